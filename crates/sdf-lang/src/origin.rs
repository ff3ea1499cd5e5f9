//! Coordinates relative to a place near the camera, for scenes far from the origin: 32 bits hold few digits of what is
//! small beside what is far away. What moves the scene and what moves the camera is known as a constant, so the difference
//! is folded in `f64`, and nothing is left to compute.

use crate::accuracy::Coordinates;
use crate::eval::{Elaborator, Eval};
use crate::scene::parts_of_union;
use crate::value::{Number, Repr, Shape, Value};
use glam::DVec3;
use sdf_ir::interval::{Bounds, Growing};
use sdf_ir::{Binary, Constant};
use sdf_syntax::Span;
use std::rc::Rc;
use std::sync::Arc;

/// How many times farther than its target the origin is from an eye that is far from the origin.
const FAR: f64 = 64.0;

/// How many times its size a shape is away from the origin if its numbers stand for a place.
const REMOTE: f64 = 64.0;

impl<'t> Elaborator<'t> {
    /// The place that coordinates are relative to, if it is not the origin: where the eye is at time 0 with the params'
    /// defaults, if it is far from the origin beside what it looks at, or if all coordinates are to be relative to it.
    pub fn find_origin(&self, settings: &[(Arc<str>, Value<'t>)], coordinates: Coordinates) -> Option<DVec3> {
        let place = |name: &str| self.setting_at_defaults(settings, "camera", name).map(DVec3::from_array);
        let (eye, target) = (place("eye")?, place("target")?);
        let is_wanted = match coordinates {
            Coordinates::Chosen => eye.length() > FAR * eye.distance(target),
            Coordinates::World => false,
            Coordinates::Camera => true,
        };
        is_wanted.then_some(eye)
    }

    /// Whether a shape's numbers stand for a place so far from the origin that they must be folded with where coordinates
    /// are zero: it is written into its callers then, as a function of its own would take coordinates as they are.
    pub fn is_remote(&mut self, shape: &Rc<Shape<'t>>) -> Eval<bool> {
        if self.origin.is_none() {
            return Ok(false);
        }
        let extent = self.extent_of(shape, 0.0)?;
        let size = DVec3::from_array(extent.size()).length();
        Ok(extent.is_bounded() && DVec3::from_array(extent.center()).length() > REMOTE * size)
    }

    /// The parts of shapes, moved so that `origin` is where coordinates are zero.
    pub fn shapes_from(&mut self, origin: DVec3, shapes: &[Rc<Shape<'t>>]) -> Eval<Vec<Rc<Shape<'t>>>> {
        let by = Value::Number(Number::constant(Constant::Vec3((-origin).to_array())));
        let mut moved = Vec::new();
        for part in shapes.iter().flat_map(parts_of_union) {
            let place = part.place;
            let arguments = [(Arc::from("s"), Value::Shape(part)), (Arc::from("by"), by.clone())];
            let shape = self.call_runtime("moved", &arguments)?;
            moved.push(self.as_shape(shape, place)?);
        }
        Ok(moved)
    }

    /// The settings with all places relative to `origin`: those of the camera and of lights that stand somewhere.
    pub fn settings_from(
        &mut self,
        origin: DVec3,
        settings: Vec<(Arc<str>, Value<'t>)>,
    ) -> Eval<Vec<(Arc<str>, Value<'t>)>> {
        let settings = settings.into_iter().map(|(name, value)| {
            let value = match (&*name, value) {
                ("camera", camera) => self.fields_from(origin, &camera, &["eye", "target"])?,
                ("lights", Value::List(lights)) => {
                    let lights = lights.items.iter().map(|light| match light {
                        Value::Record(r) if r.get("directional").is_some_and(|d| !d.is_true()) => {
                            self.fields_from(origin, light, &["at"])
                        }
                        directional => Ok(directional.clone()),
                    });
                    Value::list(lights.collect::<Eval<_>>()?)
                }
                (_, other) => other,
            };
            Ok((name, value))
        });
        settings.collect()
    }

    /// A record, whose fields of these names are places.
    fn fields_from(&mut self, origin: DVec3, record: &Value<'t>, places: &[&str]) -> Eval<Value<'t>> {
        let Value::Record(record) = record else { unreachable!("places stand in records") };
        let origin = Number::constant(Constant::Vec3(origin.to_array()));
        let fields = record.fields.iter().map(|(name, value)| match value {
            Value::Number(place) if places.contains(&&**name) => {
                let moved = self.binary(Binary::Subtract, place, &origin, Span::default())?;
                Ok((name.clone(), Value::Number(moved)))
            }
            other => Ok((name.clone(), other.clone())),
        });
        Ok(Value::record(fields.collect::<Eval<_>>()?))
    }

    /// The components of a setting at time 0 with the params' defaults, 0 for those that it does not have; nothing if one is
    /// not finite.
    pub fn setting_at_defaults(
        &self,
        settings: &[(Arc<str>, Value<'t>)],
        block: &str,
        name: &str,
    ) -> Option<[f64; 3]> {
        let block = settings.iter().find(|(other, _)| &**other == block);
        let Some((_, Value::Record(block))) = block else { unreachable!("a scene has all blocks") };
        let Some(Value::Number(number)) = block.get(name) else { unreachable!("a setting is a number") };
        let bounds = match &number.repr {
            Repr::Static(c) => Bounds::constant(*c),
            Repr::Frame(value) => {
                let (program, builder) = (&self.contexts.program, self.contexts.frame_builder());
                let defaults: Vec<Bounds> =
                    program.uniforms.iter().map(|u| Bounds::constant(u.default)).collect();
                Growing::new().bounds_of(program, builder, *value, &defaults)
            }
            Repr::Outer(..) | Repr::Local(..) => return None,
        };
        let mut middles = [0.0; 3];
        for (middle, part) in middles.iter_mut().zip(bounds.parts()) {
            *middle = part.lo + (part.hi - part.lo) / 2.0;
        }
        middles.iter().all(|x| x.is_finite()).then_some(middles)
    }
}
