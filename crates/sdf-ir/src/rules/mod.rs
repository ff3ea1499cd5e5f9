//! What is simplified while a function is built. The identity stands above its rewrite.
//!
//! A rule may use that every number is finite, and that the sign of a zero does not matter. It never makes more
//! arithmetic than it removes. Terms that are no constants are neither commuted nor reassociated: the order of a
//! sum, and of a chain of blends, is the source's.

mod affine;
mod choice;
mod scalar;
#[cfg(test)]
mod tests;
mod vector;

use crate::build::Builder;
use crate::constant::Constant;
use crate::program::{Binary, Node, Ternary, Type, Unary, Value};

/// What `op(a)` is instead, if anything.
pub(crate) fn unary(b: &mut Builder, op: Unary, a: Value) -> Option<Value> {
    if let Some(c) = b.constant_of(a) {
        return fold(b, Constant::unary(op, c));
    }
    if let Some(chosen) = choice::unary_of_choice(b, op, a) {
        return Some(chosen);
    }
    match op {
        Unary::Negate => negated(b, a),
        Unary::Not => choice::not(b, a),
        Unary::Abs => scalar::abs(b, a),
        Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc => scalar::whole(b, a),
        Unary::Length => vector::length(b, a),
        _ => None,
    }
}

/// What `op(x, y)` is instead, if anything.
pub(crate) fn binary(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    if let (Some(x), Some(y)) = (b.constant_of(x), b.constant_of(y)) {
        return fold(b, Constant::binary(op, x, y));
    }
    if let Some(chosen) = choice::binary_of_choices(b, op, x, y) {
        return Some(chosen);
    }
    match op {
        Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide => {
            arithmetic(b, op, x, y).or_else(|| vector::widened(b, op, x, y)).or_else(|| {
                let by_component = vector::by_component(b, op, x, y);
                by_component.or_else(|| b.find_commuted(op, x, y))
            })
        }
        Binary::Modulo => scalar::modulo(b, x, y),
        Binary::Min | Binary::Max => choice::extremum(b, op, x, y),
        Binary::Power => scalar::power(b, x, y),
        Binary::Dot => vector::dot(b, x, y),
        Binary::Cross => vector::cross(b, x, y),
        Binary::Less | Binary::LessEqual | Binary::Equal => choice::comparison(b, op, x, y),
        Binary::And | Binary::Or => choice::logic(b, op, x, y),
        Binary::Atan2 => None,
    }
}

/// What `op(x, y, z)` is instead, if anything.
pub(crate) fn ternary(b: &mut Builder, op: Ternary, x: Value, y: Value, z: Value) -> Option<Value> {
    if let (Some(x), Some(y), Some(z)) = (b.constant_of(x), b.constant_of(y), b.constant_of(z)) {
        return fold(b, Constant::ternary(op, x, y, z));
    }
    match op {
        Ternary::Select => choice::select(b, x, y, z),
        Ternary::Mix => scalar::mix(b, x, y, z),
    }
}

/// What the vector of `parts` is instead, if anything.
pub(crate) fn compose(b: &mut Builder, parts: &[Value]) -> Option<Value> {
    if parts.iter().all(|part| b.constant_of(*part).is_some()) {
        return None;
    }
    vector::whole(b, parts).or_else(|| affine::compose(b, parts)).or_else(|| vector::same_operation(b, parts))
}

fn arithmetic(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    match op {
        Binary::Add => scalar::add(b, x, y),
        Binary::Subtract => scalar::subtract(b, x, y),
        Binary::Multiply => scalar::multiply(b, x, y),
        _ => scalar::divide(b, x, y),
    }
}

/// A constant result stands for the operation, unless it left the range of the language's numbers.
fn fold(b: &mut Builder, c: Constant) -> Option<Value> {
    c.is_finite().then(|| b.constant(c))
}

/// What `-a` is where that takes no operation more than `a`.
fn negated(b: &mut Builder, a: Value) -> Option<Value> {
    if let Some(c) = b.constant_of(a) {
        return fold(b, Constant::unary(Unary::Negate, c));
    }
    match b.node(a) {
        // -(-x) == x
        Node::Unary(Unary::Negate, x) => Some(x),
        // -(x - y) == y - x
        Node::Binary(Binary::Subtract, x, y) => Some(b.sub(y, x)),
        // -(x*c) == x*(-c)
        Node::Binary(Binary::Multiply, x, y) if b.constant_of(y).is_some() => {
            let y = negated(b, y)?;
            Some(b.mul(x, y))
        }
        // -(c*x) == (-c)*x, -(c/x) == (-c)/x; but x/(-c) is not -(x/c) where c is 0
        Node::Binary(op @ (Binary::Multiply | Binary::Divide), x, y) if b.constant_of(x).is_some() => {
            let x = negated(b, x)?;
            Some(b.binary(op, x, y))
        }
        // -(c ? k1 : k2) == c ? -k1 : -k2
        Node::Ternary(Ternary::Select, c, x, y) if both_constant(b, x, y) => {
            let (x, y) = (negated(b, x)?, negated(b, y)?);
            Some(b.select(c, x, y))
        }
        // -(x, 0, k) == (-x, 0, -k)
        Node::Compose2(..) | Node::Compose3(..) => {
            let parts = parts(b, a)?;
            let constants = parts.iter().filter(|part| b.constant_of(**part).is_some()).count();
            (constants + 1 == parts.len()).then(|| {
                let parts: Vec<Value> = parts.iter().map(|part| b.neg(*part)).collect();
                b.compose(&parts)
            })
        }
        _ => None,
    }
}

fn both_constant(b: &Builder, x: Value, y: Value) -> bool {
    b.constant_of(x).is_some() && b.constant_of(y).is_some()
}

/// The number that a float is, or that all components of a constant vector are.
fn number(b: &Builder, a: Value) -> Option<f64> {
    let constant = b.constant_of(a)?;
    let (first, rest) = constant.components().split_first()?;
    rest.iter().all(|x| x == first).then_some(*first)
}

fn is_number(b: &Builder, a: Value, x: f64) -> bool {
    number(b, a) == Some(x)
}

/// The zero of a type.
fn zero(b: &mut Builder, ty: Type) -> Value {
    let zero = b.float(0.0);
    b.splat(zero, ty)
}

/// The wider type of the two, which arithmetic on them yields.
fn widest(b: &Builder, x: Value, y: Value) -> Type {
    b.ty(x).max(b.ty(y))
}

/// The components of a vector that is made of them.
fn parts(b: &Builder, a: Value) -> Option<Vec<Value>> {
    match b.node(a) {
        Node::Compose2(x, y) => Some(vec![x, y]),
        Node::Compose3(x, y, z) => Some(vec![x, y, z]),
        _ => None,
    }
}
