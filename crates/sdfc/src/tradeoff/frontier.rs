//! Which settings are worth their time.

/// A setting as a point between time and error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// How long a picture takes, and how far the quartiles of that are apart, in seconds.
    pub time: [f64; 2],
    /// How far off it is.
    pub error: f64,
    /// How often a pixel evaluates the field, which no noise disturbs.
    pub evaluations: f64,
}

/// Of some points, those that no other one is as good as in both time and error, and better in one (Vilfredo Pareto). Times that
/// are nearer to each other than the quartiles of either are as good as equal; then the error decides, and between points that
/// are as exact the evaluations, and at last their order. What is no point is not on it.
pub fn frontier(points: &[Option<Point>]) -> Vec<bool> {
    let beats = |(i, a): (usize, &Point), (k, b): (usize, &Point)| {
        let noise = a.time[1].max(b.time[1]) / 2.0;
        let later = a.time[0] - b.time[0];
        let is_better = a.error < b.error || (a.evaluations, i) < (b.evaluations, k);
        a.error <= b.error && (later < -noise || later <= noise && is_better)
    };
    let all = || points.iter().enumerate().filter_map(|(i, point)| point.as_ref().map(|point| (i, point)));
    let is_on = |i: usize| {
        points[i].as_ref().is_some_and(|own| !all().any(|other| other.0 != i && beats(other, (i, own))))
    };
    (0..points.len()).map(is_on).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(time: f64, error: f64) -> Option<Point> {
        Some(Point { time: [time, 0.0], error, evaluations: 1.0 })
    }

    #[test]
    fn what_is_slower_and_no_better_is_not_on_it() {
        let points =
            [point(1.0, 9.0), point(2.0, 4.0), point(3.0, 4.0), point(2.0, 5.0), point(9.0, 1.0), None];
        assert_eq!(frontier(&points), [true, true, false, false, true, false]);
    }

    #[test]
    fn of_equals_the_first_is_on_it() {
        assert_eq!(frontier(&[point(1.0, 1.0), point(1.0, 1.0)]), [true, false]);
    }

    #[test]
    fn noise_decides_nothing() {
        let noisy = |time, error, evaluations| Some(Point { time: [time, 0.2], error, evaluations });
        // The second is faster by less than the noise, and evaluates more.
        assert_eq!(frontier(&[noisy(1.0, 1.0, 10.0), noisy(0.95, 1.0, 11.0)]), [true, false]);
        assert_eq!(frontier(&[noisy(1.0, 1.0, 10.0), noisy(0.85, 1.0, 11.0)]), [false, true]);
        assert_eq!(frontier(&[noisy(1.0, 1.0, 10.0), noisy(0.95, 2.0, 9.0)]), [true, false]);
    }
}
