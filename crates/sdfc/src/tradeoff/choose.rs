//! The setting that satisfies a bound.

use super::{Row, Time, Tradeoffs};
use std::time::Duration;

/// What a picture must satisfy. A setting must have been measured with hits counted as false beyond the error.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bounds {
    /// How far from the true surface hits may be, in pixels; none may be false.
    pub error: Option<f64>,
    /// How long a picture may take, by the clock on the wall.
    pub time: Option<Duration>,
}

impl Bounds {
    /// Whether a setting satisfies them, of whose rays no more than `lost` may run out of steps.
    fn hold_for(&self, row: &Row, lost: usize) -> bool {
        let errors = &row.errors;
        let wrong = errors.false_hits + errors.false_misses;
        let is_near = |most: f64| wrong == 0 && errors.out_of_steps <= lost && errors.depth[2] <= most;
        let is_fast = |most: Duration| row.time.is_some_and(|time| time.wall <= most);
        self.error.is_none_or(is_near) && self.time.is_none_or(is_fast)
    }

    /// The place of the setting to take, if one that scenes can ask for satisfies all: where the error is bounded the fastest, of
    /// those that are as fast within their spread that with the fewest evaluations, as where no times were taken; else that of
    /// the least rms. Rays may run out of steps if they do with every setting.
    pub fn choose(&self, measured: &Tradeoffs) -> Option<usize> {
        let rows = &measured.rows;
        let own = rows.first()?;
        let all = || (0..rows.len()).filter(|i| rows[*i].setting.is_like(&own.setting));
        let lost = all().map(|i| rows[i].errors.out_of_steps).min()?;
        let fits = || all().filter(|i| self.hold_for(&rows[*i], lost));
        let least = |of: &dyn Fn(&Row) -> Option<f64>| {
            let known = fits().filter_map(|i| of(&rows[i]).map(|x| (i, x)));
            known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
        };
        match (self.error, &measured.timing) {
            (Some(_), Some(_)) => {
                let fastest = rows[least(&|row| row.time.map(|time| time.median.as_secs_f64()))?].time?;
                let is_as_fast =
                    |time: &Time| time.median <= fastest.median + fastest.spread.max(time.spread) / 2;
                least(&|row| row.time.filter(is_as_fast).map(|_| row.evaluations))
            }
            (Some(_), None) => least(&|row| Some(row.evaluations)),
            (None, _) => least(&|row| Some(row.errors.rms)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Errors, Knob, Setting, Timing, Truth};
    use super::*;
    use sdf_lang::{Accuracy, Coordinates, Correction};

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
        let time = Some(Time {
            median,
            spread: Duration::ZERO,
            wall: median,
            ratio: [1.0; 3],
            to_previous: [1.0; 3],
        });
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

    fn measured() -> Tradeoffs {
        let rows = vec![
            row("fine", 20, 0.01, 0),
            row("wrong", 1, 0.1, 3),
            row("coarse", 10, 0.4, 0),
            row("middle", 15, 0.2, 0),
        ];
        let timing =
            Timing { device: "a device".into(), fallback: None, clock: "a clock", size: (1, 1), rounds: 3 };
        Tradeoffs { size: (1, 1), timing: Some(timing), truth: Truth::default().into(), rows }
    }

    fn name(measured: &Tradeoffs, bounds: Bounds) -> Option<String> {
        bounds.choose(measured).map(|place| measured.rows[place].setting.name.clone())
    }

    fn chosen(bounds: Bounds) -> Option<String> {
        name(&measured(), bounds)
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

    #[test]
    fn what_no_scene_can_ask_for_is_not_taken() {
        let mut measured = measured();
        measured.rows[2].setting.accuracy.correction = Correction::Factor(0.3);
        assert_eq!(name(&measured, bounds(Some(0.5), None)).as_deref(), Some("middle"));
        measured.rows[3].setting.accuracy.coordinates = Coordinates::World;
        assert_eq!(name(&measured, bounds(Some(0.5), None)).as_deref(), Some("fine"));
        measured.rows[0].setting.accuracy.antialias = 2;
        assert_eq!(
            name(&measured, bounds(Some(0.5), None)).as_deref(),
            Some("fine"),
            "it is the scene's own"
        );
    }

    #[test]
    fn rays_that_run_out_of_steps_are_not_taken_for_right() {
        let mut measured = measured();
        measured.rows[2].errors.out_of_steps = 5;
        assert_eq!(name(&measured, bounds(Some(0.5), None)).as_deref(), Some("middle"));
        for row in &mut measured.rows {
            row.errors.out_of_steps = 5;
        }
        assert_eq!(name(&measured, bounds(Some(0.5), None)).as_deref(), Some("coarse"));
    }

    #[test]
    fn without_times_evaluations_decide() {
        let mut measured = measured();
        measured.timing = None;
        measured.rows[3].evaluations = 0.5;
        for row in &mut measured.rows {
            row.time = None;
        }
        assert_eq!(name(&measured, bounds(Some(0.5), None)).as_deref(), Some("middle"));
        assert_eq!(name(&measured, bounds(None, Some(100))), None);
    }
}
