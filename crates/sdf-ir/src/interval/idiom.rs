//! What is less steep than its parts together, by what it is.
//!
//! * The distance to a corner, `length(max(v, 0)) + min(max(v.x, v.y, …), 0)`: of the two terms one is flat at every
//!   point, and it moves by no more than v (it is the signed distance of v from the orthant v ≤ 0).
//! * A constant matrix times a vector, as rows or written out: as steep as the vector times the largest singular value.
//! * A blend, `min(a, b) ± f(|a - b|)`: with the slope t that the bulge has, a weighs `1 - t` and b weighs t.

use super::matrix::{largest_singular_value, norm_up};
use super::number::{Interval, above};
use crate::program::{Binary, Function, Node, Ternary, Unary, Value};

/// What is less steep than its parts together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Idiom {
    /// It moves by no more than a vector, or the vector of these.
    Corner { vector: Option<Value>, parts: Vec<Value> },
    /// It moves by no more than a vector does, times this.
    Linear { vector: Value, norm: f64 },
    /// A blend of two values.
    Blend(Blend),
}

/// `min(a, b) ± f(|a - b|)`, or the same with `max`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blend {
    pub a: Value,
    pub b: Value,
    /// `|a - b|`
    pub apart: Value,
    /// `f(|a - b|)`
    pub bulge: Value,
    /// The nodes from `apart`, which is not among them, to `bulge`.
    pub way: Vec<Value>,
    /// What else they read.
    pub others: Vec<Value>,
    /// Whether b weighs the slope of f, or else less than nothing.
    pub is_rising: bool,
}

/// How many rotations of a function are looked for.
const ROTATIONS: usize = 32;

/// What idiom a value is.
pub(crate) fn idiom(function: &Function, value: Value) -> Option<Idiom> {
    let (x, y, is_sum) = match function.node(value) {
        Node::Binary(Binary::Add, x, y) => (x, y, true),
        Node::Binary(Binary::Subtract, x, y) => (x, y, false),
        Node::Compose2(..) | Node::Compose3(..) => {
            // Rotations that were put together from components show by these alone.
            let images = function.rotations().iter().take(ROTATIONS).map(|rotation| Some(rotation.image));
            return images.chain([None]).find_map(|image| linear(function, value, image));
        }
        _ => return None,
    };
    if is_sum && let Some(corner) = corner(function, x, y).or_else(|| corner(function, y, x)) {
        return Some(corner);
    }
    let blend = blend(function, x, y, is_sum);
    let blend = if is_sum { blend.or_else(|| self::blend(function, y, x, true)) } else { blend };
    blend.map(Idiom::Blend)
}

/// The rows of a matrix that a vector is the product of with another one; what is constant does not count.
fn linear(function: &Function, value: Value, image: Option<Value>) -> Option<Idiom> {
    let mut rows = Vec::new();
    let parts = image.map_or(Vec::new(), |image| parts_of(function, image));
    if image == Some(value) || (image.is_some() && parts.is_empty()) {
        return None;
    }
    let mut vector = image;
    let mut is_linear = true;
    function.operands(value, |part| match row(function, part, &parts, &mut vector, 8) {
        Some(row) => rows.push(row),
        None => is_linear = false,
    });
    if !is_linear {
        return None;
    }
    let rows: Vec<[Interval; 3]> = rows.iter().map(|row| row.map(Interval::point)).collect();
    let norms: Vec<f64> = rows.iter().map(|row| norm_up(&row.map(Interval::most))).collect();
    // The entries have been added up, with some error.
    let error = 1e-14 * norm_up(&norms);
    Some(Idiom::Linear { vector: vector?, norm: above(largest_singular_value(&rows, &norms) + error) })
}

/// How a float is made from the components of a vector: the first that is found if none is given, or one that was
/// put together from these parts.
fn row(
    function: &Function,
    value: Value,
    parts: &[Value],
    vector: &mut Option<Value>,
    depth: usize,
) -> Option<[f64; 3]> {
    let float = |v: Value| match function.node(v) {
        Node::Float(bits) => Some(f64::from_bits(bits)),
        _ => None,
    };
    let unit = |i: usize| std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
    let depth = depth.checked_sub(1)?;
    if let Some(i) = parts.iter().position(|part| *part == value) {
        return Some(unit(i));
    }
    let mut row = |value: Value| row(function, value, parts, vector, depth);
    match function.node(value) {
        Node::Float(_) => Some([0.0; 3]),
        Node::Component(v, i) => (*vector.get_or_insert(v) == v).then(|| unit(usize::from(i))),
        Node::Unary(Unary::Negate, a) => Some(row(a)?.map(|x| -x)),
        Node::Binary(Binary::Add, a, b) => {
            let (x, y) = (row(a)?, row(b)?);
            Some(std::array::from_fn(|i| x[i] + y[i]))
        }
        Node::Binary(Binary::Subtract, a, b) => {
            let (x, y) = (row(a)?, row(b)?);
            Some(std::array::from_fn(|i| x[i] - y[i]))
        }
        Node::Binary(Binary::Multiply, a, b) => {
            let (factor, rest) = match (float(a), float(b)) {
                (Some(factor), _) => (factor, b),
                (_, Some(factor)) => (factor, a),
                _ => return None,
            };
            Some(row(rest)?.map(|x| factor * x))
        }
        Node::Binary(Binary::Dot, a, b) => {
            let constant = |v: Value| {
                let mut row = [0.0; 3];
                let parts = parts_of(function, v);
                for (x, part) in row.iter_mut().zip(&parts) {
                    *x = float(*part)?;
                }
                (!parts.is_empty()).then_some(row)
            };
            let (row, v) = match (constant(a), constant(b)) {
                (Some(row), _) => (row, b),
                (_, Some(row)) => (row, a),
                _ => return None,
            };
            (*vector.get_or_insert(v) == v).then_some(row)
        }
        _ => None,
    }
}

/// The vector v and its parts, where the sum is the distance to a corner.
fn corner(function: &Function, outside: Value, inside: Value) -> Option<Idiom> {
    let Node::Unary(Unary::Length, clamped) = function.node(outside) else { return None };
    let Node::Binary(Binary::Min, x, y) = function.node(inside) else { return None };
    let largest = if is_zero(function, y) {
        x
    } else if is_zero(function, x) {
        y
    } else {
        return None;
    };
    let size = function.type_of(clamped)?.size();
    let vector = above_zero(function, clamped);
    let mut found = vec![None; size];
    let mut open = vec![largest];
    while let Some(value) = open.pop() {
        if let Node::Binary(Binary::Max, a, b) = function.node(value) {
            open.extend([a, b]);
            continue;
        }
        let i = (0..size).find(|i| is_part(function, clamped, vector, *i, value))?;
        found[i] = Some(value);
    }
    let parts: Option<Vec<Value>> = found.into_iter().collect();
    parts.map(|parts| Idiom::Corner { vector, parts })
}

/// The other operand of a `max` with zero.
fn above_zero(function: &Function, value: Value) -> Option<Value> {
    match function.node(value) {
        Node::Binary(Binary::Max, x, zero) | Node::Binary(Binary::Max, zero, x)
            if is_zero(function, zero) =>
        {
            Some(x)
        }
        _ => None,
    }
}

/// Whether a value is part i of v, where `clamped` is `max(v, 0)`, as a vector or put together.
fn is_part(function: &Function, clamped: Value, vector: Option<Value>, i: usize, value: Value) -> bool {
    match vector {
        Some(v) => {
            matches!(function.node(value), Node::Component(w, j) if w == v && usize::from(j) == i)
                || parts_of(function, v).get(i) == Some(&value)
        }
        None => {
            parts_of(function, clamped).get(i).and_then(|part| above_zero(function, *part)) == Some(value)
        }
    }
}

/// What a vector is put together from; nothing where it is not.
fn parts_of(function: &Function, value: Value) -> Vec<Value> {
    match function.node(value) {
        Node::Compose2(x, y) => vec![x, y],
        Node::Compose3(x, y, z) => vec![x, y, z],
        _ => Vec::new(),
    }
}

fn is_zero(function: &Function, value: Value) -> bool {
    let mut is_zero = match function.node(value) {
        Node::Float(bits) => return f64::from_bits(bits) == 0.0,
        Node::Compose2(..) | Node::Compose3(..) => true,
        _ => return false,
    };
    function.operands(value, |part| {
        is_zero &= matches!(function.node(part), Node::Float(bits) if f64::from_bits(bits) == 0.0)
    });
    is_zero
}

/// The blend that is an extreme and a bulge, where they are added, or else the bulge is taken off.
fn blend(function: &Function, extreme: Value, bulge: Value, is_sum: bool) -> Option<Blend> {
    let (a, b, is_min) = match function.node(extreme) {
        Node::Binary(Binary::Min, a, b) => (a, b, true),
        Node::Binary(Binary::Max, a, b) => (a, b, false),
        _ => return None,
    };
    if function.type_of(extreme)?.is_vector() {
        return None;
    }
    let mut way = Way { function, a, b, apart: None, nodes: Vec::new(), others: Vec::new() };
    if !way.leads_back(bulge)? {
        return None;
    }
    let (apart, way, others) = (way.apart?, way.nodes, way.others);
    // For a < b and d = b - a, min(a, b) + f(d) moves by (1 - f')·a' + f'·b', and for a > b and d = a - b the max
    // by (1 + f')·a' - f'·b'.
    Some(Blend { a, b, apart, bulge, way, others, is_rising: is_min == is_sum })
}

/// The way back from a bulge to the distance of the two.
struct Way<'f> {
    function: &'f Function,
    a: Value,
    b: Value,
    apart: Option<Value>,
    nodes: Vec<Value>,
    others: Vec<Value>,
}

impl Way<'_> {
    /// Whether a value depends on `|a - b|`; `None` where that cannot be told. What does is listed after its operands.
    fn leads_back(&mut self, value: Value) -> Option<bool> {
        if self.apart == Some(value) || self.nodes.contains(&value) {
            return Some(true);
        }
        if self.others.contains(&value) {
            return Some(false);
        }
        if self.nodes.len() + self.others.len() > 64 {
            return None;
        }
        if self.apart.is_none() && self.is_apart(value) {
            self.apart = Some(value);
            return Some(true);
        }
        let is_plain = matches!(
            self.function.node(value),
            Node::Unary(..)
                | Node::Binary(..)
                | Node::Ternary(Ternary::Mix, ..)
                | Node::Compose2(..)
                | Node::Compose3(..)
                | Node::Component(..)
        );
        let mut depends = false;
        if is_plain {
            let mut operands = Vec::with_capacity(3);
            self.function.operands(value, |operand| operands.push(operand));
            for operand in operands {
                depends |= self.leads_back(operand)?;
            }
        }
        if depends {
            self.nodes.push(value);
        } else {
            self.others.push(value);
        }
        Some(depends)
    }

    /// Whether a value is `|a - b|`.
    fn is_apart(&self, value: Value) -> bool {
        let Node::Unary(Unary::Abs, difference) = self.function.node(value) else { return false };
        let Node::Binary(Binary::Subtract, x, y) = self.function.node(difference) else { return false };
        let (a, b) = (self.a, self.b);
        let negated =
            |x: Value, y: Value| matches!(self.function.node(x), Node::Unary(Unary::Negate, of) if of == y);
        // |(-a) - (-b)| is the same.
        let both_negated =
            |x: Value, y: Value| (negated(x, a) && negated(y, b)) || (negated(a, x) && negated(b, y));
        (x, y) == (a, b) || (y, x) == (a, b) || both_negated(x, y) || both_negated(y, x)
    }
}
