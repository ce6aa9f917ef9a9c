//! A covariance as P = U D Uᵀ: U unit upper triangular, D diagonal and never negative.
//!
//! Bierman, *Factorization Methods for Discrete Sequential Estimation*,
//! Academic Press 1977, chapter V.3. P stays symmetric and
//! positive semidefinite whatever rounding does.

/// The factors of an n×n matrix. Nothing is allocated after [`Factor::diagonal`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Factor {
    n: usize,
    /// U, row by row; what is not above the diagonal is not used.
    u: Box<[f64]>,
    d: Box<[f64]>,
    /// Uᵀ φ.
    f: Box<[f64]>,
    /// D Uᵀ φ.
    v: Box<[f64]>,
    /// P φ.
    projected: Box<[f64]>,
    scratch: Box<[f64]>,
}

impl Factor {
    /// P = diag(`variances`).
    pub(super) fn diagonal(variances: &[f64]) -> Self {
        let n = variances.len();
        let zeros = || vec![0.0; n].into_boxed_slice();
        Self {
            n,
            u: vec![0.0; n * n].into_boxed_slice(),
            d: variances.into(),
            f: zeros(),
            v: zeros(),
            projected: zeros(),
            scratch: zeros(),
        }
    }

    /// Back to P = diag(`variances`).
    pub(super) fn reset(&mut self, variances: &[f64]) {
        self.u.fill(0.0);
        self.d.copy_from_slice(variances);
    }

    /// Prepares a direction: keeps Uᵀ φ and P φ, returns ζ = φᵀ P φ.
    pub(super) fn look_along(&mut self, phi: &[f64]) -> f64 {
        let n = self.n;
        let mut zeta = 0.0;
        for j in 0..n {
            let above: f64 = (0..j).map(|i| self.u[i * n + j] * phi[i]).sum();
            self.f[j] = phi[j] + above;
            self.v[j] = self.d[j] * self.f[j];
            zeta += self.f[j] * self.v[j];
        }
        for i in 0..n {
            let right: f64 = (i + 1..n).map(|j| self.u[i * n + j] * self.v[j]).sum();
            self.projected[i] = self.v[i] + right;
        }
        zeta
    }

    /// P φ of the direction last looked along.
    pub(super) fn projected(&self) -> &[f64] {
        &self.projected
    }

    /// P ← P − P φ φᵀ P / (r + ζ) along the direction last looked along; r > 0.
    pub(super) fn measure(&mut self, r: f64) {
        let n = self.n;
        let mut alpha = r;
        for j in 0..n {
            let (f, v) = (self.f[j], self.v[j]);
            let next = alpha + f * v;
            self.d[j] *= alpha / next;
            self.scratch[j] = v;
            let turn = -f / alpha;
            for i in 0..j {
                let u = self.u[i * n + j];
                self.u[i * n + j] = u + self.scratch[i] * turn;
                self.scratch[i] += u * v;
            }
            alpha = next;
        }
    }

    /// P ← s P; what was looked along is scaled with it.
    pub(super) fn scale(&mut self, s: f64) {
        for part in [&mut self.d, &mut self.v, &mut self.projected] {
            part.iter_mut().for_each(|x| *x *= s);
        }
    }

    /// P_ij.
    pub(super) fn at(&self, i: usize, j: usize) -> f64 {
        let (low, high) = (i.min(j), i.max(j));
        let unit = |row: usize, column: usize| {
            if row == column {
                1.0
            } else {
                self.u[row * self.n + column]
            }
        };
        (high..self.n)
            .map(|k| unit(low, k) * self.d[k] * unit(high, k))
            .sum()
    }

    /// Whether every number in it is finite.
    pub(super) fn is_finite(&self) -> bool {
        self.u.iter().chain(&self.d).all(|x| x.is_finite())
    }
}
