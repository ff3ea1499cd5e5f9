//! `--max-error` and `--max-time`: the cheapest setting that satisfies them, measured for the scene on the device.

use super::why::digits;
use super::{failed, page, why};
use crate::arguments::BoundArguments;
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;
use crate::terminal::Terminal;
use sdfc::tradeoff::{
    Bounds, NEAR, Row, Session, Setting, Stopwatch, Subject, Tradeoffs, candidates, compared, neighbours,
};
use sdfc::{Clock, Compiled, Device, Frame, Options};
use std::time::Duration;

/// For how long pictures are timed where nobody says, in seconds.
const BUDGET: f64 = 10.0;

/// A setting that was chosen for a scene, with all that it was chosen from.
pub struct Chosen {
    /// All that was measured.
    pub measured: Tradeoffs,
    /// The place of the setting among those.
    pub place: usize,
    /// What other values of the constants that texts name cost and buy, as lines for each of them, if that was asked for.
    pub figures: Vec<(String, Vec<String>)>,
}

impl Chosen {
    /// The setting, measured.
    pub fn row(&self) -> &Row {
        &self.measured.rows[self.place]
    }
}

/// The scene, how it is compiled, the picture that bounds are about, and whether other values of the constants are asked for.
pub struct Wanted<'a> {
    pub figures: bool,
    pub source: &'a input::Scene,
    pub options: &'a Options,
    pub compiled: &'a Compiled,
    pub frame: &'a Frame,
    pub device: &'a Device,
}

/// Chooses a setting, and says which; nothing where there is no bound.
pub fn choose(
    arguments: &BoundArguments,
    wanted: &Wanted,
    terminal: &Terminal,
    clock: &mut Clock,
) -> Result<Option<Chosen>, Failure> {
    let bounds = arguments.bounds();
    if !arguments.are_any() {
        return Ok(None);
    }
    let Wanted { source, options, compiled, frame, device, figures } = wanted;
    let (scene, shader) = compiled.output.as_ref().expect("a scene without mistakes is a shader");
    let subject = Subject { name: &source.name, text: &source.text, options };
    let session = Session::new(subject, compared(shader, frame), bounds.error.unwrap_or(NEAR));
    let times = if *figures { 2.0 } else { 1.0 };
    let budget = Duration::from_secs_f64(arguments.budget.unwrap_or(BUDGET) / times);
    let stopwatch = Stopwatch { device, frame, budget };
    let progress = Progress::new("measuring");
    let mut measure = |settings: &[Setting], from: f64| {
        let show = |part: f64| progress.show(from + part / times);
        let measured = session.measure(settings, Some(&stopwatch), &show, clock);
        measured.map_err(|error| failed(error, compiled, terminal))
    };
    let measured = measure(&candidates(scene.accuracy), 0.0)?;
    let Some(chosen) = bounds.choose(&measured) else { return Err(none(&bounds, &measured)) };
    let place = measured.rows.iter().position(|row| std::ptr::eq(row, chosen)).unwrap_or(0);
    let figures = if *figures {
        let (settings, values): (Vec<Setting>, Vec<_>) = neighbours(&chosen.setting).into_iter().unzip();
        lines(&measure(&settings, 0.5)?, &values)
    } else {
        Vec::new()
    };
    progress.end();
    page::note_fallback(&measured, terminal);
    terminal.note(&said(chosen, frame));
    Ok(Some(Chosen { measured, place, figures }))
}

/// What other values of the constants of a text cost and buy beside the first setting, as lines for each constant.
fn lines(measured: &Tradeoffs, values: &[Option<(&'static str, String)>]) -> Vec<(String, Vec<String>)> {
    let mut all: Vec<(String, Vec<String>)> = Vec::new();
    let own = &measured.rows[0];
    for (row, value) in measured.rows.iter().zip(values) {
        let Some((name, value)) = value else { continue };
        // What nothing asks for is no constant of the text.
        if row.is_again {
            continue;
        }
        let line = format!(
            "  with {value} instead: {}, {}",
            why::cost(own, row),
            why::bought(&own.errors, &row.errors)
        );
        // Comments of shaders are ASCII.
        let line = line.replace('→', "to").replace('±', "+-").replace('°', " degrees");
        match all.iter_mut().find(|(other, _)| other == name) {
            Some((_, lines)) => lines.push(line),
            None => all.push(((*name).to_string(), vec![line])),
        }
    }
    all
}

/// What was chosen.
fn said(row: &Row, frame: &Frame) -> String {
    format!("chosen: `{}`, {}\n{}", row.setting.name, figures(row, frame), row.setting.accuracy)
}

/// What a setting takes, and how far off it is.
fn figures(row: &Row, frame: &Frame) -> String {
    let time = row.time.map_or("no time".into(), |time| {
        format!("{} ms at {}x{}", digits(time.median.as_secs_f64() * 1e3), frame.width, frame.height)
    });
    let errors = &row.errors;
    format!(
        "{time}, hits off by up to {} px, {} false hits, {} false misses, rms {} of 255",
        digits(errors.depth[2]),
        errors.false_hits,
        errors.false_misses,
        digits(errors.rms)
    )
}

/// Nothing that was measured satisfies the bounds.
pub(super) fn none(bounds: &Bounds, measured: &Tradeoffs) -> Failure {
    let (width, height) = measured.timing.as_ref().map_or(measured.size, |timing| timing.size);
    let frame = Frame::new(width, height);
    let fastest =
        measured.rows.iter().filter(|row| row.time.is_some()).min_by_key(|row| row.time.map(|t| t.median));
    let nearest = measured.rows.iter().min_by(|a, b| {
        let wrong = |row: &Row| (row.errors.false_hits + row.errors.false_misses, row.errors.depth[2]);
        wrong(a).partial_cmp(&wrong(b)).unwrap_or(std::cmp::Ordering::Equal)
    });
    let (closest, help) = match (bounds.error, bounds.time) {
        (_, None) => (nearest, "allow a larger error"),
        (None, Some(_)) => {
            (fastest, "allow more time, or draw fewer pixels; `sdfc explain` says what takes the time")
        }
        (Some(_), Some(_)) => (nearest, "allow a larger error or more time"),
    };
    let closest = closest.map_or(String::new(), |row| {
        format!("; the closest is `{}`: {}", row.setting.name, figures(row, &frame))
    });
    Failure::call(format!("no setting satisfies the bounds{closest}")).help(help)
}
