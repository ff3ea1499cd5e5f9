//! The scenes in `examples/`, and what each pixel of their pictures shows.

use sdf_ir::eval::{Tape, run_parallel};
use sdf_ir::{FunctionId, Program};
use sdf_lang::{Options, Scene};
use sdf_render::Frame;
use std::path::PathBuf;

/// A scene file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Example {
    /// Its name without the ending.
    pub name: String,
    /// What it holds.
    pub text: String,
}

/// The folder of the examples.
pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples")
}

/// The example that shows all shapes at once. Every client draws it once; tests that draw or ask again and again leave it
/// out, for its shapes are tried one by one.
pub const GALLERY: &str = "gallery";

/// The examples, by name, but the gallery.
pub fn examples() -> Vec<Example> {
    let mut all = all_examples();
    all.retain(|example| example.name != GALLERY);
    all
}

/// The gallery.
pub fn gallery() -> Example {
    let gallery = all_examples().into_iter().find(|example| example.name == GALLERY);
    gallery.unwrap_or_else(|| panic!("examples/{GALLERY}.sdf is missing"))
}

/// All examples, by name.
pub fn all_examples() -> Vec<Example> {
    let files = std::fs::read_dir(folder()).expect("the folder of the examples");
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("a file").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "sdf"));
    paths.sort();
    let example = |path: &PathBuf| Example {
        name: path.file_stem().expect("a name").to_string_lossy().into_owned(),
        text: std::fs::read_to_string(path).expect("a text"),
    };
    paths.iter().map(example).collect()
}

/// A source as a scene; it must have no mistakes.
pub fn scene(name: &str, text: &str, options: &Options) -> Scene {
    let compilation = sdf_lang::compile(name, text, options);
    let said: Vec<String> =
        compilation.diagnostics.iter().map(|d| format!("{}: {}", d.code, d.message)).collect();
    compilation.scene.unwrap_or_else(|| panic!("{name}: {}\n{text}", said.join("\n")))
}

/// One function of a program made the program's entry, in operations that mean the same on hardware.
pub fn legalised(program: &Program, function: FunctionId) -> Program {
    let mut program = program.clone();
    program.entry = Some(function);
    sdf_ir::legalise(&sdf_ir::simplify(&program, &[]).0)
}

/// The centres of the pixels of a picture, row by row from the top, in pixels from the bottom left.
pub fn coordinates(frame: &Frame) -> [Vec<f32>; 2] {
    let (width, height) = (frame.width as usize, frame.height as usize);
    let x = (0..width * height).map(|i| (i % width) as f32 + 0.5).collect();
    let y = (0..width * height).map(|i| (height - 1 - i / width) as f32 + 0.5).collect();
    [x, y]
}

/// What the pixels of a picture show: row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Buffers {
    /// Pixels from left to right.
    pub width: usize,
    /// What each pixel shows.
    pub pixels: Vec<Seen>,
}

/// What a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The distance from the eye; -1 where there is nothing.
    pub depth: f32,
    /// The normal of the surface.
    pub normal: [f32; 3],
    /// The colour of the surface, in linear light.
    pub color: [f32; 3],
    /// The light that arrives at it.
    pub light: [f32; 3],
    /// How many steps the ray took.
    pub steps: f32,
    /// Whether they were too few to tell.
    pub lost: bool,
}

/// How far apart two depths are at a step, as a share of the nearer one.
const DEPTH_STEP: f32 = 0.05;
/// The cosine of the angle between the normals at a step: of 15 degrees.
const NORMAL_STEP: f32 = 0.966;
/// How far apart two colours, or two amounts of light, are at a step, in a channel.
const LIGHT_STEP: f32 = 0.05;

impl Seen {
    /// Whether there is an edge between two pixels.
    fn is_apart_from(&self, other: &Seen) -> bool {
        let [near, far] = [self.depth.min(other.depth), self.depth.max(other.depth)];
        let cosine: f32 = self.normal.iter().zip(other.normal).map(|(a, b)| a * b).sum();
        let apart = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > LIGHT_STEP);
        if far < 0.0 {
            return false;
        }
        near < 0.0
            || far - near > DEPTH_STEP * near
            || cosine < NORMAL_STEP
            || apart(self.color, other.color)
            || apart(self.light, other.light)
    }
}

impl Buffers {
    /// Those of a scene that was compiled with a probe.
    pub fn of(scene: &Scene, frame: &Frame) -> Buffers {
        Buffers::of_program(&legalised(&scene.program, scene.probe.expect("a scene with a probe")), frame)
    }

    /// Those of a legalised program whose entry is a probe.
    pub fn of_program(program: &Program, frame: &Frame) -> Buffers {
        let tape = Tape::compile(program, program.entry.expect("the probe"));
        let [x, y] = coordinates(frame);
        let mut outputs = vec![vec![0.0f32; x.len()]; 12];
        let mut slices: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
        run_parallel(&tape, &frame.uniforms(program), &[&x, &y], &mut slices);
        Buffers::of_columns(frame, &outputs)
    }

    /// Those that a probe gave for [`coordinates`].
    pub fn of_columns(frame: &Frame, columns: &[Vec<f32>]) -> Buffers {
        let three = |first: usize, i: usize| [0, 1, 2].map(|k| columns[first + k][i]);
        let seen = |i| Seen {
            depth: columns[0][i],
            normal: three(1, i),
            color: three(4, i),
            light: three(7, i),
            steps: columns[10][i],
            lost: columns[11][i] != 0.0,
        };
        Buffers { width: frame.width as usize, pixels: (0..columns[0].len()).map(seen).collect() }
    }

    /// Whether an edge passes between two of a pixel and its eight neighbours: of a shape, a surface's colour or a
    /// shadow.
    pub fn is_near_edge(&self, column: usize, row: usize) -> bool {
        let height = self.pixels.len() / self.width;
        let rows = row.saturating_sub(1)..(row + 2).min(height);
        let columns = column.saturating_sub(1)..(column + 2).min(self.width);
        let near: Vec<&Seen> =
            rows.flat_map(|y| columns.clone().map(move |x| &self.pixels[y * self.width + x])).collect();
        near.iter().any(|a| near.iter().any(|b| a.is_apart_from(b)))
    }
}
