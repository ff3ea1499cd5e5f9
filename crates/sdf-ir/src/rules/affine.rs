//! Chains of constant rotations and translations, folded in `f64` to one.
//!
//! A vector whose components are constant sums over the components of one other vector is an affine map of that
//! vector, `M·q + o`. A map of a map is one map, so what a chain of ten thousand links leaves is one. The
//! canonical form of a map is `(dot(row₀, q - t), dot(row₁, q - t), dot(row₂, q - t))`, where rows with zeros have
//! become shorter sums. To recognise a link takes constant time, since what it stands on is canonical already.

use super::fold;
use crate::build::Builder;
use crate::constant::Constant;
use crate::program::{Binary, Node, Unary, Value};

type Row = [f64; 3];
type Matrix = [Row; 3];

/// How far `Mᵀ·M` may be from the identity where `M` counts as a rotation or a mirror image.
const ORTHONORMAL: f64 = 1e-10;

/// A map of a row passes through this many operations at most: three sums, each of scaled parts of the like.
const DEPTH: u32 = 10;

/// `coefficients · base + offset`
#[derive(Clone, Copy)]
struct Combination {
    base: Value,
    coefficients: Row,
    offset: f64,
    /// Whether it is a component of its base, perhaps scaled.
    is_term: bool,
    /// Whether the canonical form has fewer operations between it and its base.
    is_folded: bool,
}

/// `matrix · base + offset`
struct Map {
    base: Value,
    size: usize,
    matrix: Matrix,
    offset: Row,
}

/// M₂·(M₁·q + o) == (M₂·M₁)·q + M₂·o, and M·q + o == M·(q + Mᵀ·o), for orthonormal maps
pub(super) fn compose(b: &mut Builder, parts: &[Value]) -> Option<Value> {
    let rows = parts.iter().map(|part| combination(b, *part, DEPTH)).collect::<Option<Vec<_>>>()?;
    let is_folded = rows.iter().any(|row| row.is_folded || row.coefficients.iter().any(|c| is_dust(*c)));
    let map = of_rows(b, &rows)?;
    if is_folded { canonical(b, map) } else { None }
}

/// dot(c, M·q + o) == dot(Mᵀ·c, q) + dot(c, o)
pub(super) fn dot(b: &mut Builder, x: Value, y: Value) -> Option<Value> {
    let (c, vector) = match (b.constant_of(x), b.constant_of(y)) {
        (Some(c), _) => (c, y),
        (_, Some(c)) => (c, x),
        _ => return None,
    };
    // A sum with an offset would be an operation more.
    let map = map(b, vector, DEPTH)?;
    if map.offset != [0.0; 3] {
        return None;
    }
    let row = through(row_of(&c), &map);
    let row = fold(b, Constant::from_components(&row[..map.size]))?;
    Some(b.binary(Binary::Dot, row, map.base))
}

/// The map in its canonical form, where it is a rotation or a mirror image. Others may share what they compute.
fn canonical(b: &mut Builder, mut map: Map) -> Option<Value> {
    if deviation(&map) > ORTHONORMAL {
        return None;
    }
    map.matrix = orthonormalised(&map);
    let translation: Row = std::array::from_fn(|j| (0..3).map(|i| -map.matrix[i][j] * map.offset[i]).sum());
    let translation = fold(b, Constant::from_components(&translation[..map.size]))?;
    let base = b.sub(map.base, translation);
    let mut parts = Vec::with_capacity(map.size);
    for row in &map.matrix[..map.size] {
        let row = fold(b, Constant::from_components(&row[..map.size]))?;
        parts.push(b.binary(Binary::Dot, row, base));
    }
    Some(b.compose(&parts))
}

/// The value as a constant sum over the components of one vector.
fn combination(b: &Builder, value: Value, depth: u32) -> Option<Combination> {
    let depth = depth.checked_sub(1)?;
    match b.node(value) {
        Node::Component(vector, index) => Some(of_vector(b, vector, unit(index as usize), depth, true)),
        Node::Unary(Unary::Negate, a) => Some(times(combination(b, a, depth)?, -1.0)),
        Node::Binary(Binary::Dot, x, y) => match (b.constant_of(x), b.constant_of(y)) {
            (Some(c), _) => Some(of_vector(b, y, row_of(&c), depth, false)),
            (_, Some(c)) => Some(of_vector(b, x, row_of(&c), depth, false)),
            _ => None,
        },
        Node::Binary(Binary::Multiply, x, y) => match (float(b, x), float(b, y)) {
            (Some(k), _) => Some(times(combination(b, y, depth)?, k)),
            (_, Some(k)) => Some(times(combination(b, x, depth)?, k)),
            _ => None,
        },
        Node::Binary(op @ (Binary::Add | Binary::Subtract), x, y) => {
            let sign = if op == Binary::Add { 1.0 } else { -1.0 };
            match (float(b, x), float(b, y)) {
                (_, Some(k)) => {
                    let it = combination(b, x, depth)?;
                    Some(Combination { offset: it.offset + sign * k, is_term: false, ..it })
                }
                (Some(k), _) => {
                    let it = times(combination(b, y, depth)?, sign);
                    Some(Combination { offset: it.offset + k, is_term: false, ..it })
                }
                _ => plus(combination(b, x, depth)?, times(combination(b, y, depth)?, sign)),
            }
        }
        _ => None,
    }
}

/// `row · vector`
fn of_vector(b: &Builder, vector: Value, row: Row, depth: u32, is_term: bool) -> Combination {
    match map(b, vector, depth) {
        Some(map) => Combination {
            base: map.base,
            coefficients: through(row, &map),
            offset: (0..3).map(|i| row[i] * map.offset[i]).sum(),
            is_term: false,
            is_folded: true,
        },
        None => Combination { base: vector, coefficients: row, offset: 0.0, is_term, is_folded: false },
    }
}

/// A scaled term is a term; to scale anything else is an operation that the canonical form saves.
fn times(it: Combination, k: f64) -> Combination {
    Combination {
        coefficients: it.coefficients.map(|c| c * k),
        offset: it.offset * k,
        is_folded: it.is_folded || !it.is_term,
        ..it
    }
}

fn plus(x: Combination, y: Combination) -> Option<Combination> {
    (x.base == y.base).then(|| Combination {
        base: x.base,
        coefficients: std::array::from_fn(|i| x.coefficients[i] + y.coefficients[i]),
        offset: x.offset + y.offset,
        is_term: false,
        is_folded: x.is_folded || y.is_folded || !(x.is_term && y.is_term),
    })
}

/// The vector as a map of another one.
fn map(b: &Builder, vector: Value, depth: u32) -> Option<Map> {
    let depth = depth.checked_sub(1)?;
    let parts = match b.node(vector) {
        Node::Compose2(x, y) => vec![x, y],
        Node::Compose3(x, y, z) => vec![x, y, z],
        Node::Binary(op @ (Binary::Add | Binary::Subtract), x, y) => {
            let (inner, c, sign) = match (b.constant_of(x), b.constant_of(y)) {
                (_, Some(c)) => (x, c, if op == Binary::Add { 1.0 } else { -1.0 }),
                (Some(c), _) if op == Binary::Add => (y, c, 1.0),
                _ => return None,
            };
            let mut map = map(b, inner, depth)?;
            let c = c.components();
            for i in 0..map.size {
                map.offset[i] += sign * c[if c.len() == 1 { 0 } else { i }];
            }
            return Some(map);
        }
        _ => return None,
    };
    let rows = parts.iter().map(|part| combination(b, *part, depth)).collect::<Option<Vec<_>>>()?;
    // To move a vector along some axes is no map worth undoing.
    of_rows(b, &rows).filter(|map| !(0..map.size).all(|i| map.matrix[i] == unit(i)))
}

/// The map with these rows, where they have one base of as many components.
fn of_rows(b: &Builder, rows: &[Combination]) -> Option<Map> {
    let base = rows[0].base;
    if b.ty(base).size() != rows.len() || rows.iter().any(|row| row.base != base) {
        return None;
    }
    let mut map = Map { base, size: rows.len(), matrix: [[0.0; 3]; 3], offset: [0.0; 3] };
    for (i, row) in rows.iter().enumerate() {
        map.matrix[i] = row.coefficients;
        map.offset[i] = row.offset;
    }
    Some(map)
}

fn unit(index: usize) -> Row {
    std::array::from_fn(|i| if i == index { 1.0 } else { 0.0 })
}

/// Whether the entry of a rotation is what rounding left of a zero, as in the cosine of a right angle.
fn is_dust(x: f64) -> bool {
    x != 0.0 && x.abs() <= 2.0 * f64::EPSILON
}

/// `row · matrix`
fn through(row: Row, map: &Map) -> Row {
    std::array::from_fn(|j| (0..map.size).map(|i| row[i] * map.matrix[i][j]).sum())
}

fn row_of(c: &Constant) -> Row {
    let mut row = [0.0; 3];
    row[..c.components().len()].copy_from_slice(c.components());
    row
}

fn float(b: &Builder, value: Value) -> Option<f64> {
    match b.constant_of(value) {
        Some(Constant::Float(x)) => Some(x),
        _ => None,
    }
}

/// The product of two columns.
fn columns(m: &Matrix, i: usize, j: usize) -> f64 {
    m.iter().map(|row| row[i] * row[j]).sum()
}

/// The largest entry of `Mᵀ·M - 1`.
fn deviation(map: &Map) -> f64 {
    let entry = |i, j| (columns(&map.matrix, i, j) - if i == j { 1.0 } else { 0.0 }).abs();
    (0..map.size)
        .flat_map(|i| (0..map.size).map(move |j| (i, j)))
        .map(|(i, j)| entry(i, j))
        .fold(0.0, f64::max)
}

/// The nearest orthonormal matrix, by one step of Newton's, `M·(3 - Mᵀ·M)/2`, without dust. So a long chain keeps
/// its lengths.
fn orthonormalised(map: &Map) -> Matrix {
    let without_dust = |m: Matrix| m.map(|row| row.map(|x| if is_dust(x) { 0.0 } else { x }));
    let m = without_dust(map.matrix);
    // The step leaves dust of its own. A canonical map without any is not taken for one that is still to be folded.
    without_dust(std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            (0..map.size).fold(1.5 * m[i][j], |sum, k| sum - 0.5 * m[i][k] * columns(&m, k, j))
        })
    }))
}
