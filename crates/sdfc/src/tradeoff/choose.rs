//! The setting that satisfies a bound.

use super::{Row, Tradeoffs};
use std::time::Duration;

/// What a picture must satisfy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// How far from the true surface hits may be, in pixels; none may be false.
    pub error: Option<f64>,
    /// How long a picture may take.
    pub time: Option<Duration>,
}

impl Bounds {
    /// Whether a setting satisfies them. It must have been measured with hits counted as false beyond
    /// [`error`](Bounds::error).
    pub fn hold_for(&self, row: &Row) -> bool {
        let errors = &row.errors;
        let is_near =
            |most: f64| errors.false_hits == 0 && errors.false_misses == 0 && errors.depth[2] <= most;
        let is_fast = |most: Duration| row.time.is_some_and(|time| time.median <= most);
        self.error.is_none_or(is_near) && self.time.is_none_or(is_fast)
    }

    /// The setting to take, if one satisfies all: where the error is bounded the fastest, else the most exact.
    pub fn choose<'m>(&self, measured: &'m Tradeoffs) -> Option<&'m Row> {
        let fits = || measured.rows.iter().filter(|row| self.hold_for(row));
        match self.error {
            Some(_) => fits().filter(|row| row.time.is_some()).min_by_key(|row| row.time.map(|t| t.median)),
            None => fits().min_by(|a, b| a.errors.rms.total_cmp(&b.errors.rms)),
        }
    }
}
