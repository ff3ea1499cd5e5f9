//! How long pictures take.
//!
//! A machine that others work on too is not still for a second. So the contestants take turns, each draws once a round,
//! ratios are those of one round, and what is told are medians. A software driver's time is what the process had of all
//! processors, which the driver's threads are part of; a [device that is chosen](crate::adapter) has a clock of its own.

use crate::adapter::{self, adapter};
use crate::march::Subject;
use rayon::prelude::*;
use rustix::time::{ClockId, clock_gettime};
use sdf_emit::{Header, Target, UniformLayout, emit};
use sdf_render::Frame;
use sdf_render::gpu::{GpuError, Prepared, Shader};
use std::time::{Duration, Instant};

/// How often a device that has a clock draws a picture in one round: enough that a round is long beside what its clock
/// and its power are late by.
const PASSES: u32 = 8;
/// How long a device that has a clock draws before it is timed, so that it is at its full rate.
const WARM: Duration = Duration::from_millis(300);

/// By which clock a picture is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// What the process had of all processors together.
    Processors,
    /// That of the device, in the mean of some pictures that follow each other.
    Device,
}

impl Clock {
    /// That of the device that the tests run on: its own where it is chosen.
    pub fn of_adapter() -> Clock {
        if adapter::is_chosen() { Clock::Device } else { Clock::Processors }
    }

    /// How tables call its times.
    pub fn title(self) -> String {
        match self {
            Clock::Processors => "all processors together".into(),
            Clock::Device => {
                format!("the device's own clock, for each of {PASSES} pictures that follow each other")
            }
        }
    }
}

/// The times of a contestant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// The time of a picture, in the median.
    pub time: Duration,
    /// The time as a multiple of the first contestant's in the same round, in the median.
    pub ratio: f64,
}

/// Draws each subject once a round, after a round for warming up, in which a driver compiles. The pictures are not read
/// back.
pub fn race(subjects: &[Subject], frame: &Frame, clock: Clock, rounds: usize) -> Vec<Times> {
    // Some drivers take seconds for a pipeline.
    let prepared: Vec<Prepared> = subjects.par_iter().map(|subject| prepared(subject, frame)).collect();
    let lap = |contestant: usize| -> f64 {
        let time = match clock {
            Clock::Processors => on_processors(&prepared[contestant], frame),
            Clock::Device => prepared[contestant].time(PASSES).map(|time| time.as_secs_f64()),
        };
        time.unwrap_or_else(|error| panic!("{}: {error}", subjects[contestant].march))
    };
    let start = Instant::now();
    loop {
        for contestant in 0..subjects.len() {
            lap(contestant);
        }
        if clock == Clock::Processors || start.elapsed() >= WARM {
            break;
        }
    }
    let mut laps = vec![Vec::with_capacity(rounds); subjects.len()];
    for round in 0..rounds {
        // Nobody is always the one after the same other.
        for i in 0..subjects.len() {
            let contestant = if round % 2 == 0 { i } else { subjects.len() - 1 - i };
            laps[contestant].push(lap(contestant));
        }
    }
    let times = |own: &Vec<f64>| Times {
        time: Duration::from_secs_f64(median(own.clone())),
        ratio: median(own.iter().zip(&laps[0]).map(|(a, b)| a / b).collect()),
    };
    laps.iter().map(times).collect()
}

fn prepared(subject: &Subject, frame: &Frame) -> Prepared<'static> {
    let text =
        emit(&subject.program, Target::Wgsl, &Header::default()).unwrap_or_else(|error| panic!("{error}"));
    let size = [frame.width, frame.height];
    let uniforms = UniformLayout::of(&subject.program).bytes(size, &frame.uniforms(&subject.program));
    adapter().prepare(Shader::Wgsl(&text), size, &uniforms).unwrap_or_else(|error| panic!("{error}"))
}

/// How long a picture takes on all processors together, in seconds.
fn on_processors(prepared: &Prepared, frame: &Frame) -> Result<f64, GpuError> {
    let before = spent();
    prepared.draw(frame.width.max(frame.height), &mut |_, _| {})?;
    Ok(spent() - before)
}

/// How long this process has had processors so far, in seconds.
pub fn spent() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}
