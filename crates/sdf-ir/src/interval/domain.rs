//! What a walk computes of each value: where it lies, or also how it moves.

use super::bounds::Bounds;
use super::chain;
use super::number::{Interval, product_up};
use super::operations;
use super::rotation::{self, Turn};
use super::slopes::{Sloped, Slopes};
use crate::constant::Constant;
use crate::program::{Binary, Function, Type, Unary};

/// What a walk computes of each value: where it lies, or also how it moves.
pub trait Domain: Copy {
    /// A value that does not depend on the point.
    fn steady(bounds: &Bounds) -> Self;
    /// Where it lies.
    fn bounds(&self) -> &Bounds;
    /// One value alone.
    fn constant(c: Constant) -> Self;
    /// A value of which nothing is known.
    fn anything(ty: Type) -> Self;
    /// An operation on one value.
    fn unary(op: Unary, a: &Self) -> Self;
    /// An operation on two values; `same` says that they are one and the same.
    fn binary(op: Binary, a: &Self, b: &Self, same: bool) -> Self;
    /// `a*(1-t) + b*t`
    fn mix(a: &Self, b: &Self, t: &Self) -> Self;
    /// The vector of floats.
    fn compose(parts: &[&Self]) -> Self;
    /// A component of a vector.
    fn component(a: &Self, i: usize) -> Self;
    /// A vec2 that is those components of a vec3 that are not component `i`.
    fn pair_of(self, whole: &Self, i: usize) -> Self;
    /// What it is when it is also the same as another value.
    fn also(self, other: &Self) -> Self;
    /// The image of a rotation.
    fn turned(self, turn: &Turn<Self>) -> Self;
    /// One of two values, by an undecided condition. `is_continuous` says that they agree where that changes.
    fn either(condition: &Self, a: &Self, b: &Self, is_continuous: bool) -> Self;
    /// Whether the value certainly does not jump.
    fn is_continuous(&self) -> bool;
    /// Where the promise of a function makes a second look at its results worth while: the slopes that it promises
    /// for these arguments, and the arguments of the second look. See [`Function::lipschitz`].
    fn promised(function: &Function, lipschitz: f64, arguments: &[Self]) -> Option<Promised<Self>>;
    /// A result of a function that promises to move by at most this.
    fn with_norm(self, norm: f64) -> Self;
    /// How far it moves with the point: a Lipschitz constant.
    fn norm(&self) -> f64;
    /// Whether anything is known of how values move.
    const MOVES: bool;
    /// A number that moves as the first coordinate of the point does.
    fn variable(bounds: &Bounds) -> Self;
    /// How a number moves with the first coordinate of the point.
    fn slope_by_variable(&self) -> Interval;
}

/// What a function's promise says at a call.
pub struct Promised<D> {
    /// By how much the results move with the arguments that the promise is about.
    pub norm: f64,
    /// The arguments without those movements, where others move too.
    pub rest: Option<Vec<D>>,
}

impl Domain for Bounds {
    fn steady(bounds: &Bounds) -> Bounds {
        *bounds
    }

    fn bounds(&self) -> &Bounds {
        self
    }

    fn constant(c: Constant) -> Bounds {
        Bounds::constant(c)
    }

    fn anything(ty: Type) -> Bounds {
        Bounds::anything(ty)
    }

    fn unary(op: Unary, a: &Bounds) -> Bounds {
        operations::unary(op, a)
    }

    fn binary(op: Binary, a: &Bounds, b: &Bounds, same: bool) -> Bounds {
        operations::binary(op, a, b, same)
    }

    fn mix(a: &Bounds, b: &Bounds, t: &Bounds) -> Bounds {
        operations::mix(a, b, t)
    }

    fn compose(parts: &[&Bounds]) -> Bounds {
        operations::compose(parts)
    }

    fn component(a: &Bounds, i: usize) -> Bounds {
        Bounds::float(a.part(i))
    }

    fn pair_of(self, whole: &Bounds, i: usize) -> Bounds {
        self.with_length(whole.across(i))
    }

    fn also(self, other: &Bounds) -> Bounds {
        self.intersect(other)
    }

    fn turned(self, turn: &Turn<Bounds>) -> Bounds {
        rotation::bounds(self, turn.vector, turn.axis.as_ref())
    }

    fn either(_: &Bounds, a: &Bounds, b: &Bounds, _: bool) -> Bounds {
        a.hull(b)
    }

    fn is_continuous(&self) -> bool {
        true
    }

    fn promised(_: &Function, _: f64, _: &[Bounds]) -> Option<Promised<Bounds>> {
        None
    }

    fn with_norm(self, _: f64) -> Bounds {
        self
    }

    fn norm(&self) -> f64 {
        0.0
    }

    const MOVES: bool = false;

    fn variable(bounds: &Bounds) -> Bounds {
        *bounds
    }

    fn slope_by_variable(&self) -> Interval {
        Interval::ALL
    }
}

impl Domain for Sloped {
    fn steady(bounds: &Bounds) -> Sloped {
        Sloped::steady(*bounds)
    }

    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn constant(c: Constant) -> Sloped {
        Sloped::constant(c)
    }

    fn anything(ty: Type) -> Sloped {
        Sloped::anything(ty)
    }

    fn unary(op: Unary, a: &Sloped) -> Sloped {
        chain::unary(op, a)
    }

    fn binary(op: Binary, a: &Sloped, b: &Sloped, same: bool) -> Sloped {
        chain::binary(op, a, b, same)
    }

    fn mix(a: &Sloped, b: &Sloped, t: &Sloped) -> Sloped {
        chain::mix(a, b, t)
    }

    fn compose(parts: &[&Sloped]) -> Sloped {
        chain::compose(parts)
    }

    fn component(a: &Sloped, i: usize) -> Sloped {
        chain::component(a, i)
    }

    fn pair_of(self, whole: &Sloped, i: usize) -> Sloped {
        let slopes = self
            .slopes
            .with_norm(2, whole.norm())
            .with_lengths(whole.slopes.of_across(i), [f64::INFINITY; 3]);
        Sloped::new(self.bounds.pair_of(&whole.bounds, i), slopes)
    }

    fn also(self, other: &Sloped) -> Sloped {
        let slopes = if other.norm() < self.norm() { other.slopes } else { self.slopes };
        Sloped::new(self.bounds.intersect(&other.bounds), slopes)
    }

    fn turned(self, turn: &Turn<Sloped>) -> Sloped {
        rotation::slopes(&self, turn)
    }

    fn either(condition: &Sloped, a: &Sloped, b: &Sloped, is_continuous: bool) -> Sloped {
        let slopes = if is_continuous || condition.is_steady() {
            a.slopes.either(&b.slopes)
        } else {
            Slopes::within(f64::INFINITY)
        };
        Sloped::new(a.bounds.hull(&b.bounds), slopes)
    }

    fn is_continuous(&self) -> bool {
        self.norm() < f64::INFINITY
    }

    fn promised(function: &Function, lipschitz: f64, arguments: &[Sloped]) -> Option<Promised<Sloped>> {
        // Without a point among the parameters the promise is about all of them.
        let about_all = function.parameters.iter().all(|parameter| !parameter.point);
        let is_meant = |i: usize| about_all || function.parameters[i].point;
        let meant = arguments.iter().enumerate().filter(|(i, _)| is_meant(*i)).map(|(_, argument)| argument);
        let norm = product_up(lipschitz, Sloped::stacked_norm(meant));
        let others_move =
            arguments.iter().enumerate().any(|(i, argument)| !is_meant(i) && !argument.is_steady());
        let rest = others_move.then(|| {
            let still = |(i, argument): (usize, &Sloped)| {
                if is_meant(i) { Sloped::steady(argument.bounds) } else { *argument }
            };
            arguments.iter().enumerate().map(still).collect()
        });
        Some(Promised { norm, rest })
    }

    fn with_norm(self, norm: f64) -> Sloped {
        Sloped::new(self.bounds, self.slopes.with_norm(self.bounds.size(), norm))
    }

    fn norm(&self) -> f64 {
        self.slopes.norm()
    }

    const MOVES: bool = true;

    fn variable(bounds: &Bounds) -> Sloped {
        Sloped { bounds: *bounds, slopes: Slopes::identity(1) }
    }

    fn slope_by_variable(&self) -> Interval {
        self.slopes.gradient(0)[0]
    }
}
