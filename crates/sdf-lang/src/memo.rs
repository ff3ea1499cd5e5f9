//! What calls gave: a call of the same function with the same arguments gives the same value, so a function that
//! calls itself three times with the same arguments costs as many evaluations as it is deep.
//!
//! A value that is no constant can be a node of an open function, so what is remembered holds in the function, and
//! in the branch or loop of it, in which it was made.

use crate::context::{Scope, hash};
use crate::eval::{Elaborator, Eval};
use crate::value::{Callable, Candidate, Env, Number, Repr, Shape, Value};
use rustc_hash::FxHashMap;
use sdf_ir::Constant;
use sdf_syntax::Diagnostic;
use std::rc::Rc;
use std::sync::Arc;

/// What a call said and gave.
struct Outcome<'t> {
    value: Eval<Value<'t>>,
    diagnostics: Vec<Diagnostic>,
    /// How many expressions it took.
    cost: u64,
    /// What the key refers to by its place in memory, where nothing else may come to lie.
    _kept: (Option<Env<'t>>, Vec<(Arc<str>, Value<'t>)>),
}

/// Where a call is made: which values are known in it, and what happens on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Place {
    scope: Scope,
    notes_samples: bool,
    is_trial: bool,
}

/// Where the items of the file are evaluated.
const FILE: Place = Place { scope: Scope::FILE, notes_samples: false, is_trial: false };

/// The calls so far.
#[derive(Default)]
pub(crate) struct Memos<'t> {
    places: FxHashMap<Place, FxHashMap<Box<[u64]>, Outcome<'t>>>,
}

impl Memos<'_> {
    /// Forgets what trials gave, whose numbers are wrong.
    pub fn forget_trials(&mut self) {
        self.places.retain(|place, _| !place.is_trial);
    }
}

/// How many places are remembered before those that are closed are looked for.
const PLACES: usize = 64;
/// Arguments that take more words than this to tell apart are not compared.
const KEY_LIMIT: usize = 128;

impl<'t> Elaborator<'t> {
    /// The value of a call, found by `run` unless it was found before. `function` is what is called, by its place in
    /// memory, and `env` are the variables that it sees besides its arguments. `inert` says which arguments decide
    /// nothing; in a trial calls may differ in them.
    pub fn once(
        &mut self,
        function: *const (),
        env: Option<&Env<'t>>,
        arguments: &[(Arc<str>, Value<'t>)],
        inert: impl FnOnce(&mut Self) -> Arc<[bool]>,
        run: impl FnOnce(&mut Self) -> Eval<Value<'t>>,
    ) -> Eval<Value<'t>> {
        let deciding: Vec<(Arc<str>, Value<'t>)>;
        let key = if self.is_trial {
            let inert = inert(self);
            let kept = arguments.iter().zip(inert.iter()).filter(|(_, inert)| !**inert);
            deciding = kept.map(|(argument, _)| argument.clone()).collect();
            key(function, env, &deciding)
        } else {
            key(function, env, arguments)
        };
        let Some(key) = key else { return run(self) };
        let (scope, notes_samples) = (self.contexts.scope(), self.samples.is_some());
        let place = Place { scope, notes_samples, is_trial: self.is_trial };
        if let Some(known) = self.memos.places.get(&place).and_then(|calls| calls.get(&key)) {
            self.diagnostics.extend(known.diagnostics.iter().cloned());
            let (value, cost) = (known.value.clone(), known.cost);
            if self.is_trial {
                self.skip(cost, 1);
            }
            return value;
        }
        let (said, before) = (self.diagnostics.len(), self.spent());
        let value = run(self);
        if self.exhausted {
            return value;
        }
        let cost = self.spent() - before;
        let mut diagnostics = self.diagnostics.get(said..).map_or(Vec::new(), <[_]>::to_vec);
        crate::tidy(&mut diagnostics);
        if self.memos.places.len() > PLACES {
            let contexts = &self.contexts;
            self.memos.places.retain(|place, _| contexts.is_open(&place.scope));
        }
        let _kept = (env.cloned(), arguments.to_vec());
        let outcome = Outcome { value: value.clone(), diagnostics, cost, _kept };
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
        let known = self.memos.places.get(&FILE)?.get(&key)?;
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
        Value::Function(function) => place(7, function_place(function)),
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

/// What tells a function from others: one that has a name is the same wherever that stands.
fn function_place(function: &Rc<Callable<'_>>) -> *const () {
    match &**function {
        Callable::Overloads(_, candidates) => match candidates.first() {
            Some(Candidate::Written(written, _)) => std::ptr::from_ref(*written).cast(),
            Some(Candidate::BuiltIn(built_in)) => std::ptr::from_ref(*built_in).cast(),
            None => Rc::as_ptr(function).cast(),
        },
        Callable::Lambda { .. } | Callable::Native(_) => Rc::as_ptr(function).cast(),
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
