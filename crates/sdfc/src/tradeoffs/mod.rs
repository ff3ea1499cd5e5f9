//! `sdfc cost scene.sdf`: what accuracy costs in time, measured.

mod axis;
pub mod bounds;
mod data;
mod labels;
mod measuring;
mod outputs;
mod page;
mod pictures;
mod plot;
#[cfg(test)]
mod sample;
mod web;
mod why;

use crate::arguments::CostArguments;
use crate::compile::shader;
use crate::failure::Failure;
use crate::input;
use crate::output::print;
use crate::terminal::Terminal;
use measuring::{Measuring, Wanted};
use outputs::Outputs;
use sdfc::tradeoff::{Tradeoffs, candidates, compared, settings, walk};
use sdfc::{Clock, Frame, Options, Quality};

/// Measures a scene, and prints or writes what came of it.
pub fn run(arguments: &CostArguments, terminal: &Terminal) -> Result<(), Failure> {
    if arguments.no_time && arguments.bounds.max_time.is_some() {
        return Err(
            Failure::call("times cannot be bounded where none are taken").help("leave `--no-time` out")
        );
    }
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
    let bounds = arguments.bounds.bounds();
    let own = candidates(scene.accuracy);
    let chooses = arguments.why && arguments.bounds.are_any();
    let mut measuring = Measuring::new(Wanted {
        source: &source,
        options: &options,
        compiled: &compiled,
        frame: &frame,
        compared: match arguments.compare {
            Some((width, height)) => Frame { width, height, ..frame.clone() },
            None => compared(whole, &frame),
        },
        device: &arguments.device,
        budget: (!arguments.no_time).then_some(arguments.budget),
        near: bounds.error,
        times: if chooses { 2 } else { 1 },
    });
    let start = if chooses {
        let tried = measuring.measure(&own, terminal, &mut clock)?;
        let chosen = bounds.choose(&tried).map(|place| tried.rows[place].setting.clone());
        chosen.ok_or_else(|| bounds::none(&bounds, &tried))?
    } else {
        own[0].clone()
    };
    let wanted = if arguments.why {
        let exact = own.iter().find(|setting| setting.preset == Some(Quality::Exact));
        walk(&start, exact.expect("it is one of the candidates"))
    } else {
        settings(scene.accuracy, scene.slope)
    };
    let measured = measuring.measure(&wanted, terminal, &mut clock).map(Tradeoffs::without_repetitions)?;
    measuring.end();
    page::note_fallback(&measured, terminal);
    clock.time("write", || outputs.write(&source.name, arguments, &options, &measured))?;
    if !outputs.has_standard_output() {
        let text = if arguments.why {
            why::page(&source.name, &measured)
        } else {
            page::page(&source.name, &measured, bounds)
        };
        print(text.as_bytes())?;
    }
    if arguments.timings {
        terminal.timings(&clock);
    }
    Ok(())
}
