//! The expressions of contracts as numbers that hold for all values of the params and for all times.

use crate::eval::{Elaborator, Eval};
use crate::facts::{Stated, flat};
use crate::value::{Env, Fields, List, Module, Number, Repr, Value};
use sdf_ir::interval::{Bounds, Growing, Interval, Walker, bounds_of_uniform};
use sdf_ir::region::{Extent, FAR};
use sdf_ir::{Constant, Type};
use sdf_syntax::tree::{Dimension, Expr, Function};
use std::rc::Rc;
use std::sync::Arc;

/// How often the region is halved for a tighter bound on a stated slope.
const PIECES: usize = 64;

impl<'t> Elaborator<'t> {
    /// The box that a contract states for the points where the field is at most `level`.
    pub fn stated_extent(&mut self, stated: &Stated<'t>, dimension: Dimension, level: f64) -> Eval<Extent> {
        let (lo, hi, _) = stated.contract.bounds.expect("it was asked for");
        let env = outermost(&stated.env);
        // A parameter of that name hides it.
        let is_hidden = env.get("level").is_some();
        let env = if is_hidden { env } else { env.bind(Arc::from("level"), Value::float(level)) };
        let before = std::mem::replace(&mut self.facts.level, level);
        let corners = self
            .calling_anew(|this| Ok((this.corner(lo, &env, dimension)?, this.corner(hi, &env, dimension)?)));
        self.facts.level = before;
        let (lo, hi) = corners?;
        let ends = |corner: [Interval; 3], pick: fn(Interval) -> f64| corner.map(pick);
        Ok(flat(Extent::new(ends(lo, |i| i.lo), ends(hi, |i| i.hi)), dimension))
    }

    /// A corner of a box.
    fn corner(&mut self, expr: &'t Expr, env: &Env<'t>, dimension: Dimension) -> Eval<[Interval; 3]> {
        let value = self.eval(expr, env)?;
        let ty = if dimension == Dimension::Three { Type::Vec3 } else { Type::Vec2 };
        let number = self.as_typed(value, ty, expr.span)?;
        let bounds = self.bounds_of_number(&number);
        Ok(std::array::from_fn(|i| if i < ty.size() { bounds.part(i) } else { Interval::ZERO }))
    }

    /// The largest value in a region of an expression that may use the point `p`, with `d` being 0; infinite where
    /// no end is known.
    pub fn stated_number(
        &mut self,
        expr: &'t Expr,
        env: &Env<'t>,
        dimension: Dimension,
        region: &Extent,
    ) -> Eval<f64> {
        let env = outermost(env);
        let ty = if dimension == Dimension::Three { Type::Vec3 } else { Type::Vec2 };
        self.contexts.open(&Arc::from("promise"), None);
        let point = self.contexts.entry_parameter("p", ty);
        let inner = env.bind(Arc::from("p"), Value::Number(point)).bind(Arc::from("d"), Value::float(0.0));
        let number = self.calling_anew(|this| {
            let value = this.eval(expr, &inner)?;
            this.as_typed(value, Type::Float, expr.span)
        });
        let number = match number {
            Ok(number) => number,
            Err(reported) => {
                self.contexts.discard();
                return Err(reported);
            }
        };
        if !number.is_local() {
            self.contexts.discard();
            let known = self.bounds_of_number(&number);
            return Ok(ended(known.number().hi));
        }
        let value = self.contexts.value(&number);
        let (function, outside) = self.contexts.finish_apart(vec![value]);
        if !outside.is_empty() {
            // It depends on what an open function computes.
            return Ok(f64::INFINITY);
        }
        let globals = self.bounds_of_globals();
        let uniforms = self.bounds_of_uniforms();
        let program = &self.contexts.program;
        let mut walker = Walker::<Bounds>::new(program, &function, &uniforms, &globals);
        let ask = |cell: &Extent| {
            let at = walker.run(&[bounds_of_cell(cell, ty)])[0].number();
            sdf_ir::region::Steepness { at_most: ended(at.hi), at_least: at.lo.max(0.0) }
        };
        Ok(sdf_ir::region::steepest(ty.size(), region, PIECES, ask))
    }

    /// The slope that a function of numbers promises, if it is a number that is known now.
    pub fn promised_slope(
        &mut self,
        function: &'t Function,
        module: Module,
        arguments: &[(Arc<str>, Value<'t>)],
    ) -> Option<f64> {
        let names = self.names;
        let contract = names.contract_of(function, module)?;
        let (slope, _) = contract.slope?;
        let env = arguments.iter().fold(Env::new(module), |env, (name, v)| env.bind(name.clone(), v.clone()));
        let reported = self.diagnostics.len();
        let value = self.eval(slope, &env);
        self.diagnostics.truncate(reported);
        match value {
            Ok(Value::Number(n)) => Some(self.bounds_of_number(&n).number().hi),
            _ => None,
        }
    }

    /// Where a number lies, for all values of the params, for all times and at all points.
    pub fn bounds_of_number(&mut self, number: &Number) -> Bounds {
        match &number.repr {
            Repr::Static(c) => Bounds::constant(*c),
            Repr::Outer(_, inner) => self.bounds_of_number(inner),
            Repr::Frame(value) => {
                let uniforms = self.bounds_of_uniforms();
                let builder = self.contexts.frame_builder();
                self.facts.frame.bounds_of(&self.contexts.program, builder, *value, &uniforms)
            }
            Repr::Local(depth, value) => {
                let uniforms = self.bounds_of_uniforms();
                // It may be of a function that is put aside.
                let Some((builder, serial)) = self.contexts.open_builder(*depth) else {
                    return Bounds::anything(number.ty);
                };
                let (known, open) = &mut self.facts.open;
                if *known != serial {
                    (*known, *open) = (serial, Growing::new());
                }
                open.bounds_of(&self.contexts.program, builder, *value, &uniforms)
            }
        }
    }

    /// Where each global of the program so far lies.
    pub fn bounds_of_globals(&mut self) -> Vec<Bounds> {
        let uniforms = self.bounds_of_uniforms();
        let builder = self.contexts.frame_builder();
        let (program, frame) = (&self.contexts.program, &mut self.facts.frame);
        let values = self.contexts.global_values();
        values.iter().map(|v| frame.bounds_of(program, builder, *v, &uniforms)).collect()
    }

    /// The ranges of the uniforms.
    pub fn bounds_of_uniforms(&self) -> Vec<Bounds> {
        self.contexts.program.uniforms.iter().map(bounds_of_uniform).collect()
    }
}

/// The points of a cell; no coordinate is farther away than is promised.
pub(crate) fn bounds_of_cell(cell: &Extent, ty: Type) -> Bounds {
    let far = |x: f64| x.clamp(-FAR, FAR);
    let components: Vec<Interval> =
        (0..ty.size()).map(|i| Interval::new(far(cell.lo[i]), far(cell.hi[i]))).collect();
    Bounds::vector(&components)
}

/// A slope that stands for one that is not known, with room for contracts to multiply it.
pub(crate) const UNKNOWN_SLOPE: f64 = 1e28;

/// A slope that is made from one that is not known counts as infinite.
fn ended(x: f64) -> f64 {
    if x < UNKNOWN_SLOPE / 2.0 { x } else { f64::INFINITY }
}

/// The variables with their numbers as they are outside of all functions, where they are known there.
fn outermost<'t>(env: &Env<'t>) -> Env<'t> {
    let mut out = Env::new(env.module);
    for (name, value) in env.variables() {
        out = out.bind(name, outside(&value));
    }
    out
}

fn outside<'t>(value: &Value<'t>) -> Value<'t> {
    fn bare(number: &Number) -> Number {
        match &number.repr {
            Repr::Outer(_, inner) if !inner.is_local() => bare(inner),
            _ => number.clone(),
        }
    }
    let has_numbers = |items: &[Value<'t>]| items.iter().any(|v| !matches!(v, Value::Shape(_)));
    match value {
        Value::Number(n) => Value::Number(bare(n)),
        Value::List(l) if has_numbers(&l.items) => {
            Value::List(Rc::new(List { items: l.items.iter().map(outside).collect(), traits: l.traits }))
        }
        Value::Record(r) => Value::Record(Rc::new(Fields {
            fields: r.fields.iter().map(|(n, v)| (n.clone(), outside(v))).collect(),
            traits: r.traits,
        })),
        other => other.clone(),
    }
}

/// A coordinate of a box as a number of the language.
pub(crate) fn coordinate(x: f64) -> f64 {
    x.clamp(-crate::NOTHING, crate::NOTHING)
}

/// The corner of a box as a vector of the language.
pub(crate) fn corner_number(corner: [f64; 3], dimension: Dimension) -> Number {
    let [x, y, z] = corner.map(coordinate);
    Number::constant(match dimension {
        Dimension::Three => Constant::Vec3([x, y, z]),
        Dimension::Two => Constant::Vec2([x, y]),
    })
}
