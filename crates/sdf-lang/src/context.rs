//! The functions that are open while a scene is elaborated, and arithmetic on numbers across them.
//!
//! Depth 0 is the frame: what depends on uniforms alone is computed there, once per frame. Each deeper context is
//! a function of the program. An operation is carried out in the outermost context that knows all its operands:
//! static ones are folded in `f64`, those of a frame land in the frame function, and what a function computes from
//! its parameters alone is computed by its caller. A value of an outer context that meets one of an inner context
//! becomes a parameter of every function between.

use crate::value::{Number, Repr};
use rustc_hash::FxHashMap;
use sdf_ir::build::OpenRegions;
use sdf_ir::cost::Operations;
use sdf_ir::hash::MixMap;
use sdf_ir::interval::{Angle, Axis};
use sdf_ir::{
    Binary, Builder, Constant, Function, FunctionId, Global, Limit, Node, Parameter, Program, RegionId,
    Rotation, Ternary, Type, Unary,
};
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::rc::Rc;
use std::sync::Arc;

/// An operation of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Op {
    Unary(Unary),
    Binary(Binary),
    Ternary(Ternary),
    /// A vector of two or three floats.
    Compose,
    /// A component of a vector.
    Component(u8),
}

/// A function that is being built.
struct Context {
    builder: Builder,
    /// The parameters that stand for values of outer contexts.
    imports: FxHashMap<u64, sdf_ir::Value>,
    /// What the caller passes: one value of its own for each parameter.
    arguments: Vec<sdf_ir::Value>,
    /// What tells it from all others.
    serial: u32,
}

/// A function that was put aside.
pub(crate) struct Aside(Context);

/// The open functions, and the program that the finished ones are in.
pub(crate) struct Contexts {
    pub program: Program,
    stack: Vec<Context>,
    finished: MixMap<Function, FunctionId>,
    /// Which global a node of the frame is.
    globals: FxHashMap<sdf_ir::Value, u16>,
    global_values: Vec<sdf_ir::Value>,
    /// Whether the function that is open outermost is one that the frame calls: it takes all it needs as arguments.
    frame_calls: bool,
    /// Nodes made in functions that are finished, for the limit on a program's size.
    pub nodes: usize,
    /// How many functions were opened so far.
    opened: u32,
    operations: Operations,
}

/// Where a number can be used: in the innermost function, inside the branches and loops that are open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Scope {
    function: u32,
    region: RegionId,
    region_of_frame: RegionId,
}

impl Scope {
    /// No function is open, and no branch or loop of the frame: the items of the file are evaluated.
    pub const FILE: Scope = Scope { function: 0, region: RegionId::ROOT, region_of_frame: RegionId::ROOT };
}

impl Contexts {
    pub fn new() -> Contexts {
        Contexts {
            program: Program::default(),
            stack: vec![Context {
                builder: Builder::new("frame", Vec::new()),
                imports: FxHashMap::default(),
                arguments: Vec::new(),
                serial: 0,
            }],
            finished: MixMap::default(),
            globals: FxHashMap::default(),
            global_values: Vec::new(),
            frame_calls: false,
            nodes: 0,
            opened: 0,
            operations: Operations::default(),
        }
    }

    /// How many functions are open besides the frame.
    pub fn depth(&self) -> u32 {
        (self.stack.len() - 1) as u32
    }

    /// Where numbers that are made now can be used.
    pub fn scope(&self) -> Scope {
        let innermost = self.stack.last().expect("the frame is always open");
        Scope {
            function: innermost.serial,
            region: innermost.builder.open_region_id(),
            region_of_frame: self.stack[0].builder.open_region_id(),
        }
    }

    /// Whether the function of a scope is still open.
    pub fn is_open(&self, scope: &Scope) -> bool {
        self.stack.iter().any(|context| context.serial == scope.function)
    }

    /// The function that is open innermost.
    pub fn builder(&mut self) -> &mut Builder {
        &mut self.stack.last_mut().expect("the frame is always open").builder
    }

    /// The frame as far as it is made.
    pub fn frame(&self) -> &Function {
        self.stack[0].builder.function()
    }

    /// Leaves the branches and loops of the frame that are being made, so that what follows lands before them.
    pub fn leave_frame_regions(&mut self) -> OpenRegions {
        self.stack[0].builder.leave_regions()
    }

    /// Goes on with what was left.
    pub fn return_to_frame_regions(&mut self, regions: OpenRegions) {
        self.stack[0].builder.return_to(regions);
    }

    // ---- functions

    /// Opens a function.
    pub fn open(&mut self, name: &Arc<str>, line: Option<u32>) {
        let mut builder = Builder::new(name.clone(), Vec::new());
        builder.set_line(line);
        self.opened += 1;
        let (imports, arguments) = (FxHashMap::default(), Vec::new());
        self.stack.push(Context { builder, imports, arguments, serial: self.opened });
    }

    /// Says whether the frame calls the functions that are opened from now on.
    pub fn set_frame_calls(&mut self, frame_calls: bool) {
        self.frame_calls = frame_calls;
    }

    /// Whether the frame calls the functions that are open.
    pub fn frame_calls(&self) -> bool {
        self.frame_calls
    }

    /// Says what the innermost function is.
    pub fn describe(&mut self, doc: Option<Arc<str>>) {
        self.builder().set_doc(doc);
    }

    /// Gives the innermost function a parameter for which its caller passes `argument`.
    pub fn parameter(&mut self, name: &Arc<str>, argument: &Number, point: bool) -> Number {
        let depth = self.depth();
        let outside = self.import(argument, depth - 1);
        let context =
            self.stack.last_mut().expect("each function that is closed or added to was opened before");
        let value = context.builder.add_parameter(Parameter { name: name.clone(), ty: argument.ty, point });
        context.arguments.push(outside);
        self.local(depth, value, argument.ty)
    }

    /// A parameter of the innermost function that no caller fills in: it is an entry.
    pub fn entry_parameter(&mut self, name: &str, ty: Type) -> Number {
        let context =
            self.stack.last_mut().expect("each function that is closed or added to was opened before");
        let value = context.builder.add_parameter(Parameter { name: Arc::from(name), ty, point: false });
        let depth = self.depth();
        self.local(depth, value, ty)
    }

    /// How a function that is about to be opened, or just was, sees a number of its caller.
    pub fn seen_from_inside(&mut self, name: &Arc<str>, number: &Number, key: u64) -> Number {
        if number.is_local() {
            return self.parameter(name, number, false);
        }
        let depth = self.depth() - 1;
        Number {
            ty: number.ty,
            key,
            name: Some(name.clone()),
            repr: Repr::Outer(depth, Rc::new(number.clone())),
        }
    }

    /// Closes the innermost function, and calls it from the one round it.
    pub fn close(&mut self, results: &[(Number, Arc<str>)]) -> Vec<Number> {
        let depth = self.depth();
        let values: Vec<_> = results.iter().map(|(n, name)| (self.import(n, depth), name.clone())).collect();
        let types: Vec<Type> = results.iter().map(|(n, _)| n.ty).collect();
        let (id, arguments) = self.finish(values);
        self.call(id, &types, &arguments)
    }

    /// Closes the innermost function; returns it and what its caller must pass.
    pub fn finish(&mut self, results: Vec<(sdf_ir::Value, Arc<str>)>) -> (FunctionId, Vec<sdf_ir::Value>) {
        let context = self.stack.pop().expect("each function that is closed or added to was opened before");
        self.nodes += context.builder.function().node_count();
        let function = context.builder.finish(results);
        let id = match self.finished.get(&function) {
            Some(id) => *id,
            None => {
                let id = self.program.add(function.clone());
                self.finished.insert(function, id);
                id
            }
        };
        (id, context.arguments)
    }

    /// Closes the innermost function without adding it to the program.
    pub fn finish_apart(&mut self, results: Vec<sdf_ir::Value>) -> (Function, Vec<sdf_ir::Value>) {
        let context = self.stack.pop().expect("each function that is closed or added to was opened before");
        let results = results.into_iter().map(|v| (v, Arc::from(""))).collect();
        (context.builder.finish(results), context.arguments)
    }

    /// Forgets the innermost function.
    pub fn discard(&mut self) {
        let context = self.stack.pop().expect("each function that is closed or added to was opened before");
        self.nodes += context.builder.function().node_count();
    }

    /// A call from the innermost function.
    pub fn call(&mut self, id: FunctionId, types: &[Type], arguments: &[sdf_ir::Value]) -> Vec<Number> {
        let depth = self.depth();
        let values = self.builder().call(id, types, arguments);
        values.into_iter().zip(types).map(|(v, ty)| self.local(depth, v, *ty)).collect()
    }

    /// A parameter of the innermost function for which its caller passes `outside`; never shared.
    pub fn stand_in(&mut self, outside: sdf_ir::Value) -> sdf_ir::Value {
        let context =
            self.stack.last_mut().expect("each function that is closed or added to was opened before");
        context.arguments.push(outside);
        context.builder.add_parameter(Parameter { name: Arc::from("d"), ty: Type::Float, point: false })
    }

    /// Whether a number is a node of the innermost function.
    pub fn is_innermost(&self, number: &Number) -> bool {
        home(&number.repr) == Some(self.depth())
    }

    /// Puts the innermost function aside, so that what follows lands in the one round it.
    pub fn set_aside(&mut self) -> Aside {
        Aside(self.stack.pop().expect("each function that is closed or added to was opened before"))
    }

    /// Makes a function that was put aside the innermost again.
    pub fn take_up(&mut self, aside: Aside) {
        self.stack.push(aside.0);
    }

    /// The function that a number is a call of, and its arguments, if its first argument is `point`.
    pub fn call_of(&mut self, number: &Number, point: &Number) -> Option<(FunctionId, Vec<sdf_ir::Value>)> {
        if !self.is_innermost(number) {
            return None;
        }
        let (value, point) = (self.value(number), self.value(point));
        let function = self.builder().function();
        match function.node(value) {
            Node::Call(id, list) if function.list(list).first() == Some(&point) => {
                Some((id, function.list(list).to_vec()))
            }
            _ => None,
        }
    }

    /// The function that a number is a call of, if the point is all that it takes.
    pub fn is_call_at(&mut self, number: &Number, point: &Number) -> Option<FunctionId> {
        self.call_of(number, point).filter(|(_, arguments)| arguments.len() == 1).map(|(id, _)| id)
    }

    /// The frame function so far.
    pub fn frame_builder(&self) -> &Builder {
        &self.stack[0].builder
    }

    /// What is being built of the open function at a depth, and what tells that function from all others.
    pub fn open_builder(&self, depth: u32) -> Option<(&Builder, u32)> {
        self.stack.get(depth as usize).map(|context| (&context.builder, context.serial))
    }

    /// The nodes of the frame that are globals of the program, in order.
    pub fn global_values(&self) -> &[sdf_ir::Value] {
        &self.global_values
    }

    /// How many operations a function takes that was finished apart from the program.
    pub fn operations_apart(&mut self, function: &Function) -> u64 {
        self.operations.of_apart(&self.program, function)
    }

    /// How many operations the function takes that a number is a call of; 0 where it is none.
    pub fn operations(&mut self, number: &Number) -> u64 {
        let (depth, value) = match number.repr {
            Repr::Local(depth, value) => (depth, value),
            Repr::Frame(value) => (0, value),
            Repr::Static(_) | Repr::Outer(..) => return 0,
        };
        match self.stack[depth as usize].builder.node(value) {
            Node::Call(id, _) => self.operations.of(&self.program, id),
            _ => 0,
        }
    }

    /// The program so far, with a frame that computes the globals so far.
    pub fn snapshot(&self) -> Program {
        let mut program = self.program.clone();
        if !self.global_values.is_empty() {
            let results = self.global_values.iter().zip(&program.globals).map(|(v, g)| (*v, g.name.clone()));
            let frame = self.stack[0].builder.clone().finish(results.collect());
            program.frame = Some(program.add(frame));
        }
        program
    }

    /// The whole program. Every function must be closed.
    pub fn into_program(self) -> Program {
        assert_eq!(self.stack.len(), 1, "a function is still open");
        self.snapshot()
    }

    // ---- numbers

    /// A node of the function at `depth` as a number; what was folded to a constant is static again.
    pub fn local(&mut self, depth: u32, value: sdf_ir::Value, ty: Type) -> Number {
        let builder = &self.stack[depth as usize].builder;
        if let Some(c) = builder.constant_of(value) {
            return Number::constant(c);
        }
        let name = builder.function().name_of(value).cloned();
        let repr = if depth == 0 { Repr::Frame(value) } else { Repr::Local(depth, value) };
        Number { repr, ty, key: hash(&(depth, value)), name }
    }

    /// The number as a node of the innermost function.
    pub fn value(&mut self, number: &Number) -> sdf_ir::Value {
        let depth = self.depth();
        self.import(number, depth)
    }

    /// The number as a node of the function at `depth`.
    pub fn import(&mut self, number: &Number, depth: u32) -> sdf_ir::Value {
        match &number.repr {
            Repr::Static(c) => self.stack[depth as usize].builder.constant(*c),
            Repr::Frame(value) if depth == 0 => *value,
            Repr::Frame(value) => self.import_frame(*value, number, depth),
            Repr::Local(d, value) if *d == depth => *value,
            Repr::Outer(d, inner) if depth <= *d => self.import(inner, depth),
            Repr::Local(d, _) => {
                assert!(*d < depth, "a number of a function that is closed");
                self.import_parameter(number, depth)
            }
            Repr::Outer(..) => self.import_parameter(number, depth),
        }
    }

    fn import_parameter(&mut self, number: &Number, depth: u32) -> sdf_ir::Value {
        if let Some(value) = self.stack[depth as usize].imports.get(&number.key) {
            return *value;
        }
        let outside = self.import(number, depth - 1);
        let name = number.name.clone().unwrap_or_else(|| Arc::from("c"));
        let context = &mut self.stack[depth as usize];
        let value = context.builder.add_parameter(Parameter { name, ty: number.ty, point: false });
        context.arguments.push(outside);
        context.imports.insert(number.key, value);
        value
    }

    fn import_frame(&mut self, value: sdf_ir::Value, number: &Number, depth: u32) -> sdf_ir::Value {
        if let Node::Uniform(index) = self.stack[0].builder.node(value) {
            return self.stack[depth as usize].builder.uniform(index, number.ty);
        }
        if self.frame_calls {
            return self.import_parameter(number, depth);
        }
        let index = match self.globals.get(&value) {
            Some(index) => *index,
            None => {
                let index = self.global_values.len() as u16;
                let name = number.name.clone().unwrap_or_else(|| Arc::from("frame_value"));
                self.program.globals.push(Global { name, ty: number.ty });
                self.global_values.push(value);
                self.globals.insert(value, index);
                index
            }
        };
        self.stack[depth as usize].builder.global(index, number.ty)
    }

    /// A uniform of the program.
    pub fn uniform(&mut self, uniform: sdf_ir::Uniform) -> Number {
        let index = match self.program.uniforms.iter().position(|u| u.name == uniform.name) {
            Some(index) => index,
            None => {
                self.program.uniforms.push(uniform.clone());
                self.program.uniforms.len() - 1
            }
        };
        let value = self.stack[0].builder.uniform(index as u16, uniform.ty);
        let name = Some(uniform.name);
        Number { repr: Repr::Frame(value), ty: uniform.ty, key: hash(&("uniform", index)), name }
    }

    /// The value of a number that is static, or a setting that the text keeps as a constant.
    pub fn setting(&self, number: &Number) -> Option<Constant> {
        let Repr::Frame(value) = number.repr else { return number.known() };
        match self.stack[0].builder.node(value) {
            Node::Uniform(index) => {
                let uniform = &self.program.uniforms[index as usize];
                (uniform.role == sdf_ir::Role::Setting).then_some(uniform.default)
            }
            _ => None,
        }
    }

    /// How many rounds of a loop a number means: it is static, or a setting, or a setting so often.
    pub fn rounds(&self, number: &Number) -> Option<(f64, Option<Limit>)> {
        if let Some(Constant::Float(count)) = number.known() {
            return Some((count, None));
        }
        let value = match &number.repr {
            Repr::Frame(value) => *value,
            Repr::Outer(_, inner) => return self.rounds(inner),
            Repr::Static(_) | Repr::Local(..) => return None,
        };
        let (uniform, times) = match self.stack[0].builder.node(value) {
            Node::Uniform(index) => (index, 1.0),
            Node::Binary(Binary::Multiply, a, b) => {
                let nodes = [a, b].map(|operand| self.stack[0].builder.node(operand));
                let ([Node::Float(bits), Node::Uniform(index)] | [Node::Uniform(index), Node::Float(bits)]) =
                    nodes
                else {
                    return None;
                };
                (index, f64::from_bits(bits))
            }
            _ => return None,
        };
        let of = &self.program.uniforms[uniform as usize];
        let is_whole = times >= 1.0 && times.fract() == 0.0 && times <= f64::from(u16::MAX);
        match (of.role, of.default) {
            (sdf_ir::Role::Setting, Constant::Float(default)) if is_whole => {
                Some((default * times, Some(Limit { uniform, times: times as u32 })))
            }
            _ => None,
        }
    }

    /// Carries out an operation, where all its operands are known. Types must fit.
    pub fn apply(&mut self, op: Op, operands: &[Number]) -> Number {
        let depth = operands.iter().map(|n| home(&n.repr)).max().flatten();
        let Some(depth) = depth else {
            let constants: Vec<Constant> =
                operands.iter().map(|n| n.known().expect("a number without a home is static")).collect();
            return Number::constant(fold(op, &constants));
        };
        let outer = |n: &Number| matches!(&n.repr, Repr::Outer(d, _) if *d == depth);
        if operands.iter().any(outer) {
            return self.apply_outside(op, operands, depth);
        }
        let values: Vec<_> = operands.iter().map(|n| self.import(n, depth)).collect();
        let builder = &mut self.stack[depth as usize].builder;
        let value = match (op, &values[..]) {
            (Op::Unary(op), [a]) => builder.unary(op, *a),
            (Op::Binary(op), [a, b]) => builder.binary(op, *a, *b),
            (Op::Ternary(op), [a, b, c]) => builder.ternary(op, *a, *b, *c),
            (Op::Compose, parts) => builder.compose(parts),
            (Op::Component(i), [a]) => builder.component(*a, i as usize),
            _ => unreachable!("an operation has the operands that it takes"),
        };
        let ty = builder.ty(value);
        self.local(depth, value, ty)
    }

    /// The operation in the context at `depth`, seen from the functions inside it.
    fn apply_outside(&mut self, op: Op, operands: &[Number], depth: u32) -> Number {
        let unwrapped: Vec<Number> = operands
            .iter()
            .map(|n| match &n.repr {
                Repr::Outer(d, inner) if *d == depth => (**inner).clone(),
                _ => n.clone(),
            })
            .collect();
        let result = self.apply(op, &unwrapped);
        let mut hasher = DefaultHasher::new();
        op.hash(&mut hasher);
        for n in operands {
            identity(n).hash(&mut hasher);
        }
        let name = name_of_result(op, operands);
        Number { ty: result.ty, key: hasher.finish(), name, repr: Repr::Outer(depth, Rc::new(result)) }
    }

    /// Notes that a number is a vector turned about an axis by an angle, where it is a node of an open function.
    /// Nothing is added that would reach the text.
    pub fn mark_rotation(&mut self, image: &Number, vector: &Number, axis: Option<&Number>, angle: &Number) {
        let Repr::Local(depth, image_node) = image.repr else { return };
        if vector.ty != image.ty {
            return;
        }
        let Some(vector) = self.already_at(vector, depth) else { return };
        let axis = axis.and_then(|axis| match axis.repr {
            Repr::Static(Constant::Vec3(axis)) => Some(Axis::Fixed(axis)),
            _ => self.already_at(axis, depth).map(Axis::Of),
        });
        let angle = match angle.repr {
            Repr::Static(_) | Repr::Frame(_) => Angle::Steady,
            _ => self.already_at(angle, depth).map_or(Angle::Unknown, Angle::Of),
        };
        let builder = &mut self.stack[depth as usize].builder;
        builder.mark_rotation(Rotation { image: image_node, vector, axis, angle });
    }

    /// The number as a node of the function at `depth`, if it is known there without a new parameter or global.
    fn already_at(&mut self, number: &Number, depth: u32) -> Option<sdf_ir::Value> {
        match &number.repr {
            Repr::Static(c) => Some(self.stack[depth as usize].builder.constant(*c)),
            Repr::Frame(value) => {
                let index = self.globals.get(value)?;
                Some(self.stack[depth as usize].builder.global(*index, number.ty))
            }
            Repr::Local(d, value) if *d == depth => Some(*value),
            Repr::Outer(d, inner) if depth <= *d => self.already_at(inner, depth),
            Repr::Local(..) | Repr::Outer(..) => self.stack[depth as usize].imports.get(&number.key).copied(),
        }
    }

    /// The number as it is outside the functions deeper than the innermost one.
    pub fn settle(&self, number: Number) -> Number {
        match &number.repr {
            Repr::Outer(d, inner) if *d >= self.depth() => self.settle((**inner).clone()),
            _ => number,
        }
    }
}

/// The depth at which a number is known; `None` for one that is known everywhere.
fn home(repr: &Repr) -> Option<u32> {
    match repr {
        Repr::Static(_) => None,
        Repr::Frame(_) => Some(0),
        Repr::Local(d, _) | Repr::Outer(d, _) => Some(*d),
    }
}

/// What tells a number from others: for constants the value, else its key.
fn identity(number: &Number) -> u64 {
    match &number.repr {
        Repr::Static(c) => hash(&(
            c.ty(),
            c.components().iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
            *c == Constant::Bool(true),
        )),
        Repr::Frame(v) => hash(&("frame", v)),
        Repr::Local(..) | Repr::Outer(..) => number.key,
    }
}

/// What a number that is computed from named ones is called, where a name says anything.
fn name_of_result(op: Op, operands: &[Number]) -> Option<Arc<str>> {
    let mut names: Vec<&str> = operands.iter().filter_map(|n| n.name.as_deref()).collect();
    names.dedup();
    match (op, &names[..]) {
        (Op::Component(i), [name]) => Some(Arc::from(format!("{name}_{}", ["x", "y", "z"][i as usize]))),
        (_, [name]) => Some(Arc::from(*name)),
        (_, [a, b]) if a.len() + b.len() < 16 => Some(Arc::from(format!("{a}_{b}"))),
        _ => None,
    }
}

/// A hash that is the same in every run.
pub(crate) fn hash(x: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    x.hash(&mut hasher);
    hasher.finish()
}

fn fold(op: Op, c: &[Constant]) -> Constant {
    match (op, c) {
        (Op::Unary(op), [a]) => Constant::unary(op, *a),
        (Op::Binary(op), [a, b]) => Constant::binary(op, *a, *b),
        (Op::Ternary(op), [a, b, c]) => Constant::ternary(op, *a, *b, *c),
        (Op::Compose, parts) => {
            Constant::from_components(&parts.iter().map(|p| p.components()[0]).collect::<Vec<_>>())
        }
        (Op::Component(i), [a]) => Constant::Float(a.components()[i as usize]),
        _ => unreachable!("an operation has the operands that it takes"),
    }
}
