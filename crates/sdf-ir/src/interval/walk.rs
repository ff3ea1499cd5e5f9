//! The walk over a function, node by node, in any domain of abstract values.
//!
//! Where a condition is not decided both sides are walked and joined; a loop is unrolled for as long as it may go on.

use super::bounds::Bounds;
use super::cases::Cases;
use super::domain::Domain;
use super::idiom::Idiom;
use super::number::{product_up, sum_up};
use super::plan::Plan;
use super::rotation::{Angle, Axis, Turn};
use super::shortened::{Shortened, Step};
use crate::constant::Constant;
use crate::number::Number;
use crate::program::{Binary, Function, FunctionId, Loop, Node, Program, RegionId, Ternary, Unary, Value};
use std::rc::Rc;

/// How many rounds of loops one walk goes through before it says that a loop may yield anything.
const ROUNDS: u32 = 4096;

/// The values of one function's nodes, by their index.
pub(crate) struct Frame<D> {
    pub plan: Rc<Plan>,
    pub values: Vec<D>,
}

/// The walk: the frames of all functions that have been called, and what functions read besides their arguments.
pub(crate) struct Walk<D> {
    frames: Vec<Option<Frame<D>>>,
    pub uniforms: Vec<D>,
    pub globals: Vec<D>,
    /// Where steps and comparisons are taken apart.
    pub cases: Option<Cases>,
    rounds: u32,
}

impl<D: Domain> Walk<D> {
    pub fn new(uniforms: Vec<D>, globals: Vec<D>) -> Walk<D> {
        Walk { frames: Vec::new(), uniforms, globals, cases: None, rounds: 0 }
    }

    /// A frame in which the leaves of the function have their values.
    pub fn frame(&self, function: &Function, plan: Plan) -> Frame<D> {
        let nothing = D::constant(Constant::Float(0.0));
        let mut frame = Frame { plan: Rc::new(plan), values: vec![nothing; function.node_count()] };
        self.read_leaves(function, &mut frame, 0);
        frame
    }

    /// Sets the leaves among the nodes from `start` on.
    pub fn read_leaves(&self, function: &Function, frame: &mut Frame<D>, start: usize) {
        for i in start..function.node_count() {
            frame.values[i] = match function.node(Value(i as u32)) {
                Node::Float(bits) => D::constant(Constant::Float(f64::from_bits(bits))),
                Node::Bool(x) => D::constant(Constant::Bool(x)),
                Node::Uniform(index) if (index as usize) < self.uniforms.len() => {
                    self.uniforms[index as usize]
                }
                Node::Global(index) if (index as usize) < self.globals.len() => self.globals[index as usize],
                _ => match function.type_of(Value(i as u32)) {
                    Some(ty) => D::anything(ty),
                    None => continue,
                },
            };
        }
    }

    /// Begins a walk that may go through as many rounds of loops as any.
    pub fn begin(&mut self) {
        self.rounds = 0;
    }

    /// Evaluates a region of a function for these arguments; its results are in the frame then.
    pub fn region(
        &mut self,
        program: &Program,
        function: &Function,
        frame: &mut Frame<D>,
        id: RegionId,
        arguments: &[D],
    ) {
        let plan = frame.plan.clone();
        for (index, value) in plan.arguments(id) {
            frame.values[value.0 as usize] = arguments[*index as usize];
        }
        for value in plan.body(id) {
            self.node(program, function, frame, *value);
        }
    }

    /// Evaluates what counts of the body of a function, for arguments in the region that it was shortened for.
    pub fn shortened(
        &mut self,
        program: &Program,
        function: &Function,
        frame: &mut Frame<D>,
        shortened: &Shortened,
        arguments: &[D],
    ) {
        let plan = frame.plan.clone();
        for (index, value) in plan.arguments(RegionId::ROOT) {
            frame.values[value.0 as usize] = arguments[*index as usize];
        }
        for step in shortened.steps() {
            match *step {
                Step::Evaluate(value) => self.node(program, function, frame, value),
                Step::Copy { to, from } => frame.values[to.0 as usize] = frame.values[from.0 as usize],
            }
        }
    }

    fn call(&mut self, program: &Program, id: FunctionId, arguments: &[D]) -> Vec<D> {
        let index = id.0 as usize;
        if self.frames.len() <= index {
            self.frames.resize_with(program.functions.len().max(index + 1), || None);
        }
        let function = program.function(id);
        let mut frame = match self.frames[index].take() {
            Some(frame) => frame,
            None => self.frame(function, Plan::new(function)),
        };
        self.region(program, function, &mut frame, RegionId::ROOT, arguments);
        let mut results = read(&frame, &function.root().results);
        if let Some(lipschitz) = function.lipschitz()
            && let Some(promised) = D::promised(function, lipschitz, arguments)
        {
            let mut rest = vec![0.0; results.len()];
            if let Some(arguments) = promised.rest {
                self.region(program, function, &mut frame, RegionId::ROOT, &arguments);
                rest = read(&frame, &function.root().results).iter().map(D::norm).collect();
            }
            for (result, rest) in results.iter_mut().zip(rest) {
                *result = result.with_norm(sum_up(promised.norm, rest));
            }
        }
        self.frames[index] = Some(frame);
        results
    }

    /// Evaluates a node, all of whose operands have been.
    pub fn node(&mut self, program: &Program, function: &Function, frame: &mut Frame<D>, value: Value) {
        let at = |v: Value| &frame.values[v.0 as usize];
        let computed = match function.node(value) {
            Node::Unary(op, a) => {
                let computed = D::unary(op, at(a));
                match function.node(a) {
                    // The root of a dot with itself is the length.
                    Node::Binary(Binary::Dot, x, y) if op == Unary::Sqrt && x == y => {
                        computed.also(&D::unary(Unary::Length, at(x)))
                    }
                    _ => computed,
                }
            }
            Node::Binary(op, a, b) => {
                let computed = D::binary(op, at(a), at(b), a == b);
                match (op, frame.plan.rotation(a)) {
                    // What lies along the axis stays.
                    (Binary::Dot, Some(turn)) if is_axis(turn.axis, b, at(b).bounds()) => {
                        computed.also(&D::binary(op, at(turn.vector), at(b), false))
                    }
                    _ => computed,
                }
            }
            Node::Ternary(Ternary::Mix, a, b, t) => D::mix(at(a), at(b), at(t)),
            Node::Ternary(Ternary::Select, c, a, b) => match at(c).bounds().decided() {
                Some(true) => *at(a),
                Some(false) => *at(b),
                None => D::either(at(c), at(a), at(b), is_seamless(frame, value)),
            },
            Node::Compose2(x, y) => {
                let pair = D::compose(&[at(x), at(y)]);
                match frame.plan.pair(value) {
                    Some((whole, i)) => pair.pair_of(at(whole), i),
                    None => pair,
                }
            }
            Node::Compose3(x, y, z) => D::compose(&[at(x), at(y), at(z)]),
            Node::Component(a, index) => D::component(at(a), index as usize),
            Node::Result(tuple, index) => *at(Value(tuple.0 + 1 + u32::from(index))),
            Node::Call(callee, list) => {
                let arguments = read(frame, function.list(list));
                let results = self.call(program, callee, &arguments);
                return write(function, frame, value, &results);
            }
            Node::If(condition, then, otherwise) => {
                return self.branch(program, function, frame, (value, condition, then, otherwise));
            }
            Node::Loop(it) => return self.repeat(program, function, frame, value, it),
            Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_) => {
                return;
            }
        };
        let computed = match frame.plan.rotation(value) {
            None => computed,
            Some(turn) => computed.turned(&Turn {
                vector: at(turn.vector),
                axis: turn.axis.map(|axis| match axis {
                    Axis::Fixed(axis) => D::constant(Constant::Vec3(axis)),
                    Axis::Of(axis) => *at(axis),
                }),
                angle: match turn.angle {
                    Angle::Of(angle) => Angle::Of(at(angle)),
                    Angle::Steady => Angle::Steady,
                    Angle::Unknown => Angle::Unknown,
                },
            }),
        };
        let computed = match &mut self.cases {
            Some(cases) => {
                cases.answer(function.node(value), computed, |v| *frame.values[v.0 as usize].bounds())
            }
            None => computed,
        };
        frame.values[value.0 as usize] = computed;
        if D::MOVES && frame.plan.idiom(value).is_some() {
            self.apply_idiom(program, function, frame, value);
        }
    }

    /// Lets a sum be as steep as what it is, where that is less than what its terms are together.
    fn apply_idiom(&mut self, program: &Program, function: &Function, frame: &mut Frame<D>, value: Value) {
        let plan = frame.plan.clone();
        let norm = match plan.idiom(value) {
            None => return,
            Some(Idiom::Corner { vector, parts }) => {
                let parts = read(frame, parts);
                let together = D::compose(&parts.iter().collect::<Vec<_>>()).norm();
                vector.map_or(together, |v| together.min(frame.values[v.0 as usize].norm()))
            }
            Some(Idiom::Linear { vector, norm }) => product_up(*norm, frame.values[vector.0 as usize].norm()),
            Some(Idiom::Blend(blend)) => {
                let at = |v: Value| frame.values[v.0 as usize];
                let (a, b) = (at(blend.a).norm(), at(blend.b).norm());
                if a.max(b) == 0.0 || !blend.others.iter().all(|v| at(*v).norm() == 0.0) {
                    return;
                }
                // The slope of the bulge by |a - b|, as if that were the point.
                let kept: Vec<D> = read(frame, &blend.way);
                let apart = at(blend.apart);
                frame.values[blend.apart.0 as usize] = D::variable(apart.bounds());
                blend.way.iter().for_each(|node| self.node(program, function, frame, *node));
                let slope = frame.values[blend.bulge.0 as usize].slope_by_variable();
                for (node, kept) in blend.way.iter().zip(kept) {
                    frame.values[node.0 as usize] = kept;
                }
                frame.values[blend.apart.0 as usize] = apart;
                let t = if blend.is_rising { slope } else { slope.negated() };
                // |1 - t|·|a'| + |t|·|b'|, or the other way round
                let at = |t: f64| sum_up(sum_up(1.0, -t).abs(), t.abs());
                let weights = if t.lo >= 0.0 && t.hi <= 1.0 { 1.0 } else { at(t.lo).max(at(t.hi)) };
                product_up(weights, a.max(b))
            }
        };
        let sum = &mut frame.values[value.0 as usize];
        *sum = sum.with_norm(norm);
    }

    fn branch(
        &mut self,
        program: &Program,
        function: &Function,
        frame: &mut Frame<D>,
        (value, condition, then, otherwise): (Value, Value, RegionId, RegionId),
    ) {
        let condition = frame.values[condition.0 as usize];
        let mut side = |id: RegionId, frame: &mut Frame<D>| {
            self.region(program, function, frame, id, &[]);
            read(frame, &function.region(id).results)
        };
        let results = match condition.bounds().decided() {
            Some(true) => side(then, frame),
            Some(false) => side(otherwise, frame),
            None => {
                let (left, right) = (side(then, frame), side(otherwise, frame));
                let is_seamless = is_seamless(frame, value);
                left.iter().zip(&right).map(|(a, b)| D::either(&condition, a, b, is_seamless)).collect()
            }
        };
        write(function, frame, value, &results);
    }

    fn repeat(
        &mut self,
        program: &Program,
        function: &Function,
        frame: &mut Frame<D>,
        value: Value,
        it: Loop,
    ) {
        let mut state = read(frame, function.list(it.initial));
        // The states with which the loop may have been left, and the conditions for that.
        let mut exits: Vec<(D, Vec<D>)> = Vec::new();
        let mut arguments = Vec::with_capacity(state.len() + 1);
        for round in 0..it.count {
            self.region(program, function, frame, it.until, &state);
            let stop = frame.values[function.region(it.until).results[0].0 as usize];
            match stop.bounds().decided() {
                Some(true) => break,
                Some(false) => {}
                None => exits.push((stop, state.clone())),
            }
            self.rounds += 1;
            if self.rounds > ROUNDS {
                state = function.types_of(value).into_iter().map(D::anything).collect();
                break;
            }
            arguments.clear();
            arguments.push(D::constant(Constant::Float(f64::from(round))));
            arguments.extend(&state);
            self.region(program, function, frame, it.next, &arguments);
            state = read(frame, &function.region(it.next).results);
        }
        for (stop, exit) in exits.iter().rev() {
            state = exit.iter().zip(&state).map(|(a, b)| D::either(stop, a, b, false)).collect();
        }
        write(function, frame, value, &state);
    }
}

/// Whether a value certainly is the axis, of any length.
fn is_axis(axis: Option<Axis<Value>>, value: Value, bounds: &Bounds) -> bool {
    match axis {
        None => false,
        Some(Axis::Of(axis)) => axis == value,
        Some(Axis::Fixed(axis)) => {
            let mut unit = [0.0; 3];
            f64::normalize(&axis, &mut unit);
            [axis, unit].iter().any(|axis| *bounds == Bounds::constant(Constant::Vec3(*axis)))
        }
    }
}

/// Whether the two sides of a choice certainly go over into each other, here.
fn is_seamless<D: Domain>(frame: &Frame<D>, value: Value) -> bool {
    let Some(seams) = frame.plan.seams(value) else { return false };
    seams.iter().all(|pair| pair.iter().all(|v| frame.values[v.0 as usize].is_continuous()))
}

/// The values of a list.
fn read<D: Domain>(frame: &Frame<D>, values: &[Value]) -> Vec<D> {
    values.iter().map(|value| frame.values[value.0 as usize]).collect()
}

/// Stores what a node yields: one value, or the parts of a tuple, which stand directly behind it.
fn write<D: Domain>(function: &Function, frame: &mut Frame<D>, value: Value, results: &[D]) {
    let first = value.0 as usize + usize::from(function.type_of(value).is_none());
    frame.values[first..first + results.len()].copy_from_slice(results);
}
