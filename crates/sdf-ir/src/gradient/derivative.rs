//! The derivative of each operation, as the slopes of its components. The formula stands above its code: `a'` is
//! the slope of a, r is the result. They are total where the operations are.

use super::{Slope, Walk, chosen, difference, divided, negated, scaled, sum};
use crate::build::Builder;
use crate::number::{LEAST_SQUARE, SMALLEST_NORMAL};
use crate::program::{Binary, Node, Ternary, Type, Unary, Value};

/// The slopes of a node that has been copied and is no call, branch, loop or part.
pub(super) fn slopes(walk: &Walk, b: &mut Builder, value: Value) -> Vec<Slope> {
    let it = Operation { walk, result: walk.copy.value(b, value), size: size(walk, value) };
    match walk.source.node(value) {
        Node::Unary(op, a) => it.unary(b, op, a),
        Node::Binary(op, x, y) => it.binary(b, op, x, y),
        Node::Ternary(op, x, y, z) => it.ternary(b, op, x, y, z),
        Node::Compose2(x, y) => walk.all_slopes(&[x, y]),
        Node::Compose3(x, y, z) => walk.all_slopes(&[x, y, z]),
        Node::Component(a, index) => vec![it.slope(a, index as usize)],
        Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_) => {
            unreachable!("leaves stand in no body")
        }
        Node::Call(..) | Node::If(..) | Node::Loop(_) | Node::Result(..) => {
            unreachable!("differentiated by the walk")
        }
    }
}

fn size(walk: &Walk, value: Value) -> usize {
    walk.source.type_of(value).map_or(1, Type::size)
}

/// The operation that is differentiated.
struct Operation<'a, 'b> {
    walk: &'a Walk<'b>,
    result: Value,
    size: usize,
}

impl Operation<'_, '_> {
    /// The slope of a component of an operand; that of a float, which stands for a vector, is each one's.
    fn slope(&self, operand: Value, i: usize) -> Slope {
        let slopes = self.walk.slopes(operand);
        if slopes.len() == 1 { slopes[0].clone() } else { slopes[i].clone() }
    }

    /// A component of the copy of an operand.
    fn part(&self, b: &mut Builder, operand: Value, i: usize) -> Value {
        let copied = self.walk.copy.value(b, operand);
        b.component(copied, i)
    }

    fn flat(&self) -> Vec<Slope> {
        vec![self.walk.flat(); self.size]
    }

    fn moves(&self, operand: Value) -> bool {
        self.walk.slopes(operand).iter().flatten().any(|derivative| derivative.is_some())
    }

    /// Σ xᵢ·y'ᵢ over all components
    fn weighted(&self, b: &mut Builder, x: Value, y: Value) -> Slope {
        let mut total = self.walk.flat();
        for i in 0..size(self.walk, y) {
            let weight = self.part(b, x, i);
            let part = scaled(b, &self.slope(y, i), weight);
            total = sum(b, total, part);
        }
        total
    }

    fn unary(&self, b: &mut Builder, op: Unary, a: Value) -> Vec<Slope> {
        if !self.moves(a) {
            return self.flat();
        }
        match op {
            // length' == (Σ aᵢ·a'ᵢ) / r, which is 0 at 0
            Unary::Length => {
                // The square of what is shorter than this is lost, and with it the length.
                let total = self.weighted(b, a, a);
                let shortest = b.float(1e-20);
                let length = b.binary(Binary::Max, self.result, shortest);
                vec![divided(b, &total, length)]
            }
            Unary::Normalize => self.normalize(b, a),
            // An angle and its rest move together; the quarter turns that are taken off jump.
            Unary::ReduceAngle => vec![self.slope(a, 0), self.walk.flat()],
            Unary::Hash => self.flat(),
            _ => (0..self.size)
                .map(|i| {
                    let (x, r) = (self.part(b, a, i), b.component(self.result, i));
                    unary_number(b, op, x, r, &self.slope(a, i)).unwrap_or_else(|| self.walk.flat())
                })
                .collect(),
        }
    }

    /// r' == (a' - r·(Σ rᵢ·a'ᵢ)) / length(a), and 0 at 0
    fn normalize(&self, b: &mut Builder, a: Value) -> Vec<Slope> {
        let copied = self.walk.copy.value(b, a);
        let inverse = inverse_length(b, copied);
        let mut along = self.walk.flat();
        for i in 0..self.size {
            let r = b.component(self.result, i);
            let part = scaled(b, &self.slope(a, i), r);
            along = sum(b, along, part);
        }
        (0..self.size)
            .map(|i| {
                let r = b.component(self.result, i);
                let part = scaled(b, &along, r);
                let across = difference(b, self.slope(a, i), part);
                scaled(b, &across, inverse)
            })
            .collect()
    }

    fn binary(&self, b: &mut Builder, op: Binary, x: Value, y: Value) -> Vec<Slope> {
        match op {
            // dot' == Σ y·x' + Σ x·y'
            Binary::Dot if x == y => {
                let total = self.weighted(b, x, x);
                let two = b.float(2.0);
                vec![scaled(b, &total, two)]
            }
            Binary::Dot => {
                let (left, right) = (self.weighted(b, y, x), self.weighted(b, x, y));
                vec![sum(b, left, right)]
            }
            Binary::Cross => [(1, 2), (2, 0), (0, 1)]
                .map(|(i, j)| {
                    let left = self.product(b, x, i, y, j);
                    let right = self.product(b, x, j, y, i);
                    difference(b, left, right)
                })
                .to_vec(),
            Binary::Less | Binary::LessEqual | Binary::Equal | Binary::And | Binary::Or => self.flat(),
            _ => (0..self.size).map(|i| self.binary_number(b, op, x, y, i)).collect(),
        }
    }

    /// (xᵢ·yⱼ)' == x'·y + x·y'
    fn product(&self, b: &mut Builder, x: Value, i: usize, y: Value, j: usize) -> Slope {
        let (u, v) = (self.part(b, x, i), self.part(b, y, j));
        if u == v {
            let two = b.float(2.0);
            let twice = b.mul(u, two);
            return scaled(b, &self.slope(x, i), twice);
        }
        let (left, right) = (scaled(b, &self.slope(x, i), v), scaled(b, &self.slope(y, j), u));
        sum(b, left, right)
    }

    /// Component i of an operation that works component by component.
    fn binary_number(&self, b: &mut Builder, op: Binary, x: Value, y: Value, i: usize) -> Slope {
        let (dx, dy) = (self.slope(x, i), self.slope(y, i));
        if dx.iter().chain(&dy).all(|derivative| derivative.is_none()) {
            return self.walk.flat();
        }
        let (u, v, r) = (self.part(b, x, i), self.part(b, y, i), b.component(self.result, i));
        match op {
            Binary::Add => sum(b, dx, dy),
            Binary::Subtract => difference(b, dx, dy),
            Binary::Multiply => self.product(b, x, i, y, i),
            // (x/y)' == (x' - r·y') / y
            Binary::Divide => {
                let part = scaled(b, &dy, r);
                let top = difference(b, dx, part);
                divided(b, &top, v)
            }
            // (x - y·floor(x/y))' == x' - y'·floor(x/y)
            Binary::Modulo => {
                let quotient = b.div(u, v);
                let whole = b.unary(Unary::Floor, quotient);
                let part = scaled(b, &dy, whole);
                difference(b, dx, part)
            }
            // min' == x <= y ? x' : y', and so for max: a tie takes the first
            Binary::Min => {
                let first = b.binary(Binary::LessEqual, u, v);
                chosen(b, first, dx, dy, &self.walk.parameters)
            }
            Binary::Max => {
                let first = b.binary(Binary::LessEqual, v, u);
                chosen(b, first, dx, dy, &self.walk.parameters)
            }
            // (x^y)' == (y·r/x)·x' + (r·log|x|)·y'
            Binary::Power => {
                let (scaled_r, magnitude) = (b.mul(v, r), b.unary(Unary::Abs, u));
                let (by_base, log) = (b.div(scaled_r, u), b.unary(Unary::Log, magnitude));
                let by_exponent = b.mul(r, log);
                let (left, right) = (scaled(b, &dx, by_base), scaled(b, &dy, by_exponent));
                sum(b, left, right)
            }
            // atan2(x, y)' == (y·x' - x·y') / (x² + y²), where the square is not so small that it is lost.
            Binary::Atan2 => {
                let (uu, vv, least) = (b.mul(u, u), b.mul(v, v), b.float(LEAST_SQUARE));
                let square = b.add(uu, vv);
                let square = b.max(square, least);
                let (left, right) = (scaled(b, &dx, v), scaled(b, &dy, u));
                let top = difference(b, left, right);
                divided(b, &top, square)
            }
            Binary::Dot
            | Binary::Cross
            | Binary::Less
            | Binary::LessEqual
            | Binary::Equal
            | Binary::And
            | Binary::Or => unreachable!("{op:?} does not work component by component"),
        }
    }

    fn ternary(&self, b: &mut Builder, op: Ternary, x: Value, y: Value, z: Value) -> Vec<Slope> {
        let one = b.float(1.0);
        (0..self.size)
            .map(|i| match op {
                Ternary::Select => {
                    let condition = self.walk.copy.value(b, x);
                    let (left, right) = (self.slope(y, i), self.slope(z, i));
                    chosen(b, condition, left, right, &self.walk.parameters)
                }
                // mix(x, y, t)' == x'·(1 - t) + y'·t + t'·(y - x)
                Ternary::Mix => {
                    let t = self.part(b, z, i);
                    let rest = b.sub(one, t);
                    let (left, right) = (scaled(b, &self.slope(x, i), rest), scaled(b, &self.slope(y, i), t));
                    let both = sum(b, left, right);
                    let (u, v) = (self.part(b, x, i), self.part(b, y, i));
                    let span = b.sub(v, u);
                    let by_t = scaled(b, &self.slope(z, i), span);
                    sum(b, both, by_t)
                }
            })
            .collect()
    }
}

/// The slope of `r = op(x)`, a number, where x has the slope `dx`; `None` where it is flat.
pub(crate) fn unary_number(
    b: &mut Builder,
    op: Unary,
    x: Value,
    r: Value,
    dx: &[Option<Value>],
) -> Option<Slope> {
    let factor = match op {
        Unary::Negate => return Some(negated(b, dx)),
        // |x|' == x < 0 ? -1 : 1, one-sided at 0
        Unary::Abs => {
            let (zero, one, minus) = (b.float(0.0), b.float(1.0), b.float(-1.0));
            let is_negative = b.binary(Binary::Less, x, zero);
            b.select(is_negative, minus, one)
        }
        Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc => return None,
        // sqrt' == r/2 / x, which is 0 where x is not positive
        Unary::Sqrt => {
            let half = b.float(0.5);
            let half = b.mul(r, half);
            b.div(half, x)
        }
        Unary::Sin => b.unary(Unary::Cos, x),
        Unary::Cos => {
            let sine = b.unary(Unary::Sin, x);
            b.neg(sine)
        }
        // tan' == 1 / cos², which saturates
        Unary::Tan => {
            let cosine = b.unary(Unary::Cos, x);
            let square = b.mul(cosine, cosine);
            return Some(divided(b, dx, square));
        }
        // asin' == 1 / sqrt(1 - x²) inside, 0 where the argument is clamped
        Unary::Asin => inverse_sine(b, x),
        Unary::Acos => {
            let slope = inverse_sine(b, x);
            b.neg(slope)
        }
        // atan' == 1 / (1 + x²)
        Unary::Atan => {
            let (one, square) = (b.float(1.0), b.mul(x, x));
            let sum = b.add(square, one);
            return Some(divided(b, dx, sum));
        }
        Unary::Exp => r,
        Unary::Exp2 => {
            let factor = b.float(std::f64::consts::LN_2);
            b.mul(r, factor)
        }
        // log' == 1 / x, and 0 where the argument is raised
        Unary::Log => inverse_above(b, x, 1.0),
        Unary::Log2 => inverse_above(b, x, std::f64::consts::LOG2_E),
        // tanh' == 1 - r²
        Unary::Tanh => {
            let (one, square) = (b.float(1.0), b.mul(r, r));
            b.sub(one, square)
        }
        // It takes whole numbers, which do not move.
        Unary::PowerOfTwo | Unary::Exponent => return None,
        // x == r·2ⁿ, so r' == x'·r/x
        Unary::Mantissa => b.div(r, x),
        Unary::Not | Unary::Length | Unary::Normalize | Unary::Hash | Unary::ReduceAngle => {
            unreachable!("{op:?} does not work component by component")
        }
    };
    Some(scaled(b, dx, factor))
}

/// `1 / length(a)`, and 0 where that is 0.
pub(crate) fn inverse_length(b: &mut Builder, a: Value) -> Value {
    let (zero, one, length) = (b.float(0.0), b.float(1.0), b.unary(Unary::Length, a));
    let (is_long, inverse) = (b.binary(Binary::Less, zero, length), b.div(one, length));
    b.select(is_long, inverse, zero)
}

/// `|x| < 1 ? 1 / sqrt(1 - x²) : 0`
fn inverse_sine(b: &mut Builder, x: Value) -> Value {
    let (zero, one, square) = (b.float(0.0), b.float(1.0), b.mul(x, x));
    let (inside, rest) = (b.binary(Binary::Less, square, one), b.sub(one, square));
    let root = b.unary(Unary::Sqrt, rest);
    let inverse = b.div(one, root);
    b.select(inside, inverse, zero)
}

/// `x` is a normal number that is positive ? k / x : 0
fn inverse_above(b: &mut Builder, x: Value, k: f64) -> Value {
    let (zero, least, k) = (b.float(0.0), b.float(SMALLEST_NORMAL), b.float(k));
    let (above, inverse) = (b.binary(Binary::Less, least, x), b.div(k, x));
    b.select(above, inverse, zero)
}
