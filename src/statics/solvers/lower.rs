//! Cholesky factors of small matrices of fixed size.
//!
//! Loops run over whole columns, whose entries above the diagonal are zero, so that the compiler makes straight vector code of
//! them: for 12 x 12 that costs less than loops of the exact lengths.

use nalgebra::{SMatrix, SVector};

/// A lower triangular L with `A = L L'`.
#[derive(Clone, Debug)]
pub struct Lower<const N: usize> {
    /// Its columns below the diagonal, zero elsewhere.
    below: [[f64; N]; N],
    /// One over its diagonal.
    inverse_diagonal: [f64; N],
}

impl<const N: usize> Lower<N> {
    /// The factor of a symmetric matrix, of which the lower triangle is read; `None` if it is not positive definite.
    pub fn new(matrix: &SMatrix<f64, N, N>) -> Option<Self> {
        let mut columns = matrix.data.0;
        let mut inverse_diagonal = [0.0; N];
        for j in 0..N {
            let pivot = columns[j][j];
            // Also false for NaN.
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            let inverse = 1.0 / pivot.sqrt();
            inverse_diagonal[j] = inverse;
            let mut column = columns[j];
            column[..=j].fill(0.0);
            column.iter_mut().for_each(|entry| *entry *= inverse);
            for k in j + 1..N {
                let factor = column[k];
                columns[k].iter_mut().zip(&column).for_each(|(entry, own)| *entry -= factor * own);
            }
            columns[j] = column;
        }
        Some(Self { below: columns, inverse_diagonal })
    }

    /// `L^-1 b`.
    pub fn forward(&self, b: &SVector<f64, N>) -> SVector<f64, N> {
        let mut x = b.data.0[0];
        self.forward_in_place(&mut x);
        SVector::from(x)
    }

    /// `L^-1 B`.
    pub fn forward_matrix<const M: usize>(&self, b: &SMatrix<f64, N, M>) -> SMatrix<f64, N, M> {
        let mut x = *b;
        x.data.0.iter_mut().for_each(|column| self.forward_in_place(column));
        x
    }

    fn forward_in_place(&self, x: &mut [f64; N]) {
        for j in 0..N {
            x[j] *= self.inverse_diagonal[j];
            let own = x[j];
            x.iter_mut().zip(&self.below[j]).for_each(|(entry, below)| *entry -= own * below);
        }
    }

    /// `L'^-1 b`.
    pub fn backward(&self, b: &SVector<f64, N>) -> SVector<f64, N> {
        let mut x = b.data.0[0];
        for j in (0..N).rev() {
            let mut products = [0.0; N];
            products
                .iter_mut()
                .zip(x.iter().zip(&self.below[j]))
                .for_each(|(sum, (entry, below))| *sum = entry * below);
            x[j] = (x[j] - products.iter().sum::<f64>()) * self.inverse_diagonal[j];
        }
        SVector::from(x)
    }

    /// `A^-1 b`.
    pub fn solve(&self, b: &SVector<f64, N>) -> SVector<f64, N> {
        self.backward(&self.forward(b))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_solution_is_that_of_nalgebra(numbers in prop::collection::vec(-1.0..1.0_f64, 12 * 12 + 12)) {
            let root = SMatrix::<f64, 12, 12>::from_column_slice(&numbers[..144]);
            let matrix = root * root.transpose() + SMatrix::identity() * 0.1;
            let b = SVector::<f64, 12>::from_column_slice(&numbers[144..]);
            let (found, expected) = (Lower::new(&matrix).unwrap(), matrix.cholesky().unwrap());
            // Condition numbers of a few hundred.
            prop_assert!((found.solve(&b) - expected.solve(&b)).amax() < 1e-11);
            prop_assert!((found.forward_matrix(&root).tr_mul(&found.forward(&b)) - root.tr_mul(&found.solve(&b))).amax() < 1e-11);
            let mut indefinite = matrix;
            indefinite[(7, 7)] = -1.0;
            prop_assert!(Lower::new(&indefinite).is_none());
            indefinite[(7, 7)] = f64::NAN;
            prop_assert!(Lower::new(&indefinite).is_none());
        }
    }
}
