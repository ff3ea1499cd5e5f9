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

#[cfg(test)]
mod tests {
    use super::super::{Errors, Knob, Setting, Time, Truth};
    use super::*;
    use sdf_lang::Accuracy;

    /// A setting that takes so long, with hits that are off by so much and a picture that is off by as many codes.
    fn row(name: &str, milliseconds: u64, off: f64, false_hits: usize) -> Row {
        let errors = Errors {
            undecided: 0,
            out_of_steps: 0,
            false_hits,
            false_misses: 0,
            depth: [0.0, off, off],
            normal: [0.0; 3],
            flicker: 0,
            rms: off,
            visible: 0.0,
            aliasing: 0.0,
        };
        let setting = Setting {
            name: name.into(),
            knob: Knob::Preset,
            accuracy: Accuracy::default(),
            preset: None,
            is_own: false,
        };
        let median = Duration::from_millis(milliseconds);
        let time = Some(Time { median, spread: Duration::ZERO, ratio: [1.0; 3] });
        Row {
            setting,
            is_again: false,
            time,
            evaluations: 1.0,
            steps: 1.0,
            errors,
            on_frontier: true,
            colors: vec![],
        }
    }

    fn chosen(bounds: Bounds) -> Option<String> {
        let rows = vec![
            row("wrong", 1, 0.1, 3),
            row("coarse", 10, 0.4, 0),
            row("middle", 15, 0.2, 0),
            row("fine", 20, 0.01, 0),
        ];
        let measured = Tradeoffs { size: (1, 1), timing: None, truth: Truth::default().into(), rows };
        bounds.choose(&measured).map(|row| row.setting.name.clone())
    }

    fn bounds(error: Option<f64>, milliseconds: Option<u64>) -> Bounds {
        Bounds { error, time: milliseconds.map(Duration::from_millis) }
    }

    #[test]
    fn the_fastest_within_the_error_is_taken() {
        assert_eq!(chosen(bounds(Some(0.5), None)).as_deref(), Some("coarse"));
        assert_eq!(chosen(bounds(Some(0.3), None)).as_deref(), Some("middle"));
        assert_eq!(chosen(bounds(Some(0.001), None)), None);
    }

    #[test]
    fn the_most_exact_within_the_time_is_taken() {
        assert_eq!(chosen(bounds(None, Some(16))).as_deref(), Some("wrong"));
        assert_eq!(chosen(bounds(None, Some(100))).as_deref(), Some("fine"));
        assert_eq!(chosen(bounds(Some(0.3), Some(16))).as_deref(), Some("middle"));
        assert_eq!(chosen(bounds(Some(0.1), Some(16))), None);
    }
}
