//! The compiler from end to end: a source becomes a shader, and a shader a text or a picture.
//!
//! The typical way is `compile(name, text, &Options, &mut Clock) → Compiled`, then `Shader::text(target)` or
//! `Shader::draw(&frame, &device, …)`; programs that need distances take a [`Field`]. The command of the same name adds files, arguments and the terminal.
#![warn(missing_docs)]

mod clock;
mod cost;
mod draw;
mod field;
mod files;
mod measured;
mod price;
mod race;
pub mod tradeoff;

pub use clock::Clock;
pub use cost::{Cost, ITERATION_LIMIT, scene_word};
pub use draw::{Device, DrawError, Drawing, Language, Progress};
pub use field::{Field, Material, Property, Sample};
pub use files::{FileLoader, similar_file};
pub use measured::Measured;
pub use price::{Evaluations, Variant, without};
pub use race::{Lap, Race, race};
pub use sdf_emit::{Format, Target};
pub use sdf_ir::Constant;
pub use sdf_lang::{Accuracy, Basis, Class, Copies, Effect, Fact, Options, Quality, Scene, View};
pub use sdf_render::{Frame, Picture};

use sdf_emit::Header;
use sdf_ir::Program;
use sdf_syntax::tree::File;
use sdf_syntax::{Code, Diagnostic, Severity, Sources, Span};
use std::path::Path;

/// The version of the compiler.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What the system says of an error, in our manner: lower case, without the number.
pub fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    let text = text.split(" (os error").next().unwrap_or_default();
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// What came of a source.
#[derive(Debug)]
pub struct Compiled {
    /// The files that the places of diagnostics refer to.
    pub sources: Sources,
    /// The tree of the user's file.
    pub tree: File,
    /// What is wrong, in the order of the source.
    pub diagnostics: Vec<Diagnostic>,
    /// The scene and what it is as a shader, unless there was an error.
    pub output: Option<(Scene, Shader)>,
}

/// A scene that is ready to be written or drawn.
#[derive(Debug, Clone)]
pub struct Shader {
    /// The program, in operations that mean the same on every target.
    pub program: Program,
    /// What stands at the head of its texts.
    pub header: Header,
    /// What it costs.
    pub cost: Cost,
}

/// Compiles a source. `name` is what messages call it; `clock` takes the time of each stage.
pub fn compile(name: &str, text: &str, options: &Options, clock: &mut Clock) -> Compiled {
    let front = clock.time("parse and elaborate", || sdf_lang::compile(name, text, options));
    let (sources, tree, mut diagnostics) = (front.sources, front.tree, front.diagnostics);
    let output = front.scene.map(|scene| {
        let program = clock.time("legalise", || sdf_ir::legalise(&drawn(&scene)));
        let cost = clock.time("cost", || Cost::of(&scene, &program));
        diagnostics.extend(cost.warning(&tree));
        let title = Path::new(name).file_stem().map_or("scene".into(), |stem| stem.to_string_lossy());
        let header = cost::header(&title, &scene.summary, &cost);
        (scene, Shader { program, header, cost })
    });
    Compiled { sources, tree, diagnostics, output }
}

/// The program of a scene's pictures. Functions that only questions call would else have a say in what the others yield.
fn drawn(scene: &Scene) -> std::borrow::Cow<'_, Program> {
    match scene.query.is_some()
        || scene.probe.is_some()
        || scene.truth.is_some()
        || scene.certificate.is_some()
    {
        true => std::borrow::Cow::Owned(sdf_ir::simplify(&scene.program, &[]).0),
        false => std::borrow::Cow::Borrowed(&scene.program),
    }
}

impl Compiled {
    /// Whether there was an error.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity() == Severity::Error)
    }
}

impl Shader {
    /// The text for a target, which naga has validated. An error is a mistake of the compiler's.
    pub fn text(&self, target: Target) -> Result<String, Diagnostic> {
        sdf_emit::emit(&self.program, target, &self.header)
            .map_err(|error| invalid_shader(&error.to_string()))
    }

    /// The file of a format, made from what naga has validated. An error is a mistake of the compiler's.
    pub fn file(&self, format: Format) -> Result<Vec<u8>, Diagnostic> {
        sdf_emit::write(&self.program, format, &self.header)
            .map_err(|error| invalid_shader(&error.to_string()))
    }
}

fn invalid_shader(reason: &str) -> Diagnostic {
    Diagnostic::new(Code::E070, Span::default(), format!("the shader of this scene is not valid: {reason}"))
        .help("this is a mistake in sdfc, not in the scene; please report it with the scene")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_becomes_text_and_picture() {
        let mut clock = Clock::default();
        let compiled = compile("a.sdf", "scene { sphere(1) }", &Options::default(), &mut clock);
        assert_eq!(compiled.diagnostics, []);
        let (scene, shader) = compiled.output.unwrap();
        assert_eq!(scene.summary.shapes, 1);
        assert!(shader.text(Target::Wgsl).unwrap().contains("fn fs_main("));
        let frame = Frame::new(8, 4);
        let drawing = shader.draw(&frame, &Device::Cpu, Language::Wgsl, &|_| {}, &mut clock).unwrap();
        assert_eq!((drawing.picture.width, drawing.picture.height, drawing.device.as_str()), (8, 4, "CPU"));
        let stages: Vec<&str> = clock.stages().iter().map(|(stage, _)| *stage).collect();
        assert_eq!(stages, ["parse and elaborate", "legalise", "cost", "draw on the CPU"]);
    }

    #[test]
    fn a_mistake_leaves_the_tree() {
        let compiled = compile("a.sdf", "scene { spere(1) }", &Options::default(), &mut Clock::default());
        assert!(compiled.has_errors() && compiled.output.is_none());
        assert_eq!(compiled.tree.items.len(), 1);
    }

    #[test]
    fn a_shader_that_is_not_valid_is_our_mistake() {
        let mut compiled =
            compile("a.sdf", "scene { sphere(1) }", &Options::default(), &mut Clock::default());
        let (_, shader) = compiled.output.as_mut().unwrap();
        shader.program.entry = None;
        let diagnostic = shader.text(Target::Wgsl).unwrap_err();
        assert_eq!(diagnostic.code, Code::E070);
        assert!(diagnostic.help.unwrap().contains("report"));
    }
}
