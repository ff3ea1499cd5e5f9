//! The hard cases: scenes on which ray marchers are known to fail, in `tests/hard/`, judged pixel by pixel by the certified
//! first hit of each ray, on every execution.
//!
//! A [`Fixture`] is a file and what its head says; its [`Subject`](fixture::Subject)s are scenes with values filled in. An
//! [`Execution`] runs a subject's probe for all pixels of a [`Frame`](sdf_render::Frame). What it shows is judged
//! ([`Score`](score::Score)); the same is done with the naive [`twin`] of a case, which must fail.

pub mod execution;
pub mod fixture;
pub mod run;
pub mod score;
pub mod twin;

pub use execution::Execution;
pub use fixture::{Effort, Fixture, fixtures};
pub use run::Outcome;
pub use score::{Certified, Score};
