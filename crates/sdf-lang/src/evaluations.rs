//! Which functions of the program count as evaluations of a field, for those who ask what a picture costs: those with which
//! the renderer asks for a distance, be it with a step or a gradient, and for materials where those are told apart by
//! distances.
//!
//! What a field samples in its turn does not count. Nor do half spaces of which a ray is only told where it crosses them.

use crate::eval::{Elaborator, Eval};
use crate::value::{Module, Number, Shape, ShapeKind, Thunk};
use sdf_ir::{FunctionId, Node};
use std::rc::Rc;

impl<'t> Elaborator<'t> {
    /// What evaluates a field gives, and whether it is the renderer that asks for it, and not a field or a material that it
    /// has asked.
    pub fn asking<T>(&mut self, evaluate: impl FnOnce(&mut Self) -> Eval<T>) -> Eval<(T, bool)> {
        let is_inside = std::mem::replace(&mut self.is_asking, true);
        let result = evaluate(self);
        self.is_asking = is_inside;
        Ok((result?, !is_inside && self.is_rendering()))
    }

    /// Lets a distance that the renderer has asked for at a point count: the function that gives it, or, where the field is
    /// written into the function that asks, that one.
    pub fn count_evaluation(&mut self, distance: &Number, point: &Number) {
        if !self.contexts.is_innermost(distance) {
            return;
        }
        match self.field_function(distance, point) {
            Some(id) => self.contexts.program.functions[id.0 as usize].mark_evaluation(),
            None => self.contexts.builder().set_evaluation(true),
        }
    }

    /// The function of a point that a number is a result of.
    fn field_function(&mut self, number: &Number, point: &Number) -> Option<FunctionId> {
        let (value, point) = (self.contexts.value(number), self.contexts.value(point));
        let function = self.contexts.builder().function();
        let call = match function.node(value) {
            Node::Result(call, _) => function.node(call),
            node => node,
        };
        match call {
            Node::Call(id, list) if function.list(list).first() == Some(&point) => Some(id),
            _ => None,
        }
    }

    /// Whether the function that is open innermost calls a field.
    pub fn calls_a_field(&mut self) -> bool {
        let builder = self.contexts.builder();
        let function = builder.function();
        let callees: Vec<FunctionId> = (0..function.node_count() as u32)
            .filter_map(|v| match function.node(sdf_ir::Value(v)) {
                Node::Call(id, _) => Some(id),
                _ => None,
            })
            .collect();
        let is_field = |id: FunctionId| self.contexts.program.function(id).parameters.iter().any(|p| p.point);
        callees.into_iter().any(is_field)
    }

    /// Whether a shape is one of the half spaces beside the solids of a scene.
    pub fn is_plane_beside(&mut self, shape: &Rc<Shape<'t>>) -> Eval<bool> {
        match &shape.kind {
            ShapeKind::Named { thunk: Thunk::Fixed(_), .. } => Ok(false),
            _ => self.is_half_space(shape),
        }
    }
}

/// Whether a field is one that the renderer makes from others: those that it samples count, each by itself.
pub(crate) fn is_of_renderer(shape: &Shape<'_>) -> bool {
    matches!(&shape.kind, ShapeKind::Field { origin: Some(origin), .. } if origin.module == Module::Runtime)
}
