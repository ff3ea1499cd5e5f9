//! On which side of zero a value certainly is, from the form of its formula.

use rustc_hash::FxHashMap;
use sdf_ir::{Binary, Builder, Node, Ternary, Unary, Value};

/// What is certain of a value, whatever the arguments are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Sign {
    /// It is not above zero.
    pub never_positive: bool,
    /// It is not below zero.
    pub never_negative: bool,
}

/// The signs of one function's values, each found once.
#[derive(Debug, Default)]
pub(crate) struct Signs {
    known: FxHashMap<Value, Sign>,
}

impl Signs {
    /// The sign of a value.
    pub fn of(&mut self, builder: &Builder, value: Value) -> Sign {
        if let Some(sign) = self.known.get(&value) {
            return *sign;
        }
        let sign = self.find(builder, value);
        self.known.insert(value, sign);
        sign
    }

    fn find(&mut self, builder: &Builder, value: Value) -> Sign {
        match builder.node(value) {
            Node::Float(bits) => {
                let x = f64::from_bits(bits);
                Sign { never_positive: x <= 0.0, never_negative: x >= 0.0 }
            }
            Node::Unary(Unary::Negate, a) => {
                let Sign { never_positive, never_negative } = self.of(builder, a);
                Sign { never_positive: never_negative, never_negative: never_positive }
            }
            Node::Unary(Unary::Abs | Unary::Sqrt | Unary::Length, _) => {
                Sign { never_positive: false, never_negative: true }
            }
            Node::Ternary(Ternary::Select, _, a, b) | Node::Binary(Binary::Add, a, b) => {
                let (a, b) = (self.of(builder, a), self.of(builder, b));
                Sign {
                    never_positive: a.never_positive && b.never_positive,
                    never_negative: a.never_negative && b.never_negative,
                }
            }
            Node::Binary(Binary::Multiply, a, b) => {
                let (a, b) = (self.of(builder, a), self.of(builder, b));
                Sign {
                    never_positive: (a.never_positive && b.never_negative)
                        || (a.never_negative && b.never_positive),
                    never_negative: (a.never_negative && b.never_negative)
                        || (a.never_positive && b.never_positive),
                }
            }
            Node::Binary(Binary::Min, a, b) => {
                let (a, b) = (self.of(builder, a), self.of(builder, b));
                Sign { never_positive: a.never_positive || b.never_positive, never_negative: false }
            }
            Node::Binary(Binary::Max, a, b) => {
                let (a, b) = (self.of(builder, a), self.of(builder, b));
                Sign { never_positive: false, never_negative: a.never_negative || b.never_negative }
            }
            _ => Sign::default(),
        }
    }
}
