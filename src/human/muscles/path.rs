//! From the arm's posture to the muscles' moments (docs/method.md#416-muscles).
//!
//! The posture of the muscles is the upper arm's orientation in V and four coordinates beyond the shoulder, whose axes are not
//! quite ours: forearm and hand of the source are not in line with the upper arm. The correction was fitted over the angles q4 to
//! q7. A muscle's length is the sum of a part over the upper arm's orientation and a part over the four coordinates, and its
//! moment at full activation is by virtual work `-F(l) dl`: about the axes of V for the shoulder, and per radian of a coordinate.

use libm::sincos;
use nalgebra::{Matrix3, Quaternion, Rotation3, SMatrix, UnitQuaternion, Vector3};

use super::{
    activation::{MOMENTS, MUSCLES, Moments, MuscleMoments},
    basis::{Hessian, Row, VARIABLES},
    data::{DATA, Muscle, force_length},
};

/// Components of the shoulder's rotation.
pub(super) const SHOULDER: usize = 3;

/// A length and its derivatives by a small rotation of the upper arm about the axes of V.
pub(super) type ShoulderRow = [f64; 1 + SHOULDER];

/// Rates of the muscles' posture along one direction of motion: the angular velocity of the upper arm in V, then the rates of
/// the four coordinates.
pub(super) type PostureRate = Moments;

/// The posture of the muscles.
pub(super) struct MusclePosture {
    /// Quaternion (w, x, y, z) of the corrected upper arm in V.
    pub quaternion: [f64; VARIABLES],
    /// Coordinates of elbow, pronation, deviation, flexion, rad.
    pub coordinates_rad: [f64; VARIABLES],
    /// The axes of the coordinates in V.
    pub axes_v: [Vector3<f64>; VARIABLES],
}

impl MusclePosture {
    /// The posture of an arm whose upper arm is at `r_vu`, with the angles `beyond_rad` (q4 to q7); also its rates by the
    /// four angles.
    pub fn new(r_vu: &Matrix3<f64>, beyond_rad: [f64; VARIABLES]) -> (Self, [PostureRate; VARIABLES]) {
        let mut outputs = [[0.0; 1 + VARIABLES]; MOMENTS];
        for (row, coefficients) in DATA.angles.rows(&beyond_rad).iter().zip(&DATA.angle_coefficients) {
            for (output, coefficient) in outputs.iter_mut().zip(coefficients) {
                output.iter_mut().zip(row).for_each(|(sum, monomial)| *sum += coefficient * monomial);
            }
        }
        // The correction is the rotation with this Gibbs vector, tan(angle / 2) times its axis.
        let gibbs = |part: usize| Vector3::new(outputs[0][part], outputs[1][part], outputs[2][part]);
        let (g, scale) = (gibbs(0), 1.0 + gibbs(0).norm_squared());
        let upper_arm = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*r_vu));
        let turned = upper_arm.into_inner() * Quaternion::from_parts(1.0, g) / scale.sqrt();
        let r_corrected = UnitQuaternion::new_unchecked(turned).to_rotation_matrix();
        let coordinates_rad = [3, 4, 5, 6].map(|output: usize| outputs[output][0]);
        let rate = |angle: usize| {
            let rate = gibbs(1 + angle);
            let turn = r_vu * ((rate + g.cross(&rate)) * (2.0 / scale));
            let coordinate = |k: usize| outputs[SHOULDER + k][1 + angle];
            Moments::from_fn(|k, _| if k < SHOULDER { turn[k] } else { coordinate(k - SHOULDER) })
        };
        let posture = Self {
            quaternion: [turned.w, turned.i, turned.j, turned.k],
            coordinates_rad,
            axes_v: axes_v(r_corrected.matrix(), &coordinates_rad),
        };
        (posture, std::array::from_fn(rate))
    }

    /// Derivatives of the quaternion by a small rotation about each axis of V, `1/2 (0, e_k) q`.
    pub fn quaternion_rates(&self) -> [[f64; VARIABLES]; SHOULDER] {
        let [w, x, y, z] = self.quaternion.map(|component| component / 2.0);
        [[-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]]
    }

    /// The monomials of the shoulder at this posture.
    pub fn shoulder_monomials(&self) -> Vec<Row> {
        DATA.shoulder.rows(&self.quaternion)
    }

    /// The monomials of the shoulder as functions of its rotation.
    fn by_rotation(&self, shoulder_monomials: &[Row]) -> Vec<ShoulderRow> {
        let rates = self.quaternion_rates();
        let of_rotation = |row: &Row| {
            let slope = |k: usize| (0..VARIABLES).map(|c| row[1 + c] * rates[k][c]).sum();
            [row[0], slope(0), slope(1), slope(2)]
        };
        shoulder_monomials.iter().map(of_rotation).collect()
    }
}

/// The axes of the coordinates in V: each is turned by the coordinates before it.
fn axes_v(r_vu: &Matrix3<f64>, coordinates_rad: &[f64; VARIABLES]) -> [Vector3<f64>; VARIABLES] {
    let mut axes_v = DATA.axes_u.map(|axis| r_vu * axis);
    for turning in 0..VARIABLES {
        let axis = axes_v[turning];
        let (sin, cos) = sincos(coordinates_rad[turning]);
        for turned in &mut axes_v[turning + 1..] {
            *turned = *turned * cos + axis.cross(turned) * sin + axis * (axis.dot(turned) * (1.0 - cos));
        }
    }
    axes_v
}

/// A muscle at a posture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pull {
    /// Derivatives of the length by the posture: by a rotation of the upper arm about the axes of V, m, then by the coordinates,
    /// m/rad.
    pub length_slopes: Moments,
    /// Force at full activation, N.
    pub force_n: f64,
    /// Derivative of the force by the length, N/m.
    pub force_slope: f64,
}

impl Pull {
    fn new(muscle: &Muscle, shoulder_rows: &[ShoulderRow], beyond_rows: &[Row]) -> Self {
        let shoulder = weighted_sum(&muscle.shoulder_m, shoulder_rows);
        let beyond = weighted_sum(&muscle.beyond_m, beyond_rows);
        let length = (muscle.constant_m + shoulder[0] + beyond[0]) / muscle.fibre_m;
        let [force, slope] = force_length(length, muscle.fibre_range);
        let part = |k: usize| if k < SHOULDER { shoulder[1 + k] } else { beyond[1 + k - SHOULDER] };
        Self {
            length_slopes: Moments::from_fn(|k, _| part(k)),
            force_n: muscle.force_n * force,
            force_slope: muscle.force_n * slope / muscle.fibre_m,
        }
    }

    /// Its moments at full activation, N m.
    pub fn moments_nm(&self) -> Moments {
        self.length_slopes * -self.force_n
    }
}

/// `sum coefficient row`.
fn weighted_sum<const N: usize>(coefficients: &[f64], rows: &[[f64; N]]) -> [f64; N] {
    let mut sum = [0.0; N];
    for (coefficient, row) in coefficients.iter().zip(rows) {
        sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += coefficient * value);
    }
    sum
}

/// All muscles at a posture, with its monomials of the shoulder.
pub(super) fn pulls(posture: &MusclePosture, shoulder_monomials: &[Row]) -> [Pull; MUSCLES] {
    let (shoulder, beyond) = (posture.by_rotation(shoulder_monomials), DATA.beyond.rows(&posture.coordinates_rad));
    std::array::from_fn(|muscle| Pull::new(&DATA.muscles[muscle], &shoulder, &beyond))
}

/// Moments of all muscles at full activation, times a factor, N m.
pub(super) fn moments_nm(pulls: &[Pull; MUSCLES], factor: f64) -> MuscleMoments {
    std::array::from_fn(|muscle| pulls[muscle].moments_nm() * factor)
}

/// Second derivatives of lengths at a posture.
pub(super) struct Curvature {
    quaternion_rates: [[f64; VARIABLES]; SHOULDER],
    /// Rate of the quaternion's rate by a rotation about axis k, if the arm turns about axis l.
    second_rates: [[[f64; VARIABLES]; SHOULDER]; SHOULDER],
    shoulder_rows: Vec<Row>,
    shoulder_hessians: Vec<Hessian>,
    beyond_hessians: Vec<Hessian>,
}

/// Derivatives of the rate of length along one direction by the posture, of every monomial.
pub(super) struct RateSlopes {
    shoulder: Vec<[f64; SHOULDER]>,
    beyond: Vec<[f64; VARIABLES]>,
}

impl Curvature {
    /// The curvature at a posture, with its monomials of the shoulder.
    pub fn new(posture: &MusclePosture, shoulder_rows: Vec<Row>) -> Self {
        // After a small rotation about e_l the quaternion's rate by a rotation about e_k is 1/4 (0, e_k) (0, e_l) q more.
        let second_rate = |k: usize, l: usize| {
            let half = |axis: usize| Quaternion::from_imag(Vector3::ith(axis, 0.5));
            let [w, x, y, z] = posture.quaternion;
            let rate = half(k) * half(l) * Quaternion::new(w, x, y, z);
            [rate.w, rate.i, rate.j, rate.k]
        };
        Self {
            quaternion_rates: posture.quaternion_rates(),
            second_rates: std::array::from_fn(|k| std::array::from_fn(|l| second_rate(k, l))),
            shoulder_rows,
            shoulder_hessians: DATA.shoulder.hessians(&posture.quaternion),
            beyond_hessians: DATA.beyond.hessians(&posture.coordinates_rad),
        }
    }

    /// Derivatives by the posture of every monomial's rate along a direction.
    pub fn rate_slopes(&self, direction: &PostureRate) -> RateSlopes {
        let mixed = |rates: &[[f64; VARIABLES]; SHOULDER]| -> [f64; VARIABLES] {
            std::array::from_fn(|c| (0..SHOULDER).map(|k| direction[k] * rates[k][c]).sum())
        };
        let rate = mixed(&self.quaternion_rates);
        let second: [[f64; VARIABLES]; SHOULDER] =
            std::array::from_fn(|l| mixed(&std::array::from_fn(|k| self.second_rates[k][l])));
        let of_shoulder = |(row, hessian): (&Row, &Hessian)| {
            let bent = times(hessian, &rate);
            std::array::from_fn(|l| dot(&self.quaternion_rates[l], &bent) + dot(&second[l], &slopes_of(row)))
        };
        let of_beyond = std::array::from_fn(|k| direction[SHOULDER + k]);
        RateSlopes {
            shoulder: self.shoulder_rows.iter().zip(&self.shoulder_hessians).map(of_shoulder).collect(),
            beyond: self.beyond_hessians.iter().map(|hessian| times(hessian, &of_beyond)).collect(),
        }
    }

    /// `sum w_i d(grad l_i)/d(posture)` over the muscles: row k, column l is the derivative by l of the slope by k.
    pub fn weighted(&self, weights: &[f64; MUSCLES]) -> SMatrix<f64, MOMENTS, MOMENTS> {
        let mut shoulder = vec![0.0; self.shoulder_rows.len()];
        let mut beyond = vec![0.0; self.beyond_hessians.len()];
        for (weight, muscle) in weights.iter().zip(&DATA.muscles).filter(|(weight, _)| **weight != 0.0) {
            shoulder.iter_mut().zip(&muscle.shoulder_m).for_each(|(sum, coefficient)| *sum += weight * coefficient);
            beyond.iter_mut().zip(&muscle.beyond_m).for_each(|(sum, coefficient)| *sum += weight * coefficient);
        }
        let slopes = slopes_of(&weighted_sum(&shoulder, &self.shoulder_rows));
        let of_quaternion = weighted_matrix(&shoulder, &self.shoulder_hessians);
        let of_coordinates = weighted_matrix(&beyond, &self.beyond_hessians);
        SMatrix::from_fn(|k, l| match (k < SHOULDER, l < SHOULDER) {
            (true, true) => {
                let bent = times(&of_quaternion, &self.quaternion_rates[l]);
                dot(&self.quaternion_rates[k], &bent) + dot(&self.second_rates[k][l], &slopes)
            }
            (false, false) => of_coordinates[k - SHOULDER][l - SHOULDER],
            _ => 0.0,
        })
    }
}

impl RateSlopes {
    /// Derivatives by the posture of a muscle's rate of length along the direction.
    pub fn of_muscle(&self, muscle: usize) -> PostureRate {
        let Muscle { shoulder_m, beyond_m, .. } = &DATA.muscles[muscle];
        let (shoulder, beyond) = (weighted_sum(shoulder_m, &self.shoulder), weighted_sum(beyond_m, &self.beyond));
        Moments::from_fn(|k, _| if k < SHOULDER { shoulder[k] } else { beyond[k - SHOULDER] })
    }
}

fn slopes_of(row: &Row) -> [f64; VARIABLES] {
    std::array::from_fn(|variable| row[1 + variable])
}

fn dot(a: &[f64; VARIABLES], b: &[f64; VARIABLES]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn times(matrix: &Hessian, vector: &[f64; VARIABLES]) -> [f64; VARIABLES] {
    std::array::from_fn(|row| dot(&matrix[row], vector))
}

fn weighted_matrix(coefficients: &[f64], hessians: &[Hessian]) -> Hessian {
    let mut sum = Hessian::default();
    for (coefficient, hessian) in coefficients.iter().zip(hessians) {
        for (sum, row) in sum.iter_mut().zip(hessian) {
            sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += coefficient * value);
        }
    }
    sum
}
