//! Lights whose shadows nothing can fall into: they are left out, as if the file had asked for none.
//!
//! A ray leaves a surface where it is lit, where its normal n and the direction l to the light make `n·l > 0`. Let all parts of
//! a scene be convex, and the eye outside of them, so that all that is seen is the outside of some part B. What can the ray
//! meet?
//!
//! * Not B: it lies on one side of the plane through the point across n, and the ray goes to the other.
//! * Not a half space whose normal N has `N·l >= 0`: what begins outside of it only gets farther away. If the light is at a
//!   place outside of it, so is all between the two.
//! * Not another part A, if a plane lies between A and all ways from B to the light. They fill a convex set: B's box, moved on
//!   towards the light without end, or what B's box and the light span. It and A's box are convex with few faces, so if
//!   there is such a plane, one is across a face of either, or along an edge of both (Stefan Gottschalk, Ming Lin and Dinesh
//!   Manocha, "OBBTree", the theorem of separating axes).
//!
//! What is shown of all pairs for all values of the params and at all times, by intervals, is shown of the scene.
//!
//! A soft shadow darkens what a ray passes near by as well, the body itself too. Only over half spaces, from which rays rise
//! evenly, is it known to be none: the distance at t along a ray is at least `t·(N·l)`. A factor of √2 keeps what rounding takes
//! from that (`runtime/soft_shadow.sdf`) far off.
//!
//! A shadow also puts out the highlight where a surface is turned away from the light. As h lies in the middle between l and
//! the direction v to the eye, `n·h` is at most `sin(θ/2)` there, with θ between l and v. Where that may be seen, and in
//! mirrors, which see from everywhere, the highlight still ends where the light does, by a comparison.

use crate::eval::{Elaborator, Eval};
use crate::surface::Column;
use crate::value::{Fields, Number, Shape, Value};
use sdf_ir::Type;
use sdf_ir::interval::{Bounds, Interval};
use sdf_ir::region::Extent;
use sdf_syntax::Span;
use std::f64::consts::SQRT_2;
use std::rc::Rc;
use std::sync::Arc;

/// How many parts are compared with each other. Among more there is hardly a pair for which it cannot be shown.
const MOST_PARTS: usize = 64;
/// By how much two parts must be apart, as a share of their coordinates: rounding must not bring them together.
const GAP: f64 = 1e-6;
/// A light that shines along a plane so exactly counts as along it.
const ALONG: f64 = 1e-12;
/// How bright a highlight may be that is not seen: a twentieth of the first step of a picture of 8 bits.
const UNSEEN: f64 = 1.5e-5;

type Vector = [Interval; 3];

/// A convex part of the scene.
enum Part<'t> {
    /// A half space, with its field and the gradient of that.
    HalfSpace(Rc<Shape<'t>>, Vector),
    /// Any other, in its box.
    Boxed(Extent),
}

/// Where light comes from.
enum Source {
    /// Everywhere from this direction.
    Direction(Vector),
    /// From a place.
    Place(Bounds),
}

impl<'t> Elaborator<'t> {
    /// The settings with no shadow for lights whose shadows nothing can fall into. The records of these lights tell that they
    /// are `unshadowed`.
    pub fn without_idle_shadows(
        &mut self,
        scene: &Rc<Shape<'t>>,
        mut settings: Vec<(Arc<str>, Value<'t>)>,
    ) -> Eval<Vec<(Arc<str>, Value<'t>)>> {
        let record = |name: &str| settings.iter().find(|(other, _)| &**other == name).map(|(_, v)| v.clone());
        let (Some(Value::List(lights)), Some(Value::Record(camera))) = (record("lights"), record("camera"))
        else {
            unreachable!("a scene has lights and a camera")
        };
        let casts = |light: &Value<'t>| matches!(light, Value::Record(l) if is_true(l, "casts"));
        if !lights.items.iter().any(casts) {
            return Ok(settings);
        }
        let Some(parts) = self.convex_parts(scene)? else { return Ok(settings) };
        // Rays that go through what they meet come to its inside.
        if self.may_be_inside(scene, &camera)? || self.goes_on(scene, Column::Transmit)? {
            return Ok(settings);
        }
        let Some(Value::Number(eye)) = camera.get("eye") else { unreachable!("a camera has an eye") };
        let eye = vector(&self.bounds_of_number(eye));
        let mut changed = Vec::new();
        for light in &lights.items {
            let Value::Record(fields) = light else { unreachable!("a light is a record") };
            changed.push(match is_true(fields, "casts") && self.is_unshadowed(fields, &parts)? {
                true => self.unshadowed(fields, scene, &parts, &eye)?,
                false => light.clone(),
            });
        }
        for (name, value) in &mut settings {
            if &**name == "lights" {
                *value = Value::list(std::mem::take(&mut changed));
            }
        }
        Ok(settings)
    }

    /// The parts of a scene, if all are convex and not too many.
    fn convex_parts(&mut self, scene: &Rc<Shape<'t>>) -> Eval<Option<Vec<Part<'t>>>> {
        let shapes = self.parts_behind(scene)?;
        if shapes.len() > MOST_PARTS {
            return Ok(None);
        }
        let mut parts = Vec::new();
        for shape in shapes {
            if !self.is_convex(&shape)? {
                return Ok(None);
            }
            let extent = self.extent_of(&shape, 0.0)?;
            if extent.is_empty() {
                continue;
            }
            parts.push(match self.is_half_space(&shape)? {
                true => {
                    // It is the same everywhere.
                    let gradient = self.gradient_over(&shape, &Bounds::between([-1.0; 3], [1.0; 3]))?;
                    Part::HalfSpace(shape, gradient)
                }
                false => Part::Boxed(extent),
            });
        }
        Ok(Some(parts))
    }

    /// Whether no ray to a light meets anything.
    fn is_unshadowed(&mut self, light: &Fields<'t>, parts: &[Part<'t>]) -> Eval<bool> {
        let source = self.source(light);
        if is_true(light, "soft") {
            return Ok(self.rises_evenly(light, &source, parts));
        }
        for (i, lit) in parts.iter().enumerate() {
            if !self.may_be_lit(&source, lit)? {
                continue;
            }
            for (j, other) in parts.iter().enumerate() {
                if i != j && self.may_shadow(&source, other, lit)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    fn source(&mut self, light: &Fields<'t>) -> Source {
        let bounds = self.bounds_of_number(number(light, "at"));
        match is_true(light, "directional") {
            true => Source::Direction(vector(&bounds)),
            false => Source::Place(bounds),
        }
    }

    /// Whether rays to a light rise from all parts so steeply that a soft shadow is none.
    fn rises_evenly(&mut self, light: &Fields<'t>, source: &Source, parts: &[Part<'t>]) -> bool {
        let softness = self.bounds_of_number(number(light, "softness")).number().lo;
        let Source::Direction(direction) = source else { return false };
        parts.iter().all(|part| match part {
            Part::HalfSpace(_, gradient) => {
                let steepness = length(gradient).max(1.0);
                softness * dot(gradient, direction).lo >= SQRT_2 * steepness
            }
            Part::Boxed(_) => false,
        })
    }

    fn may_be_lit(&mut self, source: &Source, part: &Part<'t>) -> Eval<bool> {
        Ok(match (part, source) {
            (Part::HalfSpace(_, gradient), Source::Direction(direction)) => {
                dot(gradient, direction).hi > ALONG * length(gradient)
            }
            (Part::HalfSpace(shape, _), Source::Place(place)) => self.distances(shape, place)?.hi > 0.0,
            (Part::Boxed(_), _) => true,
        })
    }

    /// Whether a part may stand between a light and another part.
    fn may_shadow(&mut self, source: &Source, part: &Part<'t>, lit: &Part<'t>) -> Eval<bool> {
        Ok(match (source, part, lit) {
            (Source::Direction(direction), Part::HalfSpace(_, gradient), _) => {
                dot(gradient, direction).lo < -ALONG * length(gradient)
            }
            (Source::Place(place), Part::HalfSpace(shape, _), _) => self.distances(shape, place)?.lo < 0.0,
            (Source::Direction(direction), Part::Boxed(part), Part::Boxed(lit)) => {
                !is_beside_ways(direction, part, lit)
            }
            (Source::Place(place), Part::Boxed(part), Part::Boxed(lit)) => {
                !is_beside_span(&vector(place), part, lit)
            }
            // Whatever stands on it somewhere.
            (Source::Direction(_), Part::Boxed(_), Part::HalfSpace(..)) => true,
            // What is farther from it than the light.
            (Source::Place(place), Part::Boxed(part), Part::HalfSpace(lit, _)) => {
                let light = self.distances(lit, place)?.hi;
                let part = self.distances(lit, &Bounds::between(part.lo, part.hi))?.lo;
                let is_farther = part > light + GAP * light.abs();
                !is_farther
            }
        })
    }

    /// A light without its shadow.
    fn unshadowed(
        &mut self,
        light: &Rc<Fields<'t>>,
        scene: &Rc<Shape<'t>>,
        parts: &[Part<'t>],
        eye: &Vector,
    ) -> Eval<Value<'t>> {
        let is_cut = !self.is_highlight_unseen(light, scene, parts, eye)?;
        let fields = light.fields.iter().map(|(name, value)| {
            let value = match &**name {
                "casts" => Value::bool(false),
                "unshadowed" => Value::bool(true),
                "cut" => Value::bool(is_cut),
                _ => value.clone(),
            };
            (name.clone(), value)
        });
        Ok(Value::record(fields.collect()))
    }

    /// Whether rays go on from where they meet the scene, by this property of its materials.
    fn goes_on(&mut self, scene: &Rc<Shape<'t>>, property: Column) -> Eval<bool> {
        Ok(self.bounces && self.columns_of(scene)?.contains(&property))
    }

    /// Whether a light's highlights are too dark to be seen where surfaces are turned away from it: from the eye, and not in
    /// mirrors.
    fn is_highlight_unseen(
        &mut self,
        light: &Fields<'t>,
        scene: &Rc<Shape<'t>>,
        parts: &[Part<'t>],
        eye: &Vector,
    ) -> Eval<bool> {
        if self.own_shading().is_some() || self.goes_on(scene, Column::Reflect)? {
            return Ok(false);
        }
        let source = self.source(light);
        let cosine = parts.iter().map(|part| least_cosine(&source, part, eye)).fold(1.0, f64::min);
        let largest = ((1.0 - cosine) / 2.0).max(0.0).sqrt().min(1.0);
        let [specular, shininess] = self.shine_of(scene)?;
        let power = self.bounds_of_number(number(light, "color"));
        let power = power.parts().iter().map(|x| x.most()).fold(0.0, f64::max);
        // One that is infinitely bright times 0 is no number, and not known to be dark.
        Ok(largest == 0.0 || specular.most() * power * largest.powf(shininess.lo.max(0.0)) <= UNSEEN)
    }

    /// Where `specular` and `shininess` of a scene's materials lie.
    fn shine_of(&mut self, scene: &Rc<Shape<'t>>) -> Eval<[Interval; 2]> {
        let asked = [Column::Specular, Column::Shininess];
        self.contexts.open(&Arc::from("shine"), None);
        let point = self.contexts.entry_parameter("p", Type::Vec3);
        let normal = self.contexts.entry_parameter("n", Type::Vec3);
        let found = self.find_columns(scene, &point, &normal, Span::default()).and_then(|()| {
            self.columns.retain(|column| asked.contains(column));
            self.surface_record(&asked, scene, &point, &normal, Span::default())
        });
        let bounds = found.map(|record| {
            let Value::Record(record) = record else { unreachable!("properties are a record") };
            asked.map(|column| self.bounds_of_number(number(&record, column.name())).number())
        });
        self.contexts.discard();
        bounds
    }
}

/// Whether a plane lies between a box and all that is seen from another in a direction.
fn is_beside_ways(direction: &Vector, part: &Extent, lit: &Extent) -> bool {
    let apart = apart(part, lit);
    let gap = gap(&[part, lit]);
    let faces = (0..3).any(|axis| {
        let (ahead, along) = (apart[axis], direction[axis]);
        ahead.lo > gap && along.hi <= 0.0 || ahead.hi < -gap && along.lo >= 0.0
    });
    faces
        || (0..3).any(|axis| {
            let across = dot(&cross_axis(direction, axis), &apart);
            across.lo > gap || across.hi < -gap
        })
}

/// Whether a plane lies between a box and all that is between another and a place.
fn is_beside_span(place: &Vector, part: &Extent, lit: &Extent) -> bool {
    let from_lit = apart(part, lit);
    let from_place: Vector =
        std::array::from_fn(|axis| Interval::new(part.lo[axis], part.hi[axis]).minus(place[axis]));
    let gap = gap(&[part, lit]);
    let separates = |axis: &Vector| {
        let (a, b) = (dot(axis, &from_lit), dot(axis, &from_place));
        a.lo > gap && b.lo > gap || a.hi < -gap && b.hi < -gap
    };
    let middle = place.map(|x| Interval::point(x.middle()));
    let corner = |k: usize| -> Vector {
        std::array::from_fn(|axis| {
            let end = if k >> axis & 1 == 1 { lit.hi[axis] } else { lit.lo[axis] };
            Interval::point(end).minus(middle[axis])
        })
    };
    (0..3).any(|axis| separates(&unit(axis)))
        || (0..8).any(|k| (0..3).any(|axis| separates(&normalized(&cross_axis(&corner(k), axis)))))
}

/// How far the points of one box are from those of another.
fn apart(a: &Extent, b: &Extent) -> Vector {
    std::array::from_fn(|axis| {
        Interval::new(a.lo[axis], a.hi[axis]).minus(Interval::new(b.lo[axis], b.hi[axis]))
    })
}

fn gap(boxes: &[&Extent]) -> f64 {
    let ends = boxes.iter().flat_map(|e| e.lo.iter().chain(&e.hi)).filter(|x| x.is_finite());
    GAP * ends.fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The least cosine of the angle between the ways to a light and to the eye, from where a part may be turned away from the
/// light; 1 if there it is nowhere.
fn least_cosine(source: &Source, part: &Part, eye: &Vector) -> f64 {
    let extent = match (part, source) {
        (Part::HalfSpace(_, gradient), Source::Direction(direction)) => {
            return if dot(gradient, direction).lo > 0.0 { 1.0 } else { -1.0 };
        }
        (Part::HalfSpace(..), Source::Place(_)) => return -1.0,
        (Part::Boxed(extent), _) => extent,
    };
    let place = |axis: usize| Interval::new(extent.lo[axis], extent.hi[axis]);
    let to_eye: Vector = std::array::from_fn(|axis| eye[axis].minus(place(axis)));
    let (product, to_light) = match source {
        Source::Direction(direction) => (dot(&to_eye, direction).lo, 1.0),
        Source::Place(light) => {
            let light = vector(light);
            let to_light: Vector = std::array::from_fn(|axis| light[axis].minus(place(axis)));
            // (a - x)(b - x) is the square of x less its middle between both, less that of half of what is between them.
            let parts = (0..3).map(|axis| {
                let middle = eye[axis].plus(light[axis]).scaled(0.5).minus(place(axis));
                let half = eye[axis].minus(light[axis]).scaled(0.5);
                middle.squared().minus(half.squared()).lo
            });
            (parts.sum(), least_length(&to_light))
        }
    };
    if product >= 0.0 {
        return 0.0;
    }
    (product / (least_length(&to_eye) * to_light)).max(-1.0)
}

fn is_true(record: &Fields<'_>, name: &str) -> bool {
    record.get(name).is_some_and(Value::is_true)
}

fn number<'a>(record: &'a Fields<'_>, name: &str) -> &'a Number {
    match record.get(name) {
        Some(Value::Number(number)) => number,
        _ => unreachable!("`{name}` is a number"),
    }
}

fn vector(bounds: &Bounds) -> Vector {
    std::array::from_fn(|axis| bounds.part(axis))
}

fn unit(axis: usize) -> Vector {
    std::array::from_fn(|i| if i == axis { Interval::ONE } else { Interval::ZERO })
}

fn dot(a: &Vector, b: &Vector) -> Interval {
    (0..3).fold(Interval::ZERO, |sum, axis| sum.plus(a[axis].times(b[axis])))
}

/// A vector across another and a coordinate axis.
fn cross_axis(v: &Vector, axis: usize) -> Vector {
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut across = [Interval::ZERO; 3];
    (across[next], across[last]) = (v[last].negated(), v[next]);
    across
}

/// A fixed vector with about the length 1, of points.
fn normalized(v: &Vector) -> Vector {
    let length = v.iter().map(|x| x.middle().powi(2)).sum::<f64>().sqrt();
    match length.is_finite() && length > 0.0 {
        true => v.map(|x| Interval::point(x.middle() / length)),
        false => [Interval::ZERO; 3],
    }
}

fn length(v: &Vector) -> f64 {
    v.iter().map(|x| x.most().powi(2)).sum::<f64>().sqrt()
}

fn least_length(v: &Vector) -> f64 {
    v.iter().map(|x| x.least().powi(2)).sum::<f64>().sqrt()
}
