//! What the language says that effects are, evaluated in `f64` with far more samples than a shader takes.

use super::field::Probe;
use super::vector::{Vector, dot, length, minus, times};

/// How far samples of a shadow are apart, in the distances at which `k * d / t` changes by 1.
const FINE: f64 = 0.01;
/// Where the samples of a shadow begin, beside the limit at the place itself.
const NEAR: f64 = 1e-4;
/// A field may be so many times as steep as a distance for what is passed at once to be passed rightly.
const STEEP: f64 = 4.0;

/// A light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// The vector towards it.
    Sun(Vector),
    /// Where it is.
    Lamp(Vector),
}

impl Light {
    /// The unit vector from a place to the light, and how far it is, or how far rays go.
    pub fn from(self, place: Vector, far: f64) -> (Vector, f64) {
        let (way, reach) = match self {
            Light::Sun(direction) => (direction, far),
            Light::Lamp(at) => (minus(at, place), length(minus(at, place))),
        };
        (times(way, 1.0 / length(way)), reach)
    }

    /// The setting that is this light in a scene.
    pub fn setting(self) -> String {
        let (name, [x, y, z]) = match self {
            Light::Sun(direction) => ("direction", direction),
            Light::Lamp(at) => ("position", at),
        };
        format!("{name}: ({x}, {y}, {z})")
    }
}

/// The part of a light that reaches places of the surface in a shadow of softness `k`: the least `clamp(k * d / t, 0, 1)`
/// along the rays to it, its limit at the place itself included. Each ray is sampled until it is at the light, or dark.
pub fn soft_shadows(field: &mut Probe, places: &[Vector], light: Light, far: f64, k: f64) -> Vec<f64> {
    let ways: Vec<(Vector, f64)> = places.iter().map(|place| light.from(*place, far)).collect();
    let mut least: Vec<f64> = Vec::new();
    for (place, (way, _)) in places.iter().zip(&ways) {
        least.push((k * dot(field.gradient(*place), *way)).clamp(0.0, 1.0));
    }
    let mut live: Vec<(usize, f64)> = (0..places.len()).map(|i| (i, NEAR)).collect();
    while !live.is_empty() {
        let at = |(i, t): &(usize, f64)| std::array::from_fn(|k| places[*i][k] + ways[*i].0[k] * t);
        let distances = field.distances(&live.iter().map(at).collect::<Vec<Vector>>());
        for ((i, t), d) in live.iter_mut().zip(distances) {
            least[*i] = least[*i].min((k * d / *t).clamp(0.0, 1.0));
            // Before that it cannot be darker than without a shadow.
            let free = (k * d - *t) / (k + 1.0) / STEEP;
            *t += free.max(FINE * *t / k);
        }
        live.retain(|(i, t)| *t < ways[*i].1 && least[*i] > 0.0);
    }
    least
}

/// How open the surroundings of a place of the surface are: `1 - occlusion * 2 / radius^2` times the integral of
/// `max(t - d(p + n * t), 0)` over `t` from 0 to `radius`, at least 0.
pub fn occlusion(field: &mut Probe, place: Vector, normal: Vector, occlusion: f64, radius: f64) -> f64 {
    const PARTS: usize = 1024;
    let width = radius / PARTS as f64;
    let at: Vec<f64> = (0..PARTS).map(|i| (i as f64 + 0.5) * width).collect();
    let distances = field.along(place, normal, &at);
    let covered: f64 = at.iter().zip(distances).map(|(t, d)| (t - d).max(0.0)).sum::<f64>() * width;
    (1.0 - occlusion * 2.0 / (radius * radius) * covered).max(0.0)
}

/// The integral of `max(1 - d / w, 0)^2 / w` over the part of a ray up to `limit`.
pub fn glow(field: &mut Probe, eye: Vector, direction: Vector, limit: f64, w: f64) -> f64 {
    const SAMPLES: usize = 64;
    let step = w / 256.0;
    let (mut t, mut sum) = (0.0, 0.0);
    while t < limit {
        let d = field.along(eye, direction, &[t])[0];
        if d > w + step {
            t += (d - w) / STEEP;
            continue;
        }
        let samples = ((limit - t) / step).ceil().clamp(1.0, SAMPLES as f64);
        let width = step.min((limit - t) / samples);
        let at: Vec<f64> = (0..samples as usize).map(|i| t + (i as f64 + 0.5) * width).collect();
        let bright = |d: f64| (1.0 - d / w).max(0.0).powi(2) / w;
        sum += field.along(eye, direction, &at).into_iter().map(bright).sum::<f64>() * width;
        t += width * samples;
    }
    sum
}
