//! The items of the files, by name, and the check that every name means something.

use crate::builtin;
use crate::contract::Contract;
use crate::errors;
use crate::import::Files;
use crate::library::{Library, Shelf};
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

/// The items of one file of the user's.
#[derive(Debug, Default)]
pub(crate) struct Items<'t> {
    pub functions: HashMap<Arc<str>, Vec<&'t Function>>,
    pub values: HashMap<Arc<str>, Item<'t>>,
    /// The same in the order of the source, for a check of each.
    pub order: Vec<(&'t Name, Item<'t>)>,
    pub lights: Vec<(&'t Name, &'t Record)>,
    pub settings: Vec<(SettingsKind, &'t Record, Span)>,
    pub scenes: Vec<(&'t Scene, Span)>,
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

/// The items of the user's files by name; those of the compiler's own files are on shelves.
pub(crate) struct Names<'t> {
    /// The library and the renderer.
    pub library: &'static Library,
    /// The root file.
    pub user: Items<'t>,
    /// The files that are imported, by their numbers less 1.
    imported: Vec<Items<'t>>,
    /// The names that params have outside their files, by module and name.
    params: HashMap<(Module, Arc<str>), Arc<str>>,
}

impl<'t> Names<'t> {
    /// Collects the items of the user's files.
    pub fn new(
        root: &'t File,
        files: &'t Files,
        library: &'static Library,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Names<'t> {
        let module = |place: &usize| Module::User(*place as u16 + 1);
        let mut user = collect(root, diagnostics);
        user.imports = files.of_root.places.iter().map(module).collect();
        user.incomplete = files.of_root.failed;
        let mut imported = Vec::new();
        for file in &files.imported {
            let mut items = collect(&file.tree, diagnostics);
            items.imports = file.imports.places.iter().map(module).collect();
            items.incomplete = file.imports.failed;
            imported.push(items);
        }
        let mut names = Names { library, user, imported, params: HashMap::new() };
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

    /// The items of a file of the user's.
    fn file(&self, module: Module) -> Option<&Items<'t>> {
        match module {
            Module::Library | Module::Runtime => None,
            Module::ROOT => Some(&self.user),
            Module::User(number) => Some(&self.imported[usize::from(number) - 1]),
        }
    }

    /// The files whose items a module sees, as far as its own do not hide them.
    fn imports(&self, module: Module) -> impl Iterator<Item = (Module, &Items<'t>)> {
        let imports = self.file(module).into_iter().flat_map(|items| &items.imports);
        imports.filter_map(|from| Some((*from, self.file(*from)?)))
    }

    /// Whether a file that the module imports could not be read, so that a name that means nothing may come from there.
    pub fn is_incomplete(&self, module: Module) -> bool {
        self.file(module).is_some_and(|items| items.incomplete)
    }

    /// The functions that a module itself defines under a name; the library's own are found behind all others.
    fn own_functions(&self, name: &str, module: Module) -> Vec<&'t Function> {
        match module {
            Module::Library => Vec::new(),
            Module::Runtime => self.library.runtime.functions(name).collect(),
            Module::User(_) => {
                self.file(module).and_then(|items| items.functions.get(name)).cloned().unwrap_or_default()
            }
        }
    }

    /// Whether a module itself defines a function of this name.
    fn has_own_function(&self, name: &str, module: Module) -> bool {
        match self.file(module) {
            Some(items) => items.functions.contains_key(name),
            None => !self.own_functions(name, module).is_empty(),
        }
    }

    /// The value that a module itself defines under a name; the compiler's own files define functions alone.
    fn own_value(&self, name: &str, module: Module) -> Option<Item<'t>> {
        self.file(module)?.values.get(name).copied()
    }

    /// What a function promises and requires, if anything.
    pub fn contract_of(&self, function: &Function, module: Module) -> Option<&Contract<'t>> {
        match self.shelf(module) {
            Some(shelf) => shelf.contract_of(function),
            None => self.file(module)?.contracts.get(&std::ptr::from_ref(function).cast()),
        }
    }

    /// The same of a `let`, with the file that it stands in.
    pub fn contract_of_let(&self, binding: &Binding) -> Option<(Module, &Contract<'t>)> {
        let place = std::ptr::from_ref(binding).cast();
        self.user_modules().find_map(|(module, items)| Some((module, items.contracts.get(&place)?)))
    }

    /// The first sentence of what is said of a function. What a user wrote never reaches an output, so only the
    /// compiler's own files are quoted.
    pub fn summary_of(&self, function: &Function, module: Module) -> Option<Arc<str>> {
        self.shelf(module)?.summary_of(function)
    }

    /// What a name means: what the module itself defines, else what it imports, else what the library has.
    pub fn meaning(&self, name: &str, module: Module) -> Meaning<'t> {
        if let Some(item) = self.own_value(name, module) {
            return Meaning::Value(module, item);
        }
        match self.imported_meaning(name, module) {
            Meaning::Nothing => {}
            meaning if !self.has_own_function(name, module) => return meaning,
            _ => {}
        }
        match self.functions(name, module) {
            Err(clash) => Meaning::Clash(clash),
            Ok(functions) if !functions.is_empty() => Meaning::Functions(functions),
            Ok(_) => Meaning::Nothing,
        }
    }

    /// Whether a name means a value that the module defines or imports.
    pub fn is_value(&self, name: &str, module: Module) -> bool {
        self.own_value(name, module).is_some()
            || !self.has_own_function(name, module)
                && matches!(self.imported_meaning(name, module), Meaning::Value(..))
    }

    /// What the files that a module imports define under a name, each for itself; what they import is not seen.
    /// Functions of several files are overloads of one another as they would be in one file.
    fn imported_meaning(&self, name: &str, module: Module) -> Meaning<'t> {
        let mut value: Option<(Module, Item<'t>)> = None;
        let mut functions: Vec<(Module, &'t Function)> = Vec::new();
        for (from, items) in self.imports(module) {
            let before = value.map(|(_, item)| item.span()).or(functions.first().map(|(_, f)| f.name.span));
            if let Some(item) = items.values.get(name) {
                if let Some(before) = before {
                    return Meaning::Clash(Clash(before, item.span()));
                }
                value = Some((from, *item));
            }
            for function in items.functions.get(name).into_iter().flatten() {
                let same = functions.iter().find(|(_, f)| same_parameters(f, function));
                let other = value.map(|(_, item)| item.span()).or(same.map(|(_, f)| f.name.span));
                if let Some(other) = other {
                    return Meaning::Clash(Clash(other, function.name.span));
                }
                functions.push((from, function));
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
            let own = self.own_functions(name, module);
            if !own.is_empty() {
                return Ok(own.into_iter().map(|f| Candidate::Written(f, module)).collect());
            }
            match self.imported_meaning(name, module) {
                Meaning::Functions(functions) => return Ok(functions),
                Meaning::Clash(clash) => return Err(clash),
                Meaning::Value(..) | Meaning::Nothing => {}
            }
        }
        Ok(self.library_functions(name, module))
    }

    /// Whether the library, or the compiler, has a function of this name that every file can use.
    pub fn is_of_library(&self, name: &str) -> bool {
        self.library.std.is_public(name) || builtin::all().iter().any(|b| b.name == name)
    }

    /// What `name` is said to be where nothing has it.
    pub fn unknown(&self, name: &str, span: Span, module: Module, locals: &[Arc<str>]) -> Diagnostic {
        if matches!(name, "p" | "n") {
            return errors::no_point(span, name);
        }
        let files = self.imports(module).map(|(_, items)| items).chain(self.file(module));
        let mut all: Vec<&str> = files.flat_map(|items| items.values.keys()).map(|k| &**k).collect();
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
        let mut all: Vec<&str> = self.function_names(module).collect();
        all.sort_unstable();
        self.unknown_name(name, span, all)
    }

    /// The shelf that a module is, unless it is a file of the user's.
    fn shelf(&self, module: Module) -> Option<&'static Shelf> {
        match module {
            Module::Library => Some(&self.library.std),
            Module::Runtime => Some(&self.library.runtime),
            Module::User(_) => None,
        }
    }

    /// The functions of a name that the library and the compiler have. What the library has for its own use, users'
    /// files do not see.
    fn library_functions(&self, name: &str, module: Module) -> Vec<Candidate<'t>> {
        let std = &self.library.std;
        let is_seen = !module.is_user() || std.is_public(name);
        let written = is_seen.then(|| std.functions(name)).into_iter().flatten();
        let built_in = builtin::all().iter().filter(|b| b.name == name);
        written
            .map(|f| Candidate::Written(f, Module::Library))
            .chain(built_in.map(Candidate::BuiltIn))
            .collect()
    }

    fn function_names(&self, module: Module) -> impl Iterator<Item = &str> {
        let files = self.imports(module).map(|(_, items)| items).chain(self.file(module));
        let written = files.flat_map(|items| items.functions.keys()).map(|k| &**k);
        let ours = self.library.std.public_names().chain(builtin::all().iter().map(|b| b.name));
        written.chain(ours.map(|name| -> &str { name }))
    }
}

/// The names that the renderer's uniforms and constants have, which no param can have outside its file.
const TAKEN: [&str; 9] = [
    "time",
    "mouse",
    "orbit",
    "resolution",
    "tolerance",
    "far",
    "steps",
    "shadow_accuracy",
    "occlusion_samples",
];

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

fn collect<'t>(file: &'t File, diagnostics: &mut Vec<Diagnostic>) -> Items<'t> {
    let mut items = Items::default();
    let mut first: HashMap<Arc<str>, (Span, bool)> = HashMap::new();
    let mut lights: HashMap<Arc<str>, Span> = HashMap::new();
    for item in &file.items {
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

/// Whether two functions of a name could not be told apart where they are called.
pub(crate) fn same_parameters(a: &Function, b: &Function) -> bool {
    let kinds =
        |f: &Function| f.parameters.iter().map(|p| (p.ty.map(|t| t.kind), p.variadic)).collect::<Vec<_>>();
    kinds(a) == kinds(b)
}
