//! The true field of a scene, in `f64`.

use super::vector::{Vector, dot, minus, plus, times};
use crate::scenes::scene;
use sdf_ir::Constant;
use sdf_ir::eval::{Machine, Tape};
use sdf_lang::Options;
use sdf_render::Frame;

/// The field of a scene.
pub struct Field {
    tape: Tape,
    uniforms: Vec<Constant>,
}

/// What evaluates a field, one at a time.
pub struct Probe<'f>(Machine<'f, f64>);

/// The half of what differences are taken over.
const STEP: f64 = 1e-6;

impl Field {
    /// The field of a scene near the origin.
    pub fn of(text: &str) -> Field {
        let made = scene("field", text, &Options { attack: Some(0), ..Options::default() });
        assert_eq!(made.origin, [0.0; 3], "coordinates are the scene's");
        let tape = Tape::compile(&made.program, made.map.expect("a scene that is something"));
        Field { tape, uniforms: Frame::new(1, 1).uniforms(&made.program) }
    }

    /// What evaluates it.
    pub fn probe(&self) -> Probe<'_> {
        let mut machine = Machine::new(&self.tape);
        machine.set_uniforms(&self.uniforms);
        Probe(machine)
    }
}

impl Probe<'_> {
    /// The distances at these parameters of a line.
    pub fn along(&mut self, from: Vector, direction: Vector, at: &[f64]) -> Vec<f64> {
        self.distances(&at.iter().map(|t| plus(from, times(direction, *t))).collect::<Vec<Vector>>())
    }

    /// The distances at places.
    pub fn distances(&mut self, places: &[Vector]) -> Vec<f64> {
        let columns = [0, 1, 2].map(|k| places.iter().map(|place| place[k]).collect::<Vec<f64>>());
        let mut distances = vec![0.0; places.len()];
        self.0.run(&columns.each_ref().map(Vec::as_slice), &mut [&mut distances]);
        distances
    }

    /// The distance at a place.
    pub fn at(&mut self, place: Vector) -> f64 {
        self.0.run_one(&place)[0]
    }

    /// How the distance changes at a place, by central differences.
    pub fn gradient(&mut self, place: Vector) -> Vector {
        std::array::from_fn(|k| {
            let mut off = [0.0; 3];
            off[k] = STEP;
            (self.at(plus(place, off)) - self.at(minus(place, off))) / (2.0 * STEP)
        })
    }

    /// The place of the surface that is next to one near it.
    pub fn on_surface(&mut self, mut place: Vector) -> Vector {
        for _ in 0..4 {
            let (d, slope) = (self.at(place), self.gradient(place));
            place = minus(place, times(slope, d / dot(slope, slope).max(1e-9)));
        }
        place
    }
}
