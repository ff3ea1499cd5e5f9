//! Differentiation as a rewrite: a function becomes one that also yields its derivatives.
//!
//! Forward mode. Beside each number stands its slope: for every active parameter the derivative by it, a value of
//! that parameter's type, or nothing where it is zero whatever the point. Vectors have a slope per component.
//! Calls become calls of the callee's gradient, for the parameters whose arguments move; branches and loops carry
//! the slopes of what they yield. Where a function has a kink its derivative is one of the two, that of the first
//! operand for `min` and `max`, never a mean; a jump counts as flat.

mod activity;
pub(crate) mod derivative;
#[cfg(test)]
mod tests;

use crate::build::Builder;
use crate::copy::{Copy, SameProgram, rebuild};
use crate::program::{Function, FunctionId, Loop, Node, Parameter, Program, RegionId, Type, Value};
use activity::Activity;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// The derivatives of a number by each active parameter; `None` is zero.
type Slope = Vec<Option<Value>>;

/// The gradient of one function; see [`Gradients::of`].
pub fn gradient(program: &mut Program, function: FunctionId) -> FunctionId {
    Gradients::default().of(program, function)
}

/// The gradients made so far in one program, so that none is made twice.
#[derive(Default)]
pub struct Gradients {
    made: FxHashMap<Request, Made>,
}

/// A gradient that was asked for.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Request {
    function: FunctionId,
    /// By which parameters.
    active: Vec<bool>,
    /// Whether derivatives that are zero everywhere are results too.
    complete: bool,
}

/// A gradient that is part of the program.
#[derive(Clone)]
struct Made {
    function: FunctionId,
    /// For each component of each result and each active parameter, whether the derivative is a result.
    present: Vec<bool>,
}

impl Gradients {
    /// A function named `<name>_gradient`, which yields what `function` does and then, for each component of each
    /// result and each parameter that is a point of space, the derivative by that point, a vector. So for a field
    /// it is the distance and a vec3. At the end of the program, with the gradients that it calls before it.
    pub fn of(&mut self, program: &mut Program, function: FunctionId) -> FunctionId {
        let active = program.function(function).parameters.iter().map(|p| p.point).collect();
        self.made(program, Request { function, active, complete: true }).function
    }

    fn made(&mut self, program: &mut Program, request: Request) -> Made {
        if let Some(made) = self.made.get(&request) {
            return made.clone();
        }
        let source = program.function(request.function).clone();
        let made = differentiate(self, program, &source, &request);
        self.made.insert(request, made.clone());
        made
    }
}

fn differentiate(
    gradients: &mut Gradients,
    program: &mut Program,
    source: &Function,
    request: &Request,
) -> Made {
    let mut builder = Builder::new(format!("{}_gradient", source.name), source.parameters.clone());
    builder.set_line(source.line);
    builder.set_doc(Some("The same, with its derivative by the point or by the other values.".into()));
    let arguments: Vec<Value> =
        (0..source.parameters.len()).map(|i| builder.argument(RegionId::ROOT, i as u16)).collect();
    let active: Vec<usize> = (0..source.parameters.len()).filter(|i| request.active[*i]).collect();
    let mut walk = Walk {
        gradients,
        program,
        source,
        parameters: active.iter().map(|i| source.parameters[*i].ty).collect(),
        activity: Activity::new(source, &active),
        slopes: vec![Vec::new(); source.node_count()],
        arguments: FxHashMap::default(),
        copy: Copy::new(source, &arguments, &SameProgram),
    };
    walk.arguments.insert(RegionId::ROOT, own_slopes(&mut builder, source, &active));
    walk.body(&mut builder, RegionId::ROOT);
    let values = walk.copy.values(&mut builder, &source.root().results);
    let mut results: Vec<(Value, Arc<str>)> =
        values.into_iter().zip(source.result_names.iter().cloned()).collect();
    let mut present = Vec::new();
    for (result, name) in source.root().results.iter().zip(&source.result_names) {
        for slope in walk.slopes(*result) {
            for (derivative, index) in slope.into_iter().zip(&active) {
                let parameter = &source.parameters[*index];
                present.push(request.complete || derivative.is_some());
                if present.ends_with(&[true]) {
                    let derivative = derivative.unwrap_or_else(|| zero(&mut builder, parameter.ty));
                    results.push((derivative, derivative_name(name, parameter, active.len())));
                }
            }
        }
    }
    // What only slopes that vanished have read is left behind.
    let function = rebuild(&builder.finish(results));
    Made { function: program.add(function), present }
}

/// `gradient` for the only one, else with the result's name before it and the parameter's behind.
fn derivative_name(result: &str, parameter: &Parameter, active: usize) -> Arc<str> {
    let mut name = if result.is_empty() { String::from("gradient") } else { format!("{result}_gradient") };
    if active > 1 {
        name.push_str("_by_");
        name.push_str(&parameter.name);
    }
    name.into()
}

/// The slopes of the parameters: each component of an active one moves with itself.
fn own_slopes(builder: &mut Builder, source: &Function, active: &[usize]) -> Vec<Vec<Slope>> {
    let mut own = Vec::new();
    for (index, parameter) in source.parameters.iter().enumerate() {
        let mut slopes = vec![vec![None; active.len()]; parameter.ty.size()];
        if let Some(place) = active.iter().position(|i| *i == index) {
            for (component, slope) in slopes.iter_mut().enumerate() {
                let parts: Vec<Value> = (0..parameter.ty.size())
                    .map(|i| builder.float(if i == component { 1.0 } else { 0.0 }))
                    .collect();
                slope[place] = Some(builder.compose(&parts));
            }
        }
        own.push(slopes);
    }
    own
}

fn zero(builder: &mut Builder, ty: Type) -> Value {
    let zero = builder.float(0.0);
    builder.splat(zero, ty)
}

/// The differentiation of one function: a copy that also keeps slopes.
struct Walk<'a> {
    gradients: &'a mut Gradients,
    program: &'a mut Program,
    source: &'a Function,
    /// The types of the active parameters.
    parameters: Vec<Type>,
    activity: Activity,
    /// The slopes of the nodes so far, per component; those of the parts of a tuple, one after the other.
    slopes: Vec<Vec<Slope>>,
    /// The slopes of the arguments of each region that is being copied.
    arguments: FxHashMap<RegionId, Vec<Vec<Slope>>>,
    copy: Copy<'a>,
}

impl Walk<'_> {
    fn body(&mut self, builder: &mut Builder, region: RegionId) {
        let source = self.source;
        for value in &source.region(region).body {
            if self.copy.is_live(*value) {
                self.node(builder, *value);
            }
        }
    }

    fn node(&mut self, builder: &mut Builder, value: Value) {
        let source = self.source;
        let slopes = match source.node(value) {
            Node::Call(callee, list) => self.call(builder, value, callee, source.list(list)),
            Node::If(condition, then, otherwise) => self.branch(builder, value, condition, then, otherwise),
            Node::Loop(it) => self.repeat(builder, value, it),
            Node::Result(tuple, index) => {
                self.copy.node(builder, value);
                let before: usize = source.types_of(tuple)[..index as usize].iter().map(|ty| ty.size()).sum();
                let size = source.type_of(value).expect("a part is no tuple").size();
                self.slopes[tuple.0 as usize][before..before + size].to_vec()
            }
            _ => {
                self.copy.node(builder, value);
                derivative::slopes(self, builder, value)
            }
        };
        self.slopes[value.0 as usize] = slopes;
    }

    /// The slopes of a value, one for each component; none move where it is a bool.
    fn slopes(&self, value: Value) -> Vec<Slope> {
        match self.source.node(value) {
            Node::Float(_) | Node::Bool(_) | Node::Uniform(_) | Node::Global(_) => vec![self.flat()],
            Node::Argument(region, index) => self.arguments[&region][index as usize].clone(),
            _ => self.slopes[value.0 as usize].clone(),
        }
    }

    /// The slope of what does not move.
    fn flat(&self) -> Slope {
        vec![None; self.parameters.len()]
    }

    fn all_slopes(&self, values: &[Value]) -> Vec<Slope> {
        values.iter().flat_map(|value| self.slopes(*value)).collect()
    }

    // ---- calls

    /// By the chain rule: Σ over the callee's active parameters, ∂result/∂parameter · ∂argument.
    fn call(
        &mut self,
        builder: &mut Builder,
        value: Value,
        callee: FunctionId,
        arguments: &[Value],
    ) -> Vec<Slope> {
        let moving: Vec<Vec<Slope>> = arguments.iter().map(|argument| self.slopes(*argument)).collect();
        let active: Vec<bool> = moving
            .iter()
            .map(|slopes| slopes.iter().flatten().any(|derivative| derivative.is_some()))
            .collect();
        let types = self.source.types_of(value);
        let components: usize = types.iter().map(|ty| ty.size()).sum();
        if !active.contains(&true) {
            self.copy.node(builder, value);
            return vec![self.flat(); components];
        }
        let made = self
            .gradients
            .made(self.program, Request { function: callee, active: active.clone(), complete: false });
        let results = self.program.function(made.function).result_types();
        let arguments = self.copy.values(builder, arguments);
        let mut values = builder.call(made.function, &results, &arguments);
        let mut derivatives = values.split_off(types.len()).into_iter();
        self.copy.set(builder, value, values);
        let mut present = made.present.into_iter();
        let mut slopes = Vec::with_capacity(components);
        for _ in 0..components {
            let mut slope = self.flat();
            for argument in
                moving.iter().zip(&active).filter(|(_, active)| **active).map(|(slopes, _)| slopes)
            {
                if present.next() == Some(true) {
                    let derivative = derivatives.next().expect("a result for each that is present");
                    for (component, inner) in argument.iter().enumerate() {
                        let factor = builder.component(derivative, component);
                        let part = scaled(builder, inner, factor);
                        slope = sum(builder, slope, part);
                    }
                }
            }
            slopes.push(slope);
        }
        slopes
    }

    // ---- regions

    fn branch(
        &mut self,
        builder: &mut Builder,
        value: Value,
        condition: Value,
        then: RegionId,
        otherwise: RegionId,
    ) -> Vec<Slope> {
        let source = self.source;
        let moves = self.activity.of_tuple(value).to_vec();
        let condition = self.copy.value(builder, condition);
        let [then, otherwise] = [then, otherwise].map(|region| {
            builder.open_region(&[]);
            self.body(builder, region);
            let results = &source.region(region).results;
            let mut yielded = self.copy.values(builder, results);
            yielded.extend(self.flattened(builder, &self.all_slopes(results), &moves));
            builder.close_region(yielded)
        });
        let results = builder.branch(condition, then, otherwise);
        self.yielded(builder, value, results, &moves)
    }

    fn repeat(&mut self, builder: &mut Builder, value: Value, it: Loop) -> Vec<Slope> {
        let source = self.source;
        let moves = self.activity.of_tuple(value).to_vec();
        let initial = source.list(it.initial);
        let mut state = self.copy.values(builder, initial);
        state.extend(self.flattened(builder, &self.all_slopes(initial), &moves));
        let types: Vec<Type> = state.iter().map(|v| builder.ty(*v)).collect();

        let until = builder.open_region(&types);
        let arguments = (0..initial.len()).map(|i| builder.argument(until, i as u16)).collect();
        self.copy.enter(it.until, arguments);
        let stop = self.copy.region(builder, it.until);
        builder.close_region(stop);

        let with_round: Vec<Type> = std::iter::once(Type::Float).chain(types.iter().copied()).collect();
        let next = builder.open_region(&with_round);
        let mut arguments: Vec<Value> =
            (0..with_round.len()).map(|i| builder.argument(next, i as u16)).collect();
        let slopes = self.restored(arguments.split_off(1 + initial.len()), &moves);
        self.copy.enter(it.next, arguments);
        let mut by_argument = vec![vec![self.flat()]];
        let mut slopes = slopes.into_iter();
        for value in initial {
            let size = source.type_of(*value).expect("a state is no tuple").size();
            by_argument.push(slopes.by_ref().take(size).collect());
        }
        self.arguments.insert(it.next, by_argument);
        self.body(builder, it.next);
        let results = &source.region(it.next).results;
        let mut yielded = self.copy.values(builder, results);
        yielded.extend(self.flattened(builder, &self.all_slopes(results), &moves));
        builder.close_region(yielded);

        let results = builder.repeat_to(self.copy.rounds(it), &state, until, next);
        self.yielded(builder, value, results, &moves)
    }

    /// The derivatives that a region yields: those that may move, zeros included.
    fn flattened(&self, builder: &mut Builder, slopes: &[Slope], moves: &[Vec<bool>]) -> Vec<Value> {
        let mut flat = Vec::new();
        for (slope, moves) in slopes.iter().zip(moves) {
            for (place, _) in moves.iter().enumerate().filter(|(_, moves)| **moves) {
                flat.push(slope[place].unwrap_or_else(|| zero(builder, self.parameters[place])));
            }
        }
        flat
    }

    /// The slopes of which `flattened` made a list.
    fn restored(&self, flat: Vec<Value>, moves: &[Vec<bool>]) -> Vec<Slope> {
        let mut flat = flat.into_iter();
        let restore = |moves: &bool| moves.then(|| flat.next().expect("a value for each that moves"));
        let mut restore = restore;
        moves.iter().map(|slope| slope.iter().map(&mut restore).collect()).collect()
    }

    /// Parts the results of a copied branch or loop into values and slopes.
    fn yielded(
        &mut self,
        builder: &mut Builder,
        value: Value,
        mut results: Vec<Value>,
        moves: &[Vec<bool>],
    ) -> Vec<Slope> {
        let derivatives = results.split_off(self.source.types_of(value).len());
        self.copy.set(builder, value, results);
        let slopes = self.restored(derivatives, moves);
        slopes.into_iter().map(|slope| without_zeros(builder, slope)).collect()
    }
}

// ---- slopes

/// A slope in which what has turned out to be zero is nothing.
fn without_zeros(builder: &Builder, slope: Slope) -> Slope {
    let is_zero = |v: Value| builder.constant_of(v).is_some_and(|c| c.components().iter().all(|x| *x == 0.0));
    slope.into_iter().map(|derivative| derivative.filter(|v| !is_zero(*v))).collect()
}

/// The slope with each derivative that there is made into another.
fn each(
    builder: &mut Builder,
    slope: &[Option<Value>],
    make: impl Fn(&mut Builder, Value) -> Value,
) -> Slope {
    let slope = slope.iter().map(|derivative| derivative.map(|v| make(builder, v))).collect();
    without_zeros(builder, slope)
}

fn scaled(builder: &mut Builder, slope: &[Option<Value>], factor: Value) -> Slope {
    each(builder, slope, |b, derivative| b.mul(derivative, factor))
}

fn divided(builder: &mut Builder, slope: &[Option<Value>], divisor: Value) -> Slope {
    each(builder, slope, |b, derivative| b.div(derivative, divisor))
}

fn negated(builder: &mut Builder, slope: &[Option<Value>]) -> Slope {
    each(builder, slope, |b, derivative| b.neg(derivative))
}

fn sum(builder: &mut Builder, x: Slope, y: Slope) -> Slope {
    let pairs = x.into_iter().zip(y);
    let slope = pairs.map(|pair| match pair {
        (Some(x), Some(y)) => Some(builder.add(x, y)),
        (x, y) => x.or(y),
    });
    let slope = slope.collect();
    without_zeros(builder, slope)
}

fn difference(builder: &mut Builder, x: Slope, y: Slope) -> Slope {
    let pairs = x.into_iter().zip(y);
    let slope = pairs.map(|pair| match pair {
        (Some(x), Some(y)) => Some(builder.sub(x, y)),
        (None, Some(y)) => Some(builder.neg(y)),
        (x, None) => x,
    });
    let slope = slope.collect();
    without_zeros(builder, slope)
}

fn chosen(builder: &mut Builder, condition: Value, x: Slope, y: Slope, parameters: &[Type]) -> Slope {
    let pairs = x.into_iter().zip(y).zip(parameters);
    let slope = pairs.map(|((x, y), ty)| {
        if x.is_none() && y.is_none() {
            return None;
        }
        let x = x.unwrap_or_else(|| zero(builder, *ty));
        let y = y.unwrap_or_else(|| zero(builder, *ty));
        Some(builder.select(condition, x, y))
    });
    let slope = slope.collect();
    without_zeros(builder, slope)
}
