//! Numbers, intervals and points for tests; every run draws the same.

use sdf_ir::interval::{Bounds, Interval};
use sdf_ir::{Constant, Type};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Where something happens: zeros, denormals, ends of ranges, quarter turns, whole numbers and halves.
pub const NASTY: [f64; 42] = [
    0.0,
    -0.0,
    5e-324,
    -5e-324,
    1e-310,
    1e-200,
    -1e-160,
    1.1754943508222875e-38,
    -1.1754943508222875e-38,
    1e-30,
    1e-6,
    -1e-3,
    0.25,
    -0.5,
    0.5,
    FRAC_PI_4,
    1.0,
    -1.0,
    0.9999999999999999,
    1.0000000000000002,
    1.5,
    -1.5,
    FRAC_PI_2,
    -FRAC_PI_2,
    2.0,
    -2.0,
    2.5,
    3.0,
    -3.0,
    PI,
    -PI,
    4.71238898038469,
    TAU,
    -7.0,
    88.72,
    -104.0,
    1e5,
    -16777217.0,
    1e18,
    -1e18,
    3.4028234663852886e38,
    -3.4028234663852886e38,
];

pub struct Random(pub u64);

impl Random {
    /// 64 mixed bits (SplitMix64).
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// In `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A nasty number, or one beside it.
    fn end(&mut self) -> f64 {
        let x = self.of(&NASTY);
        match self.below(6) {
            0 => x.next_up(),
            1 => x.next_down(),
            2 => x * (1.0 + self.unit()),
            3 => x + self.unit() - 0.5,
            _ => x,
        }
    }

    /// Points, thin ones, wide ones, and some without bounds.
    pub fn interval(&mut self) -> Interval {
        let (x, y) = (self.end(), self.end());
        match self.below(8) {
            0 | 1 => Interval::point(x),
            2 => Interval::new(x, x.next_up()),
            3 => {
                let width = x.abs() * 0.1 * self.unit() + self.unit() * 1e-3;
                Interval::new(x - width, x + width)
            }
            4 if self.below(4) == 0 => Interval::new(f64::NEG_INFINITY, x),
            5 if self.below(4) == 0 => Interval::new(x, f64::INFINITY),
            _ => Interval::new(x.min(y), x.max(y)),
        }
    }

    /// An ordinary interval, at most 4 from zero.
    pub fn small(&mut self) -> Interval {
        let (x, y) = (8.0 * self.unit() - 4.0, 8.0 * self.unit() - 4.0);
        match self.below(6) {
            0 => Interval::point(x),
            1 => Interval::new(x, x + 1e-3),
            2 => Interval::new(x, x + 0.1),
            _ => Interval::new(x.min(y), x.max(y)),
        }
    }

    /// A number of the interval: an end, a zero, a nasty one, or any, all scales alike or all places alike. What is
    /// beyond `1e60` is left out.
    pub fn inside(&mut self, x: Interval) -> f64 {
        let (lo, hi) = (x.lo.max(-1e60), x.hi.min(1e60));
        let drawn = match self.below(6) {
            0 => lo,
            1 => hi,
            2 => self.of(&NASTY),
            3 => lo + (hi - lo) * self.unit(),
            _ => {
                // As whole numbers, doubles are in order.
                let order = |x: f64| {
                    let bits = x.to_bits() as i64;
                    if bits < 0 { i64::MIN.wrapping_sub(bits) } else { bits }
                };
                let (from, to) = (i128::from(order(lo)), i128::from(order(hi)));
                let at = from + (u128::from(self.bits()) % ((to - from) as u128 + 1)) as i128;
                let at = at as i64;
                f64::from_bits((if at < 0 { i64::MIN.wrapping_sub(at) } else { at }) as u64)
            }
        };
        let drawn = if drawn >= lo && drawn <= hi { drawn } else { lo };
        // A lower end of +0 says that there is no -0.
        if drawn == 0.0 && lo == 0.0 && lo.is_sign_positive() { 0.0 } else { drawn }
    }

    pub fn bounds(&mut self, ty: Type, interval: impl Fn(&mut Random) -> Interval) -> Bounds {
        match ty {
            Type::Bool => Bounds::bool(self.of(&[None, Some(true), Some(false)])),
            _ => {
                let parts: Vec<Interval> = (0..ty.size()).map(|_| interval(self)).collect();
                Bounds::vector(&parts)
            }
        }
    }

    pub fn value(&mut self, bounds: &Bounds) -> Constant {
        match bounds.ty() {
            Type::Bool => Constant::Bool(bounds.decided().unwrap_or(self.below(2) == 0)),
            _ => {
                let parts: Vec<f64> = bounds.parts().iter().map(|x| self.inside(*x)).collect();
                Constant::from_components(&parts)
            }
        }
    }
}
