//! `sdfc explain scene.sdf`: what a scene calls for, and what each of that takes.

use crate::arguments::{ExplainArguments, MessageArguments, TargetName};
use crate::compile::{our_mistake, shader};
use crate::explain::explanation::{
    Evaluations, Explained, Explanation, Price, Remains, Set, Share, Timing, shapes,
};
use crate::explain::page::page;
use crate::failure::Failure;
use crate::input;
use crate::output::print;
use crate::progress::Progress;
use crate::terminal::Terminal;
use anstream::ColorChoice;
use anstream::adapter::strip_str;
use sdfc::{Clock, DrawError, Effect, Frame, Options, Quality, Race, Shader, Variant, race, without};
use std::io;
use std::path::Path;
use std::time::Duration;

/// Which part of the progress is that of taking times, where they are taken.
const TIMING: f64 = 0.7;

/// Prints what there is to say of a scene.
pub fn run(
    path: &Path,
    arguments: &ExplainArguments,
    messages: &MessageArguments,
    terminal: &Terminal,
) -> Result<(), Failure> {
    must_be_a_scene(path)?;
    let mut clock = Clock::default();
    let source = clock.time("read", || input::read(path, terminal))?;
    let options = Options { quality: arguments.quality.preset, ..arguments.set.options(path)? };
    let facts = Options { facts: true, ..options.clone() };
    let compiled = sdfc::compile(&source.name, &source.text, &facts, &mut clock);
    terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
    shader(&compiled, terminal)?;
    let (scene, whole) = compiled.output.as_ref().expect("a scene without mistakes is a shader");

    let (width, height) = arguments.size;
    let frame = Frame { time: arguments.time, ..Frame::new(width, height) };
    let variants: Vec<Variant> = clock.time("compile without effects", || {
        left_out(&scene.effects)
            .into_iter()
            .map(|places| without(&source.name, &source.text, &options, places))
            .collect()
    });
    let shaders: Vec<&Shader> = [whole].into_iter().chain(variants.iter().map(|v| &v.shader)).collect();

    let progress = Progress::new("measuring");
    let timing = if arguments.no_time { 0.0 } else { TIMING };
    // First, since a device may be wanted that is not there.
    let raced = clock.time("time", || {
        let budget = Duration::from_secs_f64(arguments.budget);
        let show = |part| progress.show(part * timing);
        (!arguments.no_time).then(|| race(&shaders, &frame, &arguments.device, budget, &show)).transpose()
    });
    let raced = raced.map_err(|error| match error {
        DrawError::Device(message) => Failure::Device(message),
        DrawError::Shader(bug) => our_mistake(bug, &compiled, terminal),
    })?;
    let counted: Vec<Evaluations> = clock.time("count", || {
        let done = |i: usize, part: f64| {
            progress.show(timing + (i as f64 + part) / shaders.len() as f64 * (1.0 - timing));
        };
        let counts = shaders.iter().enumerate().map(|(i, s)| s.evaluations(&frame, |part| done(i, part)));
        counts.map(Evaluations::from).collect()
    });
    progress.end();
    if let Some(why) = raced.as_ref().and_then(|race| race.fallback.as_ref()) {
        terminal.note(&format!("timed on the CPU: {}", why.lines().next().unwrap_or_default()));
    }

    let mut effects: Vec<Explained> =
        scene.effects.iter().map(|effect| Explained::of(effect, &compiled.sources)).collect();
    let share = |i: usize| raced.as_ref().and_then(|race: &Race| race.laps[i].as_ref()).map(Share::of);
    // The whole scene stands before all, and what is left without all that is about light behind it.
    for (i, variant) in variants.iter().enumerate().skip(1) {
        let price =
            Price { evaluations: counted[0].more_than(counted[i + 1]), time: share(i + 1).map(Share::left) };
        effects[variant.left_out[0]].price = Some(price);
    }
    let explanation = Explanation {
        scene: source.name.clone(),
        size: arguments.size,
        time: arguments.time,
        quality: options.quality.map(Quality::word),
        set: options.set.iter().cloned().map(|(name, value)| Set { name, value }).collect(),
        evaluations: counted[0],
        operations: whole.cost.map,
        effects,
        rest: Remains { evaluations: counted[1], time: share(1) },
        timing: raced.as_ref().map(Timing::of),
        shapes: shapes(&scene.facts),
    };
    show(&explanation, arguments, messages)?;
    if arguments.timings {
        terminal.timings(&clock);
    }
    Ok(())
}

/// What is left out to be measured: first all effects that are about light, then each that is in by itself.
fn left_out(effects: &[Effect]) -> Vec<Vec<usize>> {
    let is_measured = |effect: &Effect| effect.is_in && effect.can_be_left_out;
    let places: Vec<usize> = (0..effects.len()).filter(|i| is_measured(&effects[*i])).collect();
    let all = places.iter().copied().filter(|i| !effects[*i].is_of_march).collect();
    [all].into_iter().chain(places.into_iter().map(|place| vec![place])).collect()
}

fn show(
    explanation: &Explanation,
    arguments: &ExplainArguments,
    messages: &MessageArguments,
) -> Result<(), Failure> {
    if arguments.json {
        let json = serde_json::to_string(explanation).expect("strings and numbers can be written");
        return print(format!("{json}\n").as_bytes());
    }
    let text = page(explanation);
    match messages.color_on(&io::stdout()) {
        ColorChoice::Never => print(strip_str(&text).to_string().as_bytes()),
        _ => print(text.as_bytes()),
    }
}

/// What is made from scenes is none.
fn must_be_a_scene(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let is_made = extension.eq_ignore_ascii_case("png") || TargetName::of_extension(extension).is_some();
    match is_made {
        true => Err(Failure::call(format!("{} is no scene", path.display()))
            .help("name the .sdf file that it was made from")),
        false => Ok(()),
    }
}
