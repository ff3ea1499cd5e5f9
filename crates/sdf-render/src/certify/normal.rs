//! The normals that a surface has near a point.
//!
//! Off creases there is one; on a crease there is one for each side, and any of them is right.

use super::{Prover, Vector, dot, length, moved};
use sdf_ir::interval::{Bounds, Interval};

/// A surface is smooth where its normal turns by at most this, in degrees.
const SMOOTH: f64 = 0.1;

/// What is known of the normals within a ball.
#[derive(Debug, Clone, PartialEq)]
pub struct Normal {
    /// Whether the normal certainly turns by less than 0.1 degrees in the ball: it is not on a crease, and its curvature
    /// is small.
    pub is_smooth: bool,
    /// Normals of length 1 in the ball, that at its centre first; none where the gradient vanishes.
    pub samples: Vec<Vector>,
}

impl Prover<'_> {
    /// The normals within `radius` of a point: the gradient's direction at the centre and at points round it, in `f64`,
    /// and whether its enclosure over the whole ball is narrow.
    pub fn normal(&mut self, center: Vector, radius: f64) -> Normal {
        let Some(field) = &mut self.field else {
            return Normal { is_smooth: false, samples: Vec::new() };
        };
        let side = |i: usize| Interval::point(center[i]).widened_by(radius);
        let (_, slopes) = field.moving_over(Bounds::vector(&[side(0), side(1), side(2)]));
        let is_smooth = turn_of(slopes.gradient(0)) <= SMOOTH;
        let places = if is_smooth { vec![center] } else { places_round(center, radius) };
        Normal { is_smooth, samples: self.normals_at(&places) }
    }

    /// The least angle, in degrees, between a vector and the normals in a ball round a place on a crease: from the nearest of
    /// all over the ball, a search closer and closer round the nearest so far. Close beside an edge normals turn from those of
    /// one side to those of the other within a sliver of the ball, which the first places must find.
    pub(super) fn least_angle(&mut self, center: Vector, radius: f64, found: Vector) -> f64 {
        let (mut best, mut least) = (center, 180.0);
        let mut reach = radius;
        for round in 0..ROUNDS {
            let mut places = places_in(best, reach, if round == 0 { 1024 } else { 64 });
            places.retain(|place| length(moved(*place, center, -1.0)) <= radius);
            for place in places {
                let angle = self.normals_at(&[place]).first().map_or(180.0, |normal| angle(*normal, found));
                if angle < least {
                    (best, least) = (place, angle);
                }
            }
            reach *= 0.6;
        }
        least
    }

    /// The gradient's direction at points, in `f64`; those are left out where it vanishes.
    pub(super) fn normals_at(&mut self, places: &[Vector]) -> Vec<Vector> {
        let Some(machine) = &mut self.gradient else { return Vec::new() };
        let inputs: [Vec<f64>; 3] = std::array::from_fn(|i| places.iter().map(|place| place[i]).collect());
        let mut outputs = vec![vec![0.0; places.len()]; 4];
        let mut slices: Vec<&mut [f64]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
        machine.run(&inputs.each_ref().map(Vec::as_slice), &mut slices);
        let gradient = |i: usize| [outputs[1][i], outputs[2][i], outputs[3][i]];
        (0..places.len()).map(gradient).filter(|g| length(*g) > 0.0).map(unit).collect()
    }
}

impl Normal {
    /// The least angle between a vector and one of the normals, in degrees; 180 where there is none.
    pub fn angle_to(&self, found: Vector) -> f64 {
        let angles = self.samples.iter().map(|normal| angle(*normal, found));
        angles.fold(180.0, f64::min)
    }
}

/// The angle between two vectors, in degrees (William Kahan, "How Futile are Mindless Assessments of Roundoff in
/// Floating-Point Computation?", 2006).
fn angle(a: Vector, b: Vector) -> f64 {
    let (a, b) = (unit(a), unit(b));
    let (sum, difference) = (moved(a, b, 1.0), moved(a, b, -1.0));
    2.0 * length(difference).atan2(length(sum)).to_degrees()
}

fn unit(a: Vector) -> Vector {
    let length = length(a);
    a.map(|x| x / length)
}

/// By how many degrees a gradient within these bounds may turn, at most.
fn turn_of(gradient: [Interval; 3]) -> f64 {
    let middle = gradient.map(Interval::middle);
    let spread = length(gradient.map(|x| x.width() / 2.0));
    let share = spread / dot(middle, middle).sqrt();
    if share < 1.0 { 2.0 * share.asin().to_degrees() } else { 180.0 }
}

/// How often the search for a normal on a crease becomes closer.
const ROUNDS: usize = 18;

/// So many points all over a ball: in directions along a spiral, at distances that fill it evenly (Richard Swinbank, R. James
/// Purser, "Fibonacci grids", 2006; Martin Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
fn places_in(center: Vector, radius: f64, count: usize) -> Vec<Vector> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let place = |i: usize| {
        let height = 1.0 - (2 * i + 1) as f64 / count as f64;
        let (across, turn) = ((1.0 - height * height).sqrt(), golden * i as f64);
        // Beside each other in direction, far from each other in distance.
        let share = (0.754_877_666_246_692_7 * i as f64).fract().cbrt();
        moved(center, [across * turn.cos(), height, across * turn.sin()], radius * share)
    };
    (0..count).map(place).collect()
}

/// A ball's centre, and points half way out and at its surface, in the directions of a cube's faces and corners.
fn places_round(center: Vector, radius: f64) -> Vec<Vector> {
    let mut places = vec![center];
    for direction in directions() {
        for share in [0.5, 1.0] {
            places.push(moved(center, direction, radius * share));
        }
    }
    places
}

/// The directions of a cube's faces and corners, of length 1.
pub(super) fn directions() -> impl Iterator<Item = Vector> {
    let faces = (0..6)
        .map(|i| std::array::from_fn(|axis| if axis == i / 2 { 1.0 - 2.0 * (i % 2) as f64 } else { 0.0 }));
    let corners = (0..8).map(|i| unit(std::array::from_fn(|axis| 1.0 - 2.0 * (i >> axis & 1) as f64)));
    faces.chain(corners)
}
