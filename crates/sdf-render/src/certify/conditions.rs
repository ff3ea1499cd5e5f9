//! A field as the greatest of several, each of which is a condition that holds where it is not positive: it has no zero
//! in a ball where one condition stays positive, or a sum of some of them with weights that are not negative.
//!
//! At an edge, where two faces meet, neither is positive all over a region round it, and the gradient of their maximum
//! is anything between both; a weighted sum is as smooth as they are.

use super::{Vector, dot, length, moved};
use sdf_ir::interval::{Bounds, Interval, Sloped, Walker};
use sdf_ir::{Binary, Builder, Function, Node, Program, Unary, Value, rebuild};
use std::sync::Arc;

/// How many conditions are taken into account for one region: those that promise most.
const MOST: usize = 4;
/// How many conditions are summed up, at most: a corner of space is where three meet.
const SUMMED: usize = 3;

/// The numbers whose maximum a field is where `is_outside`, and whose maximum its negative is elsewhere, as the results
/// of one function of the same parameters.
pub fn conditions(program: &Program, field: &Function, is_outside: bool) -> Function {
    let mut builder = Builder::new("conditions", Vec::new());
    let arguments: Vec<Value> =
        field.parameters.iter().map(|parameter| builder.add_parameter(parameter.clone())).collect();
    let roots = builder.inline(field, &arguments);
    // Each with whether its negative is meant.
    let mut waiting: Vec<(Value, bool)> = roots.into_iter().map(|value| (value, !is_outside)).collect();
    let mut results = Vec::new();
    while let Some((value, is_negated)) = waiting.pop() {
        match (builder.node(value), is_negated) {
            (Node::Binary(Binary::Max, a, b), false) | (Node::Binary(Binary::Min, a, b), true) => {
                waiting.extend([(b, is_negated), (a, is_negated)]);
            }
            (Node::Unary(Unary::Negate, a), _) => waiting.push((a, !is_negated)),
            (Node::Call(callee, list), _) if program.function(callee).root().results.len() == 1 => {
                let arguments = builder.function().list(list).to_vec();
                let inlined = builder.inline(program.function(callee), &arguments);
                waiting.extend(inlined.into_iter().map(|value| (value, is_negated)));
            }
            (_, false) => results.push((value, Arc::from("condition"))),
            (_, true) => results.push((builder.unary(Unary::Negate, value), Arc::from("condition"))),
        }
    }
    // The calls that were written out are dead now.
    rebuild(&builder.finish(results))
}

/// The weights, none of them negative, of up to three gradients with which their sum's products with each of the
/// gradients are these values; nothing if there are none, or the gradients depend on each other.
pub fn weights(gradients: &[Vector], values: &[f64]) -> Option<[f64; SUMMED]> {
    let n = gradients.len();
    // The normal equations, by Gauss.
    let mut rows = [[0.0; SUMMED + 1]; SUMMED];
    for i in 0..n {
        for j in 0..n {
            rows[i][j] = dot(gradients[i], gradients[j]);
        }
        rows[i][SUMMED] = values[i];
    }
    for i in 0..n {
        let least = 1e-12 * dot(gradients[i], gradients[i]);
        if rows[i][i].is_nan() || rows[i][i] <= least {
            return None;
        }
        for j in i + 1..n {
            let factor = rows[j][i] / rows[i][i];
            rows[j] = std::array::from_fn(|k| rows[j][k] - factor * rows[i][k]);
        }
    }
    let mut weights = [0.0; SUMMED];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| rows[i][j] * weights[j]).sum();
        weights[i] = (rows[i][SUMMED] - known) / rows[i][i];
    }
    weights.iter().all(|weight| *weight >= 0.0).then_some(weights)
}

/// A linear function that a condition is not below anywhere in a region.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linear {
    /// Its value at the centre of a ball, which need not lie in the region.
    at_center: f64,
    gradient: Vector,
}

impl Linear {
    /// For a region round a middle, by the condition's value in the middle and its gradient all over it; nothing where
    /// the gradient has no bound.
    pub fn below(
        here: Interval,
        gradient: [Interval; 3],
        middle: Vector,
        half: Vector,
        center: Vector,
    ) -> Option<Linear> {
        if !here.is_finite() || gradient.iter().any(|slope| !slope.is_finite()) {
            return None;
        }
        let slope = gradient.map(Interval::middle);
        let to_center = moved(center, middle, -1.0);
        // By how much the gradient may differ from its middle, along the way from the middle of the region.
        let spread: f64 = (0..3).map(|i| gradient[i].width() / 2.0 * half[i]).sum();
        let rounding = 1e-12 * (length(slope) * (length(to_center) + length(half)) + spread + here.most());
        let at_center = here.lo + dot(slope, to_center) - spread - rounding;
        Some(Linear { at_center, gradient: slope })
    }

    /// How far the centre is from where it vanishes: negative if the centre is not on the positive side.
    fn distance(&self) -> f64 {
        let steepness = length(self.gradient);
        if steepness > 0.0 { self.at_center / steepness } else { self.at_center * f64::INFINITY }
    }
}

/// Whether no point within `radius` of the centre makes all of these linear functions not positive. Where the
/// nearest point that does lies on those that a sum is made of, the weights by which one comes to it from the centre
/// prove it (Boyd and Vandenberghe, "Convex Optimization", 5.8, theorems of alternatives).
pub(super) fn exclude_ball(mut linears: Vec<Linear>, radius: f64) -> bool {
    linears.retain(|linear| linear.distance() > 0.0);
    linears.sort_by(|a, b| b.distance().total_cmp(&a.distance()));
    linears.truncate(MOST);
    (1..1usize << linears.len()).any(|chosen| {
        let is_chosen = |i: &usize| chosen >> i & 1 == 1;
        let of = |i: usize| (linears[i].gradient, linears[i].at_center);
        let (gradients, values): (Vec<Vector>, Vec<f64>) =
            (0..linears.len()).filter(is_chosen).map(of).unzip();
        if gradients.len() > SUMMED {
            return false;
        }
        // What changes nowhere needs no weight.
        if gradients == [[0.0; 3]] {
            return true;
        }
        let Some(weights) = weights(&gradients, &values) else { return false };
        let sum = gradients.iter().zip(weights).fold([0.0; 3], |sum, (g, weight)| moved(sum, *g, weight));
        let at_center: f64 = values.iter().zip(weights).map(|(value, weight)| value * weight).sum();
        at_center > radius * length(sum) * (1.0 + 1e-12)
    })
}

/// The conditions of a field on one side of it, asked by one thread.
pub(super) struct Conditions<'p> {
    values: Walker<'p, Bounds>,
    slopes: Walker<'p, Sloped>,
}

impl<'p> Conditions<'p> {
    pub fn new(
        program: &'p Program,
        conditions: &'p Function,
        uniforms: &[Bounds],
        globals: &[Bounds],
    ) -> Conditions<'p> {
        Conditions {
            values: Walker::new(program, conditions, uniforms, globals),
            slopes: Walker::new(program, conditions, uniforms, globals),
        }
    }

    /// Whether at each point of a box round `middle` that lies in the ball some condition is positive, as far as their
    /// gradients tell.
    pub fn exclude(&mut self, region: Bounds, middle: Vector, half: Vector, ball: (Vector, f64)) -> bool {
        let moving = self.slopes.run(&[Sloped::point(region)]);
        if moving.iter().any(|condition| condition.bounds.number().lo > 0.0) {
            return true;
        }
        let here = self.values.run(&[Bounds::between(middle, middle)]);
        let linear = |(moving, here): (&Sloped, &Bounds)| {
            Linear::below(here.number(), moving.slopes.gradient(0), middle, half, ball.0)
        };
        exclude_ball(moving.iter().zip(here).filter_map(linear).collect(), ball.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(at_center: f64, gradient: Vector) -> Linear {
        Linear { at_center, gradient }
    }

    #[test]
    fn one_condition_keeps_off_a_ball_that_it_does_not_touch() {
        let face = linear(1.0, [0.0, 2.0, 0.0]);
        assert!(exclude_ball(vec![face], 0.4999));
        assert!(!exclude_ball(vec![face], 0.5001));
        assert!(exclude_ball(vec![linear(1.0, [0.0; 3])], 1e9));
        assert!(!exclude_ball(vec![linear(-1.0, [0.0; 3])], 0.1));
    }

    #[test]
    fn the_edge_of_two_faces_is_farther_than_either_face() {
        let faces = vec![linear(1.0, [1.0, 0.0, 0.0]), linear(1.0, [0.0, 1.0, 0.0])];
        let distance = 2.0f64.sqrt();
        assert!(exclude_ball(faces.clone(), distance - 1e-9));
        assert!(!exclude_ball(faces, distance + 1e-9));
    }

    #[test]
    fn the_corner_of_three_faces_is_farther_than_their_edges() {
        let faces: Vec<Linear> =
            (0..3).map(|i| linear(1.0, std::array::from_fn(|axis| f64::from(u8::from(axis == i))))).collect();
        let distance = 3.0f64.sqrt();
        assert!(exclude_ball(faces.clone(), distance - 1e-9));
        assert!(!exclude_ball(faces, distance + 1e-9));
    }

    #[test]
    fn faces_at_an_obtuse_angle_are_met_on_one_of_them() {
        // The corner lies beyond where the nearest point of the first face is: the second keeps nothing off.
        let faces = vec![linear(1.0, [1.0, 0.0, 0.0]), linear(0.1, [1.0, 1.0, 0.0])];
        assert!(exclude_ball(faces.clone(), 1.0 - 1e-9));
        assert!(!exclude_ball(faces, 1.0 + 1e-9));
    }
}
