//! `sdfc scene.sdf -o scene.wgsl`

use crate::arguments::{CompileArguments, Stage, TargetName};
use crate::failure::Failure;
use crate::input;
use crate::listing::listing;
use crate::output::{Output, print};
use crate::terminal::Terminal;
use crate::tradeoffs::bounds::{self, Chosen, Wanted};
use sdf_syntax::{Code, Diagnostic, Severity};
use sdfc::{Accuracy, Clock, Compiled, Format, Frame, Options};
use std::path::Path;

/// Compiles a scene, and writes what was asked for.
pub fn run(arguments: &CompileArguments, terminal: &Terminal) -> Result<(), Failure> {
    let scene = arguments.scene.as_deref().unwrap_or(Path::new("-"));
    let format = format(arguments)?;
    let output = match (&arguments.output, format) {
        (Some(path), _) => Some(Output::prepare(path, scene)?),
        (None, Some(_)) => Some(Output::Standard),
        (None, None) => None,
    };
    if matches!(output, Some(Output::Standard)) && !arguments.emit.is_empty() {
        return Err(Failure::call("the shader and what `--emit` prints cannot both go to standard output")
            .help("name a file: `-o scene.wgsl`"));
    }

    let mut clock = Clock::default();
    let source = clock.time("read", || input::read(scene, terminal))?;
    // Whoever looks at a page can look around.
    let orbit = format == Some(Format::Page);
    let facts = arguments.emit.contains(&Stage::Facts);
    let options =
        Options { orbit, facts, quality: arguments.quality.preset, ..arguments.set.options(scene)? };
    let mut compiled = sdfc::compile(&source.name, &source.text, &options, &mut clock);
    terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
    let is_text = matches!(format, Some(Format::Text(_)));
    if let Some(chosen) = chosen(arguments, &source, &options, is_text, &compiled, terminal, &mut clock)? {
        compiled =
            with_accuracy(chosen.row.setting.accuracy, &source, options, &compiled, terminal, &mut clock);
        if let (Some((_, shader)), Some(figures)) = (&mut compiled.output, chosen.figures) {
            shader.header.lines.extend(figures.head);
            shader.header.figures = figures.lines;
        }
    }
    if !arguments.emit.is_empty() {
        print(listing(&arguments.emit, &source.text, &compiled).as_bytes())?;
    }
    let shader = shader(&compiled, terminal)?;
    if let (Some(output), Some(format)) = (&output, format) {
        let file = clock.time("write and validate", || shader.file(format));
        let file = file.map_err(|bug| our_mistake(bug, &compiled, terminal))?;
        clock.time("save", || output.write(&file))?;
    }
    if arguments.timings {
        terminal.timings(&clock);
    }
    Ok(())
}

/// A scene once more, with another accuracy; what is to be said of it then and was not said before is told.
pub fn with_accuracy(
    accuracy: Accuracy,
    source: &input::Scene,
    options: Options,
    before: &Compiled,
    terminal: &Terminal,
    clock: &mut Clock,
) -> Compiled {
    let options = Options { accuracy: Some(accuracy), ..options };
    let compiled = sdfc::compile(&source.name, &source.text, &options, clock);
    let is_new = |diagnostic: &&Diagnostic| !before.diagnostics.contains(diagnostic);
    let new: Vec<Diagnostic> = compiled.diagnostics.iter().filter(is_new).cloned().collect();
    terminal.diagnostics(&compiled.sources, &new);
    compiled
}

/// The setting that the bounds ask for, if there are any; with figures for a text.
fn chosen(
    arguments: &CompileArguments,
    source: &input::Scene,
    options: &Options,
    figures: bool,
    compiled: &Compiled,
    terminal: &Terminal,
    clock: &mut Clock,
) -> Result<Option<Chosen>, Failure> {
    if !arguments.bounds.are_any() && (arguments.size.is_some() || arguments.device.is_some()) {
        return Err(Failure::call("`--size` and `--device` are about the picture that bounds are about")
            .help("add `--max-error 0.5px` or `--max-time 16ms`; a shader draws pictures of any size"));
    }
    if arguments.bounds.are_any() {
        shader(compiled, terminal)?;
    }
    let (width, height) = arguments.size.unwrap_or((640, 360));
    let device = arguments.device.clone().unwrap_or_default();
    let wanted = Wanted { source, options, frame: &Frame::new(width, height), device: &device, figures };
    bounds::choose(&arguments.bounds, arguments.budget, &wanted, terminal, clock)
}

/// The shader of a scene without mistakes, and without warnings where they are denied.
pub fn shader<'a>(compiled: &'a Compiled, terminal: &Terminal) -> Result<&'a sdfc::Shader, Failure> {
    let is_denied = |d: &Diagnostic| terminal.denies_warnings() && d.severity() == Severity::Warning;
    if !compiled.has_errors() && compiled.diagnostics.iter().any(is_denied) {
        return Err(Failure::Denied);
    }
    compiled.output.as_ref().map(|(_, shader)| shader).ok_or_else(|| {
        let mut errors = compiled.diagnostics.iter().filter(|d| d.severity() == Severity::Error);
        if errors.all(|d| d.code == Code::E065) { Failure::CallTold } else { Failure::Scene }
    })
}

/// Tells of a mistake of the compiler's.
pub fn our_mistake(bug: Diagnostic, compiled: &Compiled, terminal: &Terminal) -> Failure {
    terminal.diagnostics(&compiled.sources, &[bug]);
    Failure::Bug
}

/// What to write: by the name, else by the extension, else nothing if something is printed instead.
fn format(arguments: &CompileArguments) -> Result<Option<Format>, Failure> {
    if let Some(name) = arguments.target {
        return Ok(Some(name.format()));
    }
    let Some(path) = &arguments.output else {
        return match arguments.emit.is_empty() {
            false => Ok(None),
            true => Err(Failure::call("there is nothing to write")
                .help("name a file, `-o scene.wgsl`, or a target, `--target glsl`, which is printed")),
        };
    };
    if input::is_dash(path) {
        return Err(Failure::call("standard output does not tell which target is wanted")
            .help("name it, for example `--target wgsl`"));
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_lowercase);
    let known = "the targets are .glsl (Shadertoy), .frag (GLSL ES 3.00), .wgsl, .html (a page), .spv, .metal and .hlsl";
    if let Some(name) = extension.as_deref().and_then(TargetName::of_extension) {
        return Ok(Some(name.format()));
    }
    match extension.as_deref() {
        Some("png") => Err(Failure::call("a picture is drawn by `sdfc render`").help(format!(
            "write `sdfc render {} -o {}`",
            shown(arguments.scene.as_deref()),
            path.display()
        ))),
        Some(other) => {
            let extensions = TargetName::extensions();
            let known_ones = extensions.iter().map(String::as_str).chain(["png"]);
            let help = match sdf_syntax::did_you_mean(other, known_ones) {
                Some(similar) => format!("did you mean .{similar}?"),
                None => format!("{known}; `--target` overrides the extension"),
            };
            Err(Failure::call(format!("no target is called .{other}")).help(help))
        }
        None => Err(Failure::call(format!("{} has no extension to tell the target by", path.display()))
            .help(format!("{known}; `--target` names one for any file"))),
    }
}

fn shown(scene: Option<&Path>) -> String {
    scene.unwrap_or(Path::new("scene.sdf")).display().to_string()
}
