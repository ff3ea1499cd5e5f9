//! What each operation makes of bounds.

use super::bounds::{Bounds, computed_length};
use super::functions;
use super::number::{Interval, product_down, product_up, sum_down, sum_up};
use crate::number::LARGEST;
use crate::program::{Binary, Type, Unary};

/// An operation on one value.
pub(crate) fn unary(op: Unary, a: &Bounds) -> Bounds {
    match op {
        Unary::Not => Bounds::bool(a.decided().map(|x| !x)),
        Unary::Length => Bounds::float(computed_length(a.length())),
        Unary::Normalize => normalize(a),
        Unary::Hash => Bounds::float(functions::hash(a.parts())),
        Unary::ReduceAngle => Bounds::vector(&functions::reduce_angle(a.number()).0),
        Unary::Negate | Unary::Abs => each(a, |x| functions::unary(op, x)).with_lengths_of(a),
        _ => each(a, |x| functions::unary(op, x)),
    }
}

fn each(a: &Bounds, f: impl Fn(Interval) -> Interval) -> Bounds {
    let mut parts = [Interval::ZERO; 3];
    for (part, x) in parts.iter_mut().zip(a.parts()) {
        *part = f(*x);
    }
    Bounds::vector(&parts[..a.size()])
}

/// Length one, or zero. `x / largest / length` is off by a few roundings, and is never above 1.
fn normalize(a: &Bounds) -> Bounds {
    let (length, unit) = (a.length(), Interval::ONE.widened());
    if length.hi == 0.0 {
        return each(a, |_| Interval::ZERO);
    }
    if length.lo > 0.0 {
        let direction = each(a, |x| x.over(length).widened().intersect(Interval::SIGNED_UNIT));
        return direction.with_length(unit);
    }
    // A component has the sign that it had.
    let direction =
        each(a, |x| Interval::new(if x.lo < 0.0 { -1.0 } else { 0.0 }, if x.hi > 0.0 { 1.0 } else { 0.0 }));
    direction.with_length(unit.hull(Interval::ZERO))
}

/// An operation on two values; `same` says that they are one and the same.
pub(crate) fn binary(op: Binary, a: &Bounds, b: &Bounds, same: bool) -> Bounds {
    match op {
        Binary::Dot => Bounds::float(dot(a, b, same)),
        Binary::Cross => cross(a, b),
        Binary::Less | Binary::LessEqual | Binary::Equal | Binary::And | Binary::Or => {
            let holds = match op {
                _ if !same => functions::binary(op, a.number(), b.number()),
                Binary::LessEqual | Binary::Equal => Interval::ONE,
                Binary::Less => Interval::ZERO,
                _ => a.number(),
            };
            Bounds::of(Type::Bool, &[holds])
        }
        Binary::Multiply if same => pairwise(a, b, |x, _| x.squared()),
        Binary::Multiply => scaled(a, b, pairwise(a, b, Interval::times)),
        Binary::Add | Binary::Subtract => {
            let sum = pairwise(a, b, |x, y| functions::binary(op, x, y));
            if a.ty().is_vector() && b.ty().is_vector() { sum_lengths(a, b, sum) } else { sum }
        }
        Binary::Divide => divided(a, b, pairwise(a, b, |x, y| functions::binary(op, x, y))),
        _ => pairwise(a, b, |x, y| functions::binary(op, x, y)),
    }
}

fn pairwise(a: &Bounds, b: &Bounds, f: impl Fn(Interval, Interval) -> Interval) -> Bounds {
    let size = a.size().max(b.size());
    let mut parts = [Interval::ZERO; 3];
    for (i, part) in parts.iter_mut().enumerate().take(size) {
        *part = f(a.part(i), b.part(i));
    }
    Bounds::vector(&parts[..size])
}

/// The length of a sum lies between the difference and the sum of the lengths.
fn sum_lengths(a: &Bounds, b: &Bounds, mut sum: Bounds) -> Bounds {
    let between = |x: Interval, y: Interval| {
        let least = sum_down(x.lo, -y.hi).max(sum_down(y.lo, -x.hi)).max(0.0);
        Interval::new(least, sum_up(x.hi, y.hi)).widened()
    };
    sum = sum.with_length(between(a.length(), b.length()));
    if sum.ty() == Type::Vec3 {
        for i in 0..3 {
            sum = sum.with_across(i, between(a.across(i), b.across(i)));
        }
    }
    sum
}

/// A vector times a float is as long as both magnitudes say.
fn scaled(a: &Bounds, b: &Bounds, product: Bounds) -> Bounds {
    let (vector, factor) = match (a.ty().is_vector(), b.ty().is_vector()) {
        (true, false) => (a, b.length()),
        (false, true) => (b, a.length()),
        _ => return product,
    };
    with_lengths(vector, product, |length| length.times(factor).widened())
}

/// A vector over a float, where neither 0 nor saturation is in sight.
fn divided(a: &Bounds, b: &Bounds, ratio: Bounds) -> Bounds {
    let divisor = b.length();
    let is_plain = a.ty().is_vector() && !b.ty().is_vector() && divisor.lo > 0.0;
    if !is_plain || a.length().hi / divisor.lo > LARGEST / 2.0 {
        return ratio;
    }
    with_lengths(a, ratio, |length| length.over(divisor).widened())
}

fn with_lengths(vector: &Bounds, mut to: Bounds, length: impl Fn(Interval) -> Interval) -> Bounds {
    to = to.with_length(length(vector.length()));
    if vector.ty() == Type::Vec3 {
        for i in 0..3 {
            to = to.with_across(i, length(vector.across(i)));
        }
    }
    to
}

/// By components, and by lengths: `|a·b| ≤ |a||b|`, `a·a == |a|²`.
fn dot(a: &Bounds, b: &Bounds, same: bool) -> Interval {
    let product = |i: usize| if same { a.part(i).squared() } else { a.part(i).times(b.part(i)) };
    let mut sum = product(0);
    for i in 1..a.size() {
        sum = sum.plus(product(i));
    }
    if same {
        let square = Interval::new(
            product_down(a.length().lo, a.length().lo),
            product_up(a.length().hi, a.length().hi),
        );
        return sum.intersect(square.widened());
    }
    let most = product_up(a.length().hi, b.length().hi);
    sum.intersect(Interval::symmetric(most).widened())
}

fn cross(a: &Bounds, b: &Bounds) -> Bounds {
    let parts: [Interval; 3] = std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let most = product_up(a.across(i).hi, b.across(i).hi);
        let part = a.part(j).times(b.part(k)).minus(a.part(k).times(b.part(j)));
        part.intersect(Interval::symmetric(most).widened())
    });
    let most = product_up(a.length().hi, b.length().hi);
    Bounds::vector(&parts).with_length(Interval::new(0.0, most).widened())
}

/// `a*(1-t) + b*t`; t is a float or a vector.
pub(crate) fn mix(a: &Bounds, b: &Bounds, t: &Bounds) -> Bounds {
    let size = a.size();
    let mut parts = [Interval::ZERO; 3];
    for (i, part) in parts.iter_mut().enumerate().take(size) {
        *part = functions::mix(a.part(i), b.part(i), t.part(i));
    }
    Bounds::vector(&parts[..size])
}

/// The vector of floats.
pub(crate) fn compose(parts: &[&Bounds]) -> Bounds {
    let mut all = [Interval::ZERO; 3];
    for (part, x) in all.iter_mut().zip(parts) {
        *part = x.number();
    }
    Bounds::vector(&all[..parts.len()])
}
