//! `f32`: each operation as the hardware does it, one rounding each and never fused.
//!
//! It wants a program that [`legalise`](crate::total::legalise) has gone over: its division, square root, length
//! and normalisation are the raw ones. The operations that such a program no longer has (`Sin`, `Power`, …) have
//! their meaning too: the `f64` result, rounded.

use crate::bits;
use crate::number::Number;
use crate::program::{Binary, Unary};

impl Number for f32 {
    #[inline(always)]
    fn from_f64(x: f64) -> f32 {
        x as f32
    }

    #[inline(always)]
    fn from_bool(x: bool) -> f32 {
        if x { 1.0 } else { 0.0 }
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn unary(op: Unary, a: f32) -> f32 {
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
            Unary::Sqrt => a.sqrt(),
            Unary::PowerOfTwo => bits::power_of_two(a),
            Unary::Exponent => bits::exponent(a),
            Unary::Mantissa => bits::mantissa(a),
            Unary::Sin
            | Unary::Cos
            | Unary::Tan
            | Unary::Asin
            | Unary::Acos
            | Unary::Atan
            | Unary::Exp
            | Unary::Exp2
            | Unary::Log
            | Unary::Log2
            | Unary::Tanh => f64::unary(op, f64::from(a)) as f32,
            Unary::Not | Unary::Length | Unary::Normalize | Unary::Hash | Unary::ReduceAngle => {
                unreachable!("{op:?} does not work component by component")
            }
        }
    }

    #[inline(always)]
    fn binary(op: Binary, a: f32, b: f32) -> f32 {
        match op {
            Binary::Add => a + b,
            Binary::Subtract => a - b,
            Binary::Multiply => a * b,
            Binary::Divide => a / b,
            // Of 0 and -0 the second, as the processors' instructions have it and lavapipe too.
            Binary::Min => {
                if a < b {
                    a
                } else {
                    b
                }
            }
            Binary::Max => {
                if b < a {
                    a
                } else {
                    b
                }
            }
            Binary::Modulo | Binary::Power | Binary::Atan2 => {
                f64::binary(op, f64::from(a), f64::from(b)) as f32
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
    fn less(a: f32, b: f32) -> bool {
        a < b
    }

    #[inline(always)]
    fn less_equal(a: f32, b: f32) -> bool {
        a <= b
    }

    #[inline(always)]
    fn equal(a: f32, b: f32) -> bool {
        a == b
    }

    #[inline(always)]
    fn mix(a: f32, b: f32, t: f32) -> f32 {
        a * (1.0 - t) + b * t
    }

    #[inline(always)]
    fn dot(a: &[f32], b: &[f32]) -> f32 {
        let mut sum = a[0] * b[0];
        for i in 1..a.len() {
            sum += a[i] * b[i];
        }
        sum
    }

    #[inline(always)]
    fn length(a: &[f32]) -> f32 {
        f32::dot(a, a).sqrt()
    }

    #[inline(always)]
    fn normalize(a: &[f32], out: &mut [f32]) {
        let length = f32::length(a);
        for (o, x) in out.iter_mut().zip(a) {
            *o = x / length;
        }
    }

    #[inline(always)]
    fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    #[inline(always)]
    fn hash(a: &[f32]) -> f32 {
        bits::hash(a.iter().map(|x| x.to_bits()))
    }

    #[inline(always)]
    fn reduce_angle(self) -> [f32; 2] {
        let (r, q) = bits::reduce_angle(self);
        [r, q]
    }
}
