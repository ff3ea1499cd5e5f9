//! What an expression is, without what it is for: [`kind_of`].

use crate::eval::{Elaborator, Reported};
use crate::import::Files;
use crate::library::library;
use crate::names::Names;
use crate::value::{Module, Number, Value};
use sdf_ir::Type;
use sdf_syntax::tree::{Dimension, File};
use sdf_syntax::{Diagnostic, Severity, Sources};
use std::sync::Arc;

/// The kinds of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A function from a point of space to a distance.
    Shape,
    /// A function from a point of the plane to a distance.
    Shape2,
    /// `true` or `false`.
    Bool,
    /// A number.
    Float,
    /// Two numbers.
    Vec2,
    /// Three numbers, or a colour.
    Vec3,
    /// A material.
    Material,
    /// A list of values.
    List,
    /// A record of values.
    Record,
    /// A function.
    Function,
}

/// The kind of the value that an expression has, in which `p` may be a point of space; or what is wrong with it.
pub fn kind_of(expression: &str) -> Result<Kind, Vec<Diagnostic>> {
    // In parentheses it cannot end before its end.
    let text = format!("fn subject(p: vec3) = ({expression}\n)\n");
    let sources = library().sources("expression", &text);
    let (tree, diagnostics) = sdf_syntax::parse(crate::USER_FILE, &text);
    crate::on_deep_stack(|| find(&sources, &tree, diagnostics))
}

fn find(sources: &Sources, tree: &File, mut diagnostics: Vec<Diagnostic>) -> Result<Kind, Vec<Diagnostic>> {
    let files = Files::default();
    let names = Names::new(tree, &files, library(), &mut diagnostics);
    names.check(sources, &mut diagnostics);
    let is_wrong = |found: &[Diagnostic]| found.iter().any(|d| d.severity() == Severity::Error);
    let [function] = names.user.all_functions[..] else { return Err(diagnostics) };
    if is_wrong(&diagnostics) {
        return Err(diagnostics);
    }
    let mut elaborator = Elaborator::new(sources, &names, diagnostics);
    elaborator.allow_finding();
    elaborator.contexts.open(&Arc::from("subject"), None);
    let point = elaborator.contexts.entry_parameter("p", Type::Vec3);
    let value = elaborator.evaluate_body(function, Module::ROOT, &[(Arc::from("p"), Value::Number(point))]);
    elaborator.contexts.discard();
    match value {
        Ok(value) if !is_wrong(&elaborator.diagnostics) => Ok(kind(&value)),
        Ok(_) | Err(Reported) => Err(elaborator.diagnostics),
    }
}

fn kind(value: &Value<'_>) -> Kind {
    match value {
        Value::Number(Number { ty: Type::Bool, .. }) => Kind::Bool,
        Value::Number(Number { ty: Type::Float, .. }) => Kind::Float,
        Value::Number(Number { ty: Type::Vec2, .. }) => Kind::Vec2,
        Value::Number(Number { ty: Type::Vec3, .. }) => Kind::Vec3,
        Value::Shape(shape) if shape.dimension == Dimension::Two => Kind::Shape2,
        Value::Shape(_) => Kind::Shape,
        Value::Material(_) => Kind::Material,
        Value::List(_) => Kind::List,
        Value::Record(_) => Kind::Record,
        Value::Function(_) => Kind::Function,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_have_kinds() {
        let kinds = [
            ("sphere(1)", Kind::Shape),
            ("circle(0.5).at(1, 0)", Kind::Shape2),
            ("p.x + 1", Kind::Float),
            ("p.x < 1", Kind::Bool),
            ("p.xz", Kind::Vec2),
            ("checker(p.xz, #000, #fff)", Kind::Vec3),
            ("material { color: #fff }", Kind::Material),
            ("for i in 0..3 { p * i }", Kind::List),
            ("(a: p)", Kind::Record),
            ("|q| q", Kind::Function),
            ("sphere", Kind::Function),
        ];
        for (expression, kind) in kinds {
            assert_eq!(kind_of(expression), Ok(kind), "{expression}");
        }
        for wrong in ["sphere(", "no_such_thing", "sphere(1) + 2", "1 let a = 2", ""] {
            assert!(kind_of(wrong).is_err_and(|found| !found.is_empty()), "{wrong}");
        }
    }
}
