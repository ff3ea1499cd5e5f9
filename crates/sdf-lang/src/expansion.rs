//! How large a shape is when it is written out: a shape that is shared is sampled once for each place that samples
//! it, so a few lines can stand for more operations than anything can carry out. They are counted on the values,
//! where what is shared is looked at once, before anything is written out.

use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::value::{Callable, Env, Number, Shape, ShapeKind, Value};
use rustc_hash::FxHashMap;
use sdf_syntax::Span;
use sdf_syntax::tree::{Argument, Block, Expr, ExprKind, PostfixKind};
use std::ops::Add;
use std::rc::Rc;
use std::sync::Arc;

/// How many operations one evaluation of a scene may take, with calls expanded.
pub(crate) const OPERATION_LIMIT: u64 = 1_000_000;
/// How many expressions may be evaluated to find out what the shapes are.
const FREE_WORK: usize = 1_500_000;
/// How many may be evaluated to write shapes out, besides those that they are known to need: what bounds the time of
/// an expansion of numbers inside a field.
const FREE_WORK_INSIDE: usize = 100_000;
/// How often a shape's expressions are evaluated at most: for the map, its materials, the frame and the camera, each
/// of them again in the functions that are named after it.
const TIMES: u64 = 256;

impl<'t> Elaborator<'t> {
    /// Allows what it takes to find out what the shapes are.
    pub fn allow_finding(&mut self) {
        self.work_limit = self.work + FREE_WORK + self.text_size();
    }

    /// Allows the evaluation of shapes that take this many expressions each time.
    pub fn allow_writing(&mut self, expressions: u64) {
        let known = expressions.saturating_mul(TIMES).min(u64::from(u32::MAX)) as usize;
        self.work_limit = self.work + FREE_WORK_INSIDE + self.text_size() + known;
    }

    /// What is written by hand is allowed, whatever it is.
    fn text_size(&self) -> usize {
        self.sources.get(crate::USER_FILE).map_or(0, |source| source.text.len())
    }

    /// Refuses a shape, or a list of shapes, that is too large to be written out; `span` is where it is asked for.
    pub fn check_size(&mut self, value: &Value<'t>, span: Span) -> Eval<()> {
        let operations = self.sizes.value(value).operations;
        if operations <= OPERATION_LIMIT {
            return Ok(());
        }
        self.report(errors::expands_too_far(span, operations, OPERATION_LIMIT))
    }

    /// Refuses a distance that is a call of a function which takes too many operations.
    pub fn check_operations(&mut self, distance: &Number) -> Eval<()> {
        let operations = self.contexts.operations(distance);
        if operations <= OPERATION_LIMIT {
            return Ok(());
        }
        self.report(errors::expands_too_far(self.place, operations, OPERATION_LIMIT))
    }
}

/// What one evaluation of a shape takes at least, as far as its text shows; the largest number stands for more.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Size {
    /// Operations: operators, calls and samples.
    pub operations: u64,
    /// Expressions that are evaluated to write it out.
    pub expressions: u64,
}

impl Size {
    const OPERATION: Size = Size { operations: 1, expressions: 0 };
    const EXPRESSION: Size = Size { operations: 0, expressions: 1 };

    /// The smaller in each respect: what is certain where one of two is taken.
    fn least(self, other: Size) -> Size {
        Size {
            operations: self.operations.min(other.operations),
            expressions: self.expressions.min(other.expressions),
        }
    }

    fn times(self, count: u64) -> Size {
        Size {
            operations: self.operations.saturating_mul(count),
            expressions: self.expressions.saturating_mul(count),
        }
    }
}

impl Add for Size {
    type Output = Size;

    fn add(self, other: Size) -> Size {
        Size {
            operations: self.operations.saturating_add(other.operations),
            expressions: self.expressions.saturating_add(other.expressions),
        }
    }
}

/// The sizes of what was looked at, by its place in memory; it lives on, so that nothing else can take that place.
#[derive(Debug, Default)]
pub(crate) struct Sizes<'t> {
    known: FxHashMap<*const (), (Value<'t>, Size)>,
}

impl<'t> Sizes<'t> {
    /// The size of a shape.
    pub fn of(&mut self, shape: &Rc<Shape<'t>>) -> Size {
        self.once(Rc::as_ptr(shape).cast(), || Value::Shape(shape.clone()), |this| this.shape(shape))
    }

    fn once(
        &mut self,
        place: *const (),
        value: impl FnOnce() -> Value<'t>,
        size: impl FnOnce(&mut Self) -> Size,
    ) -> Size {
        if let Some((_, size)) = self.known.get(&place) {
            return *size;
        }
        let size = size(self);
        self.known.insert(place, (value(), size));
        size
    }

    fn shape(&mut self, shape: &Rc<Shape<'t>>) -> Size {
        match &shape.kind {
            ShapeKind::Painted { shape, .. } | ShapeKind::Named { inner: shape, .. } => self.of(shape),
            ShapeKind::Union { shapes } => {
                shapes.iter().fold(Size::default(), |sum, s| sum + self.of(s) + Size::OPERATION)
            }
            ShapeKind::Choice { then, otherwise, .. } => self.of(then) + self.of(otherwise),
            ShapeKind::Field { block, env, .. } => self.block(block, env, &mut vec![Arc::from("p")]),
        }
    }

    /// What a value adds where it is mentioned: as if all shapes in it were sampled once.
    fn value(&mut self, value: &Value<'t>) -> Size {
        match value {
            Value::Shape(shape) => self.of(shape) + Size::OPERATION,
            Value::List(list) if list.traits.shapes => self.once(
                Rc::as_ptr(list).cast(),
                || value.clone(),
                |this| list.items.iter().fold(Size::default(), |sum, v| sum + this.value(v)),
            ),
            Value::Record(record) if record.traits.shapes => self.once(
                Rc::as_ptr(record).cast(),
                || value.clone(),
                |this| record.fields.iter().fold(Size::default(), |sum, (_, v)| sum + this.value(v)),
            ),
            Value::Function(function) => match &**function {
                Callable::Lambda { lambda, env } => self.once(
                    Rc::as_ptr(function).cast(),
                    || value.clone(),
                    |this| {
                        let mut hidden = lambda.parameters.iter().map(|p| p.name.text.clone()).collect();
                        this.expr(&lambda.body, env, &mut hidden)
                    },
                ),
                Callable::Overloads(..) | Callable::Native(_) => Size::default(),
            },
            Value::Number(_) | Value::Material(_) | Value::List(_) | Value::Record(_) => Size::default(),
        }
    }

    /// `hidden` are the names that mean something else inside than in `env`.
    fn block(&mut self, block: &'t Block, env: &Env<'t>, hidden: &mut Vec<Arc<str>>) -> Size {
        let before = hidden.len();
        let mut size = Size::default();
        for binding in &block.bindings {
            size = size + self.expr(&binding.value, env, hidden);
            hidden.push(binding.name.text.clone());
        }
        size = size + self.expr(&block.result, env, hidden);
        hidden.truncate(before);
        size
    }

    fn expr(&mut self, expr: &'t Expr, env: &Env<'t>, hidden: &mut Vec<Arc<str>>) -> Size {
        let inside = match &expr.kind {
            ExprKind::Number(_) | ExprKind::Color(_) | ExprKind::Bool(_) | ExprKind::Error => Size::default(),
            ExprKind::Name(name) => self.name(name, env, hidden),
            ExprKind::Tuple(items) | ExprKind::List(items) => self.sum(items, env, hidden),
            ExprKind::Record(record) => self.sum(record.fields.iter().map(|f| &f.value), env, hidden),
            // It is not looked at for a distance.
            ExprKind::Material(_) => Size::default(),
            ExprKind::Block(block) => self.block(block, env, hidden),
            ExprKind::Shape(_, block) => {
                hidden.push(Arc::from("p"));
                let size = self.block(block, env, hidden);
                hidden.pop();
                size
            }
            ExprKind::If { condition, then, otherwise } => {
                let (a, b) = (self.block(then, env, hidden), self.block(otherwise, env, hidden));
                self.expr(condition, env, hidden) + a.least(b)
            }
            ExprKind::For { name, list, body } => {
                let rounds = rounds(list, env, hidden);
                let list = self.expr(list, env, hidden);
                hidden.push(name.text.clone());
                let body = self.block(body, env, hidden);
                hidden.pop();
                list + body.times(rounds)
            }
            ExprKind::Lambda(lambda) => {
                let before = hidden.len();
                hidden.extend(lambda.parameters.iter().map(|p| p.name.text.clone()));
                let size = self.expr(&lambda.body, env, hidden);
                hidden.truncate(before);
                size
            }
            ExprKind::Unary(_, operand) => self.expr(operand, env, hidden) + Size::OPERATION,
            ExprKind::Chain { first, rest } => {
                let operators = Size::OPERATION.times(rest.len() as u64);
                let operands = std::iter::once(first.as_ref()).chain(rest.iter().map(|(_, _, e)| e));
                self.sum(operands, env, hidden) + operators
            }
            ExprKind::Postfix { base, operations } => {
                let mut size = self.expr(base, env, hidden);
                for operation in operations {
                    size = size
                        + match &operation.kind {
                            PostfixKind::Call(arguments) | PostfixKind::Method(_, arguments) => {
                                self.arguments(arguments, env, hidden) + Size::OPERATION
                            }
                            PostfixKind::Index(index) => self.expr(index, env, hidden),
                            PostfixKind::Member(_) => Size::default(),
                        };
                }
                size
            }
        };
        inside + Size::EXPRESSION
    }

    fn name(&mut self, name: &str, env: &Env<'t>, hidden: &[Arc<str>]) -> Size {
        match env.get(name) {
            Some(value) if !hidden.iter().any(|h| &**h == name) => self.value(value),
            _ => Size::default(),
        }
    }

    fn sum(
        &mut self,
        exprs: impl IntoIterator<Item = &'t Expr>,
        env: &Env<'t>,
        hidden: &mut Vec<Arc<str>>,
    ) -> Size {
        exprs.into_iter().fold(Size::default(), |sum, e| sum + self.expr(e, env, hidden))
    }

    fn arguments(&mut self, arguments: &'t [Argument], env: &Env<'t>, hidden: &mut Vec<Arc<str>>) -> Size {
        self.sum(arguments.iter().map(|a| &a.value), env, hidden)
    }
}

/// How many rounds a `for` has at least: as many as the list that it names, else one.
fn rounds(list: &Expr, env: &Env<'_>, hidden: &[Arc<str>]) -> u64 {
    match &list.kind {
        ExprKind::Name(name) if !hidden.contains(name) => match env.get(name) {
            Some(Value::List(list)) => list.items.len() as u64,
            _ => 1,
        },
        _ => 1,
    }
}
