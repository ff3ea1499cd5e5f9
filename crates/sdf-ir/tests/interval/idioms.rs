//! Sums that are less steep than their terms together: what is said of them, and that it holds.

use crate::answers::over;
use crate::random::Random;
use sdf_ir::eval::point;
use sdf_ir::interval::{Sloped, Walker};
use sdf_ir::{Binary, Builder, Constant, FunctionId, Parameter, Program, Type, Unary, Value};

fn close(found: f64, expected: f64) {
    assert!(
        found >= expected * (1.0 - 1e-12) && found <= expected * (1.0 + 1e-9),
        "{found} is not {expected}"
    );
}

/// `length(max(v, 0)) + min(max(v.x, v.y, …), 0)`
fn corner(b: &mut Builder, v: Value) -> Value {
    let (zero, parts) = (b.float(0.0), b.components(v));
    let zeros = b.splat(zero, b.ty(v));
    let outside = b.max(v, zeros);
    let outside = b.unary(Unary::Length, outside);
    let inside = parts[1..].iter().fold(parts[0], |m, x| b.max(m, *x));
    let inside = b.min(inside, zero);
    b.add(inside, outside)
}

fn box_field(b: &mut Builder, p: Value) -> Value {
    let (half, a) = (b.constant(Constant::Vec3([1.0, 0.5, 0.25])), b.unary(Unary::Abs, p));
    let q = b.sub(a, half);
    corner(b, q)
}

fn cylinder(b: &mut Builder, p: Value) -> Value {
    let [x, y, z] = [0, 1, 2].map(|i| b.component(p, i));
    let ring = b.compose(&[x, z]);
    let (ring, r, height, h) =
        (b.unary(Unary::Length, ring), b.float(0.7), b.unary(Unary::Abs, y), b.float(1.1));
    let (x, y) = (b.sub(ring, r), b.sub(height, h));
    let w = b.compose(&[x, y]);
    corner(b, w)
}

#[test]
fn the_distance_to_a_corner_has_slope_one() {
    for field in [box_field, cylinder] {
        close(over([-3.0; 3], [3.0; 3], field).norm(), 1.0);
        close(over([0.9, 0.4, 0.2], [1.1, 0.6, 0.3], field).norm(), 1.0);
    }
    // A part that is left out on one side counts twice.
    let broken = |b: &mut Builder, p: Value| {
        let (zeros, zero) = (b.constant(Constant::Vec3([0.0; 3])), b.float(0.0));
        let outside = b.max(p, zeros);
        let outside = b.unary(Unary::Length, outside);
        let (x, y) = (b.component(p, 0), b.component(p, 1));
        let inside = b.max(x, y);
        let inside = b.min(inside, zero);
        b.add(outside, inside)
    };
    assert!(over([-1.0; 3], [1.0; 3], broken).norm() > 1.3);
}

#[test]
fn a_matrix_after_a_crease_is_as_steep_as_its_parts() {
    // Turned by a constant angle, folded, turned back: no steeper than the point.
    let turned = over([-1.0; 3], [1.0; 3], |b, p| {
        let turn = |b: &mut Builder, v: Value, s: f64| {
            let rows = [[0.8, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, 0.8]];
            let parts = rows.map(|row| {
                let row = b.constant(Constant::Vec3(row));
                b.binary(Binary::Dot, row, v)
            });
            b.compose(&parts)
        };
        let mut v = p;
        for s in [0.6, -0.6, 0.6] {
            v = turn(b, v, s);
            v = b.unary(Unary::Abs, v);
        }
        v
    });
    close(turned.norm(), 1.0);
}

/// What a blend takes off where two values are `apart`, by kind.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// `max(k - d, 0)² · scale`
    Quadratic { k: f64, scale: f64 },
    /// `max(k - d, 0)³ / 6k²`
    Cubic { k: f64 },
    /// `k·log2(1 + 2^(-d/k))`, less what `min` has already
    Exponential { k: f64 },
}

fn bulge(b: &mut Builder, kind: Kind, apart: Value) -> Value {
    match kind {
        Kind::Quadratic { k, scale } => {
            let (k, zero, scale) = (b.float(k), b.float(0.0), b.float(scale));
            let h = b.sub(k, apart);
            let h = b.max(h, zero);
            let square = b.mul(h, h);
            b.mul(square, scale)
        }
        Kind::Cubic { k } => {
            let (width, zero, scale) = (b.float(k), b.float(0.0), b.float(1.0 / (6.0 * k * k)));
            let h = b.sub(width, apart);
            let h = b.max(h, zero);
            let square = b.mul(h, h);
            let cube = b.mul(square, h);
            b.mul(cube, scale)
        }
        Kind::Exponential { k } => {
            let (inverse, one, width) = (b.float(-1.0 / k), b.float(1.0), b.float(k));
            let x = b.mul(apart, inverse);
            let power = b.unary(Unary::Exp2, x);
            let sum = b.add(power, one);
            let log = b.unary(Unary::Log2, sum);
            b.mul(log, width)
        }
    }
}

/// The blend of a ball and a plane that is twice as steep, as `min` or `max`, with the difference either way round.
fn blend(b: &mut Builder, p: Value, kind: Kind, form: usize) -> Value {
    let (length, y) = (b.unary(Unary::Length, p), b.component(p, 1));
    let (r, two) = (b.float(1.0), b.float(2.0));
    let (x, y) = (b.sub(length, r), b.mul(y, two));
    let difference = if form & 1 == 0 { b.sub(y, x) } else { b.sub(x, y) };
    let apart = b.unary(Unary::Abs, difference);
    let bulge = bulge(b, kind, apart);
    if form & 2 == 0 {
        let least = b.min(x, y);
        b.sub(least, bulge)
    } else {
        let most = b.max(x, y);
        b.add(bulge, most)
    }
}

#[test]
fn a_blend_is_as_steep_as_the_steeper_side() {
    let kinds =
        [Kind::Quadratic { k: 0.3, scale: 0.25 / 0.3 }, Kind::Cubic { k: 0.5 }, Kind::Exponential { k: 0.2 }];
    for kind in kinds {
        for form in 0..4 {
            close(over([-2.0; 3], [2.0; 3], |b, p| blend(b, p, kind, form)).norm(), 2.0);
        }
    }
}

/// Bulges of any size: no pair of points is steeper than what is said.
#[test]
fn no_blend_is_steeper_than_its_slope() {
    let mut random = Random(5);
    let mut is_steep = 0;
    for _ in 0..400 {
        let form = random.below(4);
        let k = 0.1 + random.unit();
        let kind = match random.below(3) {
            0 => Kind::Quadratic { k, scale: (random.unit() - 0.3) * 4.0 / k },
            1 => Kind::Cubic { k },
            _ => Kind::Exponential { k },
        };
        let mut b = Builder::new("f", Vec::new());
        let p = b.add_parameter(Parameter { name: "p".into(), ty: Type::Vec3, point: true });
        let result = blend(&mut b, p, kind, form);
        let mut program = Program::default();
        program.add(b.finish(vec![(result, "".into())]));
        let region = random.bounds(Type::Vec3, Random::small);
        let function = &program.functions[0];
        let slope =
            Walker::<Sloped>::new(&program, function, &[], &[]).run(&[Sloped::point(region)])[0].norm();
        is_steep += usize::from(slope > 2.0 + 1e-6);
        for _ in 0..50 {
            let a = random.value(&region);
            let step: [f64; 3] = std::array::from_fn(|_| (random.unit() - 0.5) * 1e-3);
            let c = Constant::Vec3(std::array::from_fn(|i| {
                let part = region.part(i);
                (a.components()[i] + step[i]).clamp(part.lo, part.hi)
            }));
            let far: f64 =
                a.components().iter().zip(c.components()).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt();
            let [x, y] = [a, c].map(|p| point(&program, FunctionId(0), &[p], &[])[0].components()[0]);
            assert!(
                (x - y).abs() <= slope * far * (1.0 + 1e-9) + 1e-12,
                "{kind:?}, form {form}: {x} {y} {far} {slope}"
            );
        }
    }
    assert!(is_steep > 20, "only {is_steep} blends are steep");
}

/// Without an interval that shows it, nothing is claimed: the bulge may depend on more.
#[test]
fn a_bulge_that_depends_on_more_is_no_blend() {
    let field = |b: &mut Builder, p: Value| {
        let parts = b.components(p);
        let difference = b.sub(parts[0], parts[1]);
        let apart = b.unary(Unary::Abs, difference);
        let more = b.mul(apart, parts[2]);
        let least = b.min(parts[0], parts[1]);
        b.sub(least, more)
    };
    assert!(over([-1.0; 3], [1.0; 3], field).norm() > 1.5);
}
