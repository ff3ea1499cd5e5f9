//! Intervals, bounds and slopes hold what they say.

mod answers;
mod evaluators;
mod functions;
mod idioms;
mod operations;
mod programs;
mod random;
