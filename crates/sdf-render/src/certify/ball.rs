//! Whether there is a zero of the field in a ball, certainly, and so whether a step is safe.
//!
//! A box round the ball is halved until the field certainly has no zero in any part, by its interval there, by what its
//! slopes let it change from the middle (no Lipschitz constant is taken from anywhere else) or by the
//! [conditions](super::conditions) of which it is the greatest, or until a point is found at which it has another sign
//! than at the centre.

use super::conditions::{Linear, exclude_ball};
use super::field::{Field, sign};
use super::{Prover, Vector, dot, length, moved, normal, run};
use sdf_ir::eval::Machine;
use sdf_ir::interval::{Bounds, Interval, Slopes};

/// How often the field is evaluated for one ball, at most, where nothing else is said.
pub(super) const BUDGET: u64 = 1000;
/// How often a point is moved to where the field would vanish if it were linear: once is enough for a distance.
const DESCENTS: usize = 8;
/// The share of a step that must be free: what is left is for rounding.
const SHARE: f64 = 0.99;
/// The shares of a step that are tried where that much is not free.
const SMALLER: [f64; 4] = [0.9, 0.75, 0.5, 0.25];

/// What is certain about a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// There is no zero within 0.99 of it.
    Safe,
    /// There is one within 0.99 of it; within this share of it there is none, 0 if nothing smaller was proved.
    Unsafe(f64),
    /// It cannot be told; within this share of it there is none.
    Undecided(f64),
}

impl Step {
    /// The share of the step that certainly is free.
    pub fn free_share(self) -> f64 {
        match self {
            Step::Safe => SHARE,
            Step::Unsafe(share) | Step::Undecided(share) => share,
        }
    }
}

impl Prover<'_> {
    /// Whether the field has a zero within `radius` of a point; `None` where it cannot be told with about so many
    /// evaluations. A value that is zero up to the rounding of `f64` is one.
    pub fn contains_zero(&mut self, center: Vector, radius: f64, budget: u64) -> Option<bool> {
        let uphill = self.normals_at(&[center]).pop();
        let field = self.field.as_mut()?;
        let here = Bounds::between(center, center);
        let value = field.over(here);
        // A condition that rounding leaves open makes the value that of both its branches.
        let value = if sign(value).is_none() { field.over_by_cases(here) } else { value };
        let rounding = rounding(center, radius);
        match sign(value) {
            None if value.most() <= rounding => Some(true),
            None => None,
            Some(side) => {
                let gradient = self.gradient.as_mut();
                let mut ball = Ball { field, gradient, center, radius, side, value, uphill };
                let answer = ball.contains_zero(budget);
                ball.field.stay_within(&None);
                answer
            }
        }
    }

    /// The length of the step that the march may take from a point: negative inside.
    pub fn stride(&mut self, place: Vector) -> f64 {
        let [_, stride] = run(&mut self.step, &place);
        stride
    }

    /// Whether the field is positive at a point; `None` where rounding leaves it open.
    pub fn is_outside(&mut self, place: Vector) -> Option<bool> {
        sign(self.field.as_mut()?.over_by_cases(Bounds::between(place, place)))
    }

    /// The ball that must hold no surface for the step that the march may take from a point to be safe, in whatever
    /// direction it is taken: its centre and its radius. The march asks at points in `f32`, so the point is rounded to
    /// them. There is none, and the step is safe, where it is less than their distance.
    pub fn ball_of_step(&mut self, place: Vector) -> Option<(Vector, f64)> {
        let place = place.map(|x| f64::from(x as f32));
        let stride = self.stride(place).abs();
        let least = place.iter().fold(0.0f64, |most, x| most.max(x.abs())) * f64::from(f32::EPSILON);
        (self.field.is_some() && stride > least).then_some((place, SHARE * stride))
    }

    /// Whether the step that the march may take from a point passes no surface.
    pub fn step_from(&mut self, place: Vector) -> Step {
        let Some((center, radius)) = self.ball_of_step(place) else { return Step::Safe };
        match self.contains_zero(center, radius, BUDGET) {
            Some(false) => Step::Safe,
            Some(true) => Step::Unsafe(self.free_share(center, radius)),
            None => Step::Undecided(self.free_share(center, radius)),
        }
    }

    /// The largest of some shares of a step of which it is proved that they are free, where the ball is not: 0 if none.
    pub fn free_share(&mut self, center: Vector, radius: f64) -> f64 {
        let is_free =
            |share: &f64| self.contains_zero(center, share / SHARE * radius, BUDGET / 4) == Some(false);
        SMALLER.into_iter().find(is_free).unwrap_or(0.0)
    }
}

/// What values near a zero may be by the rounding of `f64`, for coordinates in a ball.
fn rounding(center: Vector, radius: f64) -> f64 {
    1e-12 * (length(center) + radius)
}

/// Whether a point is one of a ball's; one that is not finite is not.
fn is_inside(place: Vector, center: Vector, radius: f64) -> bool {
    length(moved(place, center, -1.0)) * (1.0 + 1e-12) <= radius
}

struct Ball<'a, 'p> {
    field: &'a mut Field<'p>,
    /// The field and its gradient, in `f64`.
    gradient: Option<&'a mut Machine<'p, f64>>,
    center: Vector,
    radius: f64,
    /// Whether the field is positive at the centre.
    side: bool,
    value: Interval,
    /// The gradient's direction at the centre.
    uphill: Option<Vector>,
}

/// A box: its middle, and half its size along each axis.
#[derive(Clone, Copy)]
struct Cell {
    middle: Vector,
    half: Vector,
}

impl Ball<'_, '_> {
    fn contains_zero(&mut self, budget: u64) -> Option<bool> {
        let until = self.field.evaluations + budget;
        let mut cells = vec![(Cell { middle: self.center, half: [self.radius; 3] }, None)];
        let mut is_first = true;
        while let Some((cell, mut within)) = cells.pop() {
            if self.is_outside(&cell) {
                continue;
            }
            let region = cell.region();
            self.field.stay_within(&within);
            if !is_first {
                if sign(self.field.over(region)).is_some() {
                    continue;
                }
                within = self.field.shorten().or(within);
            }
            let (values, slopes) = self.field.moving_over(region);
            if sign(values).is_some() {
                continue;
            }
            let middle = match is_first {
                true => self.value,
                false => self.field.over(Bounds::between(cell.middle, cell.middle)),
            };
            if sign(self.by_slopes(&cell, middle, &slopes, is_first)).is_some()
                || self.is_linear_positive(&cell, middle, slopes.gradient(0))
                || self.field.exclude(self.side, region, cell.middle, cell.half, (self.center, self.radius))
                || slopes.norm() == f64::INFINITY && sign(self.field.over_by_cases(region)).is_some()
            {
                continue;
            }
            let has_zero = match is_first {
                true => self.looks_round() || self.descends(),
                false => self.is_inside(cell.middle) && sign(middle).is_some_and(|side| side != self.side),
            };
            if has_zero {
                return Some(true);
            }
            is_first = false;
            if self.field.evaluations >= until || !cell.is_divisible() {
                return None;
            }
            cells.extend(cell.halves(cell.axis(slopes.gradient(0))).map(|half| (half, within.clone())));
        }
        Some(false)
    }

    /// Where the values in a cell are, by the value in its middle and by how they move.
    fn by_slopes(&self, cell: &Cell, middle: Interval, slopes: &Slopes, is_first: bool) -> Interval {
        // From the middle of the ball no point of it is farther than its radius.
        let reach = if is_first { self.radius } else { length(cell.half) };
        let by_norm = Interval::symmetric(reach * (1.0 + 1e-12)).scaled(slopes.norm());
        let along = |(slope, half): (&Interval, f64)| slope.times(Interval::symmetric(half));
        let change = slopes.gradient(0).iter().zip(cell.half).map(along).fold(Interval::ZERO, Interval::plus);
        middle.plus(change.intersect(by_norm))
    }

    /// Whether the values in the part of a cell that lies in the ball have the sign of the centre's, by the value in the
    /// cell's middle and the gradient.
    ///
    /// The corners of cells at the ball's border lie outside of it, and may lie beyond a surface that the ball does not
    /// reach. Over the whole ball a linear function with the gradient's middle is known exactly.
    fn is_linear_positive(&self, cell: &Cell, middle: Interval, gradient: [Interval; 3]) -> bool {
        let (middle, gradient) = match self.side {
            true => (middle, gradient),
            false => (middle.negated(), gradient.map(Interval::negated)),
        };
        let linear = Linear::below(middle, gradient, cell.middle, cell.half, self.center);
        exclude_ball(linear.into_iter().collect(), self.radius)
    }

    /// Whether the field has another sign at one of some points of the ball: along its gradient, and all round.
    fn looks_round(&mut self) -> bool {
        let way = if self.side { -1.0 } else { 1.0 };
        let downhill = self.uphill.map(|uphill| uphill.map(|x| x * way));
        let mut directions = downhill.into_iter().chain(normal::directions());
        directions.any(|direction| {
            let place = moved(self.center, direction, self.radius * (1.0 - 1e-9));
            self.is_inside(place)
                && sign(self.field.over(Bounds::between(place, place))).is_some_and(|side| side != self.side)
        })
    }

    /// Whether the field vanishes, up to rounding, where Newton's method leads from the centre, which is in the ball. At a
    /// sheet without thickness, which the ball may reach at its rim alone, the field has one sign on all sides. Where it is
    /// flat, as a square is, a small value is not yet near a zero.
    fn descends(&mut self) -> bool {
        let Some(gradient) = &mut self.gradient else { return false };
        let rounding = rounding(self.center, self.radius);
        let mut place = self.center;
        let mut sample = |place: &Vector| -> (f64, Vector) {
            let [value, slope @ ..]: [f64; 4] = run(gradient, place);
            (value, slope)
        };
        let (mut value, mut slope) = sample(&place);
        for _ in 0..DESCENTS {
            place = moved(place, slope, -value / dot(slope, slope));
            if !is_inside(place, self.center, self.radius) {
                return false;
            }
            (value, slope) = sample(&place);
            let least = rounding * length(slope).min(1.0);
            if value.abs() <= least && self.field.over(Bounds::between(place, place)).most() <= rounding {
                return true;
            }
        }
        false
    }

    fn is_inside(&self, place: Vector) -> bool {
        is_inside(place, self.center, self.radius)
    }

    fn is_outside(&self, cell: &Cell) -> bool {
        let nearest =
            std::array::from_fn(|i| ((cell.middle[i] - self.center[i]).abs() - cell.half[i]).max(0.0));
        dot(nearest, nearest) > self.radius * self.radius * (1.0 + 1e-12)
    }
}

impl Cell {
    /// The box, rounded outward.
    fn region(&self) -> Bounds {
        let side = |i: usize| Interval::point(self.middle[i]).widened_by(self.half[i]);
        Bounds::vector(&[side(0), side(1), side(2)])
    }

    /// Whether halving it still makes a difference to `f64`.
    fn is_divisible(&self) -> bool {
        let largest = self.middle.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        self.half.iter().fold(0.0f64, |most, x| most.max(*x)) > 1e-14 * largest
    }

    /// The axis across which it is to be halved: that along which the gradient's change matters most, or the longest.
    fn axis(&self, gradient: [Interval; 3]) -> usize {
        let is_known = gradient.iter().all(|slope| slope.is_finite());
        let steepness = if is_known { gradient.iter().fold(0.0, |sum, x| sum + x.most()) } else { 1.0 };
        let effect = |i: usize| {
            let change = if is_known { gradient[i].width() } else { 0.0 };
            self.half[i] * (change + 0.1 * steepness)
        };
        (0..3).fold(0, |most, i| if effect(i) > effect(most) { i } else { most })
    }

    /// The halves across an axis. They overlap by rounding.
    fn halves(&self, axis: usize) -> [Cell; 2] {
        let (mut low, mut high) = (*self, *self);
        let quarter = self.half[axis] / 2.0;
        low.middle[axis] -= quarter;
        high.middle[axis] += quarter;
        low.half[axis] = quarter;
        high.half[axis] = quarter;
        // What the middles are rounded by must be in one of the halves.
        let room = self.middle[axis].abs() * f64::EPSILON;
        low.half[axis] += room;
        high.half[axis] += room;
        [low, high]
    }
}
