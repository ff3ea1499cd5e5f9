//! How far a picture is from the truth.

use super::truth::{Grid, Oracle, Truth, encoded};
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

/// How far a picture is from the truth. Pixels of which the truth is not decided count nowhere else, and those whose true colour is
/// not known in nothing of colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Pixels of which the truth is not decided.
    pub undecided: usize,
    /// Pixels whose rays ran out of steps.
    pub out_of_steps: usize,
    /// Pixels that show a surface that the ray does not meet, where none is within a tenth of a pixel or what the session asks
    /// for. A surface that the ray does meet, but shown too near or too far, is an error of the depth.
    pub false_hits: usize,
    /// Pixels that do not show the surface that is there, but nothing, or what lies behind.
    pub false_misses: usize,
    /// How far from where the rays meet the surface it is shown, in pixels along its normal: the distance along the ray times the
    /// cosine between both; next to the eye, where pixels are tiny, in tens of what the rounding of coordinates is.
    /// The median, what 99.9 % are not above, and the most; of the pixels that show this surface, and no other that is nearer to
    /// the place that was found.
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
                    match surface(truth, oracle.near, i, found, distances[i]) {
                        _ if found.lost => Met::OutOfSteps,
                        Some(met) => met,
                        None if !truth.is_proved => judged(truth, i, found, distances[i]),
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
        let areas = truth.sampled.iter().zip(&truth.areas).filter(|(i, _)| truth.colored[**i]);
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
/// what counts as there, `near` pixels; then what was found is far behind along the ray, and faces another way.
fn surface(truth: &Truth, near: f64, i: usize, found: &Found, distance: f64) -> Option<Met> {
    let (there, here) = (truth.depths[i], f64::from(found.depth));
    if there < 0.0 || here < 0.0 {
        return (there < 0.0 && here < 0.0).then_some(Met::Right);
    }
    let ray = &truth.rays[i];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along = (here - there).abs();
    let off = along * dot(truth.normals[i], ray.direction).abs();
    let reach = ray.radius(there);
    let normal = found.normal.map(f64::from);
    let length = dot(normal, normal).sqrt();
    let cosine = dot(normal, truth.normals[i]) / length.max(1e-30);
    let is_other = along > GRAZING * reach && cosine < TURNED;
    let is_same = off <= reach.max(2.0 * distance) && !is_other && normal.iter().all(|x| x.is_finite());
    is_same.then(|| Met::Surface(off / reach * near, cosine.clamp(-1.0, 1.0).acos().to_degrees()))
}

/// What is to be said of what is not the surface that is there, where nothing is proved: as the certifier judges, but by how far
/// the place that was found is from a surface.
fn judged(truth: &Truth, i: usize, found: &Found, distance: f64) -> Met {
    let (there, here) = (truth.depths[i], f64::from(found.depth));
    let near = truth.rays[i].radius(here.max(0.0));
    let is_number = here.is_finite() && found.normal.iter().all(|x| x.is_finite());
    match there >= 0.0 && (here < 0.0 || here > there + GRAZING * near) {
        _ if !is_number => Met::FalseHit,
        true => Met::FalseMiss,
        false if distance > near => Met::FalseHit,
        false => Met::Right,
    }
}

/// The pixels whose colours are known that the rays of a picture have; of several rays a pixel only some are.
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
        (0..count).map(pixel).filter(|(i, ..)| truth.colored[*i])
    }

    /// Which share of them is so.
    fn share(&self, is_so: impl Fn(usize, [f64; 3], [f64; 3]) -> bool) -> f64 {
        let so = self.pixels().filter(|(i, color, moved)| is_so(*i, *color, *moved)).count();
        so as f64 / self.pixels().count().max(1) as f64
    }

    /// How many of all pixels with true colours are so, if the others are as these.
    fn of_all(&self, is_so: impl Fn(usize, [f64; 3], [f64; 3]) -> bool) -> usize {
        let colored = self.truth.colored.iter().filter(|is| **is).count();
        (self.share(is_so) * colored as f64).round() as usize
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
    // The sum of nothing is -0.
    (squares.iter().sum::<f64>().max(0.0) / squares.len().max(1) as f64).sqrt()
}

/// What a share of some sorted numbers is not above; 0 of none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1) as f64;
    sorted.get((last * share).ceil() as usize).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::truth::NEAR;
    use super::*;
    use crate::{Frame, Options};
    use sdf_render::certify;

    /// A slab that the eye sees at 60 degrees from its normal, before a dark sky.
    const SLAB: &str = "camera { eye: (0, 0, 4), target: (0, 0, 0), fov: 40deg } sky { color: 0.02 }
        light key { direction: (1, 0, 1) } scene { box((0.9, 0.7, 0.1)).rotate_y(60deg) }";
    /// The size of its picture; the middle of the middle pixel is on the camera's axis.
    const SIZE: u32 = 45;
    const MIDDLE: usize = (SIZE * SIZE / 2) as usize;

    /// A picture without an error, to make some in.
    struct Copy {
        oracle: Oracle,
        truth: Truth,
        found: Vec<Found>,
        colors: Vec<[f32; 3]>,
        moved: Vec<[f32; 3]>,
        antialias: u32,
    }

    impl Copy {
        fn of(text: &str, antialias: u32) -> Copy {
            let frame = Frame::new(SIZE, SIZE);
            let oracle = Oracle::new("made up", text, &Options::default(), &frame, NEAR).expect("a scene");
            let grids: Vec<u32> = (2..=antialias).collect();
            let truth = oracle.truth(&frame, &grids, &|_| {});
            let normal = |i: usize| truth.normals[i].map(|x| x as f32);
            let found = (0..truth.pixels())
                .map(|i| Found { depth: truth.depths[i] as f32, normal: normal(i), lost: false })
                .collect();
            let shown = |colors: &[[f64; 3]]| colors.iter().map(|c| encoded(*c).map(|c| c as f32)).collect();
            let (mut colors, mut moved): (Vec<[f32; 3]>, Vec<[f32; 3]>) =
                (shown(&truth.colors), shown(&truth.moved));
            for grid in &truth.grids {
                for (k, i) in truth.sampled.iter().enumerate() {
                    colors[*i] = encoded(grid.means[k]).map(|c| c as f32);
                    moved[*i] = encoded(grid.moved[k]).map(|c| c as f32);
                }
            }
            Copy { oracle, truth, found, colors, moved, antialias }
        }

        fn errors(&self) -> Errors {
            let Copy { found, colors, moved, antialias, .. } = self;
            Errors::of(&Made { found, colors, moved, antialias: *antialias }, &self.truth, &self.oracle)
        }

        /// A pixel that shows the slab, or that shows nothing, far from where that ends.
        fn pixel(&self, shows: bool) -> usize {
            if shows { MIDDLE } else { 0 }
        }
    }

    fn is_near(a: f64, b: f64, share: f64) -> bool {
        (a - b).abs() <= share * b
    }

    #[test]
    fn a_copy_of_the_truth_has_no_errors() {
        for antialias in [1, 2] {
            let copy = Copy::of(SLAB, antialias);
            let hits = copy.truth.depths.iter().filter(|t| **t > 0.0).count();
            assert!((300..1500).contains(&hits), "{hits} of {}", SIZE * SIZE);
            let errors = copy.errors();
            let Errors { undecided, out_of_steps, false_hits, false_misses, flicker, .. } = errors;
            assert_eq!([undecided, out_of_steps, false_hits, false_misses, flicker], [0; 5], "{errors:?}");
            assert!(errors.rms < 1e-4 && errors.visible == 0.0, "{errors:?}");
            assert!(errors.depth[2] < 1e-4 && errors.normal[2] < 0.1, "{errors:?}");
            let exact = Copy::of("scene {}", antialias).errors();
            assert!(exact.rms < 1e-4 && exact.undecided == 0 && exact.depth == [0.0; 3], "{exact:?}");
        }
    }

    /// Half a pixel along a ray that meets the surface at 60 degrees is a quarter of one along the normal. The height of a pixel is
    /// that of the picture at this distance over their number.
    #[test]
    fn a_moved_depth_shows_in_pixels_along_the_normal() {
        for share in [0.5, -0.5, 2.0, -5.0] {
            let mut copy = Copy::of(SLAB, 1);
            let depth = copy.truth.depths[MIDDLE];
            assert!(is_near(depth, 3.8, 1e-3), "the slab is 0.1 thick to either side: {depth}");
            let pixel = 2.0 * 20f64.to_radians().tan() * depth / f64::from(SIZE);
            copy.found[MIDDLE].depth += (share * pixel) as f32;
            let errors = copy.errors();
            assert!(is_near(errors.depth[2], 0.5 * f64::abs(share), 1e-3), "{share}: {errors:?}");
            assert_eq!((errors.false_hits, errors.false_misses), (0, 0), "{share}");
            assert!(errors.depth[0] < 1e-4, "the others are where they were: {errors:?}");
        }
    }

    /// From an eye on the surface it is met at once, where a pixel has no size, and rounding tells how near that can be.
    #[test]
    fn next_to_the_eye_rounding_counts() {
        let text = "camera { eye: (0, 1, 0), target: (3, 0, 1) } scene { box((5, 1, 5)) }";
        let mut copy = Copy::of(text, 1);
        let i = copy.truth.depths.iter().position(|t| (0.0..1e-5).contains(t)).expect("a hit at the eye");
        copy.found[i].depth += 1e-7;
        let errors = copy.errors();
        assert!(errors.depth[2] < 1.0, "{errors:?}");
    }

    #[test]
    fn what_is_not_there_is_a_false_hit_and_what_is_not_seen_a_false_miss() {
        let mut copy = Copy::of(SLAB, 1);
        let (slab, sky) = (copy.pixel(true), copy.pixel(false));
        copy.found[sky] = Found { depth: 4.0, normal: [0.0, 0.0, 1.0], lost: false };
        let errors = copy.errors();
        assert_eq!((errors.false_hits, errors.false_misses), (1, 0), "{errors:?}");
        copy.found[slab] = Found { depth: -1.0, normal: [0.0; 3], lost: false };
        let errors = copy.errors();
        assert_eq!((errors.false_hits, errors.false_misses), (1, 1), "{errors:?}");
        copy.found[slab] = Found { depth: -1.0, normal: [0.0; 3], lost: true };
        let errors = copy.errors();
        assert_eq!((errors.false_misses, errors.out_of_steps), (0, 1), "{errors:?}");
        // Through the near side, to where the ray leaves the slab, 0.2 thick.
        let back = copy.truth.depths[slab] + 0.2 / 0.5;
        copy.found[slab] =
            Found { depth: back as f32, normal: copy.found[slab].normal.map(|x| -x), lost: false };
        let errors = copy.errors();
        assert_eq!((errors.false_misses, errors.out_of_steps), (1, 0), "{errors:?}");
        // In mid-air before the slab.
        copy.found[slab].depth = 1.0;
        copy.found[slab].normal = [f32::NAN; 3];
        let errors = copy.errors();
        assert_eq!((errors.false_hits, errors.false_misses), (2, 0), "{errors:?}");
    }

    #[test]
    fn a_turned_normal_shows_in_degrees() {
        let mut copy = Copy::of(SLAB, 1);
        // The face's normal is in the plane of x and z.
        let [x, y, z] = copy.found[MIDDLE].normal.map(f64::from);
        assert!(y.abs() < 1e-9 && is_near(z, 0.5, 1e-6), "{x} {y} {z}");
        let (sin, cos) = 1f64.to_radians().sin_cos();
        copy.found[MIDDLE].normal = [x * cos + z * sin, 0.0, z * cos - x * sin].map(|x| 3.0 * x as f32);
        let errors = copy.errors();
        assert!(is_near(errors.normal[2], 1.0, 1e-3) && errors.normal[0] < 0.1, "{errors:?}");
    }

    /// One pixel of all is changed by five codes in one channel: the mean square is that over three channels and all pixels.
    #[test]
    fn a_changed_color_shows_in_codes() {
        let mut copy = Copy::of(SLAB, 1);
        copy.colors[MIDDLE][1] += 5.0 / 255.0;
        let errors = copy.errors();
        let pixels = f64::from(SIZE * SIZE);
        assert!(is_near(errors.rms, (25.0 / 3.0 / pixels).sqrt(), 1e-2), "{errors:?}");
        assert!(is_near(errors.visible, 1.0 / pixels, 1e-9), "{errors:?}");
        assert_eq!(errors.flicker, 1, "it changes as the camera moves");
        copy.colors[MIDDLE][1] -= 2.0 / 255.0;
        assert_eq!(copy.errors().visible, 0.0);
        for color in &mut copy.colors {
            *color = color.map(|c| c + 1.0 / 255.0);
        }
        let all = Copy { moved: copy.colors.clone(), ..copy }.errors();
        assert!(is_near(all.rms, 1.0, 0.1), "{all:?}");
    }

    /// A checker of small squares changes where the camera moves, and so it should.
    #[test]
    fn what_the_truth_itself_changes_does_not_flicker() {
        let checked = SLAB.replace(
            "rotate_y(60deg)",
            "rotate_y(60deg).paint(material { color: checker((4000 * p.x, 4000 * p.y), 0, 1) })",
        );
        for antialias in [1, 2] {
            let mut copy = Copy::of(&checked, antialias);
            let changes = |copy: &Copy| {
                let pairs = copy.colors.iter().zip(&copy.moved);
                pairs.filter(|(a, b)| apart(a.map(f64::from), b.map(f64::from)) > 0.1).count()
            };
            assert!(changes(&copy) > 10, "{}", changes(&copy));
            assert_eq!(copy.errors().flicker, 0);
            let sampled: Vec<usize> = copy.truth.sampled.clone();
            for i in sampled.iter().take(3) {
                copy.moved[*i] = copy.moved[*i].map(|c| if c > 0.5 { c - 0.3 } else { c + 0.3 });
            }
            let flicker = copy.errors().flicker;
            // Of one ray each pixel is known, of four one in sixteen.
            let expected = [3.0, 3.0 * f64::from(SIZE * SIZE) / sampled.len() as f64][antialias as usize - 1];
            assert!(flicker > 0 && flicker as f64 <= expected.round(), "{antialias}: {flicker}");
        }
    }

    #[test]
    fn what_is_undecided_counts_nowhere_else() {
        let mut copy = Copy::of(SLAB, 1);
        let (slab, sky) = (copy.pixel(true), copy.truth.sampled[0]);
        let untouched = copy.errors();
        for i in [slab, sky] {
            copy.truth.decided[i] = false;
            copy.truth.colored[i] = false;
        }
        let without = copy.errors();
        copy.found[slab] = Found { depth: -1.0, normal: [0.0; 3], lost: false };
        copy.found[sky] = Found { depth: 2.0, normal: [0.0, 0.0, 1.0], lost: true };
        for i in [slab, sky] {
            copy.colors[i] = [1.0, 0.0, 1.0];
            copy.moved[i] = [0.0, 1.0, 0.0];
        }
        assert_eq!(copy.errors(), without, "whatever is there");
        assert_eq!(without.undecided, untouched.undecided + 2);
    }

    /// The corners of a polygon are on the borders of its conditions.
    #[test]
    fn rays_on_the_level_of_a_corner_are_decided() {
        let text = "camera { eye: (-1.1, 0.5, 6), target: (0, 0, 0), fov: 38deg }
            let hexagon = polygon(for i in 0..6 { 1.2 * (cos(i * 60deg), sin(i * 60deg)) })
            scene { hexagon.round(0.15).extrude(0.1) }";
        let copy = Copy::of(text, 1);
        assert_eq!(copy.truth.undecided(), 0);
        let proofs = &copy.truth.proofs;
        assert!(proofs.contains(&certify::Truth::Miss));
        assert!(proofs.iter().any(|proof| matches!(proof, certify::Truth::Hit { .. })));
    }
}
