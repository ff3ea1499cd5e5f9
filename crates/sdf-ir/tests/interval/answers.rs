//! Slopes that are known.

use sdf_ir::interval::{Angle, Axis, Bounds, Interval, Sloped, Slopes};
use sdf_ir::{Binary, Builder, Constant, Parameter, Program, RegionId, Rotation, Type, Unary, Value};

/// The result of a function of a point, over a box.
pub fn over(lo: [f64; 3], hi: [f64; 3], write: impl FnOnce(&mut Builder, Value) -> Value) -> Sloped {
    let mut b = Builder::new("f", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
    let p = b.argument(RegionId::ROOT, 0);
    let result = write(&mut b, p);
    let function = b.finish(vec![(result, "".into())]);
    let point = Sloped::point(Bounds::between(lo, hi));
    sdf_ir::interval::slopes(&Program::default(), &function, &[point], &[], &[])[0]
}

fn close(found: f64, expected: f64) {
    assert!(
        found >= expected * (1.0 - 1e-15) && found <= expected * (1.0 + 1e-9),
        "{found} is not {expected}"
    );
}

fn swizzle(b: &mut Builder, p: Value, parts: &[usize]) -> Value {
    let parts: Vec<Value> = parts.iter().map(|i| b.component(p, *i)).collect();
    b.compose(&parts)
}

fn box_field(b: &mut Builder, p: Value, half: [f64; 3]) -> Value {
    let half = b.constant(Constant::Vec3(half));
    let zero = b.constant(Constant::Vec3([0.0; 3]));
    let a = b.unary(Unary::Abs, p);
    let q = b.sub(a, half);
    let outside = b.max(q, zero);
    let outside = b.unary(Unary::Length, outside);
    let parts = b.components(q);
    let inside = b.max(parts[1], parts[2]);
    let inside = b.max(parts[0], inside);
    let float_zero = b.float(0.0);
    let inside = b.min(inside, float_zero);
    b.add(outside, inside)
}

#[test]
fn a_ball_has_slope_one() {
    let ball = |b: &mut Builder, p| {
        let (length, r) = (b.unary(Unary::Length, p), b.float(0.5));
        b.sub(length, r)
    };
    for (lo, hi) in [([-3.0, -2.0, -1.0], [1.0, 2.0, 3.0]), ([1.0; 3], [1.5; 3]), ([-1e18; 3], [1e18; 3])] {
        close(over(lo, hi, ball).norm(), 1.0);
    }
}

#[test]
fn pairs_and_put_together_vectors_have_slope_one() {
    let (lo, hi) = ([-1.0, -2.0, 0.5], [2.0, 1.0, 3.0]);
    close(over(lo, hi, |b, p| swizzle(b, p, &[0, 2])).norm(), 1.0);
    close(over(lo, hi, |b, p| swizzle(b, p, &[2, 1, 0])).norm(), 1.0);
    let torus = |b: &mut Builder, p: Value| {
        let ring = swizzle(b, p, &[0, 2]);
        let (length, r) = (b.unary(Unary::Length, ring), b.float(1.0));
        let x = b.sub(length, r);
        let y = b.component(p, 1);
        b.compose(&[x, y])
    };
    close(over(lo, hi, torus).norm(), 1.0);
    close(
        over(lo, hi, |b, p| {
            let v = torus(b, p);
            b.unary(Unary::Length, v)
        })
        .norm(),
        1.0,
    );
}

#[test]
fn a_box_has_slope_one_where_one_side_is_felt() {
    let half = [1.0, 0.5, 0.25];
    close(over([2.0, 1.0, 1.0], [3.0, 2.0, 2.0], |b, p| box_field(b, p, half)).norm(), 1.0);
    close(over([-0.1; 3], [0.1; 3], |b, p| box_field(b, p, half)).norm(), 1.0);
    // Where both branches may count they add up.
    assert!(over([-3.0; 3], [3.0; 3], |b, p| box_field(b, p, half)).norm() <= 2.0 + 1e-9);
}

#[test]
fn a_matrix_has_its_largest_singular_value() {
    // Three times an orthogonal matrix, a shear, and one of rank one.
    let cases = [
        ([[1.0, 2.0, 2.0], [2.0, 1.0, -2.0], [2.0, -2.0, 1.0]], 3.0),
        ([[1.0, 0.75, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], (0.75 + (0.75f64 * 0.75 + 4.0).sqrt()) / 2.0),
        ([[1.0, 2.0, 2.0], [2.0, 4.0, 4.0], [-1.0, -2.0, -2.0]], 54f64.sqrt()),
    ];
    for (rows, expected) in cases {
        let found = over([-1.0; 3], [2.0; 3], |b, p| {
            let parts = rows.map(|row| {
                let row = b.constant(Constant::Vec3(row));
                b.binary(Binary::Dot, row, p)
            });
            b.compose(&parts)
        });
        close(found.norm(), expected);
    }
}

/// The point turned about `axis` by `angle`, as the library writes it.
pub fn rotate(b: &mut Builder, v: Value, axis: Value, angle: Value) -> Value {
    let a = b.unary(Unary::Normalize, axis);
    let (c, s) = (b.unary(Unary::Cos, angle), b.unary(Unary::Sin, angle));
    let one = b.float(1.0);
    let k = b.sub(one, c);
    let along = b.binary(Binary::Dot, a, v);
    let along = b.mul(along, k);
    let along = b.mul(a, along);
    let across = b.binary(Binary::Cross, a, v);
    let across = b.mul(across, s);
    let image = b.mul(v, c);
    let image = b.add(image, across);
    let image = b.add(image, along);
    b.mark_rotation(Rotation { image, vector: v, axis: Some(Axis::Of(axis)), angle: Angle::Of(angle) });
    image
}

fn twist(b: &mut Builder, p: Value, axis: [f64; 3], rate: f64) -> Value {
    let axis = b.constant(Constant::Vec3(axis));
    let unit = b.unary(Unary::Normalize, axis);
    let along = b.binary(Binary::Dot, p, unit);
    let rate = b.float(rate);
    let angle = b.mul(along, rate);
    rotate(b, p, axis, angle)
}

fn shear_slope(a: f64) -> f64 {
    (a + (a * a + 4.0).sqrt()) / 2.0
}

#[test]
fn a_twist_has_the_slope_of_a_shear() {
    for rate in [0.0, 0.3, 2.0, 50.0] {
        for r in [0.0, 0.5, 3.0] {
            let thin = 1e-11;
            let found =
                over([r - thin, 0.0, -thin], [r, 0.2, thin], |b, p| twist(b, p, [0.0, 1.0, 0.0], rate));
            close(found.norm(), shear_slope(rate * r));
            // About another axis, at the distance r from it.
            let at = [r, 0.0, 0.0];
            let found = over(at, at.map(|x| x + thin), |b, p| twist(b, p, [0.0, 3.0, 4.0], rate));
            let expected = shear_slope(rate * r);
            assert!(
                found.norm() >= expected - 1e-9 && found.norm() <= expected + 1e-9 + 50.0 * 1e-10,
                "{found:?}"
            );
        }
    }
}

/// A twist keeps the distance from its axis and from the origin: such a field is as steep as before.
#[test]
fn what_a_twist_keeps_has_slope_one() {
    let (lo, hi) = ([-1.0, -2.0, -1.0], [2.0, 2.0, 1.5]);
    let tube = over(lo, hi, |b, p| {
        let q = twist(b, p, [0.0, 1.0, 0.0], 3.0);
        let ring = swizzle(b, q, &[0, 2]);
        b.unary(Unary::Length, ring)
    });
    close(tube.norm(), 1.0);
    let plain = over(lo, hi, |b, p| {
        let ring = swizzle(b, p, &[0, 2]);
        b.unary(Unary::Length, ring)
    });
    assert!((tube.bounds.number().hi - plain.bounds.number().hi).abs() < 1e-9);
    let ball = over(lo, hi, |b, p| {
        let q = twist(b, p, [1.0, 1.0, 0.0], 3.0);
        b.unary(Unary::Length, q)
    });
    close(ball.norm(), 1.0);
}

/// By a dynamic angle: slope 1, and the length stays.
#[test]
fn a_rotation_has_slope_one_at_any_angle() {
    let mut b = Builder::new("f", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
    let p = b.argument(RegionId::ROOT, 0);
    let (axis, time) = (b.constant(Constant::Vec3([1.0, 2.0, -0.5])), b.uniform(0, Type::Float));
    let turned = rotate(&mut b, p, axis, time);
    let function = b.finish(vec![(turned, "".into())]);
    let point = Sloped::point(Bounds::between([1.0; 3], [1.5, 1.2, 1.1]));
    let time = Bounds::float(Interval::new(0.0, 1e5));
    let turned = sdf_ir::interval::slopes(&Program::default(), &function, &[point], &[time], &[])[0];
    close(turned.norm(), 1.0);
    let (before, after) = (point.bounds.length(), turned.bounds.length());
    assert!(after.encloses(before) && after.width() < before.width() + 1e-12);
    assert!(turned.bounds.part(0).hi <= before.hi + 1e-12);
}

#[test]
fn a_jump_is_an_infinite_slope() {
    let floor = |b: &mut Builder, p: Value| {
        let x = b.component(p, 0);
        b.unary(Unary::Floor, x)
    };
    assert_eq!(over([0.2; 3], [1.2; 3], floor).norm(), f64::INFINITY);
    assert_eq!(over([0.2; 3], [0.8; 3], floor).slopes, Slopes::STEADY);
    // What drops it is as steep as the rest.
    let dropped = |b: &mut Builder, p: Value| {
        let (jump, x) = (floor(b, p), b.component(p, 1));
        let zero = b.float(0.0);
        let left = b.binary(Binary::Less, x, zero);
        b.select(left, jump, x)
    };
    close(over([0.2; 3], [1.2; 3], dropped).norm(), 1.0);
    assert_eq!(over([-1.0; 3], [1.2; 3], dropped).norm(), f64::INFINITY);
}

/// A choice whose sides meet where it changes is no jump.
#[test]
fn sides_that_meet_do_not_jump() {
    let folded = |slope: f64, at: f64| {
        move |b: &mut Builder, p: Value| {
            let (x, w) = (b.component(p, 0), b.float(at));
            let less = b.binary(Binary::Less, x, w);
            let over = b.sub(x, w);
            let factor = b.float(slope);
            let over = b.mul(over, factor);
            let other = b.add(x, over);
            b.select(less, x, other)
        }
    };
    close(over([-1.0; 3], [1.0; 3], folded(2.0, 0.25)).norm(), 3.0);
    let jump = |b: &mut Builder, p: Value| {
        let (x, w) = (b.component(p, 0), b.float(0.25));
        let less = b.binary(Binary::Less, x, w);
        let one = b.float(1.0);
        let other = b.add(x, one);
        b.select(less, x, other)
    };
    assert_eq!(over([-1.0; 3], [1.0; 3], jump).norm(), f64::INFINITY);
}

/// The same for branches, whose sides compute something of their own.
#[test]
fn branches_that_meet_do_not_jump() {
    let branch = |other: f64| {
        move |b: &mut Builder, p: Value| {
            let (x, w) = (b.component(p, 0), b.float(0.25));
            let less = b.binary(Binary::Less, x, w);
            let then = b.open_region(&[]);
            let wave = b.unary(Unary::Sin, x);
            b.close_region(vec![wave]);
            let otherwise = b.open_region(&[]);
            let over = b.sub(x, w);
            let square = b.mul(over, over);
            let end = b.float(other.sin());
            let sum = b.add(end, square);
            b.close_region(vec![sum]);
            b.branch(less, then, otherwise)[0]
        }
    };
    let found = over([-1.0; 3], [1.0; 3], branch(0.25)).norm();
    assert!((1.5..=2.5 + 1e-9).contains(&found), "{found}");
    assert_eq!(over([-1.0; 3], [1.0; 3], branch(0.26)).norm(), f64::INFINITY);
}
