//! Attacks on what a file promises of its fields: points and pairs of points are tried, and the first at which a
//! promise fails is named.

use crate::contract::Quality;
use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::facts::listing::parts;
use crate::value::{Shape, ShapeKind};
use sdf_ir::eval::{Machine, Tape};
use sdf_ir::region::Extent;
use sdf_ir::{Constant, Program, Role, Type, Uniform};
use sdf_syntax::Span;
use sdf_syntax::tree::Dimension;
use std::collections::HashSet;
use std::rc::Rc;
use std::sync::Arc;

/// How far round the origin points are tried where a shape has no end, and at most elsewhere.
const REACH: f64 = 16.0;
/// The distances of the pairs that are tried.
const DISTANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
/// By how much a slope may exceed what is promised: the rounding of the difference of two distances.
const SLACK: f64 = 1e-6;
/// How often points are led on to the surface, by the gradient there.
const PROJECTIONS: usize = 4;
/// With how many others each point of a shape that is said to be convex is tried.
const PARTNERS: usize = 4;
/// What counts as a point of a shape, and what as one outside of it, as shares of the size: sheets hold no others.
const HELD: f64 = 1e-9;
const BEYOND: f64 = 1e-6;
/// How often the way between two points is halved to see whether the field jumps there.
const HALVINGS: usize = 20;
/// For how many values of the params, and times, the points are tried.
const FRAMES: usize = 4;
/// Times are tried from 0 up to this, in seconds, and one that a page left open comes to.
const SOON: f64 = 20.0;
const LATE: f64 = 3600.0;

/// A promise that does not hold, and where.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Broken {
    /// Between two points the field changes by more than is promised; the slope there, and what it may be.
    Slope { a: [f64; 3], b: [f64; 3], slope: f64, promised: f64 },
    /// A point of the shape, outside of the box that is promised.
    Bounds { at: [f64; 3] },
    /// A point where the field is not the distance: the point that is that far away along the gradient is not on
    /// the surface, but the field is this much there.
    Exact { at: [f64; 3], distance: f64, left: f64 },
    /// Two points of the shape, and one between them that is not.
    Convex { a: [f64; 3], b: [f64; 3], between: [f64; 3] },
}

impl<'t> Elaborator<'t> {
    /// Attacks each promise of the user's file that a shape in the scene rests on with about so many points.
    pub fn attack(&mut self, scene: &Rc<Shape<'t>>, points: usize) -> Eval<()> {
        let mut places = HashSet::new();
        let mut seen = HashSet::new();
        let mut waiting = vec![scene.clone()];
        let mut result = Ok(());
        while let Some(shape) = waiting.pop() {
            if !seen.insert(Rc::as_ptr(&shape).cast::<()>()) {
                continue;
            }
            if let ShapeKind::Painted { shape: inner, .. } = &shape.kind {
                waiting.push(inner.clone());
                continue;
            }
            waiting.extend(parts(&shape));
            let stated = self.stated(&shape).filter(|s| s.module.is_user() && s.contract.promises());
            let Some(stated) = stated else { continue };
            let Some(place) = stated.contract.place() else { continue };
            // Each promise is tried on a few of the shapes that are made under it.
            if places.len() > 100 {
                continue;
            }
            if let Some((span, broken)) = self.attack_shape(&shape, points)?
                && places.insert(place)
            {
                result = self.report(errors::broken_promise(span, &broken));
            }
        }
        result
    }

    fn attack_shape(&mut self, shape: &Rc<Shape<'t>>, points: usize) -> Eval<Option<(Span, Broken)>> {
        let Some(stated) = self.stated(shape) else { return Ok(None) };
        let Some(field) = Attacked::new(self, shape)? else { return Ok(None) };
        let extent = self.extent_of(shape, 0.0)?;
        let slope = self.slope_of(shape)?;
        let is_convex = self.claims_convex(&stated)?;
        let tried = tried(&extent);
        for frame in 0..FRAMES {
            let uniforms: Vec<Constant> =
                field.program.uniforms.iter().enumerate().map(|(i, u)| value(u, frame, i)).collect();
            let points = scattered(&tried, points / FRAMES + 8, frame as u64, field.axes);
            if let Some((_, _, span)) = stated.contract.bounds
                && let Some(broken) = field.outside(&uniforms, &points, &extent)
            {
                return Ok(Some((span, broken)));
            }
            if let Some(span) = stated.contract.convex.filter(|_| is_convex)
                && let Some(broken) = field.dented(&uniforms, &extent, points.len(), frame as u64)
            {
                return Ok(Some((span, broken)));
            }
            let Some(span) = stated.contract.slope.map(|s| s.1).or(stated.contract.quality.map(|q| q.1))
            else {
                continue;
            };
            let inside: Vec<[f64; 3]> = match slope.everywhere.is_finite() {
                true => points.clone(),
                false => points.iter().copied().filter(|p| holds(&extent, *p)).collect(),
            };
            let promised = slope.within.min(slope.everywhere);
            if let Some(broken) = field.steeper(&uniforms, &inside, promised) {
                return Ok(Some((span, broken)));
            }
            if slope.quality == Some(Quality::Exact)
                && let Some(broken) = field.inexact(&uniforms, &points, &tried)
            {
                return Ok(Some((span, broken)));
            }
        }
        Ok(None)
    }
}

/// A field under attack.
struct Attacked {
    program: Program,
    tape: Tape,
    axes: usize,
}

impl Attacked {
    fn new<'t>(elaborator: &mut Elaborator<'t>, shape: &Rc<Shape<'t>>) -> Eval<Option<Attacked>> {
        let ty = if shape.dimension == Dimension::Three { Type::Vec3 } else { Type::Vec2 };
        elaborator.contexts.open(&Arc::from("attacked"), None);
        let point = elaborator.contexts.entry_parameter("p", ty);
        let distance = match elaborator.plain_distance(shape, &point, shape.place) {
            Ok(distance) => elaborator.contexts.value(&distance),
            Err(reported) => {
                elaborator.contexts.discard();
                return Err(reported);
            }
        };
        let (function, outside) = elaborator.contexts.finish_apart(vec![distance]);
        if !outside.is_empty() {
            return Ok(None);
        }
        let mut program = elaborator.contexts.snapshot();
        program.entry = Some(program.add(function));
        let (program, _) = sdf_ir::simplify(&program, &[]);
        let tape = Tape::compile(&program, program.entry.expect("it was just set"));
        Ok(Some(Attacked { program, tape, axes: ty.size() }))
    }

    fn distances(&self, uniforms: &[Constant], points: &[[f64; 3]]) -> Vec<f64> {
        let columns: Vec<Vec<f64>> = (0..self.axes).map(|i| points.iter().map(|p| p[i]).collect()).collect();
        let inputs: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let mut out = vec![0.0; points.len()];
        let mut machine = Machine::<f64>::new(&self.tape);
        machine.set_uniforms(uniforms);
        machine.run(&inputs, &mut [&mut out]);
        out
    }

    /// A point of the shape outside of its box.
    fn outside(&self, uniforms: &[Constant], points: &[[f64; 3]], extent: &Extent) -> Option<Broken> {
        let beyond: Vec<[f64; 3]> = points.iter().copied().filter(|p| !holds(extent, *p)).collect();
        let distances = self.distances(uniforms, &beyond);
        let found = beyond.iter().zip(distances).find(|(_, d)| *d < -1e-9);
        found.map(|(at, _)| Broken::Bounds { at: *at })
    }

    /// The steepest pair, if it is steeper than promised.
    fn steeper(&self, uniforms: &[Constant], points: &[[f64; 3]], promised: f64) -> Option<Broken> {
        let here = self.distances(uniforms, points);
        let mut worst: Option<(f64, usize, [f64; 3])> = None;
        for (k, distance) in DISTANCES.into_iter().enumerate() {
            let ends: Vec<[f64; 3]> = points
                .iter()
                .enumerate()
                .map(|(i, p)| moved(*p, distance, self.axes, (i * 4 + k) as u64))
                .collect();
            for (i, (a, b)) in here.iter().zip(self.distances(uniforms, &ends)).enumerate() {
                let length = (0..self.axes).map(|c| (ends[i][c] - points[i][c]).powi(2)).sum::<f64>().sqrt();
                let slope = (a - b).abs() / length;
                if slope > promised * (1.0 + SLACK) + SLACK && worst.is_none_or(|(s, ..)| slope > s) {
                    worst = Some((slope, i, ends[i]));
                }
            }
        }
        worst.map(|(_, i, b)| {
            let (a, b, slope) = self.steepest_part(uniforms, points[i], b);
            Broken::Slope { a, b, slope, promised }
        })
    }

    /// The steeper half of the way between two points, again and again: a jump between them gets steeper without end.
    fn steepest_part(
        &self,
        uniforms: &[Constant],
        mut a: [f64; 3],
        mut b: [f64; 3],
    ) -> ([f64; 3], [f64; 3], f64) {
        let mut best = (a, b, 0.0);
        for _ in 0..HALVINGS {
            let middle: [f64; 3] = std::array::from_fn(|i| (a[i] + b[i]) / 2.0);
            let d = self.distances(uniforms, &[a, middle, b]);
            let length = (0..self.axes).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
            let slope = (d[2] - d[0]).abs() / length;
            if slope > best.2 {
                best = (a, b, slope);
            }
            (a, b) = if (d[1] - d[0]).abs() > (d[2] - d[1]).abs() { (a, middle) } else { (middle, b) };
        }
        best
    }

    /// Two points of the shape and one between them outside of it. Points are tried that lie in its box, and those of its
    /// surface to which their gradients lead.
    fn dented(&self, uniforms: &[Constant], extent: &Extent, count: usize, seed: u64) -> Option<Broken> {
        let near = tried(extent).intersection(extent);
        if near.is_empty() {
            return None;
        }
        let size = near.size().into_iter().fold(0.0, f64::max).max(1e-3);
        let mut held = Vec::new();
        let mut points = scattered(&near, count, seed, self.axes);
        for _ in 0..PROJECTIONS {
            let distances = self.distances(uniforms, &points);
            let is_held = |i: &usize| distances[*i] <= HELD * size;
            held.extend((0..points.len()).filter(is_held).map(|i| points[i]));
            let gradients = self.gradients(uniforms, &points, 1e-6 * size);
            let onto = |i: usize| -> [f64; 3] {
                let steepness = gradients[i].iter().map(|x| x * x).sum::<f64>().max(1e-3);
                std::array::from_fn(|axis| points[i][axis] - gradients[i][axis] * distances[i] / steepness)
            };
            points = (0..points.len()).map(onto).collect();
        }
        let pairs: Vec<_> = (0..held.len() * PARTNERS).map(|i| pair(&held, i, seed)).collect();
        let between: Vec<[f64; 3]> = pairs.iter().map(|(.., between)| *between).collect();
        let distances = self.distances(uniforms, &between);
        let found = pairs.into_iter().zip(distances).find(|(_, d)| *d > BEYOND * size);
        found.map(|((a, b, between), _)| Broken::Convex { a, b, between })
    }

    /// The gradients at points, from the differences over a step.
    fn gradients(&self, uniforms: &[Constant], points: &[[f64; 3]], step: f64) -> Vec<[f64; 3]> {
        let slopes: Vec<Vec<f64>> = (0..self.axes)
            .map(|axis| {
                let shifted = |by: f64| -> Vec<[f64; 3]> {
                    let coordinate = |p: &[f64; 3], i: usize| p[i] + if i == axis { by } else { 0.0 };
                    points.iter().map(|p| std::array::from_fn(|i| coordinate(p, i))).collect()
                };
                let (ahead, behind) =
                    (self.distances(uniforms, &shifted(step)), self.distances(uniforms, &shifted(-step)));
                ahead.iter().zip(behind).map(|(a, b)| (a - b) / (2.0 * step)).collect()
            })
            .collect();
        (0..points.len())
            .map(|i| std::array::from_fn(|axis| slopes.get(axis).map_or(0.0, |s| s[i])))
            .collect()
    }

    /// A point outside from which the way along the gradient does not end on the surface. Points at which the
    /// gradient changes nearby are left out: there the nearest point of the surface is not one alone.
    fn inexact(&self, uniforms: &[Constant], points: &[[f64; 3]], tried: &Extent) -> Option<Broken> {
        let size = tried.size().into_iter().fold(0.0, f64::max).max(1e-3);
        let here = self.distances(uniforms, points);
        let (fine, coarse) =
            (self.gradients(uniforms, points, 1e-6 * size), self.gradients(uniforms, points, 1e-3 * size));
        let ends: Vec<[f64; 3]> = (0..points.len())
            .map(|i| std::array::from_fn(|axis| points[i][axis] - here[i] * fine[i][axis]))
            .collect();
        let there = self.distances(uniforms, &ends);
        (0..points.len())
            .filter(|i| here[*i] > 1e-3 * size)
            .filter(|i| (0..3).all(|axis| (fine[*i][axis] - coarse[*i][axis]).abs() < 1e-3))
            .find(|i| there[*i].abs() > 1e-3 * size)
            .map(|i| Broken::Exact { at: points[i], distance: here[i], left: there[i] })
    }
}

/// Two of some points, and one between them.
fn pair(points: &[[f64; 3]], i: usize, seed: u64) -> ([f64; 3], [f64; 3], [f64; 3]) {
    let any = |n: u64| random(1 << 55 | seed << 40 | (i as u64 * 2 + n));
    let (a, b) = (points[i / PARTNERS], points[(any(0) * points.len() as f64) as usize % points.len()]);
    let t = any(1);
    (a, b, std::array::from_fn(|axis| a[axis] + (b[axis] - a[axis]) * t))
}

/// The box that points are tried in: that of the shape and as much round it.
fn tried(extent: &Extent) -> Extent {
    if extent.is_empty() {
        return Extent { lo: [-2.0; 3], hi: [2.0; 3] };
    }
    let size = extent.size().into_iter().filter(|x| x.is_finite()).fold(0.0, f64::max).clamp(1e-3, REACH);
    let around = extent.grown(size * 0.5);
    let center = extent.center();
    Extent {
        lo: std::array::from_fn(|i| around.lo[i].max(center[i] - REACH)),
        hi: std::array::from_fn(|i| around.hi[i].min(center[i] + REACH)),
    }
}

fn holds(extent: &Extent, p: [f64; 3]) -> bool {
    (0..3).all(|i| extent.lo[i] <= p[i] && p[i] <= extent.hi[i])
}

/// The `n`-th number of a sequence in 0..1 that is the same in every run.
fn random(n: u64) -> f64 {
    let mut h = n.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

fn scattered(within: &Extent, count: usize, seed: u64, axes: usize) -> Vec<[f64; 3]> {
    let coordinate = |i: usize, axis: usize| match axis < axes {
        true => {
            within.lo[axis] + (within.hi[axis] - within.lo[axis]) * random(seed << 40 | (i * 3 + axis) as u64)
        }
        false => 0.0,
    };
    (0..count).map(|i| std::array::from_fn(|axis| coordinate(i, axis))).collect()
}

/// A point at a distance from another, in some direction.
fn moved(p: [f64; 3], distance: f64, axes: usize, seed: u64) -> [f64; 3] {
    let direction: [f64; 3] =
        std::array::from_fn(
            |i| if i < axes { random(1 << 50 | (seed * 3 + i as u64)) * 2.0 - 1.0 } else { 0.0 },
        );
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
    std::array::from_fn(|i| p[i] + direction[i] / length * distance)
}

/// A value of a uniform: its default in the first frame, then any that it can have, ends included.
fn value(uniform: &Uniform, frame: usize, index: usize) -> Constant {
    let any = random(1 << 60 | (frame * 64 + index) as u64);
    match (uniform.role, frame) {
        (_, 0) | (Role::Setting | Role::Resolution | Role::Orbit { .. }, _) => uniform.default,
        (Role::Time, 2) => Constant::Float(LATE),
        (Role::Time, _) => Constant::Float(any * SOON),
        (Role::Mouse, _) => Constant::Vec2([any, 1.0 - any]),
        (Role::Param { range: Some((lo, _)), .. }, 1) => Constant::Float(lo),
        (Role::Param { range: Some((_, hi)), .. }, 2) => Constant::Float(hi),
        (Role::Param { range: Some((lo, hi)), .. }, _) => Constant::Float(lo + (hi - lo) * any),
        (Role::Param { range: None, .. }, _) => match uniform.default {
            Constant::Bool(b) => Constant::Bool(b != (frame == 1)),
            _ => Constant::Vec3([any, 1.0 - any, any * any]),
        },
    }
}
