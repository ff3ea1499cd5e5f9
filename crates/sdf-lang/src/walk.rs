//! One walk over the expressions of a tree.

use sdf_syntax::tree::{Argument, Block, Expr, ExprKind, PostfixKind};

/// Calls `visit` with each expression inside `expr`, itself included, outermost first; stops where it is true.
pub(crate) fn any<'t>(expr: &'t Expr, visit: &mut dyn FnMut(&'t Expr) -> bool) -> bool {
    if visit(expr) {
        return true;
    }
    match &expr.kind {
        ExprKind::Number(_)
        | ExprKind::Color(_)
        | ExprKind::Bool(_)
        | ExprKind::Name(_)
        | ExprKind::Error => false,
        ExprKind::Tuple(items) | ExprKind::List(items) => items.iter().any(|e| any(e, visit)),
        ExprKind::Record(r) | ExprKind::Material(r) => r.fields.iter().any(|f| any(&f.value, visit)),
        ExprKind::Block(block) | ExprKind::Shape(_, block) => any_in_block(block, visit),
        ExprKind::If { condition, then, otherwise } => {
            any(condition, visit) || any_in_block(then, visit) || any_in_block(otherwise, visit)
        }
        ExprKind::For { list, body, .. } => any(list, visit) || any_in_block(body, visit),
        ExprKind::Lambda(lambda) => any(&lambda.body, visit),
        ExprKind::Unary(_, a) => any(a, visit),
        ExprKind::Chain { first, rest } => any(first, visit) || rest.iter().any(|(_, _, e)| any(e, visit)),
        ExprKind::Postfix { base, operations } => {
            any(base, visit)
                || operations.iter().any(|op| match &op.kind {
                    PostfixKind::Call(args) | PostfixKind::Method(_, args) => any_argument(args, visit),
                    PostfixKind::Index(e) => any(e, visit),
                    PostfixKind::Member(_) => false,
                })
        }
    }
}

fn any_argument<'t>(arguments: &'t [Argument], visit: &mut dyn FnMut(&'t Expr) -> bool) -> bool {
    arguments.iter().any(|a| any(&a.value, visit))
}

/// The same over a block.
pub(crate) fn any_in_block<'t>(block: &'t Block, visit: &mut dyn FnMut(&'t Expr) -> bool) -> bool {
    block.bindings.iter().any(|b| any(&b.value, visit)) || any(&block.result, visit)
}

/// Whether a name for which `visit` is true stands anywhere inside, bound there or not.
pub(crate) fn any_name(expr: &Expr, visit: &mut dyn FnMut(&str) -> bool) -> bool {
    any(expr, &mut |e| matches!(&e.kind, ExprKind::Name(n) if visit(n)))
}
