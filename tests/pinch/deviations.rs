//! Simulations whose world deviates from the plan: each deviation against what it is by definition or by a closed form.

use benchdog::{
    model::{
        operation::Operation,
        plan::Plan,
        scenario::SimulationSettings,
        trace::{Phase, Sample, Trace},
        uncertainty::Uncertainty,
        wrench::Wrench,
    },
    robot::Robot,
    sim::Conditions,
    statics::{ContactModel, EquilibriumOutcome, EquilibriumSolver, StabilityWorkspace},
};
use nalgebra::{Point3, Rotation3, Vector3};

use crate::{
    GRAVITY_M_S2, THICKNESS_M,
    baxter::{self, BOARD_KG},
    checked, common, drill, last, simulate,
};

const FRICTION: f64 = 0.6;

const SETTINGS: SimulationSettings =
    SimulationSettings { settle_s: 0.6, ramp_s: 0.4, hold_s: 0.4, release_s: 0.0, timestep_s: 0.002 };

fn plan() -> Plan {
    baxter::plan(common::baxter(), Operation::cut([0.06, 0.05], Vector3::y(), 6.0, THICKNESS_M), BOARD_KG, 30.0)
}

fn under(robot: &Robot, plan: &Plan, uncertainty: Uncertainty) -> Trace {
    simulate(robot, plan, &Conditions { uncertainty, ..Conditions::new(FRICTION, SETTINGS) }).unwrap()
}

fn none() -> Uncertainty {
    Uncertainty::default()
}

/// The tool's wrench in O axes at the end of the hold.
fn wrench_o(trace: &Trace) -> Wrench {
    let sample = last(trace, Phase::Hold);
    sample.tool_wrench_w.rotated(&sample.x_wo.rotation.inverse())
}

#[test]
fn a_factor_of_the_force_is_a_factor_of_the_load() {
    let (robot, plan) = (common::baxter(), plan());
    let stronger = under(robot, &plan, Uncertainty { force_scale: 1.3, ..none() });
    let scaled = simulate(robot, &plan, &Conditions::new(FRICTION, SETTINGS).scaled(1.3)).unwrap();
    assert_eq!(format!("{:?}", stronger.samples), format!("{:?}", scaled.samples));
}

#[test]
fn the_tool_tilts_about_its_tip_and_its_tip_moves_in_the_face() {
    let (robot, plan) = (common::baxter(), plan());
    let uncertainty = Uncertainty { tool_tilt_deg: [4.0, -7.0], tool_offset_mm: [3.0, -2.0], ..none() };
    let trace = under(robot, &plan, uncertainty.clone());
    // x_T along the cut, z_T into the board: the rotation about x_T, then about the turned y_T.
    let r_ot = plan.operation.x_ot.rotation.to_rotation_matrix();
    let tilt = Rotation3::from_axis_angle(&Vector3::x_axis(), 4.0_f64.to_radians())
        * Rotation3::from_axis_angle(&Vector3::y_axis(), (-7.0_f64).to_radians());
    let expected_n = r_ot * tilt * r_ot.inverse() * plan.operation.wrench_o.force_n;
    // The board turns by microradians between the start of a step, when the wrench is applied, and its end.
    assert!((wrench_o(&trace).force_n - expected_n).norm() < 1e-3, "{:?}", wrench_o(&trace));
    let moved_m = trace.samples[0].p_ot_m - plan.operation.x_ot.translation.vector;
    assert!((moved_m - Vector3::new(3e-3, -2e-3, 0.0)).norm() < 1e-15);
    // The statics have the same load.
    let model = ContactModel::under(&checked(robot, &plan), FRICTION, &uncertainty).unwrap();
    let expected = Wrench::from_force(expected_n).about(&trace.samples[0].p_ot_m);
    assert!((model.load.to_vector() - expected.to_vector()).norm() < 1e-12);
}

#[test]
fn a_heavier_board_sags_by_the_compliance_of_the_arms() {
    let (robot, plan) = (common::baxter(), plan());
    let settled = |scale| {
        let trace = under(robot, &plan, Uncertainty { board_mass_scale: scale, ..none() });
        let tip_w = |sample: &Sample| (sample.x_wo * Point3::from(sample.p_ot_m)).coords;
        tip_w(last(&trace, Phase::Settle)) - tip_w(&trace.samples[0])
    };
    let hold = ContactModel::of_plan(&checked(robot, &plan), FRICTION).unwrap();
    let welded = benchdog::statics::WeldedStiffness::new(&hold).unwrap();
    let expected_m = plan.object.x_wo.rotation * welded.twist_at_tip(&hold.weight.scaled(0.2)).linear;
    let found_m = settled(1.2) - settled(1.0);
    // Pads are slightly compliant, unlike welds, as in `two_arms_deflect_as_if_welded_under_a_small_load`.
    assert!((found_m - expected_m).norm() < 0.05 * expected_m.norm(), "{found_m:?} {expected_m:?}");
    assert!(expected_m.norm() > 4e-5);
}

#[test]
fn a_thicker_board_opens_the_fingers_and_moves_the_face() {
    let (robot, plan) = (common::baxter(), plan());
    let start = |thicker_mm| under(robot, &plan, Uncertainty { board_thickness_mm: thicker_mm, ..none() });
    let (planned, thicker) = (start(0.0), start(1.0));
    let face_m = |trace: &Trace| trace.samples[0].p_ot_m.z;
    assert!((face_m(&thicker) - face_m(&planned) - 5e-4).abs() < 1e-15);
    for arm in 0..2 {
        let opened = |trace: &Trace| last(trace, Phase::Settle).arms[arm].finger_m[0].abs();
        // To a tenth of what pads on the board yield under the grip force.
        assert!((opened(&thicker) - opened(&planned) - 5e-4).abs() < 2e-6);
    }
}

#[test]
fn each_hand_has_its_own_friction_and_grip_force() {
    let (robot, plan) = (common::baxter(), plan());
    let grips = Uncertainty { grip_force_scale: 1.1, grip_force_scales: vec![0.9, 1.2], ..none() };
    let trace = under(robot, &plan, grips);
    for (arm, factor) in [(0, 0.99), (1, 1.32)] {
        let pads = &last(&trace, Phase::Settle).arms[arm].pads;
        let pressed_n: f64 = pads.iter().map(|pad| pad.normal_force_n).sum::<f64>() / 2.0;
        // The board's weight is not perpendicular to the pads.
        assert!((pressed_n / (30.0 * factor) - 1.0).abs() < 0.01, "{arm}: {pressed_n}");
        assert!((trace.arms[arm].grip_force_n - 30.0 * factor).abs() < 1e-12);
    }
    // One hand without friction leaves the board to the other one, which cannot hold its moment for ever: both have slipped
    // less where the friction is the planned one.
    let slip_m = |scales: [f64; 2]| {
        let trace = under(robot, &plan, Uncertainty { friction_scales: scales.to_vec(), ..none() });
        let (first, end) = (last(&trace, Phase::Grip), trace.samples.last().unwrap());
        [0, 1].map(|arm| {
            let at = |sample: &Sample| sample.arms[arm].x_oc.translation.vector;
            (at(end) - at(first)).norm()
        })
    };
    let (both, left_slips) = (slip_m([1.0, 1.0]), slip_m([0.02, 1.0]));
    assert!(both[0] < 1e-4 && left_slips[0] > 1e-3 && left_slips[0] > 3.0 * left_slips[1], "{both:?} {left_slips:?}");
}

#[test]
fn offsets_of_joints_pull_the_hands_apart_as_the_statics_say() {
    let (robot, plan) = (common::baxter(), plan());
    let offset_deg = vec![vec![0.3, -0.5, 0.2, 0.4, -0.8, 0.5, 0.8], vec![-0.2, 0.4, 0.5, -0.3, 0.5, 0.8, -0.8]];
    let uncertainty = Uncertainty { joint_offset_deg: offset_deg, ..none() };
    let trace = under(robot, &plan, uncertainty.clone());
    let settled = last(&trace, Phase::Settle);
    let model = ContactModel::under(&checked(robot, &plan), FRICTION, &uncertainty).unwrap();
    let EquilibriumOutcome::Found(predicted) =
        StabilityWorkspace::new().equilibrium(&model, 0.0, EquilibriumSolver::Clarabel).unwrap()
    else {
        panic!("no equilibrium")
    };
    let mut pulled_n = 0.0_f64;
    for (arm, hand) in model.hands.iter().enumerate() {
        let expected = hand.wrench_about_grasp_point(&predicted.hand_wrenches[arm]);
        let back = settled.x_wo.rotation.inverse();
        let pads = settled.arms[arm].pads.iter();
        let found_n: Vector3<f64> = pads.map(|pad| back * pad.wrench_w.force_n).sum();
        pulled_n = pulled_n.max(found_n.norm());
        // Pads are slightly compliant, unlike welds: 5 % of the largest force, as in the closed chain under a load.
        assert!((found_n - expected.force_n).norm() < 0.3, "arm {arm}: {found_n:?}, statics {:?}", expected.force_n);
    }
    // Without offsets each hand carries half of the weight, 1 N.
    assert!(pulled_n > 3.0 * BOARD_KG * GRAVITY_M_S2 / 2.0, "{pulled_n}");
}

#[test]
fn a_longer_ramp_lasts_longer_and_a_person_elsewhere_is_elsewhere() {
    let (robot, plan) = (common::baxter(), plan());
    let duration_s = |ramp_scale| {
        let trace = under(robot, &plan, Uncertainty { ramp_scale, ..none() });
        trace.samples.iter().filter(|sample| sample.phase == Phase::Ramp).count() as f64 * SETTINGS.timestep_s
    };
    assert!((duration_s(2.5) - 2.5 * SETTINGS.ramp_s).abs() < 1e-9);
    let with_person = crate::person::with_person_at(robot, &plan, 0.2);
    let distance_m = |person_offset_mm| {
        let trace = under(robot, &with_person, Uncertainty { person_offset_mm, ..none() });
        trace.samples[0].person_distance_m.unwrap()
    };
    // The person stands in front of the robot, along x_W.
    let (planned_m, away_m) = (distance_m([0.0, 0.0]), distance_m([50.0, 0.0]));
    assert!((away_m - planned_m - 0.05).abs() < 0.005, "{planned_m} {away_m}");
}

#[test]
fn deviations_of_zero_change_no_bit() {
    let (robot, plan) = (common::baxter(), baxter::plan(common::baxter(), drill(5.0), BOARD_KG, 30.0));
    let zeros = Uncertainty {
        friction_scales: vec![1.0; 2],
        grip_force_scales: vec![1.0; 2],
        joint_offset_deg: vec![vec![0.0; 7]; 2],
        ..none()
    };
    let [planned, same] = [none(), zeros].map(|uncertainty| format!("{:?}", under(robot, &plan, uncertainty)));
    assert_eq!(planned, same);
}
