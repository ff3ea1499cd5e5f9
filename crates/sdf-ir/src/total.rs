//! Programs that mean on hardware what they mean in the language.
//!
//! The operations of the language are total; those of hardware divide by zero, overflow in `length`, and have sines
//! that differ from driver to driver. [`legalise`] replaces every operation that is not the same everywhere by a
//! call of a function of basic operations, or puts a guard round it, except where the ranges of its operands show
//! that there is nothing to guard. Gradients are made before: a derivative never goes through a helper.

mod helpers;
mod range;

use crate::build::Builder;
use crate::copy::{self, Links};
use crate::program::{Binary, Function, FunctionId, Node, Program, RegionId, Ternary, Type, Unary, Value};
use helpers::{Helper, Target};
use range::{Range, Ranges};
use std::cell::RefCell;

/// Whether an operation may stand in a program that [`legalise`] has gone over.
pub fn is_basic(node: Node) -> bool {
    match node {
        Node::Unary(op, _) => is_basic_unary(op),
        Node::Binary(op, ..) => is_basic_binary(op),
        Node::Ternary(Ternary::Select | Ternary::Mix, ..) => true,
        Node::Float(_)
        | Node::Bool(_)
        | Node::Argument(..)
        | Node::Uniform(_)
        | Node::Global(_)
        | Node::Compose2(..)
        | Node::Compose3(..)
        | Node::Component(..)
        | Node::Call(..)
        | Node::If(..)
        | Node::Loop(_)
        | Node::Result(..) => true,
    }
}

fn is_basic_unary(op: Unary) -> bool {
    match op {
        Unary::Negate
        | Unary::Not
        | Unary::Abs
        | Unary::Sign
        | Unary::Floor
        | Unary::Ceil
        | Unary::Round
        | Unary::Trunc
        | Unary::Sqrt
        | Unary::Length
        | Unary::Hash
        | Unary::PowerOfTwo
        | Unary::Exponent
        | Unary::Mantissa
        | Unary::ReduceAngle => true,
        Unary::Normalize
        | Unary::Sin
        | Unary::Cos
        | Unary::Tan
        | Unary::Asin
        | Unary::Acos
        | Unary::Atan
        | Unary::Exp
        | Unary::Exp2
        | Unary::Log
        | Unary::Log2
        | Unary::Tanh => false,
    }
}

fn is_basic_binary(op: Binary) -> bool {
    match op {
        Binary::Add
        | Binary::Subtract
        | Binary::Multiply
        | Binary::Divide
        | Binary::Min
        | Binary::Max
        | Binary::Dot
        | Binary::Cross
        | Binary::Less
        | Binary::LessEqual
        | Binary::Equal
        | Binary::And
        | Binary::Or => true,
        Binary::Modulo | Binary::Power | Binary::Atan2 => false,
    }
}

/// The program in which every operation means on hardware what the language says. It is to be entered by its entry
/// or by a function that nothing calls: the others rely on what their callers pass. The functions keep their order,
/// not their ids.
pub fn legalise(program: &Program) -> Program {
    let ranges = Ranges::of(program);
    let target = RefCell::new(Target::like(program));
    let mut ids: Vec<FunctionId> = Vec::new();
    for (i, function) in program.functions.iter().enumerate() {
        let id = FunctionId(i as u32);
        let is_tiny = program.is_tiny;
        let raise = Raise { function: id, is_tiny, ranges: &ranges, ids: &ids, target: &target };
        let raised = raise.function(function);
        ids.push(target.borrow_mut().program.add(raised));
    }
    let mut target = target.into_inner().program;
    target.frame = program.frame.map(|id| ids[id.0 as usize]);
    target.entry = program.entry.map(|id| ids[id.0 as usize]);
    target
}

/// Copies one function, with other operations in the place of some.
struct Raise<'a> {
    function: FunctionId,
    /// Whether squares of lengths vanish.
    is_tiny: bool,
    ranges: &'a Ranges<'a>,
    /// What the functions before this one have become.
    ids: &'a [FunctionId],
    target: &'a RefCell<Target>,
}

impl Links for Raise<'_> {
    fn operation(&self, b: &mut Builder, node: Node, operands: &[Value]) -> Value {
        match (node, operands) {
            (Node::Unary(op, source), &[a]) => self.unary(b, op, a, self.range(source)),
            (Node::Binary(op, x, y), &[a, c]) => self.binary(b, op, [a, c], [self.range(x), self.range(y)]),
            _ => copy::operation(b, node, operands),
        }
    }

    fn call(&self, b: &mut Builder, callee: FunctionId, results: &[Type], arguments: &[Value]) -> Vec<Value> {
        b.call(self.ids[callee.0 as usize], results, arguments)
    }
}

impl Raise<'_> {
    fn function(&self, function: &Function) -> Function {
        let mut b = Builder::new(function.name.clone(), function.parameters.clone());
        b.set_line(function.line);
        b.set_doc(function.doc.clone());
        b.set_lipschitz(function.lipschitz());
        b.set_evaluation(function.is_evaluation());
        let arguments: Vec<Value> =
            (0..function.parameters.len()).map(|i| b.argument(RegionId::ROOT, i as u16)).collect();
        let results = copy::inline(&mut b, function, &arguments, self);
        b.finish(results.into_iter().zip(function.result_names.iter().cloned()).collect())
    }

    fn range(&self, value: Value) -> Range {
        self.ranges.get(self.function, value)
    }

    /// A call of a helper.
    fn help(&self, b: &mut Builder, helper: Helper, arguments: &[Value]) -> Value {
        let callee = self.target.borrow_mut().helper(helper);
        b.call(callee, &[helper.signature().1], arguments)[0]
    }

    fn unary(&self, b: &mut Builder, op: Unary, a: Value, range: Range) -> Value {
        let each = |b: &mut Builder, helper: Helper| {
            self.each(b, &[a], |this, b, parts| this.help(b, helper, parts))
        };
        match op {
            Unary::Sin => self.each(b, &[a], |this, b, parts| {
                let both = this.help(b, Helper::SineCosine, parts);
                b.component(both, 0)
            }),
            Unary::Cos => self.each(b, &[a], |this, b, parts| {
                let both = this.help(b, Helper::SineCosine, parts);
                b.component(both, 1)
            }),
            Unary::Tan => each(b, Helper::Tangent),
            Unary::Asin => each(b, Helper::ArcSine),
            Unary::Acos => each(b, Helper::ArcCosine),
            Unary::Atan => each(b, Helper::ArcTangent),
            Unary::Exp => each(b, Helper::Exponential),
            Unary::Exp2 => each(b, Helper::Exponential2),
            Unary::Log => each(b, Helper::Logarithm),
            Unary::Log2 => each(b, Helper::Logarithm2),
            Unary::Tanh => each(b, Helper::HyperbolicTangent),
            Unary::Sqrt if range.lo < 0.0 => {
                let zero = b.float(0.0);
                let zero = b.splat(zero, b.ty(a));
                let a = b.max(a, zero);
                b.unary(op, a)
            }
            Unary::Length if self.is_tiny || !squares_fit(range) => match b.ty(a) {
                Type::Vec2 => self.help(b, Helper::Length2, &[a]),
                Type::Vec3 => self.help(b, Helper::Length3, &[a]),
                // |x| of a number overflows nowhere.
                _ => b.unary(Unary::Abs, a),
            },
            // Drivers have other ways to a vector of length one, which round in other places.
            Unary::Normalize => match b.ty(a) {
                Type::Vec2 => self.help(b, Helper::Direction2, &[a]),
                Type::Vec3 => self.help(b, Helper::Direction3, &[a]),
                _ => b.unary(Unary::Sign, a),
            },
            _ => b.unary(op, a),
        }
    }

    fn binary(&self, b: &mut Builder, op: Binary, operands: [Value; 2], ranges: [Range; 2]) -> Value {
        let [x, y] = operands;
        let each = |b: &mut Builder, helper: Helper| {
            self.each(b, &operands, |this, b, parts| this.help(b, helper, parts))
        };
        match op {
            Binary::Divide if !quotient_fits(ranges) => each(b, Helper::Quotient),
            // a % b == a - b*floor(a/b)
            Binary::Modulo if quotient_fits(ranges) && ranges[0].most() < 1e37 && ranges[1].most() < 1e37 => {
                self.each(b, &operands, |_, b, parts| {
                    let ratio = b.div(parts[0], parts[1]);
                    let whole = b.unary(Unary::Floor, ratio);
                    let multiple = b.mul(parts[1], whole);
                    let rest = b.sub(parts[0], multiple);
                    helpers::in_period(b, rest, parts[1])
                })
            }
            Binary::Modulo => each(b, Helper::Remainder),
            Binary::Power => each(b, Helper::Power),
            Binary::Atan2 => each(b, Helper::Angle),
            _ => b.binary(op, x, y),
        }
    }

    /// Does to each component, or to the floats themselves, what `one` does; a float stands for a vector of equal
    /// components.
    fn each(
        &self,
        b: &mut Builder,
        operands: &[Value],
        one: impl Fn(&Self, &mut Builder, &[Value]) -> Value,
    ) -> Value {
        let size = operands.iter().map(|v| b.ty(*v).size()).max().unwrap_or(1);
        let mut parts = Vec::with_capacity(size);
        for i in 0..size {
            let at: Vec<Value> = operands.iter().map(|v| b.component(*v, i)).collect();
            parts.push(one(self, b, &at));
        }
        b.compose(&parts)
    }
}

/// Whether the sum of three squares is a number.
fn squares_fit(range: Range) -> bool {
    range.most() <= 1e19
}

/// Whether the quotient is a number whenever both operands are. Ranges are wider than what they hold, so a divisor
/// of at least 1 is one of at least almost 1.
fn quotient_fits([x, y]: [Range; 2]) -> bool {
    y.least() >= 0.999_99 || (y.least() > 0.0 && x.most() / y.least() < 3e38)
}
