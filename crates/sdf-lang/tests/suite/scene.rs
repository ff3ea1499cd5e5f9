//! A scene, compiled and verified, with its distances at hand.

use sdf_ir::eval::{Machine, Tape, point};
use sdf_ir::{Constant, FunctionId, Program};
use sdf_lang::{Compilation, Imports, Options, Scene, Texts};
use std::sync::Arc;

/// A point of space.
pub type Point = [f64; 3];

/// Compiles a scene, whatever comes of it; every program that is made is well formed.
pub fn compile(text: &str, set: &[(&str, &str)]) -> Compilation {
    compile_with(text, &[], set)
}

/// The same with files that the scene may import.
pub fn compile_with(text: &str, files: &[(&str, &str)], set: &[(&str, &str)]) -> Compilation {
    let texts = Texts(files.iter().map(|(name, text)| (name.to_string(), text.to_string())).collect());
    let imports = Imports::from(Arc::new(texts));
    let set = set.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    // Fields that compute something else than distances promise a slope that they do not have.
    let options = Options { set, imports, attack: Some(0), ..Options::default() };
    let compilation = sdf_lang::compile("scene.sdf", text, &options);
    if let Some(scene) = &compilation.scene {
        assert_eq!(sdf_ir::verify(&scene.program), Ok(()), "in\n{text}");
    }
    compilation
}

/// Compiles a scene that is right.
pub fn scene(text: &str) -> Scene {
    scene_set(text, &[])
}

/// The same with params set.
pub fn scene_set(text: &str, set: &[(&str, &str)]) -> Scene {
    let compilation = compile(text, set);
    assert!(!compilation.has_errors(), "{:#?}\nin\n{text}", compilation.diagnostics);
    compilation.scene.expect("a scene without errors")
}

/// The findings about a text, as `code: message; help`, in the order of the source.
pub fn findings(text: &str) -> Vec<String> {
    described(&sdf_lang::compile("scene.sdf", text, &Options::default()))
}

/// The findings of a compilation.
pub fn described(compilation: &Compilation) -> Vec<String> {
    compilation
        .diagnostics
        .iter()
        .map(|d| format!("{}: {}; {}", d.code, d.message, d.help.clone().unwrap_or_default()))
        .collect()
}

/// The defaults of all uniforms.
pub fn defaults(program: &Program) -> Vec<Constant> {
    program.uniforms.iter().map(|u| u.default).collect()
}

/// The field of a scene's shapes.
pub struct Field {
    program: Program,
    map: FunctionId,
    tape: Tape,
}

impl Field {
    /// The field of a whole scene.
    pub fn of(text: &str) -> Field {
        Field::of_scene(scene(text), text)
    }

    /// The field of `scene { SHAPE }` after these items.
    pub fn of_shape(items: &str, shape: &str) -> Field {
        Field::of(&format!("{items}\nscene {{ {shape} }}\n"))
    }

    /// A number at each point, by an expression in `p` that need not be a distance to anything.
    pub fn of_values(items: &str, expr: &str) -> Field {
        let tested = format!("@lipschitz(1)\nlet tested = field {{ {expr} }}");
        Field::of(&format!("{items}\n{tested}\nscene {{ tested, plane(y, 1e6) }}"))
    }

    /// The field of a scene that is compiled already.
    pub fn of_scene(scene: Scene, text: &str) -> Field {
        let map = scene.map.unwrap_or_else(|| panic!("no field in\n{text}"));
        let tape = Tape::compile(&scene.program, map);
        Field { program: scene.program, map, tape }
    }

    /// The distance at one point, node by node.
    pub fn at(&self, p: Point) -> f64 {
        self.at_with(p, &defaults(&self.program))
    }

    /// The same with values for the uniforms.
    pub fn at_with(&self, p: Point, uniforms: &[Constant]) -> f64 {
        point(&self.program, self.map, &[Constant::Vec3(p)], uniforms)[0].components()[0]
    }

    /// The distances at many points.
    pub fn distances(&self, points: &[Point]) -> Vec<f64> {
        let axis = |i: usize| points.iter().map(|p| p[i]).collect::<Vec<f64>>();
        let (x, y, z) = (axis(0), axis(1), axis(2));
        let mut out = vec![0.0; points.len()];
        Machine::<f64>::new(&self.tape).run(&[&x, &y, &z], &mut [&mut out]);
        out
    }

    /// The gradients at many points, by central differences.
    pub fn gradients(&self, points: &[Point]) -> Vec<Point> {
        const STEP: f64 = 1e-6;
        let moved = |i: usize, by: f64| -> Vec<Point> {
            points.iter().map(|p| std::array::from_fn(|k| p[k] + if k == i { by } else { 0.0 })).collect()
        };
        let slopes: Vec<Vec<f64>> = (0..3)
            .map(|i| {
                let (ahead, behind) = (self.distances(&moved(i, STEP)), self.distances(&moved(i, -STEP)));
                ahead.iter().zip(behind).map(|(a, b)| (a - b) / (2.0 * STEP)).collect()
            })
            .collect();
        (0..points.len()).map(|k| std::array::from_fn(|i| slopes[i][k])).collect()
    }
}

/// `count` points of the cube from `-size` to `size`, the same in every run and on no plane of symmetry.
pub fn points(count: usize, size: f64) -> Vec<Point> {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        ((state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0) * size
    };
    (0..count).map(|_| std::array::from_fn(|_| next())).collect()
}

/// The length of a vector.
pub fn length(v: Point) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
