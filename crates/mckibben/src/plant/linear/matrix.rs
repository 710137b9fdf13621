//! Linear equations of a few unknowns without symmetry: Gaussian elimination with row exchange.

use alloc::vec::Vec;

/// Solves `matrix · x = right`, the matrix row by row; `None` where it is singular.
pub(super) fn solve(mut matrix: Vec<f64>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let count = right.len();
    for column in 0..count {
        let size = |row: &usize| matrix[row * count + column].abs();
        let pivot = (column..count).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let largest = matrix[pivot * count + column];
        if !(largest.abs() > 0.0 && largest.is_finite()) {
            return None;
        }
        if pivot != column {
            for k in 0..count {
                matrix.swap(pivot * count + k, column * count + k);
            }
            right.swap(pivot, column);
        }
        for row in column + 1..count {
            let factor = matrix[row * count + column] / largest;
            if factor != 0.0 {
                for k in column..count {
                    matrix[row * count + k] -= factor * matrix[column * count + k];
                }
                right[row] -= factor * right[column];
            }
        }
    }
    for row in (0..count).rev() {
        let sum: f64 = (row + 1..count).map(|k| matrix[row * count + k] * right[k]).sum();
        right[row] = (right[row] - sum) / matrix[row * count + row];
    }
    right.iter().all(|value| value.is_finite()).then_some(right)
}
