//! Small symmetric systems over any scalar: mass matrices and what friction holds.

use crate::scalar::Scalar;

/// `Σ aᵢ bᵢ`.
#[inline(always)]
pub fn dot<T: Scalar>(a: &[T], b: &[T]) -> T {
    // No closure: it would be compiled separately, without the instructions of a batch.
    let mut sum = T::zero();
    for (a, b) in a.iter().zip(b) {
        sum = sum + *a * *b;
    }
    sum
}

/// `L D Lᵀ` of a positive definite matrix of `count` rows in place: D⁻¹ on the diagonal, L below it and L D above, transposed.
#[inline(always)]
pub(crate) fn factor<T: Scalar>(matrix: &mut [T], count: usize) {
    for j in 0..count {
        for k in 0..j {
            let scaled = matrix[k * count + j];
            for i in j..count {
                matrix[i * count + j] = matrix[i * count + j] - matrix[i * count + k] * scaled;
            }
        }
        let per_pivot = T::one() / matrix[j * count + j];
        matrix[j * count + j] = per_pivot;
        for i in j + 1..count {
            matrix[j * count + i] = matrix[i * count + j];
            matrix[i * count + j] = matrix[i * count + j] * per_pivot;
        }
    }
}

/// Whether every pivot of a factored matrix is above its positive bound.
pub(crate) fn pivots_exceed(factors: &[f64], count: usize, bound: impl Fn(usize) -> f64) -> bool {
    (0..count).all(|k| {
        let per_pivot = factors[k * count + k];
        per_pivot > 0.0 && bound(k) * per_pivot < 1.0
    })
}

/// Solves a factored system in place.
#[inline(always)]
pub(crate) fn solve<T: Scalar>(factors: &[T], count: usize, right: &mut [T]) {
    for i in 0..count {
        for j in 0..i {
            right[i] = right[i] - factors[i * count + j] * right[j];
        }
    }
    for i in (0..count).rev() {
        right[i] = right[i] * factors[i * count + i];
        for j in i + 1..count {
            right[i] = right[i] - factors[j * count + i] * right[j];
        }
    }
}
