//! The operations on the bits of an `f32`, written so that every language of shaders can mirror them line by line
//! and gets the same bits: unsigned arithmetic that wraps, exact conversions, and single float multiplications,
//! which no compiler can reassociate.

use std::f32::consts::FRAC_PI_4;

/// 2 to the power of `x`, a whole number from -126 to 127.
#[inline(always)]
pub fn power_of_two(x: f32) -> f32 {
    f32::from_bits(((x as i32 + 127) as u32) << 23)
}

/// The exponent of a positive normal number: `x` is `mantissa(x) * 2^exponent(x)`.
#[inline(always)]
pub fn exponent(x: f32) -> f32 {
    ((x.to_bits() >> 23) as i32 - 127) as f32
}

/// The mantissa of a positive normal number, in `[1, 2)`.
#[inline(always)]
pub fn mantissa(x: f32) -> f32 {
    f32::from_bits((x.to_bits() & 0x007f_ffff) | 0x3f80_0000)
}

/// `(r, q)` such that the angle `x` is `r + q·π/2` and whole turns, `|r| ≤ π/4` (and half an ulp), q one of 0, 1, 2, 3.
///
/// Small angles stay as they are. For others let T = 2³²/2π; then `angle·T mod 2³²` is the angle as a 32-bit
/// fraction of a turn, and `u32` arithmetic does the "mod" by itself. With the whole part `hi` of the angle and
/// `lo`, the rest in units of 2⁻²⁴ (exact: an angle above 1/2 has no finer bits),
///
/// `angle·T = hi·T + lo·(T/2²⁴) = hi·683565275 + hi·0.5764… + lo·40 + lo·0.7436…`
///
/// of which the products with whole numbers are exact modulo 2³² and the two others are single multiplications
/// whose whole parts are taken. Below 2²⁴ each of these is off by less than one unit of 2⁻³² turns and its
/// rounding by about one more, 4e-9 radians together; above, the error grows in proportion to the angle, and from
/// 2³¹ on all angles are 2³¹. The nearest quarter turn leaves a signed rest of 29 bits, which becomes a float
/// through two exact halves, since conversions of more than 24 bits may round either way. In all, r is off by at
/// most 8e-8, and near multiples of π/2 by 6e-9.
#[inline(always)]
pub fn reduce_angle(x: f32) -> (f32, f32) {
    let a = x.abs().min(2_147_483_648.0);
    let hi = a.floor();
    let lo = (a - hi) * 16_777_216.0;
    let turn = (hi as u32)
        .wrapping_mul(683_565_275)
        .wrapping_add((hi * 0.576_431_6) as u32)
        .wrapping_add((lo as u32).wrapping_mul(40))
        .wrapping_add((lo * 0.743_665_46) as u32);
    let quarter = turn.wrapping_add(0x2000_0000) >> 30;
    let rest = turn.wrapping_sub(quarter << 30) as i32;
    let r = ((rest >> 5) as f32 * 32.0 + (rest & 31) as f32) * 1.462_918_1e-9;
    let small = a < FRAC_PI_4;
    if small {
        (x, 0.0)
    } else if x < 0.0 {
        (-r, ((4 - quarter) & 3) as f32)
    } else {
        (r, quarter as f32)
    }
}

/// 32 well mixed bits from the bits of up to three floats (PCG: Jarzynski, Olano, "Hash Functions for GPU
/// Rendering", 2020), as a multiple of 2⁻²⁴ in `[0, 1)`. The bits of -0 count as those of 0.
#[inline(always)]
pub fn hash(words: impl IntoIterator<Item = u32>) -> f32 {
    let mut h = 0u32;
    for w in words {
        let w = if w == 0x8000_0000 { 0 } else { w };
        let s = (h ^ w).wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let t = ((s >> ((s >> 28) + 4)) ^ s).wrapping_mul(277_803_737);
        h = (t >> 22) ^ t;
    }
    (h >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, TAU};

    /// The distance of what `reduce_angle` says from the angle, modulo whole turns. 2π rounded to an `f64` is off
    /// by 2.5e-16, which at 2³¹ is 8e-8 in all.
    fn error(x: f32) -> f64 {
        let (r, q) = reduce_angle(x);
        assert!(f64::from(r.abs()) <= f64::from(FRAC_PI_4) + 6e-8, "{x:e}: r = {r}");
        assert!([0.0, 1.0, 2.0, 3.0].contains(&q), "{x:e}: q = {q}");
        let off = (f64::from(r) + f64::from(q) * FRAC_PI_2 - f64::from(x)) % TAU;
        off.abs().min(TAU - off.abs())
    }

    #[test]
    fn an_angle_is_its_rest_and_quarters() {
        let mut worst = 0.0f64;
        for i in 0..2_000_000u32 {
            let x = (i as f32 - 1e6) * 0.100_003;
            worst = worst.max(error(x));
        }
        println!("largest error up to 1e5: {worst:e}");
        // Near π/4: rounding the rest, the constant and their product, 2.5e-8 each.
        assert!(worst < 8e-8);
    }

    #[test]
    fn every_exponent_and_edge_stays_in_range() {
        for exponent in 0..255u32 {
            for step in 0..512u32 {
                let x = f32::from_bits(exponent << 23 | step << 14 | step);
                for x in [x, -x] {
                    let bound = 8e-8 + f64::from(x.abs()) * 4e-15;
                    assert!(x.abs() > 2.1e9 || error(x) < bound, "{x:e}: {:e}", error(x));
                    let (r, q) = reduce_angle(x);
                    assert!(r.abs() <= FRAC_PI_4.next_up() && (0.0..=3.0).contains(&q));
                }
            }
        }
        for quarter in 0..1000u32 {
            let edge = ((f64::from(quarter) + 0.5) * FRAC_PI_2) as f32;
            for x in [edge, edge.next_down(), edge.next_up(), -edge] {
                assert!(error(x) < 8e-8, "{x}: {:e}", error(x));
            }
        }
    }

    #[test]
    fn exponent_and_mantissa_make_up_a_number() {
        for bits in (0x0080_0000..0x7f80_0000u32).step_by(9973) {
            let x = f32::from_bits(bits);
            let (e, m) = (exponent(x), mantissa(x));
            assert!((1.0..2.0).contains(&m) && (-126.0..=127.0).contains(&e));
            assert_eq!(m * power_of_two(e), x);
        }
    }
}
