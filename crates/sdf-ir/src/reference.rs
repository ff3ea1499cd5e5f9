//! The plain meaning of a program, one node after the other in `f64`. For tests: the evaluators are elsewhere.

use crate::constant::Constant;
use crate::program::{Function, FunctionId, Loop, Node, Program, RegionId, Value};
use std::collections::HashMap;

/// The results of a function for these arguments. Uniforms have their defaults; there is no global.
pub(crate) fn evaluate(program: &Program, function: FunctionId, arguments: &[Constant]) -> Vec<Constant> {
    Evaluation::new(program, program.function(function)).run(RegionId::ROOT, arguments)
}

/// The results of a function that calls no other, and the largest number that any of its nodes had.
pub(crate) fn evaluate_alone(function: &Function, arguments: &[Constant]) -> (Vec<Constant>, f64) {
    let program = Program::default();
    let mut evaluation = Evaluation::new(&program, function);
    let results = evaluation.run(RegionId::ROOT, arguments);
    (results, evaluation.largest)
}

struct Evaluation<'a> {
    program: &'a Program,
    function: &'a Function,
    arguments: HashMap<RegionId, Vec<Constant>>,
    values: HashMap<Value, Vec<Constant>>,
    live: Vec<bool>,
    largest: f64,
}

impl<'a> Evaluation<'a> {
    fn new(program: &'a Program, function: &'a Function) -> Evaluation<'a> {
        Evaluation {
            program,
            function,
            arguments: HashMap::new(),
            values: HashMap::new(),
            live: crate::copy::live(function),
            largest: 0.0,
        }
    }

    fn run(&mut self, region: RegionId, arguments: &[Constant]) -> Vec<Constant> {
        self.arguments.insert(region, arguments.to_vec());
        for value in &self.function.region(region).body {
            if self.live[value.0 as usize] {
                let it = self.node(*value);
                let numbers = it.iter().flat_map(|c| c.components());
                self.largest = numbers.fold(self.largest, |m, x| m.max(x.abs()));
                self.values.insert(*value, it);
            }
        }
        self.all(&self.function.region(region).results)
    }

    fn node(&mut self, value: Value) -> Vec<Constant> {
        match self.function.node(value) {
            Node::Call(callee, list) => evaluate(self.program, callee, &self.all(self.function.list(list))),
            Node::If(c, then, otherwise) => {
                let chosen = if self.value(c) == Constant::Bool(true) { then } else { otherwise };
                self.run(chosen, &[])
            }
            Node::Loop(it) => self.repeat(it),
            Node::Result(tuple, index) => vec![self.values[&tuple][index as usize]],
            _ => vec![self.operation(value)],
        }
    }

    fn repeat(&mut self, it: Loop) -> Vec<Constant> {
        let mut state = self.all(self.function.list(it.initial));
        for round in 0..it.count {
            if self.run(it.until, &state)[0] == Constant::Bool(true) {
                break;
            }
            let mut arguments = vec![Constant::Float(f64::from(round))];
            arguments.append(&mut state);
            state = self.run(it.next, &arguments);
        }
        state
    }

    fn operation(&self, value: Value) -> Constant {
        let number = |v: Value| self.value(v).components()[0];
        match self.function.node(value) {
            Node::Unary(op, a) => Constant::unary(op, self.value(a)),
            Node::Binary(op, a, b) => Constant::binary(op, self.value(a), self.value(b)),
            Node::Ternary(op, a, b, c) => Constant::ternary(op, self.value(a), self.value(b), self.value(c)),
            Node::Compose2(x, y) => Constant::Vec2([x, y].map(number)),
            Node::Compose3(x, y, z) => Constant::Vec3([x, y, z].map(number)),
            Node::Component(a, index) => Constant::Float(self.value(a).components()[index as usize]),
            node => unreachable!("{node:?} is a leaf, or evaluated by the caller"),
        }
    }

    fn value(&self, value: Value) -> Constant {
        match self.function.node(value) {
            Node::Float(bits) => Constant::Float(f64::from_bits(bits)),
            Node::Bool(it) => Constant::Bool(it),
            Node::Argument(region, index) => self.arguments[&region][index as usize],
            Node::Uniform(index) => self.program.uniforms[index as usize].default,
            Node::Global(_) => unreachable!("no test has a frame"),
            _ => self.values[&value][0],
        }
    }

    fn all(&self, values: &[Value]) -> Vec<Constant> {
        values.iter().map(|v| self.value(*v)).collect()
    }
}
