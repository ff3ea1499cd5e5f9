//! Where the bounded parts of a scene are, for the camera that frames them. Not a proof: the field is taken to be
//! one that never promises too much, and sampled at the centres of cells that are split where it may be zero.

use crate::eval::Elaborator;
use crate::scene::OPERATION_LIMIT;
use crate::value::Shape;
use sdf_ir::cost::operations;
use sdf_ir::eval::{Machine, Tape};
use sdf_ir::simplify;
use sdf_syntax::Span;
use std::rc::Rc;
use std::sync::Arc;

/// What is framed where nothing is bounded: a ball round a box of 2.
const DEFAULT: ([f64; 3], f64) = ([0.0; 3], 1.732);
/// Half the size of the cube that is searched; what reaches its border counts as unbounded.
const REACH: f64 = 1_048_576.0;
/// How fine the cells get, as a share of what they cover together.
const FINEST: f64 = 0.04;
/// How many distances to parts one level may take: where there are many parts, the cells stay larger.
const MOST_WORK: usize = 4_000_000;

/// A ball round all bounded parts, at time 0 and with the params' defaults: centre and radius.
pub(crate) fn ball<'t>(elaborator: &mut Elaborator<'t>, parts: &[Rc<Shape<'t>>]) -> ([f64; 3], f64) {
    let points = cells_of_bounded(elaborator, parts);
    if points.is_empty() {
        return DEFAULT;
    }
    let edge = |pick: fn(f64, f64) -> f64, i: usize| points.iter().map(|p| p[i]).reduce(pick).unwrap_or(0.0);
    let center: [f64; 3] = std::array::from_fn(|i| (edge(f64::min, i) + edge(f64::max, i)) / 2.0);
    let distance = |p: &[f64; 3]| (0..3).map(|i| (p[i] - center[i]).powi(2)).sum::<f64>().sqrt();
    let radius = points.iter().map(distance).fold(0.0, f64::max);
    (center.map(round), if radius > 0.0 { radius } else { DEFAULT.1 })
}

/// Centres are rounded, so that the camera of a symmetric scene looks at its very centre.
fn round(x: f64) -> f64 {
    (x * 1024.0).round() / 1024.0 + 0.0
}

/// The cells of all parts that are bounded. Parts are searched together, and one by one only where one of them
/// is unbounded.
fn cells_of_bounded<'t>(elaborator: &mut Elaborator<'t>, parts: &[Rc<Shape<'t>>]) -> Vec<[f64; 3]> {
    if parts.is_empty() {
        return Vec::new();
    }
    if let Some(found) = cells(elaborator, parts) {
        return found;
    }
    let (left, right) = parts.split_at(parts.len() / 2);
    if left.is_empty() {
        return Vec::new();
    }
    let mut found = cells_of_bounded(elaborator, left);
    found.extend(cells_of_bounded(elaborator, right));
    found
}

/// The centres of small cells in which the surface or the inside of a union may be; nothing if it is unbounded.
fn cells<'t>(elaborator: &mut Elaborator<'t>, parts: &[Rc<Shape<'t>>]) -> Option<Vec<[f64; 3]>> {
    let field = Field::new(elaborator, parts)?;
    let mut machine = Machine::<f64>::new(&field.tape);
    let mut half = REACH;
    let mut cells = vec![[0.0; 3]];
    loop {
        let quarter = half / 2.0;
        let children: Vec<[f64; 3]> = cells
            .iter()
            .flat_map(|c| {
                (0..8)
                    .map(|k| std::array::from_fn(|i| c[i] + if k >> i & 1 == 1 { quarter } else { -quarter }))
            })
            .collect();
        half = quarter;
        let distances = field.distances(&mut machine, &children);
        cells = children
            .into_iter()
            .zip(distances)
            .filter(|(_, d)| *d <= half * 3f64.sqrt())
            .map(|(c, _)| c)
            .collect();
        let at_border = |c: &[f64; 3]| c.iter().any(|x| x.abs() + 1.5 * half > REACH);
        if cells.is_empty() {
            return Some(cells);
        }
        if half <= REACH / 8.0 && cells.iter().any(at_border) {
            return None;
        }
        let extent = (0..3)
            .map(|i| {
                let all = cells.iter().map(|c| c[i]);
                all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
            })
            .fold(0.0, f64::max);
        let is_fine = half <= FINEST * extent || 8 * cells.len() * parts.len() > MOST_WORK;
        if (half <= REACH / 8.0 && is_fine) || half < 1e-6 {
            return Some(cells);
        }
    }
}

/// The field of a union, ready to be sampled.
struct Field {
    tape: Tape,
}

impl Field {
    fn new<'t>(elaborator: &mut Elaborator<'t>, parts: &[Rc<Shape<'t>>]) -> Option<Field> {
        elaborator.contexts.open(&Arc::from("extent"), None);
        let point = elaborator.contexts.entry_parameter("p", sdf_ir::Type::Vec3);
        let Ok(distance) = elaborator.nearest_step(parts, &point, Span::default()) else {
            elaborator.contexts.discard();
            return None;
        };
        let distance = elaborator.contexts.value(&distance);
        // Kept apart from the program, which would grow by a function for each part.
        let (function, _) = elaborator.contexts.finish_apart(vec![distance]);
        let mut program = elaborator.contexts.snapshot();
        program.entry = Some(program.add(function));
        let (program, _) = simplify(&program, &[]);
        if operations(&program, program.entry?) > OPERATION_LIMIT {
            // The scene is too large altogether, which is said elsewhere.
            return None;
        }
        Some(Field { tape: Tape::compile(&program, program.entry?) })
    }

    fn distances(&self, machine: &mut Machine<'_, f64>, points: &[[f64; 3]]) -> Vec<f64> {
        let axis = |i: usize| points.iter().map(|p| p[i]).collect::<Vec<f64>>();
        let (x, y, z) = (axis(0), axis(1), axis(2));
        let mut out = vec![0.0; points.len()];
        machine.run(&[&x, &y, &z], &mut [&mut out]);
        out
    }
}
