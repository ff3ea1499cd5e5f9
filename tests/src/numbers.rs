//! Arguments for tests: ordinary numbers, and all those that code trips over.

use sdf_ir::Type;

/// Numbers at the edges of domains, rounding and range; their neighbours are tried too.
const EDGES: [f32; 24] = [
    0.0,
    1.0,
    0.5,
    1.5,
    2.5,
    0.25,
    2.0,
    3.0,
    std::f32::consts::PI,
    std::f32::consts::FRAC_PI_2,
    std::f32::consts::FRAC_PI_4,
    std::f32::consts::TAU,
    8_388_607.5,
    8_388_608.0,
    16_777_216.0,
    2_147_483_648.0,
    4_294_967_296.0,
    1e5,
    1e-5,
    1e18,
    1e-20,
    f32::MAX,
    f32::MIN_POSITIVE,
    f32::EPSILON,
];

/// The `n`-th word of a sequence that is the same on every run.
pub fn word(n: u64) -> u32 {
    let mut h = n.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((h ^ (h >> 31)) >> 32) as u32
}

/// The `n`-th number: a quarter edges and their neighbours, a quarter of any magnitude, a quarter near halves and
/// whole numbers, a quarter between -4 and 4. All are finite; a denormal one is 0.
pub fn number(n: u64) -> f32 {
    let (kind, bits) = (word(3 * n) % 4, word(3 * n + 1));
    let sign = if word(3 * n + 2).is_multiple_of(2) { 1.0 } else { -1.0 };
    let x = match kind {
        0 => {
            let edge = EDGES[bits as usize % EDGES.len()];
            [edge, edge.next_up(), edge.next_down()][(bits >> 16) as usize % 3]
        }
        1 => f32::from_bits(bits),
        2 => (bits % 4096) as f32 * 0.5,
        _ => bits as f32 / u32::MAX as f32 * 4.0,
    };
    if x.is_finite() && (x == 0.0 || x.is_normal()) { x * sign } else { 0.0 }
}

/// Arguments of these types for `count` calls: a column for each scalar component; a truth value is 0 or 1.
pub fn columns(types: &[Type], count: usize, mut number: impl FnMut(u64) -> f32) -> Vec<Vec<f32>> {
    let mut columns = Vec::new();
    for ty in types {
        for _ in 0..ty.size() {
            let start = columns.len() as u64 * 1_000_000_007;
            let x = |i: usize| match ty {
                Type::Bool => (word(start + i as u64) % 2) as f32,
                _ => number(start + i as u64),
            };
            columns.push((0..count).map(x).collect());
        }
    }
    columns
}
