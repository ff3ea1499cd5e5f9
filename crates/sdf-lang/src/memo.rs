//! What calls gave: a call of the same function with the same arguments gives the same value, so a function that
//! calls itself three times with the same arguments costs as many evaluations as it is deep.
//!
//! A value that is no constant can be a node of an open function, so what is remembered holds in the function, and
//! in the branch or loop of it, in which it was made.

use crate::context::{Scope, hash};
use crate::eval::{Elaborator, Eval};
use crate::value::{Env, Number, Repr, Shape, Value};
use rustc_hash::FxHashMap;
use sdf_ir::Constant;
use sdf_syntax::Diagnostic;
use std::rc::Rc;
use std::sync::Arc;

/// What a call said and gave.
struct Outcome<'t> {
    value: Eval<Value<'t>>,
    diagnostics: Vec<Diagnostic>,
    /// What the key refers to by its place in memory, where nothing else may come to lie.
    _kept: (Option<Env<'t>>, Vec<(Arc<str>, Value<'t>)>),
}

/// Where a call is made: values are known in it, and samples are noted down or not.
type Place = (Scope, bool);

/// The calls so far.
#[derive(Default)]
pub(crate) struct Memos<'t> {
    places: FxHashMap<Place, FxHashMap<Box<[u64]>, Outcome<'t>>>,
}

/// How many places are remembered before those that are closed are looked for.
const PLACES: usize = 64;
/// Arguments that take more words than this to tell apart are not compared.
const KEY_LIMIT: usize = 128;

impl<'t> Elaborator<'t> {
    /// The value of a call, found by `run` unless it was found before. `function` is what is called, by its place in
    /// memory, and `env` are the variables that it sees besides its arguments.
    pub fn once(
        &mut self,
        function: *const (),
        env: Option<&Env<'t>>,
        arguments: &[(Arc<str>, Value<'t>)],
        run: impl FnOnce(&mut Self) -> Eval<Value<'t>>,
    ) -> Eval<Value<'t>> {
        let Some(key) = key(function, env, arguments) else { return run(self) };
        let place = (self.contexts.scope(), self.samples.is_some());
        if let Some(known) = self.memos.places.get(&place).and_then(|calls| calls.get(&key)) {
            self.diagnostics.extend(known.diagnostics.iter().cloned());
            return known.value.clone();
        }
        let said = self.diagnostics.len();
        let value = run(self);
        let mut diagnostics = self.diagnostics.get(said..).map_or(Vec::new(), <[_]>::to_vec);
        crate::tidy(&mut diagnostics);
        if self.memos.places.len() > PLACES {
            let contexts = &self.contexts;
            self.memos.places.retain(|(scope, _), _| contexts.is_open(scope));
        }
        let _kept = (env.cloned(), arguments.to_vec());
        let outcome = Outcome { value: value.clone(), diagnostics, _kept };
        self.memos.places.entry(place).or_default().insert(key, outcome);
        value
    }

    /// The shape that a call gave when the file was evaluated, where its arguments were the same constants. In the
    /// functions that are open now it is the same shape, with its numbers seen from inside.
    pub fn known_shape(
        &self,
        function: *const (),
        arguments: &[(Arc<str>, Value<'t>)],
    ) -> Option<Rc<Shape<'t>>> {
        if self.contexts.depth() == 0 || self.samples.is_some() {
            return None;
        }
        let key = key(function, None, &settled(arguments)?)?;
        let known = self.memos.places.get(&(Scope::FILE, false))?.get(&key)?;
        match &known.value {
            Ok(Value::Shape(shape)) if known.diagnostics.is_empty() => Some(shape.clone()),
            _ => None,
        }
    }
}

/// The arguments without what depends on the functions that are open: what is known now is a constant. `None` where
/// there is more to them.
fn settled<'t>(arguments: &[(Arc<str>, Value<'t>)]) -> Option<Vec<(Arc<str>, Value<'t>)>> {
    arguments
        .iter()
        .map(|(name, value)| match value {
            Value::Number(n) => Some((name.clone(), Value::Number(Number::constant(n.known()?)))),
            _ => None,
        })
        .collect()
}

/// What tells a call from others; `None` where that would take too long.
fn key(
    function: *const (),
    env: Option<&Env<'_>>,
    arguments: &[(Arc<str>, Value<'_>)],
) -> Option<Box<[u64]>> {
    let mut key = vec![function as u64, env.map_or(0, |env| env.place() as u64)];
    for (_, value) in arguments {
        add_value(value, true, &mut key);
        if key.len() > KEY_LIMIT {
            return None;
        }
    }
    Some(key.into())
}

/// Lists and records are told apart by what is in them, those inside others by their place.
fn add_value(value: &Value<'_>, is_outermost: bool, key: &mut Vec<u64>) {
    let mut place = |kind: u64, place: *const ()| key.extend([kind, place as u64]);
    match value {
        Value::Number(n) => add_number(n, key),
        Value::Shape(shape) => place(5, Rc::as_ptr(shape).cast()),
        Value::Material(material) => place(6, Rc::as_ptr(material).cast()),
        Value::Function(function) => place(7, Rc::as_ptr(function).cast()),
        Value::List(list) if is_outermost && list.items.len() < KEY_LIMIT => {
            key.extend([8, list.items.len() as u64]);
            list.items.iter().for_each(|item| add_value(item, false, key));
        }
        Value::List(list) => place(9, Rc::as_ptr(list).cast()),
        Value::Record(record) if is_outermost => {
            key.extend([10, record.fields.len() as u64]);
            for (name, field) in &record.fields {
                key.push(hash(name));
                add_value(field, false, key);
            }
        }
        Value::Record(record) => place(11, Rc::as_ptr(record).cast()),
    }
}

fn add_number(number: &Number, key: &mut Vec<u64>) {
    match &number.repr {
        Repr::Static(Constant::Bool(b)) => key.extend([1, u64::from(*b)]),
        Repr::Static(c) => {
            key.extend([2, c.ty().size() as u64]);
            key.extend(c.components().iter().map(|x| x.to_bits()));
        }
        Repr::Frame(value) => key.extend([3, u64::from(value.0)]),
        Repr::Local(depth, value) => key.extend([4, u64::from(*depth), u64::from(value.0)]),
        // What is known is the same, however it was computed.
        Repr::Outer(depth, inner) if inner.known().is_some() => {
            key.extend([12, u64::from(*depth)]);
            add_number(inner, key);
        }
        Repr::Outer(depth, _) => key.extend([13, u64::from(*depth), number.key]),
    }
}
