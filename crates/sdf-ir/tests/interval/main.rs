//! Intervals, bounds and slopes hold what they say.

mod answers;
mod operations;
mod programs;
mod random;
