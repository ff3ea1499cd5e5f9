//! Points as columns, the same in every run.

use sdf_ir::region::Extent;

/// A column for each coordinate.
pub type Points = [Vec<f64>; 3];

/// The `n`-th number of a sequence in 0..1.
pub fn random(n: u64) -> f64 {
    let mut h = n.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Where the sequence of a text begins.
pub fn seed(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

/// Numbers one after another.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// Those of a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// The next, in 0..1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(1);
        random(self.0)
    }

    /// The next, from `lo` to `hi`.
    pub fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    /// One of so many.
    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n.saturating_sub(1))
    }

    /// A vector of length 1; in the plane where there are two axes.
    pub fn direction(&mut self, axes: usize) -> [f64; 3] {
        loop {
            let v: [f64; 3] = std::array::from_fn(|i| if i < axes { self.within(-1.0, 1.0) } else { 0.0 });
            let length = length(v);
            if length > 1e-3 && length <= 1.0 {
                return v.map(|x| x / length);
            }
        }
    }
}

/// The Euclidean length.
pub fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Whether a number is above a limit, or no number at all.
pub fn exceeds(x: f64, limit: f64) -> bool {
    x.is_nan() || x > limit
}

/// `a + b * t`
pub fn along(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + b[i] * t)
}

/// The `i`-th point.
pub fn at(points: &Points, i: usize) -> [f64; 3] {
    std::array::from_fn(|axis| points[axis][i])
}

/// Points as columns.
pub fn columns(points: impl IntoIterator<Item = [f64; 3]>) -> Points {
    let mut columns = Points::default();
    for p in points {
        (0..3).for_each(|axis| columns[axis].push(p[axis]));
    }
    columns
}

/// Points all over a box.
pub fn scattered(within: &Extent, count: usize, random: &mut Random) -> Points {
    columns((0..count).map(|_| std::array::from_fn(|i| random.within(within.lo[i], within.hi[i]))))
}

/// The points moved by `distance`, each in a direction of its own.
pub fn moved(points: &Points, axes: usize, distance: f64, random: &mut Random) -> Points {
    columns((0..points[0].len()).map(|i| along(at(points, i), random.direction(axes), distance)))
}

/// Whether a point is in a box.
pub fn holds(extent: &Extent, p: [f64; 3]) -> bool {
    (0..3).all(|i| extent.lo[i] <= p[i] && p[i] <= extent.hi[i])
}
