//! From the tree of a scene to its program: names, types, static evaluation, shapes, settings, and the renderer
//! with only the effects that the scene calls for.
//!
//! The typical way is `compile(name, text, &Options) → Compilation`, whose `scene` holds the program of a pixel
//! and whose diagnostics say what is wrong. Shapes and the renderer are written in the language itself, in `std/`
//! and `runtime/`; nothing here knows a shape's name.
#![warn(missing_docs)]

mod accuracy;
mod beside;
mod builtin;
mod call;
mod causes;
mod check;
mod choice;
mod context;
mod contract;
mod distribute;
mod effects;
mod errors;
mod eval;
mod evaluations;
mod expansion;
mod facts;
mod framing;
mod glossary;
mod ground;
mod import;
mod items;
mod kind;
mod library;
mod local_slope;
mod lookahead;
mod memo;
mod names;
mod operators;
mod origin;
mod outline;
mod ranges;
mod reachable;
mod reference;
mod scene;
mod seams;
mod settings;
mod shading;
mod shape;
mod signs;
mod solids;
mod stride;
mod surface;
mod unshadowed;
mod value;
mod view;
mod vocabulary;
mod walk;

pub use accuracy::{Accuracy, Coordinates, Correction, Normals, Quality};
pub use effects::Effect;
pub use facts::{Basis, Class, Copies, Fact};
pub use glossary::{Group, glossary};
pub use import::{Imports, Loader, Location, Refusal, Texts};
pub use kind::{Kind, kind_of};
pub use library::{compiler_files, parsed_functions};
pub use reference::{Entry, Form, Parameter, Section, reference};
pub use view::View;
pub use vocabulary::{Vocabulary, vocabulary};

use sdf_ir::{Constant, FunctionId, Program};
use sdf_syntax::tree::File;
use sdf_syntax::{Diagnostic, FileId, Severity, Sources};

/// The root file: the one that the user gave.
pub const USER_FILE: FileId = FileId(0);

/// The distance of what is not there: farther than anything that is drawn.
const NOTHING: f64 = 1e20;

/// The stack of the thread that elaborates: a shape that is moved ten thousand times nests that deep.
const STACK: usize = 1 << 30;

/// The value that `--set` gives a param, as written.
pub(crate) type Override = String;

/// How to compile.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Params that are frozen, by name, with their values as written: they become constants, and what they make
    /// zero is not called for.
    pub set: Vec<(String, String)>,
    /// At how many points each promise of the file is tried; a few where nothing is said.
    pub attack: Option<usize>,
    /// Whether the scene is to have its [`facts`](Scene::facts).
    pub facts: bool,
    /// Whether the camera can be turned about its target from outside, by a uniform of the role
    /// [`Orbit`](sdf_ir::Role::Orbit): for pages that let their users look around.
    pub orbit: bool,
    /// Whether the scene is to have a [`probe`](Scene::probe).
    pub probe: bool,
    /// Whether the scene is to have a [`query`](Scene::query).
    pub query: bool,
    /// Whether the scene is to have what a [`Certificate`] is made from.
    pub certificate: bool,
    /// What the scene is drawn as, where that is no text for others.
    pub view: Option<View>,
    /// The places in [`Scene::effects`] of those that are left out of the program. It is for measuring alone what they
    /// take: the picture is then not the scene's, and without step correction rays may pass through what is there.
    pub left_out: Vec<usize>,
    /// The preset that stands for the file's `quality`; the fields of its `render` win over it.
    pub quality: Option<Quality>,
    /// What the scene is compiled with in place of all that its `render` says about accuracy.
    pub accuracy: Option<Accuracy>,
    /// Whether the scene is to have a [`truth`](Scene::truth). Its other functions are then those of a renderer that only the
    /// interpreter has time for.
    pub truth: bool,
    /// How the files that the scene imports are found and read.
    pub imports: Imports,
    /// Files of the compiler for which others stand in, by their names as in `march.sdf`, with their texts: so a test
    /// can take a guard out and see what it is for. See [`compiler_files`].
    pub replaced: Vec<(String, String)>,
}

/// What came of a file.
#[derive(Debug)]
pub struct Compilation {
    /// The user's file, those of the compiler and those that are imported, which the places of diagnostics refer to.
    pub sources: Sources,
    /// The tree of the user's file.
    pub tree: File,
    /// What is wrong, in the order of the source.
    pub diagnostics: Vec<Diagnostic>,
    /// The scene, unless there was an error.
    pub scene: Option<Scene>,
    /// How many expressions were evaluated: what the scene cost to compile, the same on every machine.
    pub work: usize,
}

impl Compilation {
    /// Whether there was an error.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity() == Severity::Error)
    }
}

/// A scene as a program.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The program, simplified; its operations are total by the language's meaning, not yet by the hardware's.
    /// Its entry is `pixel(coordinate: vec2) → color: vec3`, in pixels from the bottom left and in sRGB; with an
    /// [`Options::view`] it has one more result, which [`View`] tells.
    pub program: Program,
    /// Where the coordinates of `map` and of the certificate are zero: a place near the camera if that stands far from
    /// the origin, else the origin.
    pub origin: [f64; 3],
    /// `map(p: vec3) → distance` of the whole scene, `p` relative to `origin`; a scene that is nothing has none.
    pub map: Option<FunctionId>,
    /// `probe(coordinate: vec2) → depth: float, normal: vec3, color: vec3, light: vec3, steps: float, lost: float` of
    /// what a pixel shows, if it was asked for: the distance from the eye (-1 where there is nothing), the surface's
    /// normal and colour, the light that arrives there, how many steps the ray took, and 1 if they were too few. The
    /// entry does not call it, so no text has it.
    pub probe: Option<FunctionId>,
    /// `truth(coordinate: vec2) → color: vec3, depth: float, normal: vec3, lost: float` of what a pixel shows, computed with no
    /// regard for time, if it was asked for; it is meant for `f64`. The colour is in linear light from 0 to 1, else as
    /// `probe` has it.
    pub truth: Option<FunctionId>,
    /// What trades accuracy for time in the program.
    pub accuracy: Accuracy,
    /// The largest slope of the field of what is marched to, in its box: 1 and more.
    pub slope: f64,
    /// What the truth about pictures is found from, if it was asked for. The entry does not call its functions.
    pub certificate: Option<Certificate>,
    /// What is proved of its shapes, if it was asked for.
    pub facts: Vec<Fact>,
    /// The functions of a point for programs that ask, if they were asked for. The entry does not call them, so no
    /// text has them.
    pub query: Option<Query>,
    /// All effects, in an order that does not change: whether each is called for, and why; those that are
    /// [left out](Options::left_out) too.
    pub effects: Vec<Effect>,
    /// What was compiled in, for the header of the emitted text.
    pub summary: Summary,
}

/// Functions of a point in space, each with more results than the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Query {
    /// `p: vec3 → distance`, negative inside; 1e20 and more of a scene that is nothing.
    pub distance: FunctionId,
    /// `p: vec3 → distance, gradient: vec3`
    pub gradient: FunctionId,
    /// `p: vec3 → distance, gradient: vec3, color: vec3, specular, shininess, emission: vec3, glow: vec3,
    /// glow_radius, reflect, transmit, ior`: the properties of the material that the surface would have here, with
    /// colours in linear light.
    pub material: FunctionId,
}

/// Functions from which the truth about a picture is found, and whether its steps are safe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Certificate {
    /// `coordinate: vec2 → origin: vec3, direction: vec3, far: float, width: float, tolerance: float`: the ray through a
    /// pixel, whose direction has length 1; how far it goes; and how near to a surface a hit may be: at its origin, and how
    /// much farther for each unit of length along it.
    pub ray: FunctionId,
    /// `p: vec3 → distance: float, stride: float`: the scene's field, and a distance within which it certainly has no
    /// zero; from inside, both are negative.
    pub step: FunctionId,
}

/// What was compiled in.
#[derive(Debug, Clone, Default)]
pub struct Summary {
    /// How many shapes the scene block has.
    pub shapes: usize,
    /// The settings that decide about accuracy, as `name value`.
    pub settings: Vec<String>,
    /// The effects that were compiled in, as the header lists them.
    pub effects: Vec<&'static str>,
}

/// The properties of a material, and what each is where a material does not say, in the order of
/// [`Query::material`].
pub fn material_defaults() -> impl Iterator<Item = (&'static str, Constant)> {
    surface::Column::ALL.into_iter().map(|column| (column.name(), column.default()))
}

/// Compiles a file. `name` is what messages call it.
pub fn compile(name: &str, text: &str, options: &Options) -> Compilation {
    let library = library::Library::with(options.truth, &options.replaced);
    let mut sources = library.sources(name, text);
    let (tree, mut diagnostics) = sdf_syntax::parse(USER_FILE, text);
    let root_errors = diagnostics.iter().any(|d| d.severity() == Severity::Error);
    let files = import::load(&tree, &mut sources, &options.imports, &mut diagnostics);
    let text_errors = diagnostics.iter().any(|d| d.severity() == Severity::Error);
    let (scene, found, work) = on_deep_stack(|| scene::elaborate(&sources, &tree, &files, library, options));
    diagnostics.extend(found);
    if root_errors {
        // It may be what could not be read.
        diagnostics.retain(|d| d.code != sdf_syntax::Code::E060);
    }
    tidy(&mut diagnostics);
    let scene = scene.filter(|_| !text_errors);
    Compilation { sources, tree, diagnostics, scene, work }
}

/// Does something in a thread whose stack is deep enough for any scene.
fn on_deep_stack<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("elaborate".into()).stack_size(STACK);
        match thread.spawn_scoped(scope, work).map(|handle| handle.join()) {
            Ok(Ok(result)) => result,
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            Err(error) => panic!("no thread for elaboration: {error}"),
        }
    })
}

/// Puts findings in the order of the source, each once.
fn tidy(diagnostics: &mut Vec<Diagnostic>) {
    diagnostics.sort_by_key(|d| (d.span, d.code));
    diagnostics.dedup_by(|b, a| a.span == b.span && a.code == b.code && a.message == b.message);
}

/// A colour as `#rgb` or `#rrggbb`, in linear light.
pub(crate) fn parse_color(text: &str) -> Option<[f64; 3]> {
    let digits = text.strip_prefix('#')?;
    let wide: String = match digits.len() {
        3 => digits.chars().flat_map(|c| [c, c]).collect(),
        6 => digits.to_string(),
        _ => return None,
    };
    let channel = |i: usize| u8::from_str_radix(wide.get(i..i + 2)?, 16).ok();
    let channels = [channel(0)?, channel(2)?, channel(4)?];
    Some(channels.map(|c| sdf_syntax::token::linear_from_srgb(f64::from(c) / 255.0)))
}
