//! The check that every name means something, called or not, and of what can be seen without evaluating anything.

use crate::builtin;
use crate::contract::{self, Contract};
use crate::errors;
use crate::names::{Item, Items, Meaning, Names};
use crate::shading::{CALLS, is_shading};
use crate::value::{Candidate, Module};
use rustc_hash::FxHashMap;
use sdf_syntax::token::UNITS;
use sdf_syntax::tree::{
    Argument, Binding, Block, Expr, ExprKind, Function, Name, Parameter, PostfixKind, Record, UnaryOp,
};
use sdf_syntax::{Diagnostic, Sources, Span};
use std::collections::HashMap;
use std::sync::Arc;

impl<'t> Names<'t> {
    /// Checks every name in the functions and scene of the user's files, called or not.
    pub fn check(&self, sources: &Sources, diagnostics: &mut Vec<Diagnostic>) {
        for (module, items) in self.user_modules() {
            self.check_module(module, items, sources, diagnostics);
        }
    }

    /// What a function may call that others may not: the scene's own shading asks for light.
    fn names_in(&self, function: &Function, module: Module) -> Vec<&'t str> {
        if !is_shading(function, module) {
            return Vec::new();
        }
        self.user.lights.iter().map(|(name, _)| &*name.text).chain(CALLS).collect()
    }

    fn check_module(
        &self,
        module: Module,
        items: &Items<'t>,
        sources: &Sources,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let mut check = Check { names: self, sources, module, locals: Locals::default(), diagnostics };
        for function in &items.all_functions {
            let contract = items.contracts.get(&std::ptr::from_ref(*function).cast());
            check.with_point(&self.names_in(function, module), |check| {
                check.with_parameters(&function.parameters, |c| {
                    c.contract(contract);
                    c.expr(&function.body);
                });
            });
        }
        for (_, item) in &items.order {
            match item {
                Item::Let(binding) => {
                    check.contract(items.contracts.get(&std::ptr::from_ref(*binding).cast()));
                    check.expr(&binding.value);
                }
                Item::Material(_, record) => check.with_point(&["p", "n"], |c| c.record(record)),
                Item::Param { default, range, .. } => {
                    check.expr(default);
                    for (low, high) in range.iter() {
                        check.expr(low);
                        check.expr(high);
                    }
                }
            }
        }
        // The scene of an imported file is ignored.
        for (scene, _) in items.scenes.iter().filter(|_| module == Module::ROOT) {
            check.bindings(&scene.bindings, |c| scene.shapes.iter().for_each(|s| c.expr(s)));
        }
    }
}

/// The variables round an expression, the innermost last.
#[derive(Default)]
struct Locals {
    names: Vec<Arc<str>>,
    /// How many variables have each name.
    counts: FxHashMap<Arc<str>, usize>,
}

impl Locals {
    fn contains(&self, name: &str) -> bool {
        self.counts.get(name).is_some_and(|count| *count > 0)
    }

    fn push(&mut self, name: Arc<str>) {
        *self.counts.entry(name.clone()).or_default() += 1;
        self.names.push(name);
    }

    fn truncate(&mut self, len: usize) {
        for name in self.names.drain(len..) {
            self.counts.entry(name).and_modify(|count| *count -= 1);
        }
    }
}

/// The walk that looks for names that mean nothing.
struct Check<'a, 't> {
    names: &'a Names<'t>,
    sources: &'a Sources,
    module: Module,
    locals: Locals,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl Check<'_, '_> {
    fn name(&mut self, name: &str, span: Span) {
        if self.locals.contains(name) {
            return;
        }
        match self.names.meaning(name, self.module) {
            Meaning::Clash(clash) => self.diagnostics.push(clash.diagnostic(name, span)),
            Meaning::Nothing
                if !builtin::CONSTANTS.contains(&name) && !self.names.is_incomplete(self.module) =>
            {
                self.diagnostics.push(self.names.unknown(name, span, self.module, &self.locals.names));
            }
            _ => {}
        }
    }

    fn with_parameters(&mut self, parameters: &[Parameter], f: impl FnOnce(&mut Self)) {
        let before = self.locals.names.len();
        self.distinct(parameters.iter().map(|parameter| &parameter.name));
        for parameter in parameters {
            if let Some(default) = &parameter.default {
                self.expr(default);
            }
            self.locals.push(parameter.name.text.clone());
        }
        f(self);
        self.locals.truncate(before);
    }

    fn with_point(&mut self, names: &[&str], f: impl FnOnce(&mut Self)) {
        let before = self.locals.names.len();
        names.iter().for_each(|n| self.locals.push(Arc::from(*n)));
        f(self);
        self.locals.truncate(before);
    }

    fn contract(&mut self, contract: Option<&Contract>) {
        let Some(contract) = contract else { return };
        let (promises, requirements) = contract.expressions();
        requirements.into_iter().for_each(|e| self.expr(e));
        self.with_point(&contract::VARIABLES, |c| promises.into_iter().for_each(|e| c.expr(e)));
    }

    fn bindings(&mut self, bindings: &[Binding], f: impl FnOnce(&mut Self)) {
        let before = self.locals.names.len();
        for binding in bindings {
            self.expr(&binding.value);
            self.locals.push(binding.name.text.clone());
        }
        f(self);
        self.locals.truncate(before);
    }

    fn block(&mut self, block: &Block) {
        self.bindings(&block.bindings, |c| c.expr(&block.result));
    }

    /// Reports names that stand twice where each can stand once.
    fn distinct<'n>(&mut self, names: impl IntoIterator<Item = &'n Name>) {
        let mut first: HashMap<&str, Span> = HashMap::new();
        for name in names {
            if let Some(span) = first.insert(&name.text, name.span) {
                self.diagnostics.push(errors::defined_twice(name, span));
            }
        }
    }

    fn record(&mut self, record: &Record) {
        record.fields.iter().for_each(|f| self.expr(&f.value));
    }

    /// Warns of what looks like degrees where a function of the library takes an angle: a number of more than a
    /// turn, without a unit. `before` is how many arguments stand before those in the parentheses.
    fn angles(&mut self, function: &str, before: usize, arguments: &[Argument]) {
        if self.locals.contains(function) {
            return;
        }
        let Meaning::Functions(candidates) = self.names.meaning(function, self.module) else { return };
        for (i, argument) in arguments.iter().enumerate() {
            let Some(number) = self.number_without_unit(&argument.value) else { continue };
            let is_angle = |candidate: &Candidate<'_>| match candidate {
                Candidate::Written(f, Module::Library) => {
                    let positional = arguments.iter().filter(|a| a.name.is_none()).count();
                    let place = before + i;
                    // A vector that is given as a row of its components moves what follows it.
                    let spread = (before + positional).saturating_sub(f.parameters.len());
                    let by_place = [place, place.saturating_sub(spread)].map(|at| f.parameters.get(at));
                    let by_place = by_place.into_iter().flatten().any(|p| &*p.name.text == "angle");
                    argument.name.as_ref().map_or(by_place, |name| &*name.text == "angle")
                }
                _ => false,
            };
            if number.abs() > std::f64::consts::TAU * 1.01 && candidates.iter().any(is_angle) {
                self.diagnostics.push(errors::degrees(argument.value.span, number));
            }
        }
    }

    /// The number that an expression writes down without a unit.
    fn number_without_unit(&self, expr: &Expr) -> Option<f64> {
        match &expr.kind {
            ExprKind::Unary(UnaryOp::Negate, operand) => self.number_without_unit(operand).map(|x| -x),
            ExprKind::Number(x) => {
                let text = &self.sources.get(expr.span.file)?.text;
                let written = text.get(expr.span.start as usize..expr.span.end as usize)?;
                let has_unit = UNITS.iter().any(|unit| written.contains(unit));
                (!has_unit).then_some(*x)
            }
            _ => None,
        }
    }

    fn arguments(&mut self, arguments: &[Argument]) {
        arguments.iter().for_each(|a| self.expr(&a.value));
    }

    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Color(_) | ExprKind::Bool(_) | ExprKind::Error => {}
            ExprKind::Name(name) => self.name(name, expr.span),
            ExprKind::Tuple(items) | ExprKind::List(items) => items.iter().for_each(|e| self.expr(e)),
            ExprKind::Record(record) => {
                self.distinct(record.fields.iter().map(|field| &field.name));
                self.record(record);
            }
            ExprKind::Material(record) => self.with_point(&["p", "n"], |c| c.record(record)),
            ExprKind::Block(block) => self.block(block),
            ExprKind::Shape(_, block) => self.with_point(&["p"], |c| c.block(block)),
            ExprKind::If { condition, then, otherwise } => {
                self.expr(condition);
                self.block(then);
                self.block(otherwise);
            }
            ExprKind::For { name, list, body } => {
                self.expr(list);
                self.with_point(&[&name.text], |c| c.block(body));
            }
            ExprKind::Lambda(lambda) => self.with_parameters(&lambda.parameters, |c| c.expr(&lambda.body)),
            ExprKind::Unary(_, a) => self.expr(a),
            ExprKind::Chain { first, rest } => {
                self.expr(first);
                rest.iter().for_each(|(_, _, e)| self.expr(e));
            }
            ExprKind::Postfix { base, operations } => {
                self.expr(base);
                if let (ExprKind::Name(name), Some(PostfixKind::Call(arguments))) =
                    (&base.kind, operations.first().map(|o| &o.kind))
                {
                    self.angles(name, 0, arguments);
                }
                for operation in operations {
                    match &operation.kind {
                        PostfixKind::Call(arguments) => self.arguments(arguments),
                        PostfixKind::Method(name, arguments) => {
                            self.angles(&name.text, 1, arguments);
                            self.arguments(arguments);
                        }
                        PostfixKind::Index(index) => self.expr(index),
                        PostfixKind::Member(_) => {}
                    }
                }
            }
        }
    }
}
