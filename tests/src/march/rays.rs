//! What the rays through the pixels of a picture meet, and what that costs: counted by the interpreter.

use crate::march::{Subject, Variant};
use crate::scenes::{Example, legalised};
use sdf_ir::eval::{Tape, run_parallel};
use sdf_ir::number::Number;
use sdf_render::Frame;

/// Two depths that are farther apart than this, as a share of the true one, are of two surfaces.
const OTHER_SURFACE: f64 = 0.01;
/// How far beside a ray what it meets may be, in pixels: twice the usual tolerance, which is that of the middle of the
/// picture, where the pixels are widest.
const BESIDE: f64 = 0.2;

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

/// What the rays through a picture truly meet, and those round them.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    through: Rays,
    /// The rays that pass a fifth of a pixel beside the centres of the pixels, on each of eight sides.
    beside: Vec<Rays>,
}

/// How far the hits of a march are from the true ones.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Errors {
    /// How many rays meet something that is nearer or farther away than all that the rays round them meet: another
    /// surface, one that is more than a hundredth of the depth away; or nothing, where all of those meet something.
    pub wrong: usize,
    /// How many rays meet another surface, or nothing, between what the rays round them meet: at silhouettes.
    pub beside: usize,
    /// The root of the mean square of the others' errors, as shares of the depths.
    pub rms: f64,
    /// The largest of these errors.
    pub largest: f64,
}

impl Rays {
    /// The rays of a subject that was compiled with `depth`, in numbers of the type `N`; they pass `beside` the centres of
    /// the pixels, in pixels.
    pub fn of<N: Number>(subject: &Subject, frame: &Frame, beside: [f64; 2]) -> Rays {
        let probe = subject.scene.probe.expect("a subject has a probe");
        let program = legalised(&subject.scene.program, probe);
        let tape = Tape::compile_counting(&program, program.entry.expect("the probe"));
        let (width, height) = (frame.width as usize, frame.height as usize);
        let count = width * height;
        let place = |i: usize| [(i % width) as f64 + 0.5, (height - 1 - i / width) as f64 + 0.5];
        let inputs = [0, 1]
            .map(|axis| (0..count).map(|i| N::from_f64(place(i)[axis] + beside[axis])).collect::<Vec<N>>());
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

    /// How far these hits are from the true ones. Rays of which either ran out of steps do not count.
    pub fn errors(&self, truth: &Truth) -> Errors {
        assert_eq!(self.met.len(), truth.through.met.len(), "pictures of one size");
        let mut errors = Errors::default();
        let mut squares = Vec::new();
        for (i, ray) in self.met.iter().enumerate() {
            let through = &truth.through.met[i];
            match (ray.depth, through.depth) {
                _ if ray.lost || through.lost => {}
                (Some(depth), Some(truth)) if ray.meets_what(through) => {
                    let error = (depth - truth).abs() / truth;
                    errors.largest = errors.largest.max(error);
                    squares.push(error * error);
                }
                _ if ray.meets_what(through) => {}
                _ if truth.is_round(i, ray) => errors.beside += 1,
                _ => errors.wrong += 1,
            }
        }
        errors.rms = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
        errors
    }
}

impl Met {
    /// Whether both meet the same surface, or nothing.
    fn meets_what(&self, truth: &Met) -> bool {
        match (self.depth, truth.depth) {
            (Some(depth), Some(truth)) => (depth - truth).abs() <= OTHER_SURFACE * truth,
            (None, None) => true,
            _ => false,
        }
    }
}

impl Truth {
    /// Whether what a ray meets lies between what it and the rays round it truly meet.
    fn is_round(&self, i: usize, ray: &Met) -> bool {
        let depth = |met: &Met| met.depth.unwrap_or(f64::INFINITY);
        let depths = self.beside.iter().chain([&self.through]).map(|rays| depth(&rays.met[i]));
        let (nearest, farthest) = depths.fold((f64::INFINITY, 0.0f64), |(n, f), d| (n.min(d), f.max(d)));
        let wide = 1.0 + OTHER_SURFACE;
        nearest <= depth(ray) * wide && depth(ray) <= farthest * wide
    }

    /// The truth about a scene, by the march `exact` in numbers of 64 bits.
    pub fn of(example: &Example, frame: &Frame) -> Result<Truth, String> {
        let exact = Subject::new(example, &Variant::named("exact+depth")?)?;
        let round = (0..8).map(|i| std::f64::consts::FRAC_PI_4 * f64::from(i));
        let beside =
            round.map(|angle| Rays::of::<f64>(&exact, frame, [BESIDE * angle.cos(), BESIDE * angle.sin()]));
        Ok(Truth { through: Rays::of::<f64>(&exact, frame, [0.0; 2]), beside: beside.collect() })
    }
}
