//! A file as a scene: its shapes, its settings, and the renderer round them.

use crate::accuracy::{Accuracy, Correction};
use crate::effects::{self, Called, Effect};
use crate::errors;
use crate::eval::{Elaborator, Eval, Reported, name_shape};
use crate::expansion::{OPERATION_LIMIT, Size};
use crate::import;
use crate::library::Library;
use crate::names::Names;
use crate::solids;
use crate::surface::Column;
use crate::value::{Env, Module, Number, Shape, ShapeKind, Thunk, Value, mentions};
use crate::view::View;
use crate::{Certificate, Fact, Options, Query, Scene, Summary};
use sdf_ir::cost::operations;
use sdf_ir::{Constant, FunctionId, Program, Role, Type};
use sdf_syntax::tree::{Dimension, File, Record, SettingsKind};
use sdf_syntax::{Code, Diagnostic, Severity, Sources, Span};
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;

/// Elaborates a file: the scene, if there is no error, what is to be said, and how many expressions were evaluated.
pub(crate) fn elaborate(
    sources: &Sources,
    tree: &File,
    files: &import::Files,
    library: &'static Library,
    options: &Options,
) -> (Option<Scene>, Vec<Diagnostic>, usize) {
    let mut diagnostics = Vec::new();
    let names = Names::new(tree, files, library, &mut diagnostics);
    names.check(sources, &mut diagnostics);
    let mut elaborator = Elaborator::new(sources, &names, diagnostics);
    elaborator.overrides = options.set.iter().cloned().collect();
    let scene = elaborator.scene(options);
    let Elaborator { contexts, mut diagnostics, work, .. } = elaborator;
    let scene =
        scene.ok().filter(|_| !diagnostics.iter().any(|d| d.severity() == Severity::Error)).map(|made| {
            let mut program = contexts.into_program();
            (program.entry, program.is_tiny) = (Some(made.pixel), made.is_tiny);
            let asked = made.query.map_or(Vec::new(), |q| vec![q.distance, q.gradient, q.material]);
            let certified = made.certificate.map_or(Vec::new(), |c| vec![c.ray, c.step]);
            let roots: Vec<_> = made
                .map
                .into_iter()
                .chain(made.probe)
                .chain(made.truth)
                .chain(asked)
                .chain(certified)
                .collect();
            let (program, kept) = sdf_ir::simplify(&program, &roots);
            debug_assert_eq!(sdf_ir::verify(&program), Ok(()));
            let mut kept = kept.into_iter();
            let mut next = || kept.next().unwrap_or_else(|| unreachable!("a root is kept"));
            let map = made.map.map(|_| next());
            let probe = made.probe.map(|_| next());
            let truth = made.truth.map(|_| next());
            let query = made.query.map(|_| Query { distance: next(), gradient: next(), material: next() });
            let certificate = made.certificate.map(|_| Certificate { ray: next(), step: next() });
            let Made { origin, accuracy, slope, facts, mut summary, mut effects, .. } = made;
            summary.settings.extend(further_settings(&accuracy, &program, map.is_some()));
            effects::settle_inputs(&mut effects, &program);
            Scene {
                origin,
                map,
                probe,
                truth,
                query,
                certificate,
                program,
                accuracy,
                slope,
                facts,
                effects,
                summary,
            }
        });
    let scene = scene.filter(|scene| {
        let fits = scene.map.is_none_or(|map| operations(&scene.program, map) <= OPERATION_LIMIT);
        if !fits {
            diagnostics.push(too_many_operations(&names));
        }
        fits
    });
    if diagnostics.iter().any(|d| d.code == Code::E045) {
        // How steep a field is that is too large to be looked at is not the question.
        diagnostics.retain(|d| d.code != Code::E052);
    }
    (scene, diagnostics, work)
}

/// The settings that the header lists where they are in the program and not as they are in a scene that says nothing: beside
/// those that it always lists.
fn further_settings(accuracy: &Accuracy, program: &Program, is_something: bool) -> Vec<String> {
    let is_in = |name: &str| match name {
        "normals" | "relax" => is_something,
        _ => program.uniforms.iter().any(|u| u.role == Role::Setting && &*u.name == name),
    };
    let always = ["tolerance", "steps", "far"];
    let changed = accuracy.fields_beside(&Accuracy::default()).into_iter();
    changed
        .filter(|(name, _)| !always.contains(name) && is_in(name))
        .map(|(name, value)| format!("{name} {value}"))
        .collect()
}

/// What is said of a scene of which no part alone is too large. Only its first word is marked.
fn too_many_operations(names: &Names) -> Diagnostic {
    let place = names.user.scenes.first().map_or(Span::default(), |(_, span)| *span);
    errors::too_large(first_word(place), "operations at each point", OPERATION_LIMIT as usize)
}

/// The word `scene` of a scene block at a place: the block may fill the screen.
fn first_word(scene: Span) -> Span {
    Span { end: scene.end.min(scene.start + "scene".len() as u32), ..scene }
}

/// At how many points a promise is tried whenever a file is compiled.
const ATTACK: usize = 400;

/// What a function of a pixel takes, and one of a point.
const COORDINATE: (&str, Type) = ("coordinate", Type::Vec2);
const POINT: (&str, Type) = ("p", Type::Vec3);

/// The functions of a scene, in the program that is being made.
struct Made {
    origin: [f64; 3],
    map: Option<FunctionId>,
    pixel: FunctionId,
    probe: Option<FunctionId>,
    truth: Option<FunctionId>,
    accuracy: Accuracy,
    slope: f64,
    facts: Vec<Fact>,
    effects: Vec<Effect>,
    query: Option<Query>,
    certificate: Option<Certificate>,
    summary: Summary,
    is_tiny: bool,
}

/// A scene for the renderer.
struct Rendered<'t> {
    /// The record that it takes.
    scene: Value<'t>,
    /// The scene as a shape.
    map: Value<'t>,
    /// Whether all that is marched to is tiny.
    is_tiny: bool,
    /// All effects, those that are left out too.
    effects: Vec<Effect>,
    /// How steep what is marched to is, in its box.
    slope: f64,
}

impl<'t> Elaborator<'t> {
    fn scene(&mut self, options: &Options) -> Eval<Made> {
        self.check_overrides(options);
        self.allow_finding();
        self.evaluate_all_items();
        let shapes = self.scene_shapes().and_then(|shapes| self.allow_writing_out(shapes));
        let Ok(shapes) = shapes else {
            // The settings are still checked, so that all mistakes are reported in one run.
            self.scene_parts = Vec::new();
            let _: Eval<_> = self.settings(options);
            return Err(Reported);
        };
        self.scene_parts = shapes.clone();
        let settings = self.settings(options)?;
        let place = self.names.user.scenes.first().map_or(Span::default(), |(_, span)| *span);
        let union = solids::union_of(shapes.clone(), place);
        match options.attack.unwrap_or(ATTACK) {
            0 => {}
            points => self.attack(&union, points)?,
        }
        let facts = if options.facts { self.facts_of(&union)? } else { Vec::new() };
        self.warn_beyond_far(&shapes, &settings, first_word(place))?;
        let settings = self.without_idle_shadows(&union, settings)?;
        let count = shapes.len();
        let origin = self.find_origin(&settings, self.accuracy.coordinates);
        let query = match origin {
            Some(_) if options.query => {
                let unseen = Options { view: None, ..options.clone() };
                let rendered = self.renderer(&shapes, settings.clone(), &unseen, place)?;
                Some(self.query(&rendered.scene)?)
            }
            _ => None,
        };
        self.origin = origin;
        let (shapes, settings) = match origin {
            Some(origin) => (self.shapes_from(origin, &shapes)?, self.settings_from(origin, settings)?),
            None => (shapes, settings),
        };
        let Rendered { scene, map, is_tiny, effects, slope } =
            self.renderer(&shapes, settings, options, place)?;
        let summary = self.summary(&scene, count, effects::listed(&effects, &options.left_out));
        let pixel = self.entry(options.view.map_or("pixel", View::entry), COORDINATE, &scene)?;
        let probe = if options.probe { Some(self.entry("probe", COORDINATE, &scene)?) } else { None };
        let truth = if options.truth { Some(self.entry("truth", COORDINATE, &scene)?) } else { None };
        let query = match query {
            None if options.query => Some(self.query(&scene)?),
            query => query,
        };
        let certificate = if options.certificate { Some(self.certificate(&scene)?) } else { None };
        let Value::Shape(map) = map else { unreachable!("a shape was named") };
        let map_id = match &map.kind {
            ShapeKind::Named { inner, .. } => {
                self.shape_functions.get(&Rc::as_ptr(inner).cast::<()>()).copied()
            }
            _ => None,
        };
        let origin = self.origin.unwrap_or_default().to_array();
        let accuracy = self.accuracy;
        Ok(Made {
            origin,
            map: map_id,
            pixel,
            probe,
            truth,
            accuracy,
            slope,
            query,
            certificate,
            facts,
            effects,
            summary,
            is_tiny,
        })
    }

    /// The record that the renderer takes.
    fn renderer(
        &mut self,
        shapes: &[Rc<Shape<'t>>],
        settings: Vec<(Arc<str>, Value<'t>)>,
        options: &Options,
        place: Span,
    ) -> Eval<Rendered<'t>> {
        self.unseen_columns.clear();
        let mut solids = self.solids(shapes, place)?;
        let (map, is_tiny) = (solids.map.clone(), solids.are_tiny());
        let slope = match solids.rest().cloned() {
            Some(rest) => self.slope_of(&rest)?.within.max(1.0),
            None => 1.0,
        };
        let (glows, columns) = self.glows(shapes)?;
        let render = settings.iter().find(|(name, _)| &**name == "render");
        let smooths = render.is_some_and(|(_, render)| is_antialiased(render));
        let called = |column| self.bounces && columns.contains(&column);
        let is_shaded = self.own_shading().is_some();
        let camera = settings.iter().find(|(name, _)| &**name == "camera").map(|(_, camera)| camera);
        let is_wide = matches!(camera, Some(Value::Record(camera)) if camera.get("parallel").is_some_and(Value::is_true));
        let (reflects, transmits) = (called(Column::Reflect) && !is_shaded, called(Column::Transmit));
        let resolution = self.input("resolution", Type::Vec2, Role::Resolution);
        let mut fields = settings;
        fields.push((Arc::from("map"), map.clone()));
        fields.push((Arc::from("empty"), Value::bool(self.is_empty(&map)?)));
        fields.push((Arc::from("glows"), glows));
        let patterned = columns.contains(&Column::Pattern);
        for (name, holds) in [
            ("reflects", reflects),
            ("transmits", transmits),
            ("goes_on", reflects || transmits),
            ("patterned", smooths && patterned),
            ("sky_is_patterned", smooths && self.sky_is_patterned()),
        ] {
            fields.push((Arc::from(name), Value::bool(holds)));
        }
        fields.push((Arc::from("resolution"), Value::Number(resolution)));
        let mut called = Called { fields: &mut fields, solids: &mut solids };
        let effects = self.effects(&called, options.view.is_none_or(View::is_lit))?;
        self.leave_out(&effects, &options.left_out, &mut called);
        if self.accuracy.correction != Correction::Derived {
            called.take_whole_steps();
        }
        let transmits = called.flag("transmits");
        let widens = is_wide || called.flag("goes_on") || called.flag("mirrors_by_call");
        fields.push((Arc::from("widens"), Value::bool(widens)));
        fields.extend(self.clear_fields(shapes, &solids, transmits, place)?);
        let solids = self.solid_fields(&solids, &fields)?;
        fields.extend(solids);
        if options.view == Some(View::Depth) {
            fields.push((Arc::from("ball"), self.ball_record()));
        }
        Ok(Rendered { scene: Value::record(fields), map, is_tiny, effects, slope })
    }

    /// Whether the sky's colours are more than a gradient.
    fn sky_is_patterned(&self) -> bool {
        let is_sky = |(kind, ..): &&(SettingsKind, &Record, Span)| *kind == SettingsKind::Sky;
        let sky = self.names.user.settings.iter().find(is_sky);
        sky.is_some_and(|(_, sky, _)| sky.fields.iter().any(|field| mentions(&field.value, "p")))
    }

    /// Whether the distance to a shape is the same everywhere, so that it has no surface.
    fn is_empty(&mut self, shape: &Value<'t>) -> Eval<bool> {
        let Value::Shape(shape) = shape else { unreachable!("a scene is a shape") };
        self.contexts.open(&Arc::from("empty"), None);
        let point = self.contexts.entry_parameter("p", Type::Vec3);
        let distance = self.sample(shape, &point, Span::default());
        self.contexts.discard();
        Ok(!distance?.is_local())
    }

    fn query(&mut self, scene: &Value<'t>) -> Eval<Query> {
        Ok(Query {
            distance: self.entry("query_distance", POINT, scene)?,
            gradient: self.entry("query_gradient", POINT, scene)?,
            material: self.entry("query_material", POINT, scene)?,
        })
    }

    fn certificate(&mut self, scene: &Value<'t>) -> Eval<Certificate> {
        Ok(Certificate {
            ray: self.entry("certificate_ray", COORDINATE, scene)?,
            step: self.entry("certificate_step", POINT, scene)?,
        })
    }

    /// A function of one parameter: the renderer's of this name, with the scene filled in.
    fn entry(&mut self, name: &str, (parameter, ty): (&str, Type), scene: &Value<'t>) -> Eval<FunctionId> {
        self.contexts.open(&Arc::from(name), None);
        let argument = self.contexts.entry_parameter(parameter, ty);
        let arguments =
            [(Arc::from("scene"), scene.clone()), (Arc::from(parameter), Value::Number(argument))];
        let results =
            self.call_runtime(name, &arguments).and_then(|value| self.flatten(&value, Span::default()));
        let Ok((_, results)) = results else {
            self.contexts.discard();
            return Err(Reported);
        };
        let results = results
            .into_iter()
            .map(|n| (self.contexts.value(&n), n.name.unwrap_or_else(|| Arc::from("color"))))
            .collect();
        Ok(self.contexts.finish(results).0)
    }

    /// What the renderer's function of this name gives for these arguments.
    pub fn call_runtime(&mut self, name: &str, arguments: &[(Arc<str>, Value<'t>)]) -> Eval<Value<'t>> {
        let function = self.names.library.runtime.functions(name).next();
        let function = function.unwrap_or_else(|| unreachable!("the renderer has a function `{name}`"));
        self.evaluate_body(function, Module::Runtime, arguments)
    }

    /// The shapes of the scene block; mistakes in one do not hide those in another.
    fn scene_shapes(&mut self) -> Eval<Vec<Rc<Shape<'t>>>> {
        let scenes = &self.names.user.scenes;
        let Some((scene, place)) = scenes.first() else {
            return self.report(errors::no_scene(Span::default()));
        };
        if let Some((_, again)) = scenes.get(1) {
            self.diagnostics.push(errors::block_twice(*again, "scene", *place));
        }
        let (env, unbound) =
            self.bind_all(&scene.bindings, &Env::new(Module::ROOT), |_, binding, value| match value {
                Value::Number(n) => Value::Number(n.named(&binding.name.text)),
                v => name_shape(v, &binding.name.text, binding.name.span, Thunk::Let(binding)),
            });
        let mut failed = !unbound.is_empty();
        let mut shapes = Vec::new();
        for expr in &scene.shapes {
            let value = self.eval_unless_hopeless(expr, &env, &unbound, Self::eval_ahead);
            let found = value.and_then(|v| {
                self.check_size(&v, expr.span)?;
                self.scene_shape(v, expr.span)
            });
            match found {
                Ok(found) => shapes.extend(found),
                Err(Reported) => failed = true,
            }
        }
        if failed { Err(Reported) } else { Ok(shapes) }
    }

    /// One entry of the scene block: a shape, or a list of shapes.
    fn scene_shape(&mut self, value: Value<'t>, span: Span) -> Eval<Vec<Rc<Shape<'t>>>> {
        self.count(span)?;
        match value {
            Value::List(list) => list
                .items
                .iter()
                .map(|v| self.scene_shape(v.clone(), span))
                .collect::<Eval<Vec<_>>>()
                .map(|v| v.concat()),
            Value::Shape(s) if s.dimension == Dimension::Two => self.report(
                errors::wrong_type(span, "a shape", "a 2D shape")
                    .help("make it solid with `.extrude(h)` or `.revolve()`"),
            ),
            other => self.as_shape(other, span).map(|s| vec![s]),
        }
    }

    /// Makes sure that the shapes of a scene are not too many to be written out, and allows the work that it takes.
    fn allow_writing_out(&mut self, shapes: Vec<Rc<Shape<'t>>>) -> Eval<Vec<Rc<Shape<'t>>>> {
        let size = shapes.iter().fold(Size::default(), |sum, s| sum + self.sizes.of(s));
        if size.operations > OPERATION_LIMIT {
            return self.report(too_many_operations(self.names));
        }
        self.allow_writing(size.expressions);
        Ok(shapes)
    }

    /// The shapes that glow, each with what is known of where: whether it is a `flat` half space with the same glow
    /// everywhere, and, if it is `bounded`, the box from `lo` to `hi` in which it may shine; and what the materials of all
    /// shapes call for.
    fn glows(&mut self, shapes: &[Rc<Shape<'t>>]) -> Eval<(Value<'t>, BTreeSet<Column>)> {
        let (mut out, mut all) = (Vec::new(), BTreeSet::new());
        self.parts_called.clear();
        for shape in shapes.iter().flat_map(parts_of_union) {
            let columns = self.columns_of(&shape)?;
            all.extend(&columns);
            if shape.painted {
                self.note_part(&shape);
            }
            if columns.contains(&Column::Glow) {
                let reach = self.reach_of_glow(&shape)?;
                out.push(self.glow_record(shape, reach)?);
            }
        }
        Ok((Value::list(out), all))
    }

    /// How far a shape's glow reaches at most, if that has a bound, and whether it is the same everywhere.
    fn reach_of_glow(&mut self, shape: &Rc<Shape<'t>>) -> Eval<Option<(f64, bool)>> {
        self.contexts.open(&Arc::from("glow"), None);
        let point = self.contexts.entry_parameter("p", Type::Vec3);
        let reach = self.reach_of_glow_at(shape, &point);
        self.contexts.discard();
        reach
    }

    fn reach_of_glow_at(&mut self, shape: &Rc<Shape<'t>>, point: &Number) -> Eval<Option<(f64, bool)>> {
        let Value::Record(glow) = self.surface(&Column::OF_GLOW, shape, point, point, Span::default())?
        else {
            unreachable!("properties are a record")
        };
        let [light, radius] = Column::OF_GLOW.map(|column| match glow.get(column.name()) {
            Some(Value::Number(number)) => number.clone(),
            _ => unreachable!("it was asked for"),
        });
        let is_even = !light.is_local() && !radius.is_local();
        let reach = self.bounds_of_number(&radius).number().hi;
        Ok(reach.is_finite().then_some((reach, is_even)))
    }

    fn glow_record(&mut self, shape: Rc<Shape<'t>>, reach: Option<(f64, bool)>) -> Eval<Value<'t>> {
        let is_flat = matches!(reach, Some((_, true))) && self.is_half_space(&shape)?;
        let corners = match reach {
            Some((reach, _)) => solids::corners(&self.extent_of(&shape, reach)?),
            None => None,
        };
        let is_bounded = corners.is_some();
        let [lo, hi] = corners.unwrap_or_else(|| [Number::float(0.0), Number::float(0.0)]);
        Ok(Value::record(vec![
            (Arc::from("shape"), Value::Shape(shape)),
            (Arc::from("flat"), Value::bool(is_flat)),
            (Arc::from("bounded"), Value::bool(is_bounded)),
            (Arc::from("lo"), Value::Number(lo)),
            (Arc::from("hi"), Value::Number(hi)),
        ]))
    }

    /// A ball round the bounded parts of the scene: centre and radius.
    pub fn scene_ball(&mut self) -> (glam::DVec3, f64) {
        let parts: Vec<_> = self.scene_parts.iter().flat_map(parts_of_union).collect();
        crate::framing::ball(self, &parts)
    }

    /// [`Elaborator::scene_ball`] as the record that the renderer takes.
    fn ball_record(&mut self) -> Value<'t> {
        let (center, radius) = self.scene_ball();
        let center = center - self.origin.unwrap_or_default();
        Value::record(vec![
            (Arc::from("center"), Value::Number(Number::constant(Constant::Vec3(center.to_array())))),
            (Arc::from("radius"), Value::float(radius)),
        ])
    }

    /// Every `--set` must name a param of the file.
    fn check_overrides(&mut self, options: &Options) {
        for (name, _) in &options.set {
            let params = self.names.names_to_set();
            let params: Vec<&str> = params.iter().map(|name| &**name).collect();
            if params.contains(&name.as_str()) {
                continue;
            }
            let help = match sdf_syntax::did_you_mean(name, params.iter().copied()) {
                Some(s) => format!("did you mean `{s}`?"),
                None if params.is_empty() => "this file has no params".to_string(),
                None => format!("its params are {}", params.join(", ")),
            };
            let message = format!("there is no param `{name}` to set");
            self.diagnostics.push(errors::bad_override(Span::default(), message, help));
        }
    }

    /// What is compiled in, with these effects.
    fn summary(&self, scene: &Value<'t>, shapes: usize, effects: Vec<&'static str>) -> Summary {
        let Value::Record(scene) = scene else { unreachable!("a scene is a record") };
        let setting = |name| match scene.get("render") {
            Some(Value::Record(r)) => match r.get(name) {
                Some(Value::Number(n)) => self.contexts.setting(n),
                _ => None,
            },
            _ => None,
        };
        let mut settings: Vec<String> =
            self.quality.iter().map(|quality| format!("quality {}", quality.word())).collect();
        for name in ["tolerance", "steps", "far"] {
            if let Some(Constant::Float(x)) = setting(name) {
                settings.push(format!("{name} {x}"));
            }
        }
        Summary { shapes, settings, effects }
    }
}

/// Whether pixels may take several rays.
pub(crate) fn is_antialiased(render: &Value<'_>) -> bool {
    let Value::Record(render) = render else { return false };
    matches!(render.get("antialias"), Some(Value::Number(n)) if n.known() != Some(Constant::Float(1.0)))
}

/// The shapes that a union is made of, also where the union has a name; a shape that is none is its only part.
/// Names inside names are left alone: each may be a union of others, and there would be no end of parts.
pub(crate) fn parts_of_union<'t>(shape: &Rc<Shape<'t>>) -> Vec<Rc<Shape<'t>>> {
    match &shape.kind {
        ShapeKind::Named { inner, .. } => match &parts_of_unnamed(inner)[..] {
            [_] => vec![shape.clone()],
            parts => parts.to_vec(),
        },
        _ => parts_of_unnamed(shape),
    }
}

fn parts_of_unnamed<'t>(shape: &Rc<Shape<'t>>) -> Vec<Rc<Shape<'t>>> {
    let mut parts = Vec::new();
    add_parts(shape, &mut parts);
    parts
}

/// One list takes them all: in a chain of unions each would else be copied once for each union round it.
fn add_parts<'t>(shape: &Rc<Shape<'t>>, parts: &mut Vec<Rc<Shape<'t>>>) {
    match &shape.kind {
        ShapeKind::Union { shapes } => shapes.iter().for_each(|s| add_parts(s, parts)),
        ShapeKind::Field { env, origin: Some(origin), .. }
            if origin.module == Module::Library && &*origin.function.name.text == "union" =>
        {
            match env.get("shapes") {
                Some(Value::List(list)) => {
                    for item in &list.items {
                        if let Value::Shape(s) = item {
                            add_parts(s, parts);
                        }
                    }
                }
                _ => parts.push(shape.clone()),
            }
        }
        _ => parts.push(shape.clone()),
    }
}
