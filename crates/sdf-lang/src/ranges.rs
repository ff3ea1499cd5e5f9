//! What numbers may be, and whether params or the time can make them something else: by trying values of them. What is
//! found that way is certain, for a value that does it is named; what is not found is not proved absent.

use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::value::{Number, Repr};
use sdf_ir::{Constant, Function, Node, Role, Type, Uniform};
use sdf_syntax::Span;
use std::collections::{BTreeSet, HashMap};

/// How many nodes of the frame one number may depend on for its values to be tried.
const MOST_NODES: usize = 1000;
/// Of how many params all combinations of their ends are tried.
const MOST_COMBINED: usize = 4;
/// At how many places of the range of a single param a number is tried.
const STEPS: u32 = 16;

/// The values that a number may have.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range {
    /// Whether a component is one of them.
    pub accepts: fn(f64) -> bool,
    /// The range as a message says it, after "expected".
    pub words: &'static str,
}

/// All numbers above zero.
pub(crate) const POSITIVE: Range = Range { accepts: |x| x > 0.0, words: "more than 0" };
/// All numbers but those below zero.
pub(crate) const NOT_NEGATIVE: Range = Range { accepts: |x| x >= 0.0, words: "at least 0" };
/// Shares of a whole.
pub(crate) const SHARE: Range = Range { accepts: |x| (0.0..=1.0).contains(&x), words: "0 to 1" };
/// All numbers from one on.
pub(crate) const AT_LEAST_ONE: Range = Range { accepts: |x| x >= 1.0, words: "at least 1" };

impl<'t> Elaborator<'t> {
    /// Checks that a number lies in its range: an error where it never does, a warning where params can move it out.
    pub fn check_range(&mut self, number: &Number, span: Span, what: &str, range: Range) -> Eval<()> {
        let fits = |c: &Constant| c.components().iter().all(|x| (range.accepts)(*x));
        match number.known() {
            Some(c) if fits(&c) => Ok(()),
            Some(_) => self.report(errors::out_of_range(span, what, range.words)),
            None => {
                if let Some(when) = self.when(number, |c| !fits(c)) {
                    self.warn(errors::may_leave_range(span, what, range.words, &when));
                }
                Ok(())
            }
        }
    }

    /// Values of params within their ranges for which a number of the frame fails, in words: `` `k` is 2 ``.
    pub fn when(&self, number: &Number, fails: impl Fn(&Constant) -> bool) -> Option<String> {
        let mut number = number;
        while let Repr::Outer(_, inner) = &number.repr {
            number = inner;
        }
        let Repr::Frame(value) = number.repr else { return None };
        let (function, uniforms) = (self.contexts.frame(), &self.contexts.program.uniforms);
        let params = params_of(function, uniforms, value)?;
        let mut values: Vec<Constant> = uniforms.iter().map(|u| u.default).collect();
        for row in trials(uniforms, &params) {
            for (param, value) in params.iter().zip(&row) {
                values[*param] = *value;
            }
            let mut known = HashMap::new();
            if fails(&worth(function, &values, value, &mut known)?) {
                let words = params.iter().zip(&row).map(|(param, value)| {
                    format!("`{}` is {}", uniforms[*param].name, value_in_words(value))
                });
                return Some(words.collect::<Vec<_>>().join(" and "));
            }
        }
        None
    }
}

/// The params that a node of the frame depends on; nothing where there are none, where what it depends on is too
/// much, or has branches, loops or calls in it.
fn params_of(function: &Function, uniforms: &[Uniform], value: sdf_ir::Value) -> Option<Vec<usize>> {
    let mut params = BTreeSet::new();
    let mut seen = BTreeSet::new();
    let mut rest = vec![value];
    while let Some(value) = rest.pop() {
        if !seen.insert(value) {
            continue;
        }
        match function.node(value) {
            Node::Uniform(index)
                if matches!(uniforms[usize::from(index)].role, Role::Param { .. } | Role::Time) =>
            {
                params.insert(usize::from(index));
            }
            Node::Call(..) | Node::If(..) | Node::Loop(_) | Node::Result(..) | Node::Argument(..) => {
                return None;
            }
            _ => function.operands(value, |operand| rest.push(operand)),
        }
        if seen.len() > MOST_NODES {
            return None;
        }
    }
    (!params.is_empty()).then(|| params.into_iter().collect())
}

/// The values of params that are tried, a row for each trial, the defaults first.
fn trials(uniforms: &[Uniform], params: &[usize]) -> Vec<Vec<Constant>> {
    let ends: Vec<Vec<Constant>> = params.iter().map(|param| ends(&uniforms[*param])).collect();
    let defaults: Vec<Constant> = ends.iter().map(|values| values[0]).collect();
    let mut rows = vec![defaults.clone()];
    if params.len() <= MOST_COMBINED {
        for (i, values) in ends.iter().enumerate() {
            let others = values[1..].iter().flat_map(|value| {
                rows.iter().map(move |row| {
                    let mut row = row.clone();
                    row[i] = *value;
                    row
                })
            });
            let more: Vec<_> = others.collect();
            rows.extend(more);
        }
    } else {
        let one_by_one = ends.iter().enumerate().flat_map(|(i, values)| {
            let defaults = &defaults;
            values[1..].iter().map(move |value| {
                let mut row = defaults.clone();
                row[i] = *value;
                row
            })
        });
        rows.extend(one_by_one);
    }
    if let [param] = params {
        let at = |low: f64, high: f64, i| {
            vec![Constant::Float(low + (high - low) * f64::from(i) / f64::from(STEPS))]
        };
        match uniforms[*param].role {
            Role::Param { range: Some((low, high)), .. } => rows.extend((1..STEPS).map(|i| at(low, high, i))),
            // What moves does so within some seconds.
            Role::Time => rows.extend((1..10 * STEPS).map(|i| at(0.0, 1.0, i))),
            _ => {}
        }
    }
    rows
}

/// The default of a param, and the ends of its range.
fn ends(uniform: &Uniform) -> Vec<Constant> {
    let mut out = vec![uniform.default];
    match (uniform.role, uniform.default.ty()) {
        (Role::Param { range: Some((low, high)), .. }, _) => {
            out.extend([Constant::Float(low), Constant::Float(high)]);
        }
        (Role::Time, _) => out.push(Constant::Float(10.0)),
        (_, Type::Bool) => out.extend([Constant::Bool(false), Constant::Bool(true)]),
        _ => out.extend([Constant::Vec3([0.0; 3]), Constant::Vec3([1.0; 3])]),
    }
    out
}

/// The value of a node of the frame, where all that it depends on is arithmetic.
fn worth(
    function: &Function,
    uniforms: &[Constant],
    value: sdf_ir::Value,
    known: &mut HashMap<sdf_ir::Value, Constant>,
) -> Option<Constant> {
    if let Some(c) = known.get(&value) {
        return Some(*c);
    }
    let mut at = |v: sdf_ir::Value| worth(function, uniforms, v, known);
    let c = match function.node(value) {
        Node::Float(bits) => Constant::Float(f64::from_bits(bits)),
        Node::Bool(b) => Constant::Bool(b),
        Node::Uniform(index) => uniforms[usize::from(index)],
        Node::Unary(op, a) => Constant::unary(op, at(a)?),
        Node::Binary(op, a, b) => Constant::binary(op, at(a)?, at(b)?),
        Node::Ternary(op, a, b, c) => Constant::ternary(op, at(a)?, at(b)?, at(c)?),
        Node::Compose2(x, y) => composed(&[at(x)?, at(y)?]),
        Node::Compose3(x, y, z) => composed(&[at(x)?, at(y)?, at(z)?]),
        Node::Component(a, index) => Constant::Float(at(a)?.components()[usize::from(index)]),
        _ => return None,
    };
    known.insert(value, c);
    Some(c)
}

fn composed(parts: &[Constant]) -> Constant {
    let parts: Vec<f64> = parts.iter().map(|c| c.components()[0]).collect();
    Constant::from_components(&parts)
}

fn value_in_words(value: &Constant) -> String {
    match value {
        Constant::Bool(b) => b.to_string(),
        // As many digits as a reader wants.
        Constant::Float(x) => format!("{x:.3e}").parse().map_or(x.to_string(), |x: f64| x.to_string()),
        Constant::Vec3([0.0, 0.0, 0.0]) => "black".to_string(),
        Constant::Vec3([1.0, 1.0, 1.0]) => "white".to_string(),
        _ => "the default".to_string(),
    }
}
