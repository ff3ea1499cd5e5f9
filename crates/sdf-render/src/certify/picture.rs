//! A whole picture against the truth.

use super::judge::{Found, Verdict};
use super::{Certifier, Prover, Ray, Step, Truth, moved, normal};
use crate::Frame;
use crate::columns::{Columns, coordinates};
use rayon::prelude::*;
use sdf_ir::{FunctionId, Program};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How many pixels of each kind of failure a report names.
const NAMED: usize = 8;
/// A normal that is off by more than this is wrong, in degrees.
const OFF: f64 = 0.1;

/// A picture to be judged, whoever drew it.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// Pixels from left to right.
    pub width: usize,
    /// What was found at each pixel, row by row from the top.
    pub found: &'a [Found],
    /// At how many points along each pixel's ray the march's step is tried.
    pub steps: usize,
}

/// How many pixels there are of a kind, and the first few: columns from the left and rows from the top.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Places {
    /// How many there are.
    pub count: usize,
    /// The first, at most eight.
    pub first: Vec<(usize, usize)>,
}

/// What came of judging a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// How many pixels there are.
    pub pixels: usize,
    /// At how many of them it is certain that what was found is right.
    pub certified: usize,
    /// Pixels that show a surface where there is none.
    pub false_hits: Places,
    /// Pixels that do not show the surface that is there.
    pub false_misses: Places,
    /// Pixels of which the truth is not known closely enough.
    pub ambiguous: Places,
    /// Pixels whose steps were too few.
    pub out_of_steps: Places,
    /// Pixels at which something that was found is no finite number.
    pub not_finite: Places,
    /// Pixels whose normal is off by more than 0.1 degrees.
    pub wrong_normals: Places,
    /// The largest distance between a hit and the first zero, in tolerances along the normal.
    pub largest_late: f64,
    /// The largest error of a normal, in degrees; on creases, to the nearest of those of the sides.
    pub largest_turn: f64,
    /// How many steps were tried.
    pub steps: usize,
    /// The least share of a step that certainly is free, of those that were tried; 0.99 is all that is asked.
    pub least_free_share: f64,
    /// Pixels on whose rays a step is unsafe.
    pub unsafe_steps: Places,
    /// Pixels on whose rays a step could not be decided.
    pub undecided_steps: Places,
}

impl Default for Report {
    fn default() -> Report {
        Report {
            pixels: 0,
            certified: 0,
            false_hits: Places::default(),
            false_misses: Places::default(),
            ambiguous: Places::default(),
            out_of_steps: Places::default(),
            not_finite: Places::default(),
            wrong_normals: Places::default(),
            largest_late: 0.0,
            largest_turn: 0.0,
            steps: 0,
            least_free_share: Step::Safe.free_share(),
            unsafe_steps: Places::default(),
            undecided_steps: Places::default(),
        }
    }
}

impl Places {
    fn add(&mut self, place: (usize, usize)) {
        self.count += 1;
        if self.first.len() < NAMED {
            self.first.push(place);
        }
    }

    fn join(&mut self, other: &Places) {
        self.count += other.count;
        self.first.extend(&other.first);
        self.first.truncate(NAMED);
    }
}

impl Report {
    /// Whether nothing certainly is wrong: no false hit, no false miss, no unsafe step, nothing that is not finite.
    pub fn is_right(&self) -> bool {
        let wrong = [&self.false_hits, &self.false_misses, &self.unsafe_steps, &self.not_finite];
        wrong.iter().all(|places| places.count == 0)
    }

    /// Adds what came of other pixels.
    pub fn join(mut self, other: &Report) -> Report {
        self.pixels += other.pixels;
        self.certified += other.certified;
        self.steps += other.steps;
        for (places, others) in [
            (&mut self.false_hits, &other.false_hits),
            (&mut self.false_misses, &other.false_misses),
            (&mut self.ambiguous, &other.ambiguous),
            (&mut self.out_of_steps, &other.out_of_steps),
            (&mut self.not_finite, &other.not_finite),
            (&mut self.wrong_normals, &other.wrong_normals),
            (&mut self.unsafe_steps, &other.unsafe_steps),
            (&mut self.undecided_steps, &other.undecided_steps),
        ] {
            places.join(others);
        }
        self.largest_late = self.largest_late.max(other.largest_late);
        self.largest_turn = self.largest_turn.max(other.largest_turn);
        self.least_free_share = self.least_free_share.min(other.least_free_share);
        self
    }

    fn count(&mut self, place: (usize, usize), verdict: &Verdict) {
        self.pixels += 1;
        match verdict {
            Verdict::RightMiss => self.certified += 1,
            Verdict::RightHit { late, normal, .. } => {
                self.certified += 1;
                self.largest_late = self.largest_late.max(late.unwrap_or(0.0));
                self.largest_turn = self.largest_turn.max(*normal);
                if *normal > OFF {
                    self.wrong_normals.add(place);
                }
            }
            Verdict::FalseHit => self.false_hits.add(place),
            Verdict::FalseMiss => self.false_misses.add(place),
            Verdict::Ambiguous => self.ambiguous.add(place),
            Verdict::OutOfSteps => self.out_of_steps.add(place),
            Verdict::NotFinite => self.not_finite.add(place),
        }
    }

    fn count_step(&mut self, place: (usize, usize), step: Step) {
        self.steps += 1;
        self.least_free_share = self.least_free_share.min(step.free_share());
        match step {
            Step::Safe => {}
            Step::Unsafe(_) => self.unsafe_steps.add(place),
            Step::Undecided(_) => self.undecided_steps.add(place),
        }
    }
}

impl Certifier {
    /// Judges a picture on all cores. `progress` is called with the part that is done, 0 to 1, from any thread.
    pub fn judge_picture(&self, picture: &Picture, progress: impl Fn(f64) + Sync) -> Report {
        let done = AtomicUsize::new(0);
        let height = picture.found.len() / picture.width.max(1);
        let pixel = |prover: &mut Prover, index: usize| {
            let place = (index % picture.width, index / picture.width);
            let ray = prover.ray([place.0 as f64 + 0.5, (height - 1 - place.1) as f64 + 0.5]);
            let truth = prover.first_hit(&ray);
            let mut report = Report::default();
            report.count(place, &prover.judge(&ray, &truth, &picture.found[index]));
            for i in 0..picture.steps {
                report.count_step(place, prover.try_step(&ray, &truth, index * picture.steps + i));
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(done as f64 / picture.found.len() as f64);
            report
        };
        let all = (0..picture.found.len()).into_par_iter();
        all.map_init(|| self.prover(), pixel).reduce(Report::default, |a, b| a.join(&b))
    }
}

impl Prover<'_> {
    /// Tries the step from a point near a ray: one of many, by its number. Half of them lie on the ray up to where it
    /// ends, the others beside it, close to the surface.
    fn try_step(&mut self, ray: &Ray, truth: &Truth, number: usize) -> Step {
        let (part, beside) = (share(2 * number as u64), share(2 * number as u64 + 1));
        let end = truth.depth().unwrap_or(ray.far);
        let place = ray.at(end * part);
        if number.is_multiple_of(2) {
            return self.step_from(place);
        }
        let direction = normal::directions().nth(number / 2 % 14).unwrap_or([1.0, 0.0, 0.0]);
        self.step_from(moved(ray.at(end), direction, end * part * beside * 0.25))
    }
}

/// A number from 0 to 1 for each natural number (Guy Steele, Doug Lea, Christine Flood, "Fast Splittable Pseudorandom
/// Number Generators", 2014).
fn share(number: u64) -> f64 {
    let mut x = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) as f64 / u64::MAX as f64
}

/// What the interpreter finds at each pixel, row by row from the top, in `f32` as shaders compute it. The function is
/// `coordinate: vec2 → …` with results `depth: float`, `normal: vec3` and `lost: float` among others.
pub fn interpreted(program: &Program, probe: FunctionId, frame: &Frame) -> Vec<Found> {
    let probe = Columns::of_shader(program, probe);
    let (columns, _) = probe.at::<f32>(frame, &coordinates(frame, [0.0; 2]), &|_| {});
    found(&probe, &columns)
}

/// What was found at each pixel, from the columns of a function as [`interpreted`] takes it.
pub fn found(probe: &Columns, columns: &[Vec<f32>]) -> Vec<Found> {
    let [depth, normal, lost] = ["depth", "normal", "lost"].map(|name| probe.place(name));
    let found = |i: usize| Found {
        depth: columns[depth][i],
        normal: [0, 1, 2].map(|k| columns[normal + k][i]),
        lost: columns[lost][i] != 0.0,
    };
    (0..columns[0].len()).map(found).collect()
}
