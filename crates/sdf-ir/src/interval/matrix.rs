//! How far a matrix that is known by bounds can stretch a vector: upper bounds of its largest singular value.

use super::number::{Interval, above, product_up, root_up, sum_up};

/// A matrix of up to three rows, known by an interval for each entry and an upper bound of each row's norm. The
/// answer is an upper bound of the largest singular value of every such matrix: the least of what the entries say by
/// their middles, and what rows say by the products of pairs of them.
pub(crate) fn largest_singular_value(rows: &[[Interval; 3]], norms: &[f64]) -> f64 {
    if rows.iter().all(|row| row[1].is_zero() && row[2].is_zero()) {
        // Of a single column it is the length.
        let mut column = [0.0; 3];
        for (entry, (row, norm)) in column.iter_mut().zip(rows.iter().zip(norms)) {
            *entry = row[0].most().min(*norm);
        }
        return norm_up(&column);
    }
    let by_products = root_up(largest_eigenvalue(&products(rows, norms), rows.len()));
    if rows.iter().flatten().any(|x| !x.is_finite()) {
        return by_products;
    }
    by_products.min(by_middles(rows))
}

/// The length of the vector whose magnitudes are these, rounded up.
pub(crate) fn norm_up(magnitudes: &[f64]) -> f64 {
    let square = magnitudes.iter().fold(0.0, |sum, x| sum_up(sum, product_up(*x, *x)));
    root_up(square)
}

/// Upper bounds of the magnitudes of the entries of the rows' Gram matrix:
/// `|a·b| ≤ min(|interval of a·b|, |a||b|, Σ|aₖ||bₖ|)`.
fn products(rows: &[[Interval; 3]], norms: &[f64]) -> [[f64; 3]; 3] {
    let mut gram = [[0.0; 3]; 3];
    for i in 0..rows.len() {
        gram[i][i] = product_up(norms[i], norms[i]);
        for j in 0..i {
            let dot = (0..3).fold(Interval::ZERO, |sum, k| sum.plus(rows[i][k].times(rows[j][k])));
            // The interval of the dot never exceeds the sum of the magnitudes.
            let entry = dot.most().min(product_up(norms[i], norms[j]));
            (gram[i][j], gram[j][i]) = (entry, entry);
        }
    }
    gram
}

/// An upper bound of the largest eigenvalue of every symmetric matrix with entries of at most these magnitudes
/// (L. Collatz, "Einschließungssatz für die charakteristischen Zahlen von Matrizen", 1942; H. Wielandt, 1950):
/// for a matrix without negative entries and any positive vector x it is at most `max (Ax)ᵢ / xᵢ`.
fn largest_eigenvalue(matrix: &[[f64; 3]; 3], size: usize) -> f64 {
    if size == 1 {
        return matrix[0][0];
    }
    if matrix.iter().flatten().any(|x| !x.is_finite()) {
        return f64::INFINITY;
    }
    let mut x = [1.0f64; 3];
    let mut least = f64::INFINITY;
    for _ in 0..24 {
        let mut image = [0.0f64; 3];
        for i in 0..size {
            image[i] = (0..size).fold(0.0, |sum, j| sum_up(sum, product_up(matrix[i][j], x[j])));
        }
        if image == [0.0; 3] {
            return 0.0;
        }
        let ratios = || (0..size).map(|i| image[i] / x[i]);
        let (most, fewest) = (ratios().fold(0.0, f64::max), ratios().fold(f64::INFINITY, f64::min));
        least = least.min(above(most));
        let largest = image.iter().fold(0.0, |m: f64, x| m.max(*x));
        if most - fewest <= 1e-15 * most {
            break;
        }
        // Every x stays positive; a shift towards the last one keeps alternating ones from staying apart.
        for i in 0..size {
            x[i] = (image[i] / largest + x[i]).max(1e-30) / 2.0;
        }
    }
    least
}

/// The largest singular value of the middles, and the norm of what the entries may be off from them.
fn by_middles(rows: &[[Interval; 3]]) -> f64 {
    let mut middles = [[0.0; 3]; 3];
    let mut radii = [0.0; 9];
    for (i, row) in rows.iter().enumerate() {
        for (k, x) in row.iter().enumerate() {
            let middle = x.middle();
            middles[i][k] = middle;
            radii[3 * i + k] = sum_up(x.hi, -middle).max(sum_up(middle, -x.lo));
        }
    }
    let mut gram = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            gram[i][j] = (0..3).map(|k| middles[i][k] * middles[j][k]).sum();
        }
    }
    let trace = gram[0][0] + gram[1][1] + gram[2][2];
    if !trace.is_finite() {
        return f64::INFINITY;
    }
    // Room for the roundings of the products and of the eigenvalue.
    let square = largest_eigenvalue_of(gram) + 1e-14 * trace;
    sum_up(above(square.max(0.0).sqrt()), norm_up(&radii))
}

/// The largest eigenvalue of a symmetric matrix, by Jacobi's rotations.
fn largest_eigenvalue_of(mut a: [[f64; 3]; 3]) -> f64 {
    for _ in 0..12 {
        let off = a[0][1].abs().max(a[0][2].abs()).max(a[1][2].abs());
        let size = a[0][0].abs() + a[1][1].abs() + a[2][2].abs();
        if off <= 1e-17 * size || size == 0.0 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = 1f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (x, y) = (a[p], a[q]);
            a[p] = std::array::from_fn(|k| c * x[k] - s * y[k]);
            a[q] = std::array::from_fn(|k| s * x[k] + c * y[k]);
        }
    }
    // Whatever rotations leave beside the diagonal is at most this (Gershgorin).
    (0..3)
        .map(|i| a[i][i] + (0..3).filter(|j| *j != i).map(|j| a[i][j].abs()).sum::<f64>())
        .fold(f64::MIN, f64::max)
}

#[cfg(test)]
mod tests {
    use super::largest_singular_value;
    use crate::interval::Interval;

    fn of(rows: [[f64; 3]; 3]) -> f64 {
        let norms = rows.map(|r| (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]).sqrt().next_up());
        largest_singular_value(&rows.map(|r| r.map(Interval::point)), &norms)
    }

    #[test]
    fn of_known_matrices() {
        assert!((of([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]) - 1.0).abs() < 1e-12);
        assert!((of([[3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]) - 3.0).abs() < 1e-12);
        // A shear by 2: (a + √(a² + 4)) / 2.
        assert!(
            (of([[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) - (1.0 + 2f64.sqrt())).abs() < 1e-12
        );
        // Signs matter: this one is a multiple of an orthogonal matrix.
        assert!((of([[1.0, 2.0, 2.0], [2.0, 1.0, -2.0], [2.0, -2.0, 1.0]]) - 3.0).abs() < 1e-12);
        assert!(of([[0.0; 3]; 3]) < 1e-150);
    }
}
