//! Prefix and infix operators, on numbers and on shapes.

use crate::errors;
use crate::eval::{Elaborator, Eval, LOOP_LIMIT, Reported};
use crate::value::{Env, Number, Value};
use sdf_ir::{Binary, Constant, Type, Unary};
use sdf_syntax::tree::{BinaryOp, Expr, UnaryOp};
use sdf_syntax::{Diagnostic, Span};

impl<'t> Elaborator<'t> {
    pub fn prefix(&mut self, op: UnaryOp, value: Value<'t>, span: Span) -> Eval<Value<'t>> {
        match (op, &value) {
            (UnaryOp::Negate, Value::Number(n)) if n.ty != Type::Bool => {
                self.unary(Unary::Negate, n, span).map(Value::Number)
            }
            (UnaryOp::Not, Value::Number(n)) if n.ty == Type::Bool => {
                self.unary(Unary::Not, n, span).map(Value::Number)
            }
            (UnaryOp::Not, Value::Shape(_)) => self.call_named("complement", vec![value.clone()], span),
            (UnaryOp::Negate, Value::Shape(_)) => self.report(errors::prefix_operator(
                span,
                "-",
                "a shape",
                Some("the complement of a shape is `!s`"),
            )),
            (op, value) => {
                let (symbol, help) = match op {
                    UnaryOp::Negate => ("-", None),
                    UnaryOp::Not => ("!", Some("`!` takes a bool or a shape")),
                };
                let found = value.describe();
                self.report(errors::prefix_operator(span, symbol, &found, help))
            }
        }
    }

    pub fn chain(
        &mut self,
        first: &'t Expr,
        rest: &'t [(BinaryOp, Span, Expr)],
        env: &Env<'t>,
    ) -> Eval<Value<'t>> {
        if rest.len() >= 2 && rest.iter().all(|(op, ..)| *op == BinaryOp::Union) {
            return self.union_chain(first, rest, env);
        }
        let mut left = self.eval(first, env);
        for (op, op_span, right) in rest {
            if left.as_ref().is_ok_and(|l| decides(*op, l)) {
                continue;
            }
            let span = first.span.to(right.span);
            let right_value = self.eval(right, env);
            left = match (left, right_value) {
                (Ok(l), Ok(r)) => self.infix(*op, l, r, span, *op_span),
                _ => Err(Reported),
            };
        }
        left
    }

    /// `a | b | c …` is one union, so that ten thousand shapes are one list and not a tower.
    pub fn union_chain(
        &mut self,
        first: &'t Expr,
        rest: &'t [(BinaryOp, Span, Expr)],
        env: &Env<'t>,
    ) -> Eval<Value<'t>> {
        let all: Vec<_> = std::iter::once(first)
            .chain(rest.iter().map(|(_, _, e)| e))
            .map(|e| self.eval(e, env).map(|v| (v, e.span)))
            .collect();
        let all = all.into_iter().collect::<Eval<Vec<_>>>()?;
        let Value::Shape(shape) = &all[0].0 else {
            let found = all[0].0.describe();
            let second = all[1].0.describe();
            return self.report(self.infix_error(BinaryOp::Union, &found, &second, rest[0].1));
        };
        let dimension = shape.dimension;
        for (i, (value, _)) in all.iter().enumerate().skip(1) {
            if !matches!(value, Value::Shape(s) if s.dimension == dimension) {
                let (left, right) = (all[0].0.describe(), value.describe());
                return self.report(self.infix_error(BinaryOp::Union, &left, &right, rest[i - 1].1));
            }
        }
        let span = first.span.to(rest[rest.len() - 1].2.span);
        self.call_named("union", all.into_iter().map(|(v, _)| v).collect(), span)
    }

    pub fn infix(
        &mut self,
        op: BinaryOp,
        left: Value<'t>,
        right: Value<'t>,
        span: Span,
        op_span: Span,
    ) -> Eval<Value<'t>> {
        match (&left, &right) {
            (Value::Number(a), Value::Number(b)) => {
                let (a, b) = (a.clone(), b.clone());
                self.infix_numbers(op, a, b, span, op_span)
            }
            (Value::Shape(a), Value::Shape(b)) if a.dimension == b.dimension => {
                let name = match op {
                    BinaryOp::Union => "union",
                    BinaryOp::Intersection => "intersection",
                    BinaryOp::Subtract => "difference",
                    _ => {
                        let (l, r) = (left.describe(), right.describe());
                        return self.report(self.infix_error(op, &l, &r, op_span));
                    }
                };
                self.call_named(name, vec![left, right], span)
            }
            _ => {
                let (l, r) = (left.describe(), right.describe());
                self.report(self.infix_error(op, &l, &r, op_span))
            }
        }
    }

    pub fn infix_error(&self, op: BinaryOp, left: &str, right: &str, span: Span) -> Diagnostic {
        let shape = |s: &str| s.ends_with("shape");
        let help = match op {
            BinaryOp::Add if shape(left) && shape(right) => Some("the union of two shapes is `a | b`"),
            BinaryOp::Add if shape(left) => {
                Some("to make a shape thicker, use `.round(r)`; to move it, `.at(v)`")
            }
            BinaryOp::Subtract if shape(left) && !shape(right) => {
                Some("to make a shape thicker, use `.round(r)`")
            }
            BinaryOp::Multiply if shape(left) && shape(right) => {
                Some("the intersection of two shapes is `a & b`")
            }
            BinaryOp::Multiply if shape(left) || shape(right) => {
                Some("to scale a shape, use `.scale(factor)`")
            }
            BinaryOp::And if shape(left) => Some("the intersection of two shapes is `a & b`"),
            BinaryOp::Or if shape(left) => Some("the union of two shapes is `a | b`"),
            BinaryOp::Union | BinaryOp::Intersection if !shape(left) && !shape(right) => {
                Some("`|` and `&` are for shapes; for bools use `||` and `&&`")
            }
            _ if left == "a shape" && right == "a 2D shape" || left == "a 2D shape" && right == "a shape" => {
                Some("make the 2D shape solid with `.extrude(h)` or `.revolve()`")
            }
            _ => None,
        };
        errors::operator(span, op.symbol(), left, right, help)
    }

    pub fn infix_numbers(
        &mut self,
        op: BinaryOp,
        a: Number,
        b: Number,
        span: Span,
        op_span: Span,
    ) -> Eval<Value<'t>> {
        let bools = a.ty == Type::Bool && b.ty == Type::Bool;
        let numbers = a.ty != Type::Bool && b.ty != Type::Bool;
        let floats = a.ty == Type::Float && b.ty == Type::Float;
        let fits = match op {
            BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply | BinaryOp::Divide | BinaryOp::Modulo => {
                numbers && (a.ty == b.ty || a.ty == Type::Float || b.ty == Type::Float)
            }
            BinaryOp::Less | BinaryOp::LessEqual | BinaryOp::Greater | BinaryOp::GreaterEqual => floats,
            BinaryOp::Equal | BinaryOp::NotEqual => {
                bools || numbers && (a.ty == b.ty || a.ty == Type::Float || b.ty == Type::Float)
            }
            BinaryOp::And | BinaryOp::Or => bools,
            BinaryOp::Range => floats,
            BinaryOp::Union | BinaryOp::Intersection => false,
        };
        if !fits {
            let (l, r) = (crate::value::describe_type(a.ty), crate::value::describe_type(b.ty));
            return self.report(self.infix_error(op, l, r, op_span));
        }
        let number = match op {
            BinaryOp::Add => self.binary(Binary::Add, &a, &b, span)?,
            BinaryOp::Subtract => self.binary(Binary::Subtract, &a, &b, span)?,
            BinaryOp::Multiply => self.binary(Binary::Multiply, &a, &b, span)?,
            BinaryOp::Divide => self.binary(Binary::Divide, &a, &b, span)?,
            BinaryOp::Modulo => self.binary(Binary::Modulo, &a, &b, span)?,
            BinaryOp::Less => self.binary(Binary::Less, &a, &b, span)?,
            BinaryOp::LessEqual => self.binary(Binary::LessEqual, &a, &b, span)?,
            BinaryOp::Greater => self.binary(Binary::Less, &b, &a, span)?,
            BinaryOp::GreaterEqual => self.binary(Binary::LessEqual, &b, &a, span)?,
            BinaryOp::Equal => self.equal(&a, &b, span)?,
            BinaryOp::NotEqual => {
                let equal = self.equal(&a, &b, span)?;
                self.unary(Unary::Not, &equal, span)?
            }
            BinaryOp::And => self.binary(Binary::And, &a, &b, span)?,
            BinaryOp::Or => self.binary(Binary::Or, &a, &b, span)?,
            BinaryOp::Range => return self.range(&a, &b, span),
            BinaryOp::Union | BinaryOp::Intersection => unreachable!("refused above"),
        };
        Ok(Value::Number(number))
    }

    /// Whether two numbers are equal; vectors are where all their components are.
    fn equal(&mut self, a: &Number, b: &Number, span: Span) -> Eval<Number> {
        let mut all: Option<Number> = None;
        for i in 0..a.ty.size().max(b.ty.size()) {
            let (x, y) = (self.component(a, i), self.component(b, i));
            let equal = self.binary(Binary::Equal, &x, &y, span)?;
            all = Some(match all {
                Some(before) => self.binary(Binary::And, &before, &equal, span)?,
                None => equal,
            });
        }
        Ok(all.expect("a number has a component"))
    }

    pub fn range(&mut self, from: &Number, to: &Number, span: Span) -> Eval<Value<'t>> {
        let (Some(Constant::Float(from)), Some(Constant::Float(to))) = (from.known(), to.known()) else {
            return self.report(errors::not_static(span, "the ends of a range"));
        };
        if from.fract() != 0.0 || to.fract() != 0.0 {
            return self.report(errors::out_of_range(span, "an end of this range", "whole numbers"));
        }
        let count = (to - from).max(0.0);
        if count > LOOP_LIMIT as f64 {
            return self.report(errors::too_long(span, "this range", LOOP_LIMIT as u64));
        }
        Ok(Value::list((0..count as usize).map(|i| Value::float(from + i as f64)).collect()))
    }
}

/// Whether the left side of `&&` or `||` is known and settles it, so that the right side is not asked for.
fn decides(op: BinaryOp, left: &Value<'_>) -> bool {
    let Value::Number(n) = left else { return false };
    match op {
        BinaryOp::And => n.known() == Some(Constant::Bool(false)),
        BinaryOp::Or => n.known() == Some(Constant::Bool(true)),
        _ => false,
    }
}
