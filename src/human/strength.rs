//! Strength of the arm's joints (docs/method.md#46-strength).
//!
//! The paper uses the strengths of Tanaka et al. 2015, whose table is not public. `assets/human/strength.toml` has cubics
//! fitted to published measurements, each with its source. The error of the shoulder rows is about 30 %.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::model::scenario::Sex;

/// Standard deviation of strength among people, as a fraction of the median: La Delfa & Potvin's Arm Force Field.
const COEFFICIENT_OF_VARIATION: f64 = 0.277;

/// Minimum fraction of the median strength. The normal distribution gives one person in 1,700 less (z = -3.25), and a negative
/// strength below z = -3.61.
const WEAKEST: f64 = 0.1;

/// The sense of a joint's torque or motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Towards larger angles: flexion, abduction, internal rotation, pronation, ulnar deviation.
    Positive,
    /// Towards smaller angles.
    Negative,
}

impl Sense {
    /// The other one.
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Positive => Self::Negative,
            Self::Negative => Self::Positive,
        }
    }
}

/// The strengths of one person's arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Strength {
    /// For each joint, positive then negative sense.
    curves: [[Curve; 2]; 7],
    /// Of moving the raised upper arm horizontally, N m: towards the body's middle, then away from it.
    horizontal_nm: [f64; 2],
}

/// Largest torque over the joint's angle, N m: a cubic in rad, constant outside its range.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Curve {
    coefficients: [f64; 4],
    range_rad: [f64; 2],
}

/// `assets/human/strength.toml`: seven joints in order, positive sense first.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    row: [Row; 14],
    horizontal: Horizontal,
}

/// Strength of moving the raised upper arm horizontally, N m: towards the body's middle, then away from it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Horizontal {
    male_nm: [f64; 2],
    female_nm: [f64; 2],
}

/// A row. Its motion, residual and source are not read.
#[derive(Deserialize)]
struct Row {
    range_deg: [f64; 2],
    coefficients: [f64; 4],
    female_ratio: f64,
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    // The file is compiled in and the tests below parse it.
    toml::from_str(include_str!("../../assets/human/strength.toml")).expect("the built-in strengths are valid")
});

impl Strength {
    /// The strengths of a person of this sex at a percentile (0 to 100, exclusive): those of the median man, times the
    /// row's female ratio for a woman, times `1 + 0.277 z_p`, `z_p` the normal quantile; that factor is at least 0.1.
    pub fn new(sex: Sex, percentile: f64) -> Self {
        let factor = percentile_factor(percentile);
        let curve = |row: &Row| {
            let of_sex = match sex {
                Sex::Male => 1.0,
                Sex::Female => row.female_ratio,
            };
            Curve {
                coefficients: row.coefficients.map(|c| c * of_sex * factor),
                range_rad: row.range_deg.map(f64::to_radians),
            }
        };
        let horizontal_nm = match sex {
            Sex::Male => TABLE.horizontal.male_nm,
            Sex::Female => TABLE.horizontal.female_nm,
        };
        Self {
            curves: std::array::from_fn(|joint| [curve(&TABLE.row[2 * joint]), curve(&TABLE.row[2 * joint + 1])]),
            horizontal_nm: horizontal_nm.map(|strength_nm| strength_nm * factor),
        }
    }

    /// The largest moment that moves the raised upper arm horizontally, N m: positive towards the body's middle (horizontal
    /// flexion), negative away from it (horizontal extension).
    pub fn horizontal_nm(&self, sense: Sense) -> f64 {
        match sense {
            Sense::Positive => self.horizontal_nm[0],
            Sense::Negative => self.horizontal_nm[1],
        }
    }

    /// The largest torque of a joint (counted from 0) at this angle in one sense, N m; always positive.
    pub fn torque_nm(&self, joint: usize, q_rad: f64, sense: Sense) -> f64 {
        let [positive, negative] = &self.curves[joint];
        match sense {
            Sense::Positive => positive.at(q_rad),
            Sense::Negative => negative.at(q_rad),
        }
    }

    /// Derivative of that torque by the joint's angle, N m/rad; zero outside the curve's range.
    pub fn slope_nm_rad(&self, joint: usize, q_rad: f64, sense: Sense) -> f64 {
        let [positive, negative] = &self.curves[joint];
        match sense {
            Sense::Positive => positive.slope(q_rad),
            Sense::Negative => negative.slope(q_rad),
        }
    }
}

impl Curve {
    fn slope(&self, q_rad: f64) -> f64 {
        let [low, high] = self.range_rad;
        let [_, c1, c2, c3] = self.coefficients;
        if (low..=high).contains(&q_rad) { c1 + q_rad * (2.0 * c2 + q_rad * 3.0 * c3) } else { 0.0 }
    }

    fn at(&self, q_rad: f64) -> f64 {
        let [low, high] = self.range_rad;
        let q = q_rad.clamp(low, high);
        let [c0, c1, c2, c3] = self.coefficients;
        c0 + q * (c1 + q * (c2 + q * c3))
    }
}

/// The mean over all joints and senses of a woman's strength relative to a man's.
pub(super) fn mean_female_ratio() -> f64 {
    TABLE.row.iter().map(|row| row.female_ratio).sum::<f64>() / TABLE.row.len() as f64
}

/// Ratio of the strength at a percentile to the median.
pub(super) fn percentile_factor(percentile: f64) -> f64 {
    (1.0 + COEFFICIENT_OF_VARIATION * normal_quantile(percentile / 100.0)).max(WEAKEST)
}

/// The z with `(1/2) erfc(-z / sqrt 2) = probability`, by bisection of [-10, 10] to rounding. Called once per person.
fn normal_quantile(probability: f64) -> f64 {
    let (mut low, mut high) = (-10.0, 10.0);
    // 20 / 2^60 is below the spacing of numbers near 1.
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if libm::erfc(-middle * std::f64::consts::FRAC_1_SQRT_2) / 2.0 < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low + high) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENSES: [Sense; 2] = [Sense::Positive, Sense::Negative];

    #[test]
    fn strengths_match_the_tabulated_ones() {
        let (man, woman) = (Strength::new(Sex::Male, 50.0), Strength::new(Sex::Female, 50.0));
        let mut rows = 0;
        for row in include_str!("../../tests/data/strength_table.csv").lines().skip(2) {
            let cells: Vec<&str> = row.split(',').collect();
            let joint = cells[0][1..2].parse::<usize>().unwrap() - 1;
            let sense = if cells[1] == "+" { Sense::Positive } else { Sense::Negative };
            let [angle_deg, of_man, of_woman] = [2, 3, 4].map(|i| cells[i].parse::<f64>().unwrap());
            let q_rad = angle_deg.to_radians();
            // The table is rounded to 0.1 N m, the coefficients to 1e-4 (times at most pi^3 = 31).
            assert!((man.torque_nm(joint, q_rad, sense) - of_man).abs() < 0.054, "{row}");
            assert!((woman.torque_nm(joint, q_rad, sense) - of_woman).abs() < 0.054, "{row}");
            rows += 1;
        }
        assert_eq!(rows, 170);
    }

    #[test]
    fn a_young_mans_shoulder_flexes_as_measured() {
        // 89.9 N m at 0 and 68.6 N m at 45 degrees, measured in 26 young men: within the fit's residual of 6.91.
        let man = Strength::new(Sex::Male, 50.0);
        assert!((man.torque_nm(0, 0.0, Sense::Positive) - 89.9).abs() < 6.91);
        assert!((man.torque_nm(0, 45_f64.to_radians(), Sense::Positive) - 68.6).abs() < 6.91);
    }

    #[test]
    fn quantiles_match_printed_tables() {
        // Any statistics table, to its digits.
        for (percent, z) in [(50.0, 0.0), (75.0, 0.674_490), (95.0, 1.644_854), (97.5, 1.959_964), (99.9, 3.090_232)] {
            assert!((normal_quantile(percent / 100.0) - z).abs() < 5e-7, "{percent}");
            assert!((normal_quantile(1.0 - percent / 100.0) + z).abs() < 5e-7, "{percent}");
        }
    }

    #[test]
    fn everyone_has_some_strength_everywhere() {
        for sex in [Sex::Male, Sex::Female] {
            for percentile in [1e-9, 5.0, 95.0] {
                let strength = Strength::new(sex, percentile);
                let angles_deg = (-100..=200).map(f64::from);
                for (joint, sense) in (0..7).flat_map(|joint| SENSES.map(|sense| (joint, sense))) {
                    let weakest = angles_deg
                        .clone()
                        .map(|angle| strength.torque_nm(joint, angle.to_radians(), sense))
                        .fold(f64::INFINITY, f64::min);
                    // The weakest figure of the table, 4.4 N m, times the smallest ratio and factor.
                    assert!(weakest > 4.3 * 0.4 * WEAKEST, "{joint} {sense:?}: {weakest}");
                }
            }
        }
    }

    #[test]
    fn strength_grows_with_the_percentile() {
        let of = |percentile| Strength::new(Sex::Male, percentile).torque_nm(3, 1.0, Sense::Positive);
        // One standard deviation, 84.134 %, is 27.7 % of the median; the percentile is rounded at 1e-3 %.
        assert!((of(84.134) / of(50.0) - 1.277).abs() < 1e-4);
        assert!(of(5.0) < of(50.0));
    }

    #[test]
    fn outside_its_range_a_strength_stays_at_the_end() {
        let man = Strength::new(Sex::Male, 50.0);
        assert_eq!(man.torque_nm(3, -0.5, Sense::Positive), man.torque_nm(3, 0.0, Sense::Positive),);
    }
}
