//! A scene's own shading: a `fn shade(surface)` of the root file stands in for the renderer's model of surface light.
//!
//! It is told of the surface and the lights by a record, which `runtime/shade.sdf` makes, and may call `shadow(light)`,
//! `occlusion()` and `reflection()`. Those that it calls are called for, and no others: it is tried once before the renderer is
//! made.

use crate::context::Op;
use crate::errors;
use crate::eval::{Elaborator, Eval};
use crate::names::Meaning;
use crate::scene::parts_of_union;
use crate::surface::Column;
use crate::value::{Callable, Module, Number, Value};
use sdf_ir::{Binary, Constant, Type};
use sdf_syntax::tree::Function;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;

/// The name of the function.
pub(crate) const SHADE: &str = "shade";
/// What it may call besides all others: the light that arrives from a lamp, from around, and from a mirror.
pub(crate) const CALLS: [&str; 3] = ["shadow", "occlusion", "reflection"];

/// What the scene's own shading calls.
#[derive(Debug, Default, Clone)]
pub(crate) struct Calls {
    /// The places in the renderer's list of the lights whose shadows it asks for.
    pub shadows: BTreeSet<usize>,
    pub occlusion: bool,
    pub reflection: bool,
}

/// Whether a function of the root file is the scene's own shading.
pub(crate) fn is_shading(function: &Function, module: Module) -> bool {
    module == Module::ROOT && &*function.name.text == SHADE && function.parameters.len() == 1
}

impl<'t> Elaborator<'t> {
    /// The scene's own shading, if it has one.
    pub fn own_shading(&self) -> Option<&'t Function> {
        self.names.user.all_functions.iter().copied().find(|function| is_shading(function, Module::ROOT))
    }

    /// What the scene's own shading calls for, found by trying it: nothing if there is none.
    pub fn calls_of_shading(&mut self) -> Eval<Option<Calls>> {
        let Some(function) = self.own_shading() else { return Ok(None) };
        let calls = Rc::new(RefCell::new(Calls::default()));
        self.contexts.open(&Arc::from(SHADE), None);
        let result = self.try_shading(function, &calls);
        self.contexts.discard();
        result?;
        let mut calls = calls.borrow().clone();
        // Without bounces a mirror shows the sky alone.
        calls.reflection &= self.bounces;
        Ok(Some(calls))
    }

    /// Calls the shading with numbers of which nothing is known, but for what all materials of the scene leave as it is.
    fn try_shading(&mut self, function: &'t Function, calls: &Rc<RefCell<Calls>>) -> Eval<Number> {
        let mut columns = BTreeSet::new();
        for part in self.scene_parts.clone().iter().flat_map(parts_of_union) {
            columns.extend(self.columns_of(&part)?);
        }
        let left = Column::ALL.into_iter().filter(|column| !columns.contains(column));
        let left: Vec<(&str, Constant)> = left.map(|column| (column.name(), column.default())).collect();
        let mut local = |name: &str, ty| Value::Number(self.contexts.entry_parameter(name, ty));
        let surface = SURFACE.map(|(name, ty)| {
            let known = left.iter().find(|(other, _)| *other == name);
            let value =
                known.map_or_else(|| local(name, ty), |(_, value)| Value::Number(Number::constant(*value)));
            (Arc::from(name), value)
        });
        let (visibility, color) = (local("visibility", Type::Float), local("seen", Type::Vec3));
        let direction = local("direction", Type::Vec3);
        let lights = self.light_names.iter().enumerate().filter(|(_, (_, shines))| *shines);
        let count = lights.count();
        let lights = (0..count).map(|i| light(direction.clone(), direction.clone(), i as f64));
        let lights = Value::list(lights.collect());
        let mut surface = surface.to_vec();
        surface.push((Arc::from("lights"), lights.clone()));
        let noted = calls.clone();
        let answer = visibility.clone();
        let known: Vec<f64> = (-1..count as i32).map(f64::from).collect();
        let shadow =
            native("shadow(light)", "`light` is one of the scene's lights", move |given| match given {
                [light] => index_of(light).filter(|index| known.contains(index)).map(|index| {
                    // One that never shines has none.
                    if index >= 0.0 {
                        noted.borrow_mut().shadows.insert(index as usize);
                    }
                    answer.clone()
                }),
                _ => None,
            });
        let noted = calls.clone();
        let occlusion = native("occlusion()", "it takes no arguments", move |given| {
            noted.borrow_mut().occlusion = true;
            given.is_empty().then(|| visibility.clone())
        });
        let noted = calls.clone();
        let reflection = native("reflection()", "it takes no arguments", move |given| {
            noted.borrow_mut().reflection = true;
            given.is_empty().then(|| color.clone())
        });
        self.shade(function, Value::record(surface), &lights, [shadow, occlusion, reflection])
    }

    /// The renderer's way to the scene's own shading: it is given a surface, the lights, and what answers its calls.
    pub fn shading_function(&self, function: &'t Function) -> Value<'t> {
        Value::Function(Rc::new(Callable::Native(Rc::new(move |e: &mut Elaborator<'t>, given, span| {
            let Ok([surface, lights, shadow, occlusion, reflection]) =
                <[Value; 5]>::try_from(given.positional)
            else {
                unreachable!("the renderer gives five")
            };
            let surface = e.with_place_of_file(surface);
            let without_argument = |answer: Value<'t>| {
                Value::Function(Rc::new(Callable::Native(Rc::new(move |e: &mut Elaborator<'t>, _, _| {
                    e.call_function(&answer, vec![Value::float(0.0)], span)
                }))))
            };
            let calls = [shadow, without_argument(occlusion), without_argument(reflection)];
            e.shade(function, surface, &lights, calls).map(Value::Number)
        }))))
    }

    /// The record of a surface with its place in the coordinates of the file, where the renderer's are others.
    fn with_place_of_file(&mut self, surface: Value<'t>) -> Value<'t> {
        let (Some(origin), Value::Record(record)) = (self.origin, &surface) else { return surface };
        let origin = Number::constant(Constant::Vec3(origin.to_array()));
        let fields = record.fields.iter().map(|(name, value)| match (&**name, value) {
            ("p", Value::Number(p)) => {
                let place = self.contexts.apply(Op::Binary(Binary::Add), &[p.clone(), origin.clone()]);
                (name.clone(), Value::Number(place))
            }
            _ => (name.clone(), value.clone()),
        });
        Value::record(fields.collect())
    }

    /// The colour that the scene's own shading gives.
    fn shade(
        &mut self,
        function: &'t Function,
        surface: Value<'t>,
        lights: &Value<'t>,
        calls: [Value<'t>; 3],
    ) -> Eval<Number> {
        let mut arguments = Vec::new();
        let Value::List(lights) = lights else { unreachable!("lights are a list") };
        let mut shining = lights.items.iter();
        for (name, shines) in self.light_names.clone() {
            let zero = || Value::Number(Number::constant(Constant::Vec3([0.0; 3])));
            let it = if shines { shining.next().cloned() } else { Some(light(zero(), zero(), -1.0)) };
            // A file's own name for something else is not hidden: lights have a namespace of their own.
            if let (Some(it), Meaning::Nothing) = (it, self.names.meaning(&name, Module::ROOT)) {
                arguments.push((name, it));
            }
        }
        // What comes later hides what was before.
        arguments.extend(CALLS.into_iter().map(Arc::from).zip(calls));
        arguments.push((function.parameters[0].name.text.clone(), surface));
        let value = self.call_afresh(function, Module::ROOT, &arguments, function.name.span)?;
        self.as_typed(value, Type::Vec3, function.body.span)
    }
}

/// What the record of a surface holds, besides its lights: numbers and vectors.
const SURFACE: [(&str, Type); 10] = [
    ("p", Type::Vec3),
    ("n", Type::Vec3),
    ("to_eye", Type::Vec3),
    ("t", Type::Float),
    ("color", Type::Vec3),
    ("specular", Type::Float),
    ("shininess", Type::Float),
    ("emission", Type::Vec3),
    ("reflect", Type::Float),
    ("ambient", Type::Vec3),
];

fn light<'t>(direction: Value<'t>, color: Value<'t>, index: f64) -> Value<'t> {
    Value::record(vec![
        (Arc::from("direction"), direction),
        (Arc::from("distance"), Value::float(0.0)),
        (Arc::from("color"), color),
        (Arc::from("index"), Value::float(index)),
    ])
}

/// The place in the renderer's list of a light that is given as a record; -1 of one that never shines.
fn index_of(light: &Value<'_>) -> Option<f64> {
    let Value::Record(light) = light else { return None };
    let (Some(Value::Number(index)), Some(_)) = (light.get("index"), light.get("direction")) else {
        return None;
    };
    match index.known() {
        Some(Constant::Float(index)) => Some(index),
        _ => None,
    }
}

/// A function that the shading may call; `answer` gives nothing for arguments that it does not take.
fn native<'t>(
    signature: &'static str,
    why: &'static str,
    answer: impl Fn(&[Value<'t>]) -> Option<Value<'t>> + 't,
) -> Value<'t> {
    Value::Function(Rc::new(Callable::Native(Rc::new(move |e: &mut Elaborator<'t>, given, span| {
        let arguments: Vec<Value> = given.receiver.iter().chain(&given.positional).cloned().collect();
        match answer(&arguments).filter(|_| given.named.is_empty()) {
            Some(value) => Ok(value),
            None => {
                let name = signature.split('(').next().unwrap_or(signature);
                e.report(errors::no_fit(span, name, &given.describe(), why, &[signature.to_owned()]))
            }
        }
    }))))
}
