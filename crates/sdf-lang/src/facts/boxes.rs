//! Boxes round what is turned or mirrored.

use sdf_ir::interval::Interval;
use sdf_ir::region::Extent;

/// The box round a box that is turned about a line through the origin. `axis` is a unit vector if it is known;
/// `angle` may be anything in its interval.
pub(crate) fn turned(extent: &Extent, axis: Option<[f64; 3]>, angle: Interval) -> Extent {
    if extent.is_empty() {
        return Extent::NONE;
    }
    let Some(a) = axis else {
        let far: f64 = (0..3).map(|i| extent.lo[i].abs().max(extent.hi[i].abs()).powi(2)).sum();
        let far = far.sqrt() * (1.0 + 1e-12);
        return Extent::new([-far; 3], [far; 3]);
    };
    by_matrix(extent, a, angle).intersection(&swept(extent, a))
}

/// Every coordinate as a sum of three products of intervals.
fn by_matrix(extent: &Extent, a: [f64; 3], angle: Interval) -> Extent {
    let (c, s) = (angle.cos(), angle.sin());
    let one_minus = Interval::ONE.minus(c);
    let point = Interval::point;
    let entry = |i: usize, j: usize| {
        let along = one_minus.times(point(a[i]).times(point(a[j])));
        if i == j {
            // c + a²(1 - c), which is c(1 - a²) + a²
            let square = point(a[i]).squared();
            return c.times(Interval::ONE.minus(square)).plus(square);
        }
        let k = 3 - i - j;
        let sign = if (i + 1) % 3 == j { -1.0 } else { 1.0 };
        along.plus(s.times(point(sign * a[k])))
    };
    let axis = |i: usize| Interval::new(extent.lo[i], extent.hi[i]);
    let row = |i: usize| (0..3).fold(Interval::ZERO, |sum, j| sum.plus(entry(i, j).times(axis(j))));
    let rows = [row(0), row(1), row(2)];
    Extent::new(rows.map(|r| r.lo), rows.map(|r| r.hi))
}

/// The box round all that the box passes when it is turned once about: along the axis it stays, from the axis it
/// goes no farther.
fn swept(extent: &Extent, a: [f64; 3]) -> Extent {
    let axis = |i: usize| Interval::new(extent.lo[i], extent.hi[i]);
    let along = (0..3).fold(Interval::ZERO, |sum, i| sum.plus(axis(i).times(Interval::point(a[i]))));
    let reach = extent.reach(a) * (1.0 + 1e-12);
    let side = |i: usize| {
        let across = (1.0 - a[i] * a[i]).max(0.0).sqrt();
        let across = if across < 1e-9 { 0.0 } else { reach * across * (1.0 + 1e-12) };
        along.times(Interval::point(a[i])).plus(Interval::new(-across, across))
    };
    let sides = [side(0), side(1), side(2)];
    Extent::new(sides.map(|s| s.lo), sides.map(|s| s.hi))
}

/// The box round the part of a box on the positive side of a plane across the unit vector `axis`, and the image of
/// that part. The plane is at any of the places in `offset`.
pub(crate) fn mirrored(extent: &Extent, axis: Option<[f64; 3]>, offset: Interval) -> Extent {
    let Some(a) = axis else {
        return if extent.is_empty() { Extent::NONE } else { Extent::ALL };
    };
    let mut part = *extent;
    if let Some(i) = (0..3).find(|i| a[*i].abs() == 1.0) {
        if a[i] > 0.0 {
            part.lo[i] = part.lo[i].max(offset.lo);
        } else {
            part.hi[i] = part.hi[i].min(-offset.lo);
        }
    }
    if part.is_empty() {
        return Extent::NONE;
    }
    part.union(&reflected(&part, a, offset))
}

/// The box round the image of a box behind a mirror across the unit vector `axis`, at any of the places in `offset`.
pub(crate) fn reflected(extent: &Extent, a: [f64; 3], offset: Interval) -> Extent {
    if extent.is_empty() {
        return Extent::NONE;
    }
    let side = |i: usize| Interval::new(extent.lo[i], extent.hi[i]);
    let image = |i: usize| {
        // p - 2a(a·p - offset)
        let own = Interval::ONE.minus(Interval::point(a[i]).squared().scaled(2.0)).times(side(i));
        let others = (0..3)
            .filter(|j| *j != i)
            .fold(Interval::ZERO, |sum, j| sum.plus(side(j).times(Interval::point(-2.0 * a[i] * a[j]))));
        own.plus(others).plus(offset.times(Interval::point(2.0 * a[i])))
    };
    let images = [image(0), image(1), image(2)];
    Extent::new(images.map(|s| s.lo), images.map(|s| s.hi))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    fn close(found: &Extent, lo: [f64; 3], hi: [f64; 3]) {
        for i in 0..3 {
            assert!(
                found.lo[i] <= lo[i] + 1e-15 && found.lo[i] > lo[i] - 1e-9 || found.lo[i] == lo[i],
                "{found:?}"
            );
            assert!(
                found.hi[i] >= hi[i] - 1e-15 && found.hi[i] < hi[i] + 1e-9 || found.hi[i] == hi[i],
                "{found:?}"
            );
        }
    }

    const BOX: Extent = Extent { lo: [1.0, -2.0, 0.0], hi: [3.0, 4.0, 0.5] };

    #[test]
    fn a_quarter_turn_changes_axes() {
        close(
            &turned(&BOX, Some([0.0, 1.0, 0.0]), Interval::point(FRAC_PI_2)),
            [0.0, -2.0, -3.0],
            [0.5, 4.0, -1.0],
        );
        close(
            &turned(&BOX, Some([0.0, 0.0, 1.0]), Interval::point(FRAC_PI_2)),
            [-4.0, 1.0, 0.0],
            [2.0, 3.0, 0.5],
        );
        close(
            &turned(&BOX, Some([1.0, 0.0, 0.0]), Interval::point(FRAC_PI_2)),
            [1.0, -0.5, -2.0],
            [3.0, 0.0, 4.0],
        );
    }

    #[test]
    fn an_unknown_angle_keeps_what_a_turn_keeps() {
        let reach = (9.0f64 + 0.25).sqrt();
        let any = turned(&BOX, Some([0.0, 1.0, 0.0]), Interval::ALL);
        close(&any, [-reach, -2.0, -reach], [reach, 4.0, reach]);
        let plane = Extent::new([-1e20, -1e20, -1e20], [1e20, 0.0, 1e20]);
        let any = turned(&plane, Some([0.0, 1.0, 0.0]), Interval::ALL);
        assert_eq!(any.hi[1], 0.0);
        assert!(any.lo[1].is_infinite() && any.hi[0].is_infinite());
    }

    #[test]
    fn corners_of_a_turned_box_lie_inside() {
        let axis = [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0];
        let found = turned(&BOX, Some(axis), Interval::point(FRAC_PI_4));
        let (c, s) = (FRAC_PI_4.cos(), FRAC_PI_4.sin());
        for k in 0..8 {
            let p: [f64; 3] = std::array::from_fn(|i| if k >> i & 1 == 1 { BOX.hi[i] } else { BOX.lo[i] });
            let along: f64 = (0..3).map(|i| axis[i] * p[i]).sum();
            for i in 0..3 {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                let q = p[i] * c + (axis[j] * p[k] - axis[k] * p[j]) * s + axis[i] * along * (1.0 - c);
                assert!(found.lo[i] <= q && q <= found.hi[i]);
            }
        }
    }

    #[test]
    fn a_mirror_shows_the_positive_side_twice() {
        close(&mirrored(&BOX, Some([1.0, 0.0, 0.0]), Interval::ZERO), [-3.0, -2.0, 0.0], [3.0, 4.0, 0.5]);
        close(
            &mirrored(&BOX, Some([0.0, -1.0, 0.0]), Interval::point(1.0)),
            [1.0, -2.0, 0.0],
            [3.0, 0.0, 0.5],
        );
        let diagonal = [0.5f64.sqrt(), 0.5f64.sqrt(), 0.0];
        let found = mirrored(&BOX, Some(diagonal), Interval::ZERO);
        close(&found, [-4.0, -3.0, 0.0], [3.0, 4.0, 0.5]);
    }
}
