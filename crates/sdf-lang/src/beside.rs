//! A shape without the steep ones in it that have boxes: what a ray may take for the shape where it is outside of these.

use crate::eval::{Elaborator, Eval};
use crate::facts::{Steep, parts};
use crate::value::{Number, Shape, ShapeKind, Value};
use sdf_ir::region::Extent;
use std::rc::Rc;

/// A shape outside of a box.
pub(crate) struct Beside<'t> {
    /// The box.
    pub extent: Extent,
    /// What the shape is outside of it, where its distance is small.
    pub rest: Rc<Shape<'t>>,
}

impl<'t> Elaborator<'t> {
    /// A shape without the steep ones in it that have boxes. Outside of their box its distance is that of `rest` if one of
    /// both is at most `band` either way, and else both are beyond that on the same side. Nothing if that is not proved.
    pub fn beside(&mut self, shape: &Rc<Shape<'t>>, band: f64, point: &Number) -> Eval<Option<Beside<'t>>> {
        if self.steep_inside(shape)?.is_empty() {
            return Ok(Some(Beside { extent: Extent::NONE, rest: shape.clone() }));
        }
        if self.extent_of(shape, 0.0)?.is_bounded() {
            if self.is_steep_in_a_corner(shape)?
                && let Some(beside) = self.beside_in(shape, band, point)?
            {
                return Ok(Some(beside));
            }
            let extent = self.extent_of(shape, band)?;
            return Ok(extent.is_bounded().then(|| Beside { extent, rest: of(shape, Vec::new()) }));
        }
        self.beside_in(shape, band, point)
    }

    /// The same for a shape that is not left out as a whole.
    fn beside_in(&mut self, shape: &Rc<Shape<'t>>, band: f64, point: &Number) -> Eval<Option<Beside<'t>>> {
        if let parts @ [_, _, ..] = &self.parts_behind(shape)?[..] {
            let (mut extent, mut rest) = (Extent::NONE, Vec::new());
            for part in parts {
                let Some(beside) = self.beside(part, band, point)? else { return Ok(None) };
                extent = extent.union(&beside.extent);
                rest.push(beside.rest);
            }
            return Ok(Some(Beside { extent, rest: of(shape, rest) }));
        }
        match &shape.kind {
            ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
                self.beside_in(inner, band, point)
            }
            ShapeKind::Field { .. } => self.beside_field(shape, band, point),
            _ => Ok(None),
        }
    }

    fn beside_field(&mut self, shape: &Rc<Shape<'t>>, band: f64, point: &Number) -> Eval<Option<Beside<'t>>> {
        let ShapeKind::Field { block, env, origin } = &shape.kind else { return Ok(None) };
        let samples = self.samples_of(|this| this.field_value(block, env, point))?;
        if samples.iter().any(|(_, at, _)| !at.is_same(point)) {
            return Ok(None);
        }
        let (mut kinds, mut steep) = (Vec::new(), Extent::NONE);
        for (sample, ..) in &samples {
            let inside = self.steep_inside(sample)?;
            steep = steep.union(&inside);
            kinds.push(if inside.is_empty() {
                Steep::Nothing
            } else if self.extent_of(sample, 0.0)?.is_bounded() && !self.is_steep_in_a_corner(sample)? {
                Steep::Whole
            } else {
                Steep::Parts
            });
        }
        if steep.is_empty() {
            return Ok(None);
        }
        let size = steep.size().into_iter().fold(0.0, f64::max);
        let Some(level) = self.influence(shape, &kinds, band, size)? else { return Ok(None) };
        let (mut extent, mut replaced) = (Extent::NONE, Vec::new());
        for (sample, ..) in &samples {
            let Some(beside) = self.beside(sample, level, point)? else { return Ok(None) };
            extent = extent.union(&beside.extent);
            replaced.push((sample.clone(), beside.rest));
        }
        let replace = |value: &Value<'t>| match value {
            Value::Shape(own) => match replaced.iter().find(|(sample, _)| Rc::ptr_eq(sample, own)) {
                Some((_, rest)) => Value::Shape(rest.clone()),
                None => value.clone(),
            },
            _ => value.clone(),
        };
        let env = env.map(|_, value| match &value {
            Value::List(list) => Value::list(list.items.iter().map(replace).collect()),
            _ => replace(&value),
        });
        let kind = ShapeKind::Field { block, env, origin: *origin };
        let rest = Rc::new(Shape { kind, ..**shape });
        Ok((!extent.is_empty()).then_some(Beside { extent, rest }))
    }

    /// Whether a shape with a box is much larger than the steep shapes in it.
    pub fn is_steep_in_a_corner(&mut self, shape: &Rc<Shape<'t>>) -> Eval<bool> {
        let (own, inside) = (self.extent_of(shape, 0.0)?, self.steep_parts(shape)?);
        let size = |extent: &Extent| extent.size().into_iter().fold(0.0, f64::max);
        Ok(!inside.is_empty() && 2.0 * size(&inside) < size(&own))
    }

    /// The box round the steep shapes that have boxes in a shape, or round itself if no others are.
    fn steep_inside(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Extent> {
        if self.slope_of(shape)?.everywhere <= 1.0 {
            return Ok(Extent::NONE);
        }
        let (own, inside) = (self.extent_of(shape, 0.0)?, self.steep_parts(shape)?);
        let is_own = own.is_bounded() && !self.is_steep_in_a_corner(shape)?;
        Ok(if is_own { own } else { inside })
    }

    fn steep_parts(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Extent> {
        if let Some(known) = self.facts.steep_parts(shape) {
            return Ok(known);
        }
        let mut inside = Extent::NONE;
        for part in parts(shape) {
            inside = inside.union(&self.steep_inside(&part)?);
        }
        self.facts.keep_steep_parts(shape, inside);
        Ok(inside)
    }
}

/// The union of some shapes of which a shape was made.
fn of<'t>(shape: &Rc<Shape<'t>>, shapes: Vec<Rc<Shape<'t>>>) -> Rc<Shape<'t>> {
    let steep = shapes.iter().any(|s| s.steep);
    Rc::new(Shape { kind: ShapeKind::Union { shapes }, painted: false, steep, ..**shape })
}
