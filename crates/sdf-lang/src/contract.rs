//! What an item promises of its field, and what it requires: the attributes before a `fn` or a `let`.

use crate::errors;
use crate::walk;
use sdf_syntax::tree::{Attribute, AttributeArgument, Expr};
use sdf_syntax::{Diagnostic, Span, did_you_mean};

/// The attributes of one item.
#[derive(Debug, Default)]
pub(crate) struct Contract<'t> {
    /// `@exact` or `@bound`.
    pub quality: Option<(Quality, Span)>,
    /// `@lipschitz(e)`: the slope of the field is at most e.
    pub slope: Option<(&'t Expr, Span)>,
    /// `@bounds(lo, hi)`: the surface and the inside lie in that box.
    pub bounds: Option<(&'t Expr, &'t Expr, Span)>,
    /// `@convex`: with any two points, the solid holds what lies between them; on an operator, if its shapes do.
    pub convex: Option<Span>,
    pub requirements: Vec<Requirement<'t>>,
}

/// What a field says of the distance; on an operator, as far as its worst shape argument lets it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Quality {
    /// The Euclidean distance, everywhere outside.
    Exact,
    /// Lipschitz constant at most 1, hence never more than the distance.
    Bound,
}

/// `@requires(condition, "message")`.
#[derive(Debug)]
pub(crate) struct Requirement<'t> {
    pub condition: &'t Expr,
    pub message: &'t str,
    pub span: Span,
}

/// The attributes that the language has.
pub(crate) const ATTRIBUTES: [&str; 6] = ["exact", "bound", "lipschitz", "bounds", "convex", "requires"];

impl<'t> Contract<'t> {
    /// What the attributes of an item say; what is wrong with them is reported. Only a `fn` and a `let` take them.
    pub fn of(
        attributes: &'t [Attribute],
        takes_attributes: bool,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Contract<'t> {
        let mut contract = Contract::default();
        for attribute in attributes {
            let name = &*attribute.name.text;
            let span = attribute.span;
            if !ATTRIBUTES.contains(&name) {
                let similar = did_you_mean(name, ATTRIBUTES);
                diagnostics.push(errors::unknown_attribute(&attribute.name, similar, &ATTRIBUTES));
                continue;
            }
            if !takes_attributes {
                diagnostics.push(errors::misplaced_attribute(span));
                continue;
            }
            let before = match (name, &attribute.arguments[..]) {
                ("exact", []) => contract.quality.replace((Quality::Exact, span)).map(|q| q.1),
                ("bound", []) => contract.quality.replace((Quality::Bound, span)).map(|q| q.1),
                ("lipschitz", [AttributeArgument::Expr(e)]) => contract.slope.replace((e, span)).map(|s| s.1),
                ("bounds", [AttributeArgument::Expr(lo), AttributeArgument::Expr(hi)]) => {
                    contract.bounds.replace((lo, hi, span)).map(|b| b.2)
                }
                ("convex", []) => contract.convex.replace(span),
                ("requires", [AttributeArgument::Expr(condition), AttributeArgument::Text(message, _)]) => {
                    contract.requirements.push(Requirement { condition, message, span });
                    None
                }
                _ => {
                    diagnostics.push(errors::wrong_attribute(span, name));
                    None
                }
            };
            if let Some(first) = before {
                diagnostics.push(errors::attribute_twice(span, name, first));
            }
        }
        contract
    }

    /// Whether its box is one for each level, and not that of the surface and the inside alone.
    pub fn is_of_levels(&self) -> bool {
        let mentions = |e: &Expr| walk::any_name(e, &mut |name| name == "level");
        self.bounds.is_some_and(|(lo, hi, _)| mentions(lo) || mentions(hi))
    }

    /// Where its first promise stands.
    pub fn place(&self) -> Option<Span> {
        let quality = self.quality.map(|q| q.1);
        quality.or(self.slope.map(|s| s.1)).or(self.bounds.map(|b| b.2)).or(self.convex)
    }

    /// Whether it says anything.
    pub fn is_empty(&self) -> bool {
        !self.promises() && self.requirements.is_empty()
    }

    /// Whether it promises anything of a field.
    pub fn promises(&self) -> bool {
        self.quality.is_some() || self.slope.is_some() || self.bounds.is_some() || self.convex.is_some()
    }

    /// The expressions in it, whose names must mean something: those of promises, and those of requirements.
    pub fn expressions(&self) -> (Vec<&'t Expr>, Vec<&'t Expr>) {
        let slope = self.slope.iter().map(|(e, _)| *e);
        let bounds = self.bounds.iter().flat_map(|(lo, hi, _)| [*lo, *hi]);
        (slope.chain(bounds).collect(), self.requirements.iter().map(|r| r.condition).collect())
    }
}

/// What a contract's expressions see besides the parameters: the point and a distance from it in `@lipschitz`; in
/// `@bounds` the level: then the box is that of the points where the field is at most that, for any level.
pub(crate) const VARIABLES: [&str; 3] = ["p", "d", "level"];
