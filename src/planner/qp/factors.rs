//! The factorisation of the active constraints of a quadratic program: `J J'` is the inverse Hessian, and `J' N = [R; 0]` with the
//! active normals N and an upper triangular R (Goldfarb and Idnani 1983, section 4).

use nalgebra::{DMatrix, DVector};

/// J and R, of n variables and q active constraints.
pub struct Factors {
    n: usize,
    active: usize,
    /// J by columns, n x n.
    j: Vec<f64>,
    /// R by columns, the first q of n x n.
    r: Vec<f64>,
    /// `J' n` of the constraint of the last [`Factors::direction`].
    projected: Vec<f64>,
    /// Memory of one column.
    column: Vec<f64>,
}

impl Factors {
    /// Without active constraints; `None` if the Hessian is not positive definite.
    pub fn new(hessian: &DMatrix<f64>) -> Option<Self> {
        let n = hessian.nrows();
        let factor = hessian.clone().cholesky()?;
        let l = factor.l_dirty();
        // J is the inverse of L': its column k, which has k + 1 entries, is row k of the inverse of L.
        let mut j = vec![0.0; n * n];
        for k in 0..n {
            let (done, own) = j.split_at_mut(k * n);
            let own = &mut own[..n];
            for before in 0..k {
                axpy(&mut own[..=before], -l[(k, before)], &done[before * n..=before * n + before]);
            }
            own[k] = 1.0;
            let scale = 1.0 / l[(k, k)];
            own[..=k].iter_mut().for_each(|entry| *entry *= scale);
        }
        Some(Self { n, active: 0, j, r: vec![0.0; n * n], projected: vec![0.0; n], column: vec![0.0; n] })
    }

    fn column(&self, k: usize) -> &[f64] {
        &self.j[k * self.n..(k + 1) * self.n]
    }

    /// The inverse Hessian times a vector.
    pub fn unconstrained(&self, gradient: &DVector<f64>) -> Vec<f64> {
        let mut product = vec![0.0; self.n];
        for k in 0..self.n {
            axpy(&mut product, dot(self.column(k), gradient.as_slice()), self.column(k));
        }
        product
    }

    /// The largest entry of the inverse Hessian, which is on its diagonal.
    pub fn largest_of_inverse(&self) -> f64 {
        let mut diagonal = vec![0.0; self.n];
        for k in 0..self.n {
            diagonal.iter_mut().zip(self.column(k)).for_each(|(sum, entry)| *sum += entry * entry);
        }
        diagonal.into_iter().fold(0.0, f64::max)
    }

    /// How the solution changes as the multiplier of a further constraint grows: writes its own change and the rates at which
    /// the active multipliers fall, and returns the rate at which the constraint's margin grows.
    pub fn direction(&mut self, normal: &[f64], primal: &mut [f64], dual: &mut Vec<f64>) -> f64 {
        let (n, active) = (self.n, self.active);
        for k in 0..n {
            self.projected[k] = dot(&self.j[k * n..(k + 1) * n], normal);
        }
        primal.fill(0.0);
        for k in active..n {
            axpy(primal, self.projected[k], self.column(k));
        }
        dual.clear();
        dual.extend_from_slice(&self.projected[..active]);
        for k in (0..active).rev() {
            let own = &self.r[k * n..k * n + active];
            dual[k] /= own[k];
            let rate = dual[k];
            axpy(&mut dual[..k], -rate, &own[..k]);
        }
        let free = &self.projected[active..];
        dot(free, free)
    }

    /// Makes the constraint of the last [`Factors::direction`] active: a reflection of the free columns of J leaves it in one.
    pub fn add(&mut self) {
        let (n, active) = (self.n, self.active);
        let free = &mut self.projected[active..];
        let length = dot(free, free).sqrt();
        let pivot = if free[0] > 0.0 { -length } else { length };
        free[0] -= pivot;
        let scale = 2.0 / dot(free, free);
        if scale.is_finite() {
            self.column.fill(0.0);
            for (k, entry) in free.iter().enumerate() {
                axpy(&mut self.column, *entry, &self.j[(active + k) * n..(active + k + 1) * n]);
            }
            for (k, entry) in free.iter().enumerate() {
                axpy(&mut self.j[(active + k) * n..(active + k + 1) * n], -scale * entry, &self.column);
            }
        }
        let own = &mut self.r[active * n..active * n + active + 1];
        own[..active].copy_from_slice(&self.projected[..active]);
        own[active] = pivot;
        self.active += 1;
    }

    /// Makes an active constraint inactive: rotations of adjacent columns of J make R triangular again.
    pub fn remove(&mut self, number: usize) {
        let (n, active) = (self.n, self.active);
        self.r.copy_within((number + 1) * n..active * n, number * n);
        self.active -= 1;
        for k in number..self.active {
            let [a, b] = [self.r[k * n + k], self.r[k * n + k + 1]];
            let length = a.hypot(b);
            if length == 0.0 {
                continue;
            }
            let (cos, sin) = (a / length, b / length);
            for column in k..self.active {
                let pair = &mut self.r[column * n + k..column * n + k + 2];
                (pair[0], pair[1]) = (cos * pair[0] + sin * pair[1], cos * pair[1] - sin * pair[0]);
            }
            let (first, second) = self.j[k * n..(k + 2) * n].split_at_mut(n);
            for (one, other) in first.iter_mut().zip(second) {
                (*one, *other) = (cos * *one + sin * *other, cos * *other - sin * *one);
            }
        }
    }
}

/// The product of two vectors, in four sums that do not wait for each other.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (fours_a, fours_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = fours_a.remainder().iter().zip(fours_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in fours_a.zip(fours_b) {
        (0..4).for_each(|lane| sums[lane] += a[lane] * b[lane]);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Adds a multiple of a vector.
pub fn axpy(sum: &mut [f64], factor: f64, vector: &[f64]) {
    sum.iter_mut().zip(vector).for_each(|(sum, entry)| *sum += factor * entry);
}
