//! The box that a shape fills: cells in which there is certainly nothing are dropped, those at the faces of what is
//! left are split.

use crate::region::Extent;

/// Half the size of the cube that is searched; what reaches its border counts as unbounded there.
const REACH: f64 = 1_048_576.0;
/// How many times all cells are halved along each axis before what touches the border counts as unbounded.
const COARSE: usize = 5;
/// How fine the cells at the faces get, as a share of the size of what they cover.
const FINE: f64 = 0.01;
/// The least size of a cell.
const LEAST: f64 = 1e-6;

/// A box in which all points lie where something may be. `may_hold` says of a cell whether there may be something
/// in it: of a cell for which it says no, nothing is kept. Cells may be infinite along an axis. `axes` is 2 in the
/// plane and 3 in space; `within` is where the search begins; `budget` is how often it may ask. The answer is sound
/// whatever the budget; with more it gets tighter.
pub fn fill(
    axes: usize,
    within: &Extent,
    budget: usize,
    mut may_hold: impl FnMut(&Extent) -> bool,
) -> Extent {
    if within.is_empty() {
        return Extent::NONE;
    }
    let mut search =
        Search { axes, asked: 0, budget, cells: vec![cube(axes, within)], open: [[false; 2]; 3] };
    let may_hold: &mut dyn FnMut(&Extent) -> bool = &mut may_hold;
    for _ in 0..COARSE {
        let wide = |s: &Search, cell: &Extent| (0..s.axes).filter(|i| cell.size()[*i] > 1.0).collect();
        search.split(may_hold, |s, cell| wide(s, cell));
    }
    search.find_open(within);
    while search.asked < search.budget && search.split_faces(may_hold) {}
    search.cover(within)
}

/// The cube that is searched, as far as it lies within a box.
fn cube(axes: usize, within: &Extent) -> Extent {
    let mut cube = *within;
    for i in 0..axes {
        cube.lo[i] = cube.lo[i].max(-REACH);
        cube.hi[i] = cube.hi[i].min(REACH);
    }
    cube
}

struct Search {
    axes: usize,
    asked: usize,
    budget: usize,
    cells: Vec<Extent>,
    /// Whether what is left reaches the border of the cube, at the low and at the high end of each axis.
    open: [[bool; 2]; 3],
}

impl Search {
    /// Halves each cell along the axes that `choose` names, and drops the parts in which there is nothing.
    fn split(
        &mut self,
        may_hold: &mut dyn FnMut(&Extent) -> bool,
        choose: impl Fn(&Search, &Extent) -> Vec<usize>,
    ) -> bool {
        let mut kept = Vec::new();
        let mut any = false;
        for cell in std::mem::take(&mut self.cells) {
            let chosen = choose(self, &cell);
            if chosen.is_empty() || self.asked >= self.budget {
                kept.push(cell);
                continue;
            }
            any = true;
            let mut parts = vec![cell];
            for axis in chosen {
                parts = parts.iter().flat_map(|part| part.halves(axis)).collect();
            }
            self.asked += parts.len();
            kept.extend(parts.into_iter().filter(|part| may_hold(part)));
        }
        self.cells = kept;
        any
    }

    /// Notes where what is left reaches the border. Along an axis that is open at both ends nothing is to be found.
    fn find_open(&mut self, within: &Extent) {
        for axis in 0..self.axes {
            let reaches = |c: &Extent| [c.lo[axis] <= -REACH, c.hi[axis] >= REACH];
            let infinite = [within.lo[axis] < -REACH, within.hi[axis] > REACH];
            self.open[axis] =
                [0, 1].map(|side| infinite[side] && self.cells.iter().any(|c| reaches(c)[side]));
        }
        let whole: Vec<usize> = (0..self.axes).filter(|i| self.open[*i] == [true, true]).collect();
        if whole.is_empty() {
            return;
        }
        // Cells that differ only along such axes become one.
        for cell in &mut self.cells {
            for axis in &whole {
                cell.lo[*axis] = f64::NEG_INFINITY;
                cell.hi[*axis] = f64::INFINITY;
            }
        }
        let key = |c: &Extent| c.lo.map(f64::to_bits);
        self.cells.sort_by_key(key);
        self.cells.dedup_by_key(|c| key(c));
    }

    /// Splits the cells at those faces that are not fine yet. Says whether there were any.
    fn split_faces(&mut self, may_hold: &mut dyn FnMut(&Extent) -> bool) -> bool {
        let Some(all) = self.cells.iter().copied().reduce(|a, b| a.union(&b)) else { return false };
        let open = self.open;
        // How fine is fine: a share of the size along the axis; where there is but one end, of where that is.
        let scale = |i: usize| match open[i] {
            [false, false] => all.size()[i],
            [low_open, _] => (if low_open { all.hi[i] } else { all.lo[i] }).abs().max(0.1),
        };
        let largest = (0..self.axes).filter(|i| open[*i] != [true, true]).map(scale).fold(0.0, f64::max);
        let fine: Vec<f64> =
            (0..self.axes).map(|i| (FINE * scale(i)).max(FINE * FINE * largest).max(LEAST)).collect();
        self.split(may_hold, move |s, cell| {
            let length = |i: usize| cell.hi[i] - cell.lo[i];
            let at_face = |i: usize| {
                let low = cell.lo[i] <= all.lo[i] && !open[i][0];
                let high = cell.hi[i] >= all.hi[i] && !open[i][1];
                (low || high) && length(i) > fine[i]
            };
            let least = (0..s.axes).filter(|i| at_face(*i)).map(length).fold(f64::INFINITY, f64::min);
            // What is as long in another direction is split there too: little is known of a long cell.
            (0..s.axes).filter(|i| at_face(*i) || (length(*i) >= least && length(*i).is_finite())).collect()
        })
    }

    /// The box round all cells, which has no end where it is open.
    fn cover(&self, within: &Extent) -> Extent {
        let Some(mut all) = self.cells.iter().copied().reduce(|a, b| a.union(&b)) else {
            return Extent::NONE;
        };
        for axis in 0..self.axes {
            if self.open[axis][0] || (all.lo[axis] <= -REACH && within.lo[axis] < -REACH) {
                all.lo[axis] = f64::NEG_INFINITY;
            }
            if self.open[axis][1] || (all.hi[axis] >= REACH && within.hi[axis] > REACH) {
                all.hi[axis] = f64::INFINITY;
            }
        }
        all.intersection(within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least of |p - c| over a cell.
    fn nearest(cell: &Extent, c: [f64; 3]) -> f64 {
        let off = |i: usize| (cell.lo[i] - c[i]).max(c[i] - cell.hi[i]).max(0.0);
        (0..3).map(|i| off(i) * off(i)).sum::<f64>().sqrt()
    }

    fn close(found: &Extent, lo: [f64; 3], hi: [f64; 3]) {
        for i in 0..3 {
            for (found, wanted, outward) in [(found.lo[i], lo[i], -1.0), (found.hi[i], hi[i], 1.0)] {
                if wanted.is_infinite() {
                    assert_eq!(found, wanted);
                } else {
                    let over = (found - wanted) * outward;
                    assert!((-1e-12..=0.2).contains(&over), "{found} for {wanted} along axis {i}");
                }
            }
        }
    }

    #[test]
    fn a_ball_is_found_where_it_is() {
        for (c, r) in [([3.0, -70.0, 0.25], 2.0), ([1e4, 0.0, -1e5], 5.0)] {
            let found = fill(3, &Extent::ALL, 60_000, |cell| nearest(cell, c) <= r);
            close(&found, c.map(|x| x - r), c.map(|x| x + r));
        }
    }

    #[test]
    fn what_has_no_end_has_none() {
        // A cylinder about the y axis, and the half space below a plane.
        let flat =
            |cell: &Extent| Extent { lo: [cell.lo[0], 0.0, cell.lo[2]], hi: [cell.hi[0], 0.0, cell.hi[2]] };
        let found = fill(3, &Extent::ALL, 60_000, |cell| nearest(&flat(cell), [1.0, 0.0, 2.0]) <= 3.0);
        let inf = f64::INFINITY;
        close(&found, [-2.0, -inf, -1.0], [4.0, inf, 5.0]);
        let found = fill(3, &Extent::ALL, 60_000, |cell| cell.lo[1] <= 2.5);
        close(&found, [-inf, -inf, -inf], [inf, 2.5, inf]);
    }

    #[test]
    fn nothing_is_found_where_nothing_is() {
        assert!(fill(3, &Extent::ALL, 1000, |_| false).is_empty());
        assert!(fill(3, &Extent::ALL, 1000, |_| true).is_everything());
    }

    #[test]
    fn little_work_gives_a_larger_box() {
        let found = fill(3, &Extent::ALL, 100, |cell| nearest(cell, [0.0; 3]) <= 1.0);
        assert!((0..3).all(|i| found.lo[i] <= -1.0 && found.hi[i] >= 1.0));
    }

    #[test]
    fn the_plane_has_two_axes() {
        let within = Extent {
            lo: [f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0],
            hi: [f64::INFINITY, f64::INFINITY, 0.0],
        };
        let found = fill(2, &within, 20_000, |cell| nearest(cell, [5.0, 6.0, 0.0]) <= 1.0);
        close(&found, [4.0, 5.0, 0.0], [6.0, 7.0, 0.0]);
    }
}
