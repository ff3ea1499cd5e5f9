//! How each effect is found: what calls for it, or why nothing does.

use crate::causes::Cause;
use crate::effects::record::Called;
use crate::errors::short;
use crate::eval::{Elaborator, Eval};
use crate::facts::{name_of, parts};
use crate::surface::Column;
use crate::value::{Shape, Value};
use sdf_syntax::Span;
use sdf_syntax::tree::{ExprKind, Record, SettingsKind};
use std::rc::Rc;

/// A slope from which on there is no use in telling it.
const ENDLESS: f64 = 1e6;

/// Why the scene's own shading is without something.
const NOT_CALLED: &str = "the scene's own shading does not call for it";

/// What calls for an effect, or why nothing does.
pub enum Found {
    In { subject: Option<String>, cause: Cause, removed_by: Option<(String, String)>, places: Vec<usize> },
    Out { subject: Option<String>, reason: String, span: Option<Span> },
}

pub fn out(reason: impl Into<String>, span: Option<Span>) -> Found {
    Found::Out { subject: None, reason: reason.into(), span }
}

/// Called for by something that no param changes.
pub fn always(words: impl Into<String>, span: Option<Span>) -> Found {
    let cause =
        Cause { words: words.into(), span, depends_on: Vec::new(), range: None, zeroed_by: Vec::new() };
    Found::In { subject: None, cause, removed_by: None, places: vec![0] }
}

pub fn relaxation<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>) -> Eval<Vec<Found>> {
    let is_auto = called.is("render", "relax");
    if is_auto && called.solids.rest().is_none() {
        return Ok(vec![out("rays march to nothing: half spaces are met where a division says", None)]);
    }
    let words = ["`relax` is `auto`", "`relax` is `none`"];
    Ok(vec![by_word(e, is_auto, (SettingsKind::Render, "relax"), words)])
}

pub fn step_correction<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>) -> Eval<Vec<Found>> {
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
pub fn shadows<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>, soft: bool) -> Eval<Vec<Found>> {
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
pub fn occlusion<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>) -> Eval<Vec<Found>> {
    // Who calls it gets it, whatever the colour round about is.
    let settings: &[&str] = if e.own_shading().is_some() { &["occlusion"] } else { &["occlusion", "color"] };
    by_setting(e, called, ("ambient", "occluded"), SettingsKind::Ambient, settings)
}

/// Reflection: by the materials, or by the scene's own shading.
pub fn reflection<'t>(e: &mut Elaborator<'t>, called: &Called<'_, 't>) -> Eval<Vec<Found>> {
    if let Some(function) = e.own_shading() {
        let span = Some(function.name.span);
        return Ok(vec![match called.flag("mirrors_by_call") {
            true => always("the scene's own shading calls `reflection()`", span),
            false if !e.bounces => out("`bounces` is 0", e.span_of_setting(SettingsKind::Render, "bounces")),
            false => out(NOT_CALLED, span),
        }]);
    }
    let found = together(e, Column::Reflect, "no shape of the scene reflects");
    Ok(vec![bounced(e, called.flag("reflects"), found)])
}

/// What the materials call for, unless rays are not to go on.
pub fn bounced(e: &Elaborator<'_>, is_in: bool, found: Found) -> Found {
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
pub fn by_setting<'t>(
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
pub fn by_word(
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
pub fn by_column(e: &mut Elaborator<'_>, column: Column, otherwise: &str) -> Vec<Found> {
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
pub fn together(e: &Elaborator<'_>, column: Column, otherwise: &str) -> Found {
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
pub fn read(e: &mut Elaborator<'_>, name: &str) -> Found {
    match e.inputs_read.get(name) {
        Some(span) => always(format!("`{name}` is read"), Some(*span)),
        None => out(format!("nothing reads `{name}`"), None),
    }
}
