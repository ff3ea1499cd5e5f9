//! The numbers from one end to the other, and arithmetic on them that rounds outwards.

/// All real numbers from `lo` to `hi`, both ends included. An infinite end means that there is no bound on that
/// side; no end is ever NaN, `lo` is never +∞ and `hi` never -∞.
///
/// Every operation holds what the operation makes of any numbers of its operands, in exact arithmetic and as `f64`
/// rounds it. A lower end of +0 also says that the number is not -0; operations that may yield -0 answer -0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub lo: f64,
    /// The upper end.
    pub hi: f64,
}

impl Interval {
    /// Every number.
    pub const ALL: Interval = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// Zero alone, of either sign.
    pub const ZERO: Interval = Interval { lo: -0.0, hi: 0.0 };
    /// One alone.
    pub const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };
    /// From zero to one.
    pub const UNIT: Interval = Interval { lo: 0.0, hi: 1.0 };
    /// From minus one to one.
    pub const SIGNED_UNIT: Interval = Interval { lo: -1.0, hi: 1.0 };
    /// No number below zero.
    pub const NOT_NEGATIVE: Interval = Interval { lo: 0.0, hi: f64::INFINITY };

    /// From `lo` to `hi`. An end that is NaN is no bound.
    pub fn new(lo: f64, hi: f64) -> Interval {
        let lo = if lo.is_nan() {
            f64::NEG_INFINITY
        } else if lo == 0.0 {
            -0.0
        } else {
            lo.min(f64::MAX)
        };
        let hi = if hi.is_nan() { f64::INFINITY } else { hi.max(f64::MIN) };
        debug_assert!(lo <= hi, "an interval from {lo:e} to {hi:e}");
        Interval { lo, hi }
    }

    /// One number alone.
    pub fn point(x: f64) -> Interval {
        if x.is_nan() { Interval::ALL } else { Interval { lo: x.min(f64::MAX), hi: x.max(f64::MIN) } }
    }

    /// From `-r` to `r`.
    pub fn symmetric(r: f64) -> Interval {
        Interval::new(-r, r)
    }

    /// A truth value as a number: 0, 1, or both where it is not known.
    pub fn of_bool(x: Option<bool>) -> Interval {
        match x {
            Some(x) => Interval::point(f64::from(x)),
            None => Interval::UNIT,
        }
    }

    /// The truth value, where it is known.
    pub fn decided(self) -> Option<bool> {
        if self.lo >= 1.0 {
            Some(true)
        } else if self.hi <= 0.0 {
            Some(false)
        } else {
            None
        }
    }

    /// Whether it holds one number alone.
    pub fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// Whether it is zero alone.
    pub fn is_zero(self) -> bool {
        self.lo == 0.0 && self.hi == 0.0
    }

    /// Whether both ends are finite.
    pub fn is_finite(self) -> bool {
        self.lo > f64::NEG_INFINITY && self.hi < f64::INFINITY
    }

    /// Whether `x` is in it.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// Whether all of `other` is in it.
    pub fn encloses(self, other: Interval) -> bool {
        self.lo <= other.lo && other.hi <= self.hi
    }

    /// The distance of its ends, rounded up.
    pub fn width(self) -> f64 {
        sum_up(self.hi, -self.lo)
    }

    /// A number in the middle, finite.
    pub fn middle(self) -> f64 {
        let middle = self.lo / 2.0 + self.hi / 2.0;
        if middle.is_nan() { 0.0 } else { middle.clamp(self.lo.max(f64::MIN), self.hi.min(f64::MAX)) }
    }

    /// The largest magnitude of its numbers.
    pub fn most(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The smallest magnitude of its numbers.
    pub fn least(self) -> f64 {
        if self.lo > 0.0 {
            self.lo
        } else if self.hi < 0.0 {
            -self.hi
        } else {
            0.0
        }
    }

    /// The smallest interval that holds both.
    pub fn hull(self, other: Interval) -> Interval {
        let lo = if self.lo == 0.0 && other.lo == 0.0 {
            // +0 only where neither may be -0.
            if self.lo.is_sign_positive() { other.lo } else { self.lo }
        } else {
            self.lo.min(other.lo)
        };
        Interval { lo, hi: self.hi.max(other.hi) }
    }

    /// What is in both. Both must hold the same numbers; where they do not meet, the first is the answer.
    pub fn intersect(self, other: Interval) -> Interval {
        let lo = if self.lo == 0.0 && other.lo == 0.0 && self.lo.is_sign_positive() {
            self.lo
        } else if other.lo > self.lo || (other.lo == self.lo && other.lo.is_sign_positive()) {
            other.lo
        } else {
            self.lo
        };
        let both = Interval { lo, hi: self.hi.min(other.hi) };
        if both.lo <= both.hi { both } else { self }
    }

    /// Each of its numbers clamped.
    pub fn clamp(self, lo: f64, hi: f64) -> Interval {
        Interval { lo: self.lo.clamp(lo, hi), hi: self.hi.clamp(lo, hi) }
    }

    /// Wider by a few units in the last place of the larger end: room for what a computation of several roundings
    /// is off by.
    pub fn widened(self) -> Interval {
        Interval { lo: below(self.lo), hi: above(self.hi) }
    }

    /// Wider by `by` on both sides.
    pub fn widened_by(self, by: f64) -> Interval {
        Interval::new(sum_down(self.lo, -by), sum_up(self.hi, by))
    }

    // ---- arithmetic

    /// `a + b`
    pub fn plus(self, b: Interval) -> Interval {
        Interval::new(sum_down(self.lo, b.lo), sum_up(self.hi, b.hi))
    }

    /// `a - b`
    pub fn minus(self, b: Interval) -> Interval {
        self.plus(b.negated())
    }

    /// `-a`
    pub fn negated(self) -> Interval {
        Interval::new(-self.hi, -self.lo)
    }

    /// `|a|`
    pub fn magnitude(self) -> Interval {
        // `abs` never yields -0.
        Interval { lo: self.least(), hi: self.most() }
    }

    /// `a * b`, where 0 times anything is 0.
    pub fn times(self, b: Interval) -> Interval {
        let a = self;
        if a.is_zero() || b.is_zero() {
            return Interval::ZERO;
        }
        let (lo, hi) = if a.lo >= 0.0 {
            if b.lo >= 0.0 {
                (product_down(a.lo, b.lo), product_up(a.hi, b.hi))
            } else if b.hi <= 0.0 {
                (product_down(a.hi, b.lo), product_up(a.lo, b.hi))
            } else {
                (product_down(a.hi, b.lo), product_up(a.hi, b.hi))
            }
        } else if a.hi <= 0.0 {
            if b.lo >= 0.0 {
                (product_down(a.lo, b.hi), product_up(a.hi, b.lo))
            } else if b.hi <= 0.0 {
                (product_down(a.hi, b.hi), product_up(a.lo, b.lo))
            } else {
                (product_down(a.lo, b.hi), product_up(a.lo, b.lo))
            }
        } else if b.lo >= 0.0 {
            (product_down(a.lo, b.hi), product_up(a.hi, b.hi))
        } else if b.hi <= 0.0 {
            (product_down(a.hi, b.lo), product_up(a.lo, b.lo))
        } else {
            (
                product_down(a.lo, b.hi).min(product_down(a.hi, b.lo)),
                product_up(a.lo, b.lo).max(product_up(a.hi, b.hi)),
            )
        };
        Interval::new(lo, hi)
    }

    /// `a * k`
    pub fn scaled(self, k: f64) -> Interval {
        self.times(Interval::point(k))
    }

    /// `a * a`, of one and the same number.
    pub fn squared(self) -> Interval {
        let a = self.magnitude();
        Interval { lo: product_down(a.lo, a.lo).clamp(0.0, f64::MAX), hi: product_up(a.hi, a.hi) }
    }

    /// `a / b` for a `b` without zero, and everything else where it has it. Saturates nowhere.
    pub fn over(self, b: Interval) -> Interval {
        if b.lo <= 0.0 && b.hi >= 0.0 {
            return if self.is_zero() { Interval::ZERO } else { Interval::ALL };
        }
        let (a, b) = if b.hi < 0.0 { (self.negated(), b.negated()) } else { (self, b) };
        let lo = quotient_down(a.lo, if a.lo >= 0.0 { b.hi } else { b.lo });
        let hi = quotient_up(a.hi, if a.hi >= 0.0 { b.lo } else { b.hi });
        Interval::new(lo, hi)
    }

    /// The square root of `max(a, 0)`.
    pub fn root(self) -> Interval {
        let lo = if self.lo > 0.0 { root_down(self.lo) } else { 0.0 };
        Interval::new(lo, root_up(self.hi.max(0.0)))
    }
}

// ---- directed rounding

/// The sum and what it is off by: Knuth's TwoSum. NaN where it overflows.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// `a + b`, rounded down. Opposite infinities give -∞.
pub(crate) fn sum_down(a: f64, b: f64) -> f64 {
    let (sum, error) = two_sum(a, b);
    if sum.is_nan() {
        f64::NEG_INFINITY
    } else if error >= 0.0 || a.is_infinite() || b.is_infinite() {
        sum
    } else {
        sum.next_down()
    }
}

/// `a + b`, rounded up. Opposite infinities give ∞.
pub(crate) fn sum_up(a: f64, b: f64) -> f64 {
    -sum_down(-a, -b)
}

/// Below this the error of a product or quotient may itself be rounded.
const TINY: f64 = 1e-290;

/// `a * b`, rounded down, where 0 times anything is 0.
pub(crate) fn product_down(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 {
        return 0.0;
    }
    let product = a * b;
    if a.is_infinite() || b.is_infinite() {
        return product;
    }
    if product.abs() < TINY || product.is_infinite() {
        let is_positive = (a > 0.0) == (b > 0.0);
        return if is_positive { product.next_down().max(0.0) } else { product.next_down() };
    }
    if a.mul_add(b, -product) < 0.0 { product.next_down() } else { product }
}

/// `a * b`, rounded up, where 0 times anything is 0.
pub(crate) fn product_up(a: f64, b: f64) -> f64 {
    -product_down(-a, b)
}

/// `a / b` for a positive `b`, rounded down.
pub(crate) fn quotient_down(a: f64, b: f64) -> f64 {
    if a == 0.0 {
        return 0.0;
    }
    if a.is_infinite() {
        return a;
    }
    if b.is_infinite() {
        return if a > 0.0 { 0.0 } else { -f64::from_bits(1) };
    }
    let quotient = a / b;
    if quotient.abs() < TINY || quotient.is_infinite() || a.abs() < TINY {
        return if a > 0.0 { quotient.next_down().max(0.0) } else { quotient.next_down() };
    }
    // What is left of a, exactly.
    if (-quotient).mul_add(b, a) < 0.0 { quotient.next_down() } else { quotient }
}

/// `a / b` for a positive `b`, rounded up.
pub(crate) fn quotient_up(a: f64, b: f64) -> f64 {
    -quotient_down(-a, b)
}

/// The square root of a number that is not negative, rounded down.
pub(crate) fn root_down(x: f64) -> f64 {
    let root = x.sqrt();
    if x < TINY {
        root.next_down().max(0.0)
    } else if root.is_finite() && (-root).mul_add(root, x) < 0.0 {
        root.next_down()
    } else {
        root
    }
}

/// The square root of a number that is not negative, rounded up.
pub(crate) fn root_up(x: f64) -> f64 {
    let root = x.sqrt();
    if x == 0.0 {
        0.0
    } else if x < TINY || (root.is_finite() && (-root).mul_add(root, x) > 0.0) {
        root.next_up()
    } else {
        root
    }
}

/// How much library functions, and short computations, may be off: 4 units in the last place.
const SLACK: f64 = 4.0 * f64::EPSILON;

/// A number that is surely below what is computed as `x`.
pub(crate) fn below(x: f64) -> f64 {
    if x.is_infinite() { x.min(f64::MAX) } else { (x - x.abs() * SLACK).next_down() }
}

/// A number that is surely above what is computed as `x`.
pub(crate) fn above(x: f64) -> f64 {
    -below(-x)
}

#[cfg(test)]
mod tests {
    use super::Interval;

    #[test]
    fn exact_results_stay_exact() {
        let [half, three] = [0.5, 3.0].map(Interval::point);
        assert_eq!(half.plus(three), Interval::point(3.5));
        assert_eq!(half.times(three), Interval::point(1.5));
        assert_eq!(three.over(half), Interval::point(6.0));
        assert_eq!(Interval::point(9.0).root(), three);
        assert!(!Interval::ONE.over(three).is_point());
    }

    #[test]
    fn no_end_is_ever_nan() {
        let ends =
            [f64::NEG_INFINITY, f64::MIN, -1.0, -1e-320, -0.0, 0.0, 5e-324, 2.0, f64::MAX, f64::INFINITY];
        let mut all = Vec::new();
        for lo in ends {
            for hi in ends {
                if lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY {
                    all.push(Interval::new(lo, hi));
                }
            }
        }
        for a in &all {
            for b in &all {
                for r in [a.plus(*b), a.minus(*b), a.times(*b), a.over(*b), a.hull(*b), a.intersect(*b)] {
                    assert!(
                        r.lo <= r.hi && r.lo < f64::INFINITY && r.hi > f64::NEG_INFINITY,
                        "{a:?} {b:?}: {r:?}"
                    );
                }
            }
            for r in [a.squared(), a.root(), a.widened(), a.magnitude(), a.negated()] {
                assert!(r.lo <= r.hi && r.lo < f64::INFINITY && r.hi > f64::NEG_INFINITY, "{a:?}: {r:?}");
            }
            assert!(a.middle().is_finite());
        }
    }
}
