//! A floor that shapes are blended with: far from them the blend is the half space alone, which a ray meets where a division
//! says.

use crate::beside::Beside;
use crate::eval::{Elaborator, Eval};
use crate::facts::Steep;
use crate::value::{Number, Shape, ShapeKind};
use sdf_ir::Type;
use sdf_ir::region::Extent;
use std::rc::Rc;
use std::sync::Arc;

impl<'t> Elaborator<'t> {
    /// The half space that a shape is outside of a box, if it is one there.
    pub fn ground(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Option<Beside<'t>>> {
        if self.extent_of(shape, 0.0)?.is_bounded() {
            return Ok(None);
        }
        self.contexts.open(&Arc::from("ground"), None);
        let point = self.contexts.entry_parameter("p", Type::Vec3);
        let found = self.ground_from(shape, 0.0, &point);
        self.contexts.discard();
        Ok(found?.filter(|ground| !ground.extent.is_empty()))
    }

    /// The same for where one of both distances is at most `band` either way: there they are the same.
    fn ground_from(&mut self, shape: &Rc<Shape<'t>>, band: f64, point: &Number) -> Eval<Option<Beside<'t>>> {
        if self.is_half_space(shape)? {
            return Ok(Some(Beside { extent: Extent::NONE, rest: shape.clone() }));
        }
        let parts = self.parts_behind(shape)?;
        if parts.len() > 1 {
            return self.ground_of_parts(&parts, band, point);
        }
        match &shape.kind {
            ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
                self.ground_from(inner, band, point)
            }
            ShapeKind::Field { block, env, .. } => {
                let samples = self.samples_of(|this| this.field_value(block, env, point))?;
                if samples.iter().any(|(_, at, _)| !at.is_same(point)) {
                    return Ok(None);
                }
                let (mut kinds, mut size) = (Vec::new(), 0.0f64);
                for (sample, ..) in &samples {
                    let extent = self.extent_of(sample, 0.0)?;
                    kinds.push(match extent.is_bounded() {
                        true => Steep::Whole,
                        false if self.is_half_space(sample)? => Steep::Nothing,
                        false => Steep::Parts,
                    });
                    size = extent.size().into_iter().filter(|s| s.is_finite()).fold(size, f64::max);
                }
                if !kinds.contains(&Steep::Whole) {
                    return Ok(None);
                }
                let Some(level) = self.plain_beyond(shape, &kinds, band, size)? else { return Ok(None) };
                let shapes: Vec<_> = samples.into_iter().map(|(shape, ..)| shape).collect();
                self.ground_of_parts(&shapes, level, point)
            }
            _ => Ok(None),
        }
    }

    /// The half space that one of some shapes is, and the box round the others.
    fn ground_of_parts(
        &mut self,
        parts: &[Rc<Shape<'t>>],
        band: f64,
        point: &Number,
    ) -> Eval<Option<Beside<'t>>> {
        let (mut around, mut ground) = (Extent::NONE, None);
        for part in parts {
            let own = self.extent_of(part, band)?;
            if own.is_bounded() {
                around = around.union(&own);
                continue;
            }
            match (self.ground_from(part, band, point)?, &ground) {
                (Some(Beside { extent, rest }), None) => {
                    around = around.union(&extent);
                    ground = Some(rest);
                }
                _ => return Ok(None),
            }
        }
        Ok(ground.map(|rest| Beside { extent: around, rest }))
    }
}
