//! What is proved of a scene's shapes as a table: one row a shape, the shapes that it is made from below it.

use crate::contract::Quality;
use crate::eval::{Elaborator, Eval};
use crate::facts::shapes_in;
use crate::value::{Module, Shape, ShapeKind, Thunk, Value};
use sdf_ir::cost;
use sdf_ir::region::Extent;
use sdf_ir::{Constant, Node, Type};
use sdf_syntax::Span;
use sdf_syntax::tree::Dimension;
use std::collections::{BTreeSet, HashSet};
use std::rc::Rc;
use std::sync::Arc;

/// How many rows a table has at most.
const ROWS: usize = 1000;

/// What is proved of one shape. It holds for all values of the params and for all times.
#[derive(Debug, Clone, PartialEq)]
pub struct Fact {
    /// How many shapes it is a part of, each a part of the next.
    pub depth: usize,
    /// Its name in the source, or the function that makes it.
    pub name: String,
    /// The line of the root file that it comes from, where there is one.
    pub line: Option<u32>,
    /// What its field says of the distance.
    pub class: Class,
    /// Where the slope comes from.
    pub basis: Basis,
    /// A Lipschitz constant of its field, over its box and a little more; infinite where none is known.
    pub slope: f64,
    /// The same over all of space.
    pub slope_everywhere: f64,
    /// The box that the surface and the inside lie in.
    pub extent: Extent,
    /// Whether it is convex: with any two points it holds what lies between them.
    pub is_convex: bool,
    /// Whether it is an area of the plane.
    pub is_flat: bool,
    /// What changes it from frame to frame: `time`, `mouse` and the names of params; nothing for a static one.
    pub depends_on: Vec<String>,
    /// Scalar operations of one evaluation, at most.
    pub operations: u64,
    /// If it repeats a shape: how many copies each point asks.
    pub copies: Vec<Copies>,
}

/// How many copies of a repeated shape each point asks, since they may be the nearest to it. The library says so by a
/// record with these fields beside the field that repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Copies {
    /// In which direction they are repeated: `along x`, `around axis`.
    pub direction: String,
    /// How many are asked.
    pub asked: f64,
    /// How many there are; infinitely many if they never end.
    pub of: f64,
    /// How wide the shape's box is in that direction; of those around an axis the angle that it takes, in radians.
    pub width: f64,
    /// The period, or the least that it may be.
    pub period: f64,
    /// Whether the shape is the same on both sides of its middle, so that one is enough.
    pub mirrored: bool,
}

/// What a field says of the distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// It is the Euclidean distance, everywhere outside.
    Exact,
    /// It is never more than the distance.
    Bound,
    /// It may be more: steps are divided by the slope.
    Steep,
}

/// Where a slope comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// A contract of the library.
    Library,
    /// A contract in the file, on this line.
    Stated(u32),
    /// The formula, bounded by intervals.
    Derived,
    /// The shapes that it is made from.
    Parts,
}

impl<'t> Elaborator<'t> {
    /// The table of a scene. Shapes that are used in several places stand where they are met first.
    pub fn facts_of(&mut self, scene: &Rc<Shape<'t>>) -> Eval<Vec<Fact>> {
        let mut rows = Vec::new();
        self.add_rows(scene, 0, &mut HashSet::new(), &mut rows)?;
        Ok(rows)
    }

    fn add_rows(
        &mut self,
        shape: &Rc<Shape<'t>>,
        depth: usize,
        seen: &mut HashSet<*const ()>,
        rows: &mut Vec<Fact>,
    ) -> Eval<()> {
        if let ShapeKind::Painted { shape, .. }
        | ShapeKind::Named { thunk: Thunk::Fixed(_), inner: shape, .. } = &shape.kind
        {
            return self.add_rows(shape, depth, seen, rows);
        }
        if rows.len() >= ROWS || !seen.insert(Rc::as_ptr(shape).cast()) {
            return Ok(());
        }
        let fact = self.fact(shape, depth)?;
        rows.push(fact);
        for part in parts(shape) {
            self.add_rows(&part, depth + 1, seen, rows)?;
        }
        Ok(())
    }

    fn fact(&mut self, shape: &Rc<Shape<'t>>, depth: usize) -> Eval<Fact> {
        let slope = self.slope_of(shape)?;
        let extent = self.extent_of(shape, 0.0)?;
        let class = match slope.quality {
            Some(Quality::Exact) => Class::Exact,
            Some(Quality::Bound) => Class::Bound,
            None => Class::Steep,
        };
        let (depends_on, operations) = self.dependence_and_cost(shape)?;
        Ok(Fact {
            depth,
            name: name(shape),
            line: self.line_of(shape),
            class,
            basis: self.basis(shape),
            slope: slope.within,
            slope_everywhere: slope.everywhere,
            extent,
            is_convex: self.is_convex(shape)?,
            is_flat: shape.dimension == Dimension::Two,
            depends_on,
            operations,
            copies: self.copies(shape),
        })
    }

    fn copies(&mut self, shape: &Shape<'t>) -> Vec<Copies> {
        let env = match &shape.kind {
            ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
                return self.copies(inner);
            }
            ShapeKind::Field { env, .. } => env,
            ShapeKind::Choice { .. } | ShapeKind::Union { .. } => return Vec::new(),
        };
        let mut out = Vec::new();
        for (name, value) in env.variables() {
            let Value::Record(record) = value else { continue };
            let mut least = |field: &str| match record.get(field) {
                Some(Value::Number(n)) => Some(self.bounds_of_number(n).number().lo),
                _ => None,
            };
            let (Some(asked), Some(of), Some(width), Some(period)) =
                (least("copies"), least("of"), least("width"), least("period"))
            else {
                continue;
            };
            if of > 1.0 {
                let of = if of < crate::NOTHING { of } else { f64::INFINITY };
                let mirrored = matches!(record.get("mirrored"), Some(Value::Number(n)) if n.known() == Some(Constant::Bool(true)));
                out.push(Copies { direction: name.replace('_', " "), asked, of, width, period, mirrored });
            }
        }
        out.sort_by(|a, b| a.direction.cmp(&b.direction));
        out
    }

    fn line_of(&self, shape: &Shape<'t>) -> Option<u32> {
        match &shape.kind {
            ShapeKind::Named { span, .. } => self.line(*span),
            _ if shape.place == Span::default() => None,
            _ => self.line(shape.place),
        }
    }

    fn basis(&self, shape: &Rc<Shape<'t>>) -> Basis {
        if let Some(stated) = self.stated(shape) {
            let place = stated.contract.slope.map(|s| s.1).or(stated.contract.quality.map(|q| q.1));
            match (place, stated.module) {
                (Some(place), Module::User(_)) => {
                    return self.line(place).map_or(Basis::Library, Basis::Stated);
                }
                (Some(_), _) => return Basis::Library,
                (None, _) => {}
            }
        }
        match &shape.kind {
            ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => self.basis(inner),
            ShapeKind::Choice { .. } | ShapeKind::Union { .. } => Basis::Parts,
            ShapeKind::Field { .. } => Basis::Derived,
        }
    }

    /// Which uniforms change a shape, and what one evaluation of it costs.
    fn dependence_and_cost(&mut self, shape: &Rc<Shape<'t>>) -> Eval<(Vec<String>, u64)> {
        let ty = if shape.dimension == Dimension::Three { Type::Vec3 } else { Type::Vec2 };
        self.contexts.open(&Arc::from("fact"), None);
        let point = self.contexts.entry_parameter("p", ty);
        let distance = match self.plain_distance(shape, &point, shape.place) {
            Ok(distance) => self.contexts.value(&distance),
            Err(reported) => {
                self.contexts.discard();
                return Err(reported);
            }
        };
        let (function, _) = self.contexts.finish_apart(vec![distance]);
        let mut program = self.contexts.snapshot();
        program.entry = Some(program.add(function));
        let (program, _) = sdf_ir::simplify(&program, &[]);
        let entry = program.entry.expect("it was just set");
        // Simplifying has left nothing that is not needed.
        let mut used = BTreeSet::new();
        for function in &program.functions {
            used.extend((0..function.node_count() as u32).filter_map(
                |v| match function.node(sdf_ir::Value(v)) {
                    Node::Uniform(index) => Some(program.uniforms[index as usize].name.to_string()),
                    _ => None,
                },
            ));
        }
        Ok((used.into_iter().collect(), cost::operations(&program, entry)))
    }
}

/// What a shape is called in the table.
pub(crate) fn name(shape: &Shape<'_>) -> String {
    match &shape.kind {
        ShapeKind::Named { name, .. } => name.to_string(),
        ShapeKind::Painted { shape, .. } => name(shape),
        ShapeKind::Choice { .. } => "if".into(),
        ShapeKind::Union { .. } => "union".into(),
        ShapeKind::Field { origin: Some(origin), .. } => origin.function.name.text.to_string(),
        ShapeKind::Field { .. } => "field".into(),
    }
}

/// The shapes that a shape is made from.
pub(crate) fn parts<'t>(shape: &Shape<'t>) -> Vec<Rc<Shape<'t>>> {
    match &shape.kind {
        ShapeKind::Named { inner, .. } | ShapeKind::Painted { shape: inner, .. } => parts(inner),
        ShapeKind::Choice { then, otherwise, .. } => vec![then.clone(), otherwise.clone()],
        ShapeKind::Union { shapes } => shapes.clone(),
        ShapeKind::Field { env, .. } => shapes_in(env),
    }
}
