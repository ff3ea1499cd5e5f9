//! What accuracy costs in time: a scene measured with several settings, each against the truth.
//!
//! The typical way is `Session::new → settings → Session::measure → Tradeoffs`. Times are taken of pictures on a device, in
//! rounds that take turns ([`race`](crate::race())). Errors, evaluations and steps are counted by the interpreter, which computes
//! what shaders compute, so they are the same on every machine. The truth is a picture in `f64`, by the march of the textbook
//! to the last digits and with shadows, occlusion and glow summed up by other rules than the renderer's; what the rays from the
//! eye meet is proved by the certifier, where that does not take too long ([`Truth::is_proved`]).

mod choose;
mod errors;
mod frontier;
mod measure;
mod settings;
mod truth;

pub use choose::Bounds;
pub use errors::Errors;
pub use frontier::{Point, frontier};
pub use measure::{Session, Stopwatch, Subject, compared};
pub use settings::{Knob, Setting, candidates, neighbours, settings, walk};
pub use truth::{NEAR, Truth};

use crate::draw::DrawError;
use sdf_syntax::Diagnostic;
use serde::Serialize;
use std::sync::Arc;
use std::time::Duration;

/// What came of measuring a scene.
#[derive(Debug, Clone)]
pub struct Tradeoffs {
    /// The size of the pictures that were compared with the truth, in pixels.
    pub size: (u32, u32),
    /// What drew them when times were taken, if they were.
    pub timing: Option<Timing>,
    /// What the picture truly is.
    pub truth: Arc<Truth>,
    /// Each setting with what it costs and how far off it is, in the order in which they were asked for.
    pub rows: Vec<Row>,
}

impl Tradeoffs {
    /// Without settings that change nothing in the program of an earlier one, unless they are presets.
    pub fn without_repetitions(mut self) -> Tradeoffs {
        self.rows.retain(|row| !row.is_again || row.setting.preset.is_some());
        self
    }
}

/// How times were taken.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Timing {
    /// What drew.
    pub device: String,
    /// Why it is not what was preferred, where that is so.
    pub fallback: Option<String>,
    /// By which clock.
    pub clock: &'static str,
    /// The size of the pictures that were timed, in pixels.
    pub size: (u32, u32),
    /// How often each was drawn.
    pub rounds: usize,
}

/// A setting, measured.
#[derive(Debug, Clone)]
pub struct Row {
    /// The setting.
    pub setting: Setting,
    /// Whether it means the same program as a setting before it.
    pub is_again: bool,
    /// The time of a picture, if there was time to take it.
    pub time: Option<Time>,
    /// How often a pixel evaluates the scene's field, in the mean.
    pub evaluations: f64,
    /// How many steps the ray from the eye takes, in the mean.
    pub steps: f64,
    /// How far from the truth it is.
    pub errors: Errors,
    /// Whether no setting that was measured is as fast and as exact, and better in one of both, of those that scenes can ask for
    /// and that have as many rays a pixel as the first.
    pub on_frontier: bool,
    /// The colours of the picture, red, green and blue in sRGB from 0 to 1, row by row from the top.
    pub colors: Vec<[f32; 3]>,
}

/// How long a picture takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Time {
    /// In the median.
    pub median: Duration,
    /// From the lower to the upper quartile.
    pub spread: Duration,
    /// By the clock on the wall, in the median.
    pub wall: Duration,
    /// As a multiple of what the first setting takes in the same round: the lower quartile, the median and the upper quartile.
    pub ratio: [f64; 3],
    /// The same as a multiple of what the setting before it takes that is another program.
    pub to_previous: [f64; 3],
}

/// Why a scene was not measured.
#[derive(Debug, Clone, PartialEq)]
pub enum MeasureError {
    /// The scene has mistakes; they are told when it is compiled.
    Scene(Vec<Diagnostic>),
    /// The pictures that were to be timed were not drawn.
    Draw(DrawError),
}

impl From<DrawError> for MeasureError {
    fn from(error: DrawError) -> MeasureError {
        MeasureError::Draw(error)
    }
}
