//! What a picture truly is: computed in `f64` with no regard for time, and proved pixel by pixel where that can be.

use super::MeasureError;
use super::settings::MOVE;
use crate::{Clock, Options, Scene, compile};
use rayon::prelude::*;
use sdf_ir::Constant;
use sdf_ir::eval::{Machine, Tape, run_parallel};
use sdf_lang::Accuracy;
use sdf_render::Frame;
use sdf_render::certify::{self, Certifier, Functions, Prover, Ray};
use sdf_render::columns::{Columns, coordinates};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How near to a surface a hit must be not to be false, in pixels, where nothing else is asked for: whatever the tolerance of a
/// setting.
pub const NEAR: f64 = 0.1;
/// One pixel in so many is compared with the mean of its area.
const AREA_SHARE: usize = 16;
/// How many rays along each side of a grid the mean of a pixel's area is taken of.
const AREA_SIDE: u32 = 6;
/// How much of what a hit may be off the truth itself may be uncertain.
const WIDE: f64 = 0.1;

/// The least slope that a distance is divided by.
const FLAT: f64 = 0.02;
/// How many pixels show whether a picture can be proved.
const TRIED: usize = 16;
/// How many operations on intervals that may take at most.
const MOST: f64 = 1e11;
/// How long a piece of a ray that the certifier cannot tell about is passed over at once, to either side, as a share of the scale of
/// the coordinates.
const GAP: f64 = 1e-8;
/// How many times as steep as a distance a field would have to be there to have a surface in it, to be passed over.
const STEEP: f64 = 1e3;
/// How often that is done on a ray.
const RESTARTS: usize = 16;

/// The truth about a picture.
#[derive(Debug, Clone, Default)]
pub struct Truth {
    /// The colours of what the rays through the pixels' centres see, in linear light from 0 to 1, row by row from the top.
    pub colors: Vec<[f64; 3]>,
    /// How far away what each pixel shows is; -1 where there is nothing.
    pub depths: Vec<f64>,
    /// The surface's normal there.
    pub normals: Vec<[f64; 3]>,
    /// Whether it is known what each pixel's ray from the eye meets, and proved if the picture [is](Truth::is_proved): nothing, or a
    /// surface within a hundredth of a pixel of there. The others count as nobody's errors.
    pub decided: Vec<bool>,
    /// Whether the colour is that of what is proved to be met. It is not where a promise about a slope is false, by which what
    /// was computed has stepped through a surface; what the surface is like is then known, and not what light it sends.
    pub colored: Vec<bool>,
    /// Whether that is proved. If not, it would take intervals too long, or they tell nothing of this scene's field; then what was
    /// computed is taken for true as it stands: by steps over slopes that are promised or proved.
    pub is_proved: bool,
    /// The colours after a move of the camera by 0.01 pixels.
    pub(super) moved: Vec<[f64; 3]>,
    /// Some pixels, of which more than one ray is known.
    pub(super) sampled: Vec<usize>,
    /// The mean of the area of each of those.
    pub(super) areas: Vec<[f64; 3]>,
    /// The means of those on the grids of antialiasing that are asked for.
    pub(super) grids: Vec<Grid>,
    pub(super) rays: Vec<Ray>,
    pub(super) proofs: Vec<certify::Truth>,
}

/// What antialiasing makes of the sampled pixels. Of their rays only those through the centres are proved.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    /// How many rays there are along each side.
    pub side: u32,
    /// The mean of the rays of each sampled pixel.
    pub means: Vec<[f64; 3]>,
    /// The same after the camera's move.
    pub moved: Vec<[f64; 3]>,
}

/// What answers questions about a scene's truth.
pub(super) struct Oracle {
    scene: Scene,
    /// How near to a surface a hit must be not to be false, in pixels.
    pub near: f64,
    pub certifier: Certifier,
    /// `p → distance, gradient` of a scene that is something.
    field: Option<Tape>,
    uniforms: Vec<Constant>,
}

impl Oracle {
    /// For a scene without mistakes at one moment. Hits are false where no surface is within `near` pixels.
    pub fn new(
        name: &str,
        text: &str,
        options: &Options,
        frame: &Frame,
        near: f64,
    ) -> Result<Oracle, MeasureError> {
        let accuracy = Accuracy { tolerance: near, ..Accuracy::default() };
        let options = Options {
            accuracy: Some(accuracy),
            truth: true,
            certificate: true,
            attack: Some(0),
            ..options.clone()
        };
        let compiled = compile(name, text, &options, &mut Clock::default());
        let Some((scene, _)) = compiled.output else { return Err(MeasureError::Scene(compiled.diagnostics)) };
        let certificate = scene.certificate.expect("it was asked for");
        let functions = Functions { map: scene.map, ray: certificate.ray, step: certificate.step };
        let certifier = Certifier::new(&scene.program, functions, frame);
        let uniforms = frame.uniforms(&scene.program);
        let mut program = scene.program.clone();
        let field = scene.map.map(|map| {
            let gradient = sdf_ir::gradient(&mut program, map);
            Tape::compile(&program, gradient)
        });
        Ok(Oracle { scene, near, certifier, field, uniforms })
    }

    /// How far places on rays are from a surface, in `f64`: the field over its slope there, which is right to first order.
    pub fn distances(&self, rays: &[Ray], depths: &[f64]) -> Vec<f64> {
        let Some(field) = &self.field else { return vec![1e20; rays.len()] };
        let places: Vec<[f64; 3]> = rays.iter().zip(depths).map(|(ray, t)| ray.at(*t)).collect();
        let columns = [0, 1, 2].map(|k| places.iter().map(|place| place[k]).collect::<Vec<f64>>());
        let mut results = vec![vec![0.0; rays.len()]; 4];
        let mut slices: Vec<&mut [f64]> = results.iter_mut().map(Vec::as_mut_slice).collect();
        run_parallel(field, &self.uniforms, &columns.each_ref().map(Vec::as_slice), &mut slices);
        let slope = |i: usize| results[1..].iter().map(|part| part[i] * part[i]).sum::<f64>().sqrt();
        (0..rays.len()).map(|i| results[0][i].abs() / slope(i).max(FLAT)).collect()
    }

    /// What a ray meets first. The certifier cannot tell where conditions of a field change sides, as those of polygons do on
    /// the level of each corner. If the field is far from zero just before and just behind such a place, with one sign, it would
    /// have to be a thousand times as steep as a distance to have a surface in between; then the ray is asked about again from
    /// behind it.
    fn first_hit(&self, prover: &mut Prover, field: &mut Option<Machine<f64>>, ray: &Ray) -> certify::Truth {
        let mut proof = prover.first_hit(ray);
        let mut from = f64::NEG_INFINITY;
        for _ in 0..RESTARTS {
            let near = match proof {
                certify::Truth::Ambiguous { near } => near,
                certify::Truth::Hit { near, far } if far - near > allowed(ray, far) => near,
                _ => break,
            };
            let Some(field) = field else { break };
            let gap = GAP * ray.at(near).iter().chain(&ray.origin).fold(near, |most, x| most.max(x.abs()));
            let [before, behind] = [near - gap, near + gap].map(|t| field.run_one(&ray.at(t))[0]);
            // Behind the last such place there is another at once: it is no place, but a region.
            if near - from < 100.0 * gap {
                break;
            }
            if before * behind <= 0.0 || before.abs().min(behind.abs()) < STEEP * gap {
                break;
            }
            from = near + gap;
            proof = behind_start(prover.first_hit(&part_from(ray, from)), from);
        }
        proof
    }

    /// Whether intervals tell enough of the field, and soon enough, for a proof of these pixels: as some of them show.
    fn can_prove(&self, centers: &[Vec<f64>; 2]) -> bool {
        let count = centers[0].len();
        let Some(map) = self.scene.map else { return true };
        // Evenly over the picture, and not in a column.
        let tried: Vec<usize> =
            (0..TRIED.min(count)).map(|k| (2 * k + 1) * count / (2 * TRIED.min(count))).collect();
        let seen: Vec<(bool, u64)> = tried
            .par_iter()
            .map(|i| {
                let mut prover = self.certifier.prover();
                let ray = prover.ray([centers[0][*i], centers[1][*i]]);
                let is_told = match prover.first_hit(&ray) {
                    certify::Truth::Miss => true,
                    certify::Truth::Hit { near, far } => far - near <= allowed(&ray, far),
                    certify::Truth::Ambiguous { .. } => false,
                };
                (is_told, prover.evaluations())
            })
            .collect();
        let told = seen.iter().filter(|(is_told, _)| *is_told).count();
        let evaluations =
            seen.iter().map(|(_, evaluations)| *evaluations as f64).sum::<f64>() / seen.len().max(1) as f64;
        let operations = sdf_ir::cost::operations(&self.scene.program, map) as f64;
        2 * told > seen.len() && evaluations * operations * count as f64 <= MOST
    }

    fn field_machine(&self) -> Option<Machine<'_, f64>> {
        let mut machine = Machine::new(self.field.as_ref()?);
        machine.set_uniforms(&self.uniforms);
        Some(machine)
    }

    /// The truth about a picture; means of grids of so many rays a side are wanted beside it.
    pub fn truth(&self, frame: &Frame, grids: &[u32], progress: &(dyn Fn(f64) + Sync)) -> Truth {
        let columns = Columns::new(&self.scene.program, self.scene.truth.expect("it was asked for"));
        let [color, depth, normal, lost] =
            ["color", "depth", "normal", "lost"].map(|name| columns.place(name));
        let colors = |places: &[Vec<f64>; 2], progress: &dyn Fn(f64)| {
            let (all, _) = columns.at(frame, places, progress);
            let colors =
                (0..places[0].len()).map(|i| [0, 1, 2].map(|k| all[color + k][i])).collect::<Vec<_>>();
            (colors, all)
        };
        let centers = coordinates::<f64>(frame, [0.0; 2]);
        let count = centers[0].len();
        let (center_colors, all) = colors(&centers, &|part| progress(0.2 * part));
        let (moved, _) = colors(&coordinates(frame, MOVE), &|part| progress(0.2 + 0.2 * part));
        // Spread evenly, and in no pattern.
        let sampled: Vec<usize> = (0..count).filter(|i| is_sampled(*i)).collect();
        let of_grid = |side: u32, shift: [f64; 2]| -> Vec<[f64; 3]> {
            let mut sums = vec![[0.0; 3]; sampled.len()];
            for place in 0..side * side {
                let offset =
                    [place % side, place / side].map(|k| (f64::from(k) + 0.5) / f64::from(side) - 0.5);
                let places = [0, 1].map(|axis| {
                    sampled.iter().map(|i| centers[axis][*i] + offset[axis] + shift[axis]).collect()
                });
                let (colors, _) = colors(&places, &|_| {});
                for (sum, color) in sums.iter_mut().zip(colors) {
                    *sum = [0, 1, 2].map(|k| sum[k] + color[k] / f64::from(side * side));
                }
            }
            sums
        };
        let areas = of_grid(AREA_SIDE, [0.0; 2]);
        progress(0.6);
        let grid =
            |side: &u32| Grid { side: *side, means: of_grid(*side, [0.0; 2]), moved: of_grid(*side, MOVE) };
        let grids = grids.iter().map(grid).collect();
        progress(0.7);
        let mut depths = all[depth].clone();
        let mut normals: Vec<[f64; 3]> = (0..count).map(|i| [0, 1, 2].map(|k| all[normal + k][i])).collect();
        let is_lost = |i: usize| all[lost][i] != 0.0;
        let done = AtomicUsize::new(0);
        let is_proved = self.can_prove(&centers);
        let proved: Vec<(Ray, certify::Truth)> = (0..count)
            .into_par_iter()
            .map_init(
                || (self.certifier.prover(), self.field_machine()),
                |(prover, field), i| {
                    let ray = prover.ray([centers[0][i], centers[1][i]]);
                    let proof = match is_proved {
                        true => self.first_hit(prover, field, &ray),
                        false if depths[i] < 0.0 => certify::Truth::Miss,
                        false => certify::Truth::Hit { near: depths[i], far: depths[i] },
                    };
                    let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                    if done.is_multiple_of(1024) {
                        progress(0.7 + 0.3 * done as f64 / count as f64);
                    }
                    (ray, proof)
                },
            )
            .collect();
        let (rays, proofs): (Vec<Ray>, Vec<certify::Truth>) = proved.into_iter().unzip();
        let colored: Vec<bool> =
            (0..count).map(|i| !is_lost(i) && agree(&rays[i], &proofs[i], depths[i])).collect();
        let mut decided = colored.clone();
        let mut field = self.field_machine();
        for i in (0..count).filter(|i| is_proved && !colored[*i]) {
            if let Some((t, n)) = shown(&rays[i], &proofs[i], &mut field) {
                (depths[i], normals[i], decided[i]) = (t, n, true);
            }
        }
        Truth {
            colors: center_colors,
            depths,
            normals,
            decided,
            colored,
            is_proved,
            moved,
            sampled,
            areas,
            grids,
            rays,
            proofs,
        }
    }
}

impl Truth {
    /// Whether the means are known of grids with so many rays a side.
    pub(super) fn has_grid(&self, side: u32) -> bool {
        side <= 1 || self.grids.iter().any(|grid| grid.side == side)
    }

    /// How many pixels there are.
    pub fn pixels(&self) -> usize {
        self.decided.len()
    }

    /// Of how many of them that is not known.
    pub fn undecided(&self) -> usize {
        self.decided.iter().filter(|is| !**is).count()
    }

    /// The colours in sRGB from 0 to 1.
    pub fn encoded(&self) -> Vec<[f32; 3]> {
        self.colors.iter().map(|color| encoded(*color).map(|c| c as f32)).collect()
    }
}

/// How uncertain the distance of what a ray meets may be.
fn allowed(ray: &Ray, far: f64) -> f64 {
    WIDE * ray.share(far) + 1e-9 * far
}

/// The part of a ray from a distance on.
fn part_from(ray: &Ray, from: f64) -> Ray {
    Ray { origin: ray.at(from), far: ray.far - from, width: ray.share(from), ..*ray }
}

/// What is proved of such a part, in distances from the beginning of the whole ray.
fn behind_start(proof: certify::Truth, from: f64) -> certify::Truth {
    match proof {
        certify::Truth::Hit { near, far } => certify::Truth::Hit { near: from + near, far: from + far },
        certify::Truth::Ambiguous { near } => certify::Truth::Ambiguous { near: from + near },
        certify::Truth::Miss => certify::Truth::Miss,
    }
}

/// Whether what was computed is what is proved.
fn agree(ray: &Ray, proof: &certify::Truth, depth: f64) -> bool {
    match *proof {
        certify::Truth::Miss => depth < 0.0,
        certify::Truth::Ambiguous { .. } => false,
        certify::Truth::Hit { near, far } => {
            let allowed = allowed(ray, far);
            depth >= 0.0 && far - near <= allowed && depth >= near - allowed && depth <= far + allowed
        }
    }
}

/// How far away what a ray meets is by its proof, and the normal there on the side that it comes on; -1 of nothing.
fn shown(ray: &Ray, proof: &certify::Truth, field: &mut Option<Machine<f64>>) -> Option<(f64, [f64; 3])> {
    match *proof {
        certify::Truth::Miss => Some((-1.0, [0.0; 3])),
        certify::Truth::Hit { near, far } if far - near <= allowed(ray, far) => {
            let field = field.as_mut()?;
            let side = if field.run_one(&ray.origin)[0] < 0.0 { -1.0 } else { 1.0 };
            let slope = field.run_one(&ray.at(near));
            let length = slope[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
            Some((near, [1, 2, 3].map(|k| side * slope[k] / length.max(1e-30))))
        }
        _ => None,
    }
}

/// Whether a pixel is one of those of which more than one ray is known (Guy Steele, Doug Lea, Christine Flood, "Fast
/// Splittable Pseudorandom Number Generators", 2014).
fn is_sampled(pixel: usize) -> bool {
    let mut x = (pixel as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) as usize).is_multiple_of(AREA_SHARE)
}

/// sRGB from linear light (IEC 61966-2-1).
pub(super) fn encoded(color: [f64; 3]) -> [f64; 3] {
    color.map(|c| {
        let c = c.clamp(0.0, 1.0);
        if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
    })
}
