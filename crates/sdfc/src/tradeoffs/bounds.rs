//! `--max-error` and `--max-time`: the cheapest setting that satisfies them, measured for the scene on the device.

use super::measuring::{self, Measuring};
use super::page::proof;
use super::why::digits;
use super::{page, why};
use crate::arguments::BoundArguments;
use crate::failure::Failure;
use crate::input;
use crate::terminal::Terminal;
use sdfc::tradeoff::{Bounds, Row, Setting, Timing, Tradeoffs, candidates, compared, neighbours};
use sdfc::{Clock, Device, Frame, Options};

/// For how long pictures are timed where nobody says, in seconds.
const BUDGET: f64 = 10.0;

/// How many rounds of times there must be for their differences to be written into texts.
const ROUNDS: usize = 8;

/// A setting that was chosen for a scene.
pub struct Chosen {
    /// The setting, measured.
    pub row: Row,
    /// What other values of the constants that texts name cost and buy, if that was asked for.
    pub figures: Option<Figures>,
}

/// What other values of the constants that texts name cost and buy.
pub struct Figures {
    /// How that was measured, as lines.
    pub head: Vec<String>,
    /// The names of settings, each with its lines.
    pub lines: Vec<(String, Vec<String>)>,
}

/// The scene, how its pictures are compiled, the picture that bounds are about, and whether other values of the constants are
/// asked for.
pub struct Wanted<'a> {
    pub figures: bool,
    pub source: &'a input::Scene,
    pub options: &'a Options,
    pub frame: &'a Frame,
    pub device: &'a Device,
}

/// Chooses a setting, and says which; nothing where there is no bound. The scene has no mistakes.
pub fn choose(
    arguments: &BoundArguments,
    budget: Option<f64>,
    wanted: &Wanted,
    terminal: &Terminal,
    clock: &mut Clock,
) -> Result<Option<Chosen>, Failure> {
    if !arguments.are_any() {
        return match budget {
            None => Ok(None),
            Some(_) => Err(Failure::call("`--budget` is the time for which a setting is looked for")
                .help("add `--max-error 0.5px` or `--max-time 16ms`")),
        };
    }
    let bounds = arguments.bounds();
    if wanted.options.quality.is_some() {
        return Err(
            Failure::call("`--quality` and bounds both choose a setting").help("leave one of them out")
        );
    }
    let Wanted { source, options, frame, device, figures } = *wanted;
    let compiled = sdfc::compile(&source.name, &source.text, options, clock);
    let (scene, shader) = compiled.output.as_ref().expect("the scene has no mistakes");
    let mut measuring = Measuring::new(measuring::Wanted {
        source,
        options,
        compiled: &compiled,
        frame,
        compared: compared(shader, frame),
        device,
        budget: Some(budget.unwrap_or(BUDGET)),
        near: bounds.error,
        times: if figures { 2 } else { 1 },
    });
    let measured = measuring.measure(&candidates(scene.accuracy), terminal, clock)?;
    if bounds.time.is_some() {
        must_be_of_size(&measured, frame)?;
    }
    let place = bounds.choose(&measured).ok_or_else(|| none(&bounds, &measured))?;
    let row = measured.rows[place].clone();
    let figures = if figures {
        let (settings, values): (Vec<Setting>, Vec<_>) = neighbours(&row.setting).into_iter().unzip();
        let beside = measuring.measure(&settings, terminal, clock)?;
        Some(Figures { head: head(&beside), lines: lines(&beside, &values) })
    } else {
        None
    };
    measuring.end();
    page::note_fallback(&measured, terminal);
    terminal.note(&said(&row, &measured));
    Ok(Some(Chosen { row, figures }))
}

/// A time is bounded for a picture of one size. The interpreter times smaller ones where it has too little time.
fn must_be_of_size(measured: &Tradeoffs, frame: &Frame) -> Result<(), Failure> {
    match &measured.timing {
        Some(timing) if timing.size != (frame.width, frame.height) => Err(Failure::call(format!(
            "a picture of {}x{} takes the CPU too long to be timed",
            frame.width, frame.height
        ))
        .help("give it more time, such as `--budget 60`, or a smaller `--size`")),
        _ => Ok(()),
    }
}

/// How the figures below constants were measured.
fn head(measured: &Tradeoffs) -> Vec<String> {
    let (width, height) = measured.size;
    let timing = measured.timing.as_ref().expect("bounds are measured with times");
    vec![
        format!(
            "Below constants: what other values cost and buy. Times are of {}, {} rounds;",
            timed(timing),
            timing.rounds
        ),
        format!(
            "errors of {width}x{height}: of 99.9 % of the depths and 99 % of the normals at most; rms is of 255."
        ),
    ]
}

/// What was timed, and on what.
fn timed(timing: &Timing) -> String {
    format!("{}x{} on {}", timing.size.0, timing.size.1, timing.device)
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
        // A few rounds tell little of times.
        let rounds = measured.timing.as_ref().map_or(0, |timing| timing.rounds);
        let ratio = row.time.filter(|_| rounds >= ROUNDS).map(|time| time.ratio);
        let line = format!(
            "  with {value} instead: {}, {}",
            why::cost(own, row, ratio),
            why::bought(&own.errors, &row.errors)
        );
        // Comments of shaders are ASCII.
        let line = line.replace('→', "->").replace('±', "+-").replace('°', " degrees");
        match all.iter_mut().find(|(other, _)| other == name) {
            Some((_, lines)) => lines.push(line),
            None => all.push(((*name).to_string(), vec![line])),
        }
    }
    all
}

/// What was chosen.
fn said(row: &Row, measured: &Tradeoffs) -> String {
    let untimed = match measured.rows.iter().filter(|row| row.time.is_none()).count() {
        0 => String::new(),
        n => format!("\n{n} settings were not timed: `--budget` gives more time"),
    };
    let (width, height) = measured.size;
    format!(
        "chosen: `{}`, {}\nerrors are of {width}x{height} pixels; {}{untimed}\n{}",
        row.setting.name,
        figures(row, measured),
        proof(&measured.truth),
        row.setting.accuracy
    )
}

/// What a setting takes, and how far off it is.
fn figures(row: &Row, measured: &Tradeoffs) -> String {
    let time = match (row.time, &measured.timing) {
        (Some(time), Some(timing)) => {
            format!("{} ms for {}", digits(time.wall.as_secs_f64() * 1e3), timed(timing))
        }
        _ => format!("{} evaluations a pixel", digits(row.evaluations)),
    };
    let errors = &row.errors;
    let lost = match errors.out_of_steps {
        0 => String::new(),
        n => format!(", {n} rays out of steps"),
    };
    format!(
        "{time}, largest depth error {} px, {} false hits, {} false misses{lost}, rms {} of 255",
        digits(errors.depth[2]),
        errors.false_hits,
        errors.false_misses,
        digits(errors.rms)
    )
}

/// Nothing that was measured satisfies the bounds.
pub(super) fn none(bounds: &Bounds, measured: &Tradeoffs) -> Failure {
    let wall = |row: &Row| row.time.map(|time| time.wall);
    let fastest = measured.rows.iter().filter(|row| row.time.is_some()).min_by_key(|row| wall(row));
    let nearest = measured.rows.iter().min_by(|a, b| {
        let wrong = |row: &Row| (row.errors.false_hits + row.errors.false_misses, row.errors.depth[2]);
        wrong(a).partial_cmp(&wrong(b)).unwrap_or(std::cmp::Ordering::Equal)
    });
    let is_untimed = measured.timing.is_some() && measured.rows.iter().any(|row| row.time.is_none());
    let (closest, help) = match (bounds.error, bounds.time) {
        (_, _) if is_untimed => {
            (nearest, "not all settings were timed: give more time, such as `--budget 60`")
        }
        (_, None) => (nearest, "allow a larger error"),
        (None, Some(_)) => {
            (fastest, "allow more time, or draw fewer pixels; `sdfc explain` says what takes the time")
        }
        (Some(_), Some(_)) => (nearest, "allow a larger error or more time"),
    };
    let closest = closest.map_or(String::new(), |row| {
        format!("; the closest is `{}`: {}", row.setting.name, figures(row, measured))
    });
    Failure::call(format!("no setting satisfies the bounds{closest}")).help(help)
}
