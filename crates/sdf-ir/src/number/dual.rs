//! Numbers with their derivatives by three variables.
//!
//! Where a function has a crease (`abs`, `min`, …) the derivative is that of the branch that the value takes, and
//! where it jumps or has a pole it is that of the saturated function: 0.

use crate::number::{LARGEST, LEAST_SQUARE, Number, SMALLEST_NORMAL};
use crate::program::{Binary, Unary};

/// A number and its derivative by three variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<N> {
    /// The number.
    pub value: N,
    /// Its derivative.
    pub slope: [N; 3],
}

impl<N: Number> Dual<N> {
    /// A number that depends on nothing.
    #[inline(always)]
    pub fn constant(value: N) -> Dual<N> {
        Dual { value, slope: [N::from_f64(0.0); 3] }
    }

    /// The variable of this index, 0 to 2.
    pub fn variable(value: N, index: usize) -> Dual<N> {
        let mut dual = Dual::constant(value);
        dual.slope[index] = N::from_f64(1.0);
        dual
    }

    /// A function's value here, and its derivative times the slope.
    #[inline(always)]
    fn chain(self, value: N, derivative: N) -> Dual<N> {
        Dual { value, slope: self.slope.map(|s| mul(derivative, s)) }
    }

    /// A function of two numbers, from its value and its two partial derivatives.
    #[inline(always)]
    fn chain2(self, other: Dual<N>, value: N, by_self: N, by_other: N) -> Dual<N> {
        let slope = |i: usize| add(mul(by_self, self.slope[i]), mul(by_other, other.slope[i]));
        Dual { value, slope: [slope(0), slope(1), slope(2)] }
    }
}

#[inline(always)]
fn number<N: Number>(x: f64) -> N {
    N::from_f64(x)
}

#[inline(always)]
fn add<N: Number>(a: N, b: N) -> N {
    N::binary(Binary::Add, a, b)
}

#[inline(always)]
fn sub<N: Number>(a: N, b: N) -> N {
    N::binary(Binary::Subtract, a, b)
}

#[inline(always)]
fn mul<N: Number>(a: N, b: N) -> N {
    N::binary(Binary::Multiply, a, b)
}

#[inline(always)]
fn div<N: Number>(a: N, b: N) -> N {
    N::binary(Binary::Divide, a, b)
}

/// `1 / b`, and 0 where there is no such number: the derivative of something that saturates there.
#[inline(always)]
fn reciprocal<N: Number>(b: N) -> N {
    let zero = number(0.0);
    if N::equal(b, zero) { zero } else { div(number(1.0), b) }
}

/// The derivative of a component-by-component operation at `a`, where its value is `f`.
#[inline(always)]
fn derivative<N: Number>(op: Unary, a: N, f: N) -> N {
    let (zero, one) = (number::<N>(0.0), number::<N>(1.0));
    let inside = |lo: f64, hi: f64| N::less(number(lo), a) && N::less(a, number(hi));
    let saturated = || !(N::less(number(-LARGEST), f) && N::less(f, number(LARGEST)));
    match op {
        Unary::Negate => number(-1.0),
        Unary::Abs => N::unary(Unary::Sign, a),
        Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc | Unary::Exponent => zero,
        Unary::Sqrt if N::less(zero, a) => reciprocal(add(f, f)),
        Unary::Sqrt => zero,
        Unary::Sin => N::unary(Unary::Cos, a),
        Unary::Cos => N::unary(Unary::Negate, N::unary(Unary::Sin, a)),
        Unary::Tan | Unary::Exp | Unary::Exp2 if saturated() => zero,
        Unary::Tan => add(one, mul(f, f)),
        Unary::Asin if inside(-1.0, 1.0) => reciprocal(N::unary(Unary::Sqrt, sub(one, mul(a, a)))),
        Unary::Acos if inside(-1.0, 1.0) => {
            N::unary(Unary::Negate, reciprocal(N::unary(Unary::Sqrt, sub(one, mul(a, a)))))
        }
        Unary::Asin | Unary::Acos => zero,
        Unary::Atan => reciprocal(add(one, mul(a, a))),
        Unary::Exp => f,
        Unary::Exp2 | Unary::PowerOfTwo => mul(f, number(std::f64::consts::LN_2)),
        Unary::Log if N::less(number(SMALLEST_NORMAL), a) => reciprocal(a),
        Unary::Log2 if N::less(number(SMALLEST_NORMAL), a) => {
            mul(reciprocal(a), number(std::f64::consts::LOG2_E))
        }
        Unary::Log | Unary::Log2 => zero,
        Unary::Tanh => sub(one, mul(f, f)),
        // The mantissa is the number over a power of two that is locally constant.
        Unary::Mantissa => div(f, a),
        Unary::Not | Unary::Length | Unary::Normalize | Unary::Hash | Unary::ReduceAngle => {
            unreachable!("{op:?} does not work component by component")
        }
    }
}

impl<N: Number> Number for Dual<N> {
    fn from_f64(x: f64) -> Dual<N> {
        Dual::constant(N::from_f64(x))
    }

    fn from_bool(x: bool) -> Dual<N> {
        Dual::constant(N::from_bool(x))
    }

    fn to_f64(self) -> f64 {
        self.value.to_f64()
    }

    #[inline(always)]
    fn unary(op: Unary, a: Dual<N>) -> Dual<N> {
        let f = N::unary(op, a.value);
        a.chain(f, derivative(op, a.value, f))
    }

    #[inline(always)]
    fn binary(op: Binary, a: Dual<N>, b: Dual<N>) -> Dual<N> {
        let (x, y) = (a.value, b.value);
        let (zero, one) = (number::<N>(0.0), number::<N>(1.0));
        let f = N::binary(op, x, y);
        let saturated = || !(N::less(number(-LARGEST), f) && N::less(f, number(LARGEST)));
        match op {
            Binary::Add => a.chain2(b, f, one, one),
            Binary::Subtract => a.chain2(b, f, one, number(-1.0)),
            Binary::Multiply => a.chain2(b, f, y, x),
            Binary::Divide if saturated() || N::equal(y, zero) => Dual::constant(f),
            Binary::Divide => {
                let by_x = reciprocal(y);
                a.chain2(b, f, by_x, N::unary(Unary::Negate, mul(f, by_x)))
            }
            Binary::Modulo if N::equal(y, zero) => Dual::constant(f),
            Binary::Modulo => {
                let whole = N::unary(Unary::Floor, div(x, y));
                a.chain2(b, f, one, N::unary(Unary::Negate, whole))
            }
            Binary::Min => {
                if N::less(y, x) {
                    b
                } else {
                    a
                }
            }
            Binary::Max => {
                if N::less(x, y) {
                    b
                } else {
                    a
                }
            }
            Binary::Power if saturated() || N::equal(x, zero) => power_at_zero(a, b, f),
            Binary::Power => {
                let by_x = div(mul(y, f), x);
                a.chain2(b, f, by_x, mul(f, N::unary(Unary::Log, N::unary(Unary::Abs, x))))
            }
            Binary::Atan2 => {
                let square = add(mul(x, x), mul(y, y));
                let scale = reciprocal(N::binary(Binary::Max, square, number(LEAST_SQUARE)));
                a.chain2(b, f, mul(y, scale), N::unary(Unary::Negate, mul(x, scale)))
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
    fn less(a: Dual<N>, b: Dual<N>) -> bool {
        N::less(a.value, b.value)
    }

    #[inline(always)]
    fn less_equal(a: Dual<N>, b: Dual<N>) -> bool {
        N::less_equal(a.value, b.value)
    }

    #[inline(always)]
    fn equal(a: Dual<N>, b: Dual<N>) -> bool {
        N::equal(a.value, b.value)
    }

    #[inline(always)]
    fn mix(a: Dual<N>, b: Dual<N>, t: Dual<N>) -> Dual<N> {
        let rest = sub(number(1.0), t.value);
        let mixed = a.chain2(b, N::mix(a.value, b.value, t.value), rest, t.value);
        mixed.chain2(t, mixed.value, number(1.0), sub(b.value, a.value))
    }

    #[inline(always)]
    fn dot(a: &[Dual<N>], b: &[Dual<N>]) -> Dual<N> {
        let mut sum = mul(a[0], b[0]);
        for i in 1..a.len() {
            sum = add(sum, mul(a[i], b[i]));
        }
        sum
    }

    #[inline(always)]
    fn length(a: &[Dual<N>]) -> Dual<N> {
        let values = values(a);
        let mut length = Dual::constant(N::length(&values[..a.len()]));
        let mut direction = [number::<N>(0.0); 3];
        N::normalize(&values[..a.len()], &mut direction[..a.len()]);
        if N::equal(length.value, number(0.0)) {
            return length;
        }
        for (x, d) in a.iter().zip(direction) {
            length = length.chain2(*x, length.value, number(1.0), d);
        }
        length
    }

    #[inline(always)]
    fn normalize(a: &[Dual<N>], out: &mut [Dual<N>]) {
        let length = Dual::length(a);
        let values = values(a);
        let mut direction = [number::<N>(0.0); 3];
        N::normalize(&values[..a.len()], &mut direction[..a.len()]);
        let scale = reciprocal(length.value);
        for i in 0..a.len() {
            // (x/l)' = (x' - x/l·l')/l
            let slope = |k: usize| mul(scale, sub(a[i].slope[k], mul(direction[i], length.slope[k])));
            out[i] = Dual { value: direction[i], slope: [slope(0), slope(1), slope(2)] };
        }
    }

    #[inline(always)]
    fn cross(a: [Dual<N>; 3], b: [Dual<N>; 3]) -> [Dual<N>; 3] {
        let part = |i: usize, j: usize| sub(mul(a[i], b[j]), mul(a[j], b[i]));
        [part(1, 2), part(2, 0), part(0, 1)]
    }

    #[inline(always)]
    fn hash(a: &[Dual<N>]) -> Dual<N> {
        Dual::constant(N::hash(&values(a)[..a.len()]))
    }

    #[inline(always)]
    fn reduce_angle(self) -> [Dual<N>; 2] {
        let [r, q] = self.value.reduce_angle();
        [Dual { value: r, slope: self.slope }, Dual::constant(q)]
    }
}

/// The values of up to three numbers.
#[inline(always)]
fn values<N: Number>(a: &[Dual<N>]) -> [N; 3] {
    let mut out = [number(0.0); 3];
    for (o, x) in out.iter_mut().zip(a) {
        *o = x.value;
    }
    out
}

/// The derivative of `x^y` where it is not finite or x is 0: that of x itself for y = 1, and else flat.
#[inline(always)]
fn power_at_zero<N: Number>(x: Dual<N>, y: Dual<N>, f: N) -> Dual<N> {
    if N::equal(y.value, number(1.0)) { x } else { Dual::constant(f) }
}
