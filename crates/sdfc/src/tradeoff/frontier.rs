//! Which settings are worth their time.

/// Of points with a time and an error, those that no other one is as good as in both, and better in one (Vilfredo Pareto).
/// Points without a time are none of them.
pub fn frontier(points: &[(Option<f64>, f64)]) -> Vec<bool> {
    let beats = |a: (f64, f64), b: (f64, f64)| a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1);
    let is_on = |(time, error): &(Option<f64>, f64)| {
        let Some(time) = *time else { return false };
        let others = points.iter().filter_map(|(t, e)| t.map(|t| (t, *e)));
        !others.into_iter().any(|other| beats(other, (time, *error)))
    };
    points.iter().map(is_on).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_slower_and_no_better_is_not_on_it() {
        let points = [
            (Some(1.0), 9.0),
            (Some(2.0), 4.0),
            (Some(3.0), 4.0),
            (Some(2.0), 5.0),
            (Some(9.0), 1.0),
            (None, 0.0),
        ];
        assert_eq!(frontier(&points), [true, true, false, false, true, false]);
    }

    #[test]
    fn equals_are_both_on_it() {
        assert_eq!(frontier(&[(Some(1.0), 1.0), (Some(1.0), 1.0)]), [true, true]);
    }
}
