//! Vectors: whole ones out of their components, and component by component where zeros make that cheaper.

use super::{is_number, number, parts, widest};
use crate::build::Builder;
use crate::program::{Binary, Node, Ternary, Type, Unary, Value};

/// (v.x, v.y, v.z) == v
pub(super) fn whole(b: &Builder, parts: &[Value]) -> Option<Value> {
    let Node::Component(vector, 0) = b.node(parts[0]) else { return None };
    let is_whole = b.ty(vector).size() == parts.len()
        && parts.iter().enumerate().all(|(i, part)| b.node(*part) == Node::Component(vector, i as u8));
    is_whole.then_some(vector)
}

/// The vector that `parts` are the components of, where none has to be made for it.
fn existing(b: &mut Builder, parts: &[Value]) -> Option<Value> {
    if parts.iter().all(|part| b.constant_of(*part).is_some()) {
        return Some(b.compose(parts));
    }
    whole(b, parts).or_else(|| b.find_composed(parts))
}

/// (op v.x, op v.y, op v.z) == op v, also with a second operand, which is a vector or the same number thrice.
pub(super) fn same_operation(b: &mut Builder, parts: &[Value]) -> Option<Value> {
    // Components that are one value are computed once.
    if parts.iter().enumerate().any(|(i, part)| parts[..i].contains(part)) {
        return None;
    }
    let nodes: Vec<Node> = parts.iter().map(|part| b.node(*part)).collect();
    match nodes[0] {
        Node::Unary(op, _) if works_by_component(op) => {
            let operands = all(&nodes, |node| match node {
                Node::Unary(other, a) if other == op => Some(a),
                _ => None,
            })?;
            // (-x, -y, -z) == -(x, y, z)
            let vector = if op == Unary::Negate { b.compose(&operands) } else { existing(b, &operands)? };
            Some(b.unary(op, vector))
        }
        Node::Binary(op, ..) => {
            let pairs = all(&nodes, |node| match node {
                Node::Binary(other, x, y) if other == op => Some((x, y)),
                _ => None,
            })?;
            let (left, right): (Vec<Value>, Vec<Value>) = pairs.into_iter().unzip();
            let widens = matches!(op, Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide);
            if !widens
                && !matches!(op, Binary::Min | Binary::Max | Binary::Modulo | Binary::Power | Binary::Atan2)
            {
                return None;
            }
            let operand = |b: &mut Builder, side: &[Value]| {
                let alike = side.iter().all(|v| *v == side[0]);
                if widens && alike { Some(side[0]) } else { existing(b, side) }
            };
            let (x, y) = (operand(b, &left)?, operand(b, &right)?);
            (b.ty(x).is_vector() || b.ty(y).is_vector()).then(|| b.binary(op, x, y))
        }
        // (c ? x : u, c ? y : v, c ? z : w) == c ? (x, y, z) : (u, v, w)
        Node::Ternary(Ternary::Select, c, ..) => {
            let pairs = all(&nodes, |node| match node {
                Node::Ternary(Ternary::Select, other, x, y) if other == c => Some((x, y)),
                _ => None,
            })?;
            let (left, right): (Vec<Value>, Vec<Value>) = pairs.into_iter().unzip();
            let (x, y) = (b.compose(&left), b.compose(&right));
            Some(b.select(c, x, y))
        }
        _ => None,
    }
}

fn all<T>(nodes: &[Node], part: impl Fn(Node) -> Option<T>) -> Option<Vec<T>> {
    nodes.iter().map(|node| part(*node)).collect()
}

/// Whether the operation on a vector is the operation on each of its components.
fn works_by_component(op: Unary) -> bool {
    !matches!(op, Unary::Not | Unary::Length | Unary::Normalize | Unary::Hash | Unary::ReduceAngle)
}

/// v op (s, s, s) == v op s, for the operations that take a vector and a number
pub(super) fn widened(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    let ty = widest(b, x, y);
    match (single(b, x), single(b, y)) {
        // (s, s, s) op (t, t, t) == (s op t, s op t, s op t)
        (Some(s), Some(t)) if ty.is_vector() => {
            let one = b.binary(op, s, t);
            Some(b.splat(one, ty))
        }
        (_, Some(t)) if b.ty(x) == ty && b.ty(y) == ty && ty.is_vector() => Some(b.binary(op, x, t)),
        (Some(s), _) if b.ty(x) == ty && b.ty(y) == ty && ty.is_vector() => Some(b.binary(op, s, y)),
        _ => None,
    }
}

/// The number that all components of a value are.
fn single(b: &Builder, a: Value) -> Option<Value> {
    if !b.ty(a).is_vector() {
        return Some(a);
    }
    let parts = parts(b, a)?;
    parts.iter().all(|part| *part == parts[0]).then(|| parts[0])
}

/// (a, b, 0) + (0, c, d) == (a, b + c, d), and so for `- * /`, where zeros and ones leave less to compute.
pub(super) fn by_component(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    let ty = widest(b, x, y);
    let vectors = [x, y].into_iter().filter(|v| b.ty(*v).is_vector()).collect::<Vec<_>>();
    if !vectors.iter().any(|v| parts(b, *v).is_some()) {
        return None;
    }
    // What is made of components vanishes with the operation; a component that is read anew is a node more.
    let mut before = 1;
    let mut after = 1;
    for vector in &vectors {
        if parts(b, *vector).is_some() {
            before += 1;
        }
    }
    let mut operations = 0;
    for i in 0..ty.size() {
        let [left, right] = [x, y].map(|v| constant_part(b, v, i));
        let (free, reads_x, reads_y) = match (op, left, right) {
            (_, Some(_), Some(_)) => (true, false, false),
            (Binary::Multiply, Some(0.0), _) | (Binary::Multiply, _, Some(0.0)) => (true, false, false),
            (Binary::Divide, Some(0.0), _) => (true, false, false),
            (Binary::Add, Some(0.0), _) | (Binary::Multiply, Some(1.0), _) => (true, false, true),
            (Binary::Add | Binary::Subtract, _, Some(0.0)) => (true, true, false),
            (Binary::Multiply | Binary::Divide, _, Some(1.0)) => (true, true, false),
            (_, left, right) => (false, left.is_none(), right.is_none()),
        };
        operations += usize::from(!free);
        let reads =
            |v: Value, reads: bool| usize::from(reads && b.ty(v).is_vector() && parts(b, v).is_none());
        after += usize::from(!free) + reads(x, reads_x) + reads(y, reads_y);
    }
    if operations >= ty.size() || after > before {
        return None;
    }
    let components: Vec<Value> = (0..ty.size())
        .map(|i| {
            let (left, right) = (b.component(x, i), b.component(y, i));
            b.binary(op, left, right)
        })
        .collect();
    Some(b.compose(&components))
}

/// The number that a component is, where it is one.
fn constant_part(b: &Builder, a: Value, i: usize) -> Option<f64> {
    let part = if b.ty(a).is_vector() { *parts(b, a)?.get(i)? } else { a };
    number(b, part)
}

pub(super) fn length(b: &mut Builder, a: Value) -> Option<Value> {
    // length(-v) == length(v), length(|v|) == length(v)
    if let Node::Unary(Unary::Negate | Unary::Abs, v) = b.node(a) {
        return Some(b.unary(Unary::Length, v));
    }
    // length((x, 0, z)) == length((x, z)), length((0, y, 0)) == |y|
    let parts = parts(b, a)?;
    let rest: Vec<Value> = parts.iter().copied().filter(|part| !is_number(b, *part, 0.0)).collect();
    if rest.len() == parts.len() {
        return None;
    }
    let rest = b.compose(&rest);
    let op = if b.ty(rest) == Type::Float { Unary::Abs } else { Unary::Length };
    Some(b.unary(op, rest))
}

pub(super) fn dot(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    // dot(-x, -y) == dot(x, y)
    if let (Node::Unary(Unary::Negate, x), Node::Unary(Unary::Negate, y)) = (b.node(x), b.node(y)) {
        return Some(b.binary(Binary::Dot, x, y));
    }
    // dot((a, 0, c), v) == a*v.x + c*v.z
    let size = b.ty(x).size();
    let is_zero = |b: &Builder, i| [x, y].into_iter().any(|v| constant_part(b, v, i) == Some(0.0));
    if !(0..size).any(|i| is_zero(b, i)) {
        return super::affine::dot(b, x, y);
    }
    let mut sum = b.float(0.0);
    for i in (0..size).filter(|i| !is_zero(b, *i)).collect::<Vec<_>>() {
        let (left, right) = (b.component(x, i), b.component(y, i));
        let product = b.mul(left, right);
        sum = b.add(sum, product);
    }
    Some(sum)
}

/// cross((0, 1, 0), v) == (v.z, 0, -v.x), and so wherever a component is zero
pub(super) fn cross(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    let zeros = |v| (0..3).filter(|i| constant_part(b, v, *i) == Some(0.0)).count();
    if x != y && zeros(x) + zeros(y) == 0 {
        return None;
    }
    let (x, y) = (b.components(x), b.components(y));
    let parts = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let (left, right) = (b.mul(x[i], y[j]), b.mul(x[j], y[i]));
        b.sub(left, right)
    });
    Some(b.compose(&parts))
}

/// c ? (x, y, z) : (x, v, z) == (x, c ? y : v, z)
pub(super) fn select(b: &mut Builder, c: Value, x: Value, y: Value) -> Option<Value> {
    let (left, right) = (parts(b, x)?, parts(b, y)?);
    left.iter().zip(&right).any(|(x, y)| x == y).then(|| {
        let parts: Vec<Value> = left.iter().zip(&right).map(|(x, y)| b.select(c, *x, *y)).collect();
        b.compose(&parts)
    })
}
