//! Fields as functions of a point, apart from any picture, and how far two computations of one may lie apart.

use crate::numbers::word;
use crate::scenes::{legalised, scene};
use sdf_ir::eval::{Machine, Tape};
use sdf_ir::number::{Dual, Number};
use sdf_ir::{FunctionId, Program};
use sdf_lang::Options;
use sdf_syntax::tree::ItemKind;

/// A scene's field, which depends on nothing but the point.
#[derive(Debug, Clone)]
pub struct Field {
    /// The distance, in the operations of the language.
    pub distance: Program,
    /// The distance and its gradient, in the operations of the language.
    pub gradient: Program,
}

impl Field {
    /// That of a source, at time 0.7 and with its params at their defaults.
    pub fn of(name: &str, text: &str) -> Field {
        // A field that jumps on purpose states a slope that it has between its jumps.
        let options = Options { attack: Some(0), ..Options::default() };
        let scene = scene(name, &still(text), &options);
        let map = scene.map.unwrap_or_else(|| panic!("{name} has no field"));
        let field = Field::of_map(&scene.program, map);
        assert!(field.gradient.uniforms.is_empty(), "{name} depends on more than the point");
        field
    }

    /// That of a program's function of a point.
    pub fn of_map(program: &Program, map: FunctionId) -> Field {
        let mut program = Program { entry: Some(map), ..program.clone() };
        let gradient = sdf_ir::gradient(&mut program, map);
        let [distance, gradient] = [map, gradient].map(|function| {
            let program = Program { entry: Some(function), ..program.clone() };
            sdf_ir::simplify(&program, &[]).0
        });
        Field { distance, gradient }
    }

    /// That of an expression that is a shape.
    pub fn of_expression(expression: &str) -> Field {
        let text = format!("@lipschitz(1)\nlet subject = {expression}\nscene {{ subject }}\n");
        Field::of(expression, &text)
    }
}

/// The source with `let`s in place of its params and of what changes from frame to frame.
fn still(text: &str) -> String {
    let compilation = sdf_lang::compile("still", text, &Options::default());
    let mut still = text.to_string();
    for item in compilation.tree.items.iter().rev() {
        if let ItemKind::Param { name, default, .. } = &item.kind {
            let value = &text[default.span.start as usize..default.span.end as usize];
            let place = item.span.start as usize..item.span.end as usize;
            still.replace_range(place, &format!("let {} = {value}", name.text));
        }
    }
    still + "\nlet time = 0.7\nlet mouse = (0.3, 0.6)\n"
}

/// The entry of a program, which must have one.
pub fn entry(program: &Program) -> FunctionId {
    program.entry.expect("an entry")
}

/// A program in the operations of hardware.
pub fn on_hardware(program: &Program) -> Program {
    legalised(program, entry(program))
}

/// What a program makes of points, each result a column.
pub fn run<N: Number>(program: &Program, points: &[Vec<N>]) -> Vec<Vec<N>> {
    let tape = Tape::compile(program, entry(program));
    let mut outputs = vec![vec![N::from_f64(0.0); points[0].len()]; tape.output_count()];
    let inputs: Vec<&[N]> = points.iter().map(Vec::as_slice).collect();
    let mut slices: Vec<&mut [N]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    Machine::<N>::new(&tape).run(&inputs, &mut slices);
    outputs
}

/// The gradient of a distance by dual numbers, each component a column.
pub fn by_duals(distance: &Program, points: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let variables = points.iter().enumerate();
    let variables: Vec<Vec<Dual<f64>>> =
        variables.map(|(axis, column)| column.iter().map(|x| Dual::variable(*x, axis)).collect()).collect();
    let results = run(distance, &variables);
    (0..3).map(|axis| results[0].iter().map(|dual| dual.slope[axis]).collect()).collect()
}

/// Points between -4 and 4, a column for each coordinate, the same on every run.
pub fn points(count: usize) -> Vec<Vec<f32>> {
    let coordinate = |axis: usize, i: usize| {
        let bits = word((axis * 0x10_0000 + i) as u64);
        (f64::from(bits) / f64::from(u32::MAX) * 8.0 - 4.0) as f32
    };
    (0..3).map(|axis| (0..count).map(|i| coordinate(axis, i)).collect()).collect()
}

/// Points on the axes, in the planes between them, at the origin and far away.
pub fn nasty_points() -> Vec<Vec<f32>> {
    const COORDINATES: [f32; 10] = [0.0, -0.0, 1.0, -1.0, 0.5, 1e-20, 1e6, -1e6, 1e18, -1e18];
    let n = COORDINATES.len();
    let coordinate = |axis: u32, i: usize| COORDINATES[i / n.pow(axis) % n];
    (0..3).map(|axis| (0..n.pow(3)).map(|i| coordinate(axis, i)).collect()).collect()
}

/// The columns in `f64`.
pub fn wide(columns: &[Vec<f32>]) -> Vec<Vec<f64>> {
    columns.iter().map(|column| column.iter().map(|x| f64::from(*x)).collect()).collect()
}

/// The distance between an `f32` of this magnitude and the next.
pub fn ulp(x: f64) -> f64 {
    let x = x.abs().clamp(f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX)) as f32;
    f64::from(x) - f64::from(x.next_down())
}

/// How far two computations of the same lie apart. The unit at a point is the ulp of the largest of 1, twice the
/// magnitude of each coordinate and twice that of each result there: about the largest number met on the way, since
/// unit vectors and cells have the size 1, and what is turned or mirrored reaches twice the coordinates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Spread {
    /// How many points there are.
    pub points: usize,
    /// How many have a result that is not equal in both; zeros of either sign are.
    pub unequal: usize,
    /// The largest difference in units where the field is not steep.
    pub worst: f64,
    /// How many differ by more than was allowed, and by no more than the results change from the point to those
    /// beside it, a unit away along each axis: creases and jumps.
    pub steep: usize,
    /// Those that differ by more than that, in words.
    pub wrong: Vec<String>,
}

/// How far gradients may change within the root of a unit for this to count as a crease.
const TIE: f64 = 2e-3;

/// Compares results at points. `beside` computes the results in `f64` at other points.
pub fn spread(
    points: &[Vec<f32>],
    expected: &[Vec<f64>],
    found: &[Vec<f64>],
    allowed: f64,
    beside: impl Fn(&[Vec<f64>]) -> Vec<Vec<f64>>,
) -> Spread {
    let mut spread = Spread { points: points[0].len(), ..Spread::default() };
    for i in 0..spread.points {
        let at = |columns: &[Vec<f64>]| columns.iter().map(|c| c[i]).collect::<Vec<f64>>();
        let (point, e, f) =
            (points.iter().map(|c| f64::from(c[i])).collect::<Vec<_>>(), at(expected), at(found));
        let finite = e.iter().chain(&f).all(|x| x.is_finite());
        if !finite {
            spread.wrong.push(format!("{point:?}: {e:?} and {f:?} are not all finite"));
            continue;
        }
        let largest = point.iter().chain(&e).chain(&f).fold(0.0f64, |m, x| m.max(x.abs()));
        let unit = ulp((2.0 * largest).max(1.0));
        let difference = e.iter().zip(&f).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        spread.unequal += usize::from(e != f);
        let units = difference / unit;
        if units > allowed {
            let near = change_beside(&point, unit, &beside);
            // Of two distances that touch, the lesser is either over a width of the unit's square root. They agree
            // there, but their gradients do not.
            let touching = change_beside(&point, unit.sqrt(), &beside).min(TIE);
            let of_distance = (e[0] - f[0]).abs() / unit <= allowed;
            let change = if of_distance { near.max(touching) } else { near };
            if difference <= change + allowed * unit {
                spread.steep += 1;
            } else {
                spread.wrong.push(format!("{point:?}: {e:?} and {f:?}, {units:.1} units apart"));
            }
        } else {
            spread.worst = spread.worst.max(units);
        }
    }
    spread
}

/// How many units `f32` and `f64` may lie apart.
const ROUNDING: f64 = 64.0;

/// The `f32` lanes against `f64`.
pub fn in_f32(program: &Program, points: &[Vec<f32>]) -> Spread {
    let found = wide(&run::<f32>(&on_hardware(program), points));
    let expected = run::<f64>(program, &wide(points));
    spread(points, &expected, &found, ROUNDING, |near| run::<f64>(program, near))
}

/// How far the results at a point and at those within `reach` of it lie apart.
fn change_beside(point: &[f64], reach: f64, results: &impl Fn(&[Vec<f64>]) -> Vec<Vec<f64>>) -> f64 {
    let steps = [-1.0, 0.0, 1.0];
    let offset = |axis: u32, i: usize| steps[i / 3usize.pow(axis) % 3] * reach;
    let near: Vec<Vec<f64>> =
        (0..3).map(|axis| (0..27).map(|i| point[axis as usize] + offset(axis, i)).collect()).collect();
    let range = |column: &Vec<f64>| {
        let [low, high] = [f64::min, f64::max].map(|pick| column.iter().copied().reduce(pick).unwrap_or(0.0));
        high - low
    };
    results(&near).iter().map(range).fold(0.0, f64::max)
}
