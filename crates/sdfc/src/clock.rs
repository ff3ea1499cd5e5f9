//! How long each stage took.

use std::time::{Duration, Instant};

/// The times of stages, in the order in which they ran.
#[derive(Debug, Clone, Default)]
pub struct Clock {
    stages: Vec<(&'static str, Duration)>,
}

impl Clock {
    /// Runs a stage and notes its time.
    pub fn time<T>(&mut self, stage: &'static str, run: impl FnOnce() -> T) -> T {
        let begin = Instant::now();
        let result = run();
        self.stages.push((stage, begin.elapsed()));
        result
    }

    /// The stages that ran, each with its time.
    pub fn stages(&self) -> &[(&'static str, Duration)] {
        &self.stages
    }
}
