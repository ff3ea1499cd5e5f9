//! How far a picture is from the truth.

use super::truth::{Grid, NEAR, Oracle, Truth, encoded};
use rayon::prelude::*;
use sdf_render::certify::{Found, Verdict};

/// From what difference of sRGB codes on, of 255, two colours are visibly different.
const VISIBLE: f64 = 4.0;
/// By how many sRGB codes more than the truth a pixel changes that flickers.
const FLICKERS: f64 = 2.0;

/// How much farther along the ray than what counts as there, and with a normal of what cosine at most, a place is one of another
/// surface.
const GRAZING: f64 = 20.0;
const TURNED: f64 = 0.5;

/// How far a picture is from the truth. Pixels of which the truth is not decided count nowhere else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Pixels of which the truth is not decided.
    pub undecided: usize,
    /// Pixels whose rays ran out of steps.
    pub out_of_steps: usize,
    /// Pixels that show a surface where none is within a tenth of a pixel: where the ray meets nothing, or something else.
    pub false_hits: usize,
    /// Pixels that do not show the surface that is there, but nothing, or what lies behind.
    pub false_misses: usize,
    /// How far from where the rays meet the surface it is shown, in pixels along its normal: the distance along the ray times the
    /// cosine between both. The median, what 99.9 % are not above, and the most; of the pixels that show this surface, and
    /// no other that is nearer to the place that was found.
    pub depth: [f64; 3],
    /// How far the normals of the same pixels are off, in degrees: the median, what 99 % are not above, and the most. On an edge
    /// the true one is that of the side that the ray meets.
    pub normal: [f64; 3],
    /// Pixels that change in a channel when the camera moves by 0.01 pixels, by more than 2 sRGB codes of 255 more than the truth
    /// does. If a pixel has several rays, one pixel in sixteen is looked at, and counts for as many.
    pub flicker: usize,
    /// The root of the mean square of the difference from the true colours of the same rays, in sRGB codes of 255, over pixels and
    /// channels; of one pixel in sixteen if it has several rays.
    pub rms: f64,
    /// The share of the same pixels that are visibly different from that: by more than 4 codes of 255 in a channel.
    pub visible: f64,
    /// The root of the mean square of the difference from the mean of each pixel's area, of one pixel in sixteen, in sRGB codes
    /// of 255: what rays through the centres miss, and antialiasing adds.
    pub aliasing: f64,
}

/// What a renderer made of a picture.
pub(super) struct Made<'a> {
    /// What the rays from the eye find.
    pub found: &'a [Found],
    /// The colours, in sRGB from 0 to 1.
    pub colors: &'a [[f32; 3]],
    /// The colours after the camera's move.
    pub moved: &'a [[f32; 3]],
    /// How many rays a pixel has, along each side of a grid.
    pub antialias: u32,
}

/// What is to be said of the ray of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Met {
    OutOfSteps,
    FalseHit,
    FalseMiss,
    /// The surface that is there, so many pixels off, with a normal that is so many degrees off.
    Surface(f64, f64),
    /// Nothing, rightly; or a surface that the ray passes within what counts as there.
    Right,
}

impl Errors {
    /// Of a picture.
    pub(super) fn of(made: &Made, truth: &Truth, oracle: &Oracle) -> Errors {
        let depths: Vec<f64> = made.found.iter().map(|found| f64::from(found.depth.max(0.0))).collect();
        let distances = oracle.distances(&truth.rays, &depths);
        let met: Vec<Met> = (0..truth.pixels())
            .into_par_iter()
            .filter(|i| truth.decided[*i])
            .map_init(
                || oracle.certifier.prover(),
                |prover, i| {
                    let found = &made.found[i];
                    match surface(truth, i, found, distances[i]) {
                        _ if found.lost => Met::OutOfSteps,
                        Some(met) => met,
                        None => match prover.judge(&truth.rays[i], &truth.proofs[i], found) {
                            Verdict::FalseHit | Verdict::NotFinite => Met::FalseHit,
                            Verdict::FalseMiss => Met::FalseMiss,
                            _ => Met::Right,
                        },
                    }
                },
            )
            .collect();
        let count = |kind: Met| met.iter().filter(|met| **met == kind).count();
        let surfaces = |part: fn(f64, f64) -> f64| {
            let parts = met.iter().filter_map(|met| match met {
                Met::Surface(depth, normal) => Some(part(*depth, *normal)),
                _ => None,
            });
            let mut parts: Vec<f64> = parts.collect();
            parts.sort_by(f64::total_cmp);
            parts
        };
        let (depth, normal) = (surfaces(|depth, _| depth), surfaces(|_, normal| normal));
        let known = Known::of(made, truth);
        let squares: Vec<f64> = known.pixels().map(|(i, color, _)| square(made.colors[i], color)).collect();
        let areas = truth.sampled.iter().zip(&truth.areas).filter(|(i, _)| truth.decided[**i]);
        let aliasing: Vec<f64> = areas.map(|(i, area)| square(made.colors[*i], *area)).collect();
        Errors {
            undecided: truth.undecided(),
            out_of_steps: count(Met::OutOfSteps),
            false_hits: count(Met::FalseHit),
            false_misses: count(Met::FalseMiss),
            depth: [quantile(&depth, 0.5), quantile(&depth, 0.999), quantile(&depth, 1.0)],
            normal: [quantile(&normal, 0.5), quantile(&normal, 0.99), quantile(&normal, 1.0)],
            flicker: known.of_all(|i, color, moved| flickers(made, i, color, moved)),
            rms: root_of_mean(&squares),
            visible: known
                .share(|i, color, _| apart(made.colors[i].map(f64::from), encoded(color)) > VISIBLE / 255.0),
            aliasing: root_of_mean(&aliasing),
        }
    }
}

/// What was found, if it is the surface that is there, or nothing where nothing is. The place that was found is `distance` from
/// a surface; if that is another one than the ray meets, the latter is farther away. What a ray only grazes it may pass within
/// what counts as there; then what was found is far behind along the ray, and faces another way.
fn surface(truth: &Truth, i: usize, found: &Found, distance: f64) -> Option<Met> {
    let (there, here) = (truth.depths[i], f64::from(found.depth));
    if there < 0.0 || here < 0.0 {
        return (there < 0.0 && here < 0.0).then_some(Met::Right);
    }
    let ray = &truth.rays[i];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along = (here - there).abs();
    let off = along * dot(truth.normals[i], ray.direction).abs();
    let near = ray.share(there);
    let normal = found.normal.map(f64::from);
    let length = dot(normal, normal).sqrt();
    let cosine = dot(normal, truth.normals[i]) / length.max(1e-30);
    let is_other = along > GRAZING * near && cosine < TURNED;
    let is_same = off <= near.max(2.0 * distance) && !is_other && normal.iter().all(|x| x.is_finite());
    is_same.then(|| Met::Surface(off / near * NEAR, cosine.clamp(-1.0, 1.0).acos().to_degrees()))
}

/// The pixels whose colours are known that the rays of a picture have, and that are decided; of several rays a pixel only some
/// are.
struct Known<'t> {
    truth: &'t Truth,
    grid: Option<&'t Grid>,
}

impl<'t> Known<'t> {
    fn of(made: &Made, truth: &'t Truth) -> Known<'t> {
        let of_side = |grid: &&Grid| grid.side == made.antialias;
        let grid = (made.antialias > 1)
            .then(|| truth.grids.iter().find(of_side).expect("the truth was asked for these grids"));
        Known { truth, grid }
    }

    /// Their places with their colours, as they are and after the camera's move.
    fn pixels(&self) -> impl Iterator<Item = (usize, [f64; 3], [f64; 3])> {
        let truth = self.truth;
        let count = self.grid.map_or(truth.pixels(), |_| truth.sampled.len());
        let pixel = move |k: usize| match self.grid {
            Some(grid) => (truth.sampled[k], grid.means[k], grid.moved[k]),
            None => (k, truth.colors[k], truth.moved[k]),
        };
        (0..count).map(pixel).filter(|(i, ..)| truth.decided[*i])
    }

    /// Which share of them is so.
    fn share(&self, is_so: impl Fn(usize, [f64; 3], [f64; 3]) -> bool) -> f64 {
        let so = self.pixels().filter(|(i, color, moved)| is_so(*i, *color, *moved)).count();
        so as f64 / self.pixels().count().max(1) as f64
    }

    /// How many of all decided pixels are so, if the others are as these.
    fn of_all(&self, is_so: impl Fn(usize, [f64; 3], [f64; 3]) -> bool) -> usize {
        let decided = self.truth.pixels() - self.truth.undecided();
        (self.share(is_so) * decided as f64).round() as usize
    }
}

/// Whether a pixel of this true colour, and that after the camera's move, changes by more than it should.
fn flickers(made: &Made, i: usize, color: [f64; 3], moved: [f64; 3]) -> bool {
    let own = apart(made.colors[i].map(f64::from), made.moved[i].map(f64::from));
    own - apart(encoded(color), encoded(moved)) > FLICKERS / 255.0
}

/// The largest difference of two colours in a channel.
fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
}

/// The mean square of the difference of a colour in sRGB and one in linear light, in sRGB codes of 255.
fn square(color: [f32; 3], linear: [f64; 3]) -> f64 {
    let encoded = encoded(linear);
    (0..3).map(|k| (255.0 * (f64::from(color[k]) - encoded[k])).powi(2)).sum::<f64>() / 3.0
}

fn root_of_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// What a share of some sorted numbers is not above; 0 of none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1) as f64;
    sorted.get((last * share).ceil() as usize).copied().unwrap_or(0.0)
}
