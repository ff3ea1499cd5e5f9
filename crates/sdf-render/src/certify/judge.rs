//! What a renderer found at a pixel, against the truth.

use super::first_hit::Truth;
use super::ray::Ray;
use super::{BUDGET, Prover, dot};

/// How much later than the first zero a hit may be: this many tolerances, measured along the normal.
const LATE: f64 = 2.0;
/// From what angle on, in degrees, a normal on a crease is worth a closer search.
const CLOSE: f64 = 0.05;
/// From what cosine between ray and normal on a surface clearly faces the eye, or clearly does not.
const HIDDEN: f64 = 0.1;
/// From what cosine on two normals are those of both sides of a sheet.
const OPPOSITE: f64 = 0.9;
/// How much of what is allowed the enclosure of the first zero may be wide.
const WIDE: f64 = 0.1;

/// What a renderer found at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The distance along the ray; -1 where there is nothing.
    pub depth: f32,
    /// The surface's normal there.
    pub normal: [f32; 3],
    /// Whether the steps were too few to tell.
    pub lost: bool,
}

/// How a pixel is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// There is nothing, as was found.
    RightMiss,
    /// The ray meets the surface where it was found, or passes it within the tolerance there.
    RightHit {
        /// How far the hit is from the first zero, in tolerances along the normal: the distance times the cosine between
        /// ray and normal, over the tolerance there ([`Ray::radius`]). `None` for one that the ray meets before it certainly meets the
        /// surface.
        late: Option<f64>,
        /// The angle between the normal that was found and the surface's, in degrees; on a crease, the nearest of those
        /// of its sides.
        normal: f64,
        /// Whether the surface certainly is smooth there.
        is_smooth: bool,
    },
    /// There is no zero of the field within the tolerance of where a hit was found.
    FalseHit,
    /// The ray certainly meets the surface, and nothing was found, or only what lies behind.
    FalseMiss,
    /// The truth is not known closely enough.
    Ambiguous,
    /// The steps were too few to tell.
    OutOfSteps,
    /// What was found is not a finite number.
    NotFinite,
}

impl Prover<'_> {
    /// Judges what was found at a pixel whose ray's truth this is.
    pub fn judge(&mut self, ray: &Ray, truth: &Truth, found: &Found) -> Verdict {
        if !found.depth.is_finite() || found.normal.iter().any(|x| !x.is_finite()) {
            Verdict::NotFinite
        } else if found.lost {
            Verdict::OutOfSteps
        } else if found.depth < 0.0 {
            self.judge_miss(ray, truth)
        } else {
            self.judge_hit(ray, truth, found)
        }
    }

    fn judge_miss(&mut self, ray: &Ray, truth: &Truth) -> Verdict {
        match *truth {
            Truth::Miss => Verdict::RightMiss,
            Truth::Ambiguous { .. } => Verdict::Ambiguous,
            // At the end of the ray rounding decides.
            Truth::Hit { near, .. } if near >= ray.far - ray.rounding(ray.far) => Verdict::RightMiss,
            Truth::Hit { .. } => Verdict::FalseMiss,
        }
    }

    fn judge_hit(&mut self, ray: &Ray, truth: &Truth, found: &Found) -> Verdict {
        let depth = f64::from(found.depth);
        let radius = ray.radius(depth);
        let Truth::Hit { near, far } = *truth else {
            return match (self.contains_zero(ray.at(depth), radius, BUDGET), truth) {
                (Some(false), _) => Verdict::FalseHit,
                (Some(true), Truth::Miss) => self.right_hit(ray, None, found),
                _ => Verdict::Ambiguous,
            };
        };
        let cosine = self.cosine(ray, far);
        let allowed = (LATE * ray.share(depth) / cosine).max(ray.rounding(depth));
        if depth > far + allowed {
            return Verdict::FalseMiss;
        }
        // The first zero is as far away as this, at most.
        let apart = (depth - near).abs().max((far - depth).abs());
        if apart > radius {
            match self.contains_zero(ray.at(depth), radius, BUDGET) {
                Some(true) => {}
                Some(false) => return Verdict::FalseHit,
                None => return Verdict::Ambiguous,
            }
        }
        if depth < near - allowed {
            return self.right_hit(ray, None, found);
        }
        if far - near > WIDE * allowed {
            return Verdict::Ambiguous;
        }
        match self.right_hit(ray, Some(apart * cosine / radius), found) {
            Verdict::RightHit { late, is_smooth, .. } if self.is_other_side(ray, far, found) => {
                Verdict::RightHit { late, normal: 180.0, is_smooth }
            }
            verdict => verdict,
        }
    }

    /// Whether a normal is that of the other side of something thin, which the eye does not see.
    fn is_other_side(&mut self, ray: &Ray, first_zero: f64, found: &Found) -> bool {
        let seen = found.normal.map(f64::from);
        let front = self.normals_at(&[ray.at(first_zero)]);
        let is_front = |normal: &[f64; 3]| dot(*normal, ray.direction) < -HIDDEN;
        dot(seen, ray.direction) > HIDDEN
            && !front.is_empty()
            && front.iter().all(|normal| is_front(normal) && dot(*normal, seen) < -OPPOSITE)
    }

    fn right_hit(&mut self, ray: &Ray, late: Option<f64>, found: &Found) -> Verdict {
        let depth = f64::from(found.depth);
        let (place, radius) = (ray.at(depth), ray.radius(depth));
        let normal = self.normal(place, radius);
        let seen = found.normal.map(f64::from);
        // From inside, the surface is seen with its normal towards the eye.
        let is_turned = dot(seen, ray.direction) < 0.0;
        let of_samples = |seen: [f64; 3]| normal.angle_to(seen);
        let mut angle = of_samples(seen);
        if is_turned {
            angle = angle.min(of_samples(seen.map(|x| -x)));
        }
        if !normal.is_smooth && angle > CLOSE {
            angle = angle.min(self.least_angle(place, radius, seen));
        }
        Verdict::RightHit { late, normal: angle, is_smooth: normal.is_smooth }
    }

    /// The cosine of the angle between a ray and the normal where it meets the surface; 1 where there is no normal.
    fn cosine(&mut self, ray: &Ray, t: f64) -> f64 {
        let normals = self.normals_at(&[ray.at(t)]);
        normals.first().map_or(1.0, |normal| dot(*normal, ray.direction).abs())
    }
}
