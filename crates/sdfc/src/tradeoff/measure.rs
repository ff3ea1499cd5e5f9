//! A scene with several settings: timed, counted, and compared with the truth.

use super::errors::{Errors, Made};
use super::settings::{MOVE, Setting};
use super::truth::{Oracle, Truth};
use super::{MeasureError, Row, Time, Timing, Tradeoffs, frontier};
use crate::{Clock, Device, Options, Progress, Scene, Shader, compile, race};
use sdf_ir::eval::Counts;
use sdf_lang::Accuracy;
use sdf_render::Frame;
use sdf_render::certify::found;
use sdf_render::columns::{Columns, coordinates};
use std::time::Duration;

/// A scene to be measured.
#[derive(Debug, Clone, Copy)]
pub struct Subject<'a> {
    /// What messages call it.
    pub name: &'a str,
    /// Its text.
    pub text: &'a str,
    /// How it is compiled, whatever the setting.
    pub options: &'a Options,
}

/// How pictures are timed.
#[derive(Debug, Clone)]
pub struct Stopwatch<'a> {
    /// What draws them.
    pub device: &'a Device,
    /// The pictures that are timed.
    pub frame: &'a Frame,
    /// For about how long.
    pub budget: Duration,
}

/// A scene, compiled with a setting.
struct Compiled {
    setting: Setting,
    scene: Scene,
    shader: Shader,
}

impl Subject<'_> {
    /// The scene with its own settings: what they are, and how steep its field is.
    pub fn own(&self) -> Result<(Accuracy, f64), MeasureError> {
        let scene = self.compile(None)?.0;
        Ok((scene.accuracy, scene.slope))
    }

    fn compile(&self, accuracy: Option<Accuracy>) -> Result<(Scene, Shader), MeasureError> {
        let options =
            Options { accuracy, probe: true, attack: Some(0), facts: false, ..self.options.clone() };
        let compiled = compile(self.name, self.text, &options, &mut Clock::default());
        compiled.output.ok_or(MeasureError::Scene(compiled.diagnostics))
    }
}

/// Measures a scene with these settings, the first being its own. Of settings that change nothing in the program of an earlier
/// one only presets are kept. Without a stopwatch no times are taken.
pub fn measure(
    subject: &Subject,
    settings: &[Setting],
    frame: &Frame,
    stopwatch: Option<&Stopwatch>,
    progress: Progress,
) -> Result<Tradeoffs, MeasureError> {
    let mut compiled: Vec<Compiled> = Vec::new();
    // For each row the place of what is compiled.
    let mut rows: Vec<(Setting, usize)> = Vec::new();
    for setting in settings {
        let (scene, shader) = subject.compile(Some(setting.accuracy))?;
        match compiled.iter().position(|other| other.shader.program == shader.program) {
            Some(_) if setting.preset.is_none() => {}
            Some(same) => rows.push((setting.clone(), same)),
            None => {
                rows.push((setting.clone(), compiled.len()));
                compiled.push(Compiled { setting: setting.clone(), scene, shader });
            }
        }
    }
    let shaders: Vec<&Shader> = compiled.iter().map(|c| &c.shader).collect();
    // First, since a device may be wanted that is not there.
    let timing = if stopwatch.is_some() { 0.4 } else { 0.0 };
    let raced = stopwatch.map(|watch| {
        race(&shaders, watch.frame, watch.device, watch.budget, &|part| progress(part * timing))
    });
    let raced = raced.transpose()?;

    let oracle = Oracle::new(subject.name, subject.text, subject.options, frame)?;
    let mut grids: Vec<u32> =
        compiled.iter().map(|c| c.setting.accuracy.antialias).filter(|n| *n > 1).collect();
    grids.sort_unstable();
    grids.dedup();
    let part =
        |from: f64, to: f64, part: f64| progress(timing + (1.0 - timing) * (from + (to - from) * part));
    let truth = oracle.truth(frame, &grids, &|done| part(0.0, 0.4, done));
    let measured: Vec<Measured> = compiled
        .iter()
        .enumerate()
        .map(|(i, c)| {
            part(0.4, 1.0, i as f64 / compiled.len() as f64);
            Measured::of(c, frame, &truth, &oracle)
        })
        .collect();

    let time = |i: usize| {
        let lap = raced.as_ref().and_then(|race| race.laps[i])?;
        Some(Time { median: lap.time, spread: lap.spread, ratio: lap.ratio })
    };
    let own_side = compiled.first().map_or(1, |c| c.setting.accuracy.antialias);
    let points: Vec<(Option<f64>, f64)> = compiled
        .iter()
        .enumerate()
        .map(|(i, c)| {
            // More rays are another picture.
            let comparable = c.setting.accuracy.antialias == own_side;
            (time(i).filter(|_| comparable).map(|t| t.median.as_secs_f64()), measured[i].errors.rms)
        })
        .collect();
    let on_frontier = frontier(&points);
    let rows = rows.into_iter().map(|(setting, i)| Row {
        setting,
        time: time(i),
        evaluations: measured[i].evaluations,
        steps: measured[i].steps,
        errors: measured[i].errors,
        on_frontier: on_frontier[i],
        colors: measured[i].colors.clone(),
    });
    let rows = rows.collect();
    let timing = raced.map(|race| Timing {
        device: race.device,
        fallback: race.fallback,
        clock: race.clock,
        size: race.size,
        rounds: race.rounds,
    });
    Ok(Tradeoffs { size: (frame.width, frame.height), timing, truth, rows })
}

/// What is counted and compared of a setting.
struct Measured {
    evaluations: f64,
    steps: f64,
    errors: Errors,
    colors: Vec<[f32; 3]>,
}

impl Measured {
    fn of(compiled: &Compiled, frame: &Frame, truth: &Truth, oracle: &Oracle) -> Measured {
        let probe =
            Columns::of_shader(&compiled.scene.program, compiled.scene.probe.expect("it was asked for"));
        let (columns, _) = probe.at::<f32>(frame, &coordinates(frame, [0.0; 2]), &|_| {});
        let steps = &columns[probe.place("steps")];
        let (colors, counts) = drawn(&compiled.shader, frame, [0.0; 2]);
        let (moved, _) = drawn(&compiled.shader, frame, MOVE);
        let made = Made {
            found: &found(&probe, &columns),
            colors: &colors,
            moved: &moved,
            antialias: compiled.setting.accuracy.antialias,
        };
        let pixels = colors.len().max(1) as f64;
        Measured {
            evaluations: counts.evaluations as f64 / pixels,
            steps: steps.iter().map(|steps| f64::from(*steps)).sum::<f64>() / pixels,
            errors: Errors::of(&made, truth, oracle),
            colors,
        }
    }
}

/// The colours of a picture, in sRGB from 0 to 1, and what was evaluated for it.
fn drawn(shader: &Shader, frame: &Frame, shift: [f64; 2]) -> (Vec<[f32; 3]>, Counts) {
    let entry = shader.program.entry.expect("a shader has an entry");
    let pixel = Columns::as_it_is(&shader.program, entry);
    let (columns, counts) = pixel.at::<f32>(frame, &coordinates(frame, shift), &|_| {});
    let color = |i: usize| [0, 1, 2].map(|k| columns[k][i].clamp(0.0, 1.0));
    ((0..columns[0].len()).map(color).collect(), counts)
}
