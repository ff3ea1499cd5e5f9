//! The functions that stand in for partial or inaccurate built-ins, made of basic operations.
//!
//! The coefficients are minimax fits by Remez exchange in 40 decimal digits, for the weight that makes the named
//! error equal everywhere; the errors given are those of the polynomials alone, before rounding. Polynomials are in
//! Horner form, and no sum depends on its rounding, since drivers reassociate.

use crate::build::Builder;
use crate::number::{LARGEST, SMALLEST_NORMAL};
use crate::program::{Binary, Function, FunctionId, Parameter, Program, RegionId, Type, Unary, Value};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, LN_2, LOG2_E, PI, SQRT_2};

/// `sin r = r + r³·S(r²)` on [-π/4, π/4]; absolute error 4e-9.
const SINE: [f64; 3] = [-0.16666654943693207, 0.008332178145589998, -0.00019517298902343972];
/// `cos r = 1 - r²/2 + r⁴·C(r²)` on [-π/4, π/4]; absolute error 1e-10.
const COSINE: [f64; 3] = [0.041666646866428216, -0.0013887367514981291, 2.4438451502237533e-05];
/// `2^f = 1 + f·E(f)` on [0, 1]; relative error 3e-9.
const POWER_OF_TWO: [f64; 6] = [
    0.6931470444433666,
    0.24022930555173855,
    0.0554852806201828,
    0.009675451565216998,
    0.0012467846450773938,
    0.00021612914969555718,
];
/// `ln m = 2s + s³·L(s²)` with `s = (m - 1)/(m + 1)`, on [√½, √2]; relative error 1e-9.
const LOGARITHM: [f64; 3] = [0.6666677638162013, 0.3997754157567087, 0.298717277562852];
/// `atan a = a + a³·A(a²)` on [0, 1]; relative error 2e-8.
const ARC_TANGENT: [f64; 8] = [
    -0.3333315273493726,
    0.19993772814307545,
    -0.14211055170765868,
    0.10666004186997391,
    -0.0755221344028918,
    0.04321185190430993,
    -0.016367923035123216,
    0.0029206910899315843,
];
/// `asin s = s + s³·P(s²)` on [0, ½]; relative error 5e-9.
const ARC_SINE: [f64; 5] = [
    0.1666675248193325,
    0.07495297646279203,
    0.045470375563788745,
    0.024179516591011554,
    0.042166305302171185,
];
/// `tanh x = x + x³·T(x²)` on [0, 0.625]; relative error 5e-9.
const HYPERBOLIC_TANGENT: [f64; 5] = [
    -0.33333281941971654,
    0.13331442197500323,
    -0.053739715051156926,
    0.02063908718008855,
    -0.005704986960076797,
];

/// A function that stands in for an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Helper {
    SineCosine,
    Tangent,
    ArcSine,
    ArcCosine,
    ArcTangent,
    Angle,
    Exponential,
    Exponential2,
    Logarithm,
    Logarithm2,
    HyperbolicTangent,
    Power,
    Quotient,
    Remainder,
    Length2,
    Length3,
    Direction2,
    Direction3,
}

impl Helper {
    pub(super) fn name(self) -> &'static str {
        match self {
            Helper::SineCosine => "sine_cosine",
            Helper::Tangent => "tangent",
            Helper::ArcSine => "arc_sine",
            Helper::ArcCosine => "arc_cosine",
            Helper::ArcTangent => "arc_tangent",
            Helper::Angle => "angle_of_point",
            Helper::Exponential => "exponential",
            Helper::Exponential2 => "exponential_2",
            Helper::Logarithm => "logarithm",
            Helper::Logarithm2 => "logarithm_2",
            Helper::HyperbolicTangent => "hyperbolic_tangent",
            Helper::Power => "signed_power",
            Helper::Quotient => "safe_divide",
            Helper::Remainder => "floor_modulo",
            Helper::Length2 => "safe_length_2",
            Helper::Length3 => "safe_length_3",
            Helper::Direction2 => "safe_normalize_2",
            Helper::Direction3 => "safe_normalize_3",
        }
    }

    /// What it is, for a reader of the text.
    fn doc(self) -> &'static str {
        match self {
            Helper::SineCosine => "Sine and cosine of an angle, the same on every device.",
            Helper::Tangent => "Tangent of an angle, the same on every device.",
            Helper::ArcSine => "Arc sine, of the argument clamped to -1 to 1.",
            Helper::ArcCosine => "Arc cosine, of the argument clamped to -1 to 1.",
            Helper::ArcTangent => "Arc tangent, the same on every device.",
            Helper::Angle => "The angle of the point (x, y), 0 at the origin.",
            Helper::Exponential => "e to the power of x, never infinite.",
            Helper::Exponential2 => "2 to the power of x, never infinite.",
            Helper::Logarithm => "Natural logarithm, of a small number where x is not above 0.",
            Helper::Logarithm2 => "Logarithm to base 2, of a small number where x is not above 0.",
            Helper::HyperbolicTangent => "Hyperbolic tangent, the same on every device.",
            Helper::Power => "|x| to the power of y, with the sign of an odd whole power, never infinite.",
            Helper::Quotient => "x / y, with the largest number for x / 0, and 0 for 0 / 0.",
            Helper::Remainder => "x - y * floor(x / y), and 0 where y is 0.",
            Helper::Length2 | Helper::Length3 => "The length of a vector, however large or small.",
            Helper::Direction2 | Helper::Direction3 => "The vector with length 1, and zero for zero.",
        }
    }

    /// The names and types of its parameters, and the type of its result.
    pub(super) fn signature(self) -> (&'static [(&'static str, Type)], Type) {
        const X: &[(&str, Type)] = &[("x", Type::Float)];
        const V2: &[(&str, Type)] = &[("v", Type::Vec2)];
        const V3: &[(&str, Type)] = &[("v", Type::Vec3)];
        match self {
            Helper::SineCosine => (X, Type::Vec2),
            Helper::Tangent
            | Helper::ArcSine
            | Helper::ArcCosine
            | Helper::ArcTangent
            | Helper::Exponential
            | Helper::Exponential2
            | Helper::Logarithm
            | Helper::Logarithm2
            | Helper::HyperbolicTangent => (X, Type::Float),
            Helper::Angle => (&[("y", Type::Float), ("x", Type::Float)], Type::Float),
            Helper::Power | Helper::Quotient | Helper::Remainder => {
                (&[("x", Type::Float), ("y", Type::Float)], Type::Float)
            }
            Helper::Length2 => (V2, Type::Float),
            Helper::Length3 => (V3, Type::Float),
            Helper::Direction2 => (V2, Type::Vec2),
            Helper::Direction3 => (V3, Type::Vec3),
        }
    }

    /// The helpers that this one calls.
    fn callees(self) -> &'static [Helper] {
        match self {
            Helper::Tangent | Helper::Remainder => &[Helper::Quotient],
            Helper::HyperbolicTangent => &[Helper::Exponential],
            _ => &[],
        }
    }

    fn build(self, callees: &[FunctionId]) -> Function {
        let (parameters, _) = self.signature();
        let parameters =
            parameters.iter().map(|(name, ty)| Parameter { name: (*name).into(), ty: *ty, point: false });
        let mut builder = Builder::new(self.name(), parameters.collect());
        builder.set_doc(Some(self.doc().into()));
        let arguments: Vec<Value> =
            (0..self.signature().0.len()).map(|i| builder.argument(RegionId::ROOT, i as u16)).collect();
        let result = self.write(&mut builder, &arguments, callees);
        builder.finish(vec![(result, "".into())])
    }

    fn write(self, b: &mut Builder, a: &[Value], callees: &[FunctionId]) -> Value {
        match self {
            Helper::SineCosine => sine_cosine(b, a[0]),
            Helper::Tangent => tangent(b, a[0], callees[0]),
            Helper::ArcSine => arc_sine(b, a[0]),
            Helper::ArcCosine => arc_cosine(b, a[0]),
            Helper::ArcTangent => arc_tangent(b, a[0]),
            Helper::Angle => angle(b, a[0], a[1]),
            Helper::Exponential => exponential(b, a[0]),
            Helper::Exponential2 => exponential_2(b, a[0]),
            Helper::Logarithm => logarithm(b, a[0]),
            Helper::Logarithm2 => logarithm_2(b, a[0]),
            Helper::HyperbolicTangent => hyperbolic_tangent(b, a[0], callees[0]),
            Helper::Power => power(b, a[0], a[1]),
            Helper::Quotient => quotient(b, a[0], a[1]),
            Helper::Remainder => remainder(b, a[0], a[1], callees[0]),
            Helper::Length2 | Helper::Length3 => length(b, a[0]),
            Helper::Direction2 | Helper::Direction3 => direction(b, a[0]),
        }
    }
}

/// A program that gets the helpers it needs.
pub(super) struct Target {
    pub(super) program: Program,
    helpers: HashMap<Helper, FunctionId>,
}

impl Target {
    /// The program with nothing but these uniforms and globals.
    pub(super) fn like(program: &Program) -> Target {
        let program = Program {
            uniforms: program.uniforms.clone(),
            globals: program.globals.clone(),
            ..Program::default()
        };
        Target { program, helpers: HashMap::new() }
    }

    /// The function of a helper, which is added, after those that it calls, when it is first asked for.
    pub(super) fn helper(&mut self, helper: Helper) -> FunctionId {
        if let Some(id) = self.helpers.get(&helper) {
            return *id;
        }
        let callees: Vec<FunctionId> = helper.callees().iter().map(|callee| self.helper(*callee)).collect();
        let id = self.program.add(helper.build(&callees));
        self.helpers.insert(helper, id);
        id
    }
}

// ---- small sequences

/// `c₀ + x·(c₁ + x·(…))`
fn horner(b: &mut Builder, x: Value, coefficients: &[f64]) -> Value {
    let (last, rest) = coefficients.split_last().expect("a polynomial has a coefficient");
    let mut sum = b.float(*last);
    for c in rest.iter().rev() {
        let product = b.mul(sum, x);
        let c = b.float(*c);
        sum = b.add(product, c);
    }
    sum
}

/// `x + x³·P(x²)`
fn odd_polynomial(b: &mut Builder, x: Value, coefficients: &[f64]) -> Value {
    let square = b.mul(x, x);
    let tail = horner(b, square, coefficients);
    let tail = b.mul(tail, square);
    let tail = b.mul(tail, x);
    b.add(x, tail)
}

fn abs(b: &mut Builder, x: Value) -> Value {
    b.unary(Unary::Abs, x)
}

fn floor(b: &mut Builder, x: Value) -> Value {
    b.unary(Unary::Floor, x)
}

fn scale(b: &mut Builder, x: Value, factor: f64) -> Value {
    let factor = b.float(factor);
    b.mul(x, factor)
}

/// `constant - x`
fn minus_from(b: &mut Builder, constant: f64, x: Value) -> Value {
    let constant = b.float(constant);
    b.sub(constant, x)
}

fn clamp(b: &mut Builder, x: Value, lo: f64, hi: f64) -> Value {
    let (lo, hi) = (b.float(lo), b.float(hi));
    let x = b.max(x, lo);
    b.min(x, hi)
}

fn less(b: &mut Builder, x: Value, constant: f64) -> Value {
    let constant = b.float(constant);
    b.binary(Binary::Less, x, constant)
}

fn greater(b: &mut Builder, x: Value, constant: f64) -> Value {
    let constant = b.float(constant);
    b.binary(Binary::Less, constant, x)
}

fn equal(b: &mut Builder, x: Value, constant: f64) -> Value {
    let constant = b.float(constant);
    b.binary(Binary::Equal, x, constant)
}

fn negate_if(b: &mut Builder, condition: Value, x: Value) -> Value {
    let negative = b.neg(x);
    b.select(condition, negative, x)
}

fn call(b: &mut Builder, callee: FunctionId, arguments: &[Value]) -> Value {
    b.call(callee, &[Type::Float], arguments)[0]
}

// ---- angles

/// The sine and cosine of the rest of an angle, and its quarter.
fn reduced(b: &mut Builder, x: Value) -> (Value, Value, Value) {
    let reduced = b.unary(Unary::ReduceAngle, x);
    let (r, quarter) = (b.component(reduced, 0), b.component(reduced, 1));
    let sine = odd_polynomial(b, r, &SINE);
    let square = b.mul(r, r);
    let cosine = horner(b, square, &[1.0, -0.5, COSINE[0], COSINE[1], COSINE[2]]);
    (sine, cosine, quarter)
}

fn is_odd_quarter(b: &mut Builder, quarter: Value) -> Value {
    let (one, three) = (equal(b, quarter, 1.0), equal(b, quarter, 3.0));
    b.binary(Binary::Or, one, three)
}

fn sine_cosine(b: &mut Builder, x: Value) -> Value {
    let (sine, cosine, quarter) = reduced(b, x);
    let odd = is_odd_quarter(b, quarter);
    let first = b.select(odd, cosine, sine);
    let second = b.select(odd, sine, cosine);
    let low_half = greater(b, quarter, 1.5);
    let (one, two) = (equal(b, quarter, 1.0), equal(b, quarter, 2.0));
    let left_half = b.binary(Binary::Or, one, two);
    let first = negate_if(b, low_half, first);
    let second = negate_if(b, left_half, second);
    b.compose(&[first, second])
}

fn tangent(b: &mut Builder, x: Value, divide: FunctionId) -> Value {
    let (sine, cosine, quarter) = reduced(b, x);
    let odd = is_odd_quarter(b, quarter);
    // tan(r + π/2) == cos r / -sin r
    let minus_sine = b.neg(sine);
    let above = b.select(odd, cosine, sine);
    let below = b.select(odd, minus_sine, cosine);
    call(b, divide, &[above, below])
}

/// For `x` in [-1, 1]: whether |x| is above ½, and the arc sine of |x| where it is not, half the arc cosine of |x|
/// where it is: asin and acos of large arguments are those of `√((1 - |x|)/2)`.
fn arc_sine_part(b: &mut Builder, x: Value) -> (Value, Value) {
    let size = abs(b, x);
    let large = greater(b, size, 0.5);
    let rest = minus_from(b, 1.0, size);
    let half_rest = scale(b, rest, 0.5);
    let root = b.unary(Unary::Sqrt, half_rest);
    let s = b.select(large, root, size);
    (large, odd_polynomial(b, s, &ARC_SINE))
}

fn arc_sine(b: &mut Builder, x: Value) -> Value {
    let x = clamp(b, x, -1.0, 1.0);
    let (large, part) = arc_sine_part(b, x);
    let twice = scale(b, part, 2.0);
    let far = minus_from(b, FRAC_PI_2, twice);
    let size = b.select(large, far, part);
    let negative = less(b, x, 0.0);
    negate_if(b, negative, size)
}

fn arc_cosine(b: &mut Builder, x: Value) -> Value {
    let x = clamp(b, x, -1.0, 1.0);
    let (large, part) = arc_sine_part(b, x);
    let twice = scale(b, part, 2.0);
    let negative = less(b, x, 0.0);
    let opposite = minus_from(b, PI, twice);
    let far = b.select(negative, opposite, twice);
    let signed = negate_if(b, negative, part);
    let near = minus_from(b, FRAC_PI_2, signed);
    b.select(large, far, near)
}

fn arc_tangent(b: &mut Builder, x: Value) -> Value {
    let size = abs(b, x);
    let one = b.float(1.0);
    let at_least_one = b.max(size, one);
    let inverse = b.div(one, at_least_one);
    let large = greater(b, size, 1.0);
    let a = b.select(large, inverse, size);
    let part = odd_polynomial(b, a, &ARC_TANGENT);
    let far = minus_from(b, FRAC_PI_2, part);
    let angle = b.select(large, far, part);
    let negative = less(b, x, 0.0);
    negate_if(b, negative, angle)
}

fn angle(b: &mut Builder, y: Value, x: Value) -> Value {
    let (size_y, size_x) = (abs(b, y), abs(b, x));
    let smaller = b.min(size_y, size_x);
    let larger = b.max(size_y, size_x);
    let least = b.float(SMALLEST_NORMAL);
    let divisor = b.max(larger, least);
    let a = b.div(smaller, divisor);
    let part = odd_polynomial(b, a, &ARC_TANGENT);
    let steep = b.binary(Binary::Less, size_x, size_y);
    let far = minus_from(b, FRAC_PI_2, part);
    let right = b.select(steep, far, part);
    let left = minus_from(b, PI, right);
    let is_left = less(b, x, 0.0);
    let upper = b.select(is_left, left, right);
    let is_lower = less(b, y, 0.0);
    negate_if(b, is_lower, upper)
}

// ---- powers

/// `2^(whole + rest)`: `whole` and the sum are between -126 and 127.99999, `rest` is small.
fn power_of_sum(b: &mut Builder, whole: Value, rest: Value) -> Value {
    let more = floor(b, rest);
    let fraction = b.sub(rest, more);
    let exponent = b.add(whole, more);
    let mantissa = mantissa_of(b, fraction);
    let power = b.unary(Unary::PowerOfTwo, exponent);
    b.mul(mantissa, power)
}

/// `2^fraction` for a fraction in [0, 1].
fn mantissa_of(b: &mut Builder, fraction: Value) -> Value {
    let mut coefficients = vec![1.0];
    coefficients.extend(POWER_OF_TWO);
    horner(b, fraction, &coefficients)
}

fn exponential_2(b: &mut Builder, x: Value) -> Value {
    let inside = clamp(b, x, -126.0, 127.99999);
    let zero = b.float(0.0);
    let power = power_of_sum(b, zero, inside);
    let vanishes = less(b, x, -126.0);
    b.select(vanishes, zero, power)
}

/// With h the whole part of x and l the rest, `x·log₂e = h·23/16 + h·(log₂e - 23/16) + l·log₂e`. The first product
/// is exact, so that only its fraction, of a few units, is rounded together with the others.
fn exponential(b: &mut Builder, x: Value) -> Value {
    const COARSE: f64 = 23.0 / 16.0;
    let inside = clamp(b, x, -87.33654, 88.72283);
    let whole = floor(b, inside);
    let part = b.sub(inside, whole);
    let exact = scale(b, whole, COARSE);
    let exponent = floor(b, exact);
    let fraction = b.sub(exact, exponent);
    let correction = scale(b, whole, LOG2_E - COARSE);
    let part = scale(b, part, LOG2_E);
    let rest = b.add(correction, part);
    let rest = b.add(fraction, rest);
    let power = power_of_sum(b, exponent, rest);
    let vanishes = less(b, x, -87.33654);
    let zero = b.float(0.0);
    b.select(vanishes, zero, power)
}

/// `(e, ln m)` of a positive normal number `m·2^e` with m from √½ to √2.
fn split_logarithm(b: &mut Builder, x: Value) -> (Value, Value) {
    let (exponent, mantissa) = (b.unary(Unary::Exponent, x), b.unary(Unary::Mantissa, x));
    let upper = greater(b, mantissa, SQRT_2);
    let half = scale(b, mantissa, 0.5);
    let m = b.select(upper, half, mantissa);
    let one = b.float(1.0);
    let next = b.add(exponent, one);
    let e = b.select(upper, next, exponent);
    let (above, below) = (b.sub(m, one), b.add(m, one));
    let s = b.div(above, below);
    let square = b.mul(s, s);
    let series = horner(b, square, &[2.0, LOGARITHM[0], LOGARITHM[1], LOGARITHM[2]]);
    (e, b.mul(s, series))
}

fn at_least_normal(b: &mut Builder, x: Value) -> Value {
    let least = b.float(SMALLEST_NORMAL);
    b.max(x, least)
}

fn logarithm(b: &mut Builder, x: Value) -> Value {
    let x = at_least_normal(b, x);
    let (e, ln_m) = split_logarithm(b, x);
    let whole = scale(b, e, LN_2);
    b.add(whole, ln_m)
}

fn logarithm_2(b: &mut Builder, x: Value) -> Value {
    let x = at_least_normal(b, x);
    let (e, ln_m) = split_logarithm(b, x);
    let log_m = scale(b, ln_m, LOG2_E);
    b.add(e, log_m)
}

fn hyperbolic_tangent(b: &mut Builder, x: Value, exponential: FunctionId) -> Value {
    let x = clamp(b, x, -10.0, 10.0);
    let near = odd_polynomial(b, x, &HYPERBOLIC_TANGENT);
    let size = abs(b, x);
    let twice = scale(b, size, 2.0);
    let power = call(b, exponential, &[twice]);
    // tanh x == 1 - 2/(exp(2x) + 1)
    let (one, two) = (b.float(1.0), b.float(2.0));
    let below = b.add(power, one);
    let rest = b.div(two, below);
    let far = b.sub(one, rest);
    let negative = less(b, x, 0.0);
    let far = negate_if(b, negative, far);
    let is_near = less(b, size, 0.625);
    b.select(is_near, near, far)
}

/// `|x|^y = 2^(y·e + y·log₂ m)`, of which `y·e` is exact for the usual exponents.
fn power(b: &mut Builder, x: Value, y: Value) -> Value {
    let size = abs(b, x);
    let base = at_least_normal(b, size);
    let (e, ln_m) = split_logarithm(b, base);
    let log_m = scale(b, ln_m, LOG2_E);
    // Beyond that every power of a number other than 1 saturates or vanishes.
    let bounded = clamp(b, y, -1e10, 1e10);
    let coarse = b.mul(bounded, e);
    let whole = floor(b, coarse);
    let fraction = b.sub(coarse, whole);
    let fine = b.mul(bounded, log_m);
    let rest = b.add(fraction, fine);
    let more = floor(b, rest);
    let fraction = b.sub(rest, more);
    let exponent = b.add(whole, more);
    let mantissa = mantissa_of(b, fraction);
    let bounded_exponent = clamp(b, exponent, -126.0, 127.0);
    let two_to = b.unary(Unary::PowerOfTwo, bounded_exponent);
    // The fraction can round to 1, which would be the largest power twice.
    let below_two = b.float(2.0 - 2f64.powi(-23));
    let mantissa = b.min(mantissa, below_two);
    let value = b.mul(mantissa, two_to);

    let (zero, largest) = (b.float(0.0), b.float(LARGEST));
    let vanishes = less(b, exponent, -126.0);
    let saturates = greater(b, exponent, 127.0);
    let value = b.select(vanishes, zero, value);
    let value = b.select(saturates, largest, value);
    let (one, positive_y, zero_y) = (b.float(1.0), greater(b, y, 0.0), equal(b, y, 0.0));
    let of_zero = b.select(positive_y, zero, largest);
    let is_zero = less(b, size, SMALLEST_NORMAL);
    let value = b.select(is_zero, of_zero, value);
    let value = b.select(zero_y, one, value);

    // An odd y is whole and differs from twice the floor of its half by 1.
    let half = scale(b, y, 0.5);
    let half = floor(b, half);
    let even = scale(b, half, 2.0);
    let rest = b.sub(y, even);
    let odd = equal(b, rest, 1.0);
    let whole_y = floor(b, y);
    let is_whole = b.binary(Binary::Equal, y, whole_y);
    let negative = less(b, x, 0.0);
    let flips = b.binary(Binary::And, odd, negative);
    let flips = b.binary(Binary::And, flips, is_whole);
    negate_if(b, flips, value)
}

// ---- division

/// The quotient leaves the range only where |x| exceeds |y| times the largest number, which is asked in quarters so
/// that nothing overflows on the way.
fn quotient(b: &mut Builder, x: Value, y: Value) -> Value {
    let (size_x, size_y) = (abs(b, x), abs(b, y));
    let quarter_x = scale(b, size_x, 0.25);
    let four = b.float(4.0);
    let bounded_y = b.min(size_y, four);
    let limit = scale(b, bounded_y, LARGEST * (0.25 - 1e-7));
    let saturates = b.binary(Binary::Less, limit, quarter_x);
    let is_zero = less(b, size_y, SMALLEST_NORMAL);
    let one = b.float(1.0);
    let divisor = b.select(is_zero, one, y);
    let unbounded = b.binary(Binary::Or, saturates, is_zero);
    let zero = b.float(0.0);
    let dividend = b.select(unbounded, zero, x);
    let value = b.div(dividend, divisor);

    let largest = b.float(LARGEST);
    let x_negative = less(b, x, 0.0);
    // A divisor that is (or is flushed to) zero has no sign.
    let y_negative = less(b, divisor, 0.0);
    let towards_x = negate_if(b, x_negative, largest);
    let towards = negate_if(b, y_negative, towards_x);
    let is_nothing = equal(b, x, 0.0);
    let end = b.select(is_nothing, zero, towards);
    b.select(unbounded, end, value)
}

/// `x - y·floor(x/y)`, kept between 0 and y where the quotient is too large to be exact.
fn remainder(b: &mut Builder, x: Value, y: Value, divide: FunctionId) -> Value {
    let ratio = call(b, divide, &[x, y]);
    let whole = floor(b, ratio);
    let multiple = b.mul(y, whole);
    let rest = b.sub(x, multiple);
    let zero = b.float(0.0);
    let (lo, hi) = (b.min(y, zero), b.max(y, zero));
    let rest = b.max(rest, lo);
    let rest = b.min(rest, hi);
    let rest = in_period(b, rest, y);
    let size = abs(b, x);
    // There the multiple could overflow.
    let meaningless = greater(b, size, 1e37);
    b.select(meaningless, zero, rest)
}

/// A remainder of `y` that is one period off, where a driver divides by multiplying and `floor` gave the whole number
/// beside the right one; from 0 on, and less than `y` away from it.
pub(super) fn in_period(b: &mut Builder, rest: Value, y: Value) -> Value {
    let signs = [b.unary(Unary::Sign, rest), b.unary(Unary::Sign, y)];
    let product = b.mul(signs[0], signs[1]);
    let is_below = less(b, product, 0.0);
    let above = b.add(rest, y);
    let rest = b.select(is_below, above, rest);
    let (size, period) = (abs(b, rest), abs(b, y));
    let is_beyond = b.binary(Binary::LessEqual, period, size);
    let below = b.sub(rest, y);
    b.select(is_beyond, below, rest)
}

// ---- vectors

/// The largest magnitude of a component, and the vector over it.
fn scaled_down(b: &mut Builder, v: Value) -> (Value, Value) {
    let sizes = abs(b, v);
    let sizes = b.components(sizes);
    let most = sizes[1..].iter().fold(sizes[0], |most, size| b.max(most, *size));
    let divisor = at_least_normal(b, most);
    let direction = b.div(v, divisor);
    (most, direction)
}

fn length(b: &mut Builder, v: Value) -> Value {
    let (most, direction) = scaled_down(b, v);
    let factor = b.unary(Unary::Length, direction);
    let one = b.float(1.0);
    let at_least_one = b.max(factor, one);
    let largest = b.float(LARGEST);
    let limit = b.float(LARGEST * (1.0 - 1e-6));
    let limit = b.div(limit, at_least_one);
    let inside = b.min(most, limit);
    let value = b.mul(inside, factor);
    let saturates = b.binary(Binary::Less, limit, most);
    b.select(saturates, largest, value)
}

fn direction(b: &mut Builder, v: Value) -> Value {
    let ty = b.ty(v);
    let (most, direction) = scaled_down(b, v);
    let length = b.unary(Unary::Length, direction);
    let one = b.float(1.0);
    let length = b.max(length, one);
    let value = b.div(direction, length);
    let is_zero = less(b, most, SMALLEST_NORMAL);
    let zero = b.float(0.0);
    let zero = b.splat(zero, ty);
    b.select(is_zero, zero, value)
}
