//! The items of the files, by name, and the check that every name means something.

use crate::builtin;
use crate::contract::Contract;
use crate::errors;
use crate::import::Files;
use crate::value::{Candidate, Module};
use sdf_syntax::tree::{Binding, Expr, File, Function, ItemKind, Name, Record, Scene, SettingsKind};
use sdf_syntax::{Diagnostic, Span, did_you_mean};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// An item that a name means.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Item<'t> {
    Let(&'t Binding),
    Param { name: &'t Name, default: &'t Expr, range: Option<&'t (Expr, Expr)> },
    Material(&'t Name, &'t Record),
}

impl Item<'_> {
    /// The place of its name.
    pub fn span(&self) -> Span {
        match self {
            Item::Let(binding) => binding.name.span,
            Item::Param { name, .. } | Item::Material(name, _) => name.span,
        }
    }
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
    /// The files whose items it sees, as far as its own do not hide them. What those import it does not see.
    pub imports: Vec<Module>,
    /// Whether a file that it imports could not be read, so that a name that means nothing may come from there.
    pub incomplete: bool,
    /// All functions, in the order of the source.
    pub all_functions: Vec<&'t Function>,
}

/// What a name means in a module, variables and built-in constants apart.
pub(crate) enum Meaning<'t> {
    Value(Module, Item<'t>),
    Functions(Vec<Candidate<'t>>),
    Clash(Clash),
    Nothing,
}

/// Where two imported files define what could be one another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clash(Span, Span);

impl Clash {
    /// What is said where the name is used.
    pub fn diagnostic(self, name: &str, span: Span) -> Diagnostic {
        errors::import_clash(span, name, self.0, self.1)
    }
}

/// The items of all modules.
pub(crate) struct Names<'t> {
    /// The root file.
    pub user: Items<'t>,
    /// The files that are imported, by their numbers less 1.
    imported: Vec<Items<'t>>,
    /// The names that params have outside their files, by module and name.
    params: HashMap<(Module, Arc<str>), Arc<str>>,
    pub library: Items<'t>,
    pub runtime: Items<'t>,
}

impl<'t> Names<'t> {
    /// Collects the items of the user's files, the library and the renderer.
    pub fn new(
        root: &'t File,
        files: &'t Files,
        library: &[&'t File],
        runtime: &[&'t File],
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Names<'t> {
        let module = |place: &usize| Module::User(*place as u16 + 1);
        let mut user = collect(&[root], Module::ROOT, diagnostics);
        user.imports = files.of_root.places.iter().map(module).collect();
        user.incomplete = files.of_root.failed;
        let mut imported = Vec::new();
        for (place, file) in files.imported.iter().enumerate() {
            let mut items = collect(&[&file.tree], module(&place), diagnostics);
            items.imports = file.imports.places.iter().map(module).collect();
            items.incomplete = file.imports.failed;
            imported.push(items);
        }
        let mut names = Names {
            user,
            imported,
            params: HashMap::new(),
            library: collect(library, Module::Library, diagnostics),
            runtime: collect(runtime, Module::Runtime, diagnostics),
        };
        names.params = param_names(&names, files);
        names
    }

    /// The user's files, the root first.
    pub fn user_modules(&self) -> impl Iterator<Item = (Module, &Items<'t>)> {
        let imported = self.imported.iter().enumerate().map(|(i, items)| (Module::User(i as u16 + 1), items));
        std::iter::once((Module::ROOT, &self.user)).chain(imported)
    }

    /// The name that a param has outside its file.
    pub fn param_name(&self, module: Module, name: &Name) -> Arc<str> {
        self.params.get(&(module, name.text.clone())).unwrap_or(&name.text).clone()
    }

    /// The name by which `--set` knows a param.
    pub fn name_to_set(&self, module: Module, name: &Name) -> Arc<str> {
        if module == Module::ROOT { name.text.clone() } else { self.param_name(module, name) }
    }

    /// The names by which `--set` knows the params, in the order of the files.
    pub fn names_to_set(&self) -> Vec<Arc<str>> {
        let params = self.user_modules().flat_map(|(module, items)| {
            let params = items.order.iter().filter(|(_, item)| matches!(item, Item::Param { .. }));
            params.map(move |(name, _)| self.name_to_set(module, name))
        });
        params.collect()
    }

    pub fn module(&self, module: Module) -> &Items<'t> {
        match module {
            Module::Library => &self.library,
            Module::Runtime => &self.runtime,
            Module::ROOT => &self.user,
            Module::User(number) => &self.imported[usize::from(number) - 1],
        }
    }

    /// What a name means: what the module itself defines, else what it imports, else what the library has.
    pub fn meaning(&self, name: &str, module: Module) -> Meaning<'t> {
        let own = self.module(module);
        if let Some(item) = own.values.get(name) {
            return Meaning::Value(module, *item);
        }
        match self.imported_meaning(name, module) {
            Meaning::Nothing => {}
            meaning if !own.functions.contains_key(name) => return meaning,
            _ => {}
        }
        match self.functions(name, module) {
            Err(clash) => Meaning::Clash(clash),
            Ok(functions) if !functions.is_empty() => Meaning::Functions(functions),
            Ok(_) => match self.library.values.get(name) {
                Some(item) => Meaning::Value(Module::Library, *item),
                None => Meaning::Nothing,
            },
        }
    }

    /// Whether a name means a value that the module defines or imports.
    pub fn is_value(&self, name: &str, module: Module) -> bool {
        let own = self.module(module);
        own.values.contains_key(name)
            || !own.functions.contains_key(name)
                && matches!(self.imported_meaning(name, module), Meaning::Value(..))
    }

    /// What the files that a module imports define under a name, each for itself; what they import is not seen.
    /// Functions of several files are overloads of one another as they would be in one file.
    fn imported_meaning(&self, name: &str, module: Module) -> Meaning<'t> {
        let mut value: Option<(Module, Item<'t>)> = None;
        let mut functions: Vec<(Module, &'t Function)> = Vec::new();
        for from in &self.module(module).imports {
            let items = self.module(*from);
            let before = value.map(|(_, item)| item.span()).or(functions.first().map(|(_, f)| f.name.span));
            if let Some(item) = items.values.get(name) {
                if let Some(before) = before {
                    return Meaning::Clash(Clash(before, item.span()));
                }
                value = Some((*from, *item));
            }
            for function in items.functions.get(name).into_iter().flatten() {
                let same = functions.iter().find(|(_, f)| same_parameters(f, function));
                let other = value.map(|(_, item)| item.span()).or(same.map(|(_, f)| f.name.span));
                if let Some(other) = other {
                    return Meaning::Clash(Clash(other, function.name.span));
                }
                functions.push((*from, function));
            }
        }
        match value {
            Some((from, item)) => Meaning::Value(from, item),
            None if functions.is_empty() => Meaning::Nothing,
            None => Meaning::Functions(
                functions.into_iter().map(|(from, f)| Candidate::Written(f, from)).collect(),
            ),
        }
    }

    /// All functions of a name: the module's own, else the imported ones, else the library's and the built-in
    /// ones together. There are none where a value has the name.
    pub fn functions(&self, name: &str, module: Module) -> Result<Vec<Candidate<'t>>, Clash> {
        if module != Module::Library && self.is_value(name, module) {
            return Ok(Vec::new());
        }
        self.methods(name, module)
    }

    /// The same behind a `.`, where a value that cannot be called hides nothing.
    pub fn methods(&self, name: &str, module: Module) -> Result<Vec<Candidate<'t>>, Clash> {
        if module != Module::Library {
            if let Some(list) = self.module(module).functions.get(name) {
                return Ok(list.iter().map(|f| Candidate::Written(f, module)).collect());
            }
            match self.imported_meaning(name, module) {
                Meaning::Functions(functions) => return Ok(functions),
                Meaning::Clash(clash) => return Err(clash),
                Meaning::Value(..) | Meaning::Nothing => {}
            }
        }
        Ok(self.library_functions(name))
    }

    /// Whether the library, or the compiler, has a function of this name.
    pub fn is_of_library(&self, name: &str) -> bool {
        self.library.functions.contains_key(name) || builtin::all().iter().any(|b| b.name == name)
    }

    fn library_functions(&self, name: &str) -> Vec<Candidate<'t>> {
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
        let imported = own.imports.iter().map(|from| self.module(*from));
        let mut all: Vec<&str> =
            imported.chain([own]).flat_map(|items| items.values.keys()).map(|k| &**k).collect();
        all.extend(locals.iter().map(|l| &**l));
        all.extend(builtin::CONSTANTS);
        all.extend(self.function_names(module));
        all.sort_unstable();
        self.unknown_name(name, span, all)
    }

    /// What is said of a name that is none of `all`.
    fn unknown_name(&self, name: &str, span: Span, all: Vec<&str>) -> Diagnostic {
        let elsewhere = self.user_modules().find_map(|(_, items)| {
            let function = items.functions.get(name).map(|f| f[0].name.span);
            items.values.get(name).map(Item::span).or(function)
        });
        match elsewhere {
            Some(place) => errors::not_imported_here(span, name, place),
            None => errors::unknown_name(span, name, sdf_syntax::foreign_name(name), did_you_mean(name, all)),
        }
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
        self.unknown_name(name, span, all)
    }

    fn function_names(&self, module: Module) -> impl Iterator<Item = &str> {
        let own = self.module(module);
        let imported = own.imports.iter().map(|from| self.module(*from));
        let user = imported.chain([own]).flat_map(|items| items.functions.keys());
        user.chain(self.library.functions.keys()).map(|k| &**k).chain(builtin::all().iter().map(|b| b.name))
    }
}

/// The names that the renderer's uniforms and constants have, which no param can have outside its file.
const TAKEN: [&str; 7] = ["time", "mouse", "orbit", "resolution", "tolerance", "far", "steps"];

/// The names that params have outside their files: their own, or where another has that already, with the name of
/// their file before it.
fn param_names(names: &Names<'_>, files: &Files) -> HashMap<(Module, Arc<str>), Arc<str>> {
    let mut out = HashMap::new();
    let mut taken: HashSet<Arc<str>> = TAKEN.iter().map(|name| Arc::from(*name)).collect();
    for (module, items) in names.user_modules() {
        let stem = match module {
            Module::User(number @ 1..) => files.imported[usize::from(number) - 1].stem.clone(),
            _ => "param".to_string(),
        };
        for (name, _) in items.order.iter().filter(|(_, item)| matches!(item, Item::Param { .. })) {
            let further = (2..).map(|i| format!("{stem}_{}_{i}", name.text));
            let mut tries =
                [name.text.to_string(), format!("{stem}_{}", name.text)].into_iter().chain(further);
            let free = tries.find(|t| !taken.contains(t.as_str())).expect("there is no end of names");
            let outer: Arc<str> = Arc::from(free);
            taken.insert(outer.clone());
            out.insert((module, name.text.clone()), outer);
        }
    }
    out
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
        if let (Some(place), false, false) = (place, module.is_user(), item.docs.is_empty()) {
            items.docs.insert(place, first_sentence(&item.docs));
        }
        match &item.kind {
            // What it brings stands in `Items::imports`.
            ItemKind::Import { .. } => {}
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
