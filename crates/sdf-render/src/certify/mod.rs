//! The truth about a picture, by interval arithmetic: where a ray first meets the surface, and whether a step of the
//! march is safe. Nothing of the march is used for it, and no promise about slopes: formulas alone.
//!
//! The typical way is `Program → Certifier → Prover → first_hit → judge` for one ray, and
//! [`Certifier::judge_picture`] for a picture, whoever drew it. The program is the one that was built, before
//! [`legalise`](sdf_ir::legalise).

mod ball;
mod conditions;
mod field;
mod first_hit;
mod judge;
mod normal;
mod picture;
mod ray;
#[cfg(test)]
mod tests;

use ball::BUDGET;
pub use ball::Step;
pub use conditions::{conditions, weights};
pub use first_hit::Truth;
pub use judge::{Found, Verdict};
pub use normal::Normal;
pub use picture::{Picture, Places, Report, found, interpreted};
pub use ray::Ray;

use crate::Frame;
use field::Field;
use sdf_ir::eval::{Machine, Tape};
use sdf_ir::interval::{Bounds, bounds_of_globals};
use sdf_ir::{Constant, Function, FunctionId, Program};

/// The most operations of a field that is written out.
const WRITTEN_OUT: u64 = 20_000;

/// A point of space, or a vector.
pub type Vector = [f64; 3];

/// The functions of a program that a certificate is made from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Functions {
    /// `p: vec3 → distance`, whose first zero along a ray is the surface; a scene that is nothing has none.
    pub map: Option<FunctionId>,
    /// `coordinate: vec2 → origin: vec3, direction: vec3, far: float, width: float, tolerance: float`: the ray through a
    /// pixel, whose direction has length 1; how far it goes; and how near to a surface a hit may be: at its origin, and how
    /// much farther for each unit of length.
    pub ray: FunctionId,
    /// `p: vec3 → distance: float, stride: float`, of which the stride is what is tried for safety.
    pub step: FunctionId,
}

/// What there is for either side of a field.
struct Sides<T> {
    outside: T,
    inside: T,
}

/// A scene at one moment, ready to be asked.
pub struct Certifier {
    program: Program,
    map: Option<FunctionId>,
    /// The conditions of `map`.
    conditions: Option<Sides<Function>>,
    uniforms: Vec<Constant>,
    uniform_bounds: Vec<Bounds>,
    global_bounds: Vec<Bounds>,
    ray: Tape,
    step: Tape,
    /// `p → distance, gradient`
    gradient: Option<Tape>,
}

impl Certifier {
    /// For the uniforms of a frame.
    pub fn new(program: &Program, functions: Functions, frame: &Frame) -> Certifier {
        let mut program = program.clone().without_promises();
        let gradient = functions.map.map(|map| sdf_ir::gradient(&mut program, map));
        let map = functions.map.map(|map| written_out_if_small(&mut program, map));
        let conditions = map.map(|map| {
            let of = |is_outside| conditions(&program, program.function(map), is_outside);
            Sides { outside: of(true), inside: of(false) }
        });
        let uniforms = frame.uniforms(&program);
        let uniform_bounds: Vec<Bounds> = uniforms.iter().map(|value| Bounds::constant(*value)).collect();
        Certifier {
            map,
            conditions,
            global_bounds: bounds_of_globals(&program, &uniform_bounds),
            ray: Tape::compile(&program, functions.ray),
            step: Tape::compile(&program, functions.step),
            gradient: gradient.map(|gradient| Tape::compile(&program, gradient)),
            uniforms,
            uniform_bounds,
            program,
        }
    }

    /// What answers questions, for one thread.
    pub fn prover(&self) -> Prover<'_> {
        let machine = |tape| {
            let mut machine = Machine::new(tape);
            machine.set_uniforms(&self.uniforms);
            machine
        };
        let field = |(map, conditions)| {
            let map = self.program.function(map);
            Field::new(&self.program, map, conditions, &self.uniform_bounds, &self.global_bounds)
        };
        Prover {
            field: self.map.zip(self.conditions.as_ref()).map(field),
            ray: machine(&self.ray),
            step: machine(&self.step),
            gradient: self.gradient.as_ref().map(machine),
        }
    }
}

/// The field with all that it calls, so that what does not count in a region can be left out wherever it stands; a field
/// that is too large for that stays as it is.
fn written_out_if_small(program: &mut Program, map: FunctionId) -> FunctionId {
    if sdf_ir::cost::operations(program, map) > WRITTEN_OUT {
        return map;
    }
    let written_out = sdf_ir::written_out(program, program.function(map));
    program.add(written_out)
}

/// Answers questions about one scene, one after the other.
pub struct Prover<'c> {
    field: Option<Field<'c>>,
    ray: Machine<'c, f64>,
    step: Machine<'c, f64>,
    gradient: Option<Machine<'c, f64>>,
}

impl Prover<'_> {
    /// The ray through a pixel's coordinate, from the bottom left. It is what `f64` makes of the camera: what is proved
    /// is proved of exactly this ray.
    pub fn ray(&mut self, coordinate: [f64; 2]) -> Ray {
        let results: [f64; 9] = run(&mut self.ray, &coordinate);
        let vector = |at: usize| [results[at], results[at + 1], results[at + 2]];
        Ray {
            origin: vector(0),
            direction: vector(3),
            far: results[6],
            width: results[7],
            tolerance: results[8],
        }
    }

    /// How often the field was evaluated over a region so far: the cost of the answers.
    pub fn evaluations(&self) -> u64 {
        self.field.as_ref().map_or(0, |field| field.evaluations)
    }
}

/// The results of a function of one place.
fn run<const COUNT: usize>(machine: &mut Machine<f64>, arguments: &[f64]) -> [f64; COUNT] {
    let inputs: Vec<&[f64]> = arguments.iter().map(std::slice::from_ref).collect();
    let mut outputs = [0.0; COUNT];
    machine.run(&inputs, &mut outputs.each_mut().map(std::slice::from_mut));
    outputs
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// `a + b·k`
fn moved(a: Vector, b: Vector, k: f64) -> Vector {
    std::array::from_fn(|i| a[i] + b[i] * k)
}
