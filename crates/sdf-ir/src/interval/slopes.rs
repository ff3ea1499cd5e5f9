//! How a value moves with the point, over a region: duals over intervals.

use super::bounds::Bounds;
use super::matrix::{largest_singular_value, norm_up};
use super::number::{Interval, product_up, sum_up};
use crate::constant::Constant;
use crate::program::Type;

/// How a value moves with the point: what is known of its Jacobian over a region. All of it holds at every place
/// where there is a Jacobian, so that between two points of the region, which must be convex, the value changes by
/// at most `norm` times their distance. Where it may jump, the bounds are infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slopes {
    /// The gradient of each component.
    gradients: [[Interval; 3]; 3],
    /// The largest norm of each component's gradient.
    norms: [f64; 3],
    /// The largest operator norm of the Jacobian.
    norm: f64,
    /// The largest norm of the gradient of the value's length.
    length: f64,
    /// The same for the length of the two components that are not this one.
    across: [f64; 3],
}

impl Slopes {
    /// Those of a value that does not depend on the point.
    pub const STEADY: Slopes = Slopes {
        gradients: [[Interval::ZERO; 3]; 3],
        norms: [0.0; 3],
        norm: 0.0,
        length: 0.0,
        across: [0.0; 3],
    };

    /// Those of a value of which nothing more is known than that it changes by at most `norm` times the distance.
    pub fn within(norm: f64) -> Slopes {
        let gradients = [[Interval::symmetric(norm); 3]; 3];
        Slopes { gradients, norms: [norm; 3], norm, length: norm, across: [norm; 3] }
    }

    /// Those of the point itself, or of its first components.
    pub fn identity(size: usize) -> Slopes {
        let mut rows = [[Interval::ZERO; 3]; 3];
        for (i, row) in rows.iter_mut().enumerate().take(size) {
            row[i] = Interval::ONE;
        }
        Slopes::of(size, rows, [1.0; 3], 1.0)
    }

    /// From bounds of different kinds, which are brought to agree.
    pub fn of(size: usize, mut gradients: [[Interval; 3]; 3], mut norms: [f64; 3], mut norm: f64) -> Slopes {
        for i in 0..size {
            let row = gradients[i].map(Interval::most);
            norms[i] = norms[i].min(norm_up(&row)).min(norm);
        }
        norm = norm.min(match size {
            1 => norms[0],
            _ => largest_singular_value(&gradients[..size], &norms[..size]),
        });
        for i in 0..3 {
            norms[i] = if i < size { norms[i].min(norm) } else { 0.0 };
            let most = Interval::symmetric(norms[i]);
            gradients[i] = gradients[i].map(|x| if i < size { x.intersect(most) } else { Interval::ZERO });
        }
        Slopes { gradients, norms, norm, length: norm, across: [norm; 3] }
    }

    /// The gradient of a component; a float stands for a vector of equal components.
    pub fn gradient(&self, i: usize) -> [Interval; 3] {
        self.gradients[i]
    }

    /// An upper bound of the norm of a component's gradient.
    pub fn norm_of(&self, i: usize) -> f64 {
        self.norms[i]
    }

    /// An upper bound of the operator norm of the Jacobian: a Lipschitz constant of the value.
    pub fn norm(&self) -> f64 {
        self.norm
    }

    /// A Lipschitz constant of the value's length.
    pub fn of_length(&self) -> f64 {
        self.length
    }

    /// A Lipschitz constant of the length of the two components of a vec3 that are not component `i`.
    pub fn of_across(&self, i: usize) -> f64 {
        self.across[i]
    }

    /// Whether the value is the same all over the region.
    pub fn is_steady(&self) -> bool {
        self.norm == 0.0
    }

    /// The gradient of each component, along x, y and z.
    pub fn gradients(&self) -> &[[Interval; 3]; 3] {
        &self.gradients
    }

    /// The same, when the value is also known to change by at most this times the distance.
    pub fn with_norm(self, size: usize, norm: f64) -> Slopes {
        if norm >= self.norm {
            return self;
        }
        Slopes::of(size, self.gradients, self.norms, norm).with_lengths(self.length, self.across)
    }

    /// The same, when the lengths are also known to change by at most this times the distance.
    pub(crate) fn with_lengths(mut self, length: f64, across: [f64; 3]) -> Slopes {
        self.length = self.length.min(length);
        self.across = std::array::from_fn(|i| self.across[i].min(across[i]));
        self
    }

    /// Those of a value that is one of these two at each point, and goes over from one to the other without a jump.
    pub(crate) fn either(&self, other: &Slopes) -> Slopes {
        Slopes {
            gradients: std::array::from_fn(|i| hull(self.gradients[i], other.gradients[i])),
            norms: std::array::from_fn(|i| self.norms[i].max(other.norms[i])),
            norm: self.norm.max(other.norm),
            length: self.length.max(other.length),
            across: std::array::from_fn(|i| self.across[i].max(other.across[i])),
        }
    }
}

/// `a + b`, of gradients.
pub(crate) fn sum(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|k| a[k].plus(b[k]))
}

/// `a - b`, of gradients.
pub(crate) fn difference(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|k| a[k].minus(b[k]))
}

/// A gradient times a number.
pub(crate) fn scaled(a: [Interval; 3], by: Interval) -> [Interval; 3] {
    a.map(|x| by.times(x))
}

fn hull(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|i| a[i].hull(b[i]))
}

/// What is known of a value over a region, and of how it moves with the point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sloped {
    /// Where the value lies.
    pub bounds: Bounds,
    /// How it moves.
    pub slopes: Slopes,
}

impl Sloped {
    /// A value that does not depend on the point.
    pub fn steady(bounds: Bounds) -> Sloped {
        Sloped { bounds, slopes: Slopes::STEADY }
    }

    /// One value alone.
    pub fn constant(c: Constant) -> Sloped {
        Sloped::steady(Bounds::constant(c))
    }

    /// The point itself, somewhere in a region: a vec3, or a vec2 of the plane.
    pub fn point(bounds: Bounds) -> Sloped {
        Sloped { bounds, slopes: Slopes::identity(bounds.size()) }
    }

    /// A value that changes by at most `norm` times the distance, in no known direction: a stand-in for a field.
    pub fn within(bounds: Bounds, norm: f64) -> Sloped {
        Sloped { bounds, slopes: Slopes::within(norm) }
    }

    /// A value of which nothing is known; it may jump.
    pub fn anything(ty: Type) -> Sloped {
        Sloped { bounds: Bounds::anything(ty), slopes: Slopes::within(f64::INFINITY) }
    }

    /// A Lipschitz constant of the value.
    pub fn norm(&self) -> f64 {
        self.slopes.norm()
    }

    /// Whether the value is the same all over the region.
    pub fn is_steady(&self) -> bool {
        self.slopes.is_steady()
    }

    /// The value, steady where it is one alone.
    pub(crate) fn new(bounds: Bounds, slopes: Slopes) -> Sloped {
        if bounds.is_point() { Sloped::steady(bounds) } else { Sloped { bounds, slopes } }
    }

    /// The norm of the Jacobians of several values as one.
    pub fn stacked_norm<'a>(values: impl IntoIterator<Item = &'a Sloped>) -> f64 {
        let mut rows: Vec<([Interval; 3], f64)> = Vec::new();
        let (mut sum, mut count, mut last) = (0.0, 0, 0.0);
        for value in values {
            let norm = value.norm();
            if norm == 0.0 {
                continue;
            }
            sum = sum_up(sum, product_up(norm, norm));
            (count, last) = (count + 1, norm);
            for i in 0..value.bounds.size() {
                rows.push((value.slopes.gradients[i], value.slopes.norms[i]));
            }
        }
        let apart = if count == 1 { last } else { super::number::root_up(sum) };
        if rows.len() > 3 || rows.is_empty() {
            return apart;
        }
        let (rows, norms): (Vec<[Interval; 3]>, Vec<f64>) = rows.into_iter().unzip();
        apart.min(largest_singular_value(&rows, &norms))
    }
}

/// An operand of a chain rule, and the derivative of the result by it, component by component.
pub(crate) struct Term<'a> {
    pub operand: &'a Sloped,
    /// The derivative of each component of the result by the operand's component, or by the float that it is.
    pub by: [Interval; 3],
}

/// `r' == Σ by·operand'`, for a result that is computed component by component.
pub(crate) fn chain(size: usize, terms: &[Term]) -> Slopes {
    let mut gradients = [[Interval::ZERO; 3]; 3];
    let (mut norms, mut norm) = ([0.0; 3], 0.0);
    for Term { operand, by } in terms {
        let (slopes, is_spread) = (&operand.slopes, operand.bounds.size() < size);
        for i in 0..size {
            let part = if is_spread { 0 } else { i };
            gradients[i] = sum(gradients[i], scaled(slopes.gradients[part], by[i]));
            norms[i] = sum_up(norms[i], product_up(by[i].most(), slopes.norms[part]));
        }
        let by = by.map(Interval::most);
        let factor = match is_spread {
            // by ⊗ gradient
            true => norm_up(&by[..size]),
            false => by[..size].iter().fold(0.0, |m: f64, x| m.max(*x)),
        };
        norm = sum_up(norm, product_up(factor, slopes.norm));
    }
    Slopes::of(size, gradients, norms, norm)
}
