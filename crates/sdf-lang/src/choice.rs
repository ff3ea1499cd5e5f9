//! `if`: decided now, for a whole frame, or at each point; and what its two sides have in common.

use crate::context::Op;
use crate::errors;
use crate::eval::{Elaborator, Eval, Reported, numbers_of};
use crate::value::{Env, Number, Shape, ShapeKind, Value};
use sdf_ir::{Constant, Ternary, Type};
use sdf_syntax::Span;
use sdf_syntax::tree::{Block, Expr};
use std::rc::Rc;
use std::sync::Arc;

impl<'t> Elaborator<'t> {
    pub fn choice(
        &mut self,
        condition: &'t Expr,
        then: &'t Block,
        otherwise: &'t Block,
        env: &Env<'t>,
    ) -> Eval<Value<'t>> {
        let value = self.eval(condition, env)?;
        let c = self.as_typed(value, Type::Bool, condition.span)?;
        match c.known() {
            Some(Constant::Bool(true)) => return self.block(then, env),
            Some(_) => return self.block(otherwise, env),
            None => {}
        }
        let costly = crate::outline::is_costly(then) || crate::outline::is_costly(otherwise);
        if costly && (c.is_local() || !self.is_shape(then, env)) {
            return self.branch(&c, condition.span, then, otherwise, env);
        }
        let a = self.block(then, env)?;
        let b = self.block(otherwise, env)?;
        if let (Value::Shape(a), Value::Shape(b)) = (&a, &b)
            && a.dimension == b.dimension
            && !c.is_local()
        {
            let (dimension, painted, steep) = (a.dimension, a.painted || b.painted, a.steep || b.steep);
            let kind = ShapeKind::Choice { condition: c, then: a.clone(), otherwise: b.clone() };
            return Ok(Value::Shape(Rc::new(Shape {
                dimension,
                kind,
                painted,
                steep,
                place: condition.span,
            })));
        }
        let (a, b) = self.alike(a, b, then.result.span, otherwise.result.span)?;
        self.zip(&a, &b, condition.span, &mut |this, x, y| {
            Ok(this.contexts.apply(Op::Ternary(Ternary::Select), &[c.clone(), x.clone(), y.clone()]))
        })
    }

    /// Whether a block gives a shape; nothing that it does is kept.
    pub fn is_shape(&mut self, block: &'t Block, env: &Env<'t>) -> bool {
        let reported = self.diagnostics.len();
        self.contexts.open(&Arc::from("trial"), None);
        let value = self.block(block, env);
        self.contexts.discard();
        self.diagnostics.truncate(reported);
        matches!(value, Ok(Value::Shape(_)))
    }

    /// An `if` of which only one side is computed.
    pub fn branch(
        &mut self,
        condition: &Number,
        span: Span,
        then: &'t Block,
        otherwise: &'t Block,
        env: &Env<'t>,
    ) -> Eval<Value<'t>> {
        let c = self.contexts.value(condition);
        let mut then_region = self.contexts.builder().open_region(&[]);
        let a = self.block(then, env);
        let a_numbers = a.as_ref().map_or(Vec::new(), numbers_of);
        let a_values: Vec<_> = a_numbers.iter().map(|n| self.contexts.value(n)).collect();
        self.contexts.builder().close_region(a_values);

        let else_region = self.contexts.builder().open_region(&[]);
        let b = self.block(otherwise, env);
        let template = match (a, &b) {
            (Ok(a), Ok(b)) => self.joined(&a, b, span),
            _ => Err(Reported),
        };
        let b_numbers = match (&template, &b) {
            (Ok(template), Ok(b)) => self.like(template, b, otherwise.result.span),
            _ => Err(Reported),
        };
        let b_values: Vec<_> = b_numbers.iter().flatten().map(|n| self.contexts.value(n)).collect();
        self.contexts.builder().close_region(b_values);
        let template = template?;
        b_numbers?;

        let types = |numbers: &[Number]| numbers.iter().map(|n| n.ty).collect::<Vec<Type>>();
        if types(&a_numbers) != types(&numbers_of(&template)) {
            // The first side is to be widened to what the second turned out to be: made once more.
            then_region = self.contexts.builder().open_region(&[]);
            let a = self.block(then, env).and_then(|a| self.like(&template, &a, then.result.span));
            let a_values: Vec<_> = a.iter().flatten().map(|n| self.contexts.value(n)).collect();
            self.contexts.builder().close_region(a_values);
            a?;
        }
        let results = self.contexts.builder().branch(c, then_region, else_region);
        self.unflatten(&template, &results)
    }

    /// The form that two values have in common, floats widened where the other is a vector; its numbers are 0.
    pub fn joined(&mut self, a: &Value<'t>, b: &Value<'t>, span: Span) -> Eval<Value<'t>> {
        match (a, b) {
            (Value::Number(x), Value::Number(y))
                if x.ty == y.ty
                    || (x.ty != Type::Bool && y.ty != Type::Bool && x.ty.min(y.ty) == Type::Float) =>
            {
                let zero = match x.ty.max(y.ty) {
                    Type::Bool => Constant::Bool(false),
                    ty => Constant::from_components(&vec![0.0; ty.size()]),
                };
                Ok(Value::Number(Number { name: x.name.clone(), ..Number::constant(zero) }))
            }
            (Value::Record(x), Value::Record(y)) if x.fields.len() == y.fields.len() => {
                let mut fields = Vec::new();
                for (name, left) in &x.fields {
                    let Some(right) = y.get(name) else {
                        return self.report(errors::no_member(span, name, "the other record", None));
                    };
                    fields.push((name.clone(), self.joined(left, right, span)?));
                }
                Ok(Value::record(fields))
            }
            (Value::List(x), Value::List(y)) if x.items.len() == y.items.len() => {
                let pairs = x.items.iter().zip(&y.items);
                let items: Eval<Vec<_>> = pairs.map(|(x, y)| self.joined(x, y, span)).collect();
                Ok(Value::list(items?))
            }
            (Value::Shape(_), Value::Shape(_)) => self.report(errors::shape_depends_on_point(span)),
            (Value::List(_), Value::List(_)) => self.report(errors::not_static(span, "the length of a list")),
            (Value::Number(_) | Value::Record(_), _) => {
                let (expected, found) = (a.describe(), b.describe());
                self.report(errors::wrong_type(span, &expected, &found))
            }
            _ => self.report(errors::not_static(span, "which of these it is")),
        }
    }

    /// Two values of one kind, floats widened where the other is a vector.
    pub fn alike(
        &mut self,
        a: Value<'t>,
        b: Value<'t>,
        a_span: Span,
        b_span: Span,
    ) -> Eval<(Value<'t>, Value<'t>)> {
        match (&a, &b) {
            (Value::Number(x), Value::Number(y)) if x.ty != y.ty => {
                let ty = x.ty.max(y.ty);
                let x = self.widen(x, ty, a_span)?;
                let y = self.widen(y, ty, b_span)?;
                Ok((Value::Number(x), Value::Number(y)))
            }
            (Value::Number(_), Value::Number(_))
            | (Value::Record(_), Value::Record(_))
            | (Value::List(_), Value::List(_)) => Ok((a, b)),
            (Value::Shape(_), _) | (_, Value::Shape(_)) => {
                self.report(errors::shape_depends_on_point(a_span))
            }
            _ => self.report(errors::not_static(a_span, "which of these it is")),
        }
    }

    /// Combines the numbers of two values of one form.
    pub fn zip(
        &mut self,
        a: &Value<'t>,
        b: &Value<'t>,
        span: Span,
        f: &mut dyn FnMut(&mut Self, &Number, &Number) -> Eval<Number>,
    ) -> Eval<Value<'t>> {
        match (a, b) {
            (Value::Number(x), Value::Number(y)) => {
                let ty = x.ty.max(y.ty);
                let (x, y) = (self.widen(x, ty, span)?, self.widen(y, ty, span)?);
                f(self, &x, &y).map(Value::Number)
            }
            (Value::Record(x), Value::Record(y)) if x.fields.len() == y.fields.len() => {
                let mut fields = Vec::new();
                for (name, left) in &x.fields {
                    let Some(right) = y.get(name) else {
                        return self.report(errors::no_member(span, name, "the other record", None));
                    };
                    fields.push((name.clone(), self.zip(left, right, span, f)?));
                }
                Ok(Value::record(fields))
            }
            (Value::List(x), Value::List(y)) if x.items.len() == y.items.len() => {
                let pairs = x.items.iter().zip(&y.items);
                let items: Eval<Vec<_>> = pairs.map(|(x, y)| self.zip(x, y, span, f)).collect();
                Ok(Value::list(items?))
            }
            (Value::Shape(_), Value::Shape(_)) => self.report(errors::shape_depends_on_point(span)),
            (Value::List(_), Value::List(_)) => self.report(errors::not_static(span, "the length of a list")),
            (a, b) => {
                let (expected, found) = (a.describe(), b.describe());
                self.report(errors::wrong_type(span, &expected, &found))
            }
        }
    }
}
