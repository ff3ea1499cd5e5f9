//! How well two pictures of a scene agree.

use crate::scenes::Buffers;
use sdf_render::Picture;

/// Pixels that differ by more than this in a channel differ.
pub const TOLERANCE: u8 = 2;
/// The largest share of the pixels that may differ.
pub const ALLOWED: f64 = 0.002;

/// A pixel that differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Difference {
    /// From the left.
    pub column: usize,
    /// From the top.
    pub row: usize,
    /// Its colour in the one picture.
    pub expected: [u8; 4],
    /// Its colour in the other.
    pub found: [u8; 4],
}

/// What came of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Agreement {
    /// How many pixels there are.
    pub pixels: usize,
    /// How many differ.
    pub differing: usize,
    /// The largest difference in a channel, of any pixel.
    pub largest: u8,
    /// Those that differ where no edge is near.
    pub unexplained: Vec<Difference>,
}

/// Compares two pictures of what the buffers tell.
pub fn compare(expected: &Picture, found: &Picture, buffers: &Buffers) -> Agreement {
    assert_eq!((expected.width, expected.height), (found.width, found.height), "pictures of one size");
    let mut agreement = Agreement { pixels: buffers.pixels.len(), ..Agreement::default() };
    for i in 0..buffers.pixels.len() {
        let (column, row) = (i % buffers.width, i / buffers.width);
        let [e, f] = [expected, found].map(|picture| picture.pixel(column as u32, row as u32));
        let difference = (0..4).map(|k| e[k].abs_diff(f[k])).max().unwrap_or(0);
        agreement.largest = agreement.largest.max(difference);
        if difference > TOLERANCE {
            agreement.differing += 1;
            if !buffers.is_near_edge(column, row) {
                agreement.unexplained.push(Difference { column, row, expected: e, found: f });
            }
        }
    }
    agreement
}

impl Agreement {
    /// What is wrong, if anything.
    pub fn complaint(&self) -> Option<String> {
        let mut said = Vec::new();
        let allowed = self.pixels as f64 * ALLOWED;
        if self.differing as f64 > allowed {
            said.push(format!("{} pixels differ, {allowed:.0} may", self.differing));
        }
        for d in self.unexplained.iter().take(20) {
            let Difference { column, row, expected, found } = d;
            said.push(format!("column {column}, row {row}: {expected:?} and {found:?}, and no edge is near"));
        }
        if self.unexplained.len() > 20 {
            said.push(format!("and {} more where no edge is near", self.unexplained.len() - 20));
        }
        (!said.is_empty()).then(|| said.join("\n"))
    }
}
