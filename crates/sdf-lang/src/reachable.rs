//! Whether rays reach anything of a scene: a picture of which it is proved that it shows nothing but sky is not what was
//! meant.

use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::scene::parts_of_union;
use crate::value::{Shape, Value};
use glam::DVec3;
use sdf_ir::region::Extent;
use sdf_syntax::Span;
use sdf_syntax::tree::SettingsKind;
use std::rc::Rc;
use std::sync::Arc;

impl<'t> Elaborator<'t> {
    /// Warns if all of a scene lies farther from the eye than rays go, at time 0 with the params' defaults. `scene` is the
    /// place of its first word.
    pub fn warn_beyond_far(
        &mut self,
        shapes: &[Rc<Shape<'t>>],
        settings: &[(Arc<str>, Value<'t>)],
        scene: Span,
    ) -> Eval<()> {
        let setting = |block, name| self.setting_at_defaults(settings, block, name);
        let (Some(eye), Some([far, ..])) = (setting("camera", "eye"), setting("render", "far")) else {
            return Ok(());
        };
        let mut nearest = f64::INFINITY;
        for part in shapes.iter().flat_map(parts_of_union) {
            nearest = nearest.min(distance(&self.extent_of(&part, 0.0)?, DVec3::from_array(eye)));
        }
        // A scene of nothing is as it was written.
        if nearest > far && nearest.is_finite() {
            let span = self.span_of_setting(SettingsKind::Render, "far").unwrap_or(scene);
            self.diagnostics.push(errors::beyond_far(span, nearest, far));
        }
        Ok(())
    }
}

/// The distance from a point to a box: infinite for an empty one.
fn distance(extent: &Extent, point: DVec3) -> f64 {
    if extent.is_empty() {
        return f64::INFINITY;
    }
    let (lo, hi) = (DVec3::from_array(extent.lo), DVec3::from_array(extent.hi));
    (lo - point).max(point - hi).max(DVec3::ZERO).length()
}
