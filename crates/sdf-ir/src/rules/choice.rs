//! Comparisons, logic, choices, and the smaller and larger of two.

use super::{fold, scalar, vector};
use crate::build::Builder;
use crate::constant::Constant;
use crate::program::{Binary, Node, Ternary, Unary, Value};

pub(super) fn not(b: &mut Builder, a: Value) -> Option<Value> {
    match b.node(a) {
        // !!a == a
        Node::Unary(Unary::Not, a) => Some(a),
        _ => None,
    }
}

pub(super) fn comparison(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    // x < x == false, x <= x == true, x == x is true
    (x == y).then(|| b.bool(op != Binary::Less))
}

pub(super) fn logic(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    // a && a == a, a || a == a
    if x == y {
        return Some(x);
    }
    let neutral = op == Binary::And;
    for (constant, other) in [(x, y), (y, x)] {
        if let Node::Bool(c) = b.node(constant) {
            // a && true == a, a || false == a, a && false == false, a || true == true
            return Some(if c == neutral { other } else { constant });
        }
    }
    None
}

pub(super) fn select(b: &mut Builder, c: Value, x: Value, y: Value) -> Option<Value> {
    // c ? x : x == x
    if x == y {
        return Some(x);
    }
    match b.node(c) {
        // true ? x : y == x, false ? x : y == y
        Node::Bool(c) => return Some(if c { x } else { y }),
        // !c ? x : y == c ? y : x
        Node::Unary(Unary::Not, c) => return Some(b.select(c, y, x)),
        _ => {}
    }
    match (b.node(x), b.node(y)) {
        // c ? true : false == c
        (Node::Bool(true), Node::Bool(false)) => Some(c),
        // c ? false : true == !c
        (Node::Bool(false), Node::Bool(true)) => Some(b.unary(Unary::Not, c)),
        // c ? (c ? x : z) : y == c ? x : y
        (Node::Ternary(Ternary::Select, again, x, _), _) if again == c => Some(b.select(c, x, y)),
        // c ? x : (c ? z : y) == c ? x : y
        (_, Node::Ternary(Ternary::Select, again, _, y)) if again == c => Some(b.select(c, x, y)),
        _ => vector::select(b, c, x, y),
    }
}

/// `op(a)` of a choice of constants.
pub(super) fn unary_of_choice(b: &mut Builder, op: Unary, a: Value) -> Option<Value> {
    let Node::Ternary(Ternary::Select, c, x, y) = b.node(a) else { return None };
    // op(c ? k1 : k2) == c ? op(k1) : op(k2)
    (chooses_constants(b, x, CHOICES) && chooses_constants(b, y, CHOICES)).then(|| {
        let (x, y) = (b.unary(op, x), b.unary(op, y));
        b.select(c, x, y)
    })
}

/// `op(x, y)` of choices.
pub(super) fn binary_of_choices(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    match (b.node(x), b.node(y)) {
        (Node::Ternary(Ternary::Select, c, x1, x2), Node::Ternary(Ternary::Select, again, y1, y2))
            if c == again =>
        {
            // (c ? x1 : x2) + (c ? y1 : y2) == c ? x1 + y1 : x2 + y2, where both sums are simpler than that
            let folds = |b: &Builder, x, y| {
                let constants = chooses_constants(b, x, CHOICES) && chooses_constants(b, y, CHOICES);
                constants
                    || (op == Binary::Add && (super::is_number(b, x, 0.0) || super::is_number(b, y, 0.0)))
            };
            (folds(b, x1, y1) && folds(b, x2, y2)).then(|| {
                let (first, second) = (b.binary(op, x1, y1), b.binary(op, x2, y2));
                b.select(c, first, second)
            })
        }
        // op(c ? k1 : k2, k) == c ? op(k1, k) : op(k2, k)
        (Node::Ternary(Ternary::Select, c, x1, x2), _) if b.constant_of(y).is_some() => {
            (chooses_constants(b, x1, CHOICES) && chooses_constants(b, x2, CHOICES)).then(|| {
                let (first, second) = (b.binary(op, x1, y), b.binary(op, x2, y));
                b.select(c, first, second)
            })
        }
        _ => None,
    }
}

/// How deep choices among constants are looked into.
const CHOICES: u32 = 6;

/// Whether a value is a constant, or a choice among constants.
fn chooses_constants(b: &Builder, v: Value, depth: u32) -> bool {
    match b.node(v) {
        Node::Ternary(Ternary::Select, _, x, y) if depth > 0 => {
            chooses_constants(b, x, depth - 1) && chooses_constants(b, y, depth - 1)
        }
        _ => b.constant_of(v).is_some(),
    }
}

/// `min(x, y)` or `max(x, y)`; the comments are about `min`.
pub(super) fn extremum(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    // min(x, x) == x
    if x == y {
        return Some(x);
    }
    let other = if op == Binary::Min { Binary::Max } else { Binary::Min };
    // min(-x, -y) == -max(x, y)
    if let (Node::Unary(Unary::Negate, x), Node::Unary(Unary::Negate, y)) = (b.node(x), b.node(y)) {
        let largest = b.binary(other, x, y);
        return Some(b.neg(largest));
    }
    bounded(b, op, x, y).or_else(|| bounded(b, op, y, x))
}

/// `min(x, y)`, by what y is.
fn bounded(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    // min(x, min(z, min(x, w))) == min(z, min(x, w))
    if chain_contains(b, op, y, x, CHAIN) {
        return Some(y);
    }
    match b.node(y) {
        // min(x, max(x, z)) == x
        Node::Binary(inner @ (Binary::Min | Binary::Max), z, w) if inner != op && (x == z || x == w) => {
            return Some(x);
        }
        _ => {}
    }
    let c = b.constant_of(y)?;
    // max(x, c) == x where c <= 0 <= x, min(x, c) == c
    if c.components().iter().all(|c| *c <= 0.0) && scalar::is_not_negative(b, x) {
        return Some(if op == Binary::Max { x } else { y });
    }
    // min(min(x, k), c) == min(x, min(k, c))
    let Node::Binary(inner, z, w) = b.node(x) else { return None };
    if inner != op {
        return None;
    }
    let (z, k) = match (b.constant_of(z), b.constant_of(w)) {
        (_, Some(k)) => (z, k),
        (Some(k), _) => (w, k),
        _ => return None,
    };
    let k = fold(b, Constant::binary(op, k, c))?;
    Some(b.binary(op, z, k))
}

/// How deep a chain of `min` is searched for an operand that it has already.
const CHAIN: u32 = 16;

fn chain_contains(b: &Builder, op: Binary, mut chain: Value, x: Value, depth: u32) -> bool {
    // A chain leans to one side; the other one is looked into, but not followed.
    for _ in 0..depth {
        let Node::Binary(inner, z, w) = b.node(chain) else { return false };
        if inner != op {
            return false;
        }
        if z == x || w == x {
            return true;
        }
        let leans = |v| matches!(b.node(v), Node::Binary(inner, ..) if inner == op);
        chain = if leans(z) { z } else { w };
    }
    false
}
