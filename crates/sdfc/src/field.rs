//! Distances for programs that need them: a scene's field at any points, in `f64`, on all cores.

use crate::{Compiled, Frame};
use sdf_ir::eval::{Tape, run_parallel};
use sdf_ir::{Constant, FunctionId, Program};

/// From here on a distance stands for that of a scene that is nothing.
const NOTHING: f64 = 1e20;

/// The field of a scene: how far each point is from the nearest surface, in which direction the distance grows, and
/// what the surface looks like.
///
/// ```
/// use sdfc::{Clock, Constant, Field, Frame, Options};
///
/// let text = "
///     param size = 1 in 0..2
///     scene { sphere(size).paint(#f00), box(1).at(0, time, 5) }";
/// let options = Options { query: true, ..Options::default() };
/// let compiled = sdfc::compile("ball.sdf", text, &options, &mut Clock::default());
/// let mut field = Field::new(&compiled).expect("a scene without mistakes");
///
/// // Negative inside; the gradient is the normal, outward and of length 1 where the field is a distance.
/// assert_eq!(field.distance(&[[0.0, 3.0, 0.0], [0.0, 0.0, 0.5]]), [2.0, -0.5]);
/// assert_eq!(field.gradient(&[[0.0, 3.0, 0.0]]), [[0.0, 1.0, 0.0]]);
/// assert_eq!(field.sample(&[[0.0, 3.0, 0.0]])[0].material.color, [1.0, 0.0, 0.0]);
///
/// // At another time, or with other values of params.
/// let mut frame = Frame { time: 4.0, ..Frame::new(1, 1) };
/// frame.params.insert("size".into(), Constant::Float(0.5));
/// field.set(&frame);
/// assert_eq!(field.distance(&[[0.0, 3.0, 0.0], [0.0, 4.0, 3.0]]), [2.5, 1.0]);
/// ```
#[derive(Debug, Clone)]
pub struct Field {
    /// The uniforms, and nothing else.
    program: Program,
    values: Vec<Constant>,
    distance: Tape,
    gradient: Tape,
    material: Tape,
}

/// What a field is like at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The distance, negative inside; infinite where the scene is nothing.
    pub distance: f64,
    /// The gradient of the distance; zero where there is none.
    pub gradient: [f64; 3],
    /// The material that the surface would have here.
    pub material: Material,
}

/// The properties of a material, as the language has them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct Material {
    /// In linear light.
    pub color: [f64; 3],
    pub specular: f64,
    pub shininess: f64,
    /// In linear light.
    pub emission: [f64; 3],
    /// In linear light.
    pub glow: [f64; 3],
    pub glow_radius: f64,
    pub reflect: f64,
    pub transmit: f64,
    pub ior: f64,
}

/// A property of a material: one number, or a colour.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub enum Property {
    Number(f64),
    Color([f64; 3]),
}

impl Property {
    /// The number, or the three of the colour.
    pub fn components(&self) -> &[f64] {
        match self {
            Property::Number(x) => std::slice::from_ref(x),
            Property::Color(c) => c,
        }
    }
}

impl Material {
    /// The properties with their names in the language, in its order.
    pub fn properties(&self) -> [(&'static str, Property); 9] {
        [
            ("color", Property::Color(self.color)),
            ("specular", Property::Number(self.specular)),
            ("shininess", Property::Number(self.shininess)),
            ("emission", Property::Color(self.emission)),
            ("glow", Property::Color(self.glow)),
            ("glow_radius", Property::Number(self.glow_radius)),
            ("reflect", Property::Number(self.reflect)),
            ("transmit", Property::Number(self.transmit)),
            ("ior", Property::Number(self.ior)),
        ]
    }
}

impl Field {
    /// The field of a scene that was compiled with [`Options::query`](crate::Options::query), at time 0 and with the
    /// params' defaults. There is none where the scene had mistakes, or was compiled without.
    pub fn new(compiled: &Compiled) -> Option<Field> {
        let (scene, _) = compiled.output.as_ref()?;
        let query = scene.query?;
        let tape = |function: FunctionId| Tape::compile(&scene.program, function);
        let program = Program { uniforms: scene.program.uniforms.clone(), ..Program::default() };
        Some(Field {
            values: Frame::new(1, 1).uniforms(&program),
            program,
            distance: tape(query.distance),
            gradient: tape(query.gradient),
            material: tape(query.material),
        })
    }

    /// From now on the time, the pointer and the params are those of the frame. Its size does not matter.
    pub fn set(&mut self, frame: &Frame) {
        self.values = frame.uniforms(&self.program);
    }

    /// The distances of points to the scene, negative inside; infinite where the scene is nothing.
    pub fn distance(&self, points: &[[f64; 3]]) -> Vec<f64> {
        let [distances] = &self.run(&self.distance, points)[..] else { unreachable!("it is a float") };
        distances.iter().copied().map(distance).collect()
    }

    /// The gradients of the distance, which costs about as much as two distances.
    pub fn gradient(&self, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let columns = self.run(&self.gradient, points);
        (0..points.len()).map(|i| [1, 2, 3].map(|k| columns[k][i])).collect()
    }

    /// Distances, gradients and materials at once.
    pub fn sample(&self, points: &[[f64; 3]]) -> Vec<Sample> {
        let columns = self.run(&self.material, points);
        let sample = |i: usize| {
            let number = |at: usize| columns[at][i];
            let color = |at: usize| [0, 1, 2].map(|k| columns[at + k][i]);
            // In the order of `sdf_lang::Query::material`.
            let material = Material {
                color: color(4),
                specular: number(7),
                shininess: number(8),
                emission: color(9),
                glow: color(12),
                glow_radius: number(15),
                reflect: number(16),
                transmit: number(17),
                ior: number(18),
            };
            Sample { distance: distance(number(0)), gradient: color(1), material }
        };
        (0..points.len()).map(sample).collect()
    }

    /// The results of a function of a point, component by component.
    fn run(&self, tape: &Tape, points: &[[f64; 3]]) -> Vec<Vec<f64>> {
        let inputs = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<f64>>());
        let mut outputs = vec![vec![0.0; points.len()]; tape.output_count()];
        let mut slices: Vec<&mut [f64]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
        run_parallel(tape, &self.values, &inputs.each_ref().map(Vec::as_slice), &mut slices);
        outputs
    }
}

/// A distance, as it is told: infinite where it is that of nothing.
fn distance(d: f64) -> f64 {
    if d.abs() >= NOTHING { d.signum() * f64::INFINITY } else { d }
}
