//! `sdfc scene.sdf -o scene.wgsl`

use crate::arguments::{CompileArguments, TargetName};
use crate::failure::Failure;
use crate::input;
use crate::listing::listing;
use crate::output::{Output, print};
use crate::terminal::Terminal;
use sdf_syntax::{Code, Diagnostic, Severity};
use sdfc::{Clock, Compiled, Target};
use std::path::Path;

/// The extensions that will have a meaning.
const NOT_BUILT_YET: [&str; 4] = ["html", "spv", "metal", "hlsl"];

/// Compiles a scene, and writes what was asked for.
pub fn run(arguments: &CompileArguments, terminal: &Terminal) -> Result<(), Failure> {
    let scene = arguments.scene.as_deref().unwrap_or(Path::new("-"));
    let target = target(arguments)?;
    let output = match (&arguments.output, target) {
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
    let compiled = sdfc::compile(&source.name, &source.text, &arguments.set.options(scene)?, &mut clock);
    terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
    if !arguments.emit.is_empty() {
        print(listing(&arguments.emit, &source.text, &compiled).as_bytes())?;
    }
    let shader = shader(&compiled)?;
    if let (Some(output), Some(target)) = (&output, target) {
        let text = clock.time("write and validate", || shader.text(target));
        let text = text.map_err(|bug| our_mistake(bug, &compiled, terminal))?;
        clock.time("save", || output.write(text.as_bytes()))?;
    }
    if arguments.timings {
        terminal.timings(&clock);
    }
    Ok(())
}

/// The shader of a scene without mistakes.
pub fn shader(compiled: &Compiled) -> Result<&sdfc::Shader, Failure> {
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
fn target(arguments: &CompileArguments) -> Result<Option<Target>, Failure> {
    if let Some(name) = arguments.target {
        return Ok(Some(match name {
            TargetName::Glsl => Target::Shadertoy,
            TargetName::Frag => Target::GlslEs,
            TargetName::Wgsl => Target::Wgsl,
        }));
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
            .help("name it: `--target glsl`, `--target frag` or `--target wgsl`"));
    }
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_lowercase);
    let known = "the targets are .glsl (Shadertoy), .frag (GLSL ES 3.00) and .wgsl";
    match extension.as_deref() {
        Some("glsl") => Ok(Some(Target::Shadertoy)),
        Some("frag") => Ok(Some(Target::GlslEs)),
        Some("wgsl") => Ok(Some(Target::Wgsl)),
        Some("png") => Err(Failure::call("a picture is drawn by `sdfc render`").help(format!(
            "write `sdfc render {} -o {}`",
            shown(arguments.scene.as_deref()),
            path.display()
        ))),
        Some(other) if NOT_BUILT_YET.contains(&other) => {
            Err(Failure::call(format!("the target .{other} is not built yet")).help(known))
        }
        Some(other) => {
            let similar = sdf_syntax::did_you_mean(other, ["glsl", "frag", "wgsl", "png"]);
            let help = match similar {
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
