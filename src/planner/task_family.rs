//! Task families: tasks that differ only in the place and direction of the operation on the board.
//!
//! The holes of a board, or the points of a line that is cut, pose nearly the same problem: the same person, tool and force,
//! at another place or in another direction. Warm starts are solved once for a family.

use std::f64::consts::PI;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use super::{
    params::warm_starts::{DIRECTIONS, HOLES, LEVEL, NATURAL_HOLES, PLACE_UNIT_M, ROUNDING_UNIT},
    problem::wrench_t,
};
use crate::model::{
    frames::Pose,
    operation::Operation,
    scenario::{Expectation, Limits, PlannerSettings, Scenario, SimulationSettings},
    uncertainty::Uncertainty,
    wrench::Wrench,
};

/// A family, represented by the scenario that all its tasks share: the operation is at the board's centre with the tool's x
/// axis above x_O, and every figure is rounded.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskFamily(Scenario);

impl TaskFamily {
    /// The family of a scenario's task.
    pub fn of(scenario: &Scenario) -> Self {
        let Operation { x_ot, .. } = scenario.operation;
        let axes = [Vector3::x(), Vector3::y()].map(|axis| x_ot.rotation * axis);
        let pointer = if axes[0].xy().norm() > LEVEL { axes[0] } else { axes[1] };
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -pointer.y.atan2(pointer.x));
        let coords = (turn * x_ot.rotation).into_inner().coords;
        // Of the two quaternions of a rotation the one whose largest part is positive; of equally large parts, which rounding may order
        // in either way, the first one.
        let largest = coords.amax();
        let sign = coords.iter().find(|part| part.abs() > largest - ROUNDING_UNIT).map_or(1.0, |part| part.signum());
        let rotation = UnitQuaternion::from_quaternion((coords * sign).map(rounded).into());
        let wrench_t = wrench_t(&scenario.operation);
        let wrench_t = Wrench::new(wrench_t.force_n.map(rounded), wrench_t.moment_nm.map(rounded));
        let p_ot_m = turn * x_ot.translation.vector;
        let roll_is_free = scenario.operation.kind.roll_is_free();
        let coarse = |v: f64| if roll_is_free { 0.0 } else { to_unit(v, PLACE_UNIT_M) };
        let p_ot_m = Vector3::new(coarse(p_ot_m.x), coarse(p_ot_m.y), rounded(p_ot_m.z));
        Self(Scenario {
            name: String::new(),
            operation: placed(&scenario.operation, &wrench_t, p_ot_m, rotation),
            planner: PlannerSettings { evaluations: None, ..scenario.planner.clone() },
            // Warm starts are no finished plans, whose scores are limited.
            limits: Limits { rula: None, rula_arm: None, reba: None, ..scenario.limits },
            // What a plan does not depend on.
            simulation: SimulationSettings::default(),
            uncertainty: Uncertainty::default(),
            sweep: None,
            expect: Expectation::default(),
            ..scenario.clone()
        })
    }

    /// The scenario that the family's tasks share.
    pub fn scenario(&self) -> &Scenario {
        &self.0
    }
}

fn rounded(v: f64) -> f64 {
    to_unit(v, ROUNDING_UNIT)
}

/// Rounded to a unit; 0 is never negative.
fn to_unit(v: f64, unit: f64) -> f64 {
    (v / unit).round() * unit + 0.0
}

/// An operation with a wrench in T axes, the tool at a pose on the board.
fn placed(operation: &Operation, wrench_t: &Wrench, p_ot_m: Vector3<f64>, r_ot: UnitQuaternion<f64>) -> Operation {
    Operation {
        x_ot: Isometry3::from_parts(p_ot_m.into(), r_ot),
        wrench_o: Wrench::new(r_ot * wrench_t.force_n, r_ot * wrench_t.moment_nm),
        ..*operation
    }
}

/// The tasks of a family for which warm starts are solved; half turns of the board transfer them to its other half, unless its
/// outline is another one then: then they are solved for both halves.
/// `shared` is the family's scenario, with the optima of its objective filled in.
pub fn solved_tasks(shared: &Scenario) -> Vec<Scenario> {
    let operation = &shared.operation;
    let wrench_t = wrench_t(operation);
    let Pose { translation, rotation } = operation.x_ot;
    let at = |p_ot_m: Vector3<f64>, turn_rad: f64| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad);
        Scenario { operation: placed(operation, &wrench_t, p_ot_m, turn * rotation), ..shared.clone() }
    };
    if operation.kind.roll_is_free() {
        // The tool's roll takes care of directions.
        let board = shared.object.shape();
        let ([width_m, height_m, _], [x_m, y_m]) = (board.size_m, board.centre_m());
        let place = |[x, y]: [f64; 2]| translation.vector + Vector3::new(x_m + x * width_m, y_m + y * height_m, 0.0);
        let further: &[_] = if shared.human.posture.is_natural() { &NATURAL_HOLES } else { &[] };
        let half: Vec<_> = HOLES.iter().chain(further).copied().collect();
        let other_half = half.iter().map(|place| place.map(std::ops::Neg::neg)).filter(|_| !board.turns(2));
        let tasks = half.iter().copied().chain(other_half).map(|hole| at(place(hole), 0.0));
        return tasks.collect();
    }
    let whole = if shared.object.shape().turns(2) { DIRECTIONS } else { 2 * DIRECTIONS };
    // Between the board's axes and diagonals, so that the common directions all have neighbours at some distance.
    let direction = |number: usize| {
        let turn_rad = PI * (number as f64 + 0.5) / DIRECTIONS as f64;
        at(UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn_rad) * translation.vector, turn_rad)
    };
    (0..whole).map(direction).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scenario;

    /// Cuts of one circle, in all directions, and holes at all places share their maps: the family, whose text is the key of its maps, is
    /// the same byte for byte.
    #[test]
    fn the_family_does_not_depend_on_place_and_direction() {
        let key = |scenario: &Scenario| format!("{:?}", TaskFamily::of(scenario));
        for file in ["cut-rim.toml", "quickstart.toml"] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(file);
            let given = scenario::load(&path).unwrap().scenario;
            let of_given = key(&given);
            for degrees in 0..360 {
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), f64::from(degrees).to_radians());
                let Operation { x_ot, .. } = given.operation;
                let moved_m = if given.operation.kind.roll_is_free() { 0.001 * f64::from(degrees) - 0.18 } else { 0.0 };
                let p_ot_m = turn * x_ot.translation.vector + Vector3::new(moved_m, -0.3 * moved_m, 0.0);
                let operation = placed(&given.operation, &wrench_t(&given.operation), p_ot_m, turn * x_ot.rotation);
                let turned = Scenario { operation, ..given.clone() };
                let (found, operation) = (key(&turned), TaskFamily::of(&turned).0.operation);
                assert!(found == of_given, "{file}: turned by {degrees} degrees: {operation:?}");
            }
        }
    }
}
