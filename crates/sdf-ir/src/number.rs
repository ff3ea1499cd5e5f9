//! Number systems: what each operation means on the numbers of one kind. Evaluators only walk.
//!
//! `f64` computes what the language says, as well as it can: it folds constants and is the reference.
//! `f32` computes what the hardware does, so it wants a program whose partial operations have been guarded.

mod dual;
mod single;

pub use dual::Dual;

use crate::bits;
use crate::program::{Binary, Unary};

/// The largest finite number of the language: the largest `f32`.
pub const LARGEST: f64 = f32::MAX as f64;
/// The smallest normal number of the language.
pub const SMALLEST_NORMAL: f64 = f32::MIN_POSITIVE as f64;
/// What the derivative of an angle takes the square of a vector for at least: the reciprocal of less than this, times
/// other numbers, may be infinite in `f32`.
pub const LEAST_SQUARE: f64 = 1e-36;

/// A kind of numbers.
pub trait Number: Copy + Send + Sync {
    /// The number nearest to `x`.
    fn from_f64(x: f64) -> Self;
    /// 1 for true and 0 for false: how evaluators keep a truth value among numbers.
    fn from_bool(x: bool) -> Self;
    /// The number, or what it is near to.
    fn to_f64(self) -> f64;
    /// An operation that works component by component. `Not`, `Length`, `Normalize`, `Hash` and `ReduceAngle`
    /// do not, and must not be asked for here.
    fn unary(op: Unary, a: Self) -> Self;
    /// An operation that works component by component and yields a number.
    fn binary(op: Binary, a: Self, b: Self) -> Self;
    /// Whether `a < b`.
    fn less(a: Self, b: Self) -> bool;
    /// Whether `a <= b`.
    fn less_equal(a: Self, b: Self) -> bool;
    /// Whether `a == b`.
    fn equal(a: Self, b: Self) -> bool;
    /// `a*(1-t) + b*t`
    fn mix(a: Self, b: Self, t: Self) -> Self;
    /// The sum of the products, from the first component to the last.
    fn dot(a: &[Self], b: &[Self]) -> Self;
    /// The square root of the sum of the squares.
    fn length(a: &[Self]) -> Self;
    /// `a` with length one, or zero.
    fn normalize(a: &[Self], out: &mut [Self]);
    /// The vector product.
    fn cross(a: [Self; 3], b: [Self; 3]) -> [Self; 3];
    /// See [`Unary::Hash`].
    fn hash(a: &[Self]) -> Self;
    /// See [`Unary::ReduceAngle`].
    fn reduce_angle(self) -> [Self; 2];
}

#[inline(always)]
fn saturate(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.clamp(-LARGEST, LARGEST) }
}

impl Number for f64 {
    #[inline(always)]
    fn from_f64(x: f64) -> f64 {
        x
    }

    #[inline(always)]
    fn from_bool(x: bool) -> f64 {
        f64::from(x)
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline(always)]
    fn unary(op: Unary, a: f64) -> f64 {
        match op {
            Unary::Negate => -a,
            Unary::Abs => a.abs(),
            Unary::Sign => {
                if a > 0.0 {
                    1.0
                } else if a < 0.0 {
                    -1.0
                } else {
                    0.0
                }
            }
            Unary::Floor => a.floor(),
            Unary::Ceil => a.ceil(),
            Unary::Round => a.round_ties_even(),
            Unary::Trunc => a.trunc(),
            Unary::Sqrt => a.max(0.0).sqrt(),
            Unary::Sin => a.sin(),
            Unary::Cos => a.cos(),
            Unary::Tan => saturate(a.tan()),
            Unary::Asin => a.clamp(-1.0, 1.0).asin(),
            Unary::Acos => a.clamp(-1.0, 1.0).acos(),
            Unary::Atan => a.atan(),
            Unary::Exp => saturate(a.exp()),
            Unary::Exp2 => saturate(a.exp2()),
            Unary::Log => a.max(SMALLEST_NORMAL).ln(),
            Unary::Log2 => a.max(SMALLEST_NORMAL).log2(),
            Unary::Tanh => a.tanh(),
            Unary::PowerOfTwo => a.exp2(),
            Unary::Exponent => f64::from((a as f32).to_bits() >> 23) - 127.0,
            Unary::Mantissa => a / (f64::from((a as f32).to_bits() >> 23) - 127.0).exp2(),
            Unary::Not | Unary::Length | Unary::Normalize | Unary::Hash | Unary::ReduceAngle => {
                unreachable!("{op:?} does not work component by component")
            }
        }
    }

    #[inline(always)]
    fn binary(op: Binary, a: f64, b: f64) -> f64 {
        match op {
            Binary::Add => a + b,
            Binary::Subtract => a - b,
            Binary::Multiply => a * b,
            Binary::Divide if b == 0.0 => {
                if a == 0.0 {
                    0.0
                } else {
                    LARGEST.copysign(a)
                }
            }
            Binary::Divide => saturate(a / b),
            Binary::Modulo if b == 0.0 => 0.0,
            Binary::Modulo => saturate(a - b * (a / b).floor()),
            Binary::Min => {
                if b < a {
                    b
                } else {
                    a
                }
            }
            Binary::Max => {
                if a < b {
                    b
                } else {
                    a
                }
            }
            Binary::Power => {
                let odd = b.floor() == b && b.rem_euclid(2.0) == 1.0;
                let magnitude = saturate(a.abs().powf(b));
                if odd && a < 0.0 { -magnitude } else { magnitude }
            }
            Binary::Atan2 => {
                if a == 0.0 && b == 0.0 {
                    0.0
                } else {
                    a.atan2(b)
                }
            }
            Binary::Dot
            | Binary::Cross
            | Binary::Less
            | Binary::LessEqual
            | Binary::Equal
            | Binary::And
            | Binary::Or => unreachable!("{op:?} does not work component by component"),
        }
    }

    #[inline(always)]
    fn less(a: f64, b: f64) -> bool {
        a < b
    }

    #[inline(always)]
    fn less_equal(a: f64, b: f64) -> bool {
        a <= b
    }

    #[inline(always)]
    fn equal(a: f64, b: f64) -> bool {
        a == b
    }

    #[inline(always)]
    fn mix(a: f64, b: f64, t: f64) -> f64 {
        a * (1.0 - t) + b * t
    }

    #[inline(always)]
    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(x, y)| x * y).sum()
    }

    #[inline(always)]
    fn length(a: &[f64]) -> f64 {
        saturate(f64::dot(a, a).sqrt())
    }

    #[inline(always)]
    fn normalize(a: &[f64], out: &mut [f64]) {
        let largest = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        if largest == 0.0 {
            out.fill(0.0);
            return;
        }
        let length = a.iter().map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt();
        for (o, x) in out.iter_mut().zip(a) {
            *o = x / largest / length;
        }
    }

    #[inline(always)]
    fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    #[inline(always)]
    fn hash(a: &[f64]) -> f64 {
        f64::from(bits::hash(a.iter().map(|x| (*x as f32).to_bits())))
    }

    #[inline(always)]
    fn reduce_angle(self) -> [f64; 2] {
        use std::f64::consts::{FRAC_PI_2, TAU};
        let angle = self % TAU;
        let q = (angle / FRAC_PI_2).round_ties_even();
        [angle - q * FRAC_PI_2, q.rem_euclid(4.0)]
    }
}
