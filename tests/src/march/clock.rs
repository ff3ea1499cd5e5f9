//! How long pictures take.
//!
//! A machine that others work on too is not still for a second. So the contestants take turns, each draws once a round,
//! ratios are those of one round, and what is told are medians. Besides the time on the wall there is the time that the
//! process had the processors, which a software driver's threads are part of.

use crate::march::Subject;
use crate::run::lavapipe;
use rustix::time::{ClockId, clock_gettime};
use sdf_emit::{Header, Target, UniformLayout, emit};
use sdf_render::gpu::{Prepared, Shader};
use sdf_render::{Frame, cpu};
use std::time::{Duration, Instant};

/// What draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// Mesa's software driver, given WGSL. The picture is not read back.
    Lavapipe,
    /// The interpreter.
    Interpreter,
}

/// The times of a contestant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// The time on the wall of a picture, in the median.
    pub wall: Duration,
    /// The time on all processors of a picture, in the median.
    pub processors: Duration,
    /// The time on the wall as a multiple of the first contestant's in the same round, in the median.
    pub wall_ratio: f64,
    /// The same of the time on all processors.
    pub processors_ratio: f64,
}

/// Draws each subject once a round, after a round for warming up, in which a driver compiles.
pub fn race(subjects: &[Subject], frame: &Frame, engine: Engine, rounds: usize) -> Vec<Times> {
    let draws: Vec<Box<dyn Fn() + '_>> =
        subjects.iter().map(|subject| drawing(subject, frame, engine)).collect();
    draws.iter().for_each(|draw| draw());
    let mut laps = vec![Vec::with_capacity(rounds); draws.len()];
    for round in 0..rounds {
        // Nobody is always the one after the same other.
        for i in 0..draws.len() {
            let contestant = if round % 2 == 0 { i } else { draws.len() - 1 - i };
            laps[contestant].push(lap(&*draws[contestant]));
        }
    }
    let times = |own: &Vec<[f64; 2]>| {
        let of = |clock: usize| median(own.iter().map(|lap| lap[clock]).collect());
        let ratio =
            |clock: usize| median(own.iter().zip(&laps[0]).map(|(a, b)| a[clock] / b[clock]).collect());
        Times {
            wall: Duration::from_secs_f64(of(0)),
            processors: Duration::from_secs_f64(of(1)),
            wall_ratio: ratio(0),
            processors_ratio: ratio(1),
        }
    };
    laps.iter().map(times).collect()
}

/// What draws a subject once; its pipeline is built.
fn drawing<'s>(subject: &'s Subject, frame: &'s Frame, engine: Engine) -> Box<dyn Fn() + 's> {
    match engine {
        Engine::Interpreter => Box::new(|| drop(cpu::render(&subject.program, frame))),
        Engine::Lavapipe => {
            let prepared = prepared(subject, frame);
            let side = frame.width.max(frame.height);
            Box::new(move || {
                prepared
                    .draw(side, &mut |_, _| {})
                    .unwrap_or_else(|error| panic!("{}: {error}", subject.march));
            })
        }
    }
}

fn prepared(subject: &Subject, frame: &Frame) -> Prepared<'static> {
    let text =
        emit(&subject.program, Target::Wgsl, &Header::default()).unwrap_or_else(|error| panic!("{error}"));
    let size = [frame.width, frame.height];
    let uniforms = UniformLayout::of(&subject.program).bytes(size, &frame.uniforms(&subject.program));
    lavapipe().prepare(Shader::Wgsl(&text), size, &uniforms).unwrap_or_else(|error| panic!("{error}"))
}

/// How long something takes, in seconds: on the wall, and on all processors together.
fn lap(work: &dyn Fn()) -> [f64; 2] {
    let (wall, processors) = (Instant::now(), on_processors());
    work();
    [wall.elapsed().as_secs_f64(), on_processors() - processors]
}

/// How long this process has had processors so far, in seconds.
fn on_processors() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}
