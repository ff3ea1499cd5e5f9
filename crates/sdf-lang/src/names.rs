//! The items of the files, by name, and the check that every name means something.

use crate::builtin;
use crate::contract::{self, Contract};
use crate::errors;
use crate::value::{Candidate, Module};
use rustc_hash::FxHashMap;
use sdf_syntax::tree::{
    Argument, Binding, Block, Expr, ExprKind, File, Function, ItemKind, Name, Parameter, PostfixKind, Record,
    Scene, SettingsKind,
};
use sdf_syntax::{Diagnostic, Span, did_you_mean};
use std::collections::HashMap;
use std::sync::Arc;

/// An item that a name means.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Item<'t> {
    Let(&'t Binding),
    Param { name: &'t Name, default: &'t Expr, range: Option<&'t (Expr, Expr)> },
    Material(&'t Name, &'t Record),
}

/// The items of one module.
#[derive(Debug, Default)]
pub(crate) struct Items<'t> {
    pub functions: HashMap<Arc<str>, Vec<&'t Function>>,
    pub values: HashMap<Arc<str>, Item<'t>>,
    /// The same in the order of the source, for a check of each.
    pub order: Vec<(&'t Name, Item<'t>)>,
    pub lights: Vec<(&'t Name, &'t Record)>,
    pub settings: Vec<(SettingsKind, &'t Record, Span)>,
    pub scenes: Vec<(&'t Scene, Span)>,
    /// The first sentence of what is said of each function, by its place in memory.
    pub docs: HashMap<*const (), Arc<str>>,
    /// What items promise and require, by their places in memory.
    pub contracts: HashMap<*const (), Contract<'t>>,
    all_functions: Vec<&'t Function>,
}

/// The items of all modules.
pub(crate) struct Names<'t> {
    pub user: Items<'t>,
    pub library: Items<'t>,
    pub runtime: Items<'t>,
}

impl<'t> Names<'t> {
    /// Collects the items of the user's file, the library and the renderer.
    pub fn new(
        user: &'t File,
        library: &[&'t File],
        runtime: &[&'t File],
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Names<'t> {
        Names {
            user: collect(&[user], Module::User, diagnostics),
            library: collect(library, Module::Library, diagnostics),
            runtime: collect(runtime, Module::Runtime, diagnostics),
        }
    }

    pub fn module(&self, module: Module) -> &Items<'t> {
        match module {
            Module::Library => &self.library,
            Module::Runtime => &self.runtime,
            Module::User => &self.user,
        }
    }

    /// All functions of a name: the module's own, else the library's and the built-in ones together.
    pub fn functions(&self, name: &str, module: Module) -> Vec<Candidate<'t>> {
        let own = self.module(module);
        if module != Module::Library {
            if let Some(list) = own.functions.get(name) {
                return list.iter().map(|f| Candidate::Written(f, module)).collect();
            }
            if own.values.contains_key(name) {
                return Vec::new();
            }
        }
        let written = self.library.functions.get(name).into_iter().flatten();
        let built_in = builtin::all().iter().filter(|b| b.name == name);
        written
            .map(|f| Candidate::Written(f, Module::Library))
            .chain(built_in.map(Candidate::BuiltIn))
            .collect()
    }

    /// What `name` is said to be where nothing has it.
    pub fn unknown(&self, name: &str, span: Span, module: Module, locals: &[Arc<str>]) -> Diagnostic {
        if matches!(name, "p" | "n") {
            return errors::no_point(span, name);
        }
        if UNBUILT.contains(&name) {
            return errors::not_built_yet(
                span,
                &format!("`{name}`"),
                "it is part of the language; use another for now",
            );
        }
        let own = self.module(module);
        let mut all: Vec<&str> = own.values.keys().map(|k| &**k).collect();
        all.extend(locals.iter().map(|l| &**l));
        all.extend(builtin::CONSTANTS);
        all.extend(self.function_names(module));
        all.sort_unstable();
        errors::unknown_name(span, name, sdf_syntax::foreign_name(name), did_you_mean(name, all))
    }

    /// What is said of a function that is not there.
    pub fn unknown_function(&self, name: &str, span: Span, module: Module) -> Diagnostic {
        if UNBUILT.contains(&name) {
            return errors::not_built_yet(
                span,
                &format!("`{name}`"),
                "it is part of the language; use another for now",
            );
        }
        let mut all: Vec<&str> = self.function_names(module).collect();
        all.sort_unstable();
        errors::unknown_name(span, name, sdf_syntax::foreign_name(name), did_you_mean(name, all))
    }

    fn function_names(&self, module: Module) -> impl Iterator<Item = &str> {
        let own = self.module(module).functions.keys();
        let library = self.library.functions.keys();
        own.chain(library).map(|k| &**k).chain(builtin::all().iter().map(|b| b.name))
    }

    fn means_something(&self, name: &str, module: Module) -> bool {
        self.module(module).values.contains_key(name)
            || self.module(module).functions.contains_key(name)
            || self.library.functions.contains_key(name)
            || builtin::CONSTANTS.contains(&name)
            || builtin::all().iter().any(|b| b.name == name)
    }

    /// Checks every name in the functions and scene of the user's file, called or not.
    pub fn check(&self, diagnostics: &mut Vec<Diagnostic>) {
        let mut check = Check { names: self, module: Module::User, locals: Locals::default(), diagnostics };
        for function in &self.user.all_functions {
            let contract = self.user.contracts.get(&std::ptr::from_ref(*function).cast());
            check.with_parameters(&function.parameters, |c| {
                c.contract(contract);
                c.expr(&function.body);
            });
        }
        for (_, item) in &self.user.order {
            match item {
                Item::Let(binding) => {
                    check.contract(self.user.contracts.get(&std::ptr::from_ref(*binding).cast()));
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
        for (scene, _) in &self.user.scenes {
            check.bindings(&scene.bindings, |c| scene.shapes.iter().for_each(|s| c.expr(s)));
        }
    }
}

fn collect<'t>(files: &[&'t File], module: Module, diagnostics: &mut Vec<Diagnostic>) -> Items<'t> {
    let mut items = Items::default();
    let mut first: HashMap<Arc<str>, (Span, bool)> = HashMap::new();
    let mut lights: HashMap<Arc<str>, Span> = HashMap::new();
    for item in files.iter().flat_map(|f| &f.items) {
        let place: Option<*const ()> = match &item.kind {
            ItemKind::Fn(function) => Some(std::ptr::from_ref(&**function).cast()),
            ItemKind::Let(binding) => Some(std::ptr::from_ref(binding).cast()),
            _ => None,
        };
        let contract = Contract::of(&item.attributes, place.is_some(), diagnostics);
        if let Some(place) = place
            && !contract.is_empty()
        {
            items.contracts.insert(place, contract);
        }
        // What a user wrote never reaches an output, so only the compiler's own files are quoted.
        if let (Some(place), false, false) = (place, module == Module::User, item.docs.is_empty()) {
            items.docs.insert(place, first_sentence(&item.docs));
        }
        match &item.kind {
            ItemKind::Import { .. } => {
                diagnostics.push(errors::not_built_yet(
                    item.span,
                    "`import`",
                    "put everything into one file for now",
                ));
            }
            ItemKind::Fn(function) => {
                if let Some((span, is_function)) = first.get(&function.name.text)
                    && !is_function
                {
                    diagnostics.push(errors::defined_twice(&function.name, *span));
                    continue;
                }
                first.entry(function.name.text.clone()).or_insert((function.name.span, true));
                let same = items.functions.entry(function.name.text.clone()).or_default();
                if let Some(other) = same.iter().find(|f| same_parameters(f, function)) {
                    diagnostics.push(errors::defined_twice(&function.name, other.name.span));
                    continue;
                }
                same.push(function);
                items.all_functions.push(function);
            }
            ItemKind::Let(binding) => {
                add_value(&mut items, &mut first, &binding.name, Item::Let(binding), diagnostics);
            }
            ItemKind::Param { name, default, range } => {
                let item = Item::Param { name, default, range: range.as_ref() };
                add_value(&mut items, &mut first, name, item, diagnostics);
            }
            ItemKind::Material(name, record) => {
                add_value(&mut items, &mut first, name, Item::Material(name, record), diagnostics);
            }
            ItemKind::Light(name, record) => {
                if let Some(span) = lights.insert(name.text.clone(), name.span) {
                    diagnostics.push(errors::defined_twice(name, span));
                }
                items.lights.push((name, record));
            }
            ItemKind::Settings(kind, record) => items.settings.push((*kind, record, item.span)),
            ItemKind::Scene(scene) => items.scenes.push((scene, item.span)),
        }
    }
    items
}

/// The names of the language's library that are not there yet.
const UNBUILT: &[&str] = &[
    "box_frame",
    "capped_torus",
    "link",
    "infinite_cylinder",
    "segment_cylinder",
    "round_cylinder",
    "capped_cone",
    "infinite_cone",
    "round_cone",
    "solid_angle",
    "cut_sphere",
    "hollow_sphere",
    "hex_prism",
    "tri_prism",
    "pyramid",
    "tetrahedron",
    "dodecahedron",
    "icosahedron",
    "rhombus_prism",
    "triangle3",
    "quad",
    "tube",
    "helix",
    "gyroid",
    "heightfield",
    "menger",
    "mandelbulb",
    "round_rect",
    "segment",
    "ellipse",
    "triangle",
    "ngon",
    "star",
    "rhombus",
    "trapezoid",
    "parallelogram",
    "pie",
    "arc",
    "ring",
    "vesica",
    "moon",
    "heart",
    "egg",
    "cross2",
    "bezier",
    "half_plane",
    "extrude_round",
    "slice",
    "chamfer",
    "stairs",
    "pipe",
    "groove",
    "tongue",
    "engrave",
    "morph",
    "orient",
    "flip",
    "repeat_each",
    "repeat_polar",
    "bend",
    "taper",
    "shear",
    "warp",
    "palette",
    "hsv",
    "fbm",
    "voronoi",
];

/// The first sentence of a doc comment, on one line.
fn first_sentence(docs: &str) -> Arc<str> {
    let line = docs.split_whitespace().collect::<Vec<_>>().join(" ");
    let end = line.find(". ").map_or(line.len(), |i| i + 1);
    Arc::from(&line[..end])
}

fn add_value<'t>(
    items: &mut Items<'t>,
    first: &mut HashMap<Arc<str>, (Span, bool)>,
    name: &'t Name,
    item: Item<'t>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    if let Some((span, _)) = first.get(&name.text) {
        diagnostics.push(errors::defined_twice(name, *span));
        return;
    }
    first.insert(name.text.clone(), (name.span, false));
    items.values.insert(name.text.clone(), item);
    items.order.push((name, item));
}

fn same_parameters(a: &Function, b: &Function) -> bool {
    let kinds =
        |f: &Function| f.parameters.iter().map(|p| (p.ty.map(|t| t.kind), p.variadic)).collect::<Vec<_>>();
    kinds(a) == kinds(b)
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
    module: Module,
    locals: Locals,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl Check<'_, '_> {
    fn name(&mut self, name: &str, span: Span) {
        if !self.locals.contains(name) && !self.names.means_something(name, self.module) {
            self.diagnostics.push(self.names.unknown(name, span, self.module, &self.locals.names));
        }
    }

    fn with_parameters(&mut self, parameters: &[Parameter], f: impl FnOnce(&mut Self)) {
        let before = self.locals.names.len();
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
        names.iter().for_each(|name| self.locals.push(Arc::from(*name)));
        f(self);
        self.locals.truncate(before);
    }

    fn contract(&mut self, contract: Option<&Contract>) {
        let Some(contract) = contract else { return };
        let (promises, requirements) = contract.expressions();
        requirements.into_iter().for_each(|e| self.expr(e));
        self.with_point(contract::variables(self.module), |c| promises.into_iter().for_each(|e| c.expr(e)));
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

    fn record(&mut self, record: &Record) {
        record.fields.iter().for_each(|f| self.expr(&f.value));
    }

    fn arguments(&mut self, arguments: &[Argument]) {
        arguments.iter().for_each(|a| self.expr(&a.value));
    }

    fn expr(&mut self, expr: &Expr) {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Color(_) | ExprKind::Bool(_) | ExprKind::Error => {}
            ExprKind::Name(name) => self.name(name, expr.span),
            ExprKind::Tuple(items) | ExprKind::List(items) => items.iter().for_each(|e| self.expr(e)),
            ExprKind::Record(record) => self.record(record),
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
                for operation in operations {
                    match &operation.kind {
                        PostfixKind::Call(arguments) | PostfixKind::Method(_, arguments) => {
                            self.arguments(arguments)
                        }
                        PostfixKind::Index(index) => self.expr(index),
                        PostfixKind::Member(_) => {}
                    }
                }
            }
        }
    }
}
