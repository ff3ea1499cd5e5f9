//! The effects of the renderer: which of them a scene calls for, what does, and how each is left out to be measured.
//!
//! [`EFFECTS`] is the list of all: a row has the name of an effect, how it is found in the record that the renderer takes,
//! and which flag of that record leaves it out.

mod find;
mod record;

use crate::causes::Cause;
use crate::eval::{Elaborator, Eval};
use crate::facts::{name_of, parts};
use crate::scene::is_antialiased;
use crate::surface::Column;
use crate::value::{Module, Number, Shape, ShapeKind, Thunk, Value};
use find::{
    Found, always, bounced, by_column, by_setting, by_word, occlusion, out, read, reflection, relaxation,
    shadows, step_correction, together,
};
pub(crate) use record::Called;
use sdf_ir::{Program, Role};
use sdf_syntax::Span;
use sdf_syntax::tree::SettingsKind;
use std::rc::Rc;

/// An effect of the renderer, or an input that pictures may depend on: whether it is in a scene's program, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// What it is called.
    pub name: &'static str,
    /// Whose it is, where there may be several: the name of a light or of a shape.
    pub subject: Option<String>,
    /// Whether it is in.
    pub is_in: bool,
    /// What calls for it, or why nothing does: a clause.
    pub reason: String,
    /// Where that is written, if it is.
    pub span: Option<Span>,
    /// The uniforms that the value depends on which calls for it.
    pub depends_on: Vec<String>,
    /// Where the components of that value lie, if it has bounds: from the least to the largest.
    pub range: Option<[f64; 2]>,
    /// The name of a param and a value within its range: `--set` takes the effect out with it.
    pub removed_by: Option<(String, String)>,
    /// Whether it can be [left out](crate::Options::left_out) to be measured.
    pub can_be_left_out: bool,
    /// Whether it is about how rays march, and not about light.
    pub is_of_march: bool,
    /// How many lights or shapes it is of: those that one line calls for are one effect.
    pub count: usize,
    /// Which of its kind they are, in the record of the renderer.
    places: Vec<usize>,
}

/// A row of the list of effects.
struct Row {
    name: &'static str,
    /// Whether the head of a text lists it.
    is_listed: bool,
    /// What it is about.
    needs: Needs,
    find: for<'t> fn(&mut Elaborator<'t>, &Called<'_, 't>) -> Eval<Vec<Found>>,
    /// Leaves out those at these places of the record; nothing where that cannot be.
    leave_out: Option<for<'t> fn(&mut Elaborator<'t>, &mut Called<'_, 't>, &[usize])>,
}

/// What an effect is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Needs {
    /// Any picture.
    Nothing,
    /// The rays, of whatever is drawn.
    Rays,
    /// Light from surfaces.
    Surfaces,
}

/// All effects; the head of a text lists them in this order.
const EFFECTS: [Row; 19] = [
    Row {
        name: "relaxation",
        is_listed: true,
        needs: Needs::Rays,
        find: relaxation,
        leave_out: Some(|_, called, _| called.set("render", "relax", false)),
    },
    Row {
        name: "step correction",
        is_listed: true,
        needs: Needs::Rays,
        find: step_correction,
        leave_out: Some(|_, called, _| called.take_whole_steps()),
    },
    Row {
        name: "soft shadow",
        is_listed: true,
        needs: Needs::Surfaces,
        find: |e, called| shadows(e, called, true),
        leave_out: Some(|_, called, places| called.set_lights(places, "casts", false)),
    },
    Row {
        name: "hard shadow",
        is_listed: true,
        needs: Needs::Surfaces,
        find: |e, called| shadows(e, called, false),
        leave_out: Some(|_, called, places| called.set_lights(places, "casts", false)),
    },
    Row {
        name: "occlusion",
        is_listed: true,
        needs: Needs::Surfaces,
        find: occlusion,
        leave_out: Some(|_, called, _| called.set("ambient", "occluded", false)),
    },
    Row {
        name: "glow",
        is_listed: true,
        needs: Needs::Surfaces,
        find: |e, _| Ok(by_column(e, Column::Glow, "no shape of the scene glows")),
        leave_out: Some(|_, called, places| called.remove("glows", places)),
    },
    Row {
        name: "reflection",
        is_listed: true,
        needs: Needs::Surfaces,
        find: reflection,
        leave_out: Some(|e, called, _| {
            e.unseen_columns.insert(Column::Reflect);
            called.set_flag("reflects", false);
            // What the scene's own shading asks for is the sky then.
            called.set_flag("mirrors_by_call", false);
        }),
    },
    Row {
        name: "transmission",
        is_listed: true,
        needs: Needs::Surfaces,
        find: |e, called| {
            let found = together(e, Column::Transmit, "no shape of the scene lets light through");
            Ok(vec![bounced(e, called.flag("transmits"), found)])
        },
        leave_out: Some(|e, called, _| {
            e.unseen_columns.insert(Column::Transmit);
            called.set_flag("transmits", false);
        }),
    },
    Row {
        name: "rim light",
        is_listed: true,
        needs: Needs::Surfaces,
        find: |e, called| by_setting(e, called, ("rim", "called"), SettingsKind::Rim, &["color"]),
        leave_out: Some(|_, called, _| called.set("rim", "called", false)),
    },
    Row {
        name: "fog",
        is_listed: true,
        needs: Needs::Nothing,
        find: |e, called| {
            if called.flag("empty") && !called.is("fog", "colored") {
                let span = e.span_of_setting(SettingsKind::Fog, "density");
                return Ok(vec![out("there is nothing but the sky, whose colour it has", span)]);
            }
            by_setting(e, called, ("fog", "called"), SettingsKind::Fog, &["density"])
        },
        leave_out: Some(|_, called, _| {
            called.set("fog", "called", false);
            called.set("fog", "colored", false);
        }),
    },
    Row {
        name: "tone mapping",
        is_listed: true,
        needs: Needs::Nothing,
        find: |e, called| {
            let words = ["`tonemap` is `aces`", "`tonemap` is `none`"];
            Ok(vec![by_word(e, called.is("render", "aces"), (SettingsKind::Render, "tonemap"), words)])
        },
        leave_out: Some(|_, called, _| called.set("render", "aces", false)),
    },
    Row {
        name: "antialiasing",
        is_listed: true,
        needs: Needs::Nothing,
        find: |e, called| {
            let is_in = called.field("render").is_some_and(is_antialiased);
            let words = ["`antialias` is more than 1", "`antialias` is 1"];
            Ok(vec![by_word(e, is_in, (SettingsKind::Render, "antialias"), words)])
        },
        leave_out: Some(|_, called, _| {
            called.set_number("render", "antialias", 1.0);
            called.set_flag("patterned", false);
            called.set_flag("sky_is_patterned", false);
        }),
    },
    Row {
        name: "emission",
        is_listed: false,
        needs: Needs::Surfaces,
        find: |e, _| Ok(vec![together(e, Column::Emission, "no surface of the scene gives light by itself")]),
        leave_out: Some(|e, _, _| {
            e.unseen_columns.insert(Column::Emission);
        }),
    },
    Row {
        name: "own shading",
        is_listed: false,
        needs: Needs::Surfaces,
        find: |e, _| {
            let own = e.own_shading().map(|function| function.name.span);
            Ok(vec![match own {
                Some(span) => always("the file has a `fn shade(surface)`", Some(span)),
                None => out("the file has no `fn shade(surface)`", None),
            }])
        },
        leave_out: Some(|_, called, _| called.set_flag("shaded", false)),
    },
    Row {
        name: "sampled normals",
        is_listed: false,
        needs: Needs::Surfaces,
        find: |e, called| {
            let is_in = ["central", "tetrahedron"].iter().any(|kind| called.is("render", kind));
            let words = ["`normals` is not `exact`", "`normals` is `exact`"];
            Ok(vec![by_word(e, is_in, (SettingsKind::Render, "normals"), words)])
        },
        leave_out: Some(|_, called, _| {
            called.set("render", "central", false);
            called.set("render", "tetrahedron", false);
        }),
    },
    Row {
        name: "parallel rays",
        is_listed: false,
        needs: Needs::Nothing,
        find: |e, called| {
            let words = ["`projection` is `orthographic`", "`projection` is `perspective`"];
            let is_in = called.is("camera", "parallel");
            Ok(vec![by_word(e, is_in, (SettingsKind::Camera, "projection"), words)])
        },
        leave_out: None,
    },
    Row {
        name: "orbit",
        is_listed: false,
        needs: Needs::Nothing,
        find: |e, called| {
            let words = ["`orbit` may be true", "`orbit` is false"];
            Ok(vec![by_word(e, called.is("camera", "orbits"), (SettingsKind::Camera, "orbit"), words)])
        },
        leave_out: Some(|_, called, _| called.set("camera", "orbits", false)),
    },
    Row {
        name: TIME,
        is_listed: false,
        needs: Needs::Nothing,
        find: |e, _| Ok(vec![read(e, TIME)]),
        leave_out: None,
    },
    Row {
        name: MOUSE,
        is_listed: false,
        needs: Needs::Nothing,
        find: |e, _| Ok(vec![read(e, MOUSE)]),
        leave_out: None,
    },
];

/// The inputs that a scene reads by these names.
const TIME: &str = "time";
const MOUSE: &str = "mouse";

impl<'t> Elaborator<'t> {
    /// All effects, in the order of the list: what calls for each, or why nothing does. `is_lit` says whether what is drawn
    /// shows light.
    pub fn effects(&mut self, called: &Called<'_, 't>, is_lit: bool) -> Eval<Vec<Effect>> {
        let is_empty = called.field("empty").is_some_and(Value::is_true);
        let mut effects = Vec::new();
        for row in &EFFECTS {
            let reason = match row.needs {
                Needs::Rays | Needs::Surfaces if is_empty => Some("there is nothing in the scene"),
                Needs::Surfaces if !is_lit => Some("this view shows no light"),
                _ => None,
            };
            let found = match reason {
                Some(reason) => vec![out(reason, None)],
                None => (row.find)(self, called)?,
            };
            effects.extend(found.into_iter().map(|found| effect(row, found)));
        }
        Ok(effects)
    }

    /// Takes those of the effects at these places out of the record of the renderer: the only place that does.
    pub fn leave_out(&mut self, effects: &[Effect], left_out: &[usize], called: &mut Called<'_, 't>) {
        for row in &EFFECTS {
            let is_wanted = |(i, e): &(usize, &Effect)| e.is_in && e.name == row.name && left_out.contains(i);
            let wanted: Vec<&Effect> = effects.iter().enumerate().filter(is_wanted).map(|(_, e)| e).collect();
            // All at once: places are those of the whole record.
            let places: Vec<usize> = wanted.iter().flat_map(|e| e.places.iter().copied()).collect();
            if let (false, Some(leave_out)) = (wanted.is_empty(), row.leave_out) {
                leave_out(self, called, &places);
            }
        }
    }

    /// Notes that the user's files read an input.
    pub fn note_input(&mut self, name: &str, module: Module, span: Span) {
        if !module.is_user() {
            return;
        }
        let first = self.inputs_read.entry(name.to_string()).or_insert(span);
        *first = (*first).min(span);
    }

    /// Notes what calls for a property of the materials that are being looked at.
    pub fn note_column(&mut self, column: Column, value: &Number, span: Option<Span>) {
        // The others are part of light that is there anyway.
        if matches!(column, Column::Glow | Column::Emission | Column::Reflect | Column::Transmit) {
            let cause = self.cause(column.name(), value, span);
            self.column_causes.push((column, cause));
        }
    }

    /// Takes what was noted of a shape's materials.
    pub fn note_part(&mut self, shape: &Shape<'t>) {
        let causes = std::mem::take(&mut self.column_causes);
        self.parts_called.push((subject_of(shape), causes));
    }
}

/// What a part of a scene is called: what is moved or repeated has the name of what is.
fn subject_of(shape: &Shape<'_>) -> String {
    match &shape.kind {
        ShapeKind::Painted { shape, .. } => subject_of(shape),
        ShapeKind::Field { origin: Some(origin), .. } if !origin.module.is_user() => {
            let mut parts: Vec<Rc<Shape>> = parts(shape).iter().map(behind_name).collect();
            parts.dedup_by(|a, b| Rc::ptr_eq(a, b));
            match &parts[..] {
                [only] => subject_of(only),
                _ => name_of(shape),
            }
        }
        _ => name_of(shape),
    }
}

/// The shape that the compiler has given a name and that is painted, by itself.
fn behind_name<'t>(shape: &Rc<Shape<'t>>) -> Rc<Shape<'t>> {
    match &shape.kind {
        ShapeKind::Named { thunk: Thunk::Fixed(_), inner, .. } | ShapeKind::Painted { shape: inner, .. } => {
            behind_name(inner)
        }
        _ => shape.clone(),
    }
}

/// The names that the head of a text lists of effects, without those that are left out.
pub(crate) fn listed(effects: &[Effect], left_out: &[usize]) -> Vec<&'static str> {
    let is_there = |row: &Row| {
        effects.iter().enumerate().any(|(i, e)| e.name == row.name && e.is_in && !left_out.contains(&i))
    };
    EFFECTS.iter().filter(|row| row.is_listed && is_there(row)).map(|row| row.name).collect()
}

/// Takes inputs out of the list that the finished program does not read.
pub(crate) fn settle_inputs(effects: &mut [Effect], program: &Program) {
    for (name, role) in [(TIME, Role::Time), (MOUSE, Role::Mouse)] {
        if program.uniforms.iter().any(|uniform| uniform.role == role) {
            continue;
        }
        for effect in effects.iter_mut().filter(|effect| effect.name == name && effect.is_in) {
            effect.is_in = false;
            effect.reason = format!("nothing that is drawn depends on `{name}`");
        }
    }
}

fn effect(row: &Row, found: Found) -> Effect {
    let (can_be_left_out, is_of_march) = (row.leave_out.is_some(), row.needs == Needs::Rays);
    match found {
        Found::In { subject, cause: Cause { words, span, depends_on, range, .. }, removed_by, places } => {
            Effect {
                name: row.name,
                subject,
                is_in: true,
                reason: words,
                span,
                depends_on,
                range,
                removed_by,
                can_be_left_out,
                is_of_march,
                count: places.len(),
                places,
            }
        }
        Found::Out { subject, reason, span } => Effect {
            name: row.name,
            subject,
            is_in: false,
            reason,
            span,
            depends_on: Vec::new(),
            range: None,
            removed_by: None,
            can_be_left_out,
            is_of_march,
            count: 0,
            places: Vec::new(),
        },
    }
}
