//! Whether a program is well formed: run after every pass in tests and debug builds.
//!
//! A program that passes can be printed and evaluated without a check. It says nothing about what the program
//! computes.

use crate::constant::Constant;
use crate::program::{
    Binary, Function, FunctionId, Limit, Loop, Node, Program, RegionId, Role, Ternary, Type, Unary, Value,
};
use std::fmt;
use std::sync::Arc;

/// What is wrong with a program, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Malformed {
    /// The function, or `None` where it is the program's frame, entry or a uniform.
    pub function: Option<Arc<str>>,
    /// The node, where it is one.
    pub value: Option<Value>,
    /// What is wrong.
    pub problem: Problem,
}

/// The ways in which a program can be wrong.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// The operands are none that the operation takes, or a component lies outside its vector.
    Operands(Node, Vec<Option<Type>>),
    /// The recorded type is not what the node yields.
    Type {
        /// What is recorded; `None` is a tuple.
        found: Option<Type>,
        /// What the node yields.
        expected: Option<Type>,
    },
    /// The operand is defined later, or in a region that is closed there.
    NotVisible(Value),
    /// A constant, argument, uniform or global stands in a body.
    LeafInBody,
    /// The node stands in two bodies, or twice in one.
    InTwoBodies,
    /// The region is owned by two nodes, or is the function's own.
    OwnedTwice(RegionId),
    /// A handle points outside its table.
    OutOfRange,
    /// The call is of the function itself or of a later one.
    CallsForward(FunctionId),
    /// The arguments are not those that the callee takes.
    Arguments {
        /// The types that the call gives.
        found: Vec<Option<Type>>,
        /// The types that the callee takes.
        expected: Vec<Type>,
    },
    /// The parts of a tuple do not stand behind it, or have other types than the node yields.
    Parts {
        /// The types of the `Result`s behind it.
        found: Vec<Type>,
        /// The types that the node yields.
        expected: Vec<Type>,
    },
    /// A tuple is used by something else than a `Result`, or a `Result` reads no tuple.
    Tuple(Value),
    /// A region takes other arguments than its owner gives.
    RegionArguments {
        /// The types that it takes.
        found: Vec<Type>,
        /// The types that the owner gives.
        expected: Vec<Type>,
    },
    /// A region yields other results than its owner wants.
    RegionResults {
        /// The types that it yields.
        found: Vec<Option<Type>>,
        /// The types that the owner wants.
        expected: Vec<Type>,
    },
    /// The parameters are not the arguments of the root region.
    Parameters,
    /// There are not as many names of results as results.
    ResultNames,
    /// The function of the frame has a parameter, or its results are not the globals, or there is none.
    Frame,
    /// The frame, or what it calls, reads a global, which the frame is there to compute.
    GlobalInFrame,
    /// The number of rounds of a loop is not that which its setting makes.
    Limit(Limit),
    /// The default of this uniform has another type than the uniform.
    UniformDefault(u16),
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.function {
            Some(name) => write!(f, "function `{name}`")?,
            None => write!(f, "program")?,
        }
        if let Some(value) = self.value {
            write!(f, ", node %{}", value.0)?;
        }
        write!(f, ": {:?}", self.problem)
    }
}

impl std::error::Error for Malformed {}

/// Whether everything in the program is as its types say; the first thing that is not.
pub fn verify(program: &Program) -> Result<(), Malformed> {
    for (index, uniform) in program.uniforms.iter().enumerate() {
        if uniform.default.ty() != uniform.ty {
            return Err(of_program(Problem::UniformDefault(index as u16)));
        }
    }
    let in_frame = reached_by_frame(program);
    for (index, function) in program.functions.iter().enumerate() {
        Check::new(program, function, index, in_frame[index]).function()?;
    }
    if program.entry.is_some_and(|id| id.0 as usize >= program.functions.len()) {
        return Err(of_program(Problem::OutOfRange));
    }
    frame(program)
}

/// The frame takes nothing, yields the globals and reads none of them.
fn frame(program: &Program) -> Result<(), Malformed> {
    let globals: Vec<Type> = program.globals.iter().map(|g| g.ty).collect();
    let Some(id) = program.frame else {
        return if globals.is_empty() { Ok(()) } else { Err(of_program(Problem::Frame)) };
    };
    if id.0 as usize >= program.functions.len() {
        return Err(of_program(Problem::OutOfRange));
    }
    let frame = program.function(id);
    if !frame.parameters.is_empty() || frame.result_types() != globals {
        return Err(of_program(Problem::Frame));
    }
    Ok(())
}

/// Which functions the frame depends on, itself included.
fn reached_by_frame(program: &Program) -> Vec<bool> {
    let mut reached = vec![false; program.functions.len()];
    if let Some(is_reached) = program.frame.and_then(|id| reached.get_mut(id.0 as usize)) {
        *is_reached = true;
    }
    for index in (0..reached.len()).rev() {
        if !reached[index] {
            continue;
        }
        for node in &program.functions[index].nodes {
            if let Node::Call(callee, _) = node
                && let Some(is_reached) = reached.get_mut(callee.0 as usize)
            {
                *is_reached = true;
            }
        }
    }
    reached
}

fn of_program(problem: Problem) -> Malformed {
    Malformed { function: None, value: None, problem }
}

/// The check of one function.
struct Check<'a> {
    program: &'a Program,
    function: &'a Function,
    /// Where the function stands; it may call those before.
    index: usize,
    /// Whether the frame depends on it.
    in_frame: bool,
    /// The nodes of bodies that have been passed and are still in scope.
    visible: Vec<bool>,
    /// The nodes that some body holds.
    placed: Vec<bool>,
    /// The regions that have been entered, and whether they are still open.
    regions: Vec<Option<bool>>,
}

impl Check<'_> {
    fn new<'a>(program: &'a Program, function: &'a Function, index: usize, in_frame: bool) -> Check<'a> {
        Check {
            program,
            function,
            index,
            in_frame,
            visible: vec![false; function.node_count()],
            placed: vec![false; function.node_count()],
            regions: vec![None; function.region_count()],
        }
    }

    fn error(&self, value: Option<Value>, problem: Problem) -> Malformed {
        Malformed { function: Some(self.function.name.clone()), value, problem }
    }

    fn function(mut self) -> Result<(), Malformed> {
        let function = self.function;
        let parameters: Vec<Type> = function.parameters.iter().map(|p| p.ty).collect();
        if function.root().arguments != parameters {
            return Err(self.error(None, Problem::Parameters));
        }
        if function.root().results.len() != function.result_names.len() {
            return Err(self.error(None, Problem::ResultNames));
        }
        self.region(RegionId::ROOT)
    }

    /// Checks a region, leaving nothing of it visible.
    fn region(&mut self, id: RegionId) -> Result<(), Malformed> {
        let function = self.function;
        let region = function.region(id);
        self.regions[id.0 as usize] = Some(true);
        for value in &region.body {
            self.node(*value)?;
        }
        for result in &region.results {
            self.operand(*result, None)?;
            if function.type_of(*result).is_none() {
                return Err(self.error(None, Problem::Tuple(*result)));
            }
        }
        for value in &region.body {
            self.visible[value.0 as usize] = false;
        }
        self.regions[id.0 as usize] = Some(false);
        Ok(())
    }

    /// Checks a node of a body and makes it visible.
    fn node(&mut self, value: Value) -> Result<(), Malformed> {
        let function = self.function;
        let Some(node) = function.nodes.get(value.0 as usize).copied() else {
            return Err(self.error(Some(value), Problem::OutOfRange));
        };
        if matches!(
            node,
            Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_)
        ) {
            return Err(self.error(Some(value), Problem::LeafInBody));
        }
        if std::mem::replace(&mut self.placed[value.0 as usize], true) {
            return Err(self.error(Some(value), Problem::InTwoBodies));
        }
        let mut operands = Vec::new();
        if let Node::Call(_, list) | Node::Loop(Loop { initial: list, .. }) = node
            && (list.start as usize + list.len as usize) > function.lists.len()
        {
            return Err(self.error(Some(value), Problem::OutOfRange));
        }
        function.operands(value, |operand| operands.push(operand));
        for operand in &operands {
            self.operand(*operand, Some(value))?;
            let reads_tuple = matches!(node, Node::Result(..));
            if function.type_of(*operand).is_none() != reads_tuple {
                return Err(self.error(Some(value), Problem::Tuple(*operand)));
            }
        }
        let yielded = self.yielded(value, node, &operands)?;
        self.record(value, &yielded)?;
        self.visible[value.0 as usize] = true;
        Ok(())
    }

    /// The recorded types are those that the node yields.
    fn record(&self, value: Value, yielded: &[Type]) -> Result<(), Malformed> {
        let expected = if let [ty] = *yielded { Some(ty) } else { None };
        let found = self.function.type_of(value);
        if found != expected {
            return Err(self.error(Some(value), Problem::Type { found, expected }));
        }
        if expected.is_none() && self.function.types_of(value) != yielded {
            let found = self.function.types_of(value);
            return Err(self.error(Some(value), Problem::Parts { found, expected: yielded.to_vec() }));
        }
        Ok(())
    }

    /// Checks that a value may be used here; a leaf is checked where it is used.
    fn operand(&self, operand: Value, user: Option<Value>) -> Result<(), Malformed> {
        let function = self.function;
        let Some(node) = function.nodes.get(operand.0 as usize) else {
            return Err(self.error(user, Problem::OutOfRange));
        };
        let expected = match *node {
            Node::Float(_) => Some(Type::Float),
            Node::Bool(_) => Some(Type::Bool),
            Node::Uniform(index) => self.program.uniforms.get(index as usize).map(|u| u.ty),
            Node::Global(_) if self.in_frame => return Err(self.error(user, Problem::GlobalInFrame)),
            Node::Global(index) => self.program.globals.get(index as usize).map(|g| g.ty),
            Node::Argument(region, index) => {
                if self.regions.get(region.0 as usize) != Some(&Some(true)) {
                    return Err(self.error(user, Problem::NotVisible(operand)));
                }
                function.region(region).arguments.get(index as usize).copied()
            }
            _ if self.visible[operand.0 as usize] => return Ok(()),
            _ => return Err(self.error(user, Problem::NotVisible(operand))),
        };
        let Some(expected) = expected else {
            return Err(self.error(Some(operand), Problem::OutOfRange));
        };
        if function.type_of(operand) != Some(expected) {
            let problem = Problem::Type { found: function.type_of(operand), expected: Some(expected) };
            return Err(self.error(Some(operand), problem));
        }
        Ok(())
    }

    /// The types of what a node yields, after a check of what it is made from.
    fn yielded(&mut self, value: Value, node: Node, operands: &[Value]) -> Result<Vec<Type>, Malformed> {
        let function = self.function;
        let found: Vec<Option<Type>> = operands.iter().map(|v| function.type_of(*v)).collect();
        let types: Vec<Type> = found.iter().copied().flatten().collect();
        match node {
            Node::If(_, then, otherwise) => self.branch(value, &types, then, otherwise),
            Node::Loop(it) => self.repeat(value, types, it),
            Node::Call(callee, _) => self.call(value, callee, found),
            Node::Result(tuple, index) => match function.types_of(tuple).get(index as usize) {
                Some(ty) => Ok(vec![*ty]),
                None => Err(self.error(Some(value), Problem::OutOfRange)),
            },
            _ => match result_type(node, &types) {
                Some(ty) => Ok(vec![ty]),
                None => Err(self.error(Some(value), Problem::Operands(node, found))),
            },
        }
    }

    fn branch(
        &mut self,
        value: Value,
        condition: &[Type],
        then: RegionId,
        otherwise: RegionId,
    ) -> Result<Vec<Type>, Malformed> {
        if condition != [Type::Bool] {
            let found = condition.iter().copied().map(Some).collect();
            return Err(self.error(Some(value), Problem::Operands(self.function.node(value), found)));
        }
        self.owned(value, then, &[])?;
        self.owned(value, otherwise, &[])?;
        let yielded: Vec<Type> = self.results(then).into_iter().flatten().collect();
        self.yields(value, otherwise, &yielded)?;
        Ok(yielded)
    }

    fn repeat(&mut self, value: Value, state: Vec<Type>, it: Loop) -> Result<Vec<Type>, Malformed> {
        if let Some(limit) = it.limit {
            let setting = self.program.uniforms.get(limit.uniform as usize);
            let setting = setting.filter(|uniform| uniform.role == Role::Setting);
            let rounds = Constant::Float(f64::from(it.count) / f64::from(limit.times));
            if setting.is_none_or(|uniform| uniform.default != rounds) {
                return Err(self.error(Some(value), Problem::Limit(limit)));
            }
        }
        self.owned(value, it.until, &state)?;
        self.yields(value, it.until, &[Type::Bool])?;
        let with_index: Vec<Type> = std::iter::once(Type::Float).chain(state.iter().copied()).collect();
        self.owned(value, it.next, &with_index)?;
        self.yields(value, it.next, &state)?;
        Ok(state)
    }

    fn call(
        &self,
        value: Value,
        callee: FunctionId,
        found: Vec<Option<Type>>,
    ) -> Result<Vec<Type>, Malformed> {
        if callee.0 as usize >= self.index {
            return Err(self.error(Some(value), Problem::CallsForward(callee)));
        }
        let callee = self.program.function(callee);
        let expected: Vec<Type> = callee.parameters.iter().map(|p| p.ty).collect();
        if !found.iter().copied().eq(expected.iter().copied().map(Some)) {
            return Err(self.error(Some(value), Problem::Arguments { found, expected }));
        }
        Ok(callee.result_types())
    }

    /// Enters a region of a node, which must take these arguments.
    fn owned(&mut self, owner: Value, region: RegionId, arguments: &[Type]) -> Result<(), Malformed> {
        match self.regions.get(region.0 as usize) {
            None => return Err(self.error(Some(owner), Problem::OutOfRange)),
            Some(Some(_)) => return Err(self.error(Some(owner), Problem::OwnedTwice(region))),
            Some(None) => {}
        }
        let found = &self.function.region(region).arguments;
        if found != arguments {
            let problem = Problem::RegionArguments { found: found.clone(), expected: arguments.to_vec() };
            return Err(self.error(Some(owner), problem));
        }
        self.region(region)
    }

    fn results(&self, region: RegionId) -> Vec<Option<Type>> {
        self.function.region(region).results.iter().map(|v| self.function.type_of(*v)).collect()
    }

    fn yields(&self, owner: Value, region: RegionId, expected: &[Type]) -> Result<(), Malformed> {
        let found = self.results(region);
        if found.iter().copied().eq(expected.iter().copied().map(Some)) {
            return Ok(());
        }
        Err(self.error(Some(owner), Problem::RegionResults { found, expected: expected.to_vec() }))
    }
}

/// The type of a node without regions that has one result and is no call, if it takes these operands.
fn result_type(node: Node, operands: &[Type]) -> Option<Type> {
    let number = |ty: Type| ty != Type::Bool;
    match (node, operands) {
        (Node::Unary(op, _), &[a]) => match op {
            Unary::Not => (a == Type::Bool).then_some(Type::Bool),
            Unary::Length => a.is_vector().then_some(Type::Float),
            Unary::Normalize => a.is_vector().then_some(a),
            Unary::Hash => number(a).then_some(Type::Float),
            Unary::ReduceAngle => (a == Type::Float).then_some(Type::Vec2),
            _ => number(a).then_some(a),
        },
        (Node::Binary(op, ..), &[a, b]) => match op {
            Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide => {
                let widens = a == Type::Float || b == Type::Float;
                (number(a) && number(b) && (a == b || widens)).then_some(a.max(b))
            }
            Binary::Modulo | Binary::Min | Binary::Max | Binary::Power | Binary::Atan2 => {
                (number(a) && a == b).then_some(a)
            }
            Binary::Dot => (a.is_vector() && a == b).then_some(Type::Float),
            Binary::Cross => (a == Type::Vec3 && b == Type::Vec3).then_some(Type::Vec3),
            Binary::Less | Binary::LessEqual => (a == Type::Float && b == Type::Float).then_some(Type::Bool),
            Binary::Equal => (a.size() == 1 && a == b).then_some(Type::Bool),
            Binary::And | Binary::Or => (a == Type::Bool && b == Type::Bool).then_some(Type::Bool),
        },
        (Node::Ternary(Ternary::Select, ..), &[a, b, c]) => (a == Type::Bool && b == c).then_some(b),
        (Node::Ternary(Ternary::Mix, ..), &[a, b, c]) => {
            (number(a) && a == b && (c == a || c == Type::Float)).then_some(a)
        }
        (Node::Compose2(..), [Type::Float, Type::Float]) => Some(Type::Vec2),
        (Node::Compose3(..), [Type::Float, Type::Float, Type::Float]) => Some(Type::Vec3),
        (Node::Component(_, index), &[a]) => {
            (a.is_vector() && (index as usize) < a.size()).then_some(Type::Float)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{Problem, verify};
    use crate::build::Builder;
    use crate::constant::Constant;
    use crate::program::{
        Binary, FunctionId, Global, Limit, List, Node, Parameter, Program, RegionId, Role, Ternary, Type,
        Unary, Uniform, Value,
    };

    fn parameter(name: &str, ty: Type) -> Parameter {
        Parameter { name: name.into(), ty, point: false }
    }

    /// A program with every kind of node: f0 yields two values, f1 is the frame, f2 calls f0, branches and loops.
    fn program() -> Program {
        let mut program = Program {
            uniforms: vec![Uniform {
                name: "time".into(),
                ty: Type::Float,
                role: Role::Time,
                default: Constant::Float(0.0),
            }],
            globals: vec![Global { name: "angle".into(), ty: Type::Float }],
            ..Program::default()
        };
        let mut b = Builder::new("both", vec![parameter("x", Type::Float)]);
        let x = b.argument(RegionId::ROOT, 0);
        let (sine, cosine) = (b.unary(Unary::Sin, x), b.unary(Unary::Cos, x));
        let both = program.add(b.finish(vec![(sine, "s".into()), (cosine, "c".into())]));
        let mut b = Builder::new("frame", vec![]);
        let time = b.uniform(0, Type::Float);
        let angle = b.unary(Unary::Sin, time);
        program.frame = Some(program.add(b.finish(vec![(angle, "angle".into())])));
        let mut b = Builder::new("main", vec![parameter("v", Type::Vec3), parameter("k", Type::Float)]);
        let [v, k] = [0, 1].map(|i| b.argument(RegionId::ROOT, i));
        let length = b.unary(Unary::Length, v);
        let angle = b.global(0, Type::Float);
        let parts = b.call(both, &[Type::Float, Type::Float], &[length]);
        let low = b.binary(Binary::Less, parts[0], k);
        let then = b.open_region(&[]);
        let tangent = b.unary(Unary::Tan, k);
        b.close_region(vec![tangent]);
        let otherwise = b.open_region(&[]);
        let root = b.unary(Unary::Sqrt, parts[1]);
        b.close_region(vec![root]);
        let chosen = b.branch(low, then, otherwise)[0];
        let until = b.open_region(&[Type::Float]);
        let state = b.argument(until, 0);
        let over = b.binary(Binary::Less, k, state);
        b.close_region(vec![over]);
        let next = b.open_region(&[Type::Float, Type::Float]);
        let [round, state] = [0, 1].map(|i| b.argument(next, i));
        let more = b.mul(state, round);
        b.close_region(vec![more]);
        let last = b.repeat(4, &[chosen], until, next)[0];
        let sum = b.add(last, angle);
        program.entry = Some(program.add(b.finish(vec![(sum, "".into())])));
        program
    }

    fn problem(change: impl FnOnce(&mut Program)) -> Problem {
        let mut program = program();
        assert_eq!(verify(&program), Ok(()));
        change(&mut program);
        verify(&program).expect_err("the change breaks the program").problem
    }

    /// The first value of `main` with such a node.
    fn find(program: &Program, is: impl Fn(Node) -> bool) -> Value {
        Value(program.functions[2].nodes.iter().position(|n| is(*n)).expect("such a node") as u32)
    }

    /// Replaces the first such node of `main`.
    fn replace(program: &mut Program, is: impl Fn(Node) -> bool, by: Node) {
        let index = find(program, is).0 as usize;
        program.functions[2].nodes[index] = by;
    }

    #[test]
    fn the_types_of_operands_and_results_are_checked() {
        let v = Value(0);
        for node in [
            Node::Unary(Unary::Not, v),
            Node::Unary(Unary::ReduceAngle, v),
            Node::Binary(Binary::Less, v, v),
            Node::Binary(Binary::And, v, v),
            Node::Binary(Binary::Equal, v, v),
            Node::Binary(Binary::Min, v, Value(1)),
            Node::Binary(Binary::Dot, Value(1), Value(1)),
            Node::Binary(Binary::Cross, Value(1), Value(1)),
            Node::Ternary(Ternary::Select, v, v, v),
            Node::Ternary(Ternary::Mix, Value(1), Value(1), v),
            Node::Compose2(v, Value(1)),
            Node::Compose3(Value(1), Value(1), v),
            Node::Component(v, 3),
            Node::Component(Value(1), 0),
        ] {
            let found = problem(|p| replace(p, |n| matches!(n, Node::Unary(Unary::Length, _)), node));
            assert!(matches!(found, Problem::Operands(n, _) if n == node), "{node:?}: {found:?}");
        }
        let abs = Node::Unary(Unary::Abs, v);
        let found = problem(|p| replace(p, |n| matches!(n, Node::Unary(Unary::Length, _)), abs));
        assert_eq!(found, Problem::Type { found: Some(Type::Float), expected: Some(Type::Vec3) });
        let found = problem(|p| p.functions[2].types[0] = Some(Type::Vec2));
        assert!(matches!(found, Problem::Type { expected: Some(Type::Vec3), .. }));
    }

    #[test]
    fn a_value_is_used_only_where_it_is_visible() {
        let later = problem(|p| p.functions[2].regions[0].body.reverse());
        assert!(matches!(later, Problem::NotVisible(_)));
        let of_a_closed_region = problem(|p| {
            let tangent = find(p, |n| matches!(n, Node::Unary(Unary::Tan, _)));
            p.functions[2].regions[0].results[0] = tangent;
        });
        assert!(matches!(of_a_closed_region, Problem::NotVisible(_)));
        let argument_outside = problem(|p| {
            let state = find(p, |n| n == Node::Argument(RegionId(3), 0));
            p.functions[2].regions[0].results[0] = state;
        });
        assert!(matches!(argument_outside, Problem::NotVisible(_)));
    }

    #[test]
    fn each_node_stands_in_one_body_and_leaves_in_none() {
        assert_eq!(problem(|p| p.functions[2].regions[0].body.insert(0, Value(0))), Problem::LeafInBody);
        let twice = |p: &mut Program| {
            let length = find(p, |n| matches!(n, Node::Unary(Unary::Length, _)));
            p.functions[2].regions[0].body.push(length);
        };
        assert_eq!(problem(twice), Problem::InTwoBodies);
    }

    #[test]
    fn regions_have_one_owner() {
        let found = problem(|p| {
            let value = find(p, |n| matches!(n, Node::If(..))).0 as usize;
            let Node::If(condition, then, _) = p.functions[2].nodes[value] else { unreachable!() };
            p.functions[2].nodes[value] = Node::If(condition, then, then);
        });
        assert!(matches!(found, Problem::OwnedTwice(_)));
        let found = problem(|p| {
            let value = find(p, |n| matches!(n, Node::If(..))).0 as usize;
            let Node::If(condition, then, _) = p.functions[2].nodes[value] else { unreachable!() };
            p.functions[2].nodes[value] = Node::If(condition, then, RegionId::ROOT);
        });
        assert_eq!(found, Problem::OwnedTwice(RegionId::ROOT));
    }

    #[test]
    fn regions_take_and_yield_what_their_owners_want() {
        let takes = problem(|p| p.functions[2].regions[1].arguments.push(Type::Float));
        assert!(matches!(takes, Problem::RegionArguments { .. }));
        let until = problem(|p| p.functions[2].regions[3].arguments[0] = Type::Vec2);
        assert!(matches!(until, Problem::RegionArguments { .. } | Problem::Type { .. }));
        let without_index = problem(|p| {
            p.functions[2].regions[4].arguments.remove(0);
        });
        assert!(matches!(without_index, Problem::RegionArguments { .. }));
        let stops = problem(|p| p.functions[2].regions[3].results[0] = Value(1));
        assert!(matches!(stops, Problem::RegionResults { .. }));
        let state = problem(|p| p.functions[2].regions[4].results[0] = Value(0));
        assert!(matches!(state, Problem::RegionResults { .. }));
        let other = problem(|p| p.functions[2].regions[2].results[0] = Value(0));
        assert!(matches!(other, Problem::RegionResults { .. }));
        let condition = problem(|p| {
            let value = find(p, |n| matches!(n, Node::If(..))).0 as usize;
            let Node::If(_, then, otherwise) = p.functions[2].nodes[value] else { unreachable!() };
            p.functions[2].nodes[value] = Node::If(Value(1), then, otherwise);
        });
        assert!(matches!(condition, Problem::Operands(..)));
    }

    #[test]
    fn calls_are_of_earlier_functions_with_their_arguments() {
        let call = |n: Node| matches!(n, Node::Call(..));
        let list = List { start: 0, len: 1 };
        let forward = problem(|p| replace(p, call, Node::Call(FunctionId(2), list)));
        assert_eq!(forward, Problem::CallsForward(FunctionId(2)));
        let outside = problem(|p| replace(p, call, Node::Call(FunctionId(9), list)));
        assert_eq!(outside, Problem::CallsForward(FunctionId(9)));
        let arity = problem(|p| replace(p, call, Node::Call(FunctionId(0), List { start: 0, len: 0 })));
        assert!(matches!(arity, Problem::Arguments { .. }));
        let types = problem(|p| p.functions[2].lists[0] = Value(0));
        assert!(matches!(types, Problem::Arguments { .. }));
        let list = problem(|p| replace(p, call, Node::Call(FunctionId(0), List { start: 9, len: 1 })));
        assert_eq!(list, Problem::OutOfRange);
    }

    #[test]
    fn tuples_are_read_by_result_alone() {
        let used = problem(|p| {
            let tuple = find(p, |n| matches!(n, Node::Call(..)));
            replace(p, |n| matches!(n, Node::Unary(Unary::Sqrt, _)), Node::Unary(Unary::Sqrt, tuple));
        });
        assert!(matches!(used, Problem::Tuple(_)));
        let yielded = problem(|p| {
            let tuple = find(p, |n| matches!(n, Node::Call(..)));
            p.functions[2].regions[0].results[0] = tuple;
        });
        assert!(matches!(yielded, Problem::Tuple(_)));
        let no_tuple = problem(|p| {
            let length = find(p, |n| matches!(n, Node::Unary(Unary::Length, _)));
            replace(p, |n| matches!(n, Node::Result(_, 1)), Node::Result(length, 1));
        });
        assert!(matches!(no_tuple, Problem::Parts { .. } | Problem::Tuple(_)));
        let part = problem(|p| {
            let tuple = find(p, |n| matches!(n, Node::Call(..)));
            replace(p, |n| matches!(n, Node::Result(_, 1)), Node::Result(tuple, 2));
        });
        assert_eq!(part, Problem::OutOfRange);
    }

    #[test]
    fn handles_stay_inside_their_tables() {
        assert_eq!(problem(|p| p.uniforms.clear()), Problem::OutOfRange);
        let global = |n: Node| matches!(n, Node::Global(_));
        assert_eq!(problem(|p| replace(p, global, Node::Global(1))), Problem::OutOfRange);
        assert_eq!(problem(|p| p.entry = Some(FunctionId(3))), Problem::OutOfRange);
        assert_eq!(problem(|p| p.frame = Some(FunctionId(3))), Problem::OutOfRange);
        assert_eq!(problem(|p| p.functions[2].regions[0].body.push(Value(99))), Problem::OutOfRange);
        assert_eq!(problem(|p| p.functions[2].regions[0].results[0] = Value(99)), Problem::OutOfRange);
    }

    #[test]
    fn the_frame_yields_the_globals_from_nothing() {
        assert_eq!(problem(|p| p.frame = Some(FunctionId(0))), Problem::Frame);
        assert_eq!(problem(|p| p.globals[0].ty = Type::Vec2), {
            Problem::Type { found: Some(Type::Float), expected: Some(Type::Vec2) }
        });
        assert_eq!(problem(|p| p.globals.push(p.globals[0].clone())), Problem::Frame);
        assert_eq!(problem(|p| p.frame = None), Problem::Frame);
        let reads = problem(|p| p.functions[1].nodes[0] = Node::Global(0));
        assert_eq!(reads, Problem::GlobalInFrame);
    }

    #[test]
    fn signatures_are_consistent() {
        assert_eq!(problem(|p| p.functions[0].parameters[0].ty = Type::Vec2), Problem::Parameters);
        assert_eq!(problem(|p| p.functions[0].result_names.clear()), Problem::ResultNames);
        assert_eq!(problem(|p| p.uniforms[0].default = Constant::Bool(true)), Problem::UniformDefault(0));
    }

    #[test]
    fn rounds_are_what_the_setting_makes() {
        let with_limit = |count: u32, times: u32, role: Role| {
            let mut program = program();
            program.uniforms[0].default = Constant::Float(2.0);
            program.uniforms[0].role = role;
            let it = program.functions[2].nodes.iter_mut().find_map(|node| match node {
                Node::Loop(it) => Some(it),
                _ => None,
            });
            let it = it.expect("a loop");
            (it.count, it.limit) = (count, Some(Limit { uniform: 0, times }));
            verify(&program)
        };
        assert_eq!(with_limit(4, 2, Role::Setting), Ok(()));
        let wrong = [with_limit(4, 1, Role::Setting), with_limit(2, 1, Role::Time)];
        for wrong in wrong {
            assert_eq!(wrong.expect_err("wrong").problem, Problem::Limit(Limit { uniform: 0, times: 1 }));
        }
    }

    #[test]
    fn the_message_names_the_place() {
        let mut program = program();
        program.functions[2].regions[0].body.insert(0, Value(0));
        let message = verify(&program).expect_err("a leaf stands in a body").to_string();
        assert_eq!(message, "function `main`, node %0: LeafInBody");
    }
}
