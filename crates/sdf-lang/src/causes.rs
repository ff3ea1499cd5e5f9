//! What calls for an effect: a value that may be other than zero, what it depends on, and what would make it zero.
//!
//! All of it is found by interval arithmetic, for all values of the params, at all times and at all points: a value of which
//! that proves that it is zero calls for nothing.

use crate::errors::short;
use crate::eval::Elaborator;
use crate::value::{Number, Repr};
use sdf_ir::interval::{Bounds, Growing};
use sdf_ir::{Constant, Function, Node, RegionId, Role, Type, Uniform};
use sdf_syntax::Span;
use std::collections::BTreeSet;

/// A magnitude from which on a value counts as having no bound.
const ENDLESS: f64 = 1e30;

/// A value that calls for an effect.
#[derive(Debug, Clone)]
pub(crate) struct Cause {
    /// What it is, in words.
    pub words: String,
    /// Where it is written.
    pub span: Option<Span>,
    /// The uniforms that it depends on.
    pub depends_on: Vec<String>,
    /// Where its components lie, if they have bounds.
    pub range: Option<[f64; 2]>,
    /// Values of params that make it zero, within their ranges, as `--set` takes them.
    pub zeroed_by: Vec<(String, String)>,
}

impl<'t> Elaborator<'t> {
    /// Whether a number may be other than zero, for some values of the params and at some time.
    pub fn may_be_nonzero(&mut self, number: &Number) -> bool {
        match number.known() {
            Some(constant) => constant.components().iter().any(|x| *x != 0.0),
            None => !is_zero(&self.bounds_of_number(number)),
        }
    }

    /// What there is to say of a setting that calls for an effect.
    pub fn cause(&mut self, name: &str, number: &Number, span: Option<Span>) -> Cause {
        let (uniforms, params) = self.uniforms_behind(number);
        let range = range_of(&self.bounds_of_number(number));
        let depends_on: Vec<String> = uniforms.iter().map(|u| u.name.to_string()).collect();
        let words = in_words(name, number, &depends_on, range);
        let mut zeroed_by = Vec::new();
        for index in params {
            zeroed_by.extend(self.zeroed_by(number, index));
        }
        Cause { words, span, depends_on, range, zeroed_by }
    }

    /// The values of a param, among those that are tried, that make a number zero.
    fn zeroed_by(&mut self, number: &Number, param: usize) -> Vec<(String, String)> {
        let uniform = self.contexts.program.uniforms[param].clone();
        let mut uniforms = self.bounds_of_uniforms();
        let mut found = Vec::new();
        for (constant, text) in trials(&uniform) {
            uniforms[param] = Bounds::constant(constant);
            if is_zero(&self.bounds_for(number, &uniforms)) {
                found.push((uniform.name.to_string(), text));
            }
        }
        found
    }

    /// Where a number lies if the uniforms lie here.
    fn bounds_for(&self, number: &Number, uniforms: &[Bounds]) -> Bounds {
        let program = &self.contexts.program;
        let mut frame = Growing::of(uniforms.to_vec(), Vec::new());
        let mut in_frame = |value| frame.bounds_of(program, self.contexts.frame_builder(), value, uniforms);
        match &number.repr {
            Repr::Static(constant) => Bounds::constant(*constant),
            Repr::Outer(_, inner) => self.bounds_for(inner, uniforms),
            Repr::Frame(value) => in_frame(*value),
            Repr::Local(depth, value) => {
                let globals = self.contexts.global_values().iter().map(|value| in_frame(*value)).collect();
                match self.contexts.open_builder(*depth) {
                    Some((builder, _)) => {
                        Growing::of(uniforms.to_vec(), globals).bounds_of(program, builder, *value, uniforms)
                    }
                    None => Bounds::anything(number.ty),
                }
            }
        }
    }

    /// The uniforms that a number is computed from, in the order of the program, and which of these are params.
    fn uniforms_behind(&self, number: &Number) -> (Vec<Uniform>, Vec<usize>) {
        let mut behind = Behind { elaborator: self, uniforms: BTreeSet::new() };
        behind.number(number);
        let all = &self.contexts.program.uniforms;
        let is_told = |index: &usize| !matches!(all[*index].role, Role::Resolution | Role::Setting);
        let found: Vec<usize> = behind.uniforms.into_iter().filter(is_told).collect();
        let is_param = |index: &usize| matches!(all[*index].role, Role::Param { .. });
        let params = found.iter().copied().filter(is_param).collect();
        (found.into_iter().map(|index| all[index].clone()).collect(), params)
    }
}

/// The search for the uniforms that a number is computed from.
struct Behind<'e, 't> {
    elaborator: &'e Elaborator<'t>,
    uniforms: BTreeSet<usize>,
}

impl Behind<'_, '_> {
    fn number(&mut self, number: &Number) {
        let contexts = &self.elaborator.contexts;
        match &number.repr {
            Repr::Static(_) => {}
            Repr::Outer(_, inner) => self.number(inner),
            Repr::Frame(value) => self.value(contexts.frame(), *value),
            Repr::Local(depth, value) => {
                if let Some((builder, _)) = contexts.open_builder(*depth) {
                    self.value(builder.function(), *value);
                }
            }
        }
    }

    /// A node of a function, and all that it is computed from.
    fn value(&mut self, function: &Function, value: sdf_ir::Value) {
        let mut seen = BTreeSet::new();
        let mut rest = vec![value];
        while let Some(value) = rest.pop() {
            if !seen.insert(value) {
                continue;
            }
            function.operands(value, |operand| rest.push(operand));
            for region in function.owned_regions(value) {
                rest.extend(&function.region(region).results);
            }
            self.leaf(function.node(value));
        }
    }

    fn leaf(&mut self, node: Node) {
        let contexts = &self.elaborator.contexts;
        match node {
            Node::Uniform(index) => {
                self.uniforms.insert(usize::from(index));
            }
            Node::Global(index) => {
                let value = contexts.global_values()[usize::from(index)];
                self.value(contexts.frame(), value);
            }
            Node::Call(callee, _) => {
                let callee = contexts.program.function(callee);
                for result in &callee.region(RegionId::ROOT).results {
                    self.value(callee, *result);
                }
            }
            _ => {}
        }
    }
}

fn is_zero(bounds: &Bounds) -> bool {
    bounds.parts().iter().all(|part| part.lo == 0.0 && part.hi == 0.0)
}

/// From the least component to the largest, where both have bounds.
fn range_of(bounds: &Bounds) -> Option<[f64; 2]> {
    let lo = bounds.parts().iter().map(|part| part.lo).fold(f64::INFINITY, f64::min);
    let hi = bounds.parts().iter().map(|part| part.hi).fold(f64::NEG_INFINITY, f64::max);
    (lo.abs() < ENDLESS && hi.abs() < ENDLESS).then_some([lo, hi])
}

/// What a setting is, as a clause.
fn in_words(name: &str, number: &Number, depends_on: &[String], range: Option<[f64; 2]>) -> String {
    if let Some(constant) = number.known() {
        let parts: Vec<String> = constant.components().iter().map(|x| short(*x)).collect();
        return match &parts[..] {
            [one] => format!("`{name}` is {one}"),
            parts => format!("`{name}` is ({})", parts.join(", ")),
        };
    }
    let names: Vec<String> = depends_on.iter().map(|name| format!("`{name}`")).collect();
    let how = match names.is_empty() {
        true => "varies over the surface".to_string(),
        false => format!("depends on {}", names.join(" and ")),
    };
    match range {
        // What lies farthest from zero.
        Some([lo, hi]) => {
            let end = if -lo > hi { lo } else { hi };
            format!("`{name}` {how} and may reach {}", short(end))
        }
        None => format!("`{name}` {how}"),
    }
}

/// The values of a param that are tried: zero and the ends of its range, or what else it may be, and how each is written.
fn trials(uniform: &Uniform) -> Vec<(Constant, String)> {
    let Role::Param { range, .. } = uniform.role else { return Vec::new() };
    match uniform.ty {
        Type::Bool => [false, true].map(|x| (Constant::Bool(x), x.to_string())).to_vec(),
        Type::Float => {
            let (lo, hi) = range.unwrap_or((0.0, 0.0));
            let mut numbers = vec![0.0, lo, hi];
            numbers.retain(|x| (lo..=hi).contains(x));
            numbers.dedup();
            numbers.into_iter().map(|x| (Constant::Float(x), x.to_string())).collect()
        }
        Type::Vec3 => vec![
            (Constant::Vec3([0.0; 3]), "#000000".to_string()),
            (Constant::Vec3([1.0; 3]), "#ffffff".to_string()),
        ],
        Type::Vec2 => Vec::new(),
    }
}
