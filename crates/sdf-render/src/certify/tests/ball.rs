//! Balls that hold a zero of a field, or just do not, and the steps that they stand for.

use super::*;
use sdf_ir::Binary;

#[test]
fn balls_hold_zeros_or_do_not() {
    for (name, shape, touching) in [
        ("sphere", sphere as Shape, [1.5, 0.0, 0.0]),
        ("box", cuboid, [1.3, 0.9, 0.0]),
        ("torus", torus, [0.0; 3]),
        // Beside the rim, and over the face.
        ("strip", strip, [1.3, 0.1, 0.4]),
        ("strip", strip, [0.3, 0.1, 0.4]),
    ] {
        let certifier = scene(shape, 1.0);
        let mut prover = certifier.prover();
        let [distance, _] = run(&mut prover.step, &touching);
        for share in [0.5, 0.99] {
            assert_eq!(
                prover.contains_zero(touching, share * distance, BUDGET),
                Some(false),
                "{name} {share}"
            );
        }
        assert_eq!(prover.contains_zero(touching, 1.01 * distance, BUDGET), Some(true), "{name}");
        assert_eq!(prover.contains_zero([5.0, 4.0, 3.0], 1.0, BUDGET), Some(false), "{name}");
    }
}

/// Where x and y are below 1 and x is above -1, by the greatest of three numbers.
fn wall(b: &mut Builder, p: Value) -> Value {
    let (x, y, one) = (b.component(p, 0), b.component(p, 1), b.float(1.0));
    let (right, above) = (b.sub(x, one), b.sub(y, one));
    let left = b.unary(Unary::Negate, x);
    let left = b.sub(left, one);
    let sides = b.max(left, right);
    b.max(sides, above)
}

fn all_but_wall(b: &mut Builder, p: Value) -> Value {
    let wall = wall(b, p);
    b.unary(Unary::Negate, wall)
}

/// The same solid as `wall`, but no longer the greatest of anything.
fn steep_wall(b: &mut Builder, p: Value) -> Value {
    let (wall, by) = (wall(b, p), b.float(2.0));
    b.mul(wall, by)
}

#[test]
fn an_edge_is_as_far_as_it_is_and_not_as_its_faces() {
    let (place, distance) = ([2.0, 2.0, 0.0], 2.0f64.sqrt());
    let asked =
        |shape, share: f64, budget| scene(shape, 1.0).prover().contains_zero(place, share * distance, budget);
    for shape in [wall as Shape, all_but_wall] {
        assert_eq!(asked(shape, 0.999, 40), Some(false));
        assert_ne!(asked(shape, 1.001, 40), Some(false));
        assert_ne!(asked(shape, 1.001, BUDGET), Some(false));
    }
    // The slopes of the maximum alone do not tell that so soon.
    assert_eq!(asked(steep_wall, 0.999, 40), None);
}

/// 2 + y, by two factors that have the same sign whatever becomes of a condition, which is open where x = 0.1.
fn by_open_condition(b: &mut Builder, p: Value) -> Value {
    let (x, y, three, limit) = (b.component(p, 0), b.component(p, 1), b.float(3.0), b.float(0.3));
    let tripled = b.mul(x, three);
    let is_low = b.binary(Binary::LessEqual, tripled, limit);
    let mut one_of = |high: f64, low: f64| {
        let (high, low) = (b.float(high), b.float(low));
        b.select(is_low, low, high)
    };
    let (sign, twice) = (one_of(1.0, -1.0), one_of(2.0, -2.0));
    let product = b.mul(sign, twice);
    b.add(product, y)
}

#[test]
fn a_condition_that_rounding_leaves_open_is_no_zero() {
    let certifier = scene(by_open_condition, 1.0);
    let mut prover = certifier.prover();
    for (y, radius, wanted) in [(0.5, 0.5, Some(false)), (0.5, 2.49, Some(false)), (0.5, 2.51, Some(true))] {
        assert_eq!(prover.contains_zero([0.1, y, 0.0], radius, BUDGET), wanted, "{radius}");
    }
    assert_eq!(prover.contains_zero([0.1, -2.0, 0.0], 0.1, BUDGET), Some(true));
}

#[test]
fn steps_are_safe_unless_they_are_too_long() {
    let places =
        (0..60).map(|i| [(i % 5) as f64 * 0.6 - 1.1, (i / 5 % 4) as f64 * 0.7 - 0.9, (i / 20) as f64 - 0.8]);
    let count_safe = |shape, stretch| {
        let certifier = scene(shape, stretch);
        let mut prover = certifier.prover();
        places.clone().filter(|place| prover.step_from(*place) == Step::Safe).count()
    };
    for shape in [sphere as Shape, plane, torus, cuboid] {
        assert_eq!(count_safe(shape, 1.0), 60);
        assert!(count_safe(shape, 1.1) < 20);
    }
    // The field is steeper than a distance.
    assert!(count_safe(twisted, 1.0) < 55);
    assert_eq!(count_safe(twisted, 0.2), 60);
}

#[test]
fn a_step_that_is_too_long_says_what_is_free() {
    let certifier = scene(sphere, 1.2);
    assert_eq!(certifier.prover().step_from([3.0, 0.0, 0.0]), Step::Unsafe(0.75));
}
