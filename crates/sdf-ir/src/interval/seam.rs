//! Choices without a jump: proofs that both sides agree where the condition changes.
//!
//! `if u < w { a } else { b }` changes sides where u == w. Both sides are written anew with one of the two in the
//! place of the other; where the builder's folding then makes them the same value, they agree there.

use crate::build::Builder;
use crate::program::{Binary, Function, Node, Parameter, Type, Unary, Value};
use rustc_hash::FxHashMap;

/// How deep and how far expressions are followed.
const DEPTH: usize = 200;
const NODES: usize = 2000;

/// The pairs of values that are equal where the condition of a `Select` or `If` changes, if the sides agree
/// wherever one of these pairs is equal.
pub(crate) fn seams(function: &Function, value: Value) -> Option<Vec<[Value; 2]>> {
    let (condition, sides): (Value, Vec<[Value; 2]>) = match function.node(value) {
        Node::Ternary(_, c, a, b) => (c, vec![[a, b]]),
        Node::If(c, then, otherwise) => {
            let [left, right] = [then, otherwise].map(|id| &function.region(id).results);
            (c, left.iter().zip(right).map(|(a, b)| [*a, *b]).collect())
        }
        _ => return None,
    };
    let mut pairs = Vec::new();
    atoms(function, condition, &mut pairs)?;
    let agree = |pair: &[Value; 2]| {
        let mut rewrite = Rewrite::new(function, *pair);
        sides.iter().all(|[a, b]| {
            let [a, b] = [a, b].map(|side| rewrite.value(*side, DEPTH));
            a.is_some() && a == b
        })
    };
    pairs.iter().all(agree).then_some(pairs)
}

/// The comparisons that a condition is made of. `None` where it is made of something else.
fn atoms(function: &Function, condition: Value, pairs: &mut Vec<[Value; 2]>) -> Option<()> {
    match function.node(condition) {
        Node::Bool(_) => Some(()),
        Node::Unary(Unary::Not, a) => atoms(function, a, pairs),
        Node::Binary(Binary::And | Binary::Or, a, b) => {
            atoms(function, a, pairs)?;
            atoms(function, b, pairs)
        }
        Node::Binary(Binary::Less | Binary::LessEqual, u, w) => {
            pairs.push([u, w]);
            Some(())
        }
        _ => None,
    }
}

/// Writes expressions anew, with the later of two values replaced by the earlier.
struct Rewrite<'f> {
    function: &'f Function,
    builder: Builder,
    /// What each value has become.
    made: FxHashMap<Value, Option<Value>>,
}

impl<'f> Rewrite<'f> {
    fn new(function: &'f Function, [u, w]: [Value; 2]) -> Rewrite<'f> {
        let mut rewrite =
            Rewrite { function, builder: Builder::new("", Vec::new()), made: FxHashMap::default() };
        let is_constant = |v: Value| matches!(function.node(v), Node::Float(_));
        let (from, to) = if is_constant(u) || (u < w && !is_constant(w)) { (w, u) } else { (u, w) };
        let made = rewrite.value(to, DEPTH);
        rewrite.made.insert(from, made);
        rewrite
    }

    fn value(&mut self, value: Value, depth: usize) -> Option<Value> {
        if let Some(made) = self.made.get(&value) {
            return *made;
        }
        if depth == 0 || self.made.len() > NODES {
            return None;
        }
        let mut operands = Vec::with_capacity(3);
        self.function.operands(value, |operand| operands.push(operand));
        let node = self.function.node(value);
        let is_opaque = matches!(node, Node::If(..) | Node::Loop(_) | Node::Result(..));
        let made = match node {
            Node::Float(bits) => Some(self.builder.float(f64::from_bits(bits))),
            Node::Bool(x) => Some(self.builder.bool(x)),
            _ if is_opaque || operands.is_empty() => self.opaque(value),
            Node::Call(callee, _) => {
                let arguments: Option<Vec<Value>> =
                    operands.iter().map(|operand| self.value(*operand, depth - 1)).collect();
                let types = self.function.types_of(value);
                match (arguments, &types[..]) {
                    (Some(arguments), [ty]) => Some(self.builder.call(callee, &[*ty], &arguments)[0]),
                    _ => None,
                }
            }
            _ => {
                let made: Option<Vec<Value>> =
                    operands.iter().map(|operand| self.value(*operand, depth - 1)).collect();
                made.map(|made| crate::copy::operation(&mut self.builder, node, &made))
            }
        };
        self.made.insert(value, made);
        made
    }

    /// A value of which nothing is known but that it is the same everywhere.
    fn opaque(&mut self, value: Value) -> Option<Value> {
        let ty: Type = self.function.type_of(value)?;
        Some(self.builder.add_parameter(Parameter { name: "".into(), ty, point: false }))
    }
}
