//! The files that are part of the compiler: the standard library and the renderer, both in the language itself.
//!
//! A file is cut into the texts of its items by looking at its lines; an item is parsed when it is first asked for.
//! So it does not matter to a scene how much there is that it does not use.

use crate::contract::Contract;
use crate::reference::{end_of_sentence, one_line};
use rustc_hash::FxHashMap;
use sdf_syntax::tree::{Function, Item, ItemKind};
use sdf_syntax::{FileId, Sources};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// The standard library, in the order of its reference page.
const STD: &[(&str, &str)] = &[
    ("<std/balls.sdf>", include_str!("../std/balls.sdf")),
    ("<std/boxes.sdf>", include_str!("../std/boxes.sdf")),
    ("<std/polyhedra.sdf>", include_str!("../std/polyhedra.sdf")),
    ("<std/turned.sdf>", include_str!("../std/turned.sdf")),
    ("<std/curves.sdf>", include_str!("../std/curves.sdf")),
    ("<std/fractals.sdf>", include_str!("../std/fractals.sdf")),
    ("<std/plane.sdf>", include_str!("../std/plane.sdf")),
    ("<std/between.sdf>", include_str!("../std/between.sdf")),
    ("<std/combine.sdf>", include_str!("../std/combine.sdf")),
    ("<std/operate.sdf>", include_str!("../std/operate.sdf")),
    ("<std/bend.sdf>", include_str!("../std/bend.sdf")),
    ("<std/repeat.sdf>", include_str!("../std/repeat.sdf")),
    ("<std/color.sdf>", include_str!("../std/color.sdf")),
];

/// The renderer: one file an effect.
const RUNTIME: &[(&str, &str)] = &[
    ("<runtime/pixel.sdf>", include_str!("../runtime/pixel.sdf")),
    ("<runtime/camera.sdf>", include_str!("../runtime/camera.sdf")),
    ("<runtime/origin.sdf>", include_str!("../runtime/origin.sdf")),
    ("<runtime/march.sdf>", include_str!("../runtime/march.sdf")),
    ("<runtime/light.sdf>", include_str!("../runtime/light.sdf")),
    ("<runtime/hard_shadow.sdf>", include_str!("../runtime/hard_shadow.sdf")),
    ("<runtime/soft_shadow.sdf>", include_str!("../runtime/soft_shadow.sdf")),
    ("<runtime/occlusion.sdf>", include_str!("../runtime/occlusion.sdf")),
    ("<runtime/glow.sdf>", include_str!("../runtime/glow.sdf")),
    ("<runtime/fog.sdf>", include_str!("../runtime/fog.sdf")),
    ("<runtime/rim.sdf>", include_str!("../runtime/rim.sdf")),
    ("<runtime/tonemap.sdf>", include_str!("../runtime/tonemap.sdf")),
    ("<runtime/path.sdf>", include_str!("../runtime/path.sdf")),
    ("<runtime/reflect.sdf>", include_str!("../runtime/reflect.sdf")),
    ("<runtime/transmit.sdf>", include_str!("../runtime/transmit.sdf")),
    ("<runtime/shade.sdf>", include_str!("../runtime/shade.sdf")),
    ("<runtime/antialias.sdf>", include_str!("../runtime/antialias.sdf")),
    ("<runtime/normals.sdf>", include_str!("../runtime/normals.sdf")),
    ("<runtime/view.sdf>", include_str!("../runtime/view.sdf")),
    ("<runtime/probe.sdf>", include_str!("../runtime/probe.sdf")),
    ("<runtime/query.sdf>", include_str!("../runtime/query.sdf")),
    ("<runtime/certificate.sdf>", include_str!("../runtime/certificate.sdf")),
    (TRUTH, include_str!("../runtime/truth.sdf")),
];

/// The file whose functions stand in for those of the renderer where the truth is asked for, and are not there else.
const TRUTH: &str = "<runtime/truth.sdf>";

/// The files that are part of the compiler.
#[derive(Debug)]
pub(crate) struct Library {
    /// The standard library.
    pub std: Shelf,
    /// The renderer.
    pub runtime: Shelf,
}

impl Library {
    fn of(files: Files, truth: bool) -> Library {
        let (std, runtime) = files.split_at(STD.len());
        let first = 1 + std.len();
        Library { std: Shelf::of(std, 1, truth), runtime: Shelf::of(runtime, first, truth) }
    }

    /// The library as it is, or for finding the `truth`, but for files that others stand in for: their names, as in
    /// `march.sdf`, with their texts. It is never dropped.
    pub fn with(truth: bool, replaced: &[(String, String)]) -> &'static Library {
        static TRUE: OnceLock<Library> = OnceLock::new();
        if replaced.is_empty() {
            return if truth { TRUE.get_or_init(|| Library::of(&all(), true)) } else { library() };
        }
        let mut files = all();
        for (name, text) in replaced {
            let file = files.iter_mut().find(|file| short_name(file.0) == name);
            let file = file.unwrap_or_else(|| panic!("no file of the compiler is called {name}"));
            file.1 = Box::leak(text.clone().into_boxed_str());
        }
        Box::leak(Box::new(Library::of(&files, truth)))
    }

    /// The user's file as file 0, and after it the files of the compiler.
    pub fn sources(&self, name: &str, text: &str) -> Sources {
        let mut sources = Sources::default();
        sources.add(name, text);
        for file in self.std.files.iter().chain(&self.runtime.files) {
            sources.add(file.name, file.text);
        }
        sources
    }
}

/// Files by their names, with their texts.
type Files<'f> = &'f [(&'static str, &'static str)];

/// All files that are part of the compiler.
fn all() -> Vec<(&'static str, &'static str)> {
    STD.iter().chain(RUNTIME).copied().collect()
}

/// The library as it is.
pub(crate) fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(|| Library::of(&all(), false))
}

/// The standard library.
pub(crate) fn std() -> &'static Shelf {
    &library().std
}

/// The texts of the compiler's files by their names without folders, such as `march.sdf`; that which the truth is found with is
/// none of those that pictures are made with.
pub fn compiler_files() -> impl Iterator<Item = (&'static str, &'static str)> {
    let files = STD.iter().chain(RUNTIME).filter(|(name, _)| *name != TRUTH);
    files.map(|(name, text)| (short_name(name), *text))
}

/// Whether a file is part of the compiler.
pub(crate) fn is_ours(file: FileId) -> bool {
    (1..=STD.len() + RUNTIME.len()).contains(&usize::from(file.0))
}

/// How many functions of the standard library were parsed in this process so far.
pub fn parsed_functions() -> usize {
    std().items.iter().filter(|item| item.parsed.get().is_some()).count()
}

/// Files with functions, each of which is there once it is asked for.
#[derive(Debug)]
pub(crate) struct Shelf {
    files: Vec<LibraryFile>,
    /// In the order of the files.
    items: Vec<Piece>,
    by_name: FxHashMap<&'static str, Functions>,
}

/// A file that is part of the compiler.
#[derive(Debug)]
pub(crate) struct LibraryFile {
    id: FileId,
    name: &'static str,
    pub text: &'static str,
}

/// The functions of one name.
#[derive(Debug, Default)]
struct Functions {
    /// Their places among the items.
    places: Vec<usize>,
    /// Whether one of them has a doc comment: the others are for the library's own use.
    is_public: bool,
}

/// One function of a file.
#[derive(Debug)]
struct Piece {
    file: usize,
    range: Range<usize>,
    parsed: OnceLock<Item>,
    contract: OnceLock<Contract<'static>>,
}

impl Shelf {
    fn of(texts: Files, first: usize, truth: bool) -> Shelf {
        let mut shelf = Shelf { files: Vec::new(), items: Vec::new(), by_name: FxHashMap::default() };
        for (file, &(name, text)) in texts.iter().enumerate() {
            shelf.files.push(LibraryFile { id: FileId((first + file) as u16), name, text });
            let stands_in = name == TRUTH;
            for Outlined { range, name, is_documented } in outlined(text) {
                let mut functions = match stands_in {
                    true => Functions::default(),
                    false => shelf.by_name.remove(name).unwrap_or_default(),
                };
                functions.places.push(shelf.items.len());
                functions.is_public |= is_documented;
                if truth || !stands_in {
                    shelf.by_name.insert(name, functions);
                }
                let (parsed, contract) = (OnceLock::new(), OnceLock::new());
                shelf.items.push(Piece { file, range, parsed, contract });
            }
        }
        shelf
    }

    /// The files, in order.
    pub fn files(&self) -> &[LibraryFile] {
        &self.files
    }

    /// The items of a file, in order.
    pub fn items_of(&'static self, file: &LibraryFile) -> impl Iterator<Item = &'static Item> {
        let id = file.id;
        self.items.iter().filter(move |piece| self.files[piece.file].id == id).map(|piece| self.item(piece))
    }

    /// The names of the functions that every file can use, in no order.
    pub fn public_names(&self) -> impl Iterator<Item = &'static str> {
        self.by_name.iter().filter(|(_, functions)| functions.is_public).map(|(name, _)| *name)
    }

    /// Whether there is a function of this name that every file can use.
    pub fn is_public(&self, name: &str) -> bool {
        self.by_name.get(name).is_some_and(|functions| functions.is_public)
    }

    /// The functions of a name.
    pub fn functions(&'static self, name: &str) -> impl Iterator<Item = &'static Function> {
        let places = self.by_name.get(name).into_iter().flat_map(|functions| &functions.places);
        places.filter_map(|place| match &self.item(&self.items[*place]).kind {
            ItemKind::Fn(function) => Some(&**function),
            _ => None,
        })
    }

    /// What a function of these files promises and requires.
    pub fn contract_of(&'static self, function: &Function) -> Option<&'static Contract<'static>> {
        let piece = self.piece_of(function)?;
        let contract =
            piece.contract.get_or_init(|| Contract::of(&self.item(piece).attributes, true, &mut Vec::new()));
        (!contract.is_empty()).then_some(contract)
    }

    /// The first sentence of what is said of a function of these files, on one line.
    pub fn summary_of(&'static self, function: &Function) -> Option<Arc<str>> {
        let docs = one_line(&self.item(self.piece_of(function)?).docs);
        (!docs.is_empty()).then(|| Arc::from(&docs[..end_of_sentence(&docs)]))
    }

    /// The piece in which a function's name stands.
    fn piece_of(&self, function: &Function) -> Option<&Piece> {
        let span = function.name.span;
        let file = usize::from(span.file.0.checked_sub(self.files.first()?.id.0)?);
        let after = self.items.partition_point(|p| (p.file, p.range.start) <= (file, span.start as usize));
        self.items.get(after.checked_sub(1)?).filter(|piece| piece.file == file)
    }

    fn item(&'static self, piece: &'static Piece) -> &'static Item {
        piece.parsed.get_or_init(|| {
            let LibraryFile { id, name, text } = self.files[piece.file];
            let (mut file, diagnostics) = sdf_syntax::parse_part(id, text, piece.range.clone());
            assert!(diagnostics.is_empty(), "{name} is not well formed: {diagnostics:?}");
            file.items.pop().unwrap_or_else(|| panic!("{name} has no item in {:?}", piece.range))
        })
    }
}

impl LibraryFile {
    /// Its name without the folder, such as `shapes.sdf`.
    pub fn short_name(&self) -> &'static str {
        short_name(self.name)
    }
}

fn short_name(name: &'static str) -> &'static str {
    let name = name.trim_matches(['<', '>']);
    name.rsplit('/').next().unwrap_or(name)
}

/// A function as the lines of its file show it.
struct Outlined {
    /// From its doc comment or its first attribute to the beginning of what follows it.
    range: Range<usize>,
    name: &'static str,
    is_documented: bool,
}

/// The functions of a file. In the compiler's own files what belongs to a function stands directly at the beginning of
/// lines: its comments, its attributes and its `fn`; all other lines of it begin with a space or a closing bracket.
fn outlined(text: &'static str) -> Vec<Outlined> {
    let mut out: Vec<Outlined> = Vec::new();
    // Where what stands before the next `fn` begins, and whether a doc comment is part of it.
    let mut heading: Option<(usize, bool)> = None;
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let start = at;
        at += line.len();
        let name = line.strip_prefix("fn ");
        if name.is_some() || line.starts_with(['@', '/']) {
            if let (None, Some(before)) = (heading, out.last_mut()) {
                before.range.end = start;
            }
            let (begin, documented) = heading.unwrap_or((start, false));
            heading = Some((begin, documented || line.starts_with("///")));
        }
        if let (Some(name), Some((begin, is_documented))) = (name, heading) {
            let end = name.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(name.len());
            out.push(Outlined { range: begin..text.len(), name: &name[..end], is_documented });
            heading = None;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use crate::errors;
    use crate::names::same_parameters;
    use std::collections::BTreeSet;

    /// What the lines show is what the parser finds in the whole file, place by place.
    #[test]
    fn pieces_are_the_items_of_the_file() {
        for shelf in [std(), &library().runtime, &Library::with(true, &[]).runtime] {
            let is_true = std::ptr::eq(shelf, &Library::with(true, &[]).runtime);
            for file in shelf.files().iter().filter(|file| (file.name == TRUTH) == is_true) {
                let (whole, diagnostics) = sdf_syntax::parse(file.id, file.text);
                assert!(diagnostics.is_empty(), "{}: {diagnostics:?}", file.name);
                let pieces: Vec<&Item> = shelf.items_of(file).collect();
                assert_eq!(pieces.len(), whole.items.len(), "{}", file.name);
                for (piece, item) in pieces.into_iter().zip(&whole.items) {
                    assert_eq!(piece, item, "{}", file.name);
                    let ItemKind::Fn(function) = &piece.kind else {
                        panic!("{} has more than functions: {item:?}", file.name)
                    };
                    let found = shelf.functions(&function.name.text);
                    assert!(found.into_iter().any(|f| f == &**function), "{}", function.name.text);
                    assert!(item.docs.is_empty() || shelf.is_public(&function.name.text));
                }
            }
        }
    }

    /// What is said of a user's items is not asked of these at every start, so it is asked here.
    #[test]
    fn items_are_in_order() {
        for shelf in [std(), &library().runtime] {
            let mut diagnostics = Vec::new();
            for piece in &shelf.items {
                Contract::of(&shelf.item(piece).attributes, true, &mut diagnostics);
            }
            for name in shelf.by_name.keys() {
                let functions: Vec<&Function> = shelf.functions(name).collect();
                for (i, function) in functions.iter().enumerate() {
                    if let Some(other) = functions[..i].iter().find(|other| same_parameters(other, function))
                    {
                        diagnostics.push(errors::defined_twice(&function.name, other.name.span));
                    }
                }
            }
            assert!(diagnostics.is_empty(), "{diagnostics:#?}");
        }
    }

    /// What stands in for nothing is the truth itself, or what only it calls, which says so by its name.
    fn stands_in_rightly(stand_in: &Function, of: &'static Shelf) -> bool {
        let same = |f: &&Function| {
            let names = |f: &Function| f.parameters.iter().map(|p| p.name.text.clone()).collect::<Vec<_>>();
            names(f) == names(stand_in) && same_parameters(f, stand_in)
        };
        let name = &stand_in.name.text;
        let mut stood_in_for = of.functions(name).peekable();
        match stood_in_for.peek() {
            Some(_) => stood_in_for.any(|f| same(&f)),
            None => name.contains("truth"),
        }
    }

    #[test]
    fn what_the_truth_is_found_with_stands_in_for_functions_of_the_renderer() {
        let (pictures, truth) = (&library().runtime, &Library::with(true, &[]).runtime);
        let file = truth.files().iter().find(|file| file.name == TRUTH).expect("it is there");
        let mut stand_ins = 0;
        for item in truth.items_of(file) {
            let ItemKind::Fn(function) = &item.kind else { unreachable!("tested above") };
            let name = &function.name.text;
            assert!(stands_in_rightly(function, pictures), "{name} stands in for nothing");
            stand_ins += pictures.functions(name).count();
            // In pictures it is not there, and for the truth nothing else of the name is.
            assert!(pictures.functions(name).all(|f| f != &**function), "{name}");
            assert!(
                truth.functions(name).all(|f| truth.files[truth.piece_of(f).unwrap().file].name == TRUTH)
            );
        }
        assert!(stand_ins >= 6, "{stand_ins}");
    }

    /// A name that the renderer has not, and one with other parameters.
    #[test]
    fn a_function_that_stands_in_for_nothing_is_seen() {
        let others = [
            "fn occlusions(map, foot, normal, ambient, count) = 1",
            "fn occlusion(map, foot, normal, count) = 1",
            "fn occlusion(map, foot, normal, surroundings, count) = 1",
        ];
        for (text, is_right) in others.map(|text| (text, false)).into_iter().chain([
            ("fn occlusion(map, foot, normal, ambient, count) = 1", true),
            ("fn in_truth(a) = 1", true),
        ]) {
            let (file, diagnostics) = sdf_syntax::parse(FileId(0), text);
            assert!(diagnostics.is_empty(), "{diagnostics:?}");
            let ItemKind::Fn(function) = &file.items[0].kind else { panic!("{text}") };
            assert_eq!(stands_in_rightly(function, &library().runtime), is_right, "{text}");
        }
    }

    /// Whatever stands in the file that the truth is found with, no picture shows it; the truth does.
    #[test]
    fn pictures_do_not_know_the_truth() {
        let example = include_str!("../../../examples/blend.sdf");
        let upside_down = "fn occlusion(map, foot, normal, ambient, count) = 0.5\n";
        let replaced = vec![("truth.sdf".to_owned(), upside_down.to_owned())];
        let of = |options: Options| {
            let scene = crate::compile("blend", example, &options).scene.expect("a scene");
            (scene.program, scene.summary.settings)
        };
        let plain = of(Options::default());
        assert_eq!(of(Options { replaced: replaced.clone(), ..Options::default() }), plain);
        let truth = Options { truth: true, ..Options::default() };
        assert_ne!(of(truth).0, plain.0);
    }

    #[test]
    fn a_function_has_its_own_contract_and_words() {
        let places: BTreeSet<_> = std()
            .items
            .iter()
            .map(|piece| {
                let ItemKind::Fn(function) = &std().item(piece).kind else { unreachable!("tested above") };
                let found = std().piece_of(function).expect("a piece");
                assert!(std::ptr::eq(found, piece), "{}", function.name.text);
                (found.file, found.range.start)
            })
            .collect();
        assert_eq!(places.len(), std().items.len());
        let sphere = std().functions("sphere").next().expect("a sphere");
        assert!(std().contract_of(sphere).is_some_and(|contract| contract.bounds.is_some()));
        assert!(std().summary_of(sphere).is_some_and(|summary| summary.ends_with('.')));
    }
}
