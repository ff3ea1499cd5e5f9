//! How far a ray may step: the distance over the field's slope, on the branch that needs it.
//!
//! A field whose slope is above 1 promises more room than there is. The correction belongs to the step and not to
//! the field, so that blends, shells, shadows and occlusion keep their shape, and to the branch, so that a ball
//! beside a twisted column still takes whole steps. Where nothing is steep, a step is the distance itself.

use crate::context::Op;
use crate::eval::{Elaborator, Eval, Reported};
use crate::value::{Env, Number, Shape, ShapeKind, Value};
use sdf_ir::{Binary, Ternary, Type};
use sdf_syntax::Span;
use std::rc::Rc;
use std::sync::Arc;

impl<'t> Elaborator<'t> {
    /// `stride(s, p)`: a distance from `p` within which the shape certainly has no surface, as far as its slopes
    /// are stated.
    pub fn stride(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        if !shape.steep || !point.is_local() {
            return self.sample(shape, point, span);
        }
        let name: Arc<str> = match &shape.kind {
            ShapeKind::Named { name, .. } => Arc::from(format!("{name}_stride")),
            _ => Arc::from("stride"),
        };
        self.contexts.open(&name, None);
        let doc = "How far a ray may step from p: the distance, over the slope where that is above 1.";
        self.contexts.describe(Some(Arc::from(doc)));
        let inside = self.contexts.parameter(&Arc::from("p"), point, true);
        match self.safe_step(shape, &inside, span) {
            Ok(step) => {
                let form = Value::Number(step.clone());
                match self.close_with(&name, &form, vec![step]) {
                    Value::Number(n) => Ok(Number { name: None, ..n }),
                    _ => unreachable!("a number comes back as one"),
                }
            }
            Err(Reported) => {
                self.contexts.discard();
                Err(Reported)
            }
        }
    }

    fn safe_step(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        if !shape.steep {
            return self.sample(shape, point, span);
        }
        let parts = crate::scene::parts_of_union(shape);
        if let [_, _, ..] = &parts[..] {
            return self.nearest_step(&parts, point, span);
        }
        match &shape.kind {
            ShapeKind::Painted { shape, .. } => self.safe_step(shape, point, span),
            ShapeKind::Choice { condition, then, otherwise } => {
                let a = self.safe_step(then, point, span)?;
                let b = self.safe_step(otherwise, point, span)?;
                Ok(self.contexts.apply(Op::Ternary(Ternary::Select), &[condition.clone(), a, b]))
            }
            _ => {
                let distance = self.sample(shape, point, span)?;
                let slope = self.slope(shape, point, &distance, span)?;
                self.binary(Binary::Divide, &distance, &slope, span)
            }
        }
    }

    /// The smallest of the steps that several shapes allow.
    pub fn nearest_step(&mut self, parts: &[Rc<Shape<'t>>], point: &Number, span: Span) -> Eval<Number> {
        let mut nearest = Number::float(crate::NOTHING);
        for (i, part) in parts.iter().enumerate() {
            let step = self.safe_step(part, point, span)?;
            nearest = if i == 0 { step } else { self.binary(Binary::Min, &nearest, &step, span)? };
        }
        Ok(nearest)
    }

    /// The slope of a shape's field round a point at which it is `distance`: what its function states, times the
    /// largest of the shapes that it samples.
    fn slope(
        &mut self,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        distance: &Number,
        span: Span,
    ) -> Eval<Number> {
        if !shape.steep {
            return Ok(Number::float(1.0));
        }
        match &shape.kind {
            ShapeKind::Named { inner, .. } => self.slope(inner, point, distance, span),
            ShapeKind::Painted { shape, .. } => self.slope(shape, point, distance, span),
            ShapeKind::Union { shapes } => {
                let shapes = shapes.clone();
                self.slope_of_samples(span, |this| this.union_distance(&shapes, point, span))
            }
            ShapeKind::Choice { then, otherwise, .. } => {
                let a = self.slope(then, point, distance, span)?;
                let b = self.slope(otherwise, point, distance, span)?;
                self.binary(Binary::Max, &a, &b, span)
            }
            ShapeKind::Field { block, env, origin } => {
                let samples = self.slope_of_samples(span, |this| this.field_value(block, env, point))?;
                let stated =
                    origin.as_ref().and_then(|o| self.names.module(o.module).slopes.get(&o.function));
                let Some(stated) = stated else { return Ok(samples) };
                let env: Env<'t> = env
                    .bind(Arc::from("p"), Value::Number(point.clone()))
                    .bind(Arc::from("d"), Value::Number(distance.clone()));
                let value = self.eval(stated, &env)?;
                let own = self.as_typed(value, Type::Float, stated.span)?;
                let own = self.binary(Binary::Max, &own, &Number::float(1.0), span)?;
                self.binary(Binary::Multiply, &own, &samples, span)
            }
        }
    }

    /// The largest slope among the shapes that a formula samples, each where it is sampled.
    fn slope_of_samples(
        &mut self,
        span: Span,
        formula: impl FnOnce(&mut Self) -> Eval<Number>,
    ) -> Eval<Number> {
        let samples = self.samples_of(formula)?;
        let mut largest = Number::float(1.0);
        for (shape, at, distance) in samples {
            let slope = self.slope(&shape, &at, &distance, span)?;
            largest = self.binary(Binary::Max, &largest, &slope, span)?;
        }
        Ok(largest)
    }
}
