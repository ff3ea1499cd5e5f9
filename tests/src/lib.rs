//! Helpers of the suites in `tests/`.
