//! What the rays through the pixels of a picture meet, and what that costs: counted by the interpreter.

use crate::march::Subject;
use crate::scenes::legalised;
use sdf_ir::eval::{Tape, run_parallel};
use sdf_ir::number::Number;
use sdf_render::Frame;

/// Two depths that are farther apart than this, as a share of the true one, are of two surfaces.
const OTHER_SURFACE: f64 = 0.01;

/// The rays through the pixels of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Rays {
    /// What each ray meets, row by row from the top.
    pub met: Vec<Met>,
    /// How often the march asked the field, for all of them together: at its beginning, once a step and for each step of
    /// the refinement. The gradient at what was met, and rays to lights, do not count.
    pub evaluations: u64,
}

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    /// How far away it is; `None` if there is nothing.
    pub depth: Option<f64>,
    /// How many rounds the loop of the march took.
    pub steps: f64,
    /// Whether they were too few to tell.
    pub lost: bool,
}

/// How far the hits of a march are from the true ones.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Errors {
    /// How many rays there are of which both tell what they meet.
    pub compared: usize,
    /// How many of them meet nothing where there is something, or the other way round, or another surface: one that is
    /// more than a hundredth of the depth away.
    pub wrong: usize,
    /// The root of the mean square of the others' errors, as shares of the depths.
    pub rms: f64,
    /// The largest of these errors.
    pub largest: f64,
}

impl Rays {
    /// The rays of a subject that was compiled with `depth`, in numbers of the type `N`.
    pub fn of<N: Number>(subject: &Subject, frame: &Frame) -> Rays {
        let probe = subject.scene.probe.expect("a subject has a probe");
        let program = legalised(&subject.scene.program, probe);
        let tape = Tape::compile_counting(&program, program.entry.expect("the probe"));
        let (width, height) = (frame.width as usize, frame.height as usize);
        let count = width * height;
        let place = |i: usize| [(i % width) as f64 + 0.5, (height - 1 - i / width) as f64 + 0.5];
        let inputs = [0, 1].map(|axis| (0..count).map(|i| N::from_f64(place(i)[axis])).collect::<Vec<N>>());
        let mut outputs = vec![vec![N::from_f64(0.0); count]; tape.output_count()];
        let counts = run_parallel(
            &tape,
            &frame.uniforms(&program),
            &inputs.each_ref().map(Vec::as_slice),
            &mut outputs.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>(),
        );
        let samples = program.functions.iter().zip(&counts.calls).filter(|(f, _)| &*f.name == "sample");
        let evaluations = samples.map(|(_, calls)| calls).sum();
        let met = |i: usize| {
            // In the order of `Scene::probe`.
            let [depth, steps, lost] = [0, 10, 11].map(|column: usize| outputs[column][i].to_f64());
            Met { depth: (depth >= 0.0).then_some(depth), steps, lost: lost != 0.0 }
        };
        Rays { met: (0..count).map(met).collect(), evaluations }
    }

    /// The steps of a ray in the mean.
    pub fn steps(&self) -> f64 {
        self.met.iter().map(|ray| ray.steps).sum::<f64>() / self.met.len() as f64
    }

    /// The evaluations of the field for a ray in the mean.
    pub fn evaluations(&self) -> f64 {
        self.evaluations as f64 / self.met.len() as f64
    }

    /// The places of the rays that ran out of steps.
    pub fn lost(&self) -> Vec<usize> {
        (0..self.met.len()).filter(|i| self.met[*i].lost).collect()
    }

    /// How far these hits are from the true ones.
    pub fn errors(&self, truth: &Rays) -> Errors {
        assert_eq!(self.met.len(), truth.met.len(), "pictures of one size");
        let mut errors = Errors::default();
        let mut squares = Vec::new();
        for (ray, truth) in self.met.iter().zip(&truth.met).filter(|(a, b)| !a.lost && !b.lost) {
            errors.compared += 1;
            match (ray.depth, truth.depth) {
                (None, None) => {}
                (Some(depth), Some(truth)) if (depth - truth).abs() <= OTHER_SURFACE * truth => {
                    let error = (depth - truth).abs() / truth;
                    errors.largest = errors.largest.max(error);
                    squares.push(error * error);
                }
                _ => errors.wrong += 1,
            }
        }
        errors.rms = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
        errors
    }
}
