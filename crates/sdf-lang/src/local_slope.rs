//! How steep a field is round a point: a contract may say more of the places near a point than of all of space, and what is
//! made from shapes is as steep as they are where it samples them.

use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::facts::Gain;
use crate::value::{Env, Number, Shape, ShapeKind, Value};
use sdf_ir::{Binary, Type, Unary};
use sdf_syntax::Span;
use sdf_syntax::tree::Expr;
use std::rc::Rc;
use std::sync::Arc;

impl<'t> Elaborator<'t> {
    /// The slope of a shape's field round a point at which it is `distance`: what its contract states there, or what
    /// holds everywhere.
    pub fn slope(
        &mut self,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        distance: &Number,
        span: Span,
    ) -> Eval<Number> {
        if !shape.steep {
            return Ok(Number::float(1.0));
        }
        let known = self.slope_of(shape)?.everywhere;
        if known <= 1.0 {
            return Ok(Number::float(1.0));
        }
        if let Some(stated) = self.stated(shape)
            && let Some((slope, _)) = stated.contract.slope
        {
            let samples = self.slopes_of_samples(shape, point, None, span)?;
            return self.slope_here(slope, &stated.env, samples, point, distance);
        }
        match &shape.kind {
            ShapeKind::Named { inner, .. } => self.slope(inner, point, distance, span),
            ShapeKind::Painted { shape, .. } => self.slope(shape, point, distance, span),
            ShapeKind::Choice { then, otherwise, .. } => {
                let a = self.slope(then, point, distance, span)?;
                let b = self.slope(otherwise, point, distance, span)?;
                self.binary(Binary::Max, &a, &b, span)
            }
            ShapeKind::Field { .. } if self.stated(shape).is_none_or(|s| s.contract.quality.is_none()) => {
                if known.is_finite() {
                    return Ok(Number::float(known));
                }
                let Some(gain) = self.gain(shape)? else {
                    return self.report(errors::no_slope(shape.place, false));
                };
                let reach = self.reach_of_step(distance, gain, span)?;
                let largest = self.largest_of_samples(shape, point, Some(&reach), span)?;
                self.binary(Binary::Multiply, &Number::float(gain.slope), &largest, span)
            }
            ShapeKind::Union { .. } | ShapeKind::Field { .. } => {
                self.largest_of_samples(shape, point, None, span)
            }
        }
    }

    /// What a contract's expression says of the slope round a point, where the shapes that the field samples have
    /// these slopes.
    fn slope_here(
        &mut self,
        stated: &'t Expr,
        env: &Env<'t>,
        samples: Vec<(Rc<Shape<'t>>, Number)>,
        point: &Number,
        distance: &Number,
    ) -> Eval<Number> {
        let env: Env<'t> = env
            .bind(Arc::from("p"), Value::Number(point.clone()))
            .bind(Arc::from("d"), Value::Number(distance.clone()));
        let before = self.facts.samples.replace(samples);
        let value = self.eval(stated, &env);
        self.facts.samples = before;
        let slope = self.as_typed(value?, Type::Float, stated.span)?;
        self.binary(Binary::Max, &slope, &Number::float(1.0), stated.span)
    }

    /// How far the places at which a field samples its shapes move during a step of its distance.
    fn reach_of_step(&mut self, distance: &Number, gain: Gain, span: Span) -> Eval<Number> {
        let distance = self.unary(Unary::Abs, distance, span)?;
        self.binary(Binary::Multiply, &distance, &Number::float(gain.places), span)
    }

    /// The largest slope of the shapes that a field samples, each where it is sampled.
    fn largest_of_samples(
        &mut self,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        reach: Option<&Number>,
        span: Span,
    ) -> Eval<Number> {
        let mut largest = Number::float(1.0);
        for (_, slope) in self.slopes_of_samples(shape, point, reach, span)? {
            largest = self.binary(Binary::Max, &largest, &slope, span)?;
        }
        Ok(largest)
    }

    /// The shapes that a field samples, each with its slope round where it is sampled: within its distance there, or
    /// within `reach` where that is more.
    fn slopes_of_samples(
        &mut self,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        reach: Option<&Number>,
        span: Span,
    ) -> Eval<Vec<(Rc<Shape<'t>>, Number)>> {
        let samples = match &shape.kind {
            ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
                return self.slopes_of_samples(inner, point, reach, span);
            }
            ShapeKind::Choice { .. } => return Ok(Vec::new()),
            ShapeKind::Union { shapes } => {
                let shapes = shapes.clone();
                self.samples_of(|this| this.union_distance(&shapes, point, span))?
            }
            ShapeKind::Field { block, env, .. } => {
                self.samples_of(|this| this.field_value(block, env, point))?
            }
        };
        let mut out = Vec::new();
        for (shape, at, distance) in samples {
            let distance = match reach {
                Some(reach) => {
                    let distance = self.unary(Unary::Abs, &distance, span)?;
                    self.binary(Binary::Max, &distance, reach, span)?
                }
                None => distance,
            };
            let slope = self.slope(&shape, &at, &distance, span)?;
            out.push((shape, slope));
        }
        Ok(out)
    }
}
