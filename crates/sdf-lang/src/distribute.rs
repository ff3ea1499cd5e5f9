//! What an operator makes of a union is the union of what it makes of the parts, if the field never falls where the
//! distance that it samples grows: `union(a, b).scale(2)` is `union(a.scale(2), b.scale(2))`, to the last bit. So the
//! parts can be told apart, the half spaces among them and the steep ones, behind operators too.

use crate::eval::{Elaborator, Eval};
use crate::scene::parts_of_union;
use crate::value::{Shape, ShapeKind, Value};
use std::rc::Rc;

impl<'t> Elaborator<'t> {
    /// The shapes that a shape is the union of, also behind paint and operators; a shape that is none is its only part.
    pub fn parts_behind(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Vec<Rc<Shape<'t>>>> {
        if let Some(parts) = self.facts.parts_behind(shape) {
            return Ok(parts);
        }
        let parts = self.find_parts_behind(shape)?;
        self.facts.keep_parts_behind(shape, &parts);
        Ok(parts)
    }

    fn find_parts_behind(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Vec<Rc<Shape<'t>>>> {
        if let parts @ [_, _, ..] = &parts_of_union(shape)[..] {
            return Ok(parts.to_vec());
        }
        let whole = || Ok(vec![shape.clone()]);
        let made: Vec<ShapeKind<'t>> = match &shape.kind {
            ShapeKind::Named { inner, .. } => {
                let parts = self.parts_behind(inner)?;
                return if parts.len() > 1 { Ok(parts) } else { whole() };
            }
            ShapeKind::Painted { shape: inner, material } => {
                let painted = |shape| ShapeKind::Painted { shape, material: material.clone() };
                self.parts_behind(inner)?.into_iter().map(painted).collect()
            }
            ShapeKind::Field { block, env, origin: Some(origin) } => {
                let parameters = &origin.function.parameters;
                let variables = env.variables();
                let of_parameters = |(name, _): &(_, _)| parameters.iter().any(|p| p.name.text == *name);
                let mut shapes = variables.iter().filter(|(_, v)| v.traits().shapes);
                // What the body has named may be made from the whole union, its box for example.
                let (Some((name, Value::Shape(inner))), None, true) =
                    (shapes.next(), shapes.next(), variables.iter().all(of_parameters))
                else {
                    return whole();
                };
                let parts = self.parts_behind(inner)?;
                if parts.len() < 2 || !self.grows_with_its_sample(shape)? {
                    return whole();
                }
                let of = |part: Rc<Shape<'t>>| {
                    let env =
                        env.map(|own, value| if own == name { Value::Shape(part.clone()) } else { value });
                    ShapeKind::Field { block, env, origin: Some(*origin) }
                };
                parts.into_iter().map(of).collect()
            }
            _ => return whole(),
        };
        if made.len() < 2 {
            return whole();
        }
        let like = |kind| Rc::new(Shape { kind, ..**shape });
        Ok(made.into_iter().map(like).collect())
    }
}
