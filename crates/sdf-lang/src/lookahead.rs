//! How much there is to evaluate, found without evaluating all of it.
//!
//! What a call takes depends on its arguments only where they decide something: in the condition of an `if`, the list
//! of a `for`, a count. The other parameters are *inert*. In a trial, a call that differs from an earlier one in inert
//! arguments alone, and a round of a loop whose variable is inert, is not carried out but counted as the earlier one;
//! what it gives then has the wrong numbers and the right size, and is thrown away.

use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::names::Names;
use crate::value::{Env, Value};
use rustc_hash::{FxHashMap, FxHashSet};
use sdf_syntax::tree::{Argument, BinaryOp, Block, Expr, ExprKind, Function, Lambda, Postfix, PostfixKind};
use std::sync::Arc;

/// How many expressions may be evaluated before a look ahead is worth its time.
const SUSPICIOUS: usize = 40_000;
/// How many a trial may evaluate.
const TRIAL: usize = 100_000;

impl<'t> Elaborator<'t> {
    /// The value of an expression that no function is open round. One that would take too much is refused, mostly long
    /// before that.
    pub fn eval_ahead(&mut self, expr: &'t Expr, env: &Env<'t>) -> Eval<Value<'t>> {
        let was_trial = std::mem::replace(&mut self.is_trial, false);
        let value = self.eval_looking_ahead(expr, env);
        self.is_trial = was_trial;
        value
    }

    fn eval_looking_ahead(&mut self, expr: &'t Expr, env: &Env<'t>) -> Eval<Value<'t>> {
        if self.exhausted || self.work_limit - self.work.min(self.work_limit) <= SUSPICIOUS {
            return self.eval(expr, env);
        }
        let (value, is_over) = self.attempt(SUSPICIOUS, |this| this.eval(expr, env));
        if !is_over {
            return value;
        }
        let (start, skipped) = (self.work, self.skipped);
        self.is_trial = true;
        let mut total = None;
        let (_, is_over) = self.attempt(TRIAL, |this| {
            let value = this.eval(expr, env);
            total = Some(((this.work - start) as u64).saturating_add(this.skipped - skipped));
            value
        });
        self.is_trial = false;
        self.skipped = skipped;
        self.memos.forget_trials();
        match total.filter(|_| !is_over) {
            Some(total) if total > (self.work_limit - self.work) as u64 => {
                self.exhausted = true;
                self.report(errors::takes_too_much(expr.span, total))
            }
            _ => self.eval(expr, env),
        }
    }

    /// What comes of an evaluation within so many expressions, and whether they were too few: then all that it said
    /// and counted is forgotten.
    fn attempt(
        &mut self,
        work: usize,
        run: impl FnOnce(&mut Self) -> Eval<Value<'t>>,
    ) -> (Eval<Value<'t>>, bool) {
        let (said, start, limit) = (self.diagnostics.len(), self.work, self.work_limit);
        self.work_limit = limit.min(start + work);
        let value = run(self);
        self.work_limit = limit;
        let is_over = std::mem::replace(&mut self.exhausted, false);
        if is_over || self.is_trial {
            self.diagnostics.truncate(said);
            self.work = start;
        }
        (value, is_over)
    }

    /// Counts as skipped what is as much as `cost`, so many times.
    pub fn skip(&mut self, cost: u64, times: u64) {
        self.skipped = self.skipped.saturating_add(cost.saturating_mul(times));
    }

    /// What was evaluated and skipped so far.
    pub fn spent(&self) -> u64 {
        (self.work as u64).saturating_add(self.skipped)
    }

    /// Which parameters of a user's function decide nothing.
    pub fn inert_parameters(&mut self, function: &'t Function) -> Arc<[bool]> {
        let names = self.names;
        self.inert.get_or_insert_with(|| Inert::of(names)).of_function(function)
    }

    /// Which parameters of a lambda decide nothing.
    pub fn inert_of_lambda(&mut self, lambda: &'t Lambda) -> Arc<[bool]> {
        let names = self.names;
        self.inert.get_or_insert_with(|| Inert::of(names)).of_lambda(names, lambda)
    }

    /// Whether the variable of a loop decides nothing.
    pub fn is_inert_in(&mut self, name: &str, body: &'t Block) -> bool {
        let names = self.names;
        let inert = self.inert.get_or_insert_with(|| Inert::of(names));
        let place = std::ptr::from_ref(body).cast();
        if let Some(known) = inert.known.get(&place) {
            return known[0];
        }
        let mut walk = Walk { names, inert, deciding: FxHashSet::default() };
        walk.block(body, true);
        let is_inert = !walk.deciding.contains(name);
        inert.known.insert(place, Arc::from([is_inert]));
        is_inert
    }
}

/// Which parameters decide nothing, of functions, lambdas and loops by their place in memory.
#[derive(Default)]
pub(crate) struct Inert {
    known: FxHashMap<*const (), Arc<[bool]>>,
}

impl Inert {
    /// Those of the user's functions: all parameters are taken to be inert until one is seen to decide something.
    fn of(names: &Names<'_>) -> Inert {
        let functions = || names.user_modules().flat_map(|(_, items)| &items.all_functions).copied();
        let place = |function: &Function| std::ptr::from_ref(function).cast::<()>();
        let mut inert = Inert::default();
        inert.known.extend(functions().map(|f| (place(f), vec![true; f.parameters.len()].into())));
        let mut changes = true;
        while changes {
            changes = false;
            for function in functions() {
                let mut walk = Walk { names, inert: &inert, deciding: FxHashSet::default() };
                walk.expr(&function.body, true);
                let found: Arc<[bool]> =
                    function.parameters.iter().map(|p| !walk.deciding.contains(&*p.name.text)).collect();
                changes |= inert.known.insert(place(function), found.clone()) != Some(found);
            }
        }
        inert
    }

    fn of_function(&self, function: &Function) -> Arc<[bool]> {
        let place = std::ptr::from_ref(function).cast::<()>();
        self.known.get(&place).cloned().unwrap_or_else(|| vec![false; function.parameters.len()].into())
    }

    fn of_lambda(&mut self, names: &Names<'_>, lambda: &Lambda) -> Arc<[bool]> {
        let place = std::ptr::from_ref(lambda).cast::<()>();
        if let Some(known) = self.known.get(&place) {
            return known.clone();
        }
        let mut walk = Walk { names, inert: self, deciding: FxHashSet::default() };
        walk.expr(&lambda.body, true);
        let found: Arc<[bool]> =
            lambda.parameters.iter().map(|p| !walk.deciding.contains(&*p.name.text)).collect();
        self.known.insert(place, found.clone());
        found
    }
}

/// Looks for names that decide something. `inert` says whether what stands there can decide nothing.
struct Walk<'a, 't> {
    names: &'a Names<'t>,
    inert: &'a Inert,
    deciding: FxHashSet<Arc<str>>,
}

impl Walk<'_, '_> {
    fn block(&mut self, block: &Block, inert: bool) {
        self.expr(&block.result, inert);
        for binding in block.bindings.iter().rev() {
            let decides = self.deciding.contains(&*binding.name.text);
            self.expr(&binding.value, inert && !decides);
        }
    }

    fn expr(&mut self, expr: &Expr, inert: bool) {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Color(_) | ExprKind::Bool(_) | ExprKind::Error => {}
            ExprKind::Name(name) => {
                if !inert {
                    self.deciding.insert(name.clone());
                }
            }
            ExprKind::Tuple(items) | ExprKind::List(items) => items.iter().for_each(|e| self.expr(e, inert)),
            ExprKind::Record(record) | ExprKind::Material(record) => {
                record.fields.iter().for_each(|f| self.expr(&f.value, inert));
            }
            ExprKind::Block(block) | ExprKind::Shape(_, block) => self.block(block, inert),
            ExprKind::If { condition, then, otherwise } => {
                self.block(then, inert);
                self.block(otherwise, inert);
                self.expr(condition, false);
            }
            ExprKind::For { list, body, .. } => {
                self.block(body, inert);
                self.expr(list, false);
            }
            ExprKind::Lambda(lambda) => self.expr(&lambda.body, inert),
            ExprKind::Unary(_, operand) => self.expr(operand, inert),
            ExprKind::Chain { first, rest } => {
                let inert = inert
                    && !rest
                        .iter()
                        .any(|(op, ..)| matches!(op, BinaryOp::Range | BinaryOp::And | BinaryOp::Or));
                self.expr(first, inert);
                rest.iter().for_each(|(_, _, e)| self.expr(e, inert));
            }
            ExprKind::Postfix { base, operations } => self.postfix(base, operations, inert),
        }
    }

    fn postfix(&mut self, base: &Expr, operations: &[Postfix], inert: bool) {
        let mut base_is_inert = inert;
        for (i, operation) in operations.iter().enumerate() {
            match &operation.kind {
                PostfixKind::Call(arguments) => match &base.kind {
                    ExprKind::Name(name) if i == 0 => self.arguments(name, 0, arguments, inert),
                    _ => {
                        base_is_inert = false;
                        arguments.iter().for_each(|a| self.expr(&a.value, false));
                    }
                },
                PostfixKind::Method(name, arguments) => {
                    base_is_inert &= self.is_inert_argument(&name.text, 0, None);
                    self.arguments(&name.text, 1, arguments, inert);
                }
                PostfixKind::Index(index) => {
                    self.expr(index, false);
                    base_is_inert = false;
                }
                PostfixKind::Member(_) => {}
            }
        }
        let is_function = matches!((&base.kind, operations.first().map(|o| &o.kind)),
            (ExprKind::Name(name), Some(PostfixKind::Call(_))) if self.is_function(name));
        if !is_function {
            let is_called = matches!(operations.first().map(|o| &o.kind), Some(PostfixKind::Call(_)));
            self.expr(base, base_is_inert && !is_called);
        }
    }

    fn arguments(&mut self, function: &str, skipped: usize, arguments: &[Argument], inert: bool) {
        for (i, argument) in arguments.iter().enumerate() {
            let name = argument.name.as_ref().map(|name| &*name.text);
            let is_inert = inert && self.is_inert_argument(function, i + skipped, name);
            self.expr(&argument.value, is_inert);
        }
    }

    fn is_function(&self, name: &str) -> bool {
        self.written(name).next().is_some() || self.names.is_of_library(name)
    }

    /// The functions of a name in all of the user's files: which of them is meant is not asked here.
    fn written(&self, name: &str) -> impl Iterator<Item = &Function> {
        self.names.user_modules().filter_map(move |(_, items)| items.functions.get(name)).flatten().copied()
    }

    /// Whether an argument decides nothing in all functions of a name. In the library nothing expands, but for
    /// the rounds of `iterate`.
    fn is_inert_argument(&self, function: &str, index: usize, name: Option<&str>) -> bool {
        match self.written(function).next() {
            Some(_) => self.written(function).all(|f| {
                let place = match name {
                    Some(name) => f.parameters.iter().position(|p| &*p.name.text == name),
                    None => Some(index),
                };
                // Positional arguments may be the components of vectors: then any parameter may be meant.
                let flags = self.inert.of_function(f);
                let has_vectors = name.is_none() && f.parameters.iter().any(|p| p.ty.is_some());
                match place {
                    Some(i) if !has_vectors => flags.get(i).copied().unwrap_or(false),
                    _ => flags.iter().all(|inert| *inert),
                }
            }),
            None => self.is_function(function) && !(function == "iterate" && index == 0),
        }
    }
}
