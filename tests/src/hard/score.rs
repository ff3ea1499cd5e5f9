//! What is wrong with what an execution shows of a scene.

use super::fixture::Fixture;
use crate::scenes::{Buffers, Seen, coordinates};
use rayon::prelude::*;
use sdf_lang::Scene;
use sdf_render::Frame;
use sdf_render::certify::{Certifier, Found, Functions, Prover, Ray, Truth, Verdict};

/// A normal that is off by more than this is wrong, in degrees.
const TURN: f64 = 0.1;
/// How far a hit may be from the first zero, in tolerances along the normal.
const LATE: f64 = 2.0;
/// How many faulty pixels are named.
const NAMED: usize = 4;
/// Below this cosine between a normal and the direction to a light it is not certain which side is lit.
const FACING: f64 = 1e-4;

/// The truth about one frame of a scene.
pub struct Certified {
    certifier: Certifier,
    /// Row by row from the top.
    pixels: Vec<Pixel>,
    width: usize,
}

/// The truth about a pixel.
struct Pixel {
    ray: Ray,
    /// What the ray meets.
    truth: Truth,
    /// How it was judged what executions found: most find the same to the bit, and to judge takes longer than to draw.
    judged: Vec<(Found, Verdict)>,
}

/// How many pixels are right, and how many wrong in which way.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Score {
    /// How many pixels there are.
    pub pixels: usize,
    /// At how many of them it is certain that what is seen is right.
    pub certified: usize,
    /// Those that show a surface where there is none.
    pub false_hits: usize,
    /// Those that do not show the surface that is there.
    pub false_misses: usize,
    /// Those of which the truth is not known.
    pub ambiguous: usize,
    /// Those whose steps were too few.
    pub out_of_steps: usize,
    /// The largest distance between a hit and the first zero, in tolerances along the normal.
    pub late: f64,
    /// The largest error of a normal, in degrees; on creases, to the nearest of those of the sides.
    pub turn: f64,
    /// How many hits are farther from the first zero than two tolerances.
    pub late_hits: usize,
    /// How many normals are off by more than 0.1 degrees.
    pub normals: usize,
    /// How many pixels have a number that is not finite.
    pub not_finite: usize,
    /// How many have another colour than all should have.
    pub colours: usize,
    /// How many are lit in certified shadow, or dark in certified light, away from the shadows' edges.
    pub lights: usize,
    /// The first faulty pixels, in words.
    pub named: Vec<String>,
}

/// What is certain about the light at a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Light {
    Lit,
    Dark,
    Unknown,
}

impl Certified {
    /// Finds the truth about a frame of a scene that was compiled for it.
    pub fn of(scene: &Scene, frame: &Frame) -> Certified {
        let functions = scene.certificate.expect("a scene with a certificate");
        let functions = Functions { map: scene.map, ray: functions.ray, step: functions.step };
        let certifier = Certifier::new(&scene.program, functions, frame);
        let [x, y] = coordinates(frame);
        let pixels = (0..x.len()).into_par_iter().map_init(
            || certifier.prover(),
            |prover, i| {
                let ray = prover.ray([x[i], y[i]].map(f64::from));
                let truth = prover.first_hit(&ray);
                Pixel { ray, truth, judged: Vec::new() }
            },
        );
        let pixels = pixels.collect();
        Certified { certifier, pixels, width: frame.width as usize }
    }

    /// Judges what is seen of it.
    pub fn score(&mut self, fixture: &Fixture, seen: &Buffers) -> Score {
        assert_eq!(seen.pixels.len(), self.pixels.len(), "a picture of the same size");
        let pairs = self.pixels.par_iter_mut().zip(&seen.pixels);
        let verdicts: Vec<Verdict> = pairs
            .map_init(|| self.certifier.prover(), |prover, (pixel, seen)| pixel.judge(prover, seen))
            .collect();
        let scores = (0..verdicts.len()).map(|i| self.pixel_score(i, verdicts[i], &seen.pixels[i], fixture));
        let mut score = scores.fold(Score::default(), Score::joined);
        if fixture.shadows {
            self.count_lights(&mut score, seen);
        }
        score
    }

    fn pixel_score(&self, i: usize, verdict: Verdict, seen: &Seen, fixture: &Fixture) -> Score {
        let mut score = Score { pixels: 1, ..Score::default() };
        match verdict {
            Verdict::RightMiss => score.certified = 1,
            Verdict::RightHit { late, normal, .. } => {
                score.certified = 1;
                let normal = if fixture.is_rough { 0.0 } else { normal };
                score.late = late.unwrap_or(0.0);
                score.turn = normal;
                score.late_hits = usize::from(score.late > LATE);
                score.normals = usize::from(normal > TURN);
                let is_other = |colour: [f32; 3]| (0..3).any(|k| (colour[k] - seen.color[k]).abs() > 1e-3);
                score.colours = usize::from(fixture.colour.is_some_and(is_other));
            }
            Verdict::FalseHit => score.false_hits = 1,
            Verdict::FalseMiss => score.false_misses = 1,
            Verdict::Ambiguous => score.ambiguous = 1,
            Verdict::OutOfSteps => score.out_of_steps = 1,
            Verdict::NotFinite => score.not_finite = 1,
        }
        if score.is_faulty() || score.out_of_steps > 0 {
            let truth = &self.pixels[i].truth;
            score.named.push(self.named(i, &format!("{verdict:?}, {truth:?}, seen at {}", seen.depth)));
        }
        score
    }

    fn named(&self, i: usize, what: &str) -> String {
        format!("column {}, row {}: {what}", i % self.width, i / self.width)
    }

    /// Counts pixels that are lit in certified shadow or dark in certified light, where all pixels round them are certainly
    /// the same: elsewhere the tolerance decides. The colour of every surface is the vector to the light.
    fn count_lights(&self, score: &mut Score, seen: &Buffers) {
        let pairs = self.pixels.par_iter().zip(&seen.pixels);
        let lights: Vec<Light> = pairs
            .map_init(|| self.certifier.prover(), |prover, (pixel, seen)| pixel.light(prover, seen))
            .collect();
        let height = lights.len() / self.width;
        for (i, light) in lights.iter().enumerate() {
            let (column, row) = (i % self.width, i / self.width);
            let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
            let mut round = near(row, height).flat_map(|y| near(column, self.width).map(move |x| (x, y)));
            let is_alike = round.all(|(x, y)| lights[y * self.width + x] == *light);
            let is_lit = seen.pixels[i].light.iter().any(|x| *x > 0.0);
            if is_alike && *light != Light::Unknown && is_lit != (*light == Light::Lit) {
                score.lights += 1;
                if score.named.len() < NAMED {
                    score.named.push(self.named(i, &format!("certainly {light:?}")));
                }
            }
        }
    }
}

impl Pixel {
    fn judge(&mut self, prover: &mut Prover, seen: &Seen) -> Verdict {
        if !is_finite(seen) {
            return Verdict::NotFinite;
        }
        let found = Found { depth: seen.depth, normal: seen.normal, lost: seen.lost };
        if let Some((_, verdict)) = self.judged.iter().find(|(other, _)| *other == found) {
            return *verdict;
        }
        let verdict = judged(prover, &self.ray, &self.truth, found);
        self.judged.push((found, verdict));
        verdict
    }

    /// The light at the first zero along a pixel's ray.
    fn light(&self, prover: &mut Prover, seen: &Seen) -> Light {
        let Pixel { ray, truth, .. } = self;
        let (Some(place), Some(depth)) = (truth.place(ray), truth.depth()) else { return Light::Unknown };
        let normal = prover.normal(place, ray.radius(depth));
        let [normal] = normal.samples[..] else { return Light::Unknown };
        let to_light = seen.color.map(f64::from);
        let distance = dot(to_light, to_light).sqrt();
        let direction = to_light.map(|x| x / distance);
        let facing = dot(normal, direction);
        if facing.abs() < FACING {
            return Light::Unknown;
        }
        if facing < 0.0 {
            return Light::Dark;
        }
        // As a renderer's, the shadow ray begins off the surface, and from there it goes to the light.
        let offset = 2.0 * ray.radius(depth);
        let origin = std::array::from_fn(|k| place[k] + normal[k] * offset);
        let to_light: [f64; 3] = std::array::from_fn(|k| place[k] + to_light[k] - origin[k]);
        let distance = dot(to_light, to_light).sqrt();
        let direction = to_light.map(|x| x / distance);
        match prover.first_hit(&Ray { origin, direction, far: distance, ..*ray }) {
            Truth::Hit { .. } => Light::Dark,
            Truth::Miss => Light::Lit,
            Truth::Ambiguous { .. } => Light::Unknown,
        }
    }
}

/// Judges what was found. The normal is that of the side that is seen: from inside it is not the field's, and a sheet
/// without thickness has both.
fn judged(prover: &mut Prover, ray: &Ray, truth: &Truth, found: Found) -> Verdict {
    let verdict = prover.judge(ray, truth, &found);
    let faces_eye = dot(found.normal.map(f64::from), ray.direction) <= 0.0;
    let Verdict::RightHit { normal, .. } = verdict else { return verdict };
    if normal <= TURN || !faces_eye {
        return verdict;
    }
    let other = prover.judge(ray, truth, &Found { normal: found.normal.map(|x| -x), ..found });
    match other {
        Verdict::RightHit { normal: turned, .. } if turned < normal => other,
        _ => verdict,
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn is_finite(pixel: &Seen) -> bool {
    let vectors = [pixel.normal, pixel.color, pixel.light];
    pixel.depth.is_finite() && pixel.steps.is_finite() && vectors.iter().flatten().all(|x| x.is_finite())
}

impl Score {
    /// This and another.
    pub fn joined(mut self, other: Score) -> Score {
        self.pixels += other.pixels;
        self.certified += other.certified;
        self.false_hits += other.false_hits;
        self.false_misses += other.false_misses;
        self.ambiguous += other.ambiguous;
        self.out_of_steps += other.out_of_steps;
        self.late = self.late.max(other.late);
        self.turn = self.turn.max(other.turn);
        self.late_hits += other.late_hits;
        self.normals += other.normals;
        self.not_finite += other.not_finite;
        self.colours += other.colours;
        self.lights += other.lights;
        self.named.extend(other.named);
        self.named.truncate(NAMED);
        self
    }

    /// The faults of which there must be none, by the names that fixtures give them, with how many there are.
    pub fn faults(&self) -> [(&'static str, usize); 7] {
        [
            ("false hits", self.false_hits),
            ("false misses", self.false_misses),
            ("late hits", self.late_hits),
            ("normals", self.normals),
            ("not finite", self.not_finite),
            ("colours", self.colours),
            ("lights", self.lights),
        ]
    }

    /// How many pixels have this fault, or are out of steps.
    pub fn count_of(&self, fault: &str) -> usize {
        let mut all = self.faults().into_iter().chain([("out of steps", self.out_of_steps)]);
        let (_, count) =
            all.find(|(name, _)| *name == fault).unwrap_or_else(|| panic!("`{fault}` is no fault"));
        count
    }

    fn is_faulty(&self) -> bool {
        self.faults().iter().any(|(_, count)| *count > 0)
    }

    /// What is wrong, if anything, by what the fixture asks for.
    pub fn complaint(&self, fixture: &Fixture) -> Option<String> {
        let faults = self.faults();
        let faults = faults.iter().filter(|(_, n)| *n > 0);
        let mut said: Vec<String> = faults.map(|(name, n)| format!("{n} {name}")).collect();
        for (name, count, share) in [
            ("ambiguous", self.ambiguous, fixture.ambiguous),
            ("out of steps", self.out_of_steps, fixture.out_of_steps),
        ] {
            let allowed = self.pixels as f64 * share;
            if count as f64 > allowed {
                said.push(format!("{count} {name}, {allowed:.1} may be"));
            }
        }
        (!said.is_empty()).then(|| format!("{}\n  {}", said.join(", "), self.named.join("\n  ")))
    }
}
