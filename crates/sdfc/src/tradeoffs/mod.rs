//! `sdfc cost scene.sdf`: what accuracy costs in time, measured.

mod axis;
mod data;
mod labels;
mod outputs;
mod page;
mod pictures;
mod plot;
#[cfg(test)]
mod sample;
mod web;

use crate::arguments::CostArguments;
use crate::compile::{our_mistake, shader};
use crate::failure::Failure;
use crate::input;
use crate::output::print;
use crate::progress::Progress;
use crate::terminal::Terminal;
use outputs::Outputs;
use sdfc::tradeoff::{MeasureError, Stopwatch, Subject, measure, settings};
use sdfc::{Clock, DrawError, Frame};
use std::time::Duration;

/// Measures a scene, and prints or writes what came of it.
pub fn run(arguments: &CostArguments, terminal: &Terminal) -> Result<(), Failure> {
    let outputs = Outputs::prepare(arguments)?;
    let mut clock = Clock::default();
    let source = clock.time("read", || input::read(&arguments.scene, terminal))?;
    let options = arguments.set.options(&arguments.scene)?;
    let compiled = sdfc::compile(&source.name, &source.text, &options, &mut clock);
    terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
    shader(&compiled, terminal)?;
    let (scene, _) = compiled.output.as_ref().expect("a scene without mistakes is a shader");

    let (width, height) = arguments.size;
    let frame = Frame { time: arguments.time, ..Frame::new(width, height) };
    let subject = Subject { name: &source.name, text: &source.text, options: &options };
    let stopwatch = Stopwatch {
        device: &arguments.device,
        frame: &frame,
        budget: Duration::from_secs_f64(arguments.budget),
    };
    let progress = Progress::new("measuring");
    let show = |part| progress.show(part);
    let wanted = settings(scene.accuracy, scene.slope);
    let measured = clock.time("measure", || {
        measure(&subject, &wanted, &frame, (!arguments.no_time).then_some(&stopwatch), &show)
    });
    progress.end();
    let measured = measured.map_err(|error| match error {
        MeasureError::Draw(DrawError::Device(message)) => Failure::Device(message),
        MeasureError::Draw(DrawError::Shader(bug)) => our_mistake(bug, &compiled, terminal),
        MeasureError::Scene(diagnostics) => {
            terminal.diagnostics(&compiled.sources, &diagnostics);
            Failure::Scene
        }
    })?;
    clock.time("write", || outputs.write(&source.name, arguments.time, &measured))?;
    if !outputs.has_standard_output() {
        print(page::page(&source.name, &measured).as_bytes())?;
    }
    if arguments.timings {
        terminal.timings(&clock);
    }
    Ok(())
}
