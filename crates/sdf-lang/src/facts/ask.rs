//! The built-in functions that ask what is proved: `lo`, `hi`, `reach`, `slope`, `most`, and the boxes of what is turned
//! or mirrored; and `any_cell`, to ask it of shapes that differ from cell to cell. What they give is known now, and holds for all values of the params and for all times.

use crate::builtin::number;
use crate::context::Op;
use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::facts::boxes;
use crate::facts::promise::{UNKNOWN_SLOPE, bounds_of_cell, coordinate, corner_number};
use crate::value::{Number, Repr, Shape, Value};
use sdf_ir::interval::{Interval, Sloped, Walker};
use sdf_ir::region::{Extent, FAR, Steepness, steepest};
use sdf_ir::{Constant, Role, Type, Uniform};
use sdf_syntax::Span;
use sdf_syntax::tree::Dimension;
use std::rc::Rc;
use std::sync::Arc;

/// How often the search for the steepest place of a function may ask.
const PIECES: usize = 100;

impl<'t> Elaborator<'t> {
    /// `lo(s)` or `hi(s)`: a corner of the shape's box; with a level, of the box of the points where the field is at
    /// most that.
    pub fn corner_of(
        &mut self,
        arguments: &[Option<Value<'t>>],
        _span: Span,
        corner: fn(&Extent) -> [f64; 3],
    ) -> Eval<Value<'t>> {
        let shape = shape_argument(arguments);
        let level = match &arguments[1] {
            Some(_) => {
                let level = number(arguments, 1);
                // The largest that it may be: the box of a higher level holds that of a lower one.
                self.bounds_of_number(&level).number().hi
            }
            None => self.facts.level,
        };
        let extent = match level < sdf_ir::region::FAR {
            true => self.extent_of(&shape, level)?,
            false => Extent::ALL,
        };
        Ok(Value::Number(corner_number(corner(&extent), shape.dimension)))
    }

    /// `reach(s, axis)`: how far from the line through the origin along `axis` the shape extends.
    pub fn reach_of(&mut self, arguments: &[Option<Value<'t>>], _span: Span) -> Eval<Value<'t>> {
        let extent = self.extent_of(&shape_argument(arguments), self.facts.level)?;
        let reach = match unit(&number(arguments, 1)) {
            Some(axis) => extent.reach(axis),
            // Whatever the axis, no farther than the farthest corner.
            None if extent.is_empty() => 0.0,
            None => (0..3).map(|i| extent.lo[i].abs().max(extent.hi[i].abs()).powi(2)).sum::<f64>().sqrt(),
        };
        Ok(Value::float(coordinate(reach)))
    }

    /// `slope(f)`: a Lipschitz constant of a shape's field, or of a function of a point.
    pub fn slope_value(&mut self, arguments: &[Option<Value<'t>>], span: Span) -> Eval<Value<'t>> {
        match &arguments[0] {
            Some(Value::Shape(shape)) => {
                if let Some(samples) = &self.facts.samples {
                    let own = samples.iter().filter(|(s, _)| Rc::ptr_eq(s, shape)).map(|(_, n)| n.clone());
                    let own: Vec<Number> = own.collect();
                    if let Some((first, rest)) = own.split_first() {
                        let mut largest = first.clone();
                        for slope in rest {
                            largest = self.binary(sdf_ir::Binary::Max, &largest, slope, span)?;
                        }
                        return Ok(Value::Number(largest));
                    }
                }
                let slope = self.slope_of(&shape.clone())?;
                Ok(Value::float(slope.within.min(UNKNOWN_SLOPE)))
            }
            Some(function @ Value::Function(_)) => {
                let slope = self.slope_of_function(&function.clone(), span)?;
                Ok(Value::float(slope.min(UNKNOWN_SLOPE)))
            }
            other => {
                let found = other.as_ref().map_or("nothing".into(), Value::describe);
                self.report(errors::wrong_type(span, "a shape or a function", &found))
            }
        }
    }

    /// A Lipschitz constant of a function of a point of space, or of the plane, or of a float.
    fn slope_of_function(&mut self, function: &Value<'t>, span: Span) -> Eval<f64> {
        let reported = self.diagnostics.len();
        for ty in [Type::Vec3, Type::Vec2, Type::Float] {
            self.contexts.open(&Arc::from("slope"), None);
            let point = self.contexts.entry_parameter("p", ty);
            let value = self.call_function(function, vec![Value::Number(point)], span);
            let Ok(Value::Number(result)) = value else {
                self.contexts.discard();
                continue;
            };
            self.diagnostics.truncate(reported);
            let result = self.contexts.value(&result);
            let (function, outside) = self.contexts.finish_apart(vec![result]);
            if !outside.is_empty() {
                return Ok(f64::INFINITY);
            }
            let (uniforms, globals) = (self.bounds_of_uniforms(), self.bounds_of_globals());
            let program = &self.contexts.program;
            let mut walker = Walker::<Sloped>::new(program, &function, &uniforms, &globals);
            let ask = |cell: &Extent| {
                let point = Sloped::point(bounds_of_cell(cell, ty));
                Steepness { at_most: walker.run(&[point])[0].norm(), at_least: 0.0 }
            };
            let mut all = Extent { lo: [0.0; 3], hi: [0.0; 3] };
            for axis in 0..ty.size() {
                (all.lo[axis], all.hi[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
            }
            return Ok(steepest(ty.size(), &all, PIECES, ask));
        }
        self.diagnostics.truncate(reported);
        self.report(errors::wrong_type(span, "a function from a point to a number", "another function"))
    }

    /// `most(x)`: the largest that a number may be.
    pub fn most_of(&mut self, arguments: &[Option<Value<'t>>], _span: Span) -> Eval<Value<'t>> {
        let bounds = self.bounds_of_number(&number(arguments, 0));
        Ok(Value::float(coordinate(bounds.number().hi)))
    }

    /// `any_cell(first, last)`: a vector that may be any from `first` to `last`, as a cell of a repetition is.
    pub fn any_cell(&mut self, arguments: &[Option<Value<'t>>], span: Span) -> Eval<Value<'t>> {
        let (first, last) = (number(arguments, 0), number(arguments, 1));
        let (Some(Constant::Vec3(first)), Some(Constant::Vec3(last))) = (first.known(), last.known()) else {
            return self.report(errors::not_static(span, "the range of cells"));
        };
        let parts: Vec<Number> = (0..3)
            .map(|i| {
                if first[i] == last[i] {
                    return Number::float(first[i]);
                }
                // What messages call it. It is a uniform of which no shader hears, for nothing is drawn with it.
                let axis = ["x", "y", "z"][i];
                let name = match first[i] > -FAR {
                    true => format!("cell.{axis} in {}..{}", first[i], last[i]),
                    false => format!("cell.{axis}"),
                };
                self.contexts.uniform(Uniform {
                    name: Arc::from(name),
                    ty: Type::Float,
                    role: Role::Param { range: Some((first[i], last[i])), color: false },
                    default: Constant::Float(first[i].max(0.0).min(last[i])),
                })
            })
            .collect();
        Ok(Value::Number(self.contexts.apply(Op::Compose, &parts)))
    }

    /// `is_even(s, axis, middle)`: whether a field is certainly the same on both sides of the plane across a coordinate
    /// axis at `middle`.
    pub fn is_even_about(&mut self, arguments: &[Option<Value<'t>>], span: Span) -> Eval<Value<'t>> {
        let shape = shape_argument(arguments);
        let axis = self.widen(&number(arguments, 1), Type::Vec3, span)?;
        let axis = unit(&axis).and_then(|axis| axis.iter().position(|x| *x == 1.0));
        let middle = number(arguments, 2).known().map(|c| c.components()[0]);
        let is_even = match axis.zip(middle) {
            Some((axis, middle)) => self.is_even(&shape, axis, middle)?,
            None => false,
        };
        Ok(Value::Number(Number::constant(Constant::Bool(is_even))))
    }

    /// `turned(s, axis, angle)`: the box round a shape that is turned; without an angle, by any.
    pub fn turned_box(&mut self, arguments: &[Option<Value<'t>>], _span: Span) -> Eval<Value<'t>> {
        let shape = shape_argument(arguments);
        let extent = self.extent_of(&shape, self.facts.level)?;
        let angle = match &arguments[2] {
            Some(Value::Number(n)) => self.bounds_of_number(n).number(),
            _ => Interval::ALL,
        };
        Ok(box_value(&boxes::turned(&extent, unit(&number(arguments, 1)), angle), Dimension::Three))
    }

    /// `turned(s, angle)` of a shape of the plane; without an angle, by any.
    pub fn turned_box_in_plane(&mut self, arguments: &[Option<Value<'t>>], _span: Span) -> Eval<Value<'t>> {
        let extent = self.extent_of(&shape_argument(arguments), self.facts.level)?;
        let angle = match &arguments[1] {
            Some(Value::Number(n)) => self.bounds_of_number(n).number(),
            _ => Interval::ALL,
        };
        Ok(box_value(&boxes::turned(&extent, Some([0.0, 0.0, 1.0]), angle), Dimension::Two))
    }

    /// `mirrored(s, axis, offset)`: the box round the positive side of a shape and its image.
    pub fn mirrored_box(&mut self, arguments: &[Option<Value<'t>>], ty: Type, span: Span) -> Eval<Value<'t>> {
        let shape = shape_argument(arguments);
        let extent = self.extent_of(&shape, self.facts.level)?;
        let axis = self.widen(&number(arguments, 1), ty, span)?;
        let offset = self.bounds_of_number(&number(arguments, 2)).number();
        Ok(box_value(&boxes::mirrored(&extent, unit(&axis), offset), shape.dimension))
    }

    /// `reflected(s, axis)`: the box round the mirror image of a shape.
    pub fn reflected_box(
        &mut self,
        arguments: &[Option<Value<'t>>],
        ty: Type,
        span: Span,
    ) -> Eval<Value<'t>> {
        let shape = shape_argument(arguments);
        let extent = self.extent_of(&shape, self.facts.level)?;
        let axis = self.widen(&number(arguments, 1), ty, span)?;
        let image = match unit(&axis) {
            Some(axis) => boxes::reflected(&extent, axis, Interval::ZERO),
            None if extent.is_empty() => Extent::NONE,
            None => Extent::ALL,
        };
        Ok(box_value(&image, shape.dimension))
    }
}

fn shape_argument<'t>(arguments: &[Option<Value<'t>>]) -> Rc<Shape<'t>> {
    match &arguments[0] {
        Some(Value::Shape(shape)) => shape.clone(),
        _ => unreachable!("the parameter takes a shape"),
    }
}

/// The direction of a vector that is known now, with length one; one of the plane lies in it.
fn unit(number: &Number) -> Option<[f64; 3]> {
    let constant = match &number.repr {
        Repr::Static(c) => *c,
        _ => number.known()?,
    };
    let v = match constant {
        Constant::Vec3(v) => v,
        Constant::Vec2([x, y]) => [x, y, 0.0],
        Constant::Float(x) => [x; 3],
        Constant::Bool(_) => return None,
    };
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}

/// A box as a record of its corners.
fn box_value<'t>(extent: &Extent, dimension: Dimension) -> Value<'t> {
    let corner = |c: [f64; 3]| Value::Number(corner_number(c, dimension));
    Value::record(vec![(Arc::from("lo"), corner(extent.lo)), (Arc::from("hi"), corner(extent.hi))])
}
