//! Assumptions that the paper does not state, changed one at a time.

use nalgebra::{UnitQuaternion, Vector3};

use super::jobs::{self, Job, Stage};
use crate::model::{
    frames::rotation_from_xyzw,
    operation::OperationKind,
    scenario::{Optima, ResponseKind, Scenario},
};

/// A changed assumption.
pub struct Assumption {
    /// Its name in `sensitivity.csv`, without commas.
    pub name: &'static str,
    /// Changes a scenario.
    pub change: fn(&mut Scenario),
}

impl Assumption {
    /// The jobs for one operation under this assumption.
    #[must_use]
    pub fn jobs(&self, scenario: &Scenario, random_seeds: u64) -> Vec<Job> {
        let mut scenario = scenario.clone();
        (self.change)(&mut scenario);
        let jobs = jobs::jobs_of(&scenario, random_seeds, Stage::Plan).into_iter();
        jobs.map(|job| Job { variant: Some(self.name), ..job }).collect()
    }
}

/// The operations of the analysis: four cuts a quarter of the circle apart, two corners and the middle of the grid.
const OPERATIONS: [&str; 7] = ["cut-01", "cut-05", "cut-09", "cut-13", "drill-1", "drill-5", "drill-9"];

/// Added length of the tool, m.
const LONGER_M: f64 = 0.05;

/// Tilt of the tool, degrees.
const TILT_DEG: f64 = 30.0;

/// All changed assumptions.
pub const VARIANTS: [Assumption; 10] = [
    Assumption {
        name: "the mean of the person's responses instead of the best",
        change: |scenario| scenario.comfort.person = ResponseKind::Mean,
    },
    Assumption { name: "strength: 5th percentile", change: |scenario| scenario.human.percentile = 5.0 },
    Assumption { name: "strength: 95th percentile", change: |scenario| scenario.human.percentile = 95.0 },
    Assumption {
        name: "peripersonal weight 16 instead of 64",
        change: |scenario| scenario.comfort.weight_peripersonal = 16.0,
    },
    Assumption { name: "peripersonal weight 256", change: |scenario| scenario.comfort.weight_peripersonal = 256.0 },
    Assumption { name: "each comfort divided by its optimum with equal weights", change: normalise },
    Assumption { name: "tool 5 cm longer", change: lengthen_tool },
    Assumption { name: "tool tilted by 30 degrees in the hand", change: tilt_tool },
    Assumption {
        name: "board 0.40 x 0.32 m instead of 0.50 x 0.40",
        change: |scenario| resize(scenario, [0.40, 0.32]),
    },
    Assumption { name: "board 0.60 x 0.48 m", change: |scenario| resize(scenario, [0.60, 0.48]) },
];

/// True for an operation of the analysis.
#[must_use]
pub fn includes(operation: &str) -> bool {
    OPERATIONS.contains(&operation)
}

/// Sets the optima of both comforts to the means that the muscular and the peripersonal planner reach
/// (`results/printed/table1.csv`), for cuts and for holes. They are the same for all planners, so that their objectives can be
/// compared.
fn normalise(scenario: &mut Scenario) {
    let [muscular_regularised, peripersonal_m] =
        if scenario.operation.kind == OperationKind::Cut { [61.6, 1.28] } else { [100.0, 1.30] };
    scenario.comfort.optima = Some(Optima { muscular_regularised, peripersonal_m });
    scenario.comfort.peripersonal_share = Some(0.5);
}

/// Moves the tip by 5 cm along the tool's axis z_T.
fn lengthen_tool(scenario: &mut Scenario) {
    let axis_h = rotation_ht(scenario) * Vector3::z();
    for (tip, along) in scenario.tool.tip_h_m.iter_mut().zip(axis_h.iter()) {
        *tip += LONGER_M * along;
    }
}

/// Turns the tool about y_T; the tip does not move.
fn tilt_tool(scenario: &mut Scenario) {
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), TILT_DEG.to_radians());
    scenario.tool.rotation_xyzw = (rotation_ht(scenario) * tilt).into_inner().coords.into();
}

/// R_HT.
fn rotation_ht(scenario: &Scenario) -> UnitQuaternion<f64> {
    // `scenario` has checked that it is a rotation.
    rotation_from_xyzw(scenario.tool.rotation_xyzw).expect("a checked scenario's tool has a rotation")
}

/// Sets width and height of the board; thickness, density and operations do not change.
fn resize(scenario: &mut Scenario, [width_m, height_m]: [f64; 2]) {
    scenario.object.size_m = [width_m, height_m, scenario.object.size_m[2]];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::paper;

    #[test]
    fn every_variant_changes_every_operation_of_the_analysis() {
        let operations: Vec<_> = paper::printed_operations().into_iter().filter(|o| includes(&o.name)).collect();
        assert_eq!(operations.len(), OPERATIONS.len());
        for operation in operations {
            let scenario = operation.load().unwrap().scenario;
            for variant in &VARIANTS {
                let mut changed = scenario.clone();
                (variant.change)(&mut changed);
                assert!(changed != scenario, "{}: {}", operation.name, variant.name);
                assert!(changed.operation == scenario.operation, "{}", variant.name);
            }
        }
    }

    #[test]
    fn the_name_of_every_variant_is_unique_and_one_cell() {
        for (index, variant) in VARIANTS.iter().enumerate() {
            assert!(!variant.name.contains([',', '"', '|']), "{}", variant.name);
            assert!(VARIANTS[..index].iter().all(|other| other.name != variant.name), "{}", variant.name);
        }
    }

    #[test]
    fn the_mean_response_is_used_by_every_planner() {
        let variant = VARIANTS.iter().find(|variant| variant.name.starts_with("the mean")).unwrap();
        let jobs = variant.jobs(&paper::printed_operations()[16].load().unwrap().scenario, 2);
        assert_eq!(jobs.len(), 5, "three planners and two draws");
        assert!(jobs.iter().all(|job| job.scenario.comfort.person == ResponseKind::Mean));
    }

    #[test]
    fn a_longer_tool_is_longer_along_its_axis() {
        let mut scenario = paper::printed_operations()[16].load().unwrap().scenario;
        let before = scenario.tool.tip_h_m;
        lengthen_tool(&mut scenario);
        let moved = Vector3::from(scenario.tool.tip_h_m) - Vector3::from(before);
        // The drill's axis is -z_H (docs/method.md#44-tools-in-the-hand).
        assert!((moved - Vector3::new(0.0, 0.0, -0.05)).norm() < 1e-15);
    }
}
