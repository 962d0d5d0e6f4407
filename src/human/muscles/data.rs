//! The muscles of the arm as functions of its posture: `assets/human/muscles.toml`, which states where they come from.

use std::sync::LazyLock;

use nalgebra::Vector3;
use serde::Deserialize;

use super::{
    activation::MUSCLES,
    basis::{Basis, VARIABLES},
    regions::REGIONS,
};

/// Outputs of the map of the angles beyond the shoulder: the correction of the upper arm, then four coordinates.
const OUTPUTS: usize = 7;

/// `assets/human/muscles.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    angles: AnglesSection,
    axes: AxesSection,
    lengths: LengthsSection,
    muscles: Vec<MuscleEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnglesSection {
    rows: Vec<[f64; VARIABLES + OUTPUTS]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxesSection {
    elbow: Vector3<f64>,
    pronation: Vector3<f64>,
    deviation: Vector3<f64>,
    flexion: Vector3<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LengthsSection {
    shoulder_degree: usize,
    beyond_powers: Vec<[usize; VARIABLES]>,
}

/// A muscle. Its `arm_error_mm` is for readers.
#[derive(Deserialize)]
struct MuscleEntry {
    name: String,
    region: String,
    force_n: f64,
    fibre_m: f64,
    fibre_range: [f64; 2],
    #[serde(default)]
    shoulder_mm: Vec<f64>,
    #[serde(default)]
    beyond_mm: Vec<f64>,
    constant_mm: f64,
}

/// A muscle.
#[derive(Debug)]
pub(super) struct Muscle {
    pub name: String,
    /// Index of its region in [`REGIONS`].
    pub region: usize,
    /// Isometric force at the best length, N.
    pub force_n: f64,
    /// Length of the fibres at which the force is largest, m.
    pub fibre_m: f64,
    /// Normalised lengths at which the force ends.
    pub fibre_range: [f64; 2],
    /// Coefficients of the shoulder's part of the length, m; empty if the muscle does not cross it.
    pub shoulder_m: Vec<f64>,
    /// Coefficients of the part beyond the shoulder, m; empty if the muscle ends above the elbow.
    pub beyond_m: Vec<f64>,
    /// Length of the fibres where both parts are zero, m.
    pub constant_m: f64,
}

/// All muscles and their polynomials.
#[derive(Debug)]
pub(super) struct Data {
    /// Monomials in q4 to q7, rad.
    pub angles: Basis,
    /// For each of them its coefficients.
    pub angle_coefficients: Vec<[f64; OUTPUTS]>,
    /// The axes of the four coordinates in U, where all of them are zero.
    pub axes_u: [Vector3<f64>; VARIABLES],
    /// Monomials in the components of the upper arm's quaternion.
    pub shoulder: Basis,
    /// Monomials in the four coordinates beyond the shoulder.
    pub beyond: Basis,
    pub muscles: [Muscle; MUSCLES],
}

impl Data {
    fn read(text: &str) -> Option<Self> {
        let File { angles, axes, lengths, muscles } = toml::from_str(text).ok()?;
        let of_row = |row: &[f64; VARIABLES + OUTPUTS], from: usize| -> [f64; OUTPUTS] {
            std::array::from_fn(|output| row[from + output])
        };
        let exponents = angles.rows.iter().map(|row| std::array::from_fn(|v| row[v] as usize)).collect();
        let shoulder = Basis::homogeneous(lengths.shoulder_degree)?;
        let beyond = Basis::new(lengths.beyond_powers)?;
        let in_m = |values: &[f64]| values.iter().map(|mm| mm * 1e-3).collect::<Vec<_>>();
        let muscle = |entry: MuscleEntry| {
            let lengths = [(&entry.shoulder_mm, shoulder.len()), (&entry.beyond_mm, beyond.len())];
            let fits = lengths.iter().all(|(values, count)| values.is_empty() || values.len() == *count);
            let region = REGIONS.iter().position(|region| region.name == entry.region)?;
            fits.then(|| Muscle {
                region,
                shoulder_m: in_m(&entry.shoulder_mm),
                beyond_m: in_m(&entry.beyond_mm),
                constant_m: entry.constant_mm * 1e-3,
                name: entry.name,
                force_n: entry.force_n,
                fibre_m: entry.fibre_m,
                fibre_range: entry.fibre_range,
            })
        };
        let muscles = muscles.into_iter().map(muscle).collect::<Option<Vec<_>>>()?;
        Some(Self {
            angles: Basis::new(exponents)?,
            angle_coefficients: angles.rows.iter().map(|row| of_row(row, VARIABLES)).collect(),
            axes_u: [axes.elbow, axes.pronation, axes.deviation, axes.flexion],
            muscles: muscles.try_into().ok()?,
            shoulder,
            beyond,
        })
    }
}

/// The built-in muscles.
pub(super) static DATA: LazyLock<Data> = LazyLock::new(|| {
    // The file is compiled in and the tests read it.
    Data::read(include_str!("../../../assets/human/muscles.toml")).expect("the built-in muscles are valid")
});

/// Active force of a muscle over the normalised length of its fibres, 1 at length 1, and its derivative: the pieces of
/// parabolas of MuJoCo's muscle model.
pub(super) fn force_length(length: f64, [shortest, longest]: [f64; 2]) -> [f64; 2] {
    // From each end the force rises to a half with growing slope, then to 1 with falling slope.
    let (end, sign) = if length < 1.0 { (shortest, 1.0) } else { (longest, -1.0) };
    let half = (1.0 - end).abs() / 2.0;
    let from_end = sign * (length - end) / half;
    if from_end <= 0.0 {
        [0.0, 0.0]
    } else if from_end <= 1.0 {
        [from_end * from_end / 2.0, sign * from_end / half]
    } else {
        let to_top = 2.0 - from_end;
        [1.0 - to_top * to_top / 2.0, sign * to_top / half]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_is_largest_at_length_one_and_smooth() {
        let range = [0.5, 1.6];
        for (length, expected) in [(0.4, 0.0), (0.5, 0.0), (0.75, 0.5), (1.0, 1.0), (1.3, 0.5), (1.6, 0.0), (2.0, 0.0)]
        {
            assert!((force_length(length, range)[0] - expected).abs() < 1e-15, "{length}");
        }
        let step = 1e-6;
        for k in 0..150 {
            let length = 0.4 + 0.01 * f64::from(k) + 0.003;
            let slope = (force_length(length + step, range)[0] - force_length(length - step, range)[0]) / (2.0 * step);
            // The second derivative is below 17: between pieces the difference is off by 17 steps.
            assert!((force_length(length, range)[1] - slope).abs() < 1e-4, "{length}");
        }
    }

    #[test]
    fn the_muscles_have_names_and_positive_figures() {
        for muscle in &DATA.muscles {
            assert!(muscle.force_n > 40.0 && muscle.force_n < 2_200.0 && muscle.fibre_m > 0.01, "{muscle:?}");
            assert!(muscle.fibre_range[0] < 1.0 && muscle.fibre_range[1] > 1.0, "{}", muscle.name);
            assert!(!(muscle.shoulder_m.is_empty() && muscle.beyond_m.is_empty()), "{}", muscle.name);
        }
        let mut names: Vec<_> = DATA.muscles.iter().map(|muscle| &muscle.name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), MUSCLES);
        let has_muscles = |region| DATA.muscles.iter().any(|muscle| muscle.region == region);
        assert!((0..REGIONS.len()).all(has_muscles));
    }
}
