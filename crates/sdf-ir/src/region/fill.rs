//! The box that a shape fills: cells in which there is certainly nothing are dropped, those at the faces of what is
//! left are split.

use crate::region::{Extent, FAR};

/// Half the size of the cube that is searched closely; beyond it cells are as large as they are far away.
const REACH: f64 = 1_048_576.0;
/// How many times all finite cells are halved along each axis before only those at the faces are.
const COARSE: usize = 3;
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
    let may_hold: &mut dyn FnMut(&Extent) -> bool = &mut may_hold;
    // Along an axis that has no end at both sides nothing is to be found: it is left out of the search.
    let mut searched: Vec<usize> = (0..axes).collect();
    let mut asked = 0;
    let mut search = loop {
        let cells = space(&searched, within);
        asked += cells.len();
        let cells = cells.into_iter().filter(|cell| may_hold(cell)).collect();
        let mut search = Search { axes, asked, budget: budget + asked, cells, open: [[false; 2]; 3] };
        search.find_open();
        let before = searched.len();
        searched.retain(|axis| search.open[*axis] != [true, true]);
        if searched.len() == before {
            break search;
        }
    };
    for _ in 0..COARSE {
        let wide = |s: &Search, cell: &Extent| -> Vec<usize> {
            let is_near = |i: &usize| cell.lo[*i] >= -REACH && cell.hi[*i] <= REACH;
            (0..s.axes).filter(is_near).filter(|i| cell.hi[*i] - cell.lo[*i] > 1.0).collect()
        };
        search.split(may_hold, wide);
    }
    search.find_open();
    while search.asked < search.budget && search.split_faces(may_hold) {}
    search.cells.iter().copied().reduce(|a, b| a.union(&b)).unwrap_or(Extent::NONE)
}

/// All that is to be searched: the cube in the middle, and shells round it, each twice as large as the one inside, as
/// far as coordinates go; in so large a cell that is far away, more is known than in one without an end.
fn space(axes: &[usize], within: &Extent) -> Vec<Extent> {
    let mut out = thirds(axes, within, 0.0, REACH);
    let mut inner = REACH;
    while inner < FAR {
        let outer = if 2.0 * inner < FAR { 2.0 * inner } else { f64::INFINITY };
        out.extend(thirds(axes, within, inner, outer));
        inner *= 2.0;
    }
    out
}

/// The cells between a cube and a larger one.
fn thirds(axes: &[usize], within: &Extent, inner: f64, outer: f64) -> Vec<Extent> {
    // Each with whether it lies beyond the inner cube along one of the axes so far.
    let mut cells = vec![(*within, inner == 0.0)];
    for axis in axes.iter().copied() {
        let cut = |(cell, is_beyond): (Extent, bool)| {
            let ends = [(-outer, -inner, true), (-inner, inner, is_beyond), (inner, outer, true)];
            ends.into_iter().filter_map(move |(lo, hi, is_beyond)| {
                let mut part = cell;
                (part.lo[axis], part.hi[axis]) = (part.lo[axis].max(lo), part.hi[axis].min(hi));
                (part.lo[axis] < part.hi[axis]).then_some((part, is_beyond))
            })
        };
        cells = cells.into_iter().flat_map(cut).collect();
    }
    cells.into_iter().filter(|(_, is_beyond)| *is_beyond).map(|(cell, _)| cell).collect()
}

struct Search {
    axes: usize,
    asked: usize,
    budget: usize,
    cells: Vec<Extent>,
    /// Whether what is left has no end, at the low and at the high side of each axis.
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

    /// Notes where what is left has no end.
    fn find_open(&mut self) {
        for axis in 0..self.axes {
            let ends = |c: &Extent| [c.lo[axis].is_infinite(), c.hi[axis].is_infinite()];
            self.open[axis] = [0, 1].map(|side| self.cells.iter().any(|c| ends(c)[side]));
        }
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
                (low || high) && length(i).is_finite() && length(i) > fine[i]
            };
            let least = (0..s.axes).filter(|i| at_face(*i)).map(length).fold(f64::INFINITY, f64::min);
            // What is as long in another direction is split there too: little is known of a long cell.
            (0..s.axes).filter(|i| at_face(*i) || (length(*i) >= least && length(*i).is_finite())).collect()
        })
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

    /// What leaves the cube in the middle slantwise has no end along any axis, although within it, it has.
    #[test]
    fn a_slanting_rod_has_no_end() {
        let low = |cell: &Extent, i: usize| cell.lo[i].clamp(-1e30, 1e30);
        let high = |cell: &Extent, i: usize| cell.hi[i].clamp(-1e30, 1e30);
        // |y - x/1000| <= 1 and |z| <= 1
        let rod = |cell: &Extent| {
            let (lo, hi) = (low(cell, 1) - high(cell, 0) / 1000.0, high(cell, 1) - low(cell, 0) / 1000.0);
            lo <= 1.0 && hi >= -1.0 && low(cell, 2) <= 1.0 && high(cell, 2) >= -1.0
        };
        let found = fill(3, &Extent::ALL, 60_000, rod);
        let inf = f64::INFINITY;
        close(&found, [-inf, -inf, -1.0], [inf, inf, 1.0]);
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
