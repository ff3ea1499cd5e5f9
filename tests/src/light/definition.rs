//! What the language says that effects are, evaluated in `f64` with far more samples than a shader takes.

use super::field::Probe;
use super::vector::{Vector, dot};

/// How many times the way doubles while a ray to a light is sampled, down from its end.
const DOUBLINGS: i32 = 20;
/// How many samples each of them has.
const SAMPLES: i32 = 400;
/// How many samples lie between those next to the darkest one.
const FINER: usize = 128;

/// The part of a light that reaches a place of the surface in a shadow of this softness: the least `clamp(k * d / t, 0, 1)`
/// along the ray to the light, its limit at the place itself included.
pub fn soft_shadow(field: &mut Probe, place: Vector, to_light: Vector, reach: f64, k: f64) -> f64 {
    let lit = |t: f64, d: f64| (k * d / t).clamp(0.0, 1.0);
    let mut least = (k * dot(field.gradient(place), to_light)).clamp(0.0, 1.0);
    for doubling in (0..DOUBLINGS).rev() {
        let part = |i: i32| reach * (-f64::from(doubling) - 1.0 + f64::from(i) / f64::from(SAMPLES)).exp2();
        let at: Vec<f64> = (0..=SAMPLES).map(part).collect();
        let distances = field.along(place, to_light, &at);
        let values: Vec<f64> = at.iter().zip(&distances).map(|(t, d)| lit(*t, *d)).collect();
        let darkest = (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).expect("samples");
        least = least.min(values[darkest]);
        if least <= 0.0 {
            return 0.0;
        }
        let (from, to) = (at[darkest.saturating_sub(1)], at[(darkest + 1).min(at.len() - 1)]);
        let finer: Vec<f64> = (0..=FINER).map(|i| from + (to - from) * i as f64 / FINER as f64).collect();
        let distances = field.along(place, to_light, &finer);
        least = finer.iter().zip(distances).fold(least, |least, (t, d)| least.min(lit(*t, d)));
    }
    least
}

/// How open the surroundings of a place of the surface are: `1 - occlusion * 2 / radius^2` times the integral of
/// `max(t - d(p + n * t), 0)` over `t` from 0 to `radius`, at least 0.
pub fn occlusion(field: &mut Probe, place: Vector, normal: Vector, occlusion: f64, radius: f64) -> f64 {
    const PARTS: usize = 2048;
    let width = radius / PARTS as f64;
    let at: Vec<f64> = (0..PARTS).map(|i| (i as f64 + 0.5) * width).collect();
    let distances = field.along(place, normal, &at);
    let covered: f64 = at.iter().zip(distances).map(|(t, d)| (t - d).max(0.0)).sum::<f64>() * width;
    (1.0 - occlusion * 2.0 / (radius * radius) * covered).max(0.0)
}

/// The integral of `max(1 - d / w, 0)^2 / w` over the part of a ray up to `limit`.
pub fn glow(field: &mut Probe, eye: Vector, direction: Vector, limit: f64, w: f64) -> f64 {
    // What is between two samples is at most half their distance nearer than they are: a part without light is passed at once.
    let step = w / 256.0;
    let mut sum = 0.0;
    let mut t = 0.0;
    while t < limit {
        let d = field.along(eye, direction, &[t])[0];
        if d > w + 2.0 * step {
            t += d - w - step;
            continue;
        }
        let parts = ((limit - t) / step).ceil().clamp(1.0, 64.0) as usize;
        let width = step.min((limit - t) / parts as f64);
        let at: Vec<f64> = (0..parts).map(|i| t + (i as f64 + 0.5) * width).collect();
        let bright = |d: f64| (1.0 - d / w).max(0.0).powi(2) / w;
        sum += field.along(eye, direction, &at).into_iter().map(bright).sum::<f64>() * width;
        t += width * parts as f64;
    }
    sum
}
