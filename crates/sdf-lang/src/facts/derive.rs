//! What a field's own formula proves where no contract says it: the box by interval search, then the slope over it.
//!
//! The formula is taken apart: the distances that it samples are stand-ins, of which only the slope and the interval
//! are known, so that what is proved of a shape is used wherever the shape is.

use crate::contract::Quality;
use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::expansion::OPERATION_LIMIT;
use crate::facts::listing::parts;
use crate::facts::promise::bounds_of_cell;
use crate::facts::{Slope, flat};
use crate::value::{Env, Number, Shape, ShapeKind, Value};
use sdf_ir::interval::{Bounds, Interval, Sloped, Walker};
use sdf_ir::region::{Extent, FAR, Steepness, fill, steepest};
use sdf_ir::{Function, Node, Program, RegionId, Type};
use sdf_syntax::tree::{Block, Dimension};
use std::rc::Rc;
use std::sync::Arc;

/// How often the search for a box may ask.
const FILL: usize = 4000;
/// How often the search for the steepest place of all of space may ask.
const EVERYWHERE: usize = 300;
/// How often the search for the steepest place of a region may ask.
const WITHIN: usize = 600;
/// How many operations one search may take: with a longer formula it asks less often, and finds less.
const WORK: u64 = 1_000_000;
/// How often it may ask at least.
const LEAST: u64 = 8;
/// How often a search for a box may ask at least that begins with all of space: with less it finds none of any use.
const LEAST_OF_ALL: u64 = 1000;
/// Of a formula that takes more operations no box is sought, which takes a thousand answers.
const LARGEST_SEARCHED: u64 = 5_000;
/// The steepest slope that is of any use.
const STEEPEST: f64 = 1e6;
/// A bound so little above 1 comes from the proof's own rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// A field's formula as functions that intervals can walk.
#[derive(Debug)]
pub(crate) struct Formula {
    pub(super) ty: Type,
    /// `p → distance`.
    whole: Function,
    /// `p →` the arguments of `inner`, then the points at which shapes are sampled.
    pub(super) outer: Function,
    /// What the formula makes of its arguments, the sampled distances among them.
    pub(super) inner: Function,
    pub(super) samples: Vec<Sampled>,
    /// How many operations one evaluation takes.
    operations: u64,
}

impl Formula {
    /// How often a search may ask for slopes that would ask `most` times of a short formula: they take several times as
    /// long as values.
    fn budget_of_slopes(&self, most: usize) -> usize {
        most.min((WORK / 5 / self.operations.max(1)).max(LEAST) as usize)
    }
}

/// A distance that a formula samples.
#[derive(Debug)]
pub(super) struct Sampled {
    /// Which argument of the formula it is.
    pub(super) argument: usize,
    /// The slope of its shape everywhere; infinite where nothing is known.
    slope: f64,
    /// The slope of its shape in a region, and that region. A place beyond its border by rounding counts as inside.
    within: f64,
    region: Extent,
    /// Whether its shape must not be trusted everywhere.
    wild: bool,
    /// The box of its shape; outside of it the distance is above 0.
    extent: Extent,
    /// Whether the distance is no less than that to the box there.
    is_exact: bool,
}

impl Sampled {
    /// The slope of its shape where it is sampled at any of these points.
    fn slope_at(&self, at: &Bounds) -> f64 {
        let is_inside = |i: usize| {
            let (lo, hi) = (self.region.lo[i], self.region.hi[i]);
            let rounding = 1e-12 * (lo.abs().min(FAR) + hi.abs().min(FAR));
            at.part(i).lo >= lo - rounding && at.part(i).hi <= hi + rounding
        };
        if (0..at.size()).all(is_inside) { self.within.min(self.slope) } else { self.slope }
    }

    /// The least that the distance can be where the shape is sampled at any of these points.
    fn least(&self, at: &Bounds) -> f64 {
        let away = distance_to_box(at, &self.extent);
        match away > 0.0 {
            true if self.is_exact => away,
            true => f64::MIN_POSITIVE,
            false => f64::NEG_INFINITY,
        }
    }
}

/// The least distance from any of these points to a box; of a vector that was turned its length is known, and how
/// long two of its components are together, where the components are not.
fn distance_to_box(at: &Bounds, extent: &Extent) -> f64 {
    if extent.is_empty() {
        return f64::INFINITY;
    }
    let farthest = |axes: &[usize]| {
        axes.iter().map(|i| extent.lo[*i].abs().max(extent.hi[*i].abs()).powi(2)).sum::<f64>().sqrt()
    };
    let gap = |i: usize| (extent.lo[i] - at.part(i).hi).max(at.part(i).lo - extent.hi[i]).max(0.0);
    let axes = at.size();
    let by_components = (0..axes).map(|i| gap(i).powi(2)).sum::<f64>().sqrt();
    let by_length = at.length().lo - farthest(&[0, 1, 2][..axes]);
    let by_pairs =
        (0..3).filter(|_| axes == 3).map(|i| at.across(i).lo - farthest(&[(i + 1) % 3, (i + 2) % 3]));
    by_pairs.chain([by_components, by_length]).fold(0.0, f64::max) * (1.0 - 1e-12)
}

/// How a field's slope follows from those of the shapes that it samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gain {
    /// Its slope is at most this times the largest of theirs, or of 1.
    pub slope: f64,
    /// Where it samples them moves at most so much faster than the point.
    pub places: f64,
}

impl<'t> Elaborator<'t> {
    /// The slope of a field without a contract.
    pub fn derived_slope(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Slope> {
        let everywhere = self.derived_everywhere(shape)?;
        if everywhere <= 1.0 {
            let quality = Some(Quality::Bound);
            return Ok(Slope { quality, everywhere, within: everywhere, wild: false });
        }
        let within = self.derived_within(shape)?.min(everywhere);
        let wild = everywhere.is_infinite() && self.gain(shape)?.is_none();
        Ok(Slope { quality: None, everywhere, within, wild })
    }

    /// How much steeper a field is than the steepest of the shapes that it samples, at most, and than where it samples
    /// them moves; nothing if no bound is found, or if one of the shapes must not be trusted everywhere.
    pub fn gain(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Option<Gain>> {
        let Some(formula) = self.formula(shape)? else { return Ok(None) };
        if formula.samples.iter().any(|s| s.wild) {
            return Ok(None);
        }
        let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
        let mut walk = Walk::new(&formula, &self.contexts.program, &uniforms, &globals);
        let all = flat(Extent::ALL, shape.dimension);
        let mut places = 1.0f64;
        let slope = steepest(formula.ty.size(), &all, formula.budget_of_slopes(EVERYWHERE), |cell| {
            let (slope, place) = walk.gain(cell);
            places = places.max(place);
            Steepness { at_most: slope, at_least: 0.0 }
        });
        let is_known = slope.is_finite() && places.is_finite();
        Ok(is_known.then_some(Gain { slope: slope.max(1.0), places }))
    }

    /// A Lipschitz constant over all of space; infinite where none is found.
    fn derived_everywhere(&mut self, shape: &Rc<Shape<'t>>) -> Eval<f64> {
        let Some(formula) = self.formula(shape)? else { return Ok(f64::INFINITY) };
        let all = flat(Extent::ALL, shape.dimension);
        Ok(self.steepest_place(&formula, &all, EVERYWHERE))
    }

    /// A Lipschitz constant over the region of a shape; infinite where none is found.
    pub fn derived_within(&mut self, shape: &Rc<Shape<'t>>) -> Eval<f64> {
        let Some(formula) = self.formula(shape)? else { return Ok(f64::INFINITY) };
        let region = self.region(shape)?;
        Ok(self.steepest_place(&formula, &region, WITHIN))
    }

    /// The box of the points where a field without a stated one is at most `level`.
    pub fn derived_extent(&mut self, shape: &Rc<Shape<'t>>, level: f64) -> Eval<Extent> {
        let all = flat(Extent::ALL, shape.dimension);
        let everywhere = self.slope_before_extent(shape)?;
        let formula = self.formula(shape)?.filter(|formula| formula.operations <= LARGEST_SEARCHED);
        let Some(formula) = formula else { return Ok(all) };
        let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
        let program = &self.contexts.program;
        let walker = |function| Walker::<Bounds>::new(program, function, &uniforms, &globals);
        let (mut whole, mut outer, mut inner) =
            (walker(&formula.whole), walker(&formula.outer), walker(&formula.inner));
        let mut least = |cell: &Extent| {
            let point = bounds_of_cell(cell, formula.ty);
            let mut arguments = outer.run(&[point]).to_vec();
            let points = arguments.split_off(formula.inner.parameters.len());
            for (sample, at) in formula.samples.iter().zip(&points) {
                let argument = &mut arguments[sample.argument];
                let distance = argument.number();
                // Above what it can be it would only be if a promise were false.
                let least = distance.lo.max(sample.least(at)).min(distance.hi);
                *argument = Bounds::float(Interval::new(least, distance.hi));
            }
            let by_samples = inner.run(&arguments)[0].number().lo;
            if by_samples > level { by_samples } else { by_samples.max(whole.run(&[point])[0].number().lo) }
        };
        let mut may_hold = |cell: &Extent| {
            if least(cell) > level {
                return false;
            }
            if !everywhere.is_finite() {
                return true;
            }
            // From the middle of the cell, or the line or plane in its middle, it is not far to any of its points.
            let (middle, radius) = cell.middle();
            least(&middle) - everywhere * radius <= level
        };
        let sampled = formula.samples.iter().fold(Extent::NONE, |all, sample| all.union(&sample.extent));
        let axes = formula.ty.size();
        let (within, least) = match room_round(&sampled, axes, &mut may_hold) {
            Some(room) => (flat(room, shape.dimension), LEAST),
            None => (all, LEAST_OF_ALL),
        };
        let budget = FILL.min((WORK / formula.operations.max(1)).max(least) as usize);
        Ok(flat(fill(axes, &within, budget, may_hold), shape.dimension))
    }

    /// The slope over all of space, found without the box.
    fn slope_before_extent(&mut self, shape: &Rc<Shape<'t>>) -> Eval<f64> {
        match self.stated(shape).and_then(|s| s.contract.quality) {
            Some(_) => Ok(self.slope_of(shape)?.everywhere),
            None => self.derived_everywhere(shape),
        }
    }

    fn steepest_place(&mut self, formula: &Formula, region: &Extent, budget: usize) -> f64 {
        let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
        let program = &self.contexts.program;
        let mut walk = Walk::new(formula, program, &uniforms, &globals);
        let ask = |cell: &Extent| {
            // No more is known of the shapes inside than what is stated of them: it is of no use to look further. A
            // single point would count as a constant.
            let at_least = walk.slope_as_stated(&middle_part(cell));
            Steepness { at_most: walk.slope(cell), at_least }
        };
        let found = steepest(formula.ty.size(), region, formula.budget_of_slopes(budget), ask);
        if found <= 1.0 + ROUNDING { found.min(1.0) } else { found }
    }

    /// The formula of a field; nothing if it is made from what an open function computes.
    pub(super) fn formula(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Option<Rc<Formula>>> {
        let shape = &unwrapped(shape);
        let ShapeKind::Field { block, env, .. } = &shape.kind else { return Ok(None) };
        let key = Rc::as_ptr(shape).cast::<()>();
        if let Some(formula) = self.facts.formulas.get(&key) {
            return Ok(formula.clone());
        }
        let formula = if depends_on_a_point(env) {
            None
        } else {
            let samples = self.samples.take();
            let takes_apart = std::mem::replace(&mut self.facts.takes_apart, true);
            let formula = self.take_apart(shape, block, env);
            self.facts.takes_apart = takes_apart;
            self.samples = samples;
            formula?.map(Rc::new)
        };
        self.facts.kept.push(shape.clone());
        self.facts.formulas.insert(key, formula.clone());
        Ok(formula)
    }

    fn take_apart(
        &mut self,
        shape: &Rc<Shape<'t>>,
        block: &'t Block,
        env: &Env<'t>,
    ) -> Eval<Option<Formula>> {
        let ty = if shape.dimension == Dimension::Three { Type::Vec3 } else { Type::Vec2 };
        let place = block.result.span;
        let Some((whole, _)) = self.apart(ty, |this, point| {
            let distance = this.plain_distance(shape, point, place)?;
            Ok((vec![this.contexts.value(&distance)], ()))
        })?
        else {
            return Ok(None);
        };
        let operations = self.contexts.operations_apart(&whole);
        if operations > OPERATION_LIMIT {
            // It is refused for that.
            return Ok(None);
        }
        let made = self.apart(ty, |this, point| {
            let (inner, mut results, samples) = this.formula_of_samples(block, env, point)?;
            for (_, at, _) in &samples {
                results.push(this.contexts.value(at));
            }
            Ok((results, (inner, samples)))
        })?;
        let Some((outer, (inner, found))) = made else { return Ok(None) };
        let mut samples = Vec::new();
        for (shape, _, stand_in) in found {
            let Node::Argument(RegionId::ROOT, argument) = inner.node(stand_in) else {
                unreachable!("a stand-in is an argument")
            };
            let argument = argument as usize;
            samples.push(if depends_on_a_point_inside(&shape) {
                Sampled {
                    argument,
                    slope: f64::INFINITY,
                    within: f64::INFINITY,
                    region: Extent::ALL,
                    wild: true,
                    extent: Extent::ALL,
                    is_exact: false,
                }
            } else {
                let (slope, extent) = (self.slope_of(&shape)?, self.extent_of(&shape, 0.0)?);
                let is_exact = slope.quality == Some(Quality::Exact);
                let (region, within) = (self.region(&shape)?, slope.within);
                Sampled {
                    argument,
                    slope: slope.everywhere,
                    within,
                    region,
                    wild: slope.wild,
                    extent,
                    is_exact,
                }
            });
        }
        Ok(Some(Formula { ty, whole, outer, inner, samples, operations }))
    }

    /// Whether a field is the same on both sides of the plane across an axis at `middle`, as far as its operations show.
    pub fn is_even(&mut self, shape: &Rc<Shape<'t>>, axis: usize, middle: f64) -> Eval<bool> {
        let formula = self.plain_formula(shape)?;
        let program = &self.contexts.program;
        Ok(formula.is_some_and(|function| sdf_ir::is_even(program, &function, axis, middle)))
    }

    /// Whether a field is an affine function of the point, as far as its operations show.
    pub fn is_affine(&mut self, shape: &Rc<Shape<'t>>) -> Eval<bool> {
        let formula = self.plain_formula(shape)?;
        Ok(formula.is_some_and(|function| sdf_ir::is_affine(&self.contexts.program, &function)))
    }

    /// A lower bound on a field at these points, for all values of the params and at all times.
    pub fn least_distance(&mut self, shape: &Rc<Shape<'t>>, points: &Bounds) -> Eval<f64> {
        Ok(self.distances(shape, points)?.lo)
    }

    /// Where a field lies at these points, for all values of the params and at all times.
    pub fn distances(&mut self, shape: &Rc<Shape<'t>>, points: &Bounds) -> Eval<Interval> {
        let Some(function) = self.plain_formula(shape)? else { return Ok(Interval::ALL) };
        let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
        let program = &self.contexts.program;
        Ok(sdf_ir::interval::bounds(program, &function, &[*points], &uniforms, &globals)[0].number())
    }

    /// Where a field's gradient lies over a region, likewise. Over a single point no field changes, so that says nothing.
    pub fn gradient_over(&mut self, shape: &Rc<Shape<'t>>, region: &Bounds) -> Eval<[Interval; 3]> {
        let Some(function) = self.plain_formula(shape)? else { return Ok([Interval::ALL; 3]) };
        let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
        let mut walker = Walker::<Sloped>::new(&self.contexts.program, &function, &uniforms, &globals);
        Ok(walker.run(&[Sloped::point(*region)])[0].slopes.gradient(0))
    }

    /// A field as a function of the point alone; nothing if it is made from what an open function computes.
    fn plain_formula(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Option<Function>> {
        if depends_on_a_point_inside(shape) {
            return Ok(None);
        }
        let ty = if shape.dimension == Dimension::Three { Type::Vec3 } else { Type::Vec2 };
        let samples = self.samples.take();
        let made = self.apart(ty, |this, point| {
            let distance = this.plain_distance(shape, point, shape.place)?;
            Ok((vec![this.contexts.value(&distance)], ()))
        });
        self.samples = samples;
        Ok(made?.map(|(function, ())| function))
    }

    /// A function of a point, apart from the program; nothing if it needs what an open function computes.
    fn apart<T>(
        &mut self,
        ty: Type,
        make: impl FnOnce(&mut Self, &Number) -> Eval<(Vec<sdf_ir::Value>, T)>,
    ) -> Eval<Option<(Function, T)>> {
        self.contexts.open(&Arc::from("formula"), None);
        let point = self.contexts.entry_parameter("p", ty);
        match make(self, &point) {
            Ok((results, more)) => {
                let (function, outside) = self.contexts.finish_apart(results);
                Ok(outside.is_empty().then_some((function, more)))
            }
            Err(reported) => {
                self.contexts.discard();
                Err(reported)
            }
        }
    }

    /// A field whose slope has no bound that is known is an error, which says how to state one.
    pub fn require_slope(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Slope> {
        let slope = self.slope_of(shape)?;
        if !slope.wild {
            return Ok(slope);
        }
        if slope.within.is_finite() && self.extent_of(shape, 0.0)?.is_bounded() {
            return Ok(slope);
        }
        let culprit = self.culprit(shape)?;
        let bounded = self.extent_of(&culprit, 0.0)?.is_bounded();
        self.report(errors::no_slope(culprit.place, bounded))
    }

    /// The shape inside a shape that makes it one that must not be trusted everywhere.
    fn culprit(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Rc<Shape<'t>>> {
        for part in parts(shape) {
            if self.slope_of(&part)?.wild {
                return self.culprit(&part);
            }
        }
        Ok(shape.clone())
    }
}

/// A formula that is walked over many cells.
struct Walk<'a> {
    formula: &'a Formula,
    whole: Walker<'a, Sloped>,
    outer: Walker<'a, Sloped>,
    inner: Walker<'a, Sloped>,
}

impl<'a> Walk<'a> {
    fn new(formula: &'a Formula, program: &'a Program, uniforms: &[Bounds], globals: &[Bounds]) -> Walk<'a> {
        let walker = |function| Walker::new(program, function, uniforms, globals);
        Walk {
            formula,
            whole: walker(&formula.whole),
            outer: walker(&formula.outer),
            inner: walker(&formula.inner),
        }
    }

    /// How steep the formula is if each sample is as steep as `choose` says, which is told what is stated of the sample
    /// and what its own arithmetic says.
    fn composed(&mut self, point: Sloped, choose: impl Fn(f64, f64) -> f64) -> f64 {
        let mut arguments = self.outer.run(&[point]).to_vec();
        let points = arguments.split_off(self.formula.inner.parameters.len());
        for (sample, at) in self.formula.samples.iter().zip(&points) {
            let argument = &mut arguments[sample.argument];
            let (stated, computed) = (sample.slope_at(&at.bounds) * at.norm(), argument.norm());
            let chosen = choose(stated, computed);
            if chosen != computed {
                *argument = Sloped::within(argument.bounds, chosen);
            }
        }
        self.inner.run(&arguments)[0].norm()
    }

    /// The slope in a cell if the shapes that are sampled were as steep in it as is stated of them.
    fn slope_as_stated(&mut self, cell: &Extent) -> f64 {
        let point = Sloped::point(bounds_of_cell(cell, self.formula.ty));
        useful(self.composed(point, |stated, computed| if stated.is_finite() { stated } else { computed }))
    }

    /// A bound on the slope in a cell: the better one of that of the formula, with what is known of the shapes that
    /// it samples, and that of all its arithmetic.
    fn slope(&mut self, cell: &Extent) -> f64 {
        let point = Sloped::point(bounds_of_cell(cell, self.formula.ty));
        let composed = self.composed(point, f64::min);
        useful(composed.min(self.whole.run(&[point])[0].norm()))
    }

    /// A bound on the slope in a cell if no sampled shape were steeper than 1, and on how fast the places move at
    /// which they are sampled.
    fn gain(&mut self, cell: &Extent) -> (f64, f64) {
        let point = Sloped::point(bounds_of_cell(cell, self.formula.ty));
        let mut arguments = self.outer.run(&[point]).to_vec();
        let points = arguments.split_off(self.formula.inner.parameters.len());
        for (sample, at) in self.formula.samples.iter().zip(&points) {
            let argument = &mut arguments[sample.argument];
            *argument = Sloped::within(argument.bounds, at.norm());
        }
        let places = points.iter().map(Sloped::norm).fold(1.0, f64::max);
        (useful(self.inner.run(&arguments)[0].norm()), useful(places))
    }
}

/// A box outside of which there is nothing, where one is found at once: that of the shapes inside, with some room round
/// it. Most fields are near the shapes that they sample.
fn room_round(inside: &Extent, axes: usize, may_hold: &mut impl FnMut(&Extent) -> bool) -> Option<Extent> {
    if inside.is_empty() || !inside.is_bounded() {
        return None;
    }
    let size = inside.size().into_iter().fold(0.0, f64::max).max(1e-6);
    let mut is_clear = |room: &Extent| {
        (0..axes).all(|axis| {
            let (mut below, mut above) = (Extent::ALL, Extent::ALL);
            (below.hi[axis], above.lo[axis]) = (room.lo[axis], room.hi[axis]);
            !may_hold(&below) && !may_hold(&above)
        })
    };
    [0.05, 0.5, 4.0].into_iter().map(|share| inside.grown(size * share)).find(|room| is_clear(room))
}

/// A small part of a cell round its middle.
fn middle_part(cell: &Extent) -> Extent {
    let (center, size) = (cell.center(), cell.size());
    let reach = |i: usize| if size[i].is_finite() { size[i] * 1e-3 } else { 1e-3 };
    Extent {
        lo: std::array::from_fn(|i| center[i] - reach(i)),
        hi: std::array::from_fn(|i| center[i] + reach(i)),
    }
}

/// A slope that no ray could take steps by is none: it comes from intervals that know nothing far away.
fn useful(slope: f64) -> f64 {
    if slope < STEEPEST { slope } else { f64::INFINITY }
}

/// The shape without its name and paint.
fn unwrapped<'t>(shape: &Rc<Shape<'t>>) -> Rc<Shape<'t>> {
    match &shape.kind {
        ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => unwrapped(inner),
        _ => shape.clone(),
    }
}

/// Whether among the variables there is a number that an open function computes.
fn depends_on_a_point(env: &Env<'_>) -> bool {
    env.variables().iter().any(|(_, v)| value_depends_on_a_point(v))
}

fn value_depends_on_a_point(value: &Value<'_>) -> bool {
    match value {
        Value::Number(n) => n.is_local(),
        Value::Shape(s) => depends_on_a_point_inside(s),
        Value::List(l) => l.items.iter().any(value_depends_on_a_point),
        Value::Record(r) => r.fields.iter().any(|(_, v)| value_depends_on_a_point(v)),
        Value::Material(_) | Value::Function(_) => false,
    }
}

fn depends_on_a_point_inside(shape: &Shape<'_>) -> bool {
    match &shape.kind {
        ShapeKind::Field { env, .. } => depends_on_a_point(env),
        ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
            depends_on_a_point_inside(inner)
        }
        ShapeKind::Choice { condition, then, otherwise } => {
            condition.is_local() || depends_on_a_point_inside(then) || depends_on_a_point_inside(otherwise)
        }
        ShapeKind::Union { shapes } => shapes.iter().any(|s| depends_on_a_point_inside(s)),
    }
}
