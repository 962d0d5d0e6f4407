//! The activations of the muscles by static optimisation (docs/method.md#417-activations).
//!
//! ```text
//! minimise sum a_i^2 + 50 sum (r_k / r0_k)^2   subject to   B a + r = tau,  0 <= a_i <= 1
//! ```
//!
//! with the moments `b_i` (columns of B) of the muscles at full activation, the demanded moments tau and reserves r, which keep
//! the program feasible. With multipliers y of the moments the minimum over a and r is `a_i = clamp(b_i . y / 2)`,
//! `r_k = y_k r0_k^2 / 100`, so the dual has seven unknowns. It is concave with piecewise linear gradient `tau - B a - r`:
//! Newton steps with a line search end exactly on the piece of the optimum.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

/// Moments that a posture demands: three about the shoulder, then elbow, pronation, deviation, flexion of the wrist.
pub const MOMENTS: usize = 7;

/// Muscles of the arm.
pub const MUSCLES: usize = 50;

/// One value for each moment, N m.
pub(super) type Moments = SVector<f64, MOMENTS>;

/// Moments of each muscle at full activation, N m.
pub(super) type MuscleMoments = [Moments; MUSCLES];

/// Size r0 of a reserve whose weight is that of a full activation of 50 muscles, N m.
const RESERVE_NM: [f64; MOMENTS] = [1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5];

/// Weight of a reserve.
const RESERVE_WEIGHT: f64 = 50.0;

/// Newton steps. Random programs take three to twelve.
const MOST_STEPS: usize = 60;

/// A piece of the dual is left if the residual is larger than this share of the moments.
const RESIDUAL: f64 = 1e-11;

/// Iterations of the line search, which ends on a piece after a few.
const MOST_SHARES: usize = 60;

/// The solution of the program.
#[derive(Clone, Debug)]
pub(super) struct Optimum {
    /// The activation of each muscle, 0 to 1.
    pub activations: [f64; MUSCLES],
    /// Multipliers y of the moments, 1/(N m): the derivatives of the minimum by the demanded moments.
    pub multipliers: Moments,
    /// Moments that no muscle gives, N m.
    pub reserves_nm: Moments,
    /// The factor of `H = 1/2 sum_free b b' + diag(r0^2 / 100)` over the muscles between their limits.
    factor: Cholesky<f64, Const<MOMENTS>>,
}

impl Optimum {
    /// True for a muscle between its limits.
    pub fn is_free(&self, muscle: usize) -> bool {
        let activation = self.activations[muscle];
        activation > 0.0 && activation < 1.0
    }

    /// `H^-1 x`.
    pub fn solve(&self, x: &Moments) -> Moments {
        self.factor.solve(x)
    }

    /// Derivative of a reserve by its multiplier, (N m)^2.
    pub fn reserve_slope(moment: usize) -> f64 {
        RESERVE_NM[moment] * RESERVE_NM[moment] / (2.0 * RESERVE_WEIGHT)
    }
}

/// A point of the dual.
struct Point {
    multipliers: Moments,
    activations: [f64; MUSCLES],
    residual: Moments,
}

impl Point {
    fn new(of_muscles: &MuscleMoments, demanded_nm: &Moments, multipliers: Moments) -> Self {
        let mut residual = *demanded_nm;
        let mut activations = [0.0; MUSCLES];
        for (activation, moments) in activations.iter_mut().zip(of_muscles) {
            *activation = (moments.dot(&multipliers) / 2.0).clamp(0.0, 1.0);
            if *activation > 0.0 {
                residual -= moments * *activation;
            }
        }
        for moment in 0..MOMENTS {
            residual[moment] -= multipliers[moment] * Optimum::reserve_slope(moment);
        }
        Self { multipliers, activations, residual }
    }
}

/// `1/2 sum b b' + diag(r0^2 / 100)` over the muscles that are picked, factored. It is positive definite whatever the muscles.
fn curvature(of_muscles: &MuscleMoments, pick: impl Fn(usize) -> bool) -> Option<Cholesky<f64, Const<MOMENTS>>> {
    let mut matrix = SMatrix::<f64, MOMENTS, MOMENTS>::zeros();
    for moment in 0..MOMENTS {
        matrix[(moment, moment)] = Optimum::reserve_slope(moment);
    }
    for (_, moments) in of_muscles.iter().enumerate().filter(|(muscle, _)| pick(*muscle)) {
        for column in 0..MOMENTS {
            let half = moments[column] / 2.0;
            for row in column..MOMENTS {
                matrix[(row, column)] += moments[row] * half;
            }
        }
    }
    matrix.cholesky()
}

/// The share of a step, at most 1, at which the dual is largest along it: where its slope `step . (tau - B a - r)`, which falls
/// piecewise linearly, is zero.
fn best_share(of_muscles: &MuscleMoments, multipliers: &Moments, residual: &Moments, step: &Moments) -> f64 {
    let lines: [[f64; 3]; MUSCLES] = std::array::from_fn(|muscle| {
        let moments = &of_muscles[muscle];
        let drive = moments.dot(multipliers);
        [drive, moments.dot(step), (drive / 2.0).clamp(0.0, 1.0)]
    });
    let reserve: f64 = (0..MOMENTS).map(|moment| Optimum::reserve_slope(moment) * step[moment] * step[moment]).sum();
    let rise = residual.dot(step);
    // The slope at a share, and how fast it falls.
    let at = |share: f64| {
        let (mut slope, mut fall) = (rise - share * reserve, reserve);
        for [drive, change, activation] in lines {
            let moved = (drive + share * change) / 2.0;
            slope -= change * (moved.clamp(0.0, 1.0) - activation);
            fall += if moved > 0.0 && moved < 1.0 { change * change / 2.0 } else { 0.0 };
        }
        (slope, fall)
    };
    let (mut low, mut high, mut share) = (0.0, 1.0, 1.0);
    for _ in 0..MOST_SHARES {
        let (slope, fall) = at(share);
        if slope.abs() <= 1e-12 * rise || (slope > 0.0 && share == 1.0) {
            break;
        }
        if slope > 0.0 {
            low = share;
        } else {
            high = share;
        }
        let next = share + slope / fall;
        share = if next > low && next < high { next } else { (low + high) / 2.0 };
    }
    share
}

/// The activations that exert the demanded moments; `None` if a number is not finite.
pub(super) fn optimum(of_muscles: &MuscleMoments, demanded_nm: &Moments) -> Option<Optimum> {
    // The optimum of muscles that could also push.
    let start = curvature(of_muscles, |_| true)?.solve(demanded_nm);
    let mut point = Point::new(of_muscles, demanded_nm, start);
    let tolerance = RESIDUAL * (1.0 + demanded_nm.norm());
    for _ in 0..MOST_STEPS {
        let is_free = |muscle: usize| point.activations[muscle] > 0.0 && point.activations[muscle] < 1.0;
        let factor = curvature(of_muscles, is_free)?;
        let Point { multipliers, activations, residual } = &point;
        if residual.norm() <= tolerance {
            let reserves_nm = Moments::from_fn(|moment, _| multipliers[moment] * Optimum::reserve_slope(moment));
            return Some(Optimum { activations: *activations, multipliers: *multipliers, reserves_nm, factor });
        }
        let step = factor.solve(residual);
        let share = best_share(of_muscles, multipliers, residual, &step);
        point = Point::new(of_muscles, demanded_nm, multipliers + step * share);
    }
    None
}
