//! `sdfc cost scene.sdf`: what accuracy costs in time, measured.

mod axis;
pub mod bounds;
mod data;
mod labels;
mod outputs;
mod page;
mod pictures;
mod plot;
#[cfg(test)]
mod sample;
mod web;
mod why;

use crate::arguments::CostArguments;
use crate::compile::{our_mistake, shader};
use crate::failure::Failure;
use crate::input;
use crate::output::print;
use crate::progress::Progress;
use crate::terminal::Terminal;
use outputs::Outputs;
use sdfc::tradeoff::{
    Bounds, MeasureError, NEAR, Session, Setting, Stopwatch, Subject, Tradeoffs, candidates, compared,
    settings, walk,
};
use sdfc::{Clock, Compiled, DrawError, Frame, Options, Quality};
use std::time::Duration;

/// Measures a scene, and prints or writes what came of it.
pub fn run(arguments: &CostArguments, terminal: &Terminal) -> Result<(), Failure> {
    let outputs = Outputs::prepare(arguments)?;
    let mut clock = Clock::default();
    let source = clock.time("read", || input::read(&arguments.scene, terminal))?;
    let options = Options { quality: arguments.quality.preset, ..arguments.set.options(&arguments.scene)? };
    let compiled = sdfc::compile(&source.name, &source.text, &options, &mut clock);
    terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
    shader(&compiled, terminal)?;
    let (scene, whole) = compiled.output.as_ref().expect("a scene without mistakes is a shader");

    let (width, height) = arguments.size;
    let frame = Frame { time: arguments.time, ..Frame::new(width, height) };
    let subject = Subject { name: &source.name, text: &source.text, options: &options };
    let bounds = Bounds { error: arguments.max_error, time: arguments.max_time };
    let compared = match arguments.compare {
        Some((width, height)) => Frame { width, height, ..frame.clone() },
        None => compared(whole, &frame),
    };
    let session = Session::new(subject, compared, bounds.error.unwrap_or(NEAR));
    let has_bounds = bounds != Bounds::default();
    let rounds = if arguments.why && has_bounds { 2.0 } else { 1.0 };
    let stopwatch = Stopwatch {
        device: &arguments.device,
        frame: &frame,
        budget: Duration::from_secs_f64(arguments.budget / rounds),
    };
    let progress = Progress::new("measuring");
    let mut measure = |settings: &[Setting], [from, to]: [f64; 2]| {
        let show = |part: f64| progress.show(from + (to - from) * part);
        let watch = (!arguments.no_time).then_some(&stopwatch);
        session
            .measure(settings, watch, &show, &mut clock)
            .map(Tradeoffs::without_repetitions)
            .map_err(|error| failed(error, &compiled, terminal))
    };
    let text;
    let measured;
    if arguments.why {
        let own = candidates(scene.accuracy);
        let start = if has_bounds {
            let tried = measure(&own, [0.0, 0.5])?;
            let chosen = bounds.choose(&tried).map(|row| row.setting.clone());
            chosen.ok_or_else(|| bounds::none(&bounds, &tried))?
        } else {
            own[0].clone()
        };
        let exact = own.iter().find(|setting| setting.preset == Some(Quality::Exact));
        let way = walk(&start, exact.expect("it is one of the candidates"));
        measured = measure(&way, [rounds / 2.0 - 0.5, 1.0])?;
        text = why::page(&source.name, &measured);
    } else {
        measured = measure(&settings(scene.accuracy, scene.slope), [0.0, 1.0])?;
        text = page::page(&source.name, &measured, bounds);
    }
    progress.end();
    page::note_fallback(&measured, terminal);
    clock.time("write", || outputs.write(&source.name, arguments.time, &measured))?;
    if !outputs.has_standard_output() {
        print(text.as_bytes())?;
    }
    if arguments.timings {
        terminal.timings(&clock);
    }
    Ok(())
}

/// Why a scene was not measured.
fn failed(error: MeasureError, compiled: &Compiled, terminal: &Terminal) -> Failure {
    match error {
        MeasureError::Draw(DrawError::Device(message)) => Failure::Device(message),
        MeasureError::Draw(DrawError::Shader(bug)) => our_mistake(bug, compiled, terminal),
        MeasureError::Scene(diagnostics) => {
            terminal.diagnostics(&compiled.sources, &diagnostics);
            Failure::Scene
        }
    }
}
