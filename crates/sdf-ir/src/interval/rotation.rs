//! What turning a vector keeps: its length, and all that lies along the axis.

use super::bounds::Bounds;
use super::matrix::norm_up;
use super::number::{Interval, above, product_up, root_up, sum_up};
use super::operations;
use super::slopes::{Sloped, Slopes};
use crate::program::{Binary, Type, Unary};

/// A vector, the axis that it is turned about (of any length; a vec2 has none), and the angle.
pub struct Turn<'a, D> {
    pub vector: &'a D,
    pub axis: Option<D>,
    pub angle: Angle<&'a D>,
}

/// What is known of the axis of a rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Axis<V> {
    /// It points this way.
    Fixed([f64; 3]),
    /// It is this value.
    Of(V),
}

/// What is known of the angle of a rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Angle<V> {
    /// It is this value.
    Of(V),
    /// It depends on nothing that the function takes.
    Steady,
    /// Nothing.
    Unknown,
}

/// The relative error of a rotation that is computed in `f64`, generously.
const ERROR: f64 = 1e-14;

fn with_error(x: Interval, size: f64) -> Interval {
    x.widened_by(product_up(size, ERROR))
}

/// The coordinate axis that a vector certainly points along, either way.
fn coordinate_axis(axis: &Bounds) -> Option<usize> {
    let parts = axis.parts();
    (0..3).find(|i| parts[*i].least() > 0.0 && (0..3).all(|j| j == *i || parts[j].is_zero()))
}

/// What the image has from the vector.
pub(crate) fn bounds(image: Bounds, vector: &Bounds, axis: Option<&Bounds>) -> Bounds {
    let length = vector.length();
    let mut image = image.with_length(with_error(length, length.hi));
    if let Some(i) = axis.and_then(coordinate_axis) {
        image = image.with_across(i, with_error(vector.across(i), vector.across(i).hi));
        image = image.with_part(i, with_error(vector.part(i), vector.part(i).most()));
    }
    image
}

/// The same for how it moves.
pub(crate) fn slopes(image: &Sloped, turn: &Turn<Sloped>) -> Sloped {
    let axis = turn.axis.as_ref().map(|axis| &axis.bounds);
    let bounds = bounds(image.bounds, &turn.vector.bounds, axis);
    if image.is_steady() {
        return Sloped::steady(bounds);
    }
    let (vector, size) = (turn.vector, bounds.size());
    let is_axis_steady = turn.axis.is_none_or(|axis| axis.is_steady());
    let mut slopes = image.slopes;
    if is_axis_steady && (size == 2 || turn.axis.is_some()) {
        let norm = match turn.angle {
            Angle::Of(angle) if !angle.is_steady() => turned_norm(vector, axis, angle),
            Angle::Of(_) | Angle::Steady => vector.norm(),
            Angle::Unknown => f64::INFINITY,
        };
        slopes = slopes.with_norm(size, norm);
    }
    let mut across = [f64::INFINITY; 3];
    if let Some(i) = axis.and_then(coordinate_axis).filter(|_| is_axis_steady) {
        across[i] = vector.slopes.of_across(i);
    }
    Sloped::new(bounds, slopes.with_lengths(vector.slopes.of_length(), across))
}

/// The norm of `R(θ)·(J + u gᵀ)`, where J is the vector's Jacobian, g the gradient of θ and u = axis × vector: at
/// most `|J| + |u||g|`. Where J is orthogonal, the norm of `1 + u hᵀ` with h = J g: its two singular values other
/// than 1 have the product `|1 + u·h|` and the sum of squares `2 + 2u·h + a²`, a = |u||g|, so that the larger one is
/// `(a + √(a² + 4(1 + u·h))) / 2`.
fn turned_norm(vector: &Sloped, axis: Option<&Bounds>, angle: &Sloped) -> f64 {
    let (arm, direction) = match axis {
        None => {
            let [x, y] = [vector.bounds.part(0), vector.bounds.part(1)];
            let arm = Bounds::vector(&[y.negated(), x, Interval::ZERO]).with_length(vector.bounds.length());
            (arm, Bounds::vector(&[Interval::ZERO, Interval::ZERO, Interval::ONE]))
        }
        Some(axis) => {
            let direction = operations::unary(Unary::Normalize, axis);
            let mut arm = operations::binary(Binary::Cross, &direction, &vector.bounds, false);
            if let Some(i) = coordinate_axis(axis) {
                arm = arm.with_length(vector.bounds.across(i));
            }
            (arm, direction)
        }
    };
    let a = product_up(arm.length().hi, angle.norm());
    let rough = sum_up(vector.norm(), a);
    let Some((h, error)) = carried(vector, &angle.slopes) else { return rough };
    // Only what is across the axis counts, as u is.
    let h = Bounds::vector(&h);
    let along = operations::binary(Binary::Dot, &h, &direction, false);
    let part = operations::binary(Binary::Multiply, &direction, &along, false);
    let across = operations::binary(Binary::Subtract, &h, &part, false);
    let b = operations::binary(Binary::Dot, &arm, &across, false).number().hi;
    let b = sum_up(b, product_up(a, error)).min(a);
    let square = sum_up(product_up(a, a), product_up(4.0, sum_up(1.0, b)));
    let norm = above(sum_up(a, root_up(square.max(0.0))) / 2.0).max(1.0);
    rough.min(sum_up(norm, error))
}

/// `J g` for a Jacobian J of the vector that is orthogonal up to an error, and that error.
fn carried(vector: &Sloped, angle: &Slopes) -> Option<([Interval; 3], f64)> {
    let (rows, g) = (vector.slopes.gradients(), angle.gradient(0));
    if vector.bounds.ty() == Type::Vec2 {
        // Of the plane: the point itself, and an angle that depends on it alone.
        let is_point = *rows == *Slopes::identity(2).gradients();
        return (is_point && g[2].is_zero()).then_some((g, 0.0));
    }
    if rows.iter().flatten().chain(&g).any(|x| !x.is_finite()) {
        return None;
    }
    let dot = |a: &[Interval; 3], b: &[Interval; 3]| {
        (0..3).fold(Interval::ZERO, |sum, k| sum.plus(a[k].times(b[k])))
    };
    // |J - Q| is at most |J Jᵀ - 1| for the nearest orthogonal Q.
    let mut off = [0.0; 9];
    for i in 0..3 {
        for j in 0..3 {
            let identity = Interval::point(f64::from(u8::from(i == j)));
            off[3 * i + j] = dot(&rows[i], &rows[j]).minus(identity).most();
        }
    }
    let error = norm_up(&off);
    (error < 1e-6).then(|| (std::array::from_fn(|i| dot(&rows[i], &g)), error))
}
