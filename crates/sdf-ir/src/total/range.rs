//! Where the numbers of a program lie: just enough to see that a guard is not needed.
//!
//! A range holds for every component of a value, in `f32` as in `f64`: each is a little wider than what was
//! computed. It says nothing about the state of loops.

use crate::number::LARGEST;
use crate::program::{Binary, Function, FunctionId, Node, Program, RegionId, Role, Ternary, Unary, Value};
use rustc_hash::FxHashMap;

/// The most rounds that any loop has.
const MOST_ROUNDS: f64 = 65_536.0;

/// The promised size of a component of a point.
const POINT: f64 = 1e18;

/// All numbers from `lo` to `hi`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    pub lo: f64,
    pub hi: f64,
}

impl Range {
    /// Every number.
    pub(crate) const ALL: Range = Range { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    fn new(lo: f64, hi: f64) -> Range {
        Range { lo, hi }
    }

    /// The range of these ends, wider by more than roundings of `f32` can be. What lies so near to zero that it may
    /// be flushed counts as zero.
    fn rounded(lo: f64, hi: f64) -> Range {
        let lo = if lo.is_nan() { f64::NEG_INFINITY } else { lo - lo.abs() * 1e-6 };
        let hi = if hi.is_nan() { f64::INFINITY } else { hi + hi.abs() * 1e-6 };
        let flushed = |x: f64| if x.abs() < 1e-37 { 0.0 } else { x };
        Range::new(flushed(lo), flushed(hi))
    }

    /// The least range with both in it.
    fn hull(self, other: Range) -> Range {
        Range::new(self.lo.min(other.lo), self.hi.max(other.hi))
    }

    /// The largest magnitude.
    pub(crate) fn most(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The least magnitude.
    pub(crate) fn least(self) -> f64 {
        if self.lo > 0.0 {
            self.lo
        } else if self.hi < 0.0 {
            -self.hi
        } else {
            0.0
        }
    }

    fn add(self, other: Range) -> Range {
        Range::rounded(self.lo + other.lo, self.hi + other.hi)
    }

    fn negate(self) -> Range {
        Range::new(-self.hi, -self.lo)
    }

    fn multiply(self, other: Range) -> Range {
        // 0 times an infinite end is 0: the end is no number, only beyond all of them.
        let times = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let ends = [
            times(self.lo, other.lo),
            times(self.lo, other.hi),
            times(self.hi, other.lo),
            times(self.hi, other.hi),
        ];
        let lo = ends.iter().copied().fold(f64::INFINITY, f64::min);
        Range::rounded(lo, ends.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    }

    fn square(self) -> Range {
        Range::rounded(self.least() * self.least(), self.most() * self.most())
    }

    fn map(self, f: impl Fn(f64) -> f64) -> Range {
        Range::rounded(f(self.lo), f(self.hi))
    }
}

/// The ranges of all values of a program. Holds for what the entry, and functions that nothing calls, do.
pub(crate) struct Ranges<'p> {
    walk: Walk<'p>,
    functions: Vec<Values>,
}

impl<'p> Ranges<'p> {
    /// The ranges of a program's values.
    pub(crate) fn of(program: &'p Program) -> Ranges<'p> {
        let mut walk =
            Walk { program, globals: vec![Range::ALL; program.globals.len()], results: Vec::new() };
        for function in &program.functions {
            let parameters = function.parameters.iter().map(|p| parameter(p.point)).collect();
            let values = walk.function(function, parameters, |_, _| {});
            walk.results
                .push(function.root().results.iter().map(|v| walk.at(function, &values, *v)).collect());
        }
        if let Some(frame) = program.frame {
            walk.globals = walk.results[frame.0 as usize].clone();
        }
        // Callers first, so that all call sites are known when a callee's turn comes.
        let mut called: Vec<Option<Vec<Range>>> = vec![None; program.functions.len()];
        let mut functions = Vec::new();
        for (i, function) in program.functions.iter().enumerate().rev() {
            let from_calls = called[i].take().filter(|_| Some(FunctionId(i as u32)) != program.entry);
            let parameters = match from_calls {
                Some(ranges) => ranges
                    .into_iter()
                    .zip(&function.parameters)
                    .map(|(range, p)| if p.point && !is_scaled_up(range) { parameter(true) } else { range })
                    .collect(),
                None => function.parameters.iter().map(|p| parameter(p.point)).collect(),
            };
            functions.push(walk.function(function, parameters, |callee, arguments| {
                let joined = called[callee.0 as usize].get_or_insert_with(|| arguments.to_vec());
                for (joined, argument) in joined.iter_mut().zip(arguments) {
                    *joined = joined.hull(*argument);
                }
            }));
        }
        functions.reverse();
        Ranges { walk, functions }
    }

    /// The range of a value that is no tuple.
    pub(crate) fn get(&self, function: FunctionId, value: Value) -> Range {
        self.walk.at(self.walk.program.function(function), &self.functions[function.0 as usize], value)
    }
}

/// Whether points are multiplied by so much that what is promised of points does not hold of them. Where nothing is known
/// of them, as of those along a ray, the promise holds.
fn is_scaled_up(range: Range) -> bool {
    range.most().is_finite() && range.most() > POINT * 1e6
}

fn parameter(point: bool) -> Range {
    if point { Range::new(-POINT, POINT) } else { Range::ALL }
}

struct Walk<'p> {
    program: &'p Program,
    globals: Vec<Range>,
    /// What the results of each function can be, whatever its arguments.
    results: Vec<Vec<Range>>,
}

/// The ranges of each value of a function so far; several for a tuple.
type Values = Vec<Vec<Range>>;

impl Walk<'_> {
    fn function(
        &self,
        function: &Function,
        parameters: Vec<Range>,
        mut on_call: impl FnMut(FunctionId, &[Range]),
    ) -> Values {
        let mut values: Values = vec![Vec::new(); function.node_count()];
        let mut arguments = FxHashMap::from_iter([(RegionId::ROOT, parameters)]);
        self.region(function, &mut values, &mut arguments, RegionId::ROOT, &mut on_call);
        // Arguments stand in no body, but are asked for later like what does.
        for (i, value) in values.iter_mut().enumerate() {
            if let Node::Argument(region, index) = function.node(Value(i as u32))
                && let Some(ranges) = arguments.get(&region)
            {
                *value = vec![ranges[index as usize]];
            }
        }
        values
    }

    fn region(
        &self,
        function: &Function,
        values: &mut Values,
        arguments: &mut FxHashMap<RegionId, Vec<Range>>,
        region: RegionId,
        on_call: &mut dyn FnMut(FunctionId, &[Range]),
    ) {
        for value in &function.region(region).body {
            let ranges = match function.node(*value) {
                Node::If(_, then, otherwise) => {
                    for side in [then, otherwise] {
                        self.region(function, values, arguments, side, on_call);
                    }
                    let results = |region| function.region(region).results.iter();
                    let hull = |(a, b): (&Value, &Value)| {
                        let of = |v: &Value| self.value(function, values, arguments, *v);
                        of(a).hull(of(b))
                    };
                    results(then).zip(results(otherwise)).map(hull).collect()
                }
                Node::Loop(repeat) => {
                    let state = vec![Range::ALL; function.list(repeat.initial).len()];
                    // A reader of a text may change what it names.
                    let most = if repeat.limit.is_some() { MOST_ROUNDS } else { f64::from(repeat.count) };
                    let mut with_index = vec![Range::new(0.0, most)];
                    with_index.extend(&state);
                    arguments.insert(repeat.until, state.clone());
                    arguments.insert(repeat.next, with_index);
                    for part in [repeat.until, repeat.next] {
                        self.region(function, values, arguments, part, on_call);
                    }
                    state
                }
                Node::Call(callee, list) => {
                    let given: Vec<Range> = function
                        .list(list)
                        .iter()
                        .map(|v| self.value(function, values, arguments, *v))
                        .collect();
                    on_call(callee, &given);
                    self.results[callee.0 as usize].clone()
                }
                Node::Result(tuple, index) => vec![values[tuple.0 as usize][index as usize]],
                node => vec![self.operation(node, |v| self.value(function, values, arguments, v))],
            };
            values[value.0 as usize] = ranges;
        }
    }

    fn value(
        &self,
        function: &Function,
        values: &Values,
        arguments: &FxHashMap<RegionId, Vec<Range>>,
        value: Value,
    ) -> Range {
        match function.node(value) {
            Node::Argument(region, index) => arguments[&region][index as usize],
            _ => self.at(function, values, value),
        }
    }

    /// The range of a value that has been computed, or of a leaf.
    fn at(&self, function: &Function, values: &Values, value: Value) -> Range {
        match function.node(value) {
            Node::Float(bits) => {
                let x = f64::from_bits(bits);
                Range::rounded(x, x)
            }
            Node::Bool(_) => Range::ALL,
            Node::Uniform(index) => self.uniform(index),
            Node::Global(index) => self.globals[index as usize],
            _ => values[value.0 as usize].first().copied().unwrap_or(Range::ALL),
        }
    }

    fn uniform(&self, index: u16) -> Range {
        match self.program.uniforms[index as usize].role {
            Role::Time => Range::new(0.0, f64::INFINITY),
            Role::Resolution => Range::new(1.0, 1e6),
            Role::Param { range: Some((lo, hi)), .. } => Range::rounded(lo.min(hi), lo.max(hi)),
            Role::Mouse | Role::Orbit { .. } | Role::Setting | Role::Param { .. } => Range::ALL,
        }
    }

    fn operation(&self, node: Node, at: impl Fn(Value) -> Range) -> Range {
        match node {
            Node::Unary(op, a) => unary(op, at(a)),
            Node::Binary(op, a, b) => binary(op, at(a), at(b), a == b),
            Node::Ternary(Ternary::Select, _, a, b) => at(a).hull(at(b)),
            Node::Ternary(Ternary::Mix, a, b, t) => mix(at(a), at(b), at(t)),
            Node::Compose2(x, y) => at(x).hull(at(y)),
            Node::Compose3(x, y, z) => at(x).hull(at(y)).hull(at(z)),
            Node::Component(a, _) => at(a),
            _ => Range::ALL,
        }
    }
}

fn unary(op: Unary, a: Range) -> Range {
    use std::f64::consts::PI;
    match op {
        Unary::Negate => a.negate(),
        Unary::Abs => Range::new(a.least(), a.most()),
        Unary::Sign | Unary::Sin | Unary::Cos | Unary::Tanh | Unary::Normalize => Range::rounded(-1.0, 1.0),
        Unary::Floor | Unary::Trunc | Unary::Ceil | Unary::Round => {
            Range::rounded(a.lo.floor().min(a.lo.trunc()), a.hi.ceil())
        }
        Unary::Sqrt => a.map(|x| x.max(0.0).sqrt()),
        Unary::Asin | Unary::Acos | Unary::Atan => Range::rounded(-PI, PI),
        Unary::Exp => Range::rounded(a.lo.exp(), a.hi.exp().min(LARGEST)),
        Unary::Exp2 | Unary::PowerOfTwo => Range::rounded(a.lo.exp2(), a.hi.exp2().min(LARGEST)),
        Unary::Log | Unary::Log2 => Range::new(-130.0, 130.0),
        Unary::Length => Range::rounded(a.least(), a.most() * 3f64.sqrt()),
        Unary::Hash => Range::new(0.0, 1.0),
        Unary::Exponent => Range::new(-127.0, 128.0),
        Unary::Mantissa => Range::new(1.0, 2.0),
        Unary::ReduceAngle => Range::new(-1.0, 3.0),
        Unary::Not | Unary::Tan => Range::ALL,
    }
}

fn binary(op: Binary, a: Range, b: Range, same: bool) -> Range {
    match op {
        Binary::Add => a.add(b),
        Binary::Subtract => a.add(b.negate()),
        Binary::Multiply if same => a.square(),
        Binary::Multiply => a.multiply(b),
        Binary::Divide if b.least() > 0.0 => a.multiply(Range::rounded(1.0 / b.hi, 1.0 / b.lo)),
        // The remainder of what is far larger than the divisor may miss the range by a rounding of it.
        Binary::Modulo => Range::rounded(b.lo.min(0.0) - a.most() * 1e-6, b.hi.max(0.0) + a.most() * 1e-6),
        Binary::Min => Range::new(a.lo.min(b.lo), a.hi.min(b.hi)),
        Binary::Max => Range::new(a.lo.max(b.lo), a.hi.max(b.hi)),
        Binary::Power if a.lo >= 0.0 => Range::new(0.0, f64::INFINITY),
        Binary::Atan2 => Range::new(-4.0, 4.0),
        Binary::Dot if same => {
            let square = a.square();
            Range::rounded(square.lo, square.hi * 3.0)
        }
        Binary::Dot => {
            let most = a.multiply(b).most() * 3.0;
            Range::rounded(-most, most)
        }
        Binary::Cross => {
            let most = a.multiply(b).most() * 2.0;
            Range::rounded(-most, most)
        }
        Binary::Divide
        | Binary::Power
        | Binary::Less
        | Binary::LessEqual
        | Binary::Equal
        | Binary::And
        | Binary::Or => Range::ALL,
    }
}

fn mix(a: Range, b: Range, t: Range) -> Range {
    if t.lo >= 0.0 && t.hi <= 1.0 {
        let hull = a.hull(b);
        return Range::rounded(hull.lo, hull.hi);
    }
    let rest = Range::rounded(1.0 - t.hi, 1.0 - t.lo);
    a.multiply(rest).add(b.multiply(t))
}
