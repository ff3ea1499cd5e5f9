//! The steepest place of a box: the cell with the largest bound is split until the bounds are tight or the work is
//! done.

use crate::region::{Extent, FAR};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// How much above the steepest place that was seen a bound may lie and count as tight.
const TIGHT: f64 = 1.02;
/// Where an infinite axis is cut first.
const FAR_CELL: f64 = 1e6;
/// The size from which on orders of magnitude count.
const LEAST_CELL: f64 = 1e-2;

/// What a field's slope is in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steepness {
    /// It is certainly no larger anywhere in the cell.
    pub at_most: f64,
    /// It is at least this somewhere in it; 0 where nothing is known.
    pub at_least: f64,
}

/// A number that the slope in no point of the region exceeds. `ask` answers for cells; it is asked at most `budget`
/// times. The answer is sound whatever the budget, and infinite where no bound was found.
pub fn steepest(
    axes: usize,
    region: &Extent,
    budget: usize,
    mut ask: impl FnMut(&Extent) -> Steepness,
) -> f64 {
    if region.is_empty() {
        return 0.0;
    }
    let first = ask(region);
    let mut seen = first.at_least;
    let mut cells = BinaryHeap::from([Cell { at_most: first.at_most, extent: *region }]);
    let mut asked = 1;
    while let Some(worst) = cells.peek() {
        if worst.at_most <= seen * TIGHT || worst.at_most == 0.0 || asked + 2 > budget {
            break;
        }
        let Some(axis) = longest(axes, &worst.extent) else { break };
        let worst = cells.pop().expect("it was just looked at");
        for part in halves(&worst.extent, axis) {
            let answer = ask(&part);
            asked += 1;
            seen = seen.max(answer.at_least);
            cells.push(Cell { at_most: answer.at_most.min(worst.at_most), extent: part });
        }
    }
    cells.peek().map_or(0.0, |worst| worst.at_most)
}

/// The axis to split along; nothing if the cell is as small as numbers allow.
fn longest(axes: usize, cell: &Extent) -> Option<usize> {
    let size = cell.size();
    let axis = (0..axes).max_by(|a, b| size[*a].total_cmp(&size[*b]))?;
    let scale = cell.lo[axis].abs().min(cell.hi[axis].abs());
    (size[axis] > 1e-9 * scale.max(1e-9)).then_some(axis)
}

/// The parts of a cell. One that reaches over many orders of magnitude is cut in the middle of those, one without an
/// end first where the numbers that scenes are made of end.
fn halves(cell: &Extent, axis: usize) -> Vec<Extent> {
    let (lo, hi) = (cell.lo[axis], cell.hi[axis]);
    let cuts: Vec<f64> = if lo < 0.0 && hi > 0.0 {
        if lo.is_infinite() || hi.is_infinite() {
            vec![-FAR_CELL, FAR_CELL]
        } else {
            vec![lo + (hi - lo) / 2.0]
        }
    } else {
        let (near, far) = (lo.abs().min(hi.abs()), lo.abs().max(hi.abs()).min(FAR));
        let magnitude = if far > 8.0 * near.max(LEAST_CELL) {
            (near.max(LEAST_CELL) * far).sqrt()
        } else {
            (near + far) / 2.0
        };
        vec![if lo < 0.0 { -magnitude } else { magnitude }]
    };
    let inside = cuts.into_iter().filter(|x| lo < *x && *x < hi);
    let ends: Vec<f64> = [lo].into_iter().chain(inside).chain([hi]).collect();
    let part = |ends: &[f64]| {
        let mut part = *cell;
        (part.lo[axis], part.hi[axis]) = (ends[0], ends[1]);
        part
    };
    ends.windows(2).map(part).collect()
}

struct Cell {
    at_most: f64,
    extent: Extent,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Cell) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Cell) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Cell) -> Ordering {
        self.at_most.total_cmp(&other.at_most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slope of x³ along x.
    fn cubic(cell: &Extent) -> Steepness {
        let most = cell.lo[0].abs().max(cell.hi[0].abs());
        let middle = cell.center()[0];
        Steepness { at_most: 3.0 * most * most, at_least: 3.0 * middle * middle }
    }

    #[test]
    fn the_bound_comes_close() {
        let region = Extent { lo: [-1.0, 0.0, 0.0], hi: [2.0, 1.0, 1.0] };
        let found = steepest(3, &region, 500, cubic);
        assert!((12.0..=12.0 * 1.02).contains(&found), "{found}");
    }

    #[test]
    fn what_has_no_bound_is_infinite() {
        let jump = |cell: &Extent| Steepness {
            at_most: if cell.lo[0] <= 0.3 && cell.hi[0] >= 0.3 { f64::INFINITY } else { 1.0 },
            at_least: 1.0,
        };
        assert_eq!(steepest(1, &Extent { lo: [0.0; 3], hi: [1.0; 3] }, 200, jump), f64::INFINITY);
        assert_eq!(steepest(1, &Extent { lo: [0.4; 3], hi: [1.0; 3] }, 200, jump), 1.0);
    }

    #[test]
    fn an_infinite_region_is_cut() {
        let near_only = |cell: &Extent| Steepness {
            at_most: if cell.lo[0] < 5.0 && cell.hi[0] > -5.0 { 2.0 } else { 1.0 },
            at_least: 0.0,
        };
        assert_eq!(steepest(3, &Extent::ALL, 100, near_only), 2.0);
    }
}
