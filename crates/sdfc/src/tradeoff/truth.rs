//! What a picture truly is: computed in `f64` with no regard for time, and proved pixel by pixel where that can be.

use super::MeasureError;
use super::settings::MOVE;
use crate::{Clock, Options, Scene, compile};
use rayon::prelude::*;
use sdf_ir::Constant;
use sdf_ir::eval::{Tape, run_parallel};
use sdf_lang::Accuracy;
use sdf_render::Frame;
use sdf_render::certify::{self, Certifier, Functions, Ray};
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

/// The truth about a picture.
#[derive(Debug, Clone)]
pub struct Truth {
    /// The colours of what the rays through the pixels' centres see, in linear light from 0 to 1, row by row from the top.
    pub colors: Vec<[f64; 3]>,
    /// How far away what each pixel shows is; -1 where there is nothing.
    pub depths: Vec<f64>,
    /// The surface's normal there.
    pub normals: Vec<[f64; 3]>,
    /// Whether it is proved what each pixel's ray meets: nothing, or a surface within a hundredth of a pixel of there. The others
    /// count as nobody's errors.
    pub decided: Vec<bool>,
    /// The colours after a move of the camera by 0.01 pixels.
    pub(super) moved: Vec<[f64; 3]>,
    /// Some pixels, of which more than one ray is known.
    pub(super) sampled: Vec<usize>,
    /// The mean of the area of each of those.
    pub(super) areas: Vec<[f64; 3]>,
    /// The mean of each of those on the grids of antialiasing that are asked for, by how many rays these have a side.
    pub(super) grids: Vec<(u32, Vec<[f64; 3]>)>,
    pub(super) rays: Vec<Ray>,
    pub(super) proofs: Vec<certify::Truth>,
}

/// What answers questions about a scene's truth.
pub(super) struct Oracle {
    scene: Scene,
    /// How near to a surface a hit must be not to be false, in pixels.
    pub near: f64,
    pub certifier: Certifier,
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
        Ok(Oracle { scene, near, certifier, uniforms })
    }

    /// The field at places on rays, in `f64`.
    pub fn distances(&self, rays: &[Ray], depths: &[f64]) -> Vec<f64> {
        let Some(map) = self.scene.map else { return vec![1e20; rays.len()] };
        let tape = Tape::compile(&self.scene.program, map);
        let places: Vec<[f64; 3]> = rays.iter().zip(depths).map(|(ray, t)| ray.at(*t)).collect();
        let columns = [0, 1, 2].map(|k| places.iter().map(|place| place[k]).collect::<Vec<f64>>());
        let mut distances = vec![0.0; rays.len()];
        run_parallel(&tape, &self.uniforms, &columns.each_ref().map(Vec::as_slice), &mut [&mut distances]);
        distances
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
        let of_grid = |side: u32| -> Vec<[f64; 3]> {
            let mut sums = vec![[0.0; 3]; sampled.len()];
            for place in 0..side * side {
                let offset =
                    [place % side, place / side].map(|k| (f64::from(k) + 0.5) / f64::from(side) - 0.5);
                let places =
                    [0, 1].map(|axis| sampled.iter().map(|i| centers[axis][*i] + offset[axis]).collect());
                let (colors, _) = colors(&places, &|_| {});
                for (sum, color) in sums.iter_mut().zip(colors) {
                    *sum = [0, 1, 2].map(|k| sum[k] + color[k] / f64::from(side * side));
                }
            }
            sums
        };
        let areas = of_grid(AREA_SIDE);
        progress(0.6);
        let grids = grids.iter().map(|side| (*side, of_grid(*side))).collect();
        progress(0.7);
        let depths = all[depth].clone();
        let is_lost = |i: usize| all[lost][i] != 0.0;
        let done = AtomicUsize::new(0);
        let proved: Vec<(Ray, certify::Truth)> = (0..count)
            .into_par_iter()
            .map_init(
                || self.certifier.prover(),
                |prover, i| {
                    let ray = prover.ray([centers[0][i], centers[1][i]]);
                    let proof = prover.first_hit(&ray);
                    let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                    if done.is_multiple_of(1024) {
                        progress(0.7 + 0.3 * done as f64 / count as f64);
                    }
                    (ray, proof)
                },
            )
            .collect();
        let (rays, proofs): (Vec<Ray>, Vec<certify::Truth>) = proved.into_iter().unzip();
        let decided = (0..count).map(|i| !is_lost(i) && agree(&rays[i], &proofs[i], depths[i])).collect();
        let normals = (0..count).map(|i| [0, 1, 2].map(|k| all[normal + k][i])).collect();
        Truth { colors: center_colors, depths, normals, decided, moved, sampled, areas, grids, rays, proofs }
    }
}

impl Truth {
    /// How many pixels there are.
    pub fn pixels(&self) -> usize {
        self.decided.len()
    }

    /// How many of them nothing is proved of.
    pub fn undecided(&self) -> usize {
        self.decided.iter().filter(|is| !**is).count()
    }

    /// What rounding alone makes of colours: the same in sRGB from 0 to 1.
    pub fn encoded(&self) -> Vec<[f32; 3]> {
        self.colors.iter().map(|color| encoded(*color).map(|c| c as f32)).collect()
    }
}

/// Whether what was computed is what is proved.
fn agree(ray: &Ray, proof: &certify::Truth, depth: f64) -> bool {
    match *proof {
        certify::Truth::Miss => depth < 0.0,
        certify::Truth::Ambiguous { .. } => false,
        certify::Truth::Hit { near, far } => {
            let allowed = WIDE * ray.share(depth) + 1e-9 * far;
            depth >= 0.0 && far - near <= allowed && depth >= near - allowed && depth <= far + allowed
        }
    }
}

/// Whether a pixel is one of those of which more than one ray is known (Guy Steele, Doug Lea, Christine Flood, "Fast
/// Splittable Pseudorandom Number Generators", 2014).
fn is_sampled(pixel: usize) -> bool {
    let mut x = (pixel as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) as usize % AREA_SHARE == 0
}

/// sRGB from linear light (IEC 61966-2-1).
pub(super) fn encoded(color: [f64; 3]) -> [f64; 3] {
    color.map(|c| {
        let c = c.clamp(0.0, 1.0);
        if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
    })
}
