//! Regions of space: boxes, the search for the box that a shape fills, and for the steepest place in a box.
//!
//! Nothing here knows programs: a field is asked for what it may be in a cell. What is found is as sound as the
//! answers are.

mod fill;
mod steepest;

pub use fill::fill;
pub use steepest::{Steepness, steepest};

/// Coordinates beyond this are not promised: a box that reaches so far reaches everywhere.
pub const FAR: f64 = 1e18;

/// A box with faces along the axes. A face may be infinitely far away; a low face above the high one means that
/// there is nothing in it. In the plane the third axis is `0..0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// The low corner.
    pub lo: [f64; 3],
    /// The high corner.
    pub hi: [f64; 3],
}

impl Extent {
    /// All of space.
    pub const ALL: Extent = Extent { lo: [f64::NEG_INFINITY; 3], hi: [f64::INFINITY; 3] };
    /// Nothing.
    pub const NONE: Extent = Extent { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

    /// The box with these corners; what is [`FAR`] or farther counts as infinitely far, what is no number as well.
    pub fn new(lo: [f64; 3], hi: [f64; 3]) -> Extent {
        let low = |x: f64| if x > -FAR { x } else { f64::NEG_INFINITY };
        let high = |x: f64| if x < FAR { x } else { f64::INFINITY };
        let extent = Extent { lo: lo.map(low), hi: hi.map(high) };
        let empty = (0..3).any(|i| lo[i] >= FAR || hi[i] <= -FAR);
        if empty { Extent::NONE } else { extent }
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        (0..3).any(|i| self.lo[i] > self.hi[i])
    }

    /// Whether all its faces are at finite places, or it is empty.
    pub fn is_bounded(&self) -> bool {
        self.is_empty() || self.lo.iter().chain(&self.hi).all(|x| x.is_finite())
    }

    /// Whether no face of it is at a finite place.
    pub fn is_everything(&self) -> bool {
        self.lo.iter().chain(&self.hi).all(|x| x.is_infinite()) && !self.is_empty()
    }

    /// The least box round both.
    pub fn union(&self, other: &Extent) -> Extent {
        if self.is_empty() {
            return *other;
        }
        if other.is_empty() {
            return *self;
        }
        Extent {
            lo: std::array::from_fn(|i| self.lo[i].min(other.lo[i])),
            hi: std::array::from_fn(|i| self.hi[i].max(other.hi[i])),
        }
    }

    /// What is in both.
    pub fn intersection(&self, other: &Extent) -> Extent {
        let both = Extent {
            lo: std::array::from_fn(|i| self.lo[i].max(other.lo[i])),
            hi: std::array::from_fn(|i| self.hi[i].min(other.hi[i])),
        };
        if both.is_empty() { Extent::NONE } else { both }
    }

    /// Every face moved out by `by`, also that of the third axis in the plane.
    pub fn grown(&self, by: f64) -> Extent {
        if self.is_empty() {
            return Extent::NONE;
        }
        Extent { lo: self.lo.map(|x| x - by), hi: self.hi.map(|x| x + by) }
    }

    /// The sizes along the axes.
    pub fn size(&self) -> [f64; 3] {
        std::array::from_fn(|i| (self.hi[i] - self.lo[i]).max(0.0))
    }

    /// The point in the middle; 0 along an axis without two ends.
    pub fn center(&self) -> [f64; 3] {
        std::array::from_fn(|i| match (self.lo[i].is_finite(), self.hi[i].is_finite()) {
            (true, true) => self.lo[i] + (self.hi[i] - self.lo[i]) / 2.0,
            _ => 0.0,
        })
    }

    /// How far from the line through the origin along the unit vector `axis` it reaches, at most; infinite where it
    /// has no end.
    pub fn reach(&self, axis: [f64; 3]) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let corner = |k: usize| -> [f64; 3] {
            std::array::from_fn(|i| if k >> i & 1 == 1 { self.hi[i] } else { self.lo[i] })
        };
        let from_axis = |c: [f64; 3]| {
            // Across the axis: an infinite coordinate along it does not matter.
            let times = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
            let cross = |i: usize, j: usize| {
                let (a, b) = (times(c[i], axis[j]), times(c[j], axis[i]));
                if a == b { 0.0 } else { a - b }
            };
            let parts = [cross(1, 2), cross(2, 0), cross(0, 1)];
            if parts.iter().any(|x| !x.is_finite()) {
                return f64::INFINITY;
            }
            parts.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        (0..8).map(corner).map(from_axis).fold(0.0, f64::max)
    }

    /// The two halves across an axis.
    pub(crate) fn halves(&self, axis: usize) -> [Extent; 2] {
        let middle = self.center()[axis];
        let (mut low, mut high) = (*self, *self);
        low.hi[axis] = middle;
        high.lo[axis] = middle;
        [low, high]
    }

    /// The part of it in the middle of its axes that have two ends, and how far from that its points are at most.
    pub fn middle(&self) -> (Extent, f64) {
        let (mut middle, mut square) = (*self, 0.0);
        for i in 0..3 {
            let half = (self.hi[i] - self.lo[i]) / 2.0;
            if half.is_finite() {
                let x = self.center()[i];
                (middle.lo[i], middle.hi[i]) = (x, x);
                square += half * half;
            }
        }
        (middle, square.sqrt() * (1.0 + 1e-12))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_join_meet_and_grow() {
        let a = Extent::new([0.0; 3], [1.0, 2.0, 3.0]);
        let b = Extent::new([0.5, -1.0, 5.0], [4.0, 1.0, 6.0]);
        assert_eq!(a.union(&b), Extent::new([0.0, -1.0, 0.0], [4.0, 2.0, 6.0]));
        assert!(a.intersection(&b).is_empty());
        assert_eq!(a.union(&Extent::NONE), a);
        assert!(Extent::NONE.grown(5.0).is_empty() && Extent::NONE.is_bounded());
        assert_eq!(a.grown(1.0).size(), [3.0, 4.0, 5.0]);
        assert!(!Extent::new([-1e20, 0.0, 0.0], [1.0; 3]).is_bounded());
        assert!(Extent::ALL.is_everything() && !a.is_everything());
        assert!(Extent::new([1e20; 3], [-1e20; 3]).is_empty());
    }

    #[test]
    fn the_middle_of_an_infinite_box_is_a_line() {
        let a = Extent::new([-1.0, -1e30, 0.0], [5.0, 1e30, 8.0]);
        let (middle, radius) = a.middle();
        assert_eq!(middle, Extent::new([2.0, -1e30, 4.0], [2.0, 1e30, 4.0]));
        assert!((5.0..5.0 + 1e-9).contains(&radius));
    }

    #[test]
    fn the_reach_is_that_of_the_farthest_corner() {
        let a = Extent::new([-1.0, -1e30, -4.0], [3.0, 1e30, 2.0]);
        assert_eq!(a.reach([0.0, 1.0, 0.0]), 5.0);
        assert_eq!(a.reach([1.0, 0.0, 0.0]), f64::INFINITY);
        assert_eq!(Extent::NONE.reach([1.0, 0.0, 0.0]), 0.0);
    }
}
