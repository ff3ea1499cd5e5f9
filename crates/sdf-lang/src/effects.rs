//! The effects of the renderer: which of them a scene calls for, what does, and how each is left out to be measured.
//!
//! [`EFFECTS`] is the list of all: a row has the name of an effect, how it is found in the record that the renderer takes,
//! and which flag of that record leaves it out.

use crate::causes::Cause;
use crate::errors::short;
use crate::eval::{Elaborator, Eval};
use crate::facts::{name_of, parts};
use crate::scene::is_antialiased;
use crate::solids::Solids;
use crate::surface::Column;
use crate::value::{Fields, Module, Number, Shape, ShapeKind, Thunk, Value};
use sdf_ir::{Program, Role};
use sdf_syntax::Span;
use sdf_syntax::tree::{ExprKind, Record, SettingsKind};
use std::rc::Rc;
use std::sync::Arc;

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

/// The record that the renderer takes, as far as it is made.
pub(crate) struct Called<'a, 't> {
    pub fields: &'a mut Vec<(Arc<str>, Value<'t>)>,
    pub solids: &'a mut Solids<'t>,
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

/// What calls for an effect, or why nothing does.
enum Found {
    In { subject: Option<String>, cause: Cause, removed_by: Option<(String, String)>, places: Vec<usize> },
    Out { subject: Option<String>, reason: String, span: Option<Span> },
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
            // What the scene's own shading asks for is the sky.
            called.set_number("render", "bounces", if called.flag("transmits") { None } else { Some(0.0) });
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
        find: |e, called| by_setting(e, called, ("fog", "called"), SettingsKind::Fog, &["density"]),
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
            called.set_number("render", "antialias", Some(1.0));
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

/// A slope from which on there is no use in telling it.
const ENDLESS: f64 = 1e6;

/// Why the scene's own shading is without something.
const NOT_CALLED: &str = "the scene's own shading does not call for it";

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
        // From the last on, so that the places of the others stay what they are.
        let mut places = left_out.to_vec();
        places.sort_unstable();
        for effect in places.iter().rev().filter_map(|place| effects.get(*place)).filter(|e| e.is_in) {
            let row = EFFECTS.iter().find(|row| row.name == effect.name);
            if let Some(leave_out) = row.and_then(|row| row.leave_out) {
                leave_out(self, called, &effect.places);
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

fn out(reason: impl Into<String>, span: Option<Span>) -> Found {
    Found::Out { subject: None, reason: reason.into(), span }
}

/// Called for by something that no param changes.
fn always(words: impl Into<String>, span: Option<Span>) -> Found {
    let cause =
        Cause { words: words.into(), span, depends_on: Vec::new(), range: None, zeroed_by: Vec::new() };
    Found::In { subject: None, cause, removed_by: None, places: vec![0] }
}

// ---- how each is found

fn relaxation<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>) -> Eval<Vec<Found>> {
    let is_auto = called.is("render", "relax");
    if is_auto && called.solids.rest().is_none() {
        return Ok(vec![out("rays march to nothing: half spaces are met where a division says", None)]);
    }
    let words = ["`relax` is `auto`", "`relax` is `none`"];
    Ok(vec![by_word(e, is_auto, (SettingsKind::Render, "relax"), words)])
}

fn step_correction<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>) -> Eval<Vec<Found>> {
    let Some(rest) = called.solids.rest().cloned() else {
        return Ok(vec![out("rays march to nothing", None)]);
    };
    if e.slope_of(&rest)?.everywhere <= 1.0 {
        return Ok(vec![out("the scene is steep nowhere", None)]);
    }
    // The shape that makes it so is as steep as the whole.
    let mut shape = rest;
    while let Some(part) = steepest_part(e, &shape)? {
        shape = part;
    }
    let (slope, name) = (e.slope_of(&shape)?, name_of(&shape));
    let how = match (slope.everywhere < ENDLESS, slope.within < ENDLESS) {
        (true, _) => format!("the slope of `{name}` may be {}", short(slope.everywhere)),
        (false, true) => {
            format!("the slope of `{name}` may be {} in its box, and more outside", short(slope.within))
        }
        (false, false) => format!("the slope of `{name}` has no bound"),
    };
    let span = (shape.place != Span::default()).then_some(shape.place);
    Ok(vec![always(how, span)])
}

/// The part of a shape that is as steep as the shape itself, if there is one.
fn steepest_part<'t>(e: &mut Elaborator<'t>, shape: &Rc<Shape<'t>>) -> Eval<Option<Rc<Shape<'t>>>> {
    let whole = e.slope_of(shape)?.everywhere;
    for part in parts(shape) {
        if e.slope_of(&part)?.everywhere >= whole {
            return Ok(Some(part));
        }
    }
    Ok(None)
}

/// The shadows of one kind, one for each light that casts it.
fn shadows<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>, soft: bool) -> Eval<Vec<Found>> {
    let Some(Value::List(lights)) = called.field("lights") else { unreachable!("lights are a list") };
    let kind = if soft { "soft" } else { "hard" };
    let mut found = Vec::new();
    if e.names.user.lights.is_empty() {
        match lights.items.first() {
            Some(light) if casts(light, soft) => {
                found.push(always("no light is declared, and the default one casts it", None));
            }
            Some(light) if soft => found.push(out(why_none(e, light), None)),
            _ => {}
        }
    }
    let mut lit = lights.items.iter().enumerate();
    for (name, record) in e.names.user.lights.clone() {
        let span = field_of(record, "shadow");
        let subject = Some(name.text.to_string());
        let shines = e.light_names.iter().any(|(other, shines)| *other == name.text && *shines);
        let light = if shines { lit.next() } else { None };
        let (index, light) = match light {
            Some((index, light)) if casts(light, soft) => (index, light),
            _ => {
                if asks_for(record, kind) {
                    let dark = "it gives no light: its `intensity` or its `color` is 0".to_string();
                    let reason = light.map_or(dark, |(_, light)| why_none(e, light));
                    found.push(Found::Out { subject, reason, span });
                }
                continue;
            }
        };
        let Value::Record(fields) = light else { unreachable!("a light is a record") };
        let Some(Value::Number(color)) = fields.get("color") else { unreachable!("a light has a colour") };
        let light = e.cause("intensity", color, span);
        // Whether it casts a shadow is static; whether it gives light may not be.
        let cause = Cause { words: format!("`shadow` is `{kind}`"), ..light };
        let removed_by = cause.zeroed_by.first().cloned();
        found.push(Found::In { subject, removed_by, cause, places: vec![index] });
    }
    if found.is_empty() {
        let reason = match lights.items.is_empty() {
            true => "no light reaches a surface".to_string(),
            false => format!("no light casts a {kind} shadow"),
        };
        found.push(out(reason, None));
    }
    Ok(found)
}

/// Why a light casts no shadow that it asks for.
fn why_none(e: &Elaborator<'_>, light: &Value<'_>) -> String {
    let Value::Record(light) = light else { unreachable!("a light is a record") };
    match light.get("unshadowed").is_some_and(Value::is_true) {
        true => "nothing can fall into it".to_string(),
        false if e.own_shading().is_some() => NOT_CALLED.to_string(),
        false => "nothing calls for it".to_string(),
    }
}

/// Occlusion, which the scene's own shading asks for by calling it.
fn occlusion<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>) -> Eval<Vec<Found>> {
    // Who calls it gets it, whatever the colour round about is.
    let settings: &[&str] = if e.own_shading().is_some() { &["occlusion"] } else { &["occlusion", "color"] };
    by_setting(e, called, ("ambient", "occluded"), SettingsKind::Ambient, settings)
}

/// Reflection: by the materials, or by the scene's own shading.
fn reflection<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>) -> Eval<Vec<Found>> {
    if let Some(function) = e.own_shading() {
        let span = Some(function.name.span);
        return Ok(vec![match called.flag("mirrors_by_call") {
            true => always("the scene's own shading calls `reflection()`", span),
            false => out(NOT_CALLED, span),
        }]);
    }
    let found = together(e, Column::Reflect, "no shape of the scene reflects");
    Ok(vec![bounced(e, called.flag("reflects"), found)])
}

/// What the materials call for, unless rays are not to go on.
fn bounced(e: &Elaborator<'_>, is_in: bool, found: Found) -> Found {
    match found {
        Found::In { .. } if !is_in => {
            out("`bounces` is 0", e.span_of_setting(SettingsKind::Render, "bounces"))
        }
        found => found,
    }
}

/// Whether a light casts shadows of this kind.
fn casts(light: &Value<'_>, soft: bool) -> bool {
    let Value::Record(light) = light else { return false };
    let is = |name| light.get(name).is_some_and(Value::is_true);
    is("casts") && is("soft") == soft
}

/// Whether the setting `shadow` of a light begins with this word.
fn asks_for(light: &Record, kind: &str) -> bool {
    let value =
        light.fields.iter().find(|field| &*field.name.text == "shadow").map(|field| &field.value.kind);
    let word = match value {
        Some(ExprKind::Postfix { base, .. }) => Some(&base.kind),
        other => other,
    };
    matches!(word, Some(ExprKind::Name(word)) if &**word == kind)
}

fn field_of(record: &Record, name: &str) -> Option<Span> {
    record.fields.iter().find(|field| &*field.name.text == name).map(|field| field.value.span)
}

/// An effect that a block's flag says is called for, since none of these of its settings is zero. The first is the one that
/// is the effect's own.
fn by_setting<'t>(
    e: &mut Elaborator<'t>,
    called: &Called<'_, 't>,
    (block, flag): (&str, &str),
    kind: SettingsKind,
    settings: &[&str],
) -> Eval<Vec<Found>> {
    let Some(record) = called.record(block) else { unreachable!("`{block}` is a record") };
    let mut causes = Vec::new();
    for name in settings {
        let Some(Value::Number(value)) = record.get(name) else { unreachable!("`{name}` is a number") };
        let span = e.span_of_setting(kind, name);
        if !e.may_be_nonzero(value) {
            let by_default = if span.is_none() { " by default" } else { "" };
            let is = if value.known().is_some() { "is 0" } else { "is always 0" };
            return Ok(vec![out(format!("`{name}` {is}{by_default}"), span)]);
        }
        causes.push(e.cause(name, value, span));
    }
    if !called.is(block, flag) {
        let reason = if e.own_shading().is_some() { NOT_CALLED } else { "nothing calls for it" };
        return Ok(vec![out(reason, None)]);
    }
    let removed_by = causes.iter().flat_map(|cause| cause.zeroed_by.first()).next().cloned();
    Ok(vec![Found::In { subject: None, cause: causes.remove(0), removed_by, places: vec![0] }])
}

/// An effect that a setting switches; the words say what it is if it is in, and if not.
fn by_word(
    e: &mut Elaborator<'_>,
    is_in: bool,
    (kind, name): (SettingsKind, &str),
    [on, off]: [&str; 2],
) -> Found {
    let span = e.span_of_setting(kind, name);
    let by_default = if span.is_none() { " by default" } else { "" };
    match is_in {
        true => always(format!("{on}{by_default}"), span),
        false => out(format!("{off}{by_default}"), span),
    }
}

/// An effect that the materials of shapes call for: one for all parts of the scene of one name for which one line does.
fn by_column(e: &mut Elaborator<'_>, column: Column, otherwise: &str) -> Vec<Found> {
    let mut groups: Vec<Group> = Vec::new();
    let of_column = |(name, causes): &(String, Vec<(Column, Cause)>)| {
        let own = causes.iter().filter(|(c, _)| *c == column).map(|(_, cause)| cause.clone());
        let own: Vec<Cause> = own.collect();
        (!own.is_empty()).then(|| (name.clone(), own))
    };
    for (place, (name, causes)) in e.parts_called.iter().filter_map(of_column).enumerate() {
        match groups.iter_mut().find(|g| g.name == name && g.causes[0].span == causes[0].span) {
            Some(group) => {
                group.places.push(place);
                group.causes.extend(causes);
            }
            None => groups.push(Group { name, causes, places: vec![place] }),
        }
    }
    if groups.is_empty() {
        return vec![out(otherwise, None)];
    }
    groups.into_iter().map(Group::found).collect()
}

/// The same as one effect, for what is in or out for the scene as a whole.
fn together(e: &Elaborator<'_>, column: Column, otherwise: &str) -> Found {
    let all = e.parts_called.iter().flat_map(|(_, causes)| causes);
    let causes: Vec<Cause> = all.filter(|(c, _)| *c == column).map(|(_, cause)| cause.clone()).collect();
    if causes.is_empty() {
        return out(otherwise, None);
    }
    match (Group { name: String::new(), causes, places: vec![0] }).found() {
        Found::In { cause, removed_by, places, .. } => Found::In { subject: None, cause, removed_by, places },
        found => found,
    }
}

/// Parts of a scene of one name, and what calls for an effect of each.
struct Group {
    name: String,
    causes: Vec<Cause>,
    places: Vec<usize>,
}

impl Group {
    fn found(self) -> Found {
        // Each of the materials must be without it.
        let removes = |set: &&(String, String)| self.causes.iter().all(|cause| cause.zeroed_by.contains(set));
        let removed_by = self.causes[0].zeroed_by.iter().find(removes).cloned();
        // The words are about the first of the values that may go farthest.
        let size = |cause: &Cause| cause.range.map_or(f64::INFINITY, |[lo, hi]| hi.max(-lo));
        let farthest = self.causes.iter().rev().max_by(|a, b| size(a).total_cmp(&size(b)));
        let cause = farthest.unwrap_or(&self.causes[0]).clone();
        Found::In { subject: Some(self.name), cause, removed_by, places: self.places }
    }
}

/// An input that the user's files read.
fn read(e: &mut Elaborator<'_>, name: &str) -> Found {
    match e.inputs_read.get(name) {
        Some(span) => always(format!("`{name}` is read"), Some(*span)),
        None => out(format!("nothing reads `{name}`"), None),
    }
}

// ---- the record of the renderer

impl<'t> Called<'_, 't> {
    fn field(&self, name: &str) -> Option<&Value<'t>> {
        self.fields.iter().find(|(other, _)| &**other == name).map(|(_, value)| value)
    }

    fn record(&self, name: &str) -> Option<&Rc<Fields<'t>>> {
        match self.field(name) {
            Some(Value::Record(record)) => Some(record),
            _ => None,
        }
    }

    fn is(&self, block: &str, flag: &str) -> bool {
        self.record(block).and_then(|record| record.get(flag)).is_some_and(Value::is_true)
    }

    /// A truth value of the record itself.
    pub fn flag(&self, name: &str) -> bool {
        self.field(name).is_some_and(Value::is_true)
    }

    fn set_flag(&mut self, name: &str, is: bool) {
        self.replace(name, |_| Value::bool(is));
        if matches!(name, "reflects" | "transmits") {
            let goes_on = self.flag("reflects") || self.flag("transmits");
            self.replace("goes_on", |_| Value::bool(goes_on));
        }
    }

    /// Sets a number of a block, if there is one to set.
    fn set_number(&mut self, block: &str, name: &str, number: Option<f64>) {
        if let Some(number) = number {
            self.replace(block, |record| with(record, name, &Value::float(number)));
        }
    }

    fn replace(&mut self, name: &str, change: impl FnOnce(&Value<'t>) -> Value<'t>) {
        if let Some((_, value)) = self.fields.iter_mut().find(|(other, _)| &**other == name) {
            *value = change(value);
        }
    }

    fn set(&mut self, block: &str, flag: &str, is: bool) {
        self.replace(block, |record| with_flag(record, flag, is));
    }

    fn set_lights(&mut self, places: &[usize], flag: &str, is: bool) {
        self.replace("lights", |lights| {
            let Value::List(list) = lights else { unreachable!("lights are a list") };
            let lights = list.items.iter().enumerate();
            let changed = |(i, light): (usize, &Value<'t>)| {
                if places.contains(&i) { with_flag(light, flag, is) } else { light.clone() }
            };
            Value::list(lights.map(changed).collect())
        });
    }

    /// Takes elements out of a list.
    fn remove(&mut self, list: &str, places: &[usize]) {
        self.replace(list, |value| {
            let Value::List(list) = value else { unreachable!("it is a list") };
            let others = list.items.iter().enumerate().filter(|(i, _)| !places.contains(i));
            Value::list(others.map(|(_, value)| value.clone()).collect())
        });
    }

    /// Lets rays step as far as fields read, however steep these are.
    fn take_whole_steps(&mut self) {
        self.solids.take_whole_steps();
        let map = self.solids.map.clone();
        self.replace("map", |_| map);
    }
}

/// The record with another truth value.
fn with_flag<'t>(record: &Value<'t>, flag: &str, is: bool) -> Value<'t> {
    with(record, flag, &Value::bool(is))
}

/// The record with another value.
fn with<'t>(record: &Value<'t>, name: &str, value: &Value<'t>) -> Value<'t> {
    let Value::Record(record) = record else { unreachable!("it is a record") };
    let fields = record.fields.iter().map(|(other, old)| {
        let value = if &**other == name { value.clone() } else { old.clone() };
        (other.clone(), value)
    });
    Value::record(fields.collect())
}
