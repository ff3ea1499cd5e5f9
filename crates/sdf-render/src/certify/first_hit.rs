//! The first zero of a field along a ray, certainly.
//!
//! From the eye outward, pieces of the ray are dropped in which the field certainly has no zero: by its interval there,
//! or by its mean value form `f(m) + f'([a, b])·([a, b] - m)` (Ramon E. Moore, "Interval Analysis", 1966). Where the sign
//! has changed there is a zero; where the slope also keeps its sign there is one alone, and interval Newton closes in on
//! it. What no halving decides is a place where the field touches zero, or nearly so.

use super::field::{Field, Within, sign};
use super::ray::Ray;
use super::{Prover, Vector};
use sdf_ir::interval::Interval;

/// How often the field is evaluated for one ray, at most.
const BUDGET: u64 = 6000;
/// How closely a zero is enclosed, as a share of the scale of the coordinates.
const CLOSE: f64 = 1e-11;
/// Shorter pieces are not halved, as a share of the scale of the coordinates.
const LEAST: f64 = 1e-10;
/// How many pieces a ray is cut into before anything is known.
const PIECES: f64 = 16.0;
/// The least slope with which a field turns round at a sheet without thickness. A ray that grazes a ball turns round more
/// gently.
const TURNING: f64 = 1e-3;

/// What is certain about a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Truth {
    /// The first zero of the field, or the first place where its sign jumps, lies between these distances. They are close
    /// together unless the ray also touches a surface before it passes one.
    Hit {
        /// There is no zero before this.
        near: f64,
        /// There is one no later than here.
        far: f64,
    },
    /// There is no zero as far as the ray goes.
    Miss,
    /// The field comes so near to zero that it could not be decided, but nowhere changes its sign.
    Ambiguous {
        /// There is no zero before this.
        near: f64,
    },
}

impl Prover<'_> {
    /// Where a ray first meets the surface, seen from outside or from inside. A sheet without thickness counts as met
    /// where the field comes within 1e-9 of zero, as a share of the coordinates, between slopes of both signs.
    pub fn first_hit(&mut self, ray: &Ray) -> Truth {
        match &mut self.field {
            Some(field) => {
                let truth = Search::new(field, ray).run();
                field.stay_within(&None);
                truth
            }
            None => Truth::Miss,
        }
    }
}

/// What is known of a piece of a ray.
enum Piece {
    /// There is no zero in it.
    Free,
    /// There is one zero in it, for the slope has one sign and the field has two; this is the slope.
    One(Interval),
    /// The sign of the field has changed at its end.
    Passed,
    /// It cannot be told.
    Unclear,
}

struct Search<'a, 'p> {
    field: &'a mut Field<'p>,
    ray: &'a Ray,
    /// When the evaluations are spent.
    until: u64,
    /// The sign of the field before the first zero.
    before: Option<bool>,
    /// What counts of the field up to some distances, each part of the ray within the one before.
    within: Vec<(f64, Within)>,
}

impl<'a, 'p> Search<'a, 'p> {
    fn new(field: &'a mut Field<'p>, ray: &'a Ray) -> Search<'a, 'p> {
        let until = field.evaluations + BUDGET;
        Search { field, ray, until, before: None, within: Vec::new() }
    }

    fn run(&mut self) -> Truth {
        self.before = sign(self.field.along(self.ray, 0.0, 0.0));
        // Up to `from` all is decided, up to `passed` there certainly is a zero, at `unclear` perhaps.
        let (mut from, mut passed, mut unclear) = (0.0, None, None);
        let mut step = self.ray.far / PIECES;
        let mut least_step = LEAST;
        while from < passed.unwrap_or(self.ray.far) {
            let scale = self.ray.scale(from);
            if let Some(far) = passed
                && far - from <= CLOSE * scale
            {
                break;
            }
            if self.field.evaluations >= self.until {
                unclear = unclear.or(Some(from));
                break;
            }
            let to = (from + step).min(passed.unwrap_or(self.ray.far));
            match self.look(from, to) {
                Piece::Free => {
                    (from, step) = (to, (to - from) * 2.0);
                    continue;
                }
                Piece::One(slope) => {
                    let (near, far) = self.narrow(from, to, slope);
                    (from, passed) = (near, Some(far));
                    break;
                }
                Piece::Passed => passed = Some(to),
                Piece::Unclear => {}
            }
            step = (to - from) / 2.0;
            if step < least_step * scale {
                if passed != Some(to) && unclear.is_none() && self.turns_round(from, to) {
                    passed = Some(to);
                    break;
                }
                unclear = unclear.or(Some(from));
                if passed == Some(to) {
                    break;
                }
                // Where many pieces are unclear they need not be told apart so closely.
                least_step *= 2.0;
                (from, step) = (to, (to - from) * 2.0);
            }
        }
        match (passed, unclear) {
            (Some(far), unclear) => Truth::Hit { near: unclear.unwrap_or(from), far },
            (None, Some(near)) => Truth::Ambiguous { near },
            (None, None) => Truth::Miss,
        }
    }

    /// What is known of a piece before which there is no zero. Pieces come in order, each behind the one before or a part
    /// of it.
    fn look(&mut self, from: f64, to: f64) -> Piece {
        while self.within.pop_if(|(end, _)| *end < to).is_some() {}
        self.field.stay_within(self.within.last().map_or(&None, |(_, within)| within));
        let values = self.field.along(self.ray, from, to);
        if sign(values).is_some() {
            return self.free(values);
        }
        if let Some(shortened) = self.field.shorten() {
            self.within.push((to, Some(shortened)));
        }
        let (values, slope) = self.field.moving_along(self.ray, from, to);
        let middle = from + (to - from) / 2.0;
        let mean = self.field.along(self.ray, middle, middle);
        let room = Interval::new(from, to).minus(Interval::point(middle));
        let values = values.intersect(mean.plus(slope.times(room)));
        if sign(values).is_some() {
            return self.free(values);
        }
        if !slope.is_finite() {
            let values = self.field.over_by_cases(self.ray.part(from, to));
            if sign(values).is_some() {
                return self.free(values);
            }
        }
        let end = sign(self.field.along(self.ray, to, to));
        match (self.before, end) {
            (Some(a), Some(b)) if a == b && sign(slope).is_some() => Piece::Free,
            (Some(a), Some(b)) if a != b && sign(slope).is_some() => Piece::One(slope),
            (Some(a), Some(b)) if a != b => Piece::Passed,
            _ => Piece::Unclear,
        }
    }

    /// A piece in which the field has one sign. If that is not the sign before it, the field has jumped over zero at its
    /// beginning.
    fn free(&mut self, values: Interval) -> Piece {
        match (self.before, sign(values)) {
            (Some(a), Some(b)) if a != b => Piece::Passed,
            (_, sign) => {
                self.before = sign;
                Piece::Free
            }
        }
    }

    /// Interval Newton: closes in on the one zero between two distances.
    fn narrow(&mut self, from: f64, to: f64, slope: Interval) -> (f64, f64) {
        let (mut here, mut slope) = (Interval::new(from, to), slope);
        while here.width() > CLOSE * self.ray.scale(here.hi) && self.field.evaluations < self.until {
            let middle = here.middle();
            let value = self.field.along(self.ray, middle, middle);
            let next = here.intersect(Interval::point(middle).minus(value.over(slope)));
            let is_done = next.width() > 0.75 * here.width();
            here = next;
            if is_done {
                break;
            }
            if here.width() > CLOSE * self.ray.scale(here.hi) {
                let (_, steeper) = self.field.moving_along(self.ray, here.lo, here.hi);
                slope = slope.intersect(steeper);
            }
        }
        (here.lo, here.hi)
    }

    /// Whether the field comes to zero in a tiny piece, by rounding, and turns round there as it does at a sheet.
    fn turns_round(&mut self, from: f64, to: f64) -> bool {
        let Some(before) = self.before else { return false };
        self.field.stay_within(&None);
        let least = LEAST * self.ray.scale(to);
        let middle = from + (to - from) / 2.0;
        let value = self.field.along(self.ray, middle, middle);
        if value.most() > 10.0 * least {
            return false;
        }
        let side = |gap: f64, length: f64| {
            let (a, b) = (middle + gap, middle + length);
            if a < b { (a, b) } else { (b, a) }
        };
        let mut slope_of = |(a, b): (f64, f64)| self.field.moving_along(self.ray, a.max(0.0), b).1;
        let towards = slope_of(side(-2.0 * least, -8.0 * least));
        let away = slope_of(side(2.0 * least, 8.0 * least));
        if before {
            towards.hi < -TURNING && away.lo > TURNING
        } else {
            towards.lo > TURNING && away.hi < -TURNING
        }
    }
}

impl Truth {
    /// The middle of where the first zero lies.
    pub fn depth(&self) -> Option<f64> {
        match self {
            Truth::Hit { near, far } => Some(near + (far - near) / 2.0),
            Truth::Miss | Truth::Ambiguous { .. } => None,
        }
    }

    /// The point in the middle of where the first zero lies.
    pub fn place(&self, ray: &Ray) -> Option<Vector> {
        self.depth().map(|t| ray.at(t))
    }
}
