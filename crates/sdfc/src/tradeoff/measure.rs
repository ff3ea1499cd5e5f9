//! A scene with several settings: timed, counted, and compared with the truth.

use super::errors::{Errors, Made};
use super::settings::{MOVE, Setting};
use super::truth::{Oracle, Truth};
use super::{MeasureError, Point, Row, Time, Timing, Tradeoffs, frontier};
use crate::race::{ENOUGH, Limits, race_of};
use crate::{Clock, Device, Options, Progress, Scene, Shader, compile};
use rayon::prelude::*;
use sdf_ir::eval::Counts;
use sdf_lang::Accuracy;
use sdf_render::Frame;
use sdf_render::certify::found;
use sdf_render::columns::{Columns, coordinates};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

/// How many operations of the field a picture may take that many settings are compared in: an evaluation's, times the evaluations
/// of all its pixels.
const OPERATIONS: f64 = 2.2e8;
/// The most pixels of such a picture.
const MOST_PIXELS: f64 = 320.0 * 180.0;
/// The smallest side of a picture in which settings are compared, unless that which is timed is smaller.
const LEAST_SIDE: u32 = 16;

/// Which part of the progress is that of taking times, where they are taken.
const TIMING: f64 = 0.5;

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

/// The picture in which settings are compared with the truth: that of a frame, or a smaller one of the same form if the
/// interpreter would take minutes for it. It depends on the scene alone, not on the machine.
pub fn compared(shader: &Shader, frame: &Frame) -> Frame {
    let scaled = |scale: f64| {
        let side = |side: u32| ((f64::from(side) * scale).round() as u32).max(side.min(LEAST_SIDE));
        Frame { width: side(frame.width), height: side(frame.height), ..frame.clone() }
    };
    let evaluations = shader.evaluations(&scaled(0.1), |_| {}).mean;
    let pixels = f64::from(frame.width) * f64::from(frame.height);
    let work = evaluations * shader.cost.map as f64 * pixels;
    // No scene is so small that pixels do not count.
    let scale = (OPERATIONS / work).min(MOST_PIXELS / pixels).sqrt();
    if scale < 1.0 { scaled(scale) } else { frame.clone() }
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
    /// After how many rounds that ends before, where something else is asked for than the usual number.
    pub enough: Option<usize>,
}

/// A scene, compiled with a setting.
struct Compiled {
    setting: Setting,
    scene: Scene,
    shader: Shader,
}

impl Subject<'_> {
    fn compile(&self, accuracy: Option<Accuracy>) -> Result<(Scene, Shader), MeasureError> {
        let options =
            Options { accuracy, probe: true, attack: Some(0), facts: false, ..self.options.clone() };
        let compiled = compile(self.name, self.text, &options, &mut Clock::default());
        compiled.output.ok_or(MeasureError::Scene(compiled.diagnostics))
    }
}

/// A scene at one moment, with its truth, which is found when it is first asked for.
pub struct Session<'a> {
    subject: Subject<'a>,
    frame: Frame,
    near: f64,
    known: RefCell<Option<(Rc<Oracle>, Arc<Truth>)>>,
}

impl<'a> Session<'a> {
    /// For pictures of a frame. A hit of what the ray does not meet is false where no surface is within `near` pixels.
    pub fn new(subject: Subject<'a>, frame: Frame, near: f64) -> Session<'a> {
        Session { subject, frame, near, known: RefCell::default() }
    }

    /// Measures the scene with these settings; ratios of times are to the first. Those that mean the same program are measured
    /// once. Without a stopwatch no times are taken. There is at least one setting.
    pub fn measure(
        &self,
        settings: &[Setting],
        stopwatch: Option<&Stopwatch>,
        progress: Progress,
        clock: &mut Clock,
    ) -> Result<Tradeoffs, MeasureError> {
        let (compiled, places) = clock.time("compile the settings", || self.compile(settings))?;
        let shaders: Vec<&Shader> = compiled.iter().map(|c| &c.shader).collect();
        // First, since a device may be wanted that is not there.
        let timing = if stopwatch.is_some() { TIMING } else { 0.0 };
        let raced = clock.time("time", || {
            let show = |part| progress(part * timing);
            let race = |watch: &Stopwatch| {
                let limits = Limits { budget: watch.budget, enough: watch.enough.unwrap_or(ENOUGH) };
                race_of(&shaders, watch.frame, watch.device, limits, &show)
            };
            stopwatch.map(race).transpose()
        })?;
        let show = |part: f64| progress(timing + (1.0 - timing) * part);
        let (oracle, truth) =
            clock.time("find the truth", || self.known(&compiled, &|part| show(0.4 * part)))?;
        let measured: Vec<Measured> = clock.time("count and compare", || {
            let each = compiled.iter().enumerate().map(|(i, c)| {
                show(0.4 + 0.6 * i as f64 / compiled.len() as f64);
                Measured::of(c, &self.frame, &truth, &oracle)
            });
            each.collect()
        });
        let time = |i: usize| {
            let lap = raced.as_ref().and_then(|race| race.laps[i])?;
            Some(Time {
                median: lap.time,
                spread: lap.spread,
                wall: lap.wall,
                ratio: lap.ratio,
                to_previous: lap.to_previous,
            })
        };
        let own = &compiled[0].setting;
        let point = |i: usize| {
            let time = time(i).filter(|_| compiled[i].setting.is_like(own))?;
            Some(Point {
                time: [time.median, time.spread].map(|time| time.as_secs_f64()),
                error: measured[i].errors.rms,
                evaluations: measured[i].evaluations,
            })
        };
        let on_frontier = frontier(&(0..compiled.len()).map(point).collect::<Vec<_>>());
        let rows = settings.iter().zip(places).map(|(setting, i)| Row {
            setting: setting.clone(),
            is_again: compiled[i].setting != *setting,
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
        Ok(Tradeoffs { size: (self.frame.width, self.frame.height), timing, truth, rows })
    }

    /// The scene with all settings that differ, and of each setting where it is among them.
    fn compile(&self, settings: &[Setting]) -> Result<(Vec<Compiled>, Vec<usize>), MeasureError> {
        let subject = self.subject;
        let all: Vec<(Scene, Shader)> = settings
            .par_iter()
            .map(|setting| subject.compile(Some(setting.accuracy)))
            .collect::<Result<_, _>>()?;
        let (mut compiled, mut places): (Vec<Compiled>, Vec<usize>) = (Vec::new(), Vec::new());
        for (setting, (scene, shader)) in settings.iter().zip(all) {
            let same = compiled.iter().position(|other| other.shader.program == shader.program);
            places.push(same.unwrap_or(compiled.len()));
            if same.is_none() {
                compiled.push(Compiled { setting: setting.clone(), scene, shader });
            }
        }
        Ok((compiled, places))
    }

    /// The truth, and what answers questions about it.
    fn known(
        &self,
        compiled: &[Compiled],
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(Rc<Oracle>, Arc<Truth>), MeasureError> {
        let mut sides: Vec<u32> = compiled.iter().map(|c| c.setting.accuracy.antialias).collect();
        let mut known = self.known.borrow_mut();
        if let Some((oracle, truth)) = &*known {
            if sides.iter().all(|side| truth.has_grid(*side)) {
                return Ok((oracle.clone(), truth.clone()));
            }
            sides.extend(truth.grids.iter().map(|grid| grid.side));
        }
        sides.sort_unstable();
        sides.dedup();
        sides.retain(|side| *side > 1);
        let Subject { name, text, options } = self.subject;
        let oracle = Oracle::new(name, text, options, &self.frame, self.near)?;
        let truth = Arc::new(oracle.truth(&self.frame, &sides, progress));
        Ok(known.insert((Rc::new(oracle), truth)).clone())
    }
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
        let entry = compiled.shader.program.entry.expect("a shader has an entry");
        let pixel = Columns::as_it_is(&compiled.shader.program, entry);
        let (colors, counts) = drawn(&pixel, frame, [0.0; 2]);
        let (moved, _) = drawn(&pixel, frame, MOVE);
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
fn drawn(pixel: &Columns, frame: &Frame, shift: [f64; 2]) -> (Vec<[f32; 3]>, Counts) {
    let (columns, counts) = pixel.at::<f32>(frame, &coordinates(frame, shift), &|_| {});
    let color = |i: usize| [0, 1, 2].map(|k| columns[k][i].clamp(0.0, 1.0));
    ((0..columns[0].len()).map(color).collect(), counts)
}
