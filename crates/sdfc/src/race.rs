//! How long pictures take beside each other.
//!
//! A machine that others work on too is not still for a second. So the contestants take turns, each draws once a round,
//! ratios are those of one round, and what is told are medians and quartiles. What is built and compiled before the first
//! picture does not count.

use crate::draw::{Device, DrawError, Progress};
use crate::{Frame, Shader};
#[cfg(feature = "gpu")]
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// How often a device that has a clock draws a picture in one round: enough that a round is long beside what its clock
/// and its power are late by.
#[cfg(feature = "gpu")]
const PASSES: u32 = 8;
/// How long a device that has a clock draws before it is timed.
#[cfg(feature = "gpu")]
const WARM: Duration = Duration::from_millis(300);
/// How many rounds there are at least, however long they take.
const LEAST: usize = 3;
/// How many rounds are enough where nobody says.
pub(crate) const ENOUGH: usize = 51;

/// What came of a race.
#[derive(Debug, Clone, PartialEq)]
pub struct Race {
    /// What drew.
    pub device: String,
    /// Why it is not what was preferred, where that is so.
    pub fallback: Option<String>,
    /// By which clock: `the device's clock`, `all processors together` or `the clock on the wall`.
    pub clock: &'static str,
    /// The size of the pictures.
    pub size: (u32, u32),
    /// How many rounds there were.
    pub rounds: usize,
    /// What each contestant took; nothing for those for which there was no time.
    pub laps: Vec<Option<Lap>>,
}

/// What a contestant takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lap {
    /// The time of a picture, in the median.
    pub time: Duration,
    /// How far the quartiles of the times are apart.
    pub spread: Duration,
    /// How long a picture takes by the clock on the wall, in the median; by the device's own where that has one.
    pub wall: Duration,
    /// The time as a multiple of the first contestant's in the same round: the lower quartile, the median and the upper
    /// quartile.
    pub ratio: [f64; 3],
    /// The same as a multiple of that of the contestant before; of the first, 1.
    pub to_previous: [f64; 3],
}

/// Draws each shader once a round, for about this long.
pub fn race(
    shaders: &[&Shader],
    frame: &Frame,
    device: &Device,
    budget: Duration,
    progress: Progress,
) -> Result<Race, DrawError> {
    race_of(shaders, frame, device, Limits { budget, enough: ENOUGH }, progress)
}

/// How long contestants draw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// For about how long.
    pub budget: Duration,
    /// After how many rounds it ends before that.
    pub enough: usize,
}

/// Draws each shader once a round, within limits.
pub(crate) fn race_of(
    shaders: &[&Shader],
    frame: &Frame,
    device: &Device,
    limits: Limits,
    progress: Progress,
) -> Result<Race, DrawError> {
    match device {
        Device::Cpu => on_cpu(shaders, frame, None, limits, progress),
        Device::Gpu | Device::Named(_) => on_gpu(shaders, frame, device, limits, progress),
        Device::Auto => match on_gpu(shaders, frame, device, limits, progress) {
            Err(DrawError::Device(why)) => on_cpu(shaders, frame, Some(why), limits, progress),
            other => other,
        },
    }
}

/// The interpreter draws smaller pictures where the time would else end before the last round.
fn on_cpu(
    shaders: &[&Shader],
    frame: &Frame,
    fallback: Option<String>,
    Limits { budget, enough }: Limits,
    progress: Progress,
) -> Result<Race, DrawError> {
    let begin = Instant::now();
    let end = begin + budget;
    let draw = |shader: &Shader, frame: &Frame| {
        let before = Watch::start();
        sdf_render::cpu::render(&shader.program, frame);
        Ok(before.spent())
    };
    let mut frame = frame.clone();
    loop {
        let start = Instant::now();
        draw(shaders[0], &frame)?;
        let all = start.elapsed() * (shaders.len() * LEAST) as u32;
        if all <= end.saturating_duration_since(Instant::now()) || frame.width.min(frame.height) < 32 {
            break;
        }
        (frame.width, frame.height) = (frame.width / 2, frame.height / 2);
    }
    let ready: Vec<usize> = (0..shaders.len()).collect();
    let laps = rounds(&ready, [begin, end], enough, progress, |i| draw(shaders[i], &frame))?;
    Ok(told(laps, shaders.len(), "CPU".into(), fallback, Watch::CLOCK, &frame))
}

#[cfg(feature = "gpu")]
fn on_gpu(
    shaders: &[&Shader],
    frame: &Frame,
    device: &Device,
    Limits { budget, enough }: Limits,
    progress: Progress,
) -> Result<Race, DrawError> {
    use crate::draw::{failed, open};
    use sdf_render::gpu::{Prepared, Shader as Source};

    let (begin, gpu) = (Instant::now(), open(device)?);
    let size = [frame.width, frame.height];
    let draw = |prepared: &Prepared| prepared.draw(size[0].max(size[1]), &mut |_, _| {}).map_err(failed);
    let tell = || progress((begin.elapsed().as_secs_f64() / budget.as_secs_f64().max(1e-3)).min(1.0));
    let prepare = |(i, shader): (usize, &&Shader)| -> Result<Option<Prepared>, DrawError> {
        if i > 0 && begin.elapsed() > budget {
            return Ok(None);
        }
        let text = shader.text(crate::Target::Wgsl).map_err(DrawError::Shader)?;
        let ready = gpu.prepare(Source::Wgsl(&text), size, &shader.uniforms(frame)).map_err(failed)?;
        // The driver compiles at the first picture.
        draw(&ready)?;
        tell();
        Ok(Some(ready))
    };
    // Some drivers take seconds for a shader.
    let prepared: Vec<Option<Prepared>> =
        shaders.par_iter().enumerate().map(prepare).collect::<Result<_, _>>()?;
    let is_ready = |i: &usize| prepared[*i].is_some();
    let ready: Vec<usize> = (0..shaders.len()).filter(is_ready).collect();
    let of = |i: usize| prepared[i].as_ref().expect("those that are ready were prepared");
    let has_clock = !gpu.name().software && of(0).time(PASSES).is_ok();
    // Hardware is not at its full rate at once.
    let warm = Instant::now();
    while has_clock && warm.elapsed() < WARM {
        of(0).time(PASSES).map_err(failed)?;
    }
    let laps = rounds(&ready, [begin, begin + budget], enough, progress, |i| match has_clock {
        true => of(i).time(PASSES).map_err(failed).map(|time| [time; 2]),
        false => {
            let watch = Watch::of(gpu.name().software);
            draw(of(i))?;
            Ok(watch.spent())
        }
    })?;
    let clock = match (has_clock, gpu.name().software) {
        (true, _) => "the device's clock",
        (false, true) => Watch::CLOCK,
        (false, false) => Watch::WALL,
    };
    Ok(told(laps, shaders.len(), gpu.name().name.clone(), None, clock, frame))
}

#[cfg(not(feature = "gpu"))]
fn on_gpu(_: &[&Shader], _: &Frame, _: &Device, _: Limits, _: Progress) -> Result<Race, DrawError> {
    Err(DrawError::Device("this build of sdfc cannot use graphics devices".into()))
}

/// What a contestant took in each round, in seconds.
struct Laps {
    contestant: usize,
    times: Vec<f64>,
    /// By the clock on the wall.
    walls: Vec<f64>,
}

/// The times of some contestants, by their numbers, round by round, until the end of the time that the race has.
fn rounds(
    ready: &[usize],
    [begin, end]: [Instant; 2],
    enough: usize,
    progress: Progress,
    mut lap: impl FnMut(usize) -> Result<[Duration; 2], DrawError>,
) -> Result<Vec<Laps>, DrawError> {
    let mut laps: Vec<Laps> =
        ready.iter().map(|i| Laps { contestant: *i, times: Vec::new(), walls: Vec::new() }).collect();
    for round in 0..enough.max(LEAST) {
        if round >= LEAST && Instant::now() >= end {
            break;
        }
        // Nobody is always the one after the same other.
        let mut order: Vec<usize> = (0..ready.len()).collect();
        if round % 2 == 1 {
            order.reverse();
        }
        for place in order {
            let [time, wall] = lap(ready[place])?.map(|time| time.as_secs_f64().max(1e-9));
            laps[place].times.push(time);
            laps[place].walls.push(wall);
            progress((begin.elapsed().as_secs_f64() / (end - begin).as_secs_f64().max(1e-3)).min(1.0));
        }
    }
    Ok(laps)
}

fn told(
    laps: Vec<Laps>,
    contestants: usize,
    device: String,
    fallback: Option<String>,
    clock: &'static str,
    frame: &Frame,
) -> Race {
    let mut out = vec![None; contestants];
    let ratios = |own: &Laps, other: &Laps| {
        quartiles(own.times.iter().zip(&other.times).map(|(a, b)| a / b).collect())
    };
    for (place, own) in laps.iter().enumerate() {
        let [low, middle, high] = quartiles(own.times.clone()).map(Duration::from_secs_f64);
        out[own.contestant] = Some(Lap {
            time: middle,
            spread: high - low,
            wall: Duration::from_secs_f64(quartiles(own.walls.clone())[1]),
            ratio: ratios(own, &laps[0]),
            to_previous: ratios(own, &laps[place.saturating_sub(1)]),
        });
    }
    let size = (frame.width, frame.height);
    Race { device, fallback, clock, size, rounds: laps[0].times.len(), laps: out }
}

/// The lower quartile, the median and the upper quartile of some numbers.
fn quartiles(mut numbers: Vec<f64>) -> [f64; 3] {
    numbers.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| numbers[(numbers.len() - 1) * quarter / 4])
}

/// A clock for what runs on processors: what the process had of them all, where the system tells that; and the one on the wall.
struct Watch {
    begin: Instant,
    #[cfg(unix)]
    processors: Option<Duration>,
}

impl Watch {
    const WALL: &str = "the clock on the wall";
    #[cfg(unix)]
    const CLOCK: &str = "all processors together";
    #[cfg(not(unix))]
    const CLOCK: &str = Watch::WALL;

    fn start() -> Watch {
        Watch::of(true)
    }

    /// A clock for what processors do, or else for what a device does.
    fn of(processors: bool) -> Watch {
        let _ = processors;
        Watch {
            begin: Instant::now(),
            #[cfg(unix)]
            processors: processors.then(processor_time),
        }
    }

    /// What it shows, and what the one on the wall does.
    fn spent(&self) -> [Duration; 2] {
        let wall = self.begin.elapsed();
        #[cfg(unix)]
        if let Some(before) = self.processors {
            return [processor_time().saturating_sub(before), wall];
        }
        [wall, wall]
    }
}

/// How long this process has had processors so far.
#[cfg(unix)]
fn processor_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Clock, Options, compile};

    #[test]
    fn quartiles_are_of_the_sorted() {
        assert_eq!(quartiles(vec![5.0, 1.0, 3.0, 2.0, 4.0]), [2.0, 3.0, 4.0]);
        assert_eq!(quartiles(vec![7.0]), [7.0; 3]);
    }

    #[test]
    fn rounds_end() {
        let shader = |occlusion: u32| {
            let text = format!("scene {{ box(1) }} ambient {{ occlusion: {occlusion} }}");
            compile("a.sdf", &text, &Options::default(), &mut Clock::default()).output.unwrap().1
        };
        let (with, without) = (shader(1), shader(0));
        let frame = Frame::new(64, 36);
        let budget = Duration::from_millis(200);
        let race = race(&[&with, &without], &frame, &Device::Cpu, budget, &|_| {}).unwrap();
        assert!(race.rounds >= 3 && race.device == "CPU" && race.laps.len() == 2, "{race:?}");
        let [low, middle, high] = race.laps[1].unwrap().ratio;
        assert!(low <= middle && middle <= high && race.laps[0].unwrap().ratio == [1.0; 3], "{race:?}");
    }
}
