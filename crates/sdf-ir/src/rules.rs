//! What is simplified while a function is built. The identity stands above its rewrite.

use crate::build::Builder;
use crate::constant::Constant;
use crate::program::{Binary, Ternary, Unary, Value};

/// What `op(a)` is instead, if anything.
pub(crate) fn unary(b: &mut Builder, op: Unary, a: Value) -> Option<Value> {
    let a = b.constant_of(a)?;
    fold(b, Constant::unary(op, a))
}

/// What `op(x, y)` is instead, if anything.
pub(crate) fn binary(b: &mut Builder, op: Binary, x: Value, y: Value) -> Option<Value> {
    let (x, y) = (b.constant_of(x)?, b.constant_of(y)?);
    fold(b, Constant::binary(op, x, y))
}

/// What `op(x, y, z)` is instead, if anything.
pub(crate) fn ternary(b: &mut Builder, op: Ternary, x: Value, y: Value, z: Value) -> Option<Value> {
    let (x, y, z) = (b.constant_of(x)?, b.constant_of(y)?, b.constant_of(z)?);
    fold(b, Constant::ternary(op, x, y, z))
}

/// What the vector of `parts` is instead, if anything.
pub(crate) fn compose(_b: &mut Builder, _parts: &[Value]) -> Option<Value> {
    None
}

/// A constant result stands for the operation, unless it left the range of the language's numbers.
fn fold(b: &mut Builder, c: Constant) -> Option<Value> {
    c.is_finite().then(|| b.constant(c))
}
