//! Helpers of the suites in `tests/`.

pub mod numbers;
pub mod run;
