//! Light in pictures, for tests that know what there must be: scenes with a known camera, what their pixels show and the light
//! that leaves them in linear values, and the definitions of the effects in `f64`.
//!
//! The typical way is `View → View::light(text), View::seen(text)` for what a picture shows, and [`Field`] with the functions
//! of [`definition`] for what it must show.

pub mod definition;
pub mod field;
pub mod vector;

pub use definition::Light;
pub use field::Field;
pub use vector::Vector;

use crate::scenes::{Buffers, Seen, coordinates, legalised, scene};
use rayon::prelude::*;
use sdf_ir::eval::{Counts, Tape, run_parallel};
use sdf_ir::{FunctionId, Program};
use sdf_lang::{Options, Scene};
use sdf_render::Frame;
use vector::{cross, dot, minus, plus, times, unit};

/// The cosine between two normals that are the same.
const SAME: f64 = 0.9999;

/// A place of the surface that a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Which pixel.
    pub pixel: usize,
    /// Where it is, on the true surface.
    pub place: Vector,
    /// The true normal there.
    pub normal: Vector,
    /// The direction of the ray from the eye.
    pub direction: Vector,
}

/// A camera that looks at a picture's subject, and the size of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Where the eye is.
    pub eye: Vector,
    /// Where it looks.
    pub target: Vector,
    /// The vertical field of view, in degrees.
    pub fov: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl View {
    /// The block that is this camera in a scene.
    pub fn block(&self) -> String {
        let [eye, target] = [self.eye, self.target].map(|[x, y, z]| format!("({x}, {y}, {z})"));
        format!("camera {{ eye: {eye}, target: {target}, fov: {}deg }}\n", self.fov)
    }

    fn frame(&self) -> Frame {
        Frame::new(self.size[0], self.size[1])
    }

    fn scene(&self, text: &str, options: &Options) -> Scene {
        scene("light", &(self.block() + text), &Options { attack: Some(0), ..options.clone() })
    }

    /// The directions of the rays through the pixels, row by row from the top, by the camera's definition.
    pub fn directions(&self) -> Vec<Vector> {
        let half = (self.fov / 2.0).to_radians().tan();
        let forward = unit(minus(self.target, self.eye));
        let right = unit(cross(forward, [0.0, 1.0, 0.0]));
        let up = cross(right, forward);
        let [x, y] = coordinates(&self.frame());
        let (width, height) = (f64::from(self.size[0]), f64::from(self.size[1]));
        let direction = |i: usize| {
            let u = (2.0 * f64::from(x[i]) - width) / height * half;
            let v = (2.0 * f64::from(y[i]) - height) / height * half;
            unit(plus(plus(forward, times(right, u)), times(up, v)))
        };
        (0..x.len()).map(direction).collect()
    }

    /// The light that leaves each pixel of a scene, as the interpreter draws it: the sRGB code taken back. Files of `options`
    /// stand in for the compiler's.
    pub fn light(&self, text: &str, options: &Options) -> Vec<Vector> {
        let made = self.scene(text, options);
        let program = legalised(&made.program, made.program.entry.expect("a pixel"));
        let (columns, _) = run(&program, &self.frame());
        (0..columns[0].len()).map(|i| [0, 1, 2].map(|k| decoded(f64::from(columns[k][i])))).collect()
    }

    /// What the pixels of a scene show.
    pub fn seen(&self, text: &str, options: &Options) -> Vec<Seen> {
        self.seen_and_counted(text, options).0
    }

    /// What the pixels of a scene show, and how often the field of its solids was evaluated for them.
    pub fn seen_and_counted(&self, text: &str, options: &Options) -> (Vec<Seen>, u64) {
        let made = self.scene(text, &Options { probe: true, ..options.clone() });
        let program = legalised(&made.program, made.probe.expect("a probe"));
        let (columns, counts) = run(&program, &self.frame());
        let called = |name: &str| {
            let functions = program
                .functions
                .iter()
                .enumerate()
                .filter(|(_, f)| f.name.trim_end_matches("_stride") == name);
            functions.map(|(i, _)| counts.calls_of(FunctionId(i as u32))).sum::<u64>()
        };
        let evaluations = match called("solids") {
            0 => called("map"),
            of_solids => of_solids,
        };
        (Buffers::of_columns(&self.frame(), &columns).pixels, evaluations)
    }

    /// What the pixels of a scene show of the surface where it is beyond doubt: at silhouettes and creases a hit that is within
    /// the tolerance of the surface may have another normal than the place next to it.
    pub fn places(&self, text: &str, seen: &[Seen]) -> Vec<Place> {
        let field = Field::of(&(self.block() + text));
        let directions = self.directions();
        let pixels = (0..seen.len()).into_par_iter().map_init(
            || field.probe(),
            |probe, pixel| {
                let Seen { depth, normal, .. } = seen[pixel];
                if depth < 0.0 {
                    return None;
                }
                let hit = plus(self.eye, times(directions[pixel], f64::from(depth)));
                let place = probe.on_surface(hit);
                let true_normal = unit(probe.gradient(place));
                let is_same = dot(true_normal, normal.map(f64::from)) > SAME;
                is_same.then_some(Place { pixel, place, normal: true_normal, direction: directions[pixel] })
            },
        );
        pixels.flatten().collect()
    }

    /// How many rounds of loops the picture of a scene takes.
    pub fn rounds(&self, text: &str, options: &Options) -> u64 {
        let made = self.scene(text, options);
        let program = legalised(&made.program, made.program.entry.expect("a pixel"));
        run(&program, &self.frame()).1.rounds
    }
}

/// The compiler with a part of a file of the renderer replaced, which must be there: a naive twin.
pub fn twin(file: &str, replaced: &[(&str, &str)]) -> Options {
    let (_, original) =
        sdf_lang::compiler_files().find(|(name, _)| *name == file).expect("a file of the renderer");
    let mut text = original.to_owned();
    for (from, to) in replaced {
        assert!(text.contains(from), "{file} has no `{from}`");
        text = text.replace(from, to);
    }
    Options { replaced: vec![(file.to_owned(), text)], ..Options::default() }
}

/// The columns that a program gives for the pixels of a frame, and what was counted.
fn run(program: &Program, frame: &Frame) -> (Vec<Vec<f32>>, Counts) {
    let [x, y] = coordinates(frame);
    let tape = Tape::compile_counting(program, program.entry.expect("an entry"));
    let mut outputs = vec![vec![0.0f32; x.len()]; tape.output_count()];
    let mut slices: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    let counts = run_parallel(&tape, &frame.uniforms(program), &[&x, &y], &mut slices);
    (outputs, counts)
}

/// Linear light from its sRGB code (IEC 61966-2-1).
fn decoded(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
