//! The record that the renderer takes, while effects are found in it and left out of it.

use crate::solids::Solids;
use crate::value::{Fields, Value};
use std::rc::Rc;
use std::sync::Arc;

/// The record that the renderer takes, as far as it is made.
pub(crate) struct Called<'a, 't> {
    pub fields: &'a mut Vec<(Arc<str>, Value<'t>)>,
    pub solids: &'a mut Solids<'t>,
}

impl<'t> Called<'_, 't> {
    pub fn field(&self, name: &str) -> Option<&Value<'t>> {
        self.fields.iter().find(|(other, _)| &**other == name).map(|(_, value)| value)
    }

    pub fn record(&self, name: &str) -> Option<&Rc<Fields<'t>>> {
        match self.field(name) {
            Some(Value::Record(record)) => Some(record),
            _ => None,
        }
    }

    pub fn is(&self, block: &str, flag: &str) -> bool {
        self.record(block).and_then(|record| record.get(flag)).is_some_and(Value::is_true)
    }

    /// A truth value of the record itself.
    pub fn flag(&self, name: &str) -> bool {
        self.field(name).is_some_and(Value::is_true)
    }

    pub fn set_flag(&mut self, name: &str, is: bool) {
        self.replace(name, |_| Value::bool(is));
        if matches!(name, "reflects" | "transmits") {
            let goes_on = self.flag("reflects") || self.flag("transmits");
            self.replace("goes_on", |_| Value::bool(goes_on));
        }
    }

    /// Sets a number of a block.
    pub fn set_number(&mut self, block: &str, name: &str, number: f64) {
        self.replace(block, |record| with(record, name, &Value::float(number)));
    }

    fn replace(&mut self, name: &str, change: impl FnOnce(&Value<'t>) -> Value<'t>) {
        if let Some((_, value)) = self.fields.iter_mut().find(|(other, _)| &**other == name) {
            *value = change(value);
        }
    }

    pub fn set(&mut self, block: &str, flag: &str, is: bool) {
        self.replace(block, |record| with_flag(record, flag, is));
    }

    pub fn set_lights(&mut self, places: &[usize], flag: &str, is: bool) {
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
    pub fn remove(&mut self, list: &str, places: &[usize]) {
        self.replace(list, |value| {
            let Value::List(list) = value else { unreachable!("it is a list") };
            let others = list.items.iter().enumerate().filter(|(i, _)| !places.contains(i));
            Value::list(others.map(|(_, value)| value.clone()).collect())
        });
    }

    /// Lets rays step as far as fields read, however steep these are.
    pub fn take_whole_steps(&mut self) {
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
