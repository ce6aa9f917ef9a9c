//! A symmetric system of as many equations as an arm has joints.

use ferntast_model::{JointCount, Joints, MAX_JOINTS, rigid_body::MassMatrix};

/// The Cholesky factor L of a positive definite matrix A = L Lᵀ.
pub(super) struct Factor {
    /// Lower triangle by rows; on the diagonal stands the inverse of what L has there.
    rows: [[f64; MAX_JOINTS]; MAX_JOINTS],
    count: JointCount,
}

impl Factor {
    /// Of the upper left part of `matrix` that has `count` rows.
    pub(super) fn new(matrix: &MassMatrix, count: JointCount) -> Factor {
        let mut rows = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        for row in 0..count.get() {
            for column in 0..=row {
                let found = dot(&rows[row][..column], &rows[column][..column]);
                let left = matrix[(row, column)] - found;
                rows[row][column] = if row == column {
                    // A matrix of masses is positive definite; rounding must not make a NaN.
                    1.0 / left.max(f64::MIN_POSITIVE).sqrt()
                } else {
                    left * rows[column][column]
                };
            }
        }
        Factor { rows, count }
    }

    /// x of A x = `right`.
    pub(super) fn solve(&self, right: &Joints<f64>) -> Joints<f64> {
        let count = self.count.get();
        let mut x = *right;
        for row in 0..count {
            let mut left = x[row];
            for column in 0..row {
                left -= self.rows[row][column] * x[column];
            }
            x[row] = left * self.rows[row][row];
        }
        for row in (0..count).rev() {
            let mut left = x[row];
            for below in row + 1..count {
                left -= self.rows[below][row] * x[below];
            }
            x[row] = left * self.rows[row][row];
        }
        x
    }
}

impl Factor {
    /// A⁻¹: the upper left part is that of the matrix.
    pub(super) fn inverse(&self) -> [[f64; MAX_JOINTS]; MAX_JOINTS] {
        let count = self.count.get();
        // The columns of L⁻¹, each in a row of this.
        let mut columns = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        for (column, own) in columns.iter_mut().enumerate().take(count) {
            own[column] = self.rows[column][column];
            for row in column + 1..count {
                let found = dot(&self.rows[row][column..row], &own[column..row]);
                own[row] = -found * self.rows[row][row];
            }
        }
        let mut inverse = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        for row in 0..count {
            for column in 0..=row {
                let value = dot(&columns[row], &columns[column]);
                inverse[row][column] = value;
                inverse[column][row] = value;
            }
        }
        inverse
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn what_is_solved_fulfils_the_equations(
            count in 1..=MAX_JOINTS,
            numbers in proptest::collection::vec(-1.0..1.0f64, MAX_JOINTS * MAX_JOINTS),
            right in proptest::array::uniform8(-10.0..10.0f64),
        ) {
            let any = MassMatrix::from_row_slice(&numbers);
            let matrix = any * any.transpose() + MassMatrix::identity() * 0.1;
            let count = JointCount::new(count).unwrap();
            let right = Joints::from_places(count, right);
            let x = Factor::new(&matrix, count).solve(&right);
            let inverse = Factor::new(&matrix, count).inverse();
            for row in 0..count.get() {
                let again: f64 = (0..count.get()).map(|column| inverse[row][column] * right[column]).sum();
                prop_assert!((again - x[row]).abs() < 1e-9 * (1.0 + x[row].abs()));
                let told: f64 = (0..count.get()).map(|column| matrix[(row, column)] * x[column]).sum();
                prop_assert!((told - right[row]).abs() < 1e-9);
            }
        }
    }
}
