//! Derivatives of the effort along motions of the arm.
//!
//! With the multipliers y of the optimum, the muscles' moments `b_i` and what is demanded, tau:
//!
//! ```text
//! B a + r = tau          a_i = b_i . y / 2 between its limits,   r_k = y_k r0_k^2 / 100
//! H y' = tau' - B' a - 1/2 sum_free b_i (b_i' . y)               H = 1/2 sum_free b_i b_i' + diag(r0^2 / 100)
//! (sum a^2 + 50 sum (r / r0)^2)' = y . (tau' - B' a)             envelope theorem
//! (sum a^2)' = y . (tau' - B' a) - r . y'
//! ```

use nalgebra::{SMatrix, Vector3};

use super::{
    ArmLoad, MISSING_LIMIT_NM, MuscleEffort, Muscles,
    activation::{MOMENTS, MUSCLES, Moments, Optimum, optimum},
    beyond_rad, demanded_nm,
    path::{Curvature, MusclePosture, PostureRate, Pull, SHOULDER, moments_nm, pulls},
};

/// The effort and its derivatives by the seven angles of the arm.
#[derive(Clone, Debug)]
pub(in crate::human) struct EffortSlopes {
    /// The effort itself.
    pub effort: MuscleEffort,
    /// Derivative of the effort by each angle, 1/rad.
    pub effort_slopes: [f64; 7],
    /// Derivatives of the shares of the missing moments: one row per moment, one column per angle, 1/rad.
    pub missing_slopes: [[f64; 7]; MOMENTS],
}

impl Muscles {
    /// The effort and its derivatives. `axes_v` are the axes of the three shoulder angles in V, `slopes_nm` for each angle the
    /// derivatives of the moments about shoulder, elbow and wrist in V, N m/rad.
    pub(in crate::human) fn effort_slopes(
        &self,
        load: &ArmLoad<'_>,
        axes_v: [&Vector3<f64>; SHOULDER],
        slopes_nm: &[[Vector3<f64>; 3]; 7],
    ) -> Option<EffortSlopes> {
        let (posture, beyond_rates) = MusclePosture::new(load.r_vu, beyond_rad(load.q_rad));
        let shoulder_monomials = posture.shoulder_monomials();
        let pulls = pulls(&posture, &shoulder_monomials);
        let of_muscles = moments_nm(&pulls, self.factor);
        let found = optimum(&of_muscles, &demanded_nm(&posture, load.moments_nm))?;
        let curvature = Curvature::new(&posture, shoulder_monomials);
        let sensitivity = Sensitivity {
            by_activation: self.moment_slopes(&found, &pulls, &curvature),
            by_drive: self.drive_slopes(&found, &pulls, &curvature),
        };
        let rate = |angle: usize| match axes_v.get(angle) {
            Some(axis) => Moments::from_fn(|k, _| if k < SHOULDER { axis[k] } else { 0.0 }),
            None => beyond_rates[angle - SHOULDER],
        };
        let mut slopes = EffortSlopes {
            effort: MuscleEffort::of(&found),
            effort_slopes: [0.0; 7],
            missing_slopes: [[0.0; 7]; MOMENTS],
        };
        for (angle, of_angle) in slopes_nm.iter().enumerate() {
            let rate = rate(angle);
            let demanded = demanded_slope(&posture, load.moments_nm, of_angle, &rate);
            let unmet = demanded - sensitivity.by_activation * rate;
            let multipliers = found.solve(&(unmet - sensitivity.by_drive * rate));
            slopes.effort_slopes[angle] = found.multipliers.dot(&unmet) - found.reserves_nm.dot(&multipliers);
            for moment in 0..MOMENTS {
                let slope = multipliers[moment] * Optimum::reserve_slope(moment) / MISSING_LIMIT_NM;
                slopes.missing_slopes[moment][angle] = slope * found.reserves_nm[moment].signum();
            }
        }
        Some(slopes)
    }

    /// `sum a_i d b_i / d(posture)`, with `b = -F(l) grad l`.
    fn moment_slopes(
        &self,
        found: &Optimum,
        pulls: &[Pull; MUSCLES],
        curvature: &Curvature,
    ) -> SMatrix<f64, MOMENTS, MOMENTS> {
        let weights: [f64; MUSCLES] = std::array::from_fn(|muscle| found.activations[muscle] * pulls[muscle].force_n);
        let mut sum = curvature.weighted(&weights);
        for (pull, activation) in pulls.iter().zip(found.activations).filter(|(_, activation)| *activation > 0.0) {
            sum += pull.length_slopes * (pull.length_slopes * (activation * pull.force_slope)).transpose();
        }
        sum * -self.factor
    }

    /// `1/2 sum_free b_i d(b_i . y) / d(posture)`.
    fn drive_slopes(
        &self,
        found: &Optimum,
        pulls: &[Pull; MUSCLES],
        curvature: &Curvature,
    ) -> SMatrix<f64, MOMENTS, MOMENTS> {
        let rate_slopes = curvature.rate_slopes(&found.multipliers);
        let mut sum = SMatrix::zeros();
        for (muscle, pull) in pulls.iter().enumerate().filter(|(muscle, _)| found.is_free(*muscle)) {
            let rate = pull.length_slopes.dot(&found.multipliers);
            let drive = rate_slopes.of_muscle(muscle) * pull.force_n + pull.length_slopes * (pull.force_slope * rate);
            // Both factors have the sign of -F.
            sum += pull.length_slopes * pull.force_n * drive.transpose();
        }
        sum * (self.factor * self.factor / 2.0)
    }
}

/// How the balance of moments changes with the posture.
struct Sensitivity {
    by_activation: SMatrix<f64, MOMENTS, MOMENTS>,
    by_drive: SMatrix<f64, MOMENTS, MOMENTS>,
}

/// Derivative of the demanded moments along a motion that changes the moments about the joints by `slopes_nm` and turns the axes.
fn demanded_slope(
    posture: &MusclePosture,
    moments_nm: &[Vector3<f64>; 3],
    slopes_nm: &[Vector3<f64>; 3],
    rate: &PostureRate,
) -> Moments {
    let mut turn = Vector3::new(rate[0], rate[1], rate[2]);
    let mut slope = Moments::zeros();
    (0..SHOULDER).for_each(|k| slope[k] = slopes_nm[0][k]);
    for (k, axis) in posture.axes_v.iter().enumerate() {
        let joint = if k < 2 { 1 } else { 2 };
        slope[SHOULDER + k] = slopes_nm[joint].dot(axis) + moments_nm[joint].dot(&turn.cross(axis));
        turn += axis * rate[SHOULDER + k];
    }
    slope
}
