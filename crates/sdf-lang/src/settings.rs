//! The blocks of settings: checked, completed with defaults, and handed to the renderer as records.

mod render;

pub(crate) use render::default_of;

use crate::Options;
use crate::context::Op;
use crate::errors;
use crate::eval::{Elaborator, Eval, Reported};
use crate::ranges::{NOT_NEGATIVE, POSITIVE, Range};
use crate::shading::Calls;
use crate::value::{Callable, Env, Module, Number, Value};
use glam::DVec3;
use render::RENDER;
use sdf_ir::{Binary, Constant, Role, Ternary, Type, Unary};
use sdf_syntax::Span;
use sdf_syntax::tree::{Expr, ExprKind, Name, PostfixKind, Record, SettingsKind};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::rc::Rc;
use std::sync::Arc;

/// The fields of each block, in the order of the language's page.
const CAMERA: &[&str] = &["eye", "target", "up", "fov", "orbit", "projection"];
const LIGHT: &[&str] = &["direction", "position", "color", "intensity", "shadow"];
const AMBIENT: &[&str] = &["color", "occlusion", "radius"];
const SKY: &[&str] = &["color", "horizon", "zenith"];
const FOG: &[&str] = &["color", "density"];
const RIM: &[&str] = &["color", "power"];
/// The blocks that have one record of fields, by their words.
pub(crate) const BLOCKS: [(&str, &[&str]); 7] = [
    ("camera", CAMERA),
    ("light", LIGHT),
    ("ambient", AMBIENT),
    ("sky", SKY),
    ("fog", FOG),
    ("rim", RIM),
    ("render", RENDER),
];

/// What `projection` of the camera may be.
const PROJECTIONS: &[&str] = &["perspective", "orthographic"];

/// The values that settings may have.
const FIELD_OF_VIEW: Range = Range {
    accepts: |x| x > 0.0 && x < std::f64::consts::PI,
    words: "more than 0 and less than 180deg; without a unit it is in radians",
};
const SOFTNESS: Range = Range { accepts: |x| x > 0.0, words: "more than 0; 2 is very soft, 32 nearly hard" };
/// The fields of one block that a file sets.
struct Block<'t> {
    fields: HashMap<&'static str, &'t Expr>,
    /// Whether it has fields that do not exist: what seems to be absent may be one of them.
    has_unknown: bool,
}

/// How a light casts shadows.
enum Shadow {
    None,
    Hard,
    Soft(Number),
}

impl<'t> Elaborator<'t> {
    fn settings_block(&mut self, kind: SettingsKind, name: &str, all: &'static [&'static str]) -> Block<'t> {
        let blocks: Vec<_> =
            self.names.user.settings.iter().filter(|(k, ..)| *k == kind).map(|(_, r, s)| (*r, *s)).collect();
        for pair in blocks.windows(2) {
            self.diagnostics.push(errors::block_twice(pair[1].1, name, blocks[0].1));
        }
        match blocks.first() {
            Some((record, _)) => self.fields(record, name, all),
            None => Block { fields: HashMap::new(), has_unknown: false },
        }
    }

    /// Where the value of a setting is written, if it is.
    pub fn span_of_setting(&self, kind: SettingsKind, name: &str) -> Option<Span> {
        let (_, record, _) = self.names.user.settings.iter().find(|(k, ..)| *k == kind)?;
        record.fields.iter().find(|field| &*field.name.text == name).map(|field| field.value.span)
    }

    fn fields(&mut self, record: &'t Record, name: &str, all: &'static [&'static str]) -> Block<'t> {
        let mut fields: HashMap<&'static str, &'t Expr> = HashMap::new();
        let mut first: HashMap<&'static str, &'t Name> = HashMap::new();
        let mut has_unknown = false;
        for field in &record.fields {
            let Some(known) = all.iter().find(|a| **a == &*field.name.text) else {
                let similar = sdf_syntax::did_you_mean(&field.name.text, all.iter().copied());
                self.diagnostics.push(errors::unknown_setting(&field.name, name, similar, all));
                has_unknown = true;
                continue;
            };
            if let Some(before) = first.insert(known, &field.name) {
                self.diagnostics.push(errors::setting_twice(&field.name, before.span));
                continue;
            }
            fields.insert(known, &field.value);
        }
        Block { fields, has_unknown }
    }

    /// The value of a field as a number, or its default.
    fn number_setting(&mut self, block: &Block<'t>, name: &str, default: Constant) -> Eval<Number> {
        let name_arc: Arc<str> = Arc::from(name);
        match block.fields.get(name) {
            None => Ok(Number::constant(default).named(&name_arc)),
            Some(expr) => {
                let value = self.eval(expr, &Env::new(Module::ROOT))?;
                Ok(self.as_typed(value, default.ty(), expr.span)?.named(&name_arc))
            }
        }
    }

    /// The same with the values that it may have.
    fn ranged_setting(
        &mut self,
        block: &Block<'t>,
        name: &str,
        default: Constant,
        range: Range,
    ) -> Eval<Number> {
        let number = self.number_setting(block, name, default)?;
        if let Some(expr) = block.fields.get(name) {
            self.check_range(&number, expr.span, &format!("`{name}`"), range)?;
        }
        Ok(number)
    }

    /// The value of a field as a float that is known now and lies in a range.
    fn static_setting(&mut self, block: &Block<'t>, name: &str, default: f64, range: Range) -> Eval<f64> {
        let Some(expr) = block.fields.get(name) else { return Ok(default) };
        let what = format!("`{name}`");
        let x = self.static_float(expr, &Env::new(Module::ROOT), &what)?;
        self.check_range(&Number::float(x), expr.span, &what, range)?;
        Ok(x)
    }

    /// The word that a field is set to, one of `words`.
    fn word_setting(
        &mut self,
        block: &Block<'t>,
        name: &str,
        words: &[&'static str],
        default: &'static str,
    ) -> Eval<&'static str> {
        let Some(expr) = block.fields.get(name) else { return Ok(default) };
        if let ExprKind::Name(word) = &expr.kind
            && let Some(known) = words.iter().find(|w| **w == &**word)
        {
            return Ok(known);
        }
        let similar = match &expr.kind {
            ExprKind::Name(word) => sdf_syntax::did_you_mean(word, words.iter().copied()),
            _ => None,
        };
        self.report(errors::wrong_word(expr.span, name, similar, words))
    }

    /// All settings as the record that the renderer takes.
    pub fn settings(&mut self, options: &Options) -> Eval<Vec<(Arc<str>, Value<'t>)>> {
        let camera = self.camera(options);
        let render = self.render_settings(options);
        let lights = self.lights();
        let shading = if lights.is_ok() { self.calls_of_shading() } else { Ok(None) };
        let calls = shading.as_ref().ok().and_then(Option::as_ref);
        let ambient = self.ambient(calls);
        let sky = self.sky();
        let fog = self.fog();
        let rim = self.rim();
        let calls = shading?;
        let shade = self.own_shading().map_or(Value::bool(false), |function| self.shading_function(function));
        Ok(vec![
            (Arc::from("shaded"), Value::bool(calls.is_some())),
            (Arc::from("shade"), shade),
            (Arc::from("mirrors_by_call"), Value::bool(calls.as_ref().is_some_and(|calls| calls.reflection))),
            (Arc::from("camera"), camera?),
            (Arc::from("lights"), without_shadows(lights?, calls.as_ref())),
            (Arc::from("ambient"), ambient?),
            (Arc::from("sky"), sky?),
            (Arc::from("fog"), fog?),
            (Arc::from("rim"), rim?),
            (Arc::from("render"), render?),
        ])
    }

    fn camera(&mut self, options: &Options) -> Eval<Value<'t>> {
        let block = self.settings_block(SettingsKind::Camera, "camera", CAMERA);
        let projection = self.word_setting(&block, "projection", PROJECTIONS, PROJECTIONS[0]);
        let target = self.number_setting(&block, "target", Constant::Vec3([0.0; 3]));
        let up = self.number_setting(&block, "up", Constant::Vec3([0.0, 1.0, 0.0]));
        let fov = self.ranged_setting(&block, "fov", Constant::Float(FRAC_PI_4), FIELD_OF_VIEW);
        let has_eye = block.fields.contains_key("eye");
        let eye = has_eye.then(|| self.number_setting(&block, "eye", Constant::Vec3([0.0; 3])));
        let orbits = self.number_setting(&block, "orbit", Constant::Bool(false));
        let (mut target, up, fov, eye, orbits) = (target?, up?, fov?, eye.transpose()?, orbits?);
        let is_parallel = projection? == "orthographic";
        let eye = match eye {
            Some(eye) => eye,
            None => {
                let (eye, center) = self.frame_scene(block.fields.contains_key("target"), &target, &fov)?;
                target = center;
                eye
            }
        };
        if let (Some(a), Some(b)) = (eye.known(), target.known())
            && a == b
        {
            let span = block.fields.get("eye").map_or(Span::default(), |e| e.span);
            return self.report(errors::wrong_setting(
                span,
                "the camera stands where it looks",
                "move `eye` away from `target`",
            ));
        }
        let orbit = self.orbit(orbits, tilt_range([&eye, &target, &up]), options)?;
        let is_turned = Number::constant(Constant::Bool(orbit.is_some()));
        let (turn, zoom) = orbit.unwrap_or((Number::constant(Constant::Vec2([0.0; 2])), Number::float(1.0)));
        Ok(fields([
            ("eye", eye),
            ("target", target),
            ("up", up),
            ("fov", fov),
            ("parallel", Number::constant(Constant::Bool(is_parallel))),
            ("orbits", is_turned),
            ("turn", turn),
            ("zoom", zoom),
        ]))
    }

    /// How the camera is turned about its target, if it ever is: the angles round `up` and towards it, and the
    /// factor of its distance. The pointer in the middle leaves it where it is; the picture's width is a full turn.
    fn orbit(
        &mut self,
        asked: Number,
        tilt: (f64, f64),
        options: &Options,
    ) -> Eval<Option<(Number, Number)>> {
        if options.orbit {
            let orbit = self.input("orbit", Type::Vec3, Role::Orbit { tilt });
            let zoom = self.component(&orbit, 2);
            return Ok(Some((orbit, zoom)));
        }
        if asked.known() == Some(Constant::Bool(false)) {
            return Ok(None);
        }
        let mouse = self.input("mouse", Type::Vec2, Role::Mouse);
        let middle = Number::constant(Constant::Vec2([0.5; 2]));
        let offset = self.contexts.apply(Op::Binary(Binary::Subtract), &[middle, mouse]);
        let turns = Number::constant(Constant::Vec2([TAU, PI]));
        let turn = self.contexts.apply(Op::Binary(Binary::Multiply), &[offset, turns]);
        let still = Number::constant(Constant::Vec2([0.0; 2]));
        let turn = self.contexts.apply(Op::Ternary(Ternary::Select), &[asked, turn, still]);
        Ok(Some((turn, Number::float(1.0))))
    }

    /// The camera that frames the bounded parts of the scene from direction (1, 0.7, 1.5).
    fn frame_scene(&mut self, has_target: bool, target: &Number, fov: &Number) -> Eval<(Number, Number)> {
        let (center, radius) = self.scene_ball();
        self.framed = Some((radius * 12.0).ceil());
        let target = if has_target {
            target.clone()
        } else {
            Number::constant(Constant::Vec3(center.to_array())).named(&Arc::from("target"))
        };
        let direction = DVec3::new(1.0, 0.7, 1.5).normalize();
        let half = self.binary(Binary::Multiply, fov, &Number::float(0.5), Span::default())?;
        let sine = self.unary(Unary::Sin, &half, Span::default())?;
        let distance = self.binary(Binary::Divide, &Number::float(radius * 1.15), &sine, Span::default())?;
        let unit = Number::constant(Constant::Vec3(direction.to_array()));
        let offset = self.binary(Binary::Multiply, &unit, &distance, Span::default())?;
        let eye = self.binary(Binary::Add, &target, &offset, Span::default())?;
        Ok((eye.named(&Arc::from("eye")), target))
    }

    fn lights(&mut self) -> Eval<Value<'t>> {
        if self.names.user.lights.is_empty() {
            self.light_names = vec![(Arc::from(""), true)];
            let direction = Number::constant(Constant::Vec3([0.5, 0.7, 0.4]));
            let direction = self.unary(Unary::Normalize, &direction, Span::default())?;
            let one = Number::constant(Constant::Vec3([1.0; 3]));
            return Ok(Value::list(vec![light_record(
                true,
                direction,
                one,
                Shadow::Soft(Number::float(8.0)),
            )]));
        }
        let mut out = Vec::new();
        let mut failed = false;
        for (name, record) in &self.names.user.lights {
            match self.light(name, record) {
                Ok(light) => {
                    self.light_names.push((name.text.clone(), light.is_some()));
                    out.extend(light);
                }
                Err(Reported) => failed = true,
            }
        }
        if failed { Err(Reported) } else { Ok(Value::list(out)) }
    }

    /// A light, or nothing where it can never give any.
    fn light(&mut self, name: &'t Name, record: &'t Record) -> Eval<Option<Value<'t>>> {
        let block = self.fields(record, "light", LIGHT);
        let directional = match (block.fields.get("direction"), block.fields.get("position")) {
            (Some(_), None) => true,
            (None, Some(_)) => false,
            (Some(_), Some(position)) => {
                return self.report(errors::wrong_setting(
                    position.span,
                    format!("the light `{}` has a direction and a position", name.text),
                    "keep `direction` for a sun, `position` for a lamp",
                ));
            }
            (None, None) if block.has_unknown => return Err(Reported),
            (None, None) => {
                return self.report(errors::wrong_setting(
                    name.span,
                    format!("the light `{}` is nowhere", name.text),
                    "give it a `direction` (towards the light) or a `position`",
                ));
            }
        };
        let place = if directional { "direction" } else { "position" };
        let at = self.number_setting(&block, place, Constant::Vec3([0.0; 3]));
        let color = self.number_setting(&block, "color", Constant::Vec3([1.0; 3]));
        let intensity = self.number_setting(&block, "intensity", Constant::Float(1.0));
        let shadow = self.shadow(&block);
        let (mut at, color, intensity, shadow) = (at?, color?, intensity?, shadow?);
        if directional {
            if at.known() == Some(Constant::Vec3([0.0; 3])) {
                let span = block.fields["direction"].span;
                return self.report(errors::wrong_setting(
                    span,
                    "this direction has no length",
                    "point it towards the light",
                ));
            }
            at = self.unary(Unary::Normalize, &at, name.span)?.named(&Arc::from("direction"));
        }
        let power = self.binary(Binary::Multiply, &color, &intensity, name.span)?;
        if !self.may_be_nonzero(&power) {
            return Ok(None);
        }
        let light_name = Arc::from(format!("{}_color", name.text));
        Ok(Some(light_record(directional, at, Number { name: Some(light_name), ..power }, shadow)))
    }

    /// `none`, `hard` or `soft(k)`.
    fn shadow(&mut self, block: &Block<'t>) -> Eval<Shadow> {
        let Some(expr) = block.fields.get("shadow") else { return Ok(Shadow::None) };
        let expr: &'t Expr = expr;
        match &expr.kind {
            ExprKind::Name(word) if &**word == "none" => return Ok(Shadow::None),
            ExprKind::Name(word) if &**word == "hard" => return Ok(Shadow::Hard),
            ExprKind::Postfix { base, operations } => {
                if let (ExprKind::Name(word), [only]) = (&base.kind, &operations[..])
                    && &**word == "soft"
                    && let PostfixKind::Call(arguments) = &only.kind
                    && let [argument] = &arguments[..]
                {
                    let value = self.eval(&argument.value, &Env::new(Module::ROOT))?;
                    let k = self.as_typed(value, Type::Float, argument.value.span)?;
                    self.check_range(&k, argument.value.span, "the softness of a shadow", SOFTNESS)?;
                    return Ok(Shadow::Soft(k));
                }
            }
            _ => {}
        }
        let word = match &expr.kind {
            ExprKind::Postfix { base, .. } => &base.kind,
            kind => kind,
        };
        let similar = match word {
            ExprKind::Name(word) => sdf_syntax::did_you_mean(word, ["none", "hard", "soft"]),
            _ => None,
        };
        let similar = similar.map(|word| if word == "soft" { "soft(8)" } else { word });
        let words = ["`none`", "`hard`", "`soft(k)`, for example `soft(8)`"];
        self.report(errors::wrong_word(expr.span, "shadow", similar, &words))
    }

    fn ambient(&mut self, calls: Option<&Calls>) -> Eval<Value<'t>> {
        let block = self.settings_block(SettingsKind::Ambient, "ambient", AMBIENT);
        let color = self.number_setting(&block, "color", Constant::Vec3([0.1; 3]));
        let occlusion = self.ranged_setting(&block, "occlusion", Constant::Float(0.0), NOT_NEGATIVE);
        let radius = self.ranged_setting(&block, "radius", Constant::Float(0.5), POSITIVE);
        let (color, mut occlusion, radius) = (color?, occlusion?, radius?);
        if calls.is_some() && !block.fields.contains_key("occlusion") {
            // Who asks for it wants all of it.
            occlusion = Number::float(1.0);
        }
        let is_asked = calls.map_or_else(|| self.may_be_nonzero(&color), |calls| calls.occlusion);
        let called = is_asked && self.may_be_nonzero(&occlusion);
        Ok(Value::record(vec![
            (Arc::from("color"), Value::Number(renamed(color, "ambient_color"))),
            (Arc::from("occluded"), Value::bool(called)),
            (Arc::from("occlusion"), Value::Number(occlusion)),
            (Arc::from("radius"), Value::Number(radius)),
        ]))
    }

    /// The sky as a function of the ray's direction.
    fn sky(&mut self) -> Eval<Value<'t>> {
        let block = self.settings_block(SettingsKind::Sky, "sky", SKY);
        self.check_sky(&block)?;
        let get = |name: &str| block.fields.get(name).copied();
        match (get("color"), get("horizon"), get("zenith")) {
            (Some(color), None, None) => Ok(sky_function(color, None)),
            (None, Some(horizon), Some(zenith)) => Ok(sky_function(horizon, Some(zenith))),
            (None, None, None) => {
                let default = Constant::Vec3(crate::parse_color("#a8c4e0").expect("a colour"));
                Ok(Value::Function(Rc::new(Callable::Native(Rc::new(move |_, _, _| {
                    Ok(Value::Number(Number::constant(default)))
                })))))
            }
            (Some(_), Some(extra), _) | (Some(_), _, Some(extra)) => self.report(errors::wrong_setting(
                extra.span,
                "the sky has a color and a gradient",
                "give it `color`, or `horizon` and `zenith`",
            )),
            (None, Some(_), None) | (None, None, Some(_)) if block.has_unknown => Err(Reported),
            (None, Some(one), None) | (None, None, Some(one)) => self.report(errors::wrong_setting(
                one.span,
                "a gradient of the sky needs two colours",
                "give it both `horizon` and `zenith`",
            )),
        }
    }

    /// Finds what is wrong in the sky's colours, whether a ray ever meets them or not.
    fn check_sky(&mut self, block: &Block<'t>) -> Eval<()> {
        self.contexts.open(&Arc::from("sky"), None);
        let direction = self.contexts.entry_parameter("p", Type::Vec3);
        let env = Env::new(Module::ROOT).bind(Arc::from("p"), Value::Number(direction));
        let mut done = Ok(());
        for name in SKY {
            let Some(expr) = block.fields.get(name) else { continue };
            let color = self.eval(expr, &env).and_then(|v| self.as_typed(v, Type::Vec3, expr.span));
            done = color.map(|_| ()).and(done);
        }
        self.contexts.discard();
        done
    }

    /// Fog, of a colour of its own or of the sky's.
    fn fog(&mut self) -> Eval<Value<'t>> {
        let block = self.settings_block(SettingsKind::Fog, "fog", FOG);
        let color = self.number_setting(&block, "color", Constant::Vec3([0.0; 3]));
        let density = self.ranged_setting(&block, "density", Constant::Float(0.0), NOT_NEGATIVE);
        let (color, density) = (color?, density?);
        let called = self.may_be_nonzero(&density);
        let colored = called && block.fields.contains_key("color");
        Ok(Value::record(vec![
            (Arc::from("called"), Value::bool(called)),
            (Arc::from("colored"), Value::bool(colored)),
            (Arc::from("color"), Value::Number(renamed(color, "fog_color"))),
            (Arc::from("density"), Value::Number(renamed(density, "fog_density"))),
        ]))
    }

    fn rim(&mut self) -> Eval<Value<'t>> {
        let block = self.settings_block(SettingsKind::Rim, "rim", RIM);
        let color = self.number_setting(&block, "color", Constant::Vec3([0.0; 3]));
        let power = self.ranged_setting(&block, "power", Constant::Float(3.0), POSITIVE);
        let (color, power) = (color?, power?);
        let called = self.may_be_nonzero(&color);
        Ok(Value::record(vec![
            (Arc::from("called"), Value::bool(called)),
            (Arc::from("color"), Value::Number(renamed(color, "rim_color"))),
            (Arc::from("power"), Value::Number(renamed(power, "rim_power"))),
        ]))
    }
}

/// How far a camera can be tilted until it stands above or below its target, as `runtime/camera.sdf` does it; all
/// round where it is not known where it stands.
fn tilt_range([eye, target, up]: [&Number; 3]) -> (f64, f64) {
    let vector = |n: &Number| match n.known() {
        Some(Constant::Vec3(v)) => Some(DVec3::from_array(v)),
        _ => None,
    };
    let (Some(eye), Some(target), Some(up)) = (vector(eye), vector(target), vector(up)) else {
        return (-PI, PI);
    };
    let height = (eye - target).normalize_or_zero().dot(up.normalize_or_zero()).clamp(-1.0, 1.0).asin();
    let steepest = 89f64.to_radians();
    ((-steepest - height).min(0.0), (steepest - height).max(0.0))
}

/// The same number by the name that the text is to have for it, which several blocks would else share.
fn renamed(number: Number, name: &str) -> Number {
    Number { name: Some(Arc::from(name)), ..number }
}

fn fields<'t, const N: usize>(numbers: [(&str, Number); N]) -> Value<'t> {
    Value::record(numbers.into_iter().map(|(n, v)| (Arc::from(n), Value::Number(v))).collect())
}

fn light_record<'t>(directional: bool, at: Number, color: Number, shadow: Shadow) -> Value<'t> {
    let (casts, soft, softness) = match shadow {
        Shadow::None => (false, false, Number::float(1.0)),
        Shadow::Hard => (true, false, Number::float(1.0)),
        Shadow::Soft(k) => (true, true, k),
    };
    Value::record(vec![
        (Arc::from("directional"), Value::bool(directional)),
        (Arc::from("at"), Value::Number(at)),
        (Arc::from("color"), Value::Number(color)),
        (Arc::from("casts"), Value::bool(casts)),
        // What is proved of it later, and what is left of its shadow then.
        (Arc::from("unshadowed"), Value::bool(false)),
        (Arc::from("cut"), Value::bool(false)),
        (Arc::from("soft"), Value::bool(soft)),
        (Arc::from("softness"), Value::Number(softness.named(&Arc::from("softness")))),
    ])
}

/// The lights, of which those cast no shadow that the scene's own shading does not ask for.
fn without_shadows<'t>(lights: Value<'t>, calls: Option<&Calls>) -> Value<'t> {
    let (Value::List(list), Some(calls)) = (&lights, calls) else { return lights };
    let asked = |(index, light): (usize, &Value<'t>)| match light {
        Value::Record(light) if !calls.shadows.contains(&index) => {
            let fields = light.fields.iter().map(|(name, value)| match &**name {
                "casts" => (name.clone(), Value::bool(false)),
                _ => (name.clone(), value.clone()),
            });
            Value::record(fields.collect())
        }
        light => light.clone(),
    };
    Value::list(list.items.iter().enumerate().map(asked).collect())
}

/// `mix(horizon, zenith, max(p.y, 0))`, or one colour; `p` is the direction.
fn sky_function<'t>(low: &'t Expr, high: Option<&'t Expr>) -> Value<'t> {
    Value::Function(Rc::new(Callable::Native(Rc::new(move |e: &mut Elaborator<'t>, given, span| {
        let direction = match given.positional.into_iter().next() {
            Some(Value::Number(n)) => n,
            _ => unreachable!("the renderer asks with a direction"),
        };
        let env = Env::new(Module::ROOT).bind(Arc::from("p"), Value::Number(direction.clone()));
        let low_value = e.eval(low, &env)?;
        let low_color = e.as_typed(low_value, Type::Vec3, low.span)?;
        let Some(high) = high else { return Ok(Value::Number(low_color)) };
        let high_value = e.eval(high, &env)?;
        let high_color = e.as_typed(high_value, Type::Vec3, high.span)?;
        let up = e.component(&direction, 1);
        let up = e.binary(Binary::Max, &up, &Number::float(0.0), span)?;
        let mixed = e.contexts.apply(Op::Ternary(Ternary::Mix), &[low_color, high_color, up]);
        e.finite(mixed, span).map(Value::Number)
    }))))
}
