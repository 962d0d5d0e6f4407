//! Elastic pads (docs/method.md#612-pad-compliance) against closed forms and the statics.

use benchdog::{
    model::{frames::Pose, plan::Plan, scenario::SimulationSettings, wrench::Wrench},
    robot::Robot,
    sim::Conditions,
    statics::{ContactModel, ResponseOutcome, StabilityWorkspace},
};
use nalgebra::{Point3, Vector3};

use crate::{
    bench::{self, Bench, Grip, Hinge, PAD_HALF_M, THICKNESS_M, fingers_level},
    common::{baxter, checked, ten_plans},
    force_along_x_g,
    holds::{FRICTION, SETTINGS, judged_grasp, limits},
    moment_g, simulate,
};

/// Stiffness of a pad, N/m: 1.2 um/N.
const STIFFNESS_N_M: f64 = 8e5;

/// Along the face.
const TANGENTIAL_N_M: f64 = 2.0 / 3.0 * STIFFNESS_N_M;

const GRIP: Grip = Grip { force_n: 100.0, friction: 0.8, mass_kg: 0.2 };

fn with_pads(mut robot: Robot, stiffness_n_m: f64) -> Robot {
    robot
        .arms
        .iter_mut()
        .for_each(|arm| arm.gripper.holding.pads_mut().unwrap().pad_stiffness_n_m = Some(stiffness_n_m));
    robot
}

/// How far a wrench in the gripper's axes displaces the block, in these axes.
fn displaced(robot: &Robot, wrench_g: Wrench) -> Pose {
    let plan = bench::plan(robot, fingers_level(), &GRIP, wrench_g);
    let mut bench = Bench::new(robot, &plan, GRIP.friction);
    let before = bench.run(0.3, 0.0, 0.0).x_wo;
    bench.run(0.5, 0.0, 1.0);
    let after = bench.run(0.5, 1.0, 1.0).x_wo;
    let x_og = plan.arms[0].x_og;
    x_og.inverse() * (before.inverse() * after) * x_og
}

/// The part of the displacement that elastic pads add to that of the engine's contacts.
fn added_by_pads(wrench_g: Wrench) -> [Vector3<f64>; 2] {
    let rigid = bench::robot(fingers_level(), None);
    let elastic = with_pads(rigid.clone(), STIFFNESS_N_M);
    let [rigid, elastic] = [rigid, elastic].map(|robot| displaced(&robot, wrench_g));
    let centre_g = Point3::new(0.0, 0.0, -0.0149);
    [elastic * centre_g - rigid * centre_g, elastic.rotation.scaled_axis() - rigid.rotation.scaled_axis()]
}

#[test]
fn a_block_in_a_fixed_hand_moves_as_in_closed_form() {
    for (axis, stiffness_n_m) in [
        (Vector3::x(), 2.0 * TANGENTIAL_N_M),
        (Vector3::y(), 2.0 * STIFFNESS_N_M),
        (Vector3::z(), 2.0 * TANGENTIAL_N_M),
    ] {
        let [moved_m, _] = added_by_pads(Wrench::from_force(axis * 15.0));
        // The springs are exact; the engine's contacts, 1e-8 m/N, yield differently under a hand with inertia.
        assert!((moved_m - axis * (15.0 / stiffness_n_m)).norm() < 0.01 * 15.0 / stiffness_n_m, "{axis}: {moved_m}");
    }
}

#[test]
fn a_block_in_a_fixed_hand_turns_as_in_closed_form() {
    let [a, b] = PAD_HALF_M.map(|half| half * half / 3.0);
    let shear = TANGENTIAL_N_M * THICKNESS_M * THICKNESS_M / 4.0;
    for (axis, stiffness_nm_rad) in [
        (Vector3::x(), 2.0 * (STIFFNESS_N_M * b + shear)),
        (Vector3::y(), 2.0 * TANGENTIAL_N_M * (a + b)),
        (Vector3::z(), 2.0 * (STIFFNESS_N_M * a + shear)),
    ] {
        let [_, turned_rad] = added_by_pads(moment_g(axis, 0.5));
        let expected_rad = 0.5 / stiffness_nm_rad;
        assert!((turned_rad - axis * expected_rad).norm() < 0.01 * expected_rad, "{axis}: {turned_rad}");
    }
}

/// Deflection of the tool point in mm and the energy that the simulation gained in J, at a tenth of the load.
fn simulated(robot: &Robot, plan: &Plan) -> (f64, f64) {
    let trace = simulate(robot, plan, &Conditions::new(FRICTION, SETTINGS).scaled(0.1)).unwrap();
    let gained_j = trace.samples.iter().map(|sample| sample.self_check.contact_energy_j).fold(0.0, f64::max);
    (*judged_grasp(trace, &limits(plan.operation.kind)).measures.deflection_mm.last().unwrap(), gained_j)
}

fn predicted_mm(robot: &Robot, plan: &Plan) -> f64 {
    let hold = ContactModel::of_plan(&checked(robot, plan), FRICTION).unwrap();
    let ResponseOutcome::Found(response) = StabilityWorkspace::new().response(&hold, 0.1).unwrap() else {
        panic!("{}: no equilibrium", plan.name)
    };
    response.deflection_mm()
}

#[test]
fn small_deflections_of_baxter_with_elastic_pads_are_predicted() {
    let elastic = with_pads(baxter().clone(), STIFFNESS_N_M);
    for plan in ten_plans() {
        let (predicted, (found, gained_j)) = (predicted_mm(&elastic, &plan), simulated(&elastic, &plan));
        let (name, off) = (&plan.name, predicted / found - 1.0);
        println!(
            "| {name} | {:.4} | {predicted:.4} | {found:.4} | {:+.1} % | {gained_j}",
            predicted_mm(baxter(), &plan),
            100.0 * off
        );
        // As with rigid pads: contact compliance and pads of five contacts.
        assert!(off.abs() < 0.05, "{name}: {predicted} and {found}");
        assert!(predicted > 1.02 * predicted_mm(baxter(), &plan), "{name}: the pads do not yield");
        // A thousandth of the work of a tenth of the load: 0.1 x 30 N x 1 mm / 2. The springs' work is part of the balance.
        assert!(gained_j < 1.5e-6, "{name}: gained {gained_j} J");
    }
}

#[test]
fn a_board_on_soft_pads_does_not_swing() {
    let soft = with_pads(baxter().clone(), 1e4);
    for plan in ten_plans().into_iter().step_by(6) {
        let trace = simulate(&soft, &plan, &Conditions::new(FRICTION, SETTINGS).scaled(0.05)).unwrap();
        let deflection_mm = judged_grasp(trace, &limits(plan.operation.kind)).measures.deflection_mm;
        let (largest, last) = (deflection_mm.iter().copied().fold(0.0, f64::max), *deflection_mm.last().unwrap());
        println!("{}: {largest:.4} {last:.4}", plan.name);
        // Critically damped. The arms' servos and the other hand leave a little.
        assert!(largest < 1.02 * last, "{}: {largest} and at last {last}", plan.name);
    }
}

#[test]
fn a_quarter_of_the_time_step_changes_little_with_elastic_pads() {
    let elastic = with_pads(baxter().clone(), STIFFNESS_N_M);
    for plan in ten_plans().into_iter().step_by(5) {
        let at = |timestep_s| {
            let settings = SimulationSettings { timestep_s, ..SETTINGS };
            let trace = simulate(&elastic, &plan, &Conditions::new(FRICTION, settings).scaled(0.5)).unwrap();
            *judged_grasp(trace, &limits(plan.operation.kind)).measures.deflection_mm.last().unwrap()
        };
        let (coarse, fine) = (at(1.0 / 500.0), at(1.0 / 2000.0));
        // As with rigid pads, see `holds.rs`.
        assert!((coarse / fine - 1.0).abs() < 0.03, "{}: {coarse} and {fine}", plan.name);
    }
}

#[test]
fn a_hand_and_arm_of_one_link_share_its_mass() {
    // The palm is the hinge's only link. The load is along the hinge's axis, so only the pads yield.
    let hinge = Hinge { effort_nm: 100.0, stiffness_nm_rad: 1e5, damping_nm_s_rad: 50.0 };
    let rigid = bench::robot(fingers_level(), Some(hinge));
    let elastic = with_pads(rigid.clone(), STIFFNESS_N_M);
    let [rigid, elastic] = [rigid, elastic].map(|robot| displaced(&robot, force_along_x_g(15.0)));
    let added_m = (elastic.translation.vector - rigid.translation.vector).x;
    let expected_m = 15.0 / (2.0 * TANGENTIAL_N_M);
    // As for a fixed hand.
    assert!((added_m - expected_m).abs() < 0.01 * expected_m, "{added_m} {expected_m}");
}
