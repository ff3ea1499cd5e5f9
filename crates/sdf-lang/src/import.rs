//! Files that import others: `load(root, sources, loader) → Vec<Imported>`, every file once, whichever way it is
//! reached, with what each of them imports.
//!
//! This crate opens no file: a [`Loader`] says what a path means and hands the bytes over.

use crate::errors;
use sdf_syntax::tree::{File, ItemKind};
use sdf_syntax::{Diagnostic, Sources, Span};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Debug;
use std::sync::Arc;

/// How long a chain of imports may be, the root file apart.
pub(crate) const DEPTH_LIMIT: usize = 64;
/// How many files one scene may import.
pub(crate) const FILE_COUNT_LIMIT: usize = 1024;
/// How many bytes the imported files of one scene may have together.
pub(crate) const BYTES_LIMIT: usize = 64 << 20;

/// A file that an import means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// What tells it from all other files, and alone decides whether two are one: a canonical path, for example.
    pub key: String,
    /// What messages call it.
    pub name: String,
}

/// Why an import cannot be followed, as a diagnostic says it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// What is wrong, in lower case and without a full stop.
    pub message: String,
    /// What to do, where that is known.
    pub help: Option<String>,
}

/// Finds and reads the files that scenes import.
pub trait Loader: Debug + Send + Sync {
    /// Where the root file is, unless it is no file that could be imported.
    fn root(&self) -> Option<Location>;

    /// The file that `path` means in an import of the file at `importer`; of the root file, if there is none.
    fn find(&self, path: &str, importer: Option<&Location>) -> Result<Location, Refusal>;

    /// The content of a file that was found.
    fn read(&self, file: &Location) -> Result<Vec<u8>, Refusal>;
}

/// Files that are texts in memory, by their paths, for what has no folder: a test, an editor, a page.
#[derive(Debug, Clone, Default)]
pub struct Texts(pub BTreeMap<String, String>);

impl Loader for Texts {
    fn root(&self) -> Option<Location> {
        None
    }

    fn find(&self, path: &str, importer: Option<&Location>) -> Result<Location, Refusal> {
        let mut parts: Vec<&str> = importer.map_or(Vec::new(), |file| file.key.split('/').collect());
        parts.pop();
        for part in path.split('/') {
            match part {
                "." => {}
                ".." if parts.is_empty() => {
                    return Err(Refusal { message: "it is not in the scene's folder".into(), help: None });
                }
                ".." => drop(parts.pop()),
                name => parts.push(name),
            }
        }
        let key = parts.join("/");
        match self.0.contains_key(&key) {
            true => Ok(Location { name: key.clone(), key }),
            false => Err(Refusal { message: "there is no such file".into(), help: None }),
        }
    }

    fn read(&self, file: &Location) -> Result<Vec<u8>, Refusal> {
        Ok(self.0[&file.key].clone().into_bytes())
    }
}

/// What imports are followed with. The default follows none: each is an error that says so.
#[derive(Debug, Clone, Default)]
pub struct Imports(Option<Arc<dyn Loader>>);

impl Imports {
    /// Imports that a loader follows.
    pub fn from(loader: Arc<dyn Loader>) -> Imports {
        Imports(Some(loader))
    }
}

/// A file that was imported.
#[derive(Debug)]
pub(crate) struct Imported {
    /// Its items.
    pub tree: File,
    /// The name of the file without folders and extension, as a name of the language.
    pub stem: String,
    /// What it imports.
    pub imports: ImportsOf,
}

/// What a file imports.
#[derive(Debug, Default)]
pub(crate) struct ImportsOf {
    /// The places of the files in [`Files::imported`], in the order of the imports, each once.
    pub places: Vec<usize>,
    /// Whether one of them could not be read, which has been said.
    pub failed: bool,
}

/// The files of a scene beside the root.
#[derive(Debug, Default)]
pub(crate) struct Files {
    /// All of them.
    pub imported: Vec<Imported>,
    /// What the root file imports.
    pub of_root: ImportsOf,
}

/// Reads everything that the root file imports, and what those files import.
pub(crate) fn load(
    root: &File,
    sources: &mut Sources,
    imports: &Imports,
    diagnostics: &mut Vec<Diagnostic>,
) -> Files {
    let Imports(loader) = imports;
    let location = loader.as_ref().and_then(|loader| loader.root());
    let name = sources.get(crate::USER_FILE).map_or_else(String::new, |source| source.name.clone());
    let mut walk = Walk {
        loader: loader.as_deref(),
        sources,
        diagnostics,
        files: Vec::new(),
        places: HashMap::new(),
        open: vec![(location.as_ref().map(|l| l.key.clone()), name)],
        bytes: 0,
    };
    let of_root = walk.imports_of(root, location.as_ref());
    let imported =
        walk.files.into_iter().map(|file| file.expect("every file that was begun was read")).collect();
    Files { imported, of_root }
}

struct Walk<'a> {
    loader: Option<&'a dyn Loader>,
    sources: &'a mut Sources,
    diagnostics: &'a mut Vec<Diagnostic>,
    files: Vec<Option<Imported>>,
    /// The files by their keys; what could not be read has no place.
    places: HashMap<String, Option<usize>>,
    /// The files whose imports are being followed, from the root: keys and names.
    open: Vec<(Option<String>, String)>,
    bytes: usize,
}

impl Walk<'_> {
    /// What a file imports.
    fn imports_of(&mut self, tree: &File, importer: Option<&Location>) -> ImportsOf {
        let mut out = ImportsOf::default();
        for item in &tree.items {
            let ItemKind::Import { path, span } = &item.kind else { continue };
            match self.import(path, *span, importer) {
                Ok(Some(place)) if out.places.contains(&place) => {}
                Ok(Some(place)) => out.places.push(place),
                Ok(None) => out.failed = true,
                Err(diagnostic) => {
                    out.failed = true;
                    self.diagnostics.push(*diagnostic);
                }
            }
        }
        out
    }

    /// The place of the file that one import means; none where that file could not be read, which has been said.
    fn import(
        &mut self,
        path: &str,
        span: Span,
        importer: Option<&Location>,
    ) -> Result<Option<usize>, Box<Diagnostic>> {
        let refused = |refusal: Refusal| Box::new(errors::import_refused(span, path, &refusal));
        let loader = self.loader.ok_or_else(|| Box::new(errors::imports_without_files(span)))?;
        let location = loader.find(path, importer).map_err(refused)?;
        if let Some(from) = self.open.iter().position(|(key, _)| key.as_deref() == Some(&location.key)) {
            let names = self.open[from..].iter().chain([&self.open[from]]).map(|(_, name)| name.as_str());
            return Err(Box::new(errors::import_circle(span, &names.collect::<Vec<_>>())));
        }
        if let Some(place) = self.places.get(&location.key) {
            return Ok(*place);
        }
        if self.open.len() > DEPTH_LIMIT {
            return Err(Box::new(errors::imports_too_deep(span)));
        }
        if self.files.len() >= FILE_COUNT_LIMIT {
            return Err(Box::new(errors::too_many_imports(span, &format!("{FILE_COUNT_LIMIT} files"))));
        }
        self.places.insert(location.key.clone(), None);
        let bytes = loader.read(&location).map_err(refused)?;
        self.bytes += bytes.len();
        if self.bytes > BYTES_LIMIT {
            return Err(Box::new(errors::too_many_imports(span, &format!("{BYTES_LIMIT} bytes"))));
        }
        Ok(self.open_file(location, &bytes))
    }

    /// Parses a file and follows its imports.
    fn open_file(&mut self, location: Location, bytes: &[u8]) -> Option<usize> {
        let text = sdf_syntax::decode(self.sources.next(), bytes);
        let file = self.sources.add(&*location.name, text.as_deref().unwrap_or_default());
        let text = match text {
            Ok(text) => text,
            Err(diagnostic) => {
                self.diagnostics.push(diagnostic);
                return None;
            }
        };
        let (tree, found) = sdf_syntax::parse(file, &text);
        self.diagnostics.extend(found);
        let place = self.files.len();
        self.files.push(None);
        self.places.insert(location.key.clone(), Some(place));
        self.open.push((Some(location.key.clone()), location.name.clone()));
        let imports = self.imports_of(&tree, Some(&location));
        self.open.pop();
        self.files[place] = Some(Imported { tree, stem: stem(&location.name), imports });
        Some(place)
    }
}

/// The name of a file without folders and extension, as a name of the language.
fn stem(name: &str) -> String {
    let file = name.rsplit('/').next().unwrap_or_default();
    let stem = file.split('.').find(|part| !part.is_empty()).unwrap_or("file");
    let plain: String = stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.starts_with(|c: char| c.is_ascii_digit()) { format!("_{plain}") } else { plain }
}
