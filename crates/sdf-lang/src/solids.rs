//! The scene as rays see it: half spaces, which a ray meets where a division says, and the solids, which it marches to,
//! with the box that they lie in.

use crate::contract::Quality;
use crate::eval::{Elaborator, Eval, name_shape};
use crate::facts::{corner_number, room};
use crate::surface::Column;
use crate::value::{Fields, Number, Shape, ShapeKind, Thunk, Value};
use sdf_ir::region::Extent;
use sdf_syntax::Span;
use sdf_syntax::tree::Dimension;
use std::rc::Rc;
use std::sync::Arc;

/// The shapes of a scene, told apart by how a ray meets them.
pub(crate) struct Solids<'t> {
    /// Those whose fields are affine.
    half_spaces: Vec<Rc<Shape<'t>>>,
    /// The half spaces that some of the others are outside of the box.
    grounds: Vec<Rc<Shape<'t>>>,
    /// The box of the others.
    extent: Extent,
    /// The union of the others, if there are any.
    rest: Option<Rc<Shape<'t>>>,
    /// The union of all, in the order of the source.
    pub map: Value<'t>,
    /// Whether steps are as long as the fields read, however steep these are.
    takes_whole_steps: bool,
}

/// From what size on scenes are measured as they are: of smaller ones hardware may take the squares of what a pixel shows,
/// some 1e-5 of them, for zero.
const TINY: f64 = 1e-13;

impl<'t> Solids<'t> {
    /// What is marched to, if there is anything.
    pub fn rest(&self) -> Option<&Rc<Shape<'t>>> {
        self.rest.as_ref()
    }

    /// Forgets how steep the fields are, so that a step is as long as a field reads.
    pub fn take_whole_steps(&mut self) {
        self.takes_whole_steps = true;
        self.rest = self.rest.as_ref().map(as_if_not_steep);
        if let Value::Shape(map) = &self.map {
            self.map = Value::Shape(as_if_not_steep(map));
        }
    }

    /// Whether what is marched to is so small, and so near to the origin, that hardware takes squares for zero.
    pub fn are_tiny(&self) -> bool {
        let corners = [self.extent.lo, self.extent.hi];
        self.rest.is_some() && corners.iter().flatten().all(|x| x.abs() < TINY)
    }
}

impl<'t> Elaborator<'t> {
    /// Tells the shapes of a scene apart.
    pub fn solids(&mut self, shapes: &[Rc<Shape<'t>>], place: Span) -> Eval<Solids<'t>> {
        let mut entries = Vec::new();
        for shape in shapes {
            let parts = self.parts_behind(shape)?;
            let mut is_half_space = Vec::new();
            for part in &parts {
                is_half_space.push(self.is_half_space(part)?);
            }
            if is_half_space.contains(&true) {
                entries.extend(parts.into_iter().zip(is_half_space));
            } else {
                entries.push((shape.clone(), false));
            }
        }
        let named = |shapes: Vec<Rc<Shape<'t>>>, name: &str, doc| {
            let shape = Value::Shape(union_of(shapes, place));
            name_shape(shape, &Arc::from(name), place, Thunk::Fixed(doc))
        };
        let all = |wanted: bool| entries.iter().filter(|e| e.1 == wanted).map(|e| e.0.clone()).collect();
        let (half_spaces, rest): (Vec<_>, Vec<_>) = (all(true), all(false));
        let (mut grounds, mut extent) = (Vec::new(), Extent::NONE);
        for shape in &rest {
            let own = match self.ground(shape)? {
                Some(ground) => {
                    grounds.push(ground.rest);
                    ground.extent
                }
                None => self.extent_of(shape, 0.0)?,
            };
            extent = extent.union(&own);
        }
        const MAP: &str = "The distance from a point to the scene.";
        if half_spaces.is_empty() {
            let map = named(rest, "map", MAP);
            let Value::Shape(shape) = &map else { unreachable!("a shape was named") };
            return Ok(Solids {
                half_spaces,
                grounds,
                extent,
                rest: Some(shape.clone()),
                map,
                takes_whole_steps: false,
            });
        }
        if rest.is_empty() {
            let map = named(half_spaces.clone(), "map", MAP);
            return Ok(Solids { half_spaces, grounds, extent, rest: None, map, takes_whole_steps: false });
        }
        let solids = named(rest, "solids", "The distance from a point to what is not a half space.");
        let Value::Shape(solids) = solids else { unreachable!("a shape was named") };
        // Where the source has the half spaces first or last, the map is made from them and the solids; a tie takes
        // what the source has first.
        let first = entries.iter().position(|e| !e.1).unwrap_or(0);
        let last = entries.iter().rposition(|e| !e.1).unwrap_or(0);
        let mut parts: Vec<Rc<Shape>> = entries.iter().map(|e| e.0.clone()).collect();
        if entries[first..=last].iter().all(|e| !e.1) {
            parts.splice(first..=last, [solids.clone()]);
        }
        let map = named(parts, "map", MAP);
        Ok(Solids { half_spaces, grounds, extent, rest: Some(solids), map, takes_whole_steps: false })
    }

    /// What the renderer is told of how rays meet the scene: `planes`, the half spaces; `grounds`, those that solids are
    /// outside of the box, if it is `grounded` on any; `solids`, the union of the others,
    /// unless it is `hollow`, and its box from `lo` to `hi`, if it is `bounded`; whether its field is `steep` and steps are
    /// `relaxed`; whether the eye may be `inside`; and whether its distances are `exact`, so that a small one means
    /// a surface near by.
    pub fn solid_fields(
        &mut self,
        solids: &Solids<'t>,
        settings: &[(Arc<str>, Value<'t>)],
    ) -> Eval<Vec<(Arc<str>, Value<'t>)>> {
        let record = |wanted: &str| match settings.iter().find(|(name, _)| &**name == wanted) {
            Some((_, Value::Record(record))) => record.clone(),
            _ => unreachable!("`{wanted}` is a record"),
        };
        let Value::Shape(map) = &solids.map else { unreachable!("a scene is a shape") };
        let goes_through = settings.iter().any(|(name, value)| &**name == "transmits" && value.is_true());
        let inside = goes_through || self.may_be_inside(map, &record("camera"))?;
        let rest = solids.rest.clone().unwrap_or_else(|| map.clone());
        let render = record("render");
        let relaxed = render.get("relax").is_some_and(Value::is_true);
        let is_scaled = render.get("scaled").is_some_and(Value::is_true);
        let slope = self.slope_of(&rest)?;
        let is_exact = slope.quality == Some(Quality::Exact);
        let corners = corners(&solids.extent);
        let [lo, hi] = corners.clone().unwrap_or_else(|| [Number::float(0.0), Number::float(0.0)]);
        let list = |shapes: &[Rc<Shape<'t>>]| {
            Value::list(shapes.iter().map(|shape| Value::Shape(shape.clone())).collect())
        };
        Ok(vec![
            (Arc::from("planes"), list(&solids.half_spaces)),
            (Arc::from("grounds"), list(&solids.grounds)),
            (Arc::from("grounded"), Value::bool(!solids.grounds.is_empty())),
            (Arc::from("hollow"), Value::bool(solids.rest.is_none())),
            (Arc::from("bounded"), Value::bool(corners.is_some())),
            (Arc::from("lo"), Value::Number(lo)),
            (Arc::from("hi"), Value::Number(hi)),
            (
                Arc::from("steep"),
                Value::bool(
                    solids.rest.is_some()
                        && (is_scaled || !solids.takes_whole_steps && slope.everywhere > 1.0),
                ),
            ),
            (Arc::from("relaxed"), Value::bool(solids.rest.is_some() && relaxed)),
            (Arc::from("inside"), Value::bool(inside)),
            (Arc::from("exact"), Value::bool(is_exact)),
            (Arc::from("solids"), Value::Shape(rest)),
        ])
    }

    /// What the renderer is told of what lets light through, if something `transmits`: which of the planes are `clear_planes`;
    /// `clear`, the union of all that does, and `opaque`, of the others, if it `has_opaque` ones; and of both what is marched to,
    /// `clear_solids` and `opaque_solids`, if it has those.
    pub fn clear_fields(
        &mut self,
        shapes: &[Rc<Shape<'t>>],
        solids: &Solids<'t>,
        transmits: bool,
        place: Span,
    ) -> Eval<Vec<(Arc<str>, Value<'t>)>> {
        let mut fields = Vec::new();
        let mut clear_planes = Vec::new();
        for plane in &solids.half_spaces {
            clear_planes.push(Value::bool(transmits && self.columns_of(plane)?.contains(&Column::Transmit)));
        }
        fields.push((Arc::from("clear_planes"), Value::list(clear_planes)));
        if !transmits {
            return Ok(fields);
        }
        let mut parts = Vec::new();
        for shape in shapes {
            for part in self.parts_behind(shape)? {
                let is_clear = self.columns_of(&part)?.contains(&Column::Transmit);
                let is_solid = !self.is_half_space(&part)?;
                parts.push((part, is_clear, is_solid));
            }
        }
        const DOCS: [[&str; 2]; 2] = [
            [
                "The distance from a point to what is opaque.",
                "The distance from a point to what is opaque and no half space.",
            ],
            [
                "The distance from a point to what lets light through.",
                "The distance from a point to what lets light through and is no half space.",
            ],
        ];
        for (wanted, all, marched, [of_all, of_marched]) in
            [(false, "opaque", "opaque_solids", DOCS[0]), (true, "clear", "clear_solids", DOCS[1])]
        {
            let own = |only_solids: bool| -> Vec<Rc<Shape<'t>>> {
                let own =
                    parts.iter().filter(|(_, clear, solid)| *clear == wanted && (*solid || !only_solids));
                own.map(|(part, ..)| part.clone()).collect()
            };
            for (name, shapes, doc) in [(all, own(false), of_all), (marched, own(true), of_marched)] {
                let has = !shapes.is_empty();
                let shape = Value::Shape(union_of(shapes, place));
                let shape = name_shape(shape, &Arc::from(name), place, Thunk::Fixed(doc));
                fields.push((Arc::from(format!("has_{name}")), Value::bool(has)));
                fields.push((Arc::from(name), shape));
            }
        }
        Ok(fields)
    }

    /// Whether a shape's field is affine. What is bounded has none.
    pub fn is_half_space(&mut self, shape: &Rc<Shape<'t>>) -> Eval<bool> {
        if self.extent_of(shape, 0.0)?.is_bounded() {
            return Ok(false);
        }
        self.is_affine(shape)
    }

    /// Whether the eye may be in the scene's solids, for some values of the params and at some times; of parallel rays, which
    /// begin all over the plane of the eye, some may.
    pub fn may_be_inside(&mut self, map: &Rc<Shape<'t>>, camera: &Fields<'t>) -> Eval<bool> {
        match (camera.get("eye"), camera.get("orbits")) {
            (Some(Value::Number(eye)), Some(Value::Number(orbits)))
                if !camera.get("parallel").is_some_and(Value::is_true)
                    && orbits.known() == Number::constant(sdf_ir::Constant::Bool(false)).known() =>
            {
                let eye = self.bounds_of_number(eye);
                Ok(self.least_distance(map, &eye)? <= 0.0)
            }
            _ => Ok(true),
        }
    }
}

/// One of the functions of a scene, of which nobody asks how steep it is.
fn as_if_not_steep<'t>(shape: &Rc<Shape<'t>>) -> Rc<Shape<'t>> {
    let ShapeKind::Named { name, span, thunk: Thunk::Fixed(what), inner } = &shape.kind else {
        unreachable!("the functions of a scene have names")
    };
    let kind =
        ShapeKind::Named { name: name.clone(), span: *span, thunk: Thunk::Fixed(what), inner: inner.clone() };
    let Shape { dimension, painted, place, .. } = **shape;
    Rc::new(Shape { dimension, kind, painted, steep: false, place })
}

/// The corners of the box that shapes lie in, far away where it has no end; nothing if it has none at all.
pub(crate) fn corners(extent: &Extent) -> Option<[Number; 2]> {
    let extent = extent.grown(room(extent));
    let corner = |corner| corner_number(corner, Dimension::Three);
    (!extent.is_everything()).then(|| [corner(extent.lo), corner(extent.hi)])
}

pub(crate) fn union_of<'t>(shapes: Vec<Rc<Shape<'t>>>, place: Span) -> Rc<Shape<'t>> {
    Rc::new(Shape {
        dimension: Dimension::Three,
        painted: shapes.iter().any(|s| s.painted),
        steep: shapes.iter().any(|s| s.steep),
        kind: ShapeKind::Union { shapes },
        place,
    })
}
