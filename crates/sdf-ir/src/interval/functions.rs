//! The operations of the language on intervals, number by number: what is not plain arithmetic.
//!
//! Library functions of `f64` are off by less than a unit in the last place; their results are widened by four.

use super::number::{Interval, above, below, product_up, quotient_up, sum_up};
use crate::bits;
use crate::number::{LARGEST, Number, SMALLEST_NORMAL};
use crate::program::{Binary, Unary};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Everything that an operation which saturates may yield.
pub(crate) const SATURATED: Interval = Interval { lo: -LARGEST, hi: LARGEST };

/// An operation that works component by component.
pub(crate) fn unary(op: Unary, a: Interval) -> Interval {
    match op {
        Unary::Negate => a.negated(),
        Unary::Abs => a.magnitude(),
        Unary::Sign | Unary::Floor | Unary::Ceil | Unary::Round | Unary::Trunc => increasing(op, a),
        Unary::Sqrt => {
            let root = a.root();
            // The root of -0 is -0.
            Interval::new(root.lo, root.hi)
        }
        Unary::Sin => sine(a),
        // The same waves, a quarter turn earlier.
        Unary::Cos => wave(a, 0.0, f64::cos),
        Unary::Tan => tangent(a),
        Unary::Asin => widened_within(increasing(op, a), -FRAC_PI_2, FRAC_PI_2),
        Unary::Acos => {
            let a = a.clamp(-1.0, 1.0);
            widened_within(Interval::new(a.hi.acos(), a.lo.acos()), 0.0, PI)
        }
        Unary::Atan => widened_within(increasing(op, a), -FRAC_PI_2, FRAC_PI_2),
        Unary::Exp | Unary::Exp2 => {
            let power = increasing(op, a).widened();
            Interval::new(power.lo.clamp(0.0, LARGEST), power.hi.min(LARGEST))
        }
        Unary::Log | Unary::Log2 => increasing(op, a).widened(),
        Unary::Tanh => widened_within(increasing(op, a), -1.0, 1.0),
        Unary::PowerOfTwo => {
            let power = increasing(op, a).widened();
            Interval::new(power.lo.max(0.0), power.hi)
        }
        Unary::Exponent => exponent(a),
        Unary::Mantissa => mantissa(a),
        Unary::Not | Unary::Length | Unary::Normalize | Unary::Hash | Unary::ReduceAngle => {
            unreachable!("{op:?} does not work component by component")
        }
    }
}

/// A function that does not decrease, as computed at both ends.
fn increasing(op: Unary, a: Interval) -> Interval {
    Interval::new(f64::unary(op, a.lo), f64::unary(op, a.hi))
}

/// Wider by the error of a library function, but not beyond these bounds, which are wider by a unit themselves.
fn widened_within(a: Interval, lo: f64, hi: f64) -> Interval {
    let wide = a.widened();
    let (lo, hi) = (if lo == 0.0 { 0.0 } else { lo.next_down() }, hi.next_up());
    Interval::new(wide.lo.max(lo), wide.hi.min(hi))
}

fn sine(a: Interval) -> Interval {
    wave(a, FRAC_PI_2, f64::sin)
}

/// A sine or cosine whose crests lie at `crest` and whole turns from it.
fn wave(a: Interval, crest: f64, function: fn(f64) -> f64) -> Interval {
    if !a.is_finite() {
        return Interval::SIGNED_UNIT;
    }
    let (x, y) = (function(a.lo), function(a.hi));
    let mut wide = Interval::new(x.min(y), x.max(y)).widened();
    if !a.is_point() {
        if holds_multiple(a, crest, TAU) {
            wide.hi = 1.0;
        }
        if holds_multiple(a, crest + PI, TAU) {
            wide.lo = -1.0;
        }
    }
    Interval::new(wide.lo.max(-1.0), wide.hi.min(1.0))
}

/// Whether some `offset + k·period` may lie in the interval, errors of π and of rounding included.
fn holds_multiple(a: Interval, offset: f64, period: f64) -> bool {
    let (from, to) = ((a.lo - offset) / period, (a.hi - offset) / period);
    let slack = 8.0 * f64::EPSILON * (1.0 + from.abs().max(to.abs()));
    (to + slack).floor() >= (from - slack).ceil()
}

/// Whether the tangent has a pole in the interval.
pub(crate) fn holds_pole(a: Interval) -> bool {
    !a.is_finite() || holds_multiple(a, FRAC_PI_2, PI)
}

fn tangent(a: Interval) -> Interval {
    if a.is_point() && a.is_finite() {
        return increasing(Unary::Tan, a).widened().clamp(-LARGEST, LARGEST);
    }
    if holds_pole(a) {
        return SATURATED;
    }
    increasing(Unary::Tan, a).widened().clamp(-LARGEST, LARGEST)
}

/// From the bits of the number as `f32`: the sign counts as 256.
fn exponent(a: Interval) -> Interval {
    let of_magnitude = |lo: f64, hi: f64| {
        let at = |x: f64| f64::unary(Unary::Exponent, x);
        Interval::new(at(lo), at(hi))
    };
    let positive = (a.hi >= 0.0).then(|| of_magnitude(a.lo.max(0.0) + 0.0, a.hi + 0.0));
    let may_be_negative = a.lo < 0.0 || (a.lo == 0.0 && a.lo.is_sign_negative());
    let negative = may_be_negative.then(|| {
        let below_zero = of_magnitude((-a.hi).max(0.0) + 0.0, -a.lo + 0.0);
        below_zero.plus(Interval::point(256.0))
    });
    match (positive, negative) {
        (Some(x), Some(y)) => x.hull(y),
        (Some(x), None) | (None, Some(x)) => x,
        (None, None) => unreachable!("a number is negative or not"),
    }
}

/// Where the number is normal: in `[1, 2]`, or just below where the exponent is that of the rounded number. What
/// the formula makes of other numbers is bounded roughly.
fn mantissa(a: Interval) -> Interval {
    if a.lo < SMALLEST_NORMAL || a.hi > LARGEST {
        // |x| / 2^n, where n is at least -127, at least 128 beyond `LARGEST`, and at least 129 below zero.
        let lo = if a.lo < 0.0 { (a.lo / 2f64.powi(384)).min(-(2f64.powi(-250))) } else { 0.0 };
        let hi = (a.hi / 2f64.powi(128)).max(2.0);
        return Interval::new(below(lo), above(hi));
    }
    if is_in_one_binade(a) {
        let scale = f64::unary(Unary::Exponent, a.lo).exp2();
        // A division by a power of two is exact.
        return Interval::new(a.lo / scale, a.hi / scale);
    }
    Interval::new(1.0 - f64::from(f32::EPSILON), 2.0)
}

/// Whether all numbers have one exponent, so that none jumps to another.
pub(crate) fn is_in_one_binade(a: Interval) -> bool {
    let at = |x: f64| f64::unary(Unary::Exponent, x);
    a.lo >= SMALLEST_NORMAL && a.hi <= LARGEST && at(a.lo) == at(a.hi)
}

/// An operation on two numbers that works component by component.
pub(crate) fn binary(op: Binary, a: Interval, b: Interval) -> Interval {
    match op {
        Binary::Add => a.plus(b),
        Binary::Subtract => a.minus(b),
        Binary::Multiply => a.times(b),
        Binary::Divide => quotient(a, b),
        Binary::Modulo => modulo(a, b),
        Binary::Min => Interval::new(a.lo.min(b.lo), a.hi.min(b.hi)),
        Binary::Max => Interval::new(a.lo.max(b.lo), a.hi.max(b.hi)),
        Binary::Power => power(a, b),
        Binary::Atan2 => angle(a, b),
        Binary::Less => Interval::of_bool(if a.hi < b.lo {
            Some(true)
        } else if a.lo >= b.hi {
            Some(false)
        } else {
            None
        }),
        Binary::LessEqual => Interval::of_bool(if a.hi <= b.lo {
            Some(true)
        } else if a.lo > b.hi {
            Some(false)
        } else {
            None
        }),
        Binary::Equal => Interval::of_bool(if a.is_point() && b.is_point() && a.lo == b.lo {
            Some(true)
        } else if a.hi < b.lo || b.hi < a.lo {
            Some(false)
        } else {
            None
        }),
        Binary::And => Interval::new(a.lo.min(b.lo), a.hi.min(b.hi)),
        Binary::Or => Interval::new(a.lo.max(b.lo), a.hi.max(b.hi)),
        Binary::Dot | Binary::Cross => unreachable!("{op:?} does not work component by component"),
    }
}

/// `a / b`, which saturates; what is divided by 0 has its own sign, and 0 / 0 is 0.
fn quotient(a: Interval, b: Interval) -> Interval {
    if a.is_zero() {
        return Interval::ZERO;
    }
    if b.lo > 0.0 || b.hi < 0.0 {
        return a.over(b).clamp(-LARGEST, LARGEST);
    }
    if b.lo < 0.0 {
        return SATURATED;
    }
    // The divisor is not negative, so the sign is that of a.
    let lo = if a.lo < 0.0 {
        -LARGEST
    } else if a.lo > 0.0 && b.hi > 0.0 {
        super::number::quotient_down(a.lo, b.hi).min(LARGEST)
    } else if a.lo > 0.0 {
        LARGEST
    } else {
        0.0
    };
    let hi = if a.hi > 0.0 {
        LARGEST
    } else if a.hi < 0.0 && b.hi > 0.0 {
        quotient_up(a.hi, b.hi).max(-LARGEST)
    } else if a.hi < 0.0 {
        -LARGEST
    } else {
        0.0
    };
    Interval::new(lo, hi)
}

/// The whole number that `floor(a / b)` is, where it is one and the same in the whole region.
pub(crate) fn whole_quotient(a: Interval, b: Interval) -> Option<f64> {
    if b.lo <= 0.0 && b.hi >= 0.0 {
        return None;
    }
    let ratio = a.over(b);
    let (lo, hi) = (ratio.lo.floor(), ratio.hi.floor());
    (lo == hi && lo.is_finite()).then_some(lo)
}

/// `a - b*floor(a/b)`, and 0 for a `b` of 0.
fn modulo(a: Interval, b: Interval) -> Interval {
    if b.is_zero() {
        return Interval::ZERO;
    }
    // The rounding of a/b may put the floor on the wrong side of a whole number, that of the product is as large.
    let quotient = a.most() / b.least();
    if !a.is_finite() || !quotient.is_finite() || quotient > 1e300 {
        return SATURATED;
    }
    // So may a quotient that is too small for an `f64` and becomes 0.
    let lost = product_up(b.most(), f64::from_bits(4));
    let slack = sum_up(product_up(a.most(), 4.0 * f64::EPSILON), lost);
    let rest = Interval::new(b.lo.min(0.0), b.hi.max(0.0)).widened_by(slack);
    let rest = match whole_quotient(a, b) {
        Some(whole) => rest.intersect(a.minus(b.scaled(whole)).widened_by(slack)),
        None => rest,
    };
    rest.clamp(-LARGEST, LARGEST)
}

/// Whether an odd whole number lies in the interval.
pub(crate) fn holds_odd(b: Interval) -> bool {
    if !b.is_finite() {
        return true;
    }
    let first = b.lo.ceil();
    let odd = if first.rem_euclid(2.0) == 1.0 { first } else { first + 1.0 };
    // Beyond 2^53 all numbers are even, and the sum above is not exact.
    odd <= b.hi && (odd.rem_euclid(2.0) == 1.0 || b.width() > 1.0)
}

/// `m^b` of magnitudes: monotone in both, so that the corners are the extremes.
pub(crate) fn power_of_magnitude(m: Interval, b: Interval) -> Interval {
    // No magnitude is -0.
    let m = Interval { lo: m.lo + 0.0, hi: m.hi + 0.0 };
    let corners = [m.lo.powf(b.lo), m.lo.powf(b.hi), m.hi.powf(b.lo), m.hi.powf(b.hi)];
    if corners.iter().any(|x| x.is_nan()) {
        return Interval { lo: 0.0, hi: LARGEST };
    }
    let (lo, hi) = corners.iter().fold((f64::INFINITY, 0.0f64), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
    Interval { lo: below(lo).clamp(0.0, LARGEST), hi: above(hi).min(LARGEST) }
}

fn power(a: Interval, b: Interval) -> Interval {
    if a.lo >= 0.0 || !holds_odd(b) {
        return power_of_magnitude(a.magnitude(), b);
    }
    let negative = power_of_magnitude(Interval::new(a.lo, a.hi.min(0.0)).magnitude(), b);
    let mut power = negative.negated();
    if !b.is_point() {
        power = power.hull(negative);
    }
    if a.hi >= 0.0 {
        power = power.hull(power_of_magnitude(Interval::new(a.lo.max(0.0), a.hi), b));
    }
    power
}

/// Whether the angle jumps in the region: it holds the origin, or points on both sides of the negative x axis.
pub(crate) fn angle_jumps(y: Interval, x: Interval) -> bool {
    let is_above = y.lo > 0.0 || (y.lo == 0.0 && y.lo.is_sign_positive());
    let holds_origin = y.contains(0.0) && x.contains(0.0);
    holds_origin || (x.lo < 0.0 && !is_above && y.hi >= 0.0)
}

/// The angle of the point (x, y).
fn angle(y: Interval, x: Interval) -> Interval {
    let all = Interval::new(-PI.next_up(), PI.next_up());
    let is_above = y.lo > 0.0 || (y.lo == 0.0 && y.lo.is_sign_positive());
    if !is_above && y.hi >= 0.0 && x.lo < 0.0 {
        return all;
    }
    // Zero counts as positive here: as a sign it matters only left of the origin, and above that is its sign.
    let corners = [y.lo + 0.0, y.hi + 0.0].map(|y| [x.lo, x.hi].map(|x| f64::binary(Binary::Atan2, y, x)));
    let mut hull = Interval::point(corners[0][0]);
    for corner in corners.as_flattened() {
        hull = hull.hull(Interval::point(*corner));
    }
    if y.contains(0.0) && x.contains(0.0) {
        hull = hull.hull(Interval::ZERO);
        // From the origin every direction of the quadrants that the region reaches is seen.
        if y.lo < 0.0 {
            hull = hull.hull(Interval::point(-FRAC_PI_2));
        }
        if y.hi > 0.0 {
            hull = hull.hull(Interval::point(FRAC_PI_2));
        }
        if x.lo < 0.0 {
            hull = hull.hull(Interval::point(PI));
        }
    }
    let wide = hull.widened();
    Interval::new(wide.lo.max(all.lo), wide.hi.min(all.hi))
}

/// See [`Unary::Hash`]: what the bits say where they are known.
pub(crate) fn hash(parts: &[Interval]) -> Interval {
    if parts.iter().all(|x| has_one_single(*x)) {
        return Interval::point(f64::from(bits::hash(parts.iter().map(|x| (x.lo as f32).to_bits()))));
    }
    Interval::UNIT
}

/// Whether all numbers are the same `f32`, zeros of both signs being one.
pub(crate) fn has_one_single(x: Interval) -> bool {
    x.is_finite() && x.lo as f32 == x.hi as f32
}

/// `(r, q)` of [`Unary::ReduceAngle`], and whether q is one and the same in the whole region.
pub(crate) fn reduce_angle(a: Interval) -> ([Interval; 2], bool) {
    let all = [Interval::symmetric(above(FRAC_PI_4)), Interval::new(0.0, 3.0)];
    if !a.is_finite() || a.width() > FRAC_PI_2 {
        return (all, false);
    }
    let [low, high] = [a.lo, a.hi].map(|x| x.reduce_angle());
    // Both ends have the same quarter and no turn lies between them: the rests are as far apart as the ends.
    if low[1] == high[1] && low[0] <= high[0] {
        let rest = Interval::new(low[0], high[0]).widened_by(4.0 * f64::EPSILON);
        return ([rest, Interval::point(low[1])], true);
    }
    (all, false)
}

/// `a*(1-t) + b*t`
pub(crate) fn mix(a: Interval, b: Interval, t: Interval) -> Interval {
    let by_parts = a.times(Interval::ONE.minus(t)).plus(b.times(t));
    let by_span = a.plus(b.minus(a).times(t));
    let slack = product_up(a.most().max(b.most()), 4.0 * f64::EPSILON);
    let mixed = by_parts.intersect(by_span.widened_by(product_up(slack, 1.0 + t.most())));
    if t.lo >= 0.0 && t.hi <= 1.0 { mixed.intersect(a.hull(b).widened_by(slack)) } else { mixed }
}
