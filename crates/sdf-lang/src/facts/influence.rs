//! How a field depends on the distances that it samples: whether it grows with one, and how far away a shape matters to
//! the field's surface.

use crate::eval::{Elaborator, Eval};
use crate::facts::derive::{Formula, ROUNDING};
use crate::facts::flat;
use crate::facts::promise::bounds_of_cell;
use crate::value::Shape;
use sdf_ir::Program;
use sdf_ir::interval::{Bounds, Interval, Sloped, Walker};
use sdf_ir::region::Extent;
use sdf_syntax::tree::Dimension;
use std::rc::Rc;

/// How often one proof about a field's samples may ask.
const ASKED: usize = 4000;
/// Of more distances than this a field is not looked at as a function.
const MOST_OTHERS: usize = 3;
/// No distance is larger, not even that to nothing.
const FARTHEST: f64 = 2.0 * crate::NOTHING;
/// The levels that are tried are the shapes' size times a power of 2 between these.
const LEVELS: [i32; 2] = [-10, 4];

/// What of a shape is steep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Steep {
    Nothing,
    /// Some of the shapes in it.
    Parts,
    Whole,
}

/// How a field shows one shape elsewhere.
pub(crate) struct Zoom {
    /// What it multiplies the distance by.
    pub factor: Interval,
    /// How fast the place at which it samples the shape moves with the point, at most.
    pub rate: f64,
}

/// How a field depends on the only distance that it samples.
struct OnlySample {
    /// What it is where that distance is 0.
    at_surface: Interval,
    /// How it changes with that distance.
    factor: Interval,
}

impl<'t> Elaborator<'t> {
    /// How a field draws the one shape that it samples larger or smaller; nothing if it does more, or gets steeper.
    pub fn zoom(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Option<Zoom>> {
        let Some(formula) = self.formula(shape)? else { return Ok(None) };
        let Some(OnlySample { at_surface, factor }) = self.only_sample_of(shape, &formula) else {
            return Ok(None);
        };
        let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
        let mut outer = Walker::new(&self.contexts.program, &formula.outer, &uniforms, &globals);
        let anywhere = bounds_of_cell(&flat(Extent::ALL, shape.dimension), formula.ty);
        let rate = outer.run(&[Sloped::point(anywhere)]).last().map_or(f64::INFINITY, Sloped::norm);
        let is_zoom = at_surface == Interval::ZERO && factor.lo > 0.0 && rate * factor.hi <= 1.0 + ROUNDING;
        Ok(is_zoom.then_some(Zoom { factor, rate: if (rate - 1.0).abs() < ROUNDING { 1.0 } else { rate } }))
    }

    /// Whether a field samples one distance, and never falls where that grows: then it is of a union what the union is of
    /// it.
    pub fn grows_with_its_sample(&mut self, shape: &Rc<Shape<'t>>) -> Eval<bool> {
        let Some(formula) = self.formula(shape)? else { return Ok(false) };
        Ok(self.only_sample_of(shape, &formula).is_some_and(|only| only.factor.lo >= 0.0))
    }

    /// How a field depends on the distance that it samples; nothing if it samples none, or several.
    fn only_sample_of(&mut self, shape: &Rc<Shape<'t>>, formula: &Formula) -> Option<OnlySample> {
        let [only] = &formula.samples[..] else { return None };
        let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
        let program = &self.contexts.program;
        let (mut inner, mut arguments) = of_samples(formula, shape.dimension, program, &uniforms, &globals);
        arguments[only.argument] = Sloped::steady(distances(0.0, 0.0));
        let at_surface = inner.run(&arguments)[0].bounds.number();
        arguments[only.argument] = Sloped::point(distances(-FARTHEST, FARTHEST));
        let factor = inner.run(&arguments)[0].slopes.gradients()[0][0];
        Some(OnlySample { at_surface, factor })
    }

    /// How far away the steep shapes in a field matter: a level so that, where they are farther away than that, the field is
    /// what it would be without them if it is at most `band` either way, and else is beyond that on the same side. Nothing
    /// if no level is found up to some times `size`, the size of those shapes. `samples` tells, in their order, what is steep
    /// in what the field samples.
    pub fn influence(
        &mut self,
        shape: &Rc<Shape<'t>>,
        samples: &[Steep],
        band: f64,
        size: f64,
    ) -> Eval<Option<f64>> {
        self.level_from(shape, samples, band, size, |run, level, cell| {
            let field = run(level, cell, None);
            let value = field.bounds.number();
            field.norm() > 0.0 && value.lo <= band && value.hi >= -band
        })
    }

    /// From how far on a field is one of the distances that it samples, the only one that is not of a shape with a box: a
    /// level as that of [`influence`](Self::influence), for a field that is that distance without the other shapes.
    pub fn plain_beyond(
        &mut self,
        shape: &Rc<Shape<'t>>,
        samples: &[Steep],
        band: f64,
        size: f64,
    ) -> Eval<Option<f64>> {
        if samples.iter().filter(|steep| **steep != Steep::Whole).count() != 1 {
            return Ok(None);
        }
        self.level_from(shape, samples, band, size, |run, level, cell| {
            let [own] = cell else { return true };
            let field = run(level, cell, None);
            let value = field.bounds.number();
            if value.lo > band && own.lo > band || value.hi < -band && own.hi < -band {
                return false;
            }
            // It depends on this distance alone, changes as that does, and is 0 with it.
            let rate = run(level, cell, Some(0)).slopes.gradients()[0][0];
            let at_surface = run(level, &[Interval::ZERO], None).bounds.number();
            field.norm() > 0.0 || rate != Interval::ONE || at_surface != Interval::ZERO
        })
    }

    /// The least level, up to some times `size`, from which on something may hold for no values of the samples that are not
    /// steep as a whole. `may_hold` is told how to run the field over such values where all steep shapes are farther away
    /// than a level, with the derivative by one of them if it asks for that.
    fn level_from(
        &mut self,
        shape: &Rc<Shape<'t>>,
        samples: &[Steep],
        band: f64,
        size: f64,
        may_hold: impl Fn(&mut dyn FnMut(f64, &[Interval], Option<usize>) -> Sloped, f64, &[Interval]) -> bool,
    ) -> Eval<Option<f64>> {
        let others = samples.iter().filter(|steep| **steep != Steep::Whole).count();
        let Some(formula) = self.formula(shape)? else { return Ok(None) };
        if others == 0 || others > MOST_OTHERS || formula.samples.len() != samples.len() {
            return Ok(None);
        }
        let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
        let program = &self.contexts.program;
        let (mut inner, mut arguments) = of_samples(&formula, shape.dimension, program, &uniforms, &globals);
        let mut run = |level: f64, cell: &[Interval], by: Option<usize>| {
            let mut others = cell.iter().enumerate();
            for (sample, steep) in formula.samples.iter().zip(samples) {
                let other = if *steep == Steep::Whole { None } else { others.next() };
                arguments[sample.argument] = match other {
                    Some((i, d)) if by == Some(i) => Sloped::point(Bounds::float(*d)),
                    Some((_, d)) => without_steep(*steep, *d, level),
                    None if by.is_some() => Sloped::steady(distances(level, FARTHEST)),
                    None => Sloped::within(distances(level, FARTHEST), 1.0),
                };
            }
            inner.run(&arguments)[0]
        };
        let size = size.max(band);
        let mut is_enough = |exponent: i32| {
            let level = size * f64::from(exponent).exp2();
            holds_nowhere(others, size, |cell| may_hold(&mut run, level, cell))
        };
        let [mut least, mut most] = LEVELS;
        if !is_enough(most) {
            return Ok(None);
        }
        while least < most {
            let middle = (least + most).div_euclid(2);
            if is_enough(middle) { most = middle } else { least = middle + 1 }
        }
        Ok(Some(size * f64::from(most).exp2()))
    }
}

/// A distance that is in `d` without the steep shapes in it, where those are farther away than `level`: they do not matter
/// to it if it is at most that either way, and else it is beyond that on the same side.
fn without_steep(steep: Steep, d: Interval, level: f64) -> Sloped {
    if steep == Steep::Nothing || d.lo >= -level && d.hi <= level {
        return Sloped::steady(Bounds::float(d));
    }
    let least = if d.lo > -level { d.lo.min(level) } else { -FARTHEST };
    let most = if d.hi < level { d.hi.max(-level) } else { FARTHEST };
    Sloped::within(distances(least, most), 1.0)
}

/// A formula as a function of its samples; and the arguments that it has besides, whatever they are at any point.
fn of_samples<'a>(
    formula: &'a Formula,
    dimension: Dimension,
    program: &'a Program,
    uniforms: &[Bounds],
    globals: &[Bounds],
) -> (Walker<'a, Sloped>, Vec<Sloped>) {
    let anywhere = bounds_of_cell(&flat(Extent::ALL, dimension), formula.ty);
    let mut outer = Walker::new(program, &formula.outer, uniforms, globals);
    let mut arguments = outer.run(&[Sloped::steady(anywhere)]).to_vec();
    arguments.truncate(formula.inner.parameters.len());
    (Walker::new(program, &formula.inner, uniforms, globals), arguments)
}

/// Whether something holds for no values of some distances, as far as a search by halves shows that asks whether it may
/// hold in a cell. It is fine near 0, by `size`, and coarse far away.
fn holds_nowhere(count: usize, size: f64, mut may_hold: impl FnMut(&[Interval]) -> bool) -> bool {
    let farthest = (FARTHEST / size).asinh();
    let mut left = vec![vec![Interval::new(-farthest, farthest); count]];
    for _ in 0..ASKED {
        let Some(cell) = left.pop() else { return true };
        let end = |u: f64| size * u.sinh();
        let ends = |u: &Interval| distances(end(u.lo), end(u.hi)).number();
        let distances: Vec<Interval> = cell.iter().map(ends).collect();
        if !may_hold(&distances) {
            continue;
        }
        let width = |axis: &usize| cell[*axis].hi - cell[*axis].lo;
        let Some(axis) = (0..count).max_by(|a, b| width(a).total_cmp(&width(b))) else { return false };
        let (lo, hi) = (cell[axis].lo, cell[axis].hi);
        let middle = (lo + hi) / 2.0;
        for half in [Interval::new(lo, middle), Interval::new(middle, hi)] {
            let mut part = cell.clone();
            part[axis] = half;
            left.push(part);
        }
    }
    false
}

/// The distances from one to another.
fn distances(least: f64, most: f64) -> Bounds {
    let known = |d: f64| d.clamp(-FARTHEST, FARTHEST);
    Bounds::float(Interval::new(known(least), known(most)))
}
