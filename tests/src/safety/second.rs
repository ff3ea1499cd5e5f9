//! That a ball holds no surface of a shape, by the [definitions](crate::attack::definitions) that the library's shapes
//! have besides their formulas: by inequalities, whose slopes have bounds where a formula's have none, and by points.

use super::HEIGHT;
use crate::attack::definitions::Definitions;
use crate::attack::search::{Found, distance_to_curve};
use crate::attack::subject::Kind;
use sdf_ir::Program;
use sdf_lang::{Options, Scene};
use sdf_render::Frame;
use sdf_render::certify::{Certifier, Functions, Prover};

/// How closely the distance to points is looked for, as a share of the ball's radius.
const TOLERANCE: f64 = 0.005;
/// What the library's areas are as outlines alone, which leave open which side is inside.
const OUTLINES: [&str; 2] = ["polygon", "star"];

/// Both files of definitions.
#[derive(Debug)]
pub struct Files {
    /// Those by inequalities.
    pub solids: Definitions,
    /// Those by points.
    pub curves: Definitions,
}

/// How a shape consists of points.
struct Curve {
    program: Program,
    /// Whether it is an area, which is extruded.
    is_area: bool,
    /// Whether the points are the outline.
    is_outline: bool,
}

/// The other definitions of one shape.
pub struct Second {
    solid: Option<Certifier>,
    curve: Option<Curve>,
}

/// What can be asked of a compiled scene.
pub fn certifier(scene: &Scene) -> Certifier {
    let certificate = scene.certificate.as_ref().expect("asked for");
    let functions = Functions { map: scene.map, ray: certificate.ray, step: certificate.step };
    Certifier::new(&scene.program, functions, &Frame::new(1, 1))
}

impl Second {
    /// Those of a call of the function of this name.
    pub fn of(files: &Files, name: &str, call: &str, kind: Kind) -> Second {
        let options = Options { certificate: true, attack: Some(0), ..Options::default() };
        let solid = files.solids.has(name).then(|| {
            let scene = match kind {
                Kind::Area => files.solids.scene(&[name, "extrude"], &extruded(call), Kind::Solid, &options),
                _ => files.solids.scene(&[name], call, kind, &options),
            };
            certifier(&scene.unwrap_or_else(|said| panic!("{said}")))
        });
        let curve = files.curves.has(name).then(|| {
            let program = files.curves.program(name, call, Kind::Solid);
            let program = program.unwrap_or_else(|said| panic!("{said}"));
            Curve { program, is_area: kind == Kind::Area, is_outline: OUTLINES.contains(&name) }
        });
        Second { solid, curve }
    }

    /// What answers questions about the inequalities.
    pub fn prover(&self) -> Option<Prover<'_>> {
        self.solid.as_ref().map(Certifier::prover)
    }

    /// Whether the ball certainly holds nothing of the surface, by the points that the shape consists of. The inequalities
    /// tell on which side of an outline the centre is.
    pub fn is_free_of_points(&self, solid: Option<&mut Prover>, center: [f64; 3], radius: f64) -> bool {
        let Some(curve) = &self.curve else { return false };
        let found = distance_to_curve(&curve.program, center, TOLERANCE * radius);
        let (mut away, beyond) = match curve.is_area {
            true => ((found.at_least, found.at_most), center[2].abs() - HEIGHT),
            false => ((found.at_least, found.at_most), f64::NEG_INFINITY),
        };
        if curve.is_outline {
            let Found { at_least, at_most, .. } = found;
            // The middle of the height is as far as can be from both ends.
            away = match solid.and_then(|prover| prover.is_outside([center[0], center[1], 0.0])) {
                Some(true) => (at_least, at_most),
                Some(false) => (-at_most, -at_least),
                None => return false,
            };
        }
        is_farther(away, beyond, radius)
    }
}

/// A shape of the plane with a height.
pub fn extruded(call: &str) -> String {
    format!("({call}).extrude({HEIGHT})")
}

/// Whether a point is farther than `radius` from the surface of what is extruded, by bounds of its signed distance in the
/// plane and by how far it is beyond the ends.
fn is_farther((at_least, at_most): (f64, f64), beyond: f64, radius: f64) -> bool {
    let outside = at_least.max(0.0).hypot(beyond.max(0.0));
    let inside = (-at_most).min(-beyond);
    outside.max(inside) > radius
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extruded_area_is_as_far_as_its_nearest_side() {
        let free = |away: f64, beyond: f64, radius: f64| is_farther((away, away), beyond, radius);
        for (away, beyond, distance) in
            [(3.0, -1.0, 3.0), (-1.0, 2.0, 2.0), (3.0, 4.0, 5.0), (-3.0, -1.0, 1.0), (-1.0, -3.0, 1.0)]
        {
            assert!(free(away, beyond, distance - 1e-9), "{away} {beyond}");
            assert!(!free(away, beyond, distance + 1e-9), "{away} {beyond}");
        }
        assert!(!is_farther((-0.5, 0.5), f64::NEG_INFINITY, 0.1));
    }
}
