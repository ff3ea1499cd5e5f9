//! Helpers of the suites in `tests/`.

pub mod agreement;
pub mod fields;
pub mod glslang;
pub mod library;
pub mod numbers;
pub mod run;
pub mod scenes;
