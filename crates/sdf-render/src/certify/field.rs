//! A field over regions: where its values lie there, and how they move.

use super::conditions::Conditions;
use super::ray::Ray;
use super::{Sides, Vector};
use sdf_ir::interval::{Bounds, Interval, Shortened, Sloped, Slopes, Walker};
use sdf_ir::{Function, Program};
use std::rc::Rc;

/// How many borders between cells are told apart in one region, at most.
const BORDERS: usize = 5;

/// A field, asked by one thread.
pub(super) struct Field<'p> {
    values: Walker<'p, Bounds>,
    slopes: Walker<'p, Sloped>,
    /// On either side, where there is more than one condition.
    conditions: Sides<Option<Conditions<'p>>>,
    /// How often it was evaluated.
    pub evaluations: u64,
}

/// What counts of a field's sign in a region, or all of it.
pub(super) type Within = Option<Rc<Shortened>>;

impl<'p> Field<'p> {
    pub fn new(
        program: &'p Program,
        map: &'p Function,
        conditions: &'p Sides<Function>,
        uniforms: &[Bounds],
        globals: &[Bounds],
    ) -> Field<'p> {
        let several = |conditions: &'p Function| {
            let is_several = conditions.root().results.len() > 1;
            is_several.then(|| Conditions::new(program, conditions, uniforms, globals))
        };
        Field {
            conditions: Sides { outside: several(&conditions.outside), inside: several(&conditions.inside) },
            values: Walker::new(program, map, uniforms, globals),
            slopes: Walker::new(program, map, uniforms, globals),
            evaluations: 0,
        }
    }

    /// Asks from now on in parts of a region in which this counts. The values have the field's sign there, and near a zero
    /// they are its values.
    pub fn stay_within(&mut self, within: &Within) {
        self.values.stay_within(within.clone());
        self.slopes.stay_within(within.clone());
    }

    /// Stays within the region over which the values were asked for just now; gives what counts there, if that is much less
    /// than where the field stayed before.
    pub fn shorten(&mut self) -> Within {
        let shortened = self.values.shorten().map(Rc::new);
        if shortened.is_some() {
            self.stay_within(&shortened);
        }
        shortened
    }

    /// Where the values in a region lie.
    pub fn over(&mut self, region: Bounds) -> Interval {
        self.evaluations += 1;
        self.values.run(&[region])[0].number()
    }

    /// The same, more closely where the region holds borders at which the field may jump, for as many evaluations as
    /// there are cases.
    pub fn over_by_cases(&mut self, region: Bounds) -> Interval {
        self.evaluations += 4;
        self.values.run_by_cases(&[region], BORDERS)[0].number()
    }

    /// Where the values in a region lie, and how they move with the point there.
    pub fn moving_over(&mut self, region: Bounds) -> (Interval, Slopes) {
        self.evaluations += 1;
        let result = self.slopes.run(&[Sloped::point(region)])[0];
        (result.bounds.number(), result.slopes)
    }

    /// Whether the field certainly keeps its sign in the part of a box that lies in a ball, by the conditions that it is
    /// the greatest of on this side.
    pub fn exclude(
        &mut self,
        is_outside: bool,
        region: Bounds,
        middle: Vector,
        half: Vector,
        ball: (Vector, f64),
    ) -> bool {
        let side = match is_outside {
            true => &mut self.conditions.outside,
            false => &mut self.conditions.inside,
        };
        let Some(conditions) = side else { return false };
        self.evaluations += 1;
        conditions.exclude(region, middle, half, ball)
    }

    /// Where the values along a part of a ray lie.
    pub fn along(&mut self, ray: &Ray, from: f64, to: f64) -> Interval {
        self.over(ray.part(from, to))
    }

    /// Where the values along a part of a ray lie, and how they change with the distance along it; where they may jump,
    /// that is everything.
    pub fn moving_along(&mut self, ray: &Ray, from: f64, to: f64) -> (Interval, Interval) {
        self.evaluations += 1;
        let result = self.slopes.run(&[ray.moving_part(from, to)])[0];
        (result.bounds.number(), result.slopes.gradient(0)[0])
    }
}

/// The sign of all numbers of an interval, where they have the same.
pub(super) fn sign(x: Interval) -> Option<bool> {
    if x.lo > 0.0 {
        Some(true)
    } else if x.hi < 0.0 {
        Some(false)
    } else {
        None
    }
}
