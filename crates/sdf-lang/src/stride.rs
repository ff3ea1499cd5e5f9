//! How far a ray may step: the distance over the field's slope, on the branch that needs it.
//!
//! A field whose slope is above 1 promises more room than there is. The correction belongs to the step and not to
//! the field, so that blends, shells, shadows and occlusion keep their shape, and to the branch, so that a ball
//! beside a twisted column still takes whole steps. Where nothing is steep, a step is the distance itself.

use crate::beside::Beside;
use crate::context::Op;
use crate::contract::Quality;
use crate::errors;
use crate::eval::{Elaborator, Eval, Reported};
use crate::facts::{Stated, corner_number, parts, room};
use crate::scene::parts_of_union;
use crate::value::{Number, Shape, ShapeKind, Value};
use sdf_ir::interval::Interval;
use sdf_ir::region::Extent;
use sdf_ir::{Binary, Ternary, Type, Unary};
use sdf_syntax::Span;
use sdf_syntax::tree::Dimension;
use std::rc::Rc;
use std::sync::Arc;

/// A slope from which on a ray is likely to run out of steps.
const VERY_STEEP: f64 = 32.0;

impl<'t> Elaborator<'t> {
    /// `stride(s, p)`: a distance from `p` within which the shape certainly has no surface.
    pub fn stride(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        match self.approach(shape, point, span)? {
            Value::Record(record) => match record.get("stride") {
                Some(Value::Number(stride)) => Ok(stride.clone()),
                _ => unreachable!("it was just made"),
            },
            _ => unreachable!("it was just made"),
        }
    }

    /// `approach(s, p)`: the distance that the field gives at `p`, and the distance from there within which the shape
    /// certainly has no surface; where the field is steep the latter is the smaller one.
    pub fn approach(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Value<'t>> {
        let (seen, asked) = self.asking(|this| this.approach_here(shape, point, span))?;
        if asked
            && let Value::Record(record) = &seen
            && let Some(Value::Number(distance)) = record.get("distance")
        {
            self.count_evaluation(distance, point);
        }
        Ok(seen)
    }

    fn approach_here(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Value<'t>> {
        if !shape.steep || !point.is_local() || self.slope_of(shape)?.everywhere <= 1.0 {
            let distance = self.sample(shape, point, span)?;
            return Ok(approached(distance.clone(), distance));
        }
        let name: Arc<str> = match &shape.kind {
            ShapeKind::Named { name, .. } => Arc::from(format!("{name}_stride")),
            _ => Arc::from("stride"),
        };
        self.contexts.open(&name, None);
        let doc =
            "The distance at p, and how far a ray may step from there: over the slope where that is above 1.";
        self.contexts.describe(Some(Arc::from(doc)));
        let inside = self.contexts.parameter(&Arc::from("p"), point, true);
        let both = self
            .safe_step(shape, &inside, span)
            .and_then(|step| Ok((self.distance_of_parts(shape, &inside, span)?, step)));
        match both {
            Ok((distance, step)) => {
                let form = approached(distance.clone(), step.clone());
                Ok(self.close_with(&name, &form, vec![distance, step]))
            }
            Err(Reported) => {
                self.contexts.discard();
                Err(Reported)
            }
        }
    }

    /// The distance to a shape from those of the parts of unions, which the step has sampled.
    fn distance_of_parts(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        let parts = self.parts_of_step(shape)?;
        if let [_, _, ..] = &parts[..] {
            let mut nearest = Number::float(crate::NOTHING);
            for (i, part) in parts.iter().enumerate() {
                let distance = self.distance_of_parts(part, point, span)?;
                nearest =
                    if i == 0 { distance } else { self.binary(Binary::Min, &nearest, &distance, span)? };
            }
            return Ok(nearest);
        }
        match &shape.kind {
            ShapeKind::Painted { shape, .. } => self.distance_of_parts(shape, point, span),
            ShapeKind::Named { inner, .. } if matches!(inner.kind, ShapeKind::Union { .. }) => {
                self.distance_of_parts(inner, point, span)
            }
            ShapeKind::Union { shapes } if shapes.len() == 1 => {
                self.distance_of_parts(&shapes[0], point, span)
            }
            _ if shape.steep => match self.moved(shape, point)? {
                Some(moved) if moved.is_to_scale => self.distance_of_parts(&moved.shape, &moved.place, span),
                _ => self.sample(shape, point, span),
            },
            _ => self.sample(shape, point, span),
        }
    }

    /// The parts whose steps are taken each by itself: those of a union, and what an operator makes of them, unless
    /// all of them are steep or none is.
    fn parts_of_step(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Vec<Rc<Shape<'t>>>> {
        let parts = parts_of_union(shape);
        if parts.len() > 1 || !shape.steep {
            return Ok(parts);
        }
        let behind = self.parts_behind(shape)?;
        let is_steep = |part: &Rc<Shape<'t>>| self.slope_of(part).map(|slope| slope.everywhere > 1.0);
        let steep = behind.iter().map(is_steep).collect::<Eval<Vec<bool>>>()?;
        Ok(if steep.contains(&true) && steep.contains(&false) { behind } else { parts })
    }

    fn safe_step(&mut self, shape: &Rc<Shape<'t>>, point: &Number, span: Span) -> Eval<Number> {
        if !shape.steep {
            return self.sample(shape, point, span);
        }
        let parts = self.parts_of_step(shape)?;
        if let [_, _, ..] = &parts[..] {
            return self.nearest_step(&parts, point, span);
        }
        match &shape.kind {
            ShapeKind::Painted { shape, .. } => self.safe_step(shape, point, span),
            ShapeKind::Named { inner, .. } if matches!(inner.kind, ShapeKind::Union { .. }) => {
                self.safe_step(inner, point, span)
            }
            ShapeKind::Union { shapes } if shapes.len() == 1 => self.safe_step(&shapes[0], point, span),
            ShapeKind::Choice { condition, then, otherwise } => {
                let a = self.safe_step(then, point, span)?;
                let b = self.safe_step(otherwise, point, span)?;
                Ok(self.contexts.apply(Op::Ternary(Ternary::Select), &[condition.clone(), a, b]))
            }
            _ => {
                if let Some(moved) = self.moved(shape, point)? {
                    let step = self.safe_step(&moved.shape, &moved.place, span)?;
                    return self.binary(Binary::Multiply, &step, &Number::float(1.0 / moved.rate), span);
                }
                let slope = self.require_slope(shape)?;
                let distance = self.sample(shape, point, span)?;
                if slope.everywhere <= 1.0 {
                    return Ok(distance);
                }
                let is_bounded = self.extent_of(shape, 0.0)?.is_bounded();
                let beside = if !slope.wild && (!is_bounded || self.is_steep_in_a_corner(shape)?) {
                    self.step_beside(shape, point, &distance, span)?
                } else {
                    None
                };
                let by_region = beside.is_none() && is_bounded && self.has_better_region(shape)?;
                let constant = if slope.wild || by_region { slope.within } else { self.steepness(shape)? };
                if constant.is_finite() && constant > VERY_STEEP {
                    self.warn(errors::very_steep(shape.place, constant));
                }
                if slope.wild || by_region {
                    return self.step_by_region(shape, slope.within, point, &distance, span);
                }
                if let Some(step) = beside {
                    return Ok(step);
                }
                let slope = self.slope(shape, point, &distance, span)?;
                self.binary(Binary::Divide, &distance, &slope, span)
            }
        }
    }

    /// The shape that a field shows elsewhere, and the point as that shape sees it: one that is only moved, turned or
    /// mirrored, of which a step there is a step here, or one that is drawn larger or smaller.
    fn moved(&mut self, shape: &Rc<Shape<'t>>, point: &Number) -> Eval<Option<Moved<'t>>> {
        // What a contract says of the slope it says of the whole.
        if self.stated(shape).is_some_and(|stated| stated.contract.slope.is_some()) {
            return Ok(None);
        }
        let ShapeKind::Field { block, env, .. } = &shape.kind else {
            return match &shape.kind {
                ShapeKind::Named { inner, .. } => self.moved(inner, point),
                _ => Ok(None),
            };
        };
        let is_exact = |stated: Stated| matches!(stated.contract.quality, Some((Quality::Exact, _)));
        if self.stated(shape).is_some_and(is_exact)
            && let Some((shape, place)) = self.only_sample(|this| this.field_value(block, env, point))?
        {
            return Ok(Some(Moved { shape, place, rate: 1.0, is_to_scale: true }));
        }
        let Some(zoom) = self.zoom(shape)? else { return Ok(None) };
        let samples = self.samples_of(|this| this.field_value(block, env, point))?;
        let is_to_scale = zoom.factor == Interval::ONE;
        let moved = |(shape, place, _)| Moved { shape, place, rate: zoom.rate, is_to_scale };
        Ok(samples.into_iter().next().map(moved))
    }

    /// Whether a field, or a shape that it is made from, is far less steep in its region than elsewhere.
    fn has_better_region(&mut self, shape: &Rc<Shape<'t>>) -> Eval<bool> {
        if let Some(known) = self.facts.has_better_region(shape) {
            return Ok(known);
        }
        let mut is_better = self.slope_of(shape)?.has_better_region();
        for part in parts(shape) {
            is_better = is_better || part.steep && self.has_better_region(&part)?;
        }
        self.facts.keep_better_region(shape, is_better);
        Ok(is_better)
    }

    /// How steep a field is near its surface: one that is as good as its shapes, as they are near theirs.
    fn steepness(&mut self, shape: &Rc<Shape<'t>>) -> Eval<f64> {
        let slope = self.slope_of(shape)?;
        let of_parts = self.stated(shape).is_some_and(|s| s.contract.quality.is_some());
        if !of_parts || !slope.has_better_region() && slope.within < VERY_STEEP {
            return Ok(slope.everywhere);
        }
        let mut steepest = 1.0f64;
        for part in parts(shape) {
            let part = if self.stated(&part).is_some_and(|s| s.contract.quality.is_some()) {
                self.steepness(&part)?
            } else {
                self.slope_of(&part)?.within
            };
            steepest = steepest.max(part);
        }
        Ok(steepest)
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

    /// The step where the slope has a bound in the region of a shape alone: outside of it the field counts as the
    /// distance to the shape's box, which is not small there.
    fn step_by_region(
        &mut self,
        shape: &Rc<Shape<'t>>,
        slope: f64,
        point: &Number,
        distance: &Number,
        span: Span,
    ) -> Eval<Number> {
        let extent = self.extent_of(shape, 0.0)?;
        let (outside, to_box) = self.outside_of(&extent, point, span)?;
        let mut slope = Number::float(slope.max(1.0));
        if self.stated(shape).is_some_and(|s| s.contract.quality.is_some() || s.contract.slope.is_some())
            && !self.slope_of(shape)?.wild
        {
            // What is as good as its shapes is no steeper than they are where it samples them; and a contract may say
            // more of the places near a point than of the whole region.
            let local = self.slope(shape, point, distance, span)?;
            slope = self.binary(Binary::Min, &slope, &local, span)?;
        }
        let within = self.binary(Binary::Divide, distance, &slope, span)?;
        Ok(self.contexts.apply(Op::Ternary(Ternary::Select), &[outside, to_box, within]))
    }

    /// The step where shapes in a field are steep and have boxes, and the field goes on beyond these, as a blend with a
    /// plane does: outside of the boxes it is as if they were not there, until the ray comes to a box. Nothing if there are
    /// no such boxes.
    fn step_beside(
        &mut self,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        distance: &Number,
        span: Span,
    ) -> Eval<Option<Number>> {
        let Some(Beside { extent, rest }) = self.beside(shape, 0.0, point)? else { return Ok(None) };
        if extent.is_empty() {
            return Ok(None);
        }
        let (outside, to_box) = self.outside_of(&extent, point, span)?;
        let rest = self.safe_step(&rest, point, span)?;
        let from_inside = self.unary(Unary::Negate, &to_box, span)?;
        let beside = self.binary(Binary::Max, &rest, &from_inside, span)?;
        let beside = self.binary(Binary::Min, &beside, &to_box, span)?;
        let slope = self.slope(shape, point, distance, span)?;
        let within = self.binary(Binary::Divide, distance, &slope, span)?;
        Ok(Some(self.contexts.apply(Op::Ternary(Ternary::Select), &[outside, beside, within])))
    }

    /// Whether a point lies outside of the region round a box, and how far it is from there to the box.
    fn outside_of(&mut self, extent: &Extent, point: &Number, span: Span) -> Eval<(Number, Number)> {
        let beyond = self.beyond(&extent.grown(room(extent)), point, span)?;
        let mut farthest = self.component(&beyond, 0);
        for axis in 1..beyond.ty.size() {
            let component = self.component(&beyond, axis);
            farthest = self.binary(Binary::Max, &farthest, &component, span)?;
        }
        let outside = self.binary(Binary::Less, &Number::float(0.0), &farthest, span)?;
        let to_box = self.beyond(extent, point, span)?;
        let to_box = self.binary(Binary::Max, &to_box, &Number::float(0.0), span)?;
        Ok((outside, self.unary(Unary::Length, &to_box, span)?))
    }

    /// How far a point lies outside of a box along each axis; below 0 inside.
    fn beyond(&mut self, extent: &Extent, point: &Number, span: Span) -> Eval<Number> {
        let dimension = if point.ty == Type::Vec3 { Dimension::Three } else { Dimension::Two };
        let (lo, hi) = (corner_number(extent.lo, dimension), corner_number(extent.hi, dimension));
        let below = self.binary(Binary::Subtract, &lo, point, span)?;
        let above = self.binary(Binary::Subtract, point, &hi, span)?;
        self.binary(Binary::Max, &below, &above, span)
    }
}

/// A shape that a field shows elsewhere.
struct Moved<'t> {
    shape: Rc<Shape<'t>>,
    /// The point as the shape sees it.
    place: Number,
    /// How fast that moves at most: a step of the shape is so many times as long as one of the field.
    rate: f64,
    /// Whether the field is the shape's distance there.
    is_to_scale: bool,
}

fn approached<'t>(distance: Number, stride: Number) -> Value<'t> {
    let named = |name: &str, n: Number| (Arc::from(name), Value::Number(Number { name: None, ..n }));
    Value::record(vec![named("distance", distance), named("stride", stride)])
}
