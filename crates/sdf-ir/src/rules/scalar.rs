//! Arithmetic, on numbers and alike on the components of vectors.

use super::{fold, is_number, negated, number, widest, zero};
use crate::build::Builder;
use crate::constant::Constant;
use crate::program::{Binary, Node, Ternary, Unary, Value};

pub(super) fn add(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    let ty = widest(b, x, y);
    // x + 0 == x, 0 + x == x
    if is_number(b, y, 0.0) {
        return Some(b.splat(x, ty));
    }
    if is_number(b, x, 0.0) {
        return Some(b.splat(y, ty));
    }
    // x + (y - x) == y, (y - x) + x == y: where y is constant, since then nothing is lost but rounding
    for (sum, difference) in [(x, y), (y, x)] {
        if let Node::Binary(Binary::Subtract, k, again) = b.node(difference)
            && again == sum
            && b.constant_of(k).is_some()
        {
            return Some(b.splat(k, ty));
        }
    }
    // x + (-y) == x - y
    if let Node::Unary(Unary::Negate, y) = b.node(y) {
        return Some(b.sub(x, y));
    }
    // (-x) + y == y - x
    if let Node::Unary(Unary::Negate, x) = b.node(x) {
        return Some(b.sub(y, x));
    }
    if let Some(c) = b.constant_of(y) {
        return shift(b, x, c);
    }
    if let Some(c) = b.constant_of(x) {
        return shift(b, y, c);
    }
    None
}

pub(super) fn subtract(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    let ty = widest(b, x, y);
    // x - x == 0
    if x == y {
        return Some(zero(b, ty));
    }
    // x - 0 == x
    if is_number(b, y, 0.0) {
        return Some(b.splat(x, ty));
    }
    // 0 - x == -x
    if is_number(b, x, 0.0) {
        let negative = b.neg(y);
        return Some(b.splat(negative, ty));
    }
    // x - (-y) == x + y
    if let Node::Unary(Unary::Negate, y) = b.node(y) {
        return Some(b.add(x, y));
    }
    if let Some(c) = b.constant_of(y) {
        return shift(b, x, Constant::unary(Unary::Negate, c));
    }
    let c = b.constant_of(x)?;
    match sum(b, y)? {
        // c - (z + k) == (c - k) - z
        Sum::Plus(z, k) => {
            let c = fold(b, Constant::binary(Binary::Subtract, c, k))?;
            Some(b.sub(c, z))
        }
        // c - (k - z) == z + (c - k)
        Sum::Minus(k, z) => {
            let c = fold(b, Constant::binary(Binary::Subtract, c, k))?;
            Some(b.add(z, c))
        }
    }
}

/// A sum with a constant in it.
enum Sum {
    /// `z + k`
    Plus(Value, Constant),
    /// `k - z`
    Minus(Constant, Value),
}

fn sum(b: &Builder, a: Value) -> Option<Sum> {
    match b.node(a) {
        Node::Binary(Binary::Add, x, y) => match (b.constant_of(x), b.constant_of(y)) {
            (_, Some(k)) => Some(Sum::Plus(x, k)),
            (Some(k), _) => Some(Sum::Plus(y, k)),
            _ => None,
        },
        Node::Binary(Binary::Subtract, x, y) => match (b.constant_of(x), b.constant_of(y)) {
            (_, Some(k)) => Some(Sum::Plus(x, Constant::unary(Unary::Negate, k))),
            (Some(k), _) => Some(Sum::Minus(k, y)),
            _ => None,
        },
        _ => None,
    }
}

/// `x + c`, where x is a sum with a constant.
fn shift(b: &mut Builder, x: Value, c: Constant) -> Option<Value> {
    match sum(b, x)? {
        // (z + k) + c == z + (k + c)
        Sum::Plus(z, k) => {
            let c = Constant::binary(Binary::Add, k, c);
            if !c.is_finite() {
                return None;
            }
            // z + c is written z - (-c) where c begins with a minus.
            let ty = b.ty(z).max(c.ty());
            match c.components().iter().find(|x| **x != 0.0) {
                None => Some(b.splat(z, ty)),
                Some(first) if *first < 0.0 => {
                    let c = b.constant(Constant::unary(Unary::Negate, c));
                    Some(b.sub(z, c))
                }
                Some(_) => {
                    let c = b.constant(c);
                    Some(b.add(z, c))
                }
            }
        }
        // (k - z) + c == (k + c) - z
        Sum::Minus(k, z) => {
            let c = fold(b, Constant::binary(Binary::Add, k, c))?;
            Some(b.sub(c, z))
        }
    }
}

pub(super) fn multiply(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    factor(b, x, y).or_else(|| factor(b, y, x)).or_else(|| {
        // (-x) * (-y) == x * y
        let (Node::Unary(Unary::Negate, x), Node::Unary(Unary::Negate, y)) = (b.node(x), b.node(y)) else {
            return None;
        };
        Some(b.mul(x, y))
    })
}

/// `x * y`, by what y is.
fn factor(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    let ty = widest(b, x, y);
    // (c ? 1 : 0) * x == c ? x : 0, (c ? 0 : 1) * x == c ? 0 : x
    if let Node::Ternary(Ternary::Select, c, one, other) = b.node(y) {
        let (one, other) = (number(b, one)?, number(b, other)?);
        if (one, other) == (1.0, 0.0) || (one, other) == (0.0, 1.0) {
            let (x, zero) = (b.splat(x, ty), zero(b, ty));
            return Some(if one == 1.0 { b.select(c, x, zero) } else { b.select(c, zero, x) });
        }
    }
    let c = b.constant_of(y)?;
    // x * 0 == 0
    if is_number(b, y, 0.0) {
        return Some(zero(b, ty));
    }
    // x * 1 == x
    if is_number(b, y, 1.0) {
        return Some(b.splat(x, ty));
    }
    // x * -1 == -x
    if is_number(b, y, -1.0) {
        let negative = b.neg(x);
        return Some(b.splat(negative, ty));
    }
    match b.node(x) {
        // (-z) * c == z * -c
        Node::Unary(Unary::Negate, z) => {
            let c = negated(b, y)?;
            Some(b.mul(z, c))
        }
        // (z * k) * c == z * (k * c)
        Node::Binary(Binary::Multiply, z, k) | Node::Binary(Binary::Multiply, k, z)
            if b.constant_of(k).is_some() =>
        {
            scaled(b, z, k, c)
        }
        Node::Binary(Binary::Multiply, k, z) if b.constant_of(k).is_some() => scaled(b, z, k, c),
        _ => None,
    }
}

/// `z * (k * c)`, unless the product vanishes where neither factor does.
fn scaled(b: &mut Builder, z: Value, k: Value, c: Constant) -> Option<Value> {
    let k = b.constant_of(k)?;
    let product = Constant::binary(Binary::Multiply, k, c);
    let vanishes = |c: &Constant| c.components().iter().filter(|x| (**x as f32) == 0.0).count();
    if vanishes(&product) > vanishes(&k).max(vanishes(&c)) {
        return None;
    }
    let product = fold(b, product)?;
    Some(b.mul(z, product))
}

pub(super) fn divide(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    // 0 / x == 0, also for x == 0
    if is_number(b, x, 0.0) {
        let ty = widest(b, x, y);
        return Some(zero(b, ty));
    }
    // v / length(v) == normalize(v), also for the zero vector
    if let Node::Unary(Unary::Length, v) = b.node(y)
        && v == x
    {
        return Some(b.unary(Unary::Normalize, v));
    }
    // x / c == x * (1/c), exactly, where c is a power of two that is not below 1: a smaller one
    // could overflow, where the quotient saturates
    let c = b.constant_of(y)?;
    c.components().iter().all(|x| is_power_of_two(*x)).then(|| {
        let inverse = b.constant(Constant::binary(Binary::Divide, Constant::Float(1.0), c));
        b.mul(x, inverse)
    })
}

/// Whether `x` is ±2ⁿ, with n from 0 to 126, so that its inverse is a normal number.
fn is_power_of_two(x: f64) -> bool {
    let mantissa = x.to_bits() & ((1 << 52) - 1);
    mantissa == 0 && (1.0..=126.0f64.exp2()).contains(&x.abs())
}

pub(super) fn modulo(b: &mut Builder, x: Value, _y: Value) -> Option<Value> {
    // 0 % x == 0
    is_number(b, x, 0.0).then_some(x)
}

pub(super) fn power(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    let ty = b.ty(x);
    // x ^ 0 == 1
    if is_number(b, y, 0.0) {
        let one = b.float(1.0);
        return Some(b.splat(one, ty));
    }
    // x ^ 1 == x: the sign of an odd whole power
    is_number(b, y, 1.0).then_some(x)
}

pub(super) fn mix(b: &mut Builder, x: Value, y: Value, t: Value) -> Option<Value> {
    // mix(x, y, 0) == x, mix(x, x, t) == x
    if is_number(b, t, 0.0) || x == y {
        return Some(x);
    }
    // mix(x, y, 1) == y
    is_number(b, t, 1.0).then_some(y)
}

pub(super) fn abs(b: &mut Builder, a: Value) -> Option<Value> {
    match b.node(a) {
        // |-x| == |x|
        Node::Unary(Unary::Negate, x) => Some(b.unary(Unary::Abs, x)),
        // |x| == x where x is not negative
        _ => is_not_negative(b, a).then_some(a),
    }
}

/// Whether no component can be below zero, by the operation that makes it.
pub(super) fn is_not_negative(b: &Builder, a: Value) -> bool {
    let is_positive = |c: Constant| c.components().iter().all(|x| *x >= 0.0);
    match b.node(a) {
        Node::Unary(op, _) => {
            matches!(op, Unary::Abs | Unary::Sqrt | Unary::Exp | Unary::Exp2 | Unary::Length | Unary::Hash)
        }
        Node::Binary(Binary::Multiply | Binary::Dot, x, y) => x == y,
        Node::Binary(Binary::Max, x, y) => {
            [x, y].into_iter().any(|v| b.constant_of(v).is_some_and(is_positive))
        }
        _ => b.constant_of(a).is_some_and(is_positive),
    }
}

pub(super) fn whole(b: &mut Builder, a: Value) -> Option<Value> {
    // floor(floor(x)) == floor(x), and so for each pair of roundings
    matches!(
        b.node(a),
        Node::Unary(Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc | Unary::Sign, _)
    )
    .then_some(a)
}
