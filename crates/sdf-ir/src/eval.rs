//! Running a program.
//!
//! The typical way is `Program → Tape → Machine → run` for many points, in any [`Number`](crate::number::Number)
//! system, and [`point`] for a single one in `f64`. `f32` wants a program that
//! [`legalise`](crate::total::legalise) has gone over.

mod allocate;
mod kernel;
mod lanes;
mod lower;
mod point;
mod tape;

pub use lanes::{Counts, Machine, run_parallel};
pub use point::point;
pub use tape::Tape;
