//! One point in `f64`, node by node: the shortest way from a program to its meaning, and what the tape is tested
//! against.

use crate::constant::Constant;
use crate::program::{Function, FunctionId, Node, Program, RegionId, Value};
use std::collections::HashMap;

/// The results of a function for these arguments and uniforms, as the language means them.
pub fn point(
    program: &Program,
    function: FunctionId,
    arguments: &[Constant],
    uniforms: &[Constant],
) -> Vec<Constant> {
    let mut walk = Walk { program, uniforms, globals: Vec::new() };
    if let Some(frame) = program.frame {
        walk.globals = walk.call(frame, &[]);
    }
    walk.call(function, arguments)
}

struct Walk<'p> {
    program: &'p Program,
    uniforms: &'p [Constant],
    globals: Vec<Constant>,
}

struct Frame<'p> {
    function: &'p Function,
    arguments: HashMap<RegionId, Vec<Constant>>,
    /// The value of each node so far; several for a tuple.
    values: HashMap<Value, Vec<Constant>>,
}

impl<'p> Walk<'p> {
    fn call(&self, id: FunctionId, arguments: &[Constant]) -> Vec<Constant> {
        let function = self.program.function(id);
        let mut frame = Frame { function, arguments: HashMap::new(), values: HashMap::new() };
        self.region(&mut frame, RegionId::ROOT, arguments.to_vec())
    }

    fn region(&self, frame: &mut Frame<'p>, id: RegionId, arguments: Vec<Constant>) -> Vec<Constant> {
        frame.arguments.insert(id, arguments);
        let region = frame.function.region(id);
        for value in &region.body {
            let computed = self.node(frame, *value);
            frame.values.insert(*value, computed);
        }
        region.results.iter().map(|v| self.value(frame, *v)).collect()
    }

    fn value(&self, frame: &Frame<'p>, value: Value) -> Constant {
        match frame.function.node(value) {
            Node::Float(bits) => Constant::Float(f64::from_bits(bits)),
            Node::Bool(b) => Constant::Bool(b),
            Node::Argument(region, index) => frame.arguments[&region][index as usize],
            Node::Uniform(index) => self.uniforms[index as usize],
            Node::Global(index) => self.globals[index as usize],
            _ => frame.values[&value][0],
        }
    }

    fn values(&self, frame: &Frame<'p>, values: &[Value]) -> Vec<Constant> {
        values.iter().map(|v| self.value(frame, *v)).collect()
    }

    fn node(&self, frame: &mut Frame<'p>, value: Value) -> Vec<Constant> {
        let function = frame.function;
        let at = |v: Value| self.value(frame, v);
        let compose = |parts: &[Value]| {
            let parts: Vec<f64> = parts.iter().map(|v| self.value(frame, *v).components()[0]).collect();
            Constant::from_components(&parts)
        };
        match function.node(value) {
            Node::Unary(op, a) => vec![Constant::unary(op, at(a))],
            Node::Binary(op, a, b) => vec![Constant::binary(op, at(a), at(b))],
            Node::Ternary(op, a, b, c) => vec![Constant::ternary(op, at(a), at(b), at(c))],
            Node::Compose2(x, y) => vec![compose(&[x, y])],
            Node::Compose3(x, y, z) => vec![compose(&[x, y, z])],
            Node::Component(a, index) => vec![Constant::Float(at(a).components()[index as usize])],
            Node::Call(callee, list) => self.call(callee, &self.values(frame, function.list(list))),
            Node::If(condition, then, otherwise) => {
                let side = if at(condition) == Constant::Bool(true) { then } else { otherwise };
                self.region(frame, side, Vec::new())
            }
            Node::Loop(repeat) => {
                let mut state = self.values(frame, function.list(repeat.initial));
                for round in 0..repeat.count {
                    if self.region(frame, repeat.until, state.clone()) == [Constant::Bool(true)] {
                        break;
                    }
                    let mut arguments = vec![Constant::Float(f64::from(round))];
                    arguments.extend(state);
                    state = self.region(frame, repeat.next, arguments);
                }
                state
            }
            Node::Result(tuple, index) => vec![frame.values[&tuple][index as usize]],
            Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_) => {
                vec![at(value)]
            }
        }
    }
}
