//! `sdfc render scene.sdf -o scene.png`

use crate::arguments::{RenderArguments, TargetName};
use crate::compile::{our_mistake, shader, with_accuracy};
use crate::failure::Failure;
use crate::input;
use crate::output::Output;
use crate::progress::Progress;
use crate::terminal::Terminal;
use crate::tradeoffs::bounds::{self, Wanted};
use clap::ValueEnum;
use sdfc::{Accuracy, Clock, DrawError, Drawing, Frame, Measured, Options, View};

/// Draws a scene to a PNG file.
pub fn run(arguments: &RenderArguments, terminal: &Terminal) -> Result<(), Failure> {
    must_be_png(arguments)?;
    let output = Output::prepare(&arguments.output, &arguments.scene)?;
    let mut clock = Clock::default();
    let source = clock.time("read", || input::read(&arguments.scene, terminal))?;
    let view = arguments.view.map_or(View::Picture, View::from);
    let options = Options {
        view: Some(view),
        quality: arguments.quality.preset,
        ..arguments.set.options(&arguments.scene)?
    };
    let mut compiled = sdfc::compile(&source.name, &source.text, &options, &mut clock);
    terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
    shader(&compiled, terminal)?;

    let (width, height) = arguments.size;
    let frame = Frame { time: arguments.time, ..Frame::new(width, height) };
    let picture = Options { view: None, ..options.clone() };
    let wanted = Wanted {
        source: &source,
        options: &picture,
        frame: &frame,
        device: &arguments.device,
        figures: false,
    };
    let chosen = bounds::choose(&arguments.bounds, arguments.budget, &wanted, terminal, &mut clock)?;
    let accuracy = chosen.map(|chosen| chosen.row.setting.accuracy);
    if let Some(accuracy) = accuracy {
        compiled = with_accuracy(accuracy, &source, options, &compiled, terminal, &mut clock);
    }
    let shader = shader(&compiled, terminal)?;
    let progress = Progress::new("drawing");
    let show = |part| progress.show(part);
    let drawing = shader.draw(&frame, &arguments.device, arguments.shader.into(), &show, &mut clock);
    progress.end();
    let drawing = drawing.map_err(|error| match error {
        DrawError::Device(message) => Failure::Device(message),
        DrawError::Shader(bug) => our_mistake(bug, &compiled, terminal),
    })?;
    if let Some(why) = &drawing.fallback {
        terminal.note(&format!("drawn on the CPU: {}", why.lines().next().unwrap_or_default()));
    }
    let measured = drawing.measured.as_ref().expect("a view is measured");
    let lost = measured.warning(&compiled.tree);
    terminal.diagnostics(&compiled.sources, lost.as_slice());
    if lost.is_some() && terminal.denies_warnings() {
        return Err(Failure::Denied);
    }
    if let Some(legend) = legend(view, measured) {
        terminal.note(&legend);
    }
    let bytes = clock.time("encode", || png(&drawing, &source.text, arguments, accuracy))?;
    clock.time("save", || output.write(&bytes))?;
    if arguments.timings {
        terminal.note(&format!("drawn by {}", drawing.device));
        terminal.timings(&clock);
    }
    Ok(())
}

/// What the colours of a view mean, and the largest values in it; the picture itself needs no words.
fn legend(view: View, measured: &Measured) -> Option<String> {
    let of_range = |words: &dyn Fn(f32, f32) -> String| match measured.range {
        Some((least, largest)) => words(least, largest),
        None => "there is nothing".into(),
    };
    match view {
        View::Picture => None,
        View::Depth => Some(format!(
            "white is near, black is far, dark blue is nothing; {}",
            of_range(&|nearest, farthest| format!(
                "the nearest is at {nearest:.3}, the farthest at {farthest:.3}"
            ))
        )),
        View::Normal => Some(
            "red, green and blue are x, y and z of the normal, from -1 to 1; dark blue is nothing".into(),
        ),
        View::Steps => Some(format!(
            "violet is no step, blue 1/16 of the most that may be, teal 1/4, green 9/16, yellow all; {}",
            of_range(&|_, most| format!("the most were {most} steps"))
        )),
        View::Error => Some(format!(
            "violet is 1/1000 of the tolerance or less, blue 1/100, teal 1/10, green the tolerance, yellow 10 times \
             it or more, dark blue nothing; {}",
            of_range(&|_, largest| format!("the largest is {largest:.3} times the tolerance"))
        )),
        View::Material => Some("the surfaces' colours without light; dark blue is nothing".into()),
    }
}

fn must_be_png(arguments: &RenderArguments) -> Result<(), Failure> {
    let path = &arguments.output;
    let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if is_png || input::is_dash(path) {
        return Ok(());
    }
    let failure = Failure::call(format!("{} is not the name of a .png file", path.display()));
    Err(match path.extension().and_then(|extension| extension.to_str()) {
        Some(extension) if TargetName::of_extension(extension).is_some() => failure.help(format!(
            "a shader is written without `render`: `sdfc {} -o {}`",
            arguments.scene.display(),
            path.display()
        )),
        _ => failure.help("pictures are written as PNG: `-o scene.png`"),
    })
}

/// The file: the picture, the scene, and how it was drawn.
fn png(
    drawing: &Drawing,
    source: &str,
    arguments: &RenderArguments,
    accuracy: Option<Accuracy>,
) -> Result<Vec<u8>, Failure> {
    let (width, height) = arguments.size;
    let mut settings = format!("--size {width}x{height} --time {}", arguments.time);
    if let Some(view) = arguments.view.and_then(|view| view.to_possible_value()) {
        settings.push_str(&format!(" --view {}", view.get_name()));
    }
    for (name, value) in &arguments.set.values {
        settings.push_str(&format!(" --set {name}={value}"));
    }
    match (accuracy, arguments.quality.preset) {
        (Some(accuracy), _) => settings.push_str(&format!("; {accuracy}")),
        (None, Some(quality)) => settings.push_str(&format!(" --quality {}", quality.word())),
        (None, None) => {}
    }
    let software = format!("sdfc {}", sdfc::VERSION);
    let texts = [("Software", software.as_str()), ("Source", source), ("Settings", &settings)];
    let mut bytes = Vec::new();
    match drawing.picture.write_png(&mut bytes, &texts) {
        Ok(()) => Ok(bytes),
        Err(error) => Err(Failure::call(format!("the picture cannot be encoded: {error}"))),
    }
}
