//! What an evaluation costs: counted, not measured.
//!
//! A scalar operation is one arithmetic result of a scalar: an addition of two vec3 counts three, a dot product of
//! two vec3 five. What only moves values (components, composition, constants, arguments) is free. Both arms of an
//! `If` count as the dearer one.
//!
//! An evaluation is a call of a function that [is marked](Function::is_evaluation) as one, from a function that is not
//! itself being evaluated: a distance, a distance with its gradient and a distance with a step count alike, and what such a
//! function calls in its turn does not count again.

use crate::program::{
    Binary, Function, FunctionId, Loop, Node, Program, RegionId, Ternary, Type, Unary, Value,
};

/// Scalar operations of one evaluation at most, with calls expanded and every loop run to its last round.
pub fn operations(program: &Program, function: FunctionId) -> u64 {
    total(program, function, &OPERATIONS)
}

/// The [`operations`] of the functions of a program that is being made: each is counted once.
#[derive(Debug, Default)]
pub struct Operations {
    totals: Vec<u64>,
}

impl Operations {
    /// Scalar operations of one evaluation of a function at most.
    pub fn of(&mut self, program: &Program, function: FunctionId) -> u64 {
        self.keep_up_with(program);
        self.totals[function.0 as usize]
    }

    /// The same of a function apart from the program, which may call those of the program.
    pub fn of_apart(&mut self, program: &Program, function: &Function) -> u64 {
        self.keep_up_with(program);
        region(function, RegionId::ROOT, &self.totals, &OPERATIONS)
    }

    fn keep_up_with(&mut self, program: &Program) {
        for function in &program.functions[self.totals.len()..] {
            let total = region(function, RegionId::ROOT, &self.totals, &OPERATIONS);
            self.totals.push(total);
        }
    }
}

/// [`operations`] with each loop's body counted once.
pub fn operations_without_loops(program: &Program, function: FunctionId) -> u64 {
    total(program, function, &Count { rounds: |count| u64::from(count.min(1)), ..OPERATIONS })
}

/// Loop iterations of one evaluation at most, over all loops, those of callees included.
pub fn iterations(program: &Program, function: FunctionId) -> u64 {
    total(program, function, &Count { of_node: iterations_of_node, ..OPERATIONS })
}

/// Evaluations of fields in one call of a function at most, with every loop run to its last round.
pub fn evaluations(program: &Program, function: FunctionId) -> u64 {
    let of_callee = |callee: &Function, inside: u64| if callee.is_evaluation() { 1 } else { inside };
    total(program, function, &Count { of_node: |_, _| 0, of_callee, rounds: u64::from })
}

/// What is counted.
struct Count {
    /// A node by itself.
    of_node: fn(&Function, Value) -> u64,
    /// A call of a function in which so much was counted.
    of_callee: fn(&Function, u64) -> u64,
    /// How often a loop's body counts.
    rounds: fn(u32) -> u64,
}

const OPERATIONS: Count =
    Count { of_node: operations_of_node, of_callee: |_, inside| inside, rounds: u64_of };

fn u64_of(count: u32) -> u64 {
    u64::from(count)
}

/// Callees stand before their callers, so each function is counted once, in order.
fn total(program: &Program, function: FunctionId, count: &Count) -> u64 {
    let mut totals: Vec<u64> = Vec::with_capacity(function.0 as usize + 1);
    for function in &program.functions[..function.0 as usize] {
        let inside = region(function, RegionId::ROOT, &totals, count);
        totals.push((count.of_callee)(function, inside));
    }
    region(program.function(function), RegionId::ROOT, &totals, count)
}

fn region(function: &Function, id: RegionId, callees: &[u64], count: &Count) -> u64 {
    let each = function.region(id).body.iter().map(|value| {
        let owned = match function.node(*value) {
            Node::Call(callee, _) => callees[callee.0 as usize],
            Node::If(_, then, otherwise) => {
                region(function, then, callees, count).max(region(function, otherwise, callees, count))
            }
            Node::Loop(it) => {
                let body = region(function, it.next, callees, count);
                // The condition is tested before each round and once more behind the last.
                let until = region(function, it.until, callees, count);
                (count.rounds)(it.count).saturating_mul(body.saturating_add(until)).saturating_add(until)
            }
            _ => 0,
        };
        owned.saturating_add((count.of_node)(function, *value))
    });
    each.fold(0, u64::saturating_add)
}

/// Each round of a loop is an iteration; those of loops inside are counted with its body.
fn iterations_of_node(function: &Function, value: Value) -> u64 {
    match function.node(value) {
        Node::Loop(Loop { count, .. }) => u64::from(count),
        _ => 0,
    }
}

/// The scalar operations of a node by itself, without callees and regions.
pub(crate) fn operations_of_node(function: &Function, value: Value) -> u64 {
    let size = |value: Value| function.type_of(value).map_or(1, Type::size) as u64;
    match function.node(value) {
        Node::Unary(op, a) => match op {
            // The products, their sum, the root, and the quotients.
            Unary::Length => 2 * size(a),
            Unary::Normalize => 3 * size(a),
            _ => size(a),
        },
        Node::Binary(op, a, _) => match op {
            Binary::Dot => 2 * size(a) - 1,
            Binary::Cross => 9,
            _ => size(value),
        },
        Node::Ternary(Ternary::Select, ..) => size(value),
        // Two products, a difference and a sum.
        Node::Ternary(Ternary::Mix, ..) => 4 * size(value),
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
        | Node::Result(..) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::{Operations, evaluations, iterations, operations, operations_without_loops};
    use crate::build::Builder;
    use crate::program::{Binary, Parameter, Program, RegionId, Type, Unary};

    #[test]
    fn loops_count_their_rounds_and_calls_their_callees() {
        let mut program = Program::default();
        let point = Parameter { name: "p".into(), ty: Type::Vec3, point: true };
        let mut b = Builder::new("callee", vec![point.clone()]);
        let p = b.argument(RegionId::ROOT, 0);
        let length = b.unary(Unary::Length, p);
        let callee = program.add(b.finish(vec![(length, "".into())]));
        assert_eq!(operations(&program, callee), 6);
        let mut counted = Operations::default();
        assert_eq!(counted.of(&program, callee), 6);
        let mut b = Builder::new("caller", vec![point]);
        let p = b.argument(RegionId::ROOT, 0);
        let first = b.call(callee, &[Type::Float], &[p])[0];
        let until = b.open_region(&[Type::Float]);
        let (state, one) = (b.argument(until, 0), b.float(1.0));
        let stop = b.binary(Binary::Less, state, one);
        b.close_region(vec![stop]);
        let next = b.open_region(&[Type::Float, Type::Float]);
        let (round, state) = (b.argument(next, 0), b.argument(next, 1));
        let q = b.mul(p, round);
        let d = b.call(callee, &[Type::Float], &[q])[0];
        let sum = b.add(state, d);
        b.close_region(vec![sum]);
        let last = b.repeat(10, &[first], until, next)[0];
        let caller = program.add(b.finish(vec![(last, "".into())]));
        // The call, ten rounds of test, product, call and sum, and the last test.
        assert_eq!(operations(&program, caller), 6 + 10 * (1 + 3 + 6 + 1) + 1);
        assert_eq!(counted.of(&program, caller), operations(&program, caller));
        assert_eq!(operations_without_loops(&program, caller), 6 + (1 + 3 + 6 + 1) + 1);
        assert_eq!(iterations(&program, caller), 10);
        assert_eq!(iterations(&program, callee), 0);
        // Calls of the callee count only if it is an evaluation; what it calls in its turn never does.
        assert_eq!(evaluations(&program, caller), 0);
        program.functions[callee.0 as usize].mark_evaluation();
        assert_eq!((evaluations(&program, caller), evaluations(&program, callee)), (1 + 10, 0));
        let mut b = Builder::new("outer", vec![Parameter { name: "p".into(), ty: Type::Vec3, point: true }]);
        let p = b.argument(RegionId::ROOT, 0);
        let twice = [b.call(caller, &[Type::Float], &[p])[0], b.call(callee, &[Type::Float], &[p])[0]];
        let sum = b.add(twice[0], twice[1]);
        let outer = program.add(b.finish(vec![(sum, "".into())]));
        assert_eq!(evaluations(&program, outer), 11 + 1);
        program.functions[caller.0 as usize].mark_evaluation();
        assert_eq!(evaluations(&program, outer), 1 + 1);
    }
}
