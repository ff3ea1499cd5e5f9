//! Which shapes are convex: from contracts, and of half spaces from their formulas.
//!
//! What the library promises, and what is exact, has a field that is a convex function outside of the solid: the distance to
//! a convex solid is one, and the library's operators keep that. So all that lies within any level of it is convex too. A
//! file promises it of the solid alone; its field may have dents further out, which rounding would bring to light. So only
//! what has a convex field stays convex under operators.

use crate::contract::Quality;
use crate::eval::{Elaborator, Eval};
use crate::facts::Stated;
use crate::value::{Shape, ShapeKind};
use std::rc::Rc;

/// What is known of a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Convexity {
    /// Nothing.
    Unknown,
    /// The solid is convex.
    Solid,
    /// So is the field outside of it, as a function.
    Function,
}

impl<'t> Elaborator<'t> {
    /// Whether a shape is convex, for all values of the params and for all times.
    pub fn is_convex(&mut self, shape: &Rc<Shape<'t>>) -> Eval<bool> {
        Ok(self.convexity(shape)? >= Convexity::Solid)
    }

    /// Whether a contract says that its shape is convex: that of an operator does where its shapes are.
    pub fn claims_convex(&mut self, stated: &Stated<'t>) -> Eval<bool> {
        if stated.contract.convex.is_none() {
            return Ok(false);
        }
        for shape in &stated.shapes {
            if self.convexity(shape)? < Convexity::Function {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn convexity(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Convexity> {
        let key = Rc::as_ptr(shape).cast::<()>();
        if let Some(convexity) = self.facts.convexities.get(&key) {
            return Ok(*convexity);
        }
        let convexity = self.find_convexity(shape)?;
        self.facts.kept.push(shape.clone());
        self.facts.convexities.insert(key, convexity);
        Ok(convexity)
    }

    fn find_convexity(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Convexity> {
        let promised = self.promised_convexity(shape)?;
        let found = match &shape.kind {
            ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
                self.convexity(&inner.clone())?
            }
            ShapeKind::Choice { then, otherwise, .. } => {
                let (then, otherwise) = (then.clone(), otherwise.clone());
                self.convexity(&then)?.min(self.convexity(&otherwise)?)
            }
            ShapeKind::Union { shapes } => match &shapes[..] {
                [only] => self.convexity(&only.clone())?,
                _ => Convexity::Unknown,
            },
            ShapeKind::Field { .. } if promised == Convexity::Unknown && self.is_half_space(shape)? => {
                Convexity::Function
            }
            ShapeKind::Field { .. } => Convexity::Unknown,
        };
        Ok(promised.max(found))
    }

    fn promised_convexity(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Convexity> {
        let Some(stated) = self.stated(shape) else { return Ok(Convexity::Unknown) };
        if !self.claims_convex(&stated)? {
            return Ok(Convexity::Unknown);
        }
        let has_convex_field =
            !stated.module.is_user() || self.slope_of(shape)?.quality == Some(Quality::Exact);
        Ok(if has_convex_field { Convexity::Function } else { Convexity::Solid })
    }
}
