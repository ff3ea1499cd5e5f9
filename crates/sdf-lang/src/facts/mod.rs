//! What is proved of shapes: how steep their fields are, and which boxes they fill.
//!
//! A contract is used where there is one; of an operator it says what the field is made from its shapes. Without a
//! contract the field's own formula is bounded by intervals ([`derive`](crate::facts::derive)). Everything holds for
//! all values of the params and for all times.

mod ask;
mod attack;
mod boxes;
mod convex;
mod derive;
mod influence;
mod listing;
mod promise;

use crate::contract::{Contract, Quality};
use crate::eval::{Elaborator, Eval};
use crate::value::{Env, Module, Origin, Shape, ShapeKind, Thunk, Value};
pub(crate) use attack::Broken;
use convex::Convexity;
use derive::Formula;
pub(crate) use derive::Gain;
pub(crate) use influence::Steep;
pub use listing::{Basis, Class, Copies, Fact};
pub(crate) use listing::{name as name_of, parts};
pub(crate) use promise::corner_number;
use sdf_ir::interval::Growing;
use sdf_ir::region::Extent;
use sdf_syntax::tree::{Block, Dimension, Expr, ExprKind};
use std::collections::HashMap;
use std::rc::Rc;

/// How steep a field is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slope {
    /// What the field says of the distance; nothing if it may be steeper than 1 somewhere.
    pub quality: Option<Quality>,
    /// A Lipschitz constant over all of space; infinite where none is known.
    pub everywhere: f64,
    /// A Lipschitz constant over the [region](Elaborator::region) of the shape; infinite where none is known.
    pub within: f64,
    /// Whether nothing but a region bounds it, so that it must not be trusted outside of it.
    pub wild: bool,
}

impl Slope {
    fn of_quality(quality: Quality) -> Slope {
        Slope { quality: Some(quality), everywhere: 1.0, within: 1.0, wild: false }
    }

    /// Whether it is worth while to ask first whether a point is in the region.
    pub fn has_better_region(&self) -> bool {
        self.everywhere.is_finite() && self.within.max(1.0) * 1.5 < self.everywhere
    }

    /// That of a field that is nowhere steeper than the steeper of two.
    fn or(self, other: Slope) -> Slope {
        Slope {
            quality: self.quality.zip(other.quality).map(|(a, b)| a.max(b)),
            everywhere: self.everywhere.max(other.everywhere),
            within: self.within.max(other.within),
            wild: self.wild || other.wild,
        }
    }
}

/// What was proved so far. Shapes are told apart by their place in memory.
pub(crate) struct Facts<'t> {
    slopes: HashMap<*const (), Slope>,
    extents: HashMap<(*const (), u64), Extent>,
    formulas: HashMap<*const (), Option<Rc<Formula>>>,
    parts_behind: HashMap<*const (), Vec<Rc<Shape<'t>>>>,
    steep_parts: HashMap<*const (), Extent>,
    better_regions: HashMap<*const (), bool>,
    convexities: HashMap<*const (), Convexity>,
    /// The shapes whose places are keys: as long as they are kept, no other shape gets their places.
    kept: Vec<Rc<Shape<'t>>>,
    frame: Growing,
    /// Bounds in the open function that was asked about last, and what tells it from all others.
    open: (u32, Growing),
    /// The level that the promise of a box that is being evaluated is about.
    pub level: f64,
    /// Whether a formula is being taken apart to be bounded.
    pub takes_apart: bool,
    /// The slopes round a point of the shapes that an operator samples, while its own slope there is evaluated.
    pub samples: Option<Vec<(Rc<Shape<'t>>, crate::value::Number)>>,
}

impl<'t> Facts<'t> {
    pub fn new() -> Self {
        Facts {
            slopes: HashMap::new(),
            extents: HashMap::new(),
            formulas: HashMap::new(),
            parts_behind: HashMap::new(),
            steep_parts: HashMap::new(),
            better_regions: HashMap::new(),
            convexities: HashMap::new(),
            kept: Vec::new(),
            frame: Growing::new(),
            open: (u32::MAX, Growing::new()),
            level: 0.0,
            takes_apart: false,
            samples: None,
        }
    }

    /// The shapes that a shape was found to be the union of.
    pub fn parts_behind(&self, shape: &Rc<Shape<'t>>) -> Option<Vec<Rc<Shape<'t>>>> {
        self.parts_behind.get(&Rc::as_ptr(shape).cast()).cloned()
    }

    /// The box that was found round the steep shapes in a shape.
    pub fn steep_parts(&self, shape: &Rc<Shape<'t>>) -> Option<Extent> {
        self.steep_parts.get(&Rc::as_ptr(shape).cast()).copied()
    }

    pub fn keep_steep_parts(&mut self, shape: &Rc<Shape<'t>>, inside: Extent) {
        self.kept.push(shape.clone());
        self.steep_parts.insert(Rc::as_ptr(shape).cast(), inside);
    }

    /// Whether a shape was found to be less steep in its region, or to be made of what is.
    pub fn has_better_region(&self, shape: &Rc<Shape<'t>>) -> Option<bool> {
        self.better_regions.get(&Rc::as_ptr(shape).cast()).copied()
    }

    pub fn keep_better_region(&mut self, shape: &Rc<Shape<'t>>, is_better: bool) {
        self.kept.push(shape.clone());
        self.better_regions.insert(Rc::as_ptr(shape).cast(), is_better);
    }

    pub fn keep_parts_behind(&mut self, shape: &Rc<Shape<'t>>, parts: &[Rc<Shape<'t>>]) {
        self.kept.push(shape.clone());
        self.parts_behind.insert(Rc::as_ptr(shape).cast(), parts.to_vec());
    }
}

/// A contract and the variables that its expressions see.
pub(crate) struct Stated<'t> {
    pub contract: &'t Contract<'t>,
    pub env: Env<'t>,
    pub module: Module,
    /// The shapes that the field is made from.
    shapes: Vec<Rc<Shape<'t>>>,
}

impl<'t> Elaborator<'t> {
    /// The contract of the function in which a field stands, if the field is what the function gives.
    pub fn contract_of_field(&self, origin: Origin<'t>, block: &Block) -> Option<&'t Contract<'t>> {
        let names = self.names;
        names.contract_of(origin.function, origin.module).filter(|_| gives(&origin.function.body, block))
    }

    /// The contract of a shape, if its own `let` or function has one.
    pub fn stated(&self, shape: &Rc<Shape<'t>>) -> Option<Stated<'t>> {
        let names = self.names;
        match &shape.kind {
            ShapeKind::Named { thunk: Thunk::Let(binding), .. } => {
                let (module, contract) = names.contract_of_let(binding)?;
                Some(Stated { contract, env: Env::new(module), module, shapes: Vec::new() })
            }
            ShapeKind::Named { thunk: Thunk::Call { function, module, arguments }, .. } => {
                let contract = names.contract_of(function, *module)?;
                let env = Env::new(*module);
                let env = arguments.iter().fold(env, |env, (name, v)| env.bind(name.clone(), v.clone()));
                let shapes = shapes_in(&env);
                Some(Stated { contract, env, module: *module, shapes })
            }
            ShapeKind::Field { block, env, origin: Some(origin) } => {
                let contract = self.contract_of_field(*origin, block)?;
                // It sees the parameters, and not what the body names besides.
                let parameters = origin.function.parameters.iter().map(|p| &p.name.text);
                let seen = parameters.fold(Env::new(origin.module), |seen, name| match env.get(name) {
                    Some(value) => seen.bind(name.clone(), value.clone()),
                    None => seen,
                });
                Some(Stated { contract, env: seen, module: origin.module, shapes: shapes_in(env) })
            }
            _ => None,
        }
    }

    /// How steep a shape's field is.
    pub fn slope_of(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Slope> {
        let key = Rc::as_ptr(shape).cast::<()>();
        if let Some(slope) = self.facts.slopes.get(&key) {
            return Ok(*slope);
        }
        let slope = self.find_slope(shape)?;
        self.facts.kept.push(shape.clone());
        self.facts.slopes.insert(key, slope);
        Ok(slope)
    }

    fn find_slope(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Slope> {
        if let Some(stated) = self.stated(shape)
            && let Some(slope) = self.stated_slope(shape, &stated)?
        {
            return Ok(slope);
        }
        match &shape.kind {
            ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
                self.slope_of(&inner.clone())
            }
            ShapeKind::Choice { then, otherwise, .. } => {
                let (then, otherwise) = (then.clone(), otherwise.clone());
                Ok(self.slope_of(&then)?.or(self.slope_of(&otherwise)?))
            }
            ShapeKind::Union { shapes } => self.steepest_of(Quality::Exact, &shapes.clone()),
            ShapeKind::Field { .. } => self.derived_slope(shape),
        }
    }

    /// The slope that a contract states; nothing if it says nothing of slopes.
    fn stated_slope(&mut self, shape: &Rc<Shape<'t>>, stated: &Stated<'t>) -> Eval<Option<Slope>> {
        if let Some((quality, _)) = stated.contract.quality {
            let worst = self.steepest_of(quality, &stated.shapes)?;
            if worst.everywhere.is_finite() && !worst.has_better_region() {
                return Ok(Some(worst));
            }
            let within = self.derived_within(shape)?.min(worst.everywhere);
            return Ok(Some(Slope { within, ..worst }));
        }
        let Some((slope, _)) = stated.contract.slope else { return Ok(None) };
        let everywhere =
            self.stated_number(slope, &stated.env, shape.dimension, &flat(Extent::ALL, shape.dimension))?;
        let region = self.region(shape)?;
        let within = if everywhere.is_finite() && region.is_everything() {
            everywhere
        } else {
            self.stated_number(slope, &stated.env, shape.dimension, &region)?.min(everywhere)
        };
        let quality = (everywhere <= 1.0).then_some(Quality::Bound);
        Ok(Some(Slope { quality, everywhere, within, wild: within.is_infinite() }))
    }

    /// The slope of a field that is as good as `quality` and as its worst shape let it be.
    fn steepest_of(&mut self, quality: Quality, shapes: &[Rc<Shape<'t>>]) -> Eval<Slope> {
        let mut worst = Slope::of_quality(quality);
        for shape in shapes {
            worst = worst.or(self.slope_of(shape)?);
        }
        Ok(worst)
    }

    /// The box round the points where a shape's field is at most `level`: for 0 the surface and the inside.
    pub fn extent_of(&mut self, shape: &Rc<Shape<'t>>, level: f64) -> Eval<Extent> {
        let key = (Rc::as_ptr(shape).cast::<()>(), level.to_bits());
        if let Some(extent) = self.facts.extents.get(&key) {
            return Ok(*extent);
        }
        let extent = self.find_extent(shape, level)?;
        self.facts.kept.push(shape.clone());
        self.facts.extents.insert(key, extent);
        Ok(extent)
    }

    fn find_extent(&mut self, shape: &Rc<Shape<'t>>, level: f64) -> Eval<Extent> {
        let stated = self.stated(shape).filter(|s| s.contract.bounds.is_some());
        if let Some(stated) = &stated {
            // The distance grows by no less than one goes away; below 0 it says nothing.
            if level != 0.0 && self.slope_of(shape)?.quality == Some(Quality::Exact) {
                return Ok(self.extent_of(shape, 0.0)?.grown(level.max(0.0)));
            }
            // What a file promises, it promises of the shape itself, unless it says `level`.
            let is_of_levels = stated.contract.is_of_levels() && stated.env.get("level").is_none();
            if level == 0.0 || !stated.module.is_user() || is_of_levels {
                return self.stated_extent(stated, shape.dimension, level);
            }
        }
        match &shape.kind {
            ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
                self.extent_of(&inner.clone(), level)
            }
            ShapeKind::Choice { then, otherwise, .. } => {
                let (then, otherwise) = (then.clone(), otherwise.clone());
                Ok(self.extent_of(&then, level)?.union(&self.extent_of(&otherwise, level)?))
            }
            ShapeKind::Union { shapes } => self.extent_of_all(&shapes.clone(), level),
            ShapeKind::Field { .. } => self.derived_extent(shape, level),
        }
    }

    /// The box round several shapes.
    pub fn extent_of_all(&mut self, shapes: &[Rc<Shape<'t>>], level: f64) -> Eval<Extent> {
        let mut all = Extent::NONE;
        for shape in shapes {
            all = all.union(&self.extent_of(shape, level)?);
        }
        Ok(all)
    }

    /// The box over which a shape's slope is bounded: what it fills, and some room round it, in which a ray that
    /// comes from outside finds itself after a step to the box.
    pub fn region(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Extent> {
        let extent = self.extent_of(shape, 0.0)?;
        Ok(flat(extent.grown(room(&extent)), shape.dimension))
    }
}

/// The room round a shape's box that belongs to its region.
pub(crate) fn room(extent: &Extent) -> f64 {
    let largest =
        |xs: &mut dyn Iterator<Item = f64>| xs.filter(|x| x.is_finite()).map(f64::abs).fold(0.0, f64::max);
    let size = largest(&mut extent.size().into_iter());
    let farthest = largest(&mut extent.lo.into_iter().chain(extent.hi));
    // Far from the origin it must be more than the rounding of coordinates in 32 bits.
    (size * 0.05).max(farthest * 1e-6).max(1e-3)
}

/// The box in the plane, if that is where the shape is.
fn flat(extent: Extent, dimension: Dimension) -> Extent {
    match dimension {
        Dimension::Three => extent,
        Dimension::Two if extent.is_empty() => extent,
        Dimension::Two => {
            Extent { lo: [extent.lo[0], extent.lo[1], 0.0], hi: [extent.hi[0], extent.hi[1], 0.0] }
        }
    }
}

/// Whether a field's block is what an expression gives: itself, or behind `let`s and `if`s.
fn gives(expr: &Expr, block: &Block) -> bool {
    match &expr.kind {
        ExprKind::Shape(_, own) => std::ptr::eq(&**own, block),
        ExprKind::Block(b) => gives(&b.result, block),
        ExprKind::If { then, otherwise, .. } => gives(&then.result, block) || gives(&otherwise.result, block),
        _ => false,
    }
}

/// The shapes among the variables, also those in lists and records.
pub(crate) fn shapes_in<'t>(env: &Env<'t>) -> Vec<Rc<Shape<'t>>> {
    fn collect<'t>(value: &Value<'t>, out: &mut Vec<Rc<Shape<'t>>>) {
        match value {
            Value::Shape(s) => out.push(s.clone()),
            Value::List(l) => l.items.iter().for_each(|v| collect(v, out)),
            Value::Record(r) => r.fields.iter().for_each(|(_, v)| collect(v, out)),
            Value::Number(_) | Value::Material(_) | Value::Function(_) => {}
        }
    }
    let mut out = Vec::new();
    env.variables().iter().for_each(|(_, v)| collect(v, &mut out));
    out
}
