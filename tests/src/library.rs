//! The functions of the standard library, and calls of each: those that their doc comments give as examples.

use sdf_lang::{Kind, kind_of, reference};

/// A call of a function of the library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// The function's name.
    pub function: String,
    /// The call, as the doc comment has it. It may depend on `p`.
    pub expression: String,
    /// What the call gives.
    pub kind: Kind,
    /// Whether the function makes something of shapes or of functions.
    pub is_operator: bool,
}

impl Call {
    /// Whether the function makes a shape of numbers alone.
    pub fn is_primitive(&self) -> bool {
        self.is_of_a_shape() && !self.is_operator
    }

    /// Whether the call gives a shape, of space or of the plane.
    pub fn is_of_a_shape(&self) -> bool {
        matches!(self.kind, Kind::Shape | Kind::Shape2)
    }

    /// An expression that is a shape of space, in which all is computed that the call gives or a part of it.
    pub fn as_shape(&self) -> String {
        let call = &self.expression;
        match self.kind {
            Kind::Shape => call.clone(),
            Kind::Shape2 => format!("field {{ ({call})(p.xy) }}"),
            Kind::Float => format!("field {{ {call} }}"),
            Kind::Vec2 | Kind::Vec3 => format!("field {{ ({call}).y }}"),
            kind => panic!("{call} is no shape and no number, but a {kind:?}"),
        }
    }
}

/// The examples of the library, in its order, but that of `nothing`: it has no field to look at.
pub fn calls() -> Vec<Call> {
    let mut calls = Vec::new();
    for entry in reference().iter().flat_map(|section| &section.entries).filter(|e| e.name != "nothing") {
        for form in &entry.forms {
            for expression in &form.examples {
                calls.push(call(&entry.name, expression, form.is_operator()));
            }
        }
    }
    calls
}

fn call(function: &str, expression: &str, is_operator: bool) -> Call {
    let kind = kind_of(expression).unwrap_or_else(|found| panic!("{expression}: {found:#?}"));
    Call { function: function.into(), expression: expression.into(), kind, is_operator }
}
