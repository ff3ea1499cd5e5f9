//! Which calls stay calls in the emitted program, so that it reads as a person would have written it.

use crate::value::{Module, Value};
use crate::walk;
use sdf_syntax::tree::{Block, ExprKind, Function, PostfixKind};

/// Whether a function of numbers stays a function: a user's or the renderer's always does; one of the library
/// does where its body has names of its own, while a one-line formula is written into its caller.
pub(crate) fn stays_a_function(function: &Function, module: Module) -> bool {
    module != Module::Library || matches!(&function.body.kind, ExprKind::Block(b) if !b.bindings.is_empty())
}

/// Whether a value has a number in it that is a node of an open function.
pub(crate) fn has_local_number(value: &Value<'_>) -> bool {
    match value {
        Value::Number(n) => n.is_local(),
        Value::Record(r) => r.traits.local,
        _ => false,
    }
}

/// Whether computing a side of an `if` for nothing would cost more than a branch: it has a loop or calls
/// something that may sample a shape.
pub(crate) fn is_costly(block: &Block) -> bool {
    walk::any_in_block(block, &mut |e| match &e.kind {
        ExprKind::For { .. } => true,
        ExprKind::Postfix { base, operations } => {
            let named = matches!(&base.kind, ExprKind::Name(n) if !crate::builtin::is_cheap(n));
            operations.iter().enumerate().any(|(i, op)| match &op.kind {
                PostfixKind::Call(_) => i > 0 || named,
                PostfixKind::Method(name, _) => !crate::builtin::is_cheap(&name.text),
                _ => false,
            })
        }
        _ => false,
    })
}
