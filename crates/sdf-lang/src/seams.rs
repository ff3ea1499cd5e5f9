//! Where a surface may change from one shape to another: antialiasing takes all rays of a pixel there.
//!
//! A point of the surface lies on that of one of the shapes that it is made of. Near another one's, the material, or the
//! direction of the surface, may be another within that distance.

use crate::context::Op;
use crate::eval::{Elaborator, Eval};
use crate::scene::parts_of_union;
use crate::value::{Number, Shape, ShapeKind, Value};
use sdf_ir::{Binary, Ternary, Unary};
use sdf_syntax::Span;
use std::rc::Rc;
use std::sync::Arc;

impl<'t> Elaborator<'t> {
    /// `seams(s, p, width)`: how many of the surfaces that a shape is made of lie within `width` of a point. It is 0 for one that
    /// is made of one.
    pub fn seams(
        &mut self,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        width: &Number,
        span: Span,
    ) -> Eval<Value<'t>> {
        let name: Arc<str> = Arc::from("seams");
        self.contexts.open(&name, None);
        self.contexts.describe(Some(Arc::from(
            "How many of the surfaces of which the scene is made are this near to a point.",
        )));
        let p = self.contexts.parameter(&Arc::from("p"), point, true);
        let w = self.contexts.parameter(&Arc::from("width"), width, false);
        let mut near = Vec::new();
        let found = self.near_surfaces(shape, &p, &w, span, &mut near);
        if found.is_err() || near.len() < 2 {
            self.contexts.discard();
            return found.map(|()| Value::float(0.0));
        }
        let sum =
            |this: &mut Self, a: Number, b: Number| this.contexts.apply(Op::Binary(Binary::Add), &[a, b]);
        let sum = near.into_iter().reduce(|a, b| sum(self, a, b)).unwrap_or(Number::float(0.0));
        let template = Value::Number(sum.clone());
        Ok(self.close_with(&name, &template, vec![sum]))
    }

    /// 1 for each surface that is near, and 0 for each other one.
    fn near_surfaces(
        &mut self,
        shape: &Rc<Shape<'t>>,
        point: &Number,
        width: &Number,
        span: Span,
        near: &mut Vec<Number>,
    ) -> Eval<()> {
        let parts = parts_of_union(shape);
        if parts.len() > 1 {
            return parts.iter().try_for_each(|part| self.near_surfaces(part, point, width, span, near));
        }
        let samples = match &shape.kind {
            _ if !shape.painted => Vec::new(),
            ShapeKind::Named { inner, .. } => return self.near_surfaces(inner, point, width, span, near),
            ShapeKind::Painted { shape: inner, .. } if inner.painted => {
                return self.near_surfaces(inner, point, width, span, near);
            }
            ShapeKind::Painted { .. } | ShapeKind::Union { .. } => Vec::new(),
            ShapeKind::Choice { condition, then, otherwise } => {
                let (condition, then, otherwise) = (condition.clone(), then.clone(), otherwise.clone());
                self.samples_of(|this| this.chosen_distance(&condition, [&then, &otherwise], point, span))?
            }
            ShapeKind::Field { block, env, .. } => {
                let (block, env) = (*block, env.clone());
                self.samples_of(|this| this.field_value(block, &env, point))?
            }
        };
        if samples.is_empty() {
            let distance = self.sample(shape, point, span)?;
            let size = self.contexts.apply(Op::Unary(Unary::Abs), &[distance]);
            let is_near = self.contexts.apply(Op::Binary(Binary::Less), &[size, width.clone()]);
            let [one, zero] = [1.0, 0.0].map(Number::float);
            near.push(self.contexts.apply(Op::Ternary(Ternary::Select), &[is_near, one, zero]));
        }
        samples.iter().try_for_each(|(part, at, _)| self.near_surfaces(part, at, width, span, near))
    }
}
