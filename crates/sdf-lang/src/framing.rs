//! Where the bounded parts of a scene are, for the camera that frames them: what they fill at time 0 with the params'
//! defaults, closer than a box is. Steps tell in which cells there is no surface; the search begins in the box that is
//! proved of the parts, or in a cube of all that may be drawn.

use crate::eval::Elaborator;
use crate::expansion::OPERATION_LIMIT;
use crate::value::Shape;
use glam::DVec3;
use sdf_ir::cost::operations;
use sdf_ir::eval::{Machine, Tape};
use sdf_ir::simplify;
use sdf_syntax::Span;
use std::rc::Rc;
use std::sync::Arc;

/// What is framed where nothing is bounded: a ball round a box of 2.
const DEFAULT: (DVec3, f64) = (DVec3::ZERO, 1.732);
/// Half the size of the cube that is searched; what reaches its border counts as unbounded.
const REACH: f64 = 1_048_576.0;
/// How fine the cells get, as a share of what they cover together.
const FINEST: f64 = 0.04;
/// How many distances to parts one level may take: where there are many parts, the cells stay larger.
const MOST_WORK: usize = 4_000_000;

/// A ball round all bounded parts, at time 0 and with the params' defaults: centre and radius.
pub(crate) fn ball<'t>(elaborator: &mut Elaborator<'t>, parts: &[Rc<Shape<'t>>]) -> (DVec3, f64) {
    let points = cells_of_bounded(elaborator, parts);
    let Some((low, high)) = corners(&points) else { return DEFAULT };
    let center = (low + high) / 2.0;
    let radius = points.iter().map(|p| p.distance(center)).fold(0.0, f64::max);
    // Rounded, so that the camera of a symmetric scene looks at its very centre.
    let center = (center * 1024.0).round() / 1024.0 + DVec3::ZERO;
    (center, if radius > 0.0 { radius } else { DEFAULT.1 })
}

/// The corners of the box round some points.
fn corners(points: &[DVec3]) -> Option<(DVec3, DVec3)> {
    let low = points.iter().copied().reduce(DVec3::min)?;
    let high = points.iter().copied().reduce(DVec3::max)?;
    Some((low, high))
}

/// The cells of all parts that are bounded. Parts are searched together, and one by one only where one of them
/// is unbounded.
fn cells_of_bounded<'t>(elaborator: &mut Elaborator<'t>, parts: &[Rc<Shape<'t>>]) -> Vec<DVec3> {
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
fn cells<'t>(elaborator: &mut Elaborator<'t>, parts: &[Rc<Shape<'t>>]) -> Option<Vec<DVec3>> {
    let proved = elaborator.extent_of_all(parts, 0.0).ok()?;
    if proved.is_empty() {
        return Some(Vec::new());
    }
    let field = Field::new(elaborator, parts)?;
    let mut machine = Machine::<f64>::new(&field.tape);
    let is_proved = proved.is_bounded();
    let mut half = if is_proved { proved.size().into_iter().fold(1e-6, f64::max) / 2.0 } else { REACH };
    let mut cells = vec![if is_proved { DVec3::from_array(proved.center()) } else { DVec3::ZERO }];
    loop {
        let quarter = half / 2.0;
        let sign = |k: i32, bit: i32| if k >> bit & 1 == 1 { quarter } else { -quarter };
        let children: Vec<DVec3> = cells
            .iter()
            .flat_map(|c| (0..8).map(|k| *c + DVec3::new(sign(k, 0), sign(k, 1), sign(k, 2))))
            .collect();
        half = quarter;
        let distances = field.distances(&mut machine, &children);
        cells = children
            .into_iter()
            .zip(distances)
            .filter(|(_, d)| *d <= half * 3f64.sqrt())
            .map(|(c, _)| c)
            .collect();
        let at_border = |c: &DVec3| c.abs().max_element() + 1.5 * half > REACH;
        let Some((low, high)) = corners(&cells) else { return Some(cells) };
        if !is_proved && half <= REACH / 8.0 && cells.iter().any(at_border) {
            return None;
        }
        let extent = (high - low).max_element();
        let is_fine = half <= FINEST * extent || 8 * cells.len() * parts.len() > MOST_WORK;
        if ((is_proved || half <= REACH / 8.0) && is_fine) || half < 1e-6 {
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

    fn distances(&self, machine: &mut Machine<'_, f64>, points: &[DVec3]) -> Vec<f64> {
        let axis = |i: usize| points.iter().map(|p| p[i]).collect::<Vec<f64>>();
        let (x, y, z) = (axis(0), axis(1), axis(2));
        let mut out = vec![0.0; points.len()];
        machine.run(&[&x, &y, &z], &mut [&mut out]);
        out
    }
}
