//! The chain rule of each operation over a region. Where it jumps or has a pole, the derivative is everything.

use super::bounds::Bounds;
use super::functions;
use super::matrix::norm_up;
use super::number::{Interval, product_up, quotient_up, sum_up};
use super::operations;
use super::slopes::{Sloped, Slopes, Term, chain, difference, scaled, sum};
use crate::number::{LARGEST, SMALLEST_NORMAL};
use crate::program::{Binary, Type, Unary};
use std::f64::consts::{E, LN_2, LOG2_E};

/// An operation on one value.
pub(crate) fn unary(op: Unary, a: &Sloped) -> Sloped {
    let bounds = operations::unary(op, &a.bounds);
    if a.is_steady() {
        return Sloped::steady(bounds);
    }
    let slopes = match op {
        Unary::Not => truth(&bounds),
        Unary::Length => length(a),
        Unary::Normalize => normalize(a, &bounds),
        Unary::Hash => unless_point(&bounds),
        Unary::ReduceAngle => match functions::reduce_angle(a.bounds.number()).1 {
            // The angle and its rest move together; the quarter turns stay.
            true => {
                let mut gradients = [[Interval::ZERO; 3]; 3];
                gradients[0] = a.slopes.gradient(0);
                Slopes::of(2, gradients, [a.norm(), 0.0, 0.0], a.norm())
            }
            false => Slopes::within(f64::INFINITY),
        },
        _ => {
            let mut by = [Interval::ZERO; 3];
            for (i, by) in by.iter_mut().enumerate().take(bounds.size()) {
                *by = derivative(op, a.bounds.part(i), bounds.part(i));
            }
            let slopes = chain(bounds.size(), &[Term { operand: a, by }]);
            match op {
                Unary::Negate | Unary::Abs => kept_lengths(slopes, a),
                _ => slopes,
            }
        }
    };
    Sloped::new(bounds, slopes)
}

/// The slopes of a vector that is as long as another at every point.
fn kept_lengths(slopes: Slopes, a: &Sloped) -> Slopes {
    slopes.with_lengths(a.slopes.of_length(), [0, 1, 2].map(|i| a.slopes.of_across(i)))
}

/// A truth value that is not known may change anywhere.
fn truth(bounds: &Bounds) -> Slopes {
    unless_point(bounds)
}

fn unless_point(bounds: &Bounds) -> Slopes {
    if bounds.is_point() { Slopes::STEADY } else { Slopes::within(f64::INFINITY) }
}

/// The derivative of an operation that works component by component, where its value is `f`.
fn derivative(op: Unary, a: Interval, f: Interval) -> Interval {
    let jump = |stays: bool| if stays { Interval::ZERO } else { Interval::ALL };
    match op {
        Unary::Negate => Interval::point(-1.0),
        Unary::Abs if a.lo >= 0.0 => Interval::ONE,
        Unary::Abs if a.hi <= 0.0 => Interval::point(-1.0),
        Unary::Abs => Interval::SIGNED_UNIT,
        Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc | Unary::Exponent => {
            jump(f.is_point())
        }
        // 1 / 2√a
        Unary::Sqrt if a.hi <= 0.0 => Interval::ZERO,
        Unary::Sqrt => {
            let slope =
                Interval::point(0.5).over(Interval { lo: f.lo.max(0.0), hi: f.hi.max(0.0) }.widened());
            Interval::new(if a.lo < 0.0 { 0.0 } else { slope.lo.max(0.0) }, slope.hi)
        }
        Unary::Sin => functions::unary(Unary::Cos, a),
        Unary::Cos => functions::unary(Unary::Sin, a).negated(),
        // 1 + tan², and a jump from one end to the other at the poles
        Unary::Tan if functions::holds_pole(a) => Interval::ALL,
        Unary::Tan => saturating(f, Interval::ONE.plus(f.squared())),
        Unary::Asin => inverse_sine(a),
        Unary::Acos => inverse_sine(a).negated(),
        Unary::Atan => Interval::ONE.over(Interval::ONE.plus(a.squared())).widened(),
        Unary::Exp => saturating(f, f),
        Unary::Exp2 => saturating(f, f.scaled(LN_2).widened()),
        Unary::PowerOfTwo => f.scaled(LN_2).widened(),
        Unary::Log => logarithm(a),
        Unary::Log2 => logarithm(a).scaled(LOG2_E).widened(),
        Unary::Tanh => Interval::ONE.minus(f.squared()).widened().clamp(0.0, 1.0),
        Unary::Mantissa if functions::is_in_one_binade(a) => f.over(a).widened(),
        Unary::Mantissa => Interval::ALL,
        Unary::Not | Unary::Length | Unary::Normalize | Unary::Hash | Unary::ReduceAngle => {
            unreachable!("{op:?} does not work component by component")
        }
    }
}

/// Where the value may be cut off it may also stand still.
fn saturating(f: Interval, derivative: Interval) -> Interval {
    if f.hi >= LARGEST || f.lo <= -LARGEST { derivative.hull(Interval::ZERO) } else { derivative }
}

/// `1 / √(1 - a²)`, and 0 where the argument is clamped.
fn inverse_sine(a: Interval) -> Interval {
    if a.lo >= 1.0 || a.hi <= -1.0 {
        return Interval::ZERO;
    }
    let root = Interval::ONE.minus(a.clamp(-1.0, 1.0).squared()).root();
    let slope = if root.lo > 0.0 { Interval::ONE.over(root) } else { Interval::new(1.0, f64::INFINITY) };
    if a.lo < -1.0 || a.hi > 1.0 { slope.hull(Interval::ZERO) } else { slope }
}

/// `1 / a`, and 0 where the argument is raised.
fn logarithm(a: Interval) -> Interval {
    if a.hi <= SMALLEST_NORMAL {
        return Interval::ZERO;
    }
    let slope = Interval::ONE.over(Interval::new(a.lo.max(SMALLEST_NORMAL), a.hi));
    if a.lo < SMALLEST_NORMAL { slope.hull(Interval::ZERO) } else { slope }
}

/// `length' == Σ n·a'`, where n has length one: at most the norm of the Jacobian.
fn length(a: &Sloped) -> Slopes {
    let direction = operations::unary(Unary::Normalize, &a.bounds);
    let gradient = weighted(&direction, &a.slopes);
    let most = a.slopes.of_length().min(a.norm());
    Slopes::of(1, [gradient, [Interval::ZERO; 3], [Interval::ZERO; 3]], [most; 3], most)
}

/// `Σ wᵢ·a'ᵢ`
fn weighted(weights: &Bounds, slopes: &Slopes) -> [Interval; 3] {
    let parts = weights.parts().iter().enumerate();
    parts.fold([Interval::ZERO; 3], |total, (i, weight)| sum(total, scaled(slopes.gradient(i), *weight)))
}

/// `n' == (a' - n·(Σ n·a')) / |a|`: the part of a' across n, so at most the Jacobian over the length.
fn normalize(a: &Sloped, direction: &Bounds) -> Slopes {
    let length = a.bounds.length();
    if length.lo <= 0.0 {
        return Slopes::within(f64::INFINITY);
    }
    let along = weighted(direction, &a.slopes);
    let mut gradients = [[Interval::ZERO; 3]; 3];
    for (i, gradient) in gradients.iter_mut().enumerate().take(a.bounds.size()) {
        let across = difference(a.slopes.gradient(i), scaled(along, direction.part(i)));
        *gradient = across.map(|x| x.over(length));
    }
    let norm = quotient_up(a.norm(), length.lo);
    let norms = [0, 1, 2].map(|_| norm);
    // The length stays one.
    Slopes::of(a.bounds.size(), gradients, norms, norm).with_lengths(0.0, [f64::INFINITY; 3])
}

/// An operation on two values; `same` says that they are one and the same.
pub(crate) fn binary(op: Binary, a: &Sloped, b: &Sloped, same: bool) -> Sloped {
    let bounds = operations::binary(op, &a.bounds, &b.bounds, same);
    if a.is_steady() && b.is_steady() {
        return Sloped::steady(bounds);
    }
    let slopes = match op {
        Binary::Dot => dot(a, b, same),
        Binary::Cross => cross(a, b),
        Binary::Less | Binary::LessEqual | Binary::Equal | Binary::And | Binary::Or => truth(&bounds),
        Binary::Min | Binary::Max => extreme(op, a, b),
        _ => by_components(op, a, b, &bounds, same),
    };
    Sloped::new(bounds, slopes)
}

fn by_components(op: Binary, a: &Sloped, b: &Sloped, f: &Bounds, same: bool) -> Slopes {
    let size = f.size();
    let (mut by_a, mut by_b) = ([Interval::ZERO; 3], [Interval::ZERO; 3]);
    for i in 0..size {
        (by_a[i], by_b[i]) = derivatives(op, a.bounds.part(i), b.bounds.part(i), f.part(i));
    }
    if same && op == Binary::Multiply {
        let by = by_a.map(|x| x.scaled(2.0));
        return chain(size, &[Term { operand: a, by }]);
    }
    let mut slopes = chain(size, &[Term { operand: a, by: by_a }, Term { operand: b, by: by_b }]);
    // A vector times a float moves by at most its length times what the float moves by.
    if op == Binary::Multiply && a.bounds.size() != b.bounds.size() {
        let (vector, factor) = if a.bounds.size() > b.bounds.size() { (a, b) } else { (b, a) };
        let by_vector = product_up(factor.bounds.length().hi, vector.norm());
        let by_factor = product_up(vector.bounds.length().hi, factor.norm());
        slopes = slopes.with_norm(size, sum_up(by_vector, by_factor));
    }
    // The point (b, a) moves across its direction at most, seen from the origin.
    if op == Binary::Atan2 && size == 1 && slopes.norm() < f64::INFINITY {
        let point = compose(&[a, b]);
        slopes = slopes.with_norm(1, quotient_up(point.norm(), point.bounds.length().lo));
    }
    slopes
}

/// The derivatives by both operands of an operation that works component by component, where its value is `f`.
fn derivatives(op: Binary, a: Interval, b: Interval, f: Interval) -> (Interval, Interval) {
    let jump = (Interval::ALL, Interval::ALL);
    match op {
        Binary::Add => (Interval::ONE, Interval::ONE),
        Binary::Subtract => (Interval::ONE, Interval::point(-1.0)),
        Binary::Multiply => (b, a),
        Binary::Divide if a.is_zero() => {
            (if b.least() > 0.0 { Interval::ONE.over(b) } else { Interval::ALL }, Interval::ZERO)
        }
        Binary::Divide if b.least() == 0.0 => jump,
        // a'/b - b'·(a/b)/b
        Binary::Divide => {
            let by_a = Interval::ONE.over(b);
            let by_b = a.over(b).over(b).negated();
            (saturating(f, by_a), saturating(f, by_b))
        }
        // a' - b'·floor(a/b), where the floor stays
        Binary::Modulo => match functions::whole_quotient(a, b) {
            Some(whole) => (Interval::ONE, Interval::point(-whole)),
            None => jump,
        },
        Binary::Power => power(a, b, f),
        Binary::Atan2 if functions::angle_jumps(a, b) => jump,
        // (b·a' - a·b') / (a² + b²)
        Binary::Atan2 => {
            let square = a.squared().plus(b.squared());
            // |a|/(a² + b²) is at most 1/2|b|, and 1/|a|.
            let most = |x: Interval, y: Interval| {
                let half = quotient_up(0.5, y.least());
                let whole = quotient_up(1.0, x.least());
                Interval::symmetric(match (y.least() > 0.0, x.least() > 0.0) {
                    (true, true) => half.min(whole),
                    (true, false) => half,
                    (false, true) => whole,
                    (false, false) => f64::INFINITY,
                })
            };
            let over = |x: Interval, y: Interval| x.over(square).widened().intersect(most(x, y).widened());
            (over(b, a), over(a, b).negated())
        }
        Binary::Min
        | Binary::Max
        | Binary::Dot
        | Binary::Cross
        | Binary::Less
        | Binary::LessEqual
        | Binary::Equal
        | Binary::And
        | Binary::Or => unreachable!("{op:?} has no derivatives by components"),
    }
}

/// `b·|x|^(b-1)` with the sign of x for an even or broken power, and `f·log|x|`.
fn power(x: Interval, b: Interval, f: Interval) -> (Interval, Interval) {
    let m = x.magnitude();
    let may_be_odd = x.lo < 0.0 && functions::holds_odd(b);
    let by_base = if b.is_zero() {
        Interval::ZERO
    } else if (m.lo == 0.0 && b.lo <= 0.0) || (may_be_odd && !b.is_point()) {
        // A pole at 0, or a sign that depends on the power.
        Interval::ALL
    } else {
        let size = functions::power_of_magnitude(m, b.minus(Interval::ONE));
        // That saturates where the true derivative does not.
        let size = if size.hi >= LARGEST { Interval::new(size.lo, f64::INFINITY) } else { size };
        let slope = b.times(size).widened();
        let is_even = !(b.is_point() && functions::holds_odd(b));
        if !is_even || x.lo >= 0.0 {
            slope
        } else if x.hi <= 0.0 {
            slope.negated()
        } else {
            slope.hull(slope.negated())
        }
    };
    let by_exponent = if may_be_odd || (m.lo == 0.0 && b.lo <= 0.0) {
        Interval::ALL
    } else if m.lo > 0.0 {
        let log = Interval::new(m.lo.ln(), m.hi.ln()).widened();
        f.times(log).widened()
    } else {
        // m^b·log m is least where log m == -1/b.
        let least = -quotient_up(1.0, b.lo * E);
        let most = if m.hi > 1.0 { product_up(f.hi, m.hi.ln()) } else { 0.0 };
        Interval::new(least, most).widened()
    };
    (saturating(f, by_base), saturating(f, by_exponent))
}

/// `min` and `max`: the slopes of the operand that wins, component by component.
fn extreme(op: Binary, a: &Sloped, b: &Sloped) -> Slopes {
    let size = a.bounds.size();
    let wins = |x: Interval, y: Interval| match op {
        Binary::Min => x.hi <= y.lo,
        _ => x.lo >= y.hi,
    };
    let first = |i: usize| wins(a.bounds.part(i), b.bounds.part(i));
    let second = |i: usize| wins(b.bounds.part(i), a.bounds.part(i));
    if (0..size).all(first) {
        return a.slopes;
    }
    if (0..size).all(second) {
        return b.slopes;
    }
    let either = a.slopes.either(&b.slopes);
    if size == 1 {
        return either;
    }
    let (mut gradients, mut norms) = (*either.gradients(), [0, 1, 2].map(|i| either.norm_of(i)));
    for i in 0..size {
        let winner = if first(i) {
            a
        } else if second(i) {
            b
        } else {
            continue;
        };
        gradients[i] = winner.slopes.gradient(i);
        norms[i] = winner.slopes.norm_of(i);
    }
    // Each row is one of a's or of b's.
    Slopes::of(size, gradients, norms, norm_up(&[a.norm(), b.norm()]))
}

/// `Σ b·a' + Σ a·b'`: at most `|b||a'| + |a||b'|`.
fn dot(a: &Sloped, b: &Sloped, same: bool) -> Slopes {
    let left = weighted(&b.bounds, &a.slopes);
    let (gradient, norm) = if same {
        // (|a|²)' == 2·|a|·|a|'
        let norm = 2.0 * product_up(a.bounds.length().hi, a.slopes.of_length());
        (left.map(|x| x.scaled(2.0)), norm)
    } else {
        let right = weighted(&a.bounds, &b.slopes);
        let by_a = product_up(b.bounds.length().hi, a.norm());
        let by_b = product_up(a.bounds.length().hi, b.norm());
        (std::array::from_fn(|k| left[k].plus(right[k])), sum_up(by_a, by_b))
    };
    Slopes::of(1, [gradient, [Interval::ZERO; 3], [Interval::ZERO; 3]], [norm; 3], norm)
}

/// `a' × b + a × b'`
fn cross(a: &Sloped, b: &Sloped) -> Slopes {
    let mut gradients = [[Interval::ZERO; 3]; 3];
    for (i, gradient) in gradients.iter_mut().enumerate() {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let product = |u: usize, v: usize, c: usize| {
            let left = a.slopes.gradient(u)[c].times(b.bounds.part(v));
            left.plus(a.bounds.part(u).times(b.slopes.gradient(v)[c]))
        };
        *gradient = std::array::from_fn(|c| product(j, k, c).minus(product(k, j, c)));
    }
    let by_a = product_up(b.bounds.length().hi, a.norm());
    let by_b = product_up(a.bounds.length().hi, b.norm());
    let norm = sum_up(by_a, by_b);
    Slopes::of(3, gradients, [norm; 3], norm)
}

/// `a'·(1-t) + b'·t + t'·(b-a)`
pub(crate) fn mix(a: &Sloped, b: &Sloped, t: &Sloped) -> Sloped {
    let bounds = operations::mix(&a.bounds, &b.bounds, &t.bounds);
    if a.is_steady() && b.is_steady() && t.is_steady() {
        return Sloped::steady(bounds);
    }
    let size = bounds.size();
    let weights: [Interval; 3] = std::array::from_fn(|i| t.bounds.part(i));
    let span: [Interval; 3] =
        std::array::from_fn(
            |i| {
                if i < size { b.bounds.part(i).minus(a.bounds.part(i)) } else { Interval::ZERO }
            },
        );
    let rest = weights.map(|t| Interval::ONE.minus(t));
    let slopes = chain(
        size,
        &[Term { operand: a, by: rest }, Term { operand: b, by: weights }, Term { operand: t, by: span }],
    );
    // Between a and b, by one weight for all components, no more than the larger moves, and what the weight adds.
    let between = t.bounds.size() == 1 && weights[0].lo >= 0.0 && weights[0].hi <= 1.0;
    if !between {
        return Sloped::new(bounds, slopes);
    }
    let at = |t: f64| sum_up(product_up(sum_up(1.0, -t), a.norm()), product_up(t, b.norm()));
    let by_weight = product_up(norm_up(&span.map(Interval::most)), t.norm());
    let norm = sum_up(at(weights[0].lo).max(at(weights[0].hi)), by_weight);
    let mut gradients = *slopes.gradients();
    for (i, gradient) in gradients.iter_mut().enumerate().take(size) {
        let (from, to) = (a.slopes.gradient(i), b.slopes.gradient(i));
        let both = std::array::from_fn(|k| functions::mix(from[k], to[k], weights[0]));
        let moved = sum(both, scaled(t.slopes.gradient(0), span[i]));
        *gradient = std::array::from_fn(|k| gradient[k].intersect(moved[k]));
    }
    let norms = [0, 1, 2].map(|i| slopes.norm_of(i));
    Sloped::new(bounds, Slopes::of(size, gradients, norms, norm.min(slopes.norm())))
}

/// The vector of floats.
pub(crate) fn compose(parts: &[&Sloped]) -> Sloped {
    let mut all = [Bounds::float(Interval::ZERO); 3];
    let (mut gradients, mut norms) = ([[Interval::ZERO; 3]; 3], [0.0; 3]);
    for (i, part) in parts.iter().enumerate() {
        all[i] = part.bounds;
        gradients[i] = part.slopes.gradient(0);
        norms[i] = part.slopes.norm_of(0);
    }
    let bounds = operations::compose(&all.each_ref()[..parts.len()]);
    Sloped::new(bounds, Slopes::of(parts.len(), gradients, norms, norm_up(&norms)))
}

/// A component of a vector.
pub(crate) fn component(a: &Sloped, i: usize) -> Sloped {
    let norm = a.slopes.norm_of(i);
    let gradients = [a.slopes.gradient(i), [Interval::ZERO; 3], [Interval::ZERO; 3]];
    let bounds = Bounds::of(Type::Float, &[a.bounds.part(i)]);
    Sloped::new(bounds, Slopes::of(1, gradients, [norm; 3], norm))
}
