//! How much a number depends on others that the same function has computed: reverse differentiation of the code
//! between them.
//!
//! A composed field mixes the materials of the fields that it sampled by their share in its distance. The shares
//! are the adjoints of the samples: each sample counts as a variable of its own, whatever it was made from.

use crate::build::Builder;
use crate::gradient::derivative::{inverse_length, unary_number};
use crate::program::{Binary, Node, RegionId, Ternary, Unary, Value};
use rustc_hash::{FxHashMap, FxHashSet};

/// The derivative of the float `of` by each of these floats, which count as independent of each other; `None` where
/// it is zero whatever they are. A tie of `min` or `max` goes to the first.
///
/// Between them may stand operations of the function's own region. A call, branch or loop that takes one of them
/// and yields what `of` is made from must have been inlined, or must be among `with_respect_to` itself.
pub fn adjoints(builder: &mut Builder, of: Value, with_respect_to: &[Value]) -> Vec<Option<Value>> {
    let body = builder.function().region(RegionId::ROOT).body.clone();
    let sources: FxHashSet<Value> = with_respect_to.iter().copied().collect();
    let depends = depends(builder, &body, &sources);
    let one = builder.float(1.0);
    let mut sweep = Sweep { depends, adjoints: FxHashMap::from_iter([(of, vec![Some(one)])]) };
    for value in body.iter().rev().filter(|value| !sources.contains(value)) {
        if sweep.depends.contains(value)
            && let Some(adjoint) = sweep.adjoints.remove(value)
        {
            sweep.node(builder, *value, &adjoint);
        }
    }
    with_respect_to.iter().map(|value| sweep.adjoints.get(value).and_then(|adjoint| adjoint[0])).collect()
}

/// The nodes that are made from one of `sources`, those included.
fn depends(b: &Builder, body: &[Value], sources: &FxHashSet<Value>) -> FxHashSet<Value> {
    let mut depends = sources.clone();
    for value in body {
        let mut found = false;
        b.function().operands(*value, |operand| found |= depends.contains(&operand));
        if found {
            depends.insert(*value);
        }
    }
    depends
}

struct Sweep {
    /// What the adjoints have to pass through.
    depends: FxHashSet<Value>,
    /// Those of the components of each value, as far as they have arrived.
    adjoints: FxHashMap<Value, Vec<Option<Value>>>,
}

impl Sweep {
    /// Adds `amount` to the adjoint of a component of an operand; a float has one component, wherever it is used.
    fn add(&mut self, b: &mut Builder, operand: Value, component: usize, amount: Value) {
        let is_zero = b.constant_of(amount).is_some_and(|c| c.components() == [0.0]);
        if is_zero || !self.depends.contains(&operand) {
            return;
        }
        let size = b.ty(operand).size();
        let slot =
            &mut self.adjoints.entry(operand).or_insert_with(|| vec![None; size])[component.min(size - 1)];
        *slot = Some(match *slot {
            Some(before) => b.add(before, amount),
            None => amount,
        });
    }

    /// Passes the adjoint of a node on to its operands.
    fn node(&mut self, b: &mut Builder, value: Value, adjoint: &[Option<Value>]) {
        match b.node(value) {
            Node::Compose2(x, y) => self.parts(b, &[x, y], adjoint),
            Node::Compose3(x, y, z) => self.parts(b, &[x, y, z], adjoint),
            Node::Component(vector, index) => {
                if let Some(amount) = adjoint[0] {
                    self.add(b, vector, index as usize, amount);
                }
            }
            Node::Unary(op, x) => self.unary(b, op, value, x, adjoint),
            Node::Binary(op @ (Binary::Dot | Binary::Cross), x, y) => self.product(b, op, x, y, adjoint),
            Node::Binary(op, x, y) => self.each(b, adjoint, |sweep, b, i, amount| {
                sweep.binary(b, op, [value, x, y], i, amount);
            }),
            Node::Ternary(op, x, y, z) => self.each(b, adjoint, |sweep, b, i, amount| {
                sweep.ternary(b, op, [x, y, z], i, amount);
            }),
            Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_) => {
                unreachable!("leaves stand in no body")
            }
            Node::Call(..) | Node::If(..) | Node::Loop(_) | Node::Result(..) => {
                panic!("a call, branch or loop stands between a number and what it is differentiated by")
            }
        }
    }

    fn each(
        &mut self,
        b: &mut Builder,
        adjoint: &[Option<Value>],
        pass: impl Fn(&mut Sweep, &mut Builder, usize, Value),
    ) {
        for (i, amount) in adjoint.iter().enumerate() {
            if let Some(amount) = *amount {
                pass(self, b, i, amount);
            }
        }
    }

    fn parts(&mut self, b: &mut Builder, parts: &[Value], adjoint: &[Option<Value>]) {
        self.each(b, adjoint, |sweep, b, i, amount| sweep.add(b, parts[i], 0, amount));
    }

    fn unary(&mut self, b: &mut Builder, op: Unary, value: Value, x: Value, adjoint: &[Option<Value>]) {
        match op {
            // x̄ᵢ == r̄·xᵢ / r
            Unary::Length => self.each(b, adjoint, |sweep, b, _, amount| {
                let share = b.div(amount, value);
                for (i, part) in b.components(x).into_iter().enumerate() {
                    let amount = b.mul(part, share);
                    sweep.add(b, x, i, amount);
                }
            }),
            // x̄ᵢ == (r̄ᵢ - rᵢ·Σ rⱼ·r̄ⱼ) / length(x)
            Unary::Normalize => {
                let (inverse, zero, parts) = (inverse_length(b, x), b.float(0.0), b.components(value));
                let along = adjoint.iter().zip(&parts).fold(zero, |sum, (amount, part)| {
                    let product = b.mul(amount.unwrap_or(zero), *part);
                    b.add(sum, product)
                });
                for (i, part) in parts.into_iter().enumerate() {
                    let along = b.mul(part, along);
                    let across = b.sub(adjoint[i].unwrap_or(zero), along);
                    let amount = b.mul(across, inverse);
                    self.add(b, x, i, amount);
                }
            }
            Unary::ReduceAngle => {
                if let Some(amount) = adjoint[0] {
                    self.add(b, x, 0, amount);
                }
            }
            Unary::Hash | Unary::Not => {}
            _ => self.each(b, adjoint, |sweep, b, i, amount| {
                let (part, result) = (b.component(x, i), b.component(value, i));
                // The derivative of a number passes slopes forward and adjoints backward alike: it scales them.
                if let Some([Some(amount)]) = unary_number(b, op, part, result, &[Some(amount)]).as_deref() {
                    sweep.add(b, x, i, *amount);
                }
            }),
        }
    }

    fn product(&mut self, b: &mut Builder, op: Binary, x: Value, y: Value, adjoint: &[Option<Value>]) {
        let (left, right) = (b.components(x), b.components(y));
        if op == Binary::Dot {
            // x̄ᵢ == r̄·yᵢ, ȳᵢ == r̄·xᵢ
            let Some(amount) = adjoint[0] else { return };
            for i in 0..left.len() {
                let (to_left, to_right) = (b.mul(amount, right[i]), b.mul(amount, left[i]));
                self.add(b, x, i, to_left);
                self.add(b, y, i, to_right);
            }
            return;
        }
        // x̄ == y × r̄, ȳ == r̄ × x
        for (k, (i, j)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
            let Some(amount) = adjoint[k] else { continue };
            let minus = b.neg(amount);
            for (operand, component, amount, other) in [
                (x, i, amount, right[j]),
                (y, j, amount, left[i]),
                (x, j, minus, right[i]),
                (y, i, minus, left[j]),
            ] {
                let amount = b.mul(amount, other);
                self.add(b, operand, component, amount);
            }
        }
    }

    /// Component i of `r = op(x, y)`, with the adjoint `a`.
    fn binary(&mut self, b: &mut Builder, op: Binary, [r, x, y]: [Value; 3], i: usize, a: Value) {
        let (u, v, w, zero) = (b.component(x, i), b.component(y, i), b.component(r, i), b.float(0.0));
        let (to_x, to_y) = match op {
            Binary::Add => (a, a),
            Binary::Subtract => (a, b.neg(a)),
            Binary::Multiply => (b.mul(a, v), b.mul(a, u)),
            // (x/y)' == (x' - r·y') / y
            Binary::Divide => {
                let share = b.div(a, v);
                let product = b.mul(share, w);
                (share, b.neg(product))
            }
            // (x - y·floor(x/y))' == x' - y'·floor(x/y)
            Binary::Modulo => {
                let quotient = b.div(u, v);
                let whole = b.unary(Unary::Floor, quotient);
                let product = b.mul(a, whole);
                (a, b.neg(product))
            }
            Binary::Min => {
                let first = b.binary(Binary::LessEqual, u, v);
                (b.select(first, a, zero), b.select(first, zero, a))
            }
            Binary::Max => {
                let first = b.binary(Binary::LessEqual, v, u);
                (b.select(first, a, zero), b.select(first, zero, a))
            }
            // (x^y)' == (y·r/x)·x' + (r·log|x|)·y'
            Binary::Power => {
                let (product, magnitude) = (b.mul(v, w), b.unary(Unary::Abs, u));
                let (by_base, log) = (b.div(product, u), b.unary(Unary::Log, magnitude));
                let by_exponent = b.mul(w, log);
                (b.mul(a, by_base), b.mul(a, by_exponent))
            }
            // atan2(x, y)' == (y·x' - x·y') / (x² + y²)
            Binary::Atan2 => {
                let (uu, vv) = (b.mul(u, u), b.mul(v, v));
                let square = b.add(uu, vv);
                let (by_x, by_y) = (b.div(v, square), b.div(u, square));
                let to_y = b.mul(a, by_y);
                (b.mul(a, by_x), b.neg(to_y))
            }
            Binary::Less | Binary::LessEqual | Binary::Equal | Binary::And | Binary::Or => return,
            Binary::Dot | Binary::Cross => unreachable!("{op:?} does not work component by component"),
        };
        self.add(b, x, i, to_x);
        self.add(b, y, i, to_y);
    }

    fn ternary(&mut self, b: &mut Builder, op: Ternary, [x, y, z]: [Value; 3], i: usize, a: Value) {
        let (zero, one) = (b.float(0.0), b.float(1.0));
        match op {
            Ternary::Select => {
                let (to_y, to_z) = (b.select(x, a, zero), b.select(x, zero, a));
                self.add(b, y, i, to_y);
                self.add(b, z, i, to_z);
            }
            // mix(x, y, t)' == x'·(1 - t) + y'·t + t'·(y - x)
            Ternary::Mix => {
                let (u, v, t) = (b.component(x, i), b.component(y, i), b.component(z, i));
                let (rest, span) = (b.sub(one, t), b.sub(v, u));
                for (operand, factor) in [(x, rest), (y, t), (z, span)] {
                    let amount = b.mul(a, factor);
                    self.add(b, operand, i, amount);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::adjoints;
    use crate::build::Builder;
    use crate::constant::Constant;
    use crate::program::{Binary, Parameter, RegionId, Ternary, Type, Unary, Value};
    use crate::reference::evaluate_alone;

    /// A builder with three floats as parameters.
    fn start() -> (Builder, [Value; 3]) {
        let float = |name: &str| Parameter { name: name.into(), ty: Type::Float, point: false };
        let mut b = Builder::new("shares", ["x", "y", "z"].map(float).to_vec());
        let arguments = [0, 1, 2].map(|i| b.argument(RegionId::ROOT, i));
        (b, arguments)
    }

    /// Fails where the adjoints of what is made from three numbers differ from what differences tell.
    fn check(make: impl Fn(&mut Builder, [Value; 3]) -> Value) {
        let (mut b, variables) = start();
        let result = make(&mut b, variables);
        let zero = b.float(0.0);
        let shares = adjoints(&mut b, result, &variables);
        let results = std::iter::once(result).chain(shares.into_iter().map(|share| share.unwrap_or(zero)));
        let function = b.finish(results.map(|r| (r, "".into())).collect());
        let at = |point: [f64; 3]| -> Vec<f64> {
            let (results, _) = evaluate_alone(&function, &point.map(Constant::Float));
            results.iter().map(|c| c.components()[0]).collect()
        };
        for point in [[0.31, 0.72, 0.55], [0.83, 0.24, 0.47], [0.12, 0.36, 0.91]] {
            let h = 1e-5;
            for axis in 0..3 {
                let [mut left, mut right] = [point; 2];
                left[axis] -= h;
                right[axis] += h;
                let expected = (at(right)[0] - at(left)[0]) / (2.0 * h);
                let found = at(point)[1 + axis];
                let close = (found - expected).abs() <= 1e-6 * (1.0 + expected.abs());
                assert!(close, "by {axis} at {point:?}: {found}, not {expected}\n{function}");
            }
        }
    }

    #[test]
    fn a_bound_takes_one_of_two() {
        for op in [Binary::Min, Binary::Max] {
            let (mut b, [x, y, z]) = start();
            let bound = b.binary(op, x, y);
            let shares = adjoints(&mut b, bound, &[x, y, z]);
            let (one, zero) = (b.float(1.0), b.float(0.0));
            let first = if op == Binary::Min { (x, y) } else { (y, x) };
            let first = b.binary(Binary::LessEqual, first.0, first.1);
            let expected = [Some(b.select(first, one, zero)), Some(b.select(first, zero, one)), None];
            assert_eq!(shares, expected);
        }
    }

    #[test]
    fn what_counts_as_a_variable_is_not_looked_into() {
        let (mut b, [x, ..]) = start();
        let sine = b.unary(Unary::Sin, x);
        let twice = b.add(sine, x);
        let one = b.float(1.0);
        assert_eq!(adjoints(&mut b, twice, &[sine, x]), [Some(one), Some(one)]);
        assert_eq!(adjoints(&mut b, sine, &[sine]), [Some(one)]);
    }

    #[test]
    fn every_operation_passes_its_adjoint_on() {
        use Unary::*;
        for op in [
            Negate, Abs, Sign, Floor, Ceil, Trunc, Sqrt, Sin, Cos, Tan, Asin, Acos, Atan, Exp, Exp2, Log,
            Log2, Tanh,
        ] {
            check(|b, [x, y, _]| {
                let product = b.mul(x, y);
                b.unary(op, product)
            });
        }
        for op in [Length, Normalize, Sin] {
            check(|b, parts| {
                let vector = b.compose(&parts);
                let it = b.unary(op, vector);
                let last = if op == Length { 0 } else { 2 };
                let (first, last) = (b.component(it, 0), b.component(it, last));
                b.mul(first, last)
            });
        }
        for op in [
            Binary::Add,
            Binary::Subtract,
            Binary::Multiply,
            Binary::Divide,
            Binary::Modulo,
            Binary::Min,
            Binary::Max,
            Binary::Power,
            Binary::Atan2,
        ] {
            check(|b, [x, y, z]| {
                let inner = b.binary(op, x, y);
                b.binary(op, z, inner)
            });
        }
        for op in [Binary::Dot, Binary::Cross] {
            check(|b, [x, y, z]| {
                let (u, v) = (b.compose(&[x, y, z]), b.compose(&[y, z, x]));
                let it = b.binary(op, u, v);
                let (first, last) = (b.component(it, 0), b.component(it, 2));
                b.mul(first, last)
            });
        }
        check(|b, [x, y, z]| b.ternary(Ternary::Mix, x, y, z));
        check(|b, [x, y, z]| {
            let condition = b.binary(Binary::Less, x, y);
            let (u, v) = (b.compose(&[x, z]), b.compose(&[z, y]));
            let it = b.select(condition, u, v);
            b.unary(Length, it)
        });
    }

    #[test]
    fn the_shares_of_a_blend_are_its_weights() {
        // min(x, y) - h²·k/4 with h = max(k - |x - y|, 0)/k, for k = 0.8.
        check(|b, [x, y, _]| {
            let (k, zero, factor) = (b.float(0.8), b.float(0.0), b.float(1.0 / 3.2));
            let difference = b.sub(x, y);
            let distance = b.unary(Unary::Abs, difference);
            let rest = b.sub(k, distance);
            let h = b.max(rest, zero);
            let square = b.mul(h, h);
            let (nearer, bulge) = (b.min(x, y), b.mul(square, factor));
            b.sub(nearer, bulge)
        });
    }
}
