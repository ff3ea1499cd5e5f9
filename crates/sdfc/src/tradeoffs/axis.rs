//! Axes of plots: where values stand on them, and what is written beside them.

use std::ops::Range;

/// Below this a root of a mean square, in codes of 255, is as good as none: pictures in `f32` differ by more.
pub const LEAST: f64 = 1e-4;
/// From what ratio of the longest to the shortest time on times are shown by their logarithms.
const WIDE: f64 = 5.0;

/// An axis. Places on it are values, or their logarithms.
#[derive(Debug, PartialEq)]
pub struct Axis {
    is_log: bool,
    /// From which place to which it goes.
    pub range: Range<f64>,
    /// Places with a number beside them.
    pub ticks: Vec<(f64, String)>,
    /// Places with a line, and no number.
    pub minor: Vec<f64>,
    /// The stripe of what has no logarithm.
    pub stripe: Option<Stripe>,
}

/// Where on a logarithmic axis what is as good as zero stands, apart from the rest.
#[derive(Debug, PartialEq)]
pub struct Stripe {
    /// Where its values stand.
    pub place: f64,
    /// Where it ends, and the logarithms begin.
    pub end: f64,
}

impl Axis {
    /// An axis of times in milliseconds, by their logarithms where they are far apart.
    pub fn of_times(times: &[f64]) -> Axis {
        let (least, most) = ends(times).unwrap_or((1.0, 1.0));
        // No clock is finer.
        let (least, most) = (least.max(1e-6), most.max(1e-6));
        if most / least >= WIDE {
            return Axis::logarithmic(padded(least.log10(), most.log10(), 0.1));
        }
        let padded = padded(least, most, most / 10.0);
        let range = if least < most / 2.0 { 0.0..padded.end } else { padded };
        let ticks = even_ticks(&range);
        Axis { is_log: false, range, ticks, minor: Vec::new(), stripe: None }
    }

    /// An axis of errors, by their logarithms. What is less than [`LEAST`] stands in a stripe below.
    pub fn of_errors(errors: &[f64]) -> Axis {
        let told: Vec<f64> = errors.iter().copied().filter(|error| *error >= LEAST).collect();
        let (least, most) = ends(&told).unwrap_or((LEAST, 1.0));
        let mut axis = Axis::logarithmic(padded(least.log10(), most.log10(), 0.1));
        if told.len() < errors.len() {
            let Range { start, end } = axis.range;
            let place = start - 0.08 * (end - start);
            axis.range = 2.0 * place - start..end;
            axis.ticks.push((place, format!("< {LEAST}")));
            axis.stripe = Some(Stripe { place, end: start });
        }
        axis
    }

    fn logarithmic(range: Range<f64>) -> Axis {
        let steps: &[u32] = match range.end - range.start {
            decades if decades >= 3.0 => &[1],
            decades if decades >= 1.0 => &[1, 2, 5],
            _ => &[],
        };
        let all = |steps: &[u32]| -> Vec<(f64, String)> {
            let decades = range.start.floor() as i32..=range.end.floor() as i32;
            let ticks = decades.flat_map(|decade| {
                steps.iter().map(move |step| {
                    let label = decimal(f64::from(*step), decade);
                    (f64::from(*step).log10() + f64::from(decade), label)
                })
            });
            ticks.filter(|(place, _)| range.contains(place)).collect()
        };
        let (ticks, minor) = match steps {
            [] => {
                let values = 10f64.powf(range.start)..10f64.powf(range.end);
                (even_ticks(&values).into_iter().map(|(x, label)| (x.log10(), label)).collect(), Vec::new())
            }
            _ => {
                (all(steps), all(&[1, 2, 3, 4, 5, 6, 7, 8, 9]).into_iter().map(|(place, _)| place).collect())
            }
        };
        Axis { is_log: true, range, ticks, minor, stripe: None }
    }

    /// Where a value stands.
    pub fn place(&self, value: f64) -> f64 {
        match (&self.stripe, self.is_log) {
            (Some(stripe), _) if value < LEAST => stripe.place,
            (_, true) => value.log10().max(self.range.start),
            (_, false) => value.max(self.range.start),
        }
    }

    /// Which pixel a place is, of those between the ends of the axis; what is beyond them is upon them.
    pub fn pixel(&self, place: f64, (from, to): (i32, i32)) -> i32 {
        let part = (place - self.range.start) / (self.range.end - self.range.start);
        from + (part.clamp(0.0, 1.0) * f64::from(to - from)).round() as i32
    }

    /// Whether places are logarithms.
    pub fn is_log(&self) -> bool {
        self.is_log
    }

    /// What is written at a place.
    pub fn label(&self, place: f64) -> String {
        let near = |tick: &&(f64, String)| (tick.0 - place).abs() < 1e-9;
        self.ticks.iter().find(near).map_or(String::new(), |(_, label)| label.clone())
    }
}

fn ends(values: &[f64]) -> Option<(f64, f64)> {
    let least = values.iter().copied().min_by(f64::total_cmp)?;
    let most = values.iter().copied().max_by(f64::total_cmp)?;
    Some((least, most))
}

/// A range with some room beside its ends; of no length, it gets this much.
fn padded(low: f64, high: f64, least: f64) -> Range<f64> {
    let room = (0.07 * (high - low)).max(least);
    low - room..high + room
}

/// From four to ten round numbers, evenly spaced.
fn even_ticks(range: &Range<f64>) -> Vec<(f64, String)> {
    let rough = (range.end - range.start) / 5.0;
    let decade = rough.log10().floor() as i32;
    let step = [5.0, 2.0, 1.0].into_iter().find(|step| step * 10f64.powi(decade) <= rough).unwrap_or(1.0);
    let size = step * 10f64.powi(decade);
    let numbers = (range.start / size).ceil() as i64..=(range.end / size).floor() as i64;
    numbers.map(|n| (n as f64 * size, decimal(n as f64 * step, decade))).collect()
}

/// A number times a power of ten, with the digits that it has.
fn decimal(number: f64, decade: i32) -> String {
    let digits = usize::try_from(-decade).unwrap_or(0);
    format!("{:.digits$}", number * 10f64.powi(decade))
}

#[cfg(test)]
mod tests {
    use super::Axis;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn ticks() {
        let rows: [(Axis, &[&str]); 6] = [
            (Axis::of_times(&[1.0, 4000.0]), &["1", "10", "100", "1000"]),
            (Axis::of_times(&[0.03, 0.9]), &["0.05", "0.1", "0.2", "0.5", "1"]),
            (Axis::of_times(&[1.0, 3.0]), &["0.0", "0.5", "1.0", "1.5", "2.0", "2.5", "3.0"]),
            (
                Axis::of_times(&[2.0]),
                &["1.80", "1.85", "1.90", "1.95", "2.00", "2.05", "2.10", "2.15", "2.20"],
            ),
            (Axis::of_errors(&[3.0, 3.0]), &["2.4", "2.6", "2.8", "3.0", "3.2", "3.4", "3.6"]),
            (
                Axis::of_errors(&[0.0, 0.02, 2.0]),
                &["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "< 0.0001"],
            ),
        ];
        for (axis, expected) in rows {
            assert_eq!(labels(&axis), expected);
            let range = axis.range.start..=axis.range.end;
            assert!(axis.ticks.iter().all(|(place, _)| range.contains(place)), "{axis:?}");
        }
    }

    #[test]
    fn all_values_are_on_it() {
        for values in [&[0.0][..], &[0.0, 0.0], &[1e-9, 255.0], &[0.5], &[0.0, 7.0], &[1e-4, 1e-4]] {
            let axis = Axis::of_errors(values);
            for value in values {
                assert!(axis.range.contains(&axis.place(*value)), "{value} in {axis:?}");
            }
            let axis = Axis::of_times(values);
            for value in values {
                assert!(axis.place(*value) >= axis.range.start, "{value} in {axis:?}");
                assert!(axis.place(*value) <= axis.range.end, "{value} in {axis:?}");
            }
        }
    }

    #[test]
    fn what_is_zero_stands_below_the_logarithms() {
        let axis = Axis::of_errors(&[0.0, 0.02, 2.0]);
        let stripe = axis.stripe.as_ref().unwrap();
        assert_eq!(axis.place(0.0), stripe.place);
        assert!(stripe.place < stripe.end && stripe.end < axis.place(0.02), "{axis:?}");
        assert_eq!(Axis::of_errors(&[0.02, 2.0]).stripe, None);
    }
}
