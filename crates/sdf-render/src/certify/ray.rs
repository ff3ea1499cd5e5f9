//! A ray, and the boxes round its parts.

use super::{Vector, moved};
use sdf_ir::interval::{Bounds, Interval, Sloped, Slopes};

/// Eight times the distance of two neighbouring `f32`, for a number of magnitude 1: what rounding may do to a coordinate.
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64 / 2.0;

/// A ray through a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// The eye.
    pub origin: Vector,
    /// Of length 1, up to rounding.
    pub direction: Vector,
    /// How far the ray goes.
    pub far: f64,
    /// How near to a surface a hit may be at the origin.
    pub width: f64,
    /// How much farther from it for each unit of length along the ray.
    pub tolerance: f64,
}

impl Ray {
    /// The point at a distance along the ray.
    pub fn at(&self, t: f64) -> Vector {
        moved(self.origin, self.direction, t)
    }

    /// How near to a surface a hit at distance `t` must be: a share of a pixel, and at least what the rounding of `f32`
    /// does to the coordinates there.
    pub fn radius(&self, t: f64) -> f64 {
        self.share(t).max(self.rounding(t))
    }

    /// The share of a pixel that a hit at distance `t` may be off.
    pub fn share(&self, t: f64) -> f64 {
        self.width + self.tolerance * t
    }

    /// Eight units in the last place of the largest `f32` that the point at distance `t` is computed with.
    pub fn rounding(&self, t: f64) -> f64 {
        ROUNDING * self.scale(t)
    }

    /// The largest magnitude that the point at distance `t` is computed with.
    pub(super) fn scale(&self, t: f64) -> f64 {
        self.origin.iter().chain(&self.at(t)).fold(t.abs(), |most, x| most.max(x.abs()))
    }

    /// A box that holds the points from distance `from` to `to`, in exact arithmetic.
    pub(super) fn part(&self, from: f64, to: f64) -> Bounds {
        let t = Interval::new(from, to);
        let coordinate = |i: usize| Interval::point(self.origin[i]).plus(t.scaled(self.direction[i]));
        Bounds::vector(&[coordinate(0), coordinate(1), coordinate(2)])
    }

    /// The same points, which move with the distance along the ray as with a first coordinate.
    pub(super) fn moving_part(&self, from: f64, to: f64) -> Sloped {
        let mut gradients = [[Interval::ZERO; 3]; 3];
        for (gradient, d) in gradients.iter_mut().zip(self.direction) {
            gradient[0] = Interval::point(d);
        }
        let slopes = Slopes::of(3, gradients, [f64::INFINITY; 3], f64::INFINITY);
        Sloped { bounds: self.part(from, to), slopes }
    }
}
