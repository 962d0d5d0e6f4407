//! The tool's wrench over time, uncertainty, and the balance of momentum and energy.

use benchdog::{
    model::{
        load::{ForceFrame, ForceProfile, Load},
        operation::Operation,
        plan::Plan,
        scenario::SimulationSettings,
        trace::{Phase, Sample, Trace},
        uncertainty::Uncertainty,
        wrench::Wrench,
    },
    robot::Robot,
    sim::{Conditions, LateralDirection, SimError},
    statics::{ContactModel, WeldedStiffness},
};
use nalgebra::{UnitQuaternion, Vector3};

use crate::{
    GRAVITY_M_S2, LIGHT_KG, THICKNESS_M,
    baxter::{self, BOARD_KG},
    bench::{self, Bench, Grip, Hinge, fingers_level},
    checked, common, displacement_m, drill, force_along_x_g, last, moment_g, simulate,
};

const SHORT: SimulationSettings =
    SimulationSettings { settle_s: 0.1, ramp_s: 0.1, hold_s: 0.2, release_s: 0.1, timestep_s: 0.002 };

fn under(profile: ForceProfile) -> Conditions {
    Conditions { load: Load { profile, ..Load::default() }, ..Conditions::new(0.6, SHORT) }
}

fn traced(robot: &Robot, plan: &Plan, profile: ForceProfile) -> Trace {
    simulate(robot, plan, &under(profile)).unwrap()
}

/// The tool's wrench in O axes.
fn wrench_o(sample: &Sample) -> Wrench {
    let back = sample.x_wo.rotation.inverse();
    Wrench::new(back * sample.tool_wrench_w.force_n, back * sample.tool_wrench_w.moment_nm)
}

fn at(trace: &Trace, time_s: f64) -> &Sample {
    &trace.samples[(time_s / SHORT.timestep_s).round() as usize]
}

#[test]
fn a_drill_has_torque_and_vibration_and_breaks_through_within_20_ms() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(10.0), BOARD_KG, 30.0);
    let profile =
        ForceProfile::Drill { spindle_torque_nm: 0.4, vibration_n: 2.0, vibration_hz: 25.0, breakthrough_s: Some(0.1) };
    let trace = traced(robot, &plan, profile);
    // z_T = -z_O. 0.01 s after the start of the load the sine of 25 Hz is 1 and the ramp is at a tenth.
    let first = wrench_o(at(&trace, 0.11));
    // The board turns by microradians between the start of the step, when the wrench is applied, and its end.
    assert!((first.force_n - Vector3::new(0.0, 0.0, -1.2)).norm() < 1e-4, "{first:?}");
    assert!((first.moment_nm - Vector3::new(0.0, 0.0, -0.04)).norm() < 1e-5, "{first:?}");
    let whole = wrench_o(at(&trace, 0.25));
    assert!((whole.force_n.z + 10.0 + 2.0 * (std::f64::consts::TAU * 25.0 * 0.15).sin()).abs() < 1e-3, "{whole:?}");
    assert_eq!(at(&trace, 0.3).load_factor, 1.0);
    assert!((at(&trace, 0.31).load_factor - 0.5).abs() < 1e-9);
    assert!(at(&trace, 0.32).load_factor < 1e-9 && at(&trace, 0.4).phase == Phase::Hold);
}

#[test]
fn a_knife_travels_around_the_circle_with_its_force_along_the_tangent() {
    let robot = common::baxter();
    let radius_m = 0.12;
    let cut = Operation::cut([radius_m, 0.0], Vector3::y(), 10.0, THICKNESS_M);
    let profile = ForceProfile::Path { speed_m_s: 0.3, centre_m: [0.0, 0.0], normal_share: 0.2 };
    let trace = traced(robot, &baxter::plan(robot, cut, BOARD_KG, 30.0), profile);
    for (time_s, held_s) in [(0.2, 0.0), (0.3, 0.1), (0.4, 0.2)] {
        let (sin, cos) = f64::sin_cos(0.3 * held_s / radius_m);
        let sample = at(&trace, time_s);
        assert!((sample.p_ot_m - Vector3::new(radius_m * cos, radius_m * sin, 0.015)).norm() < 1e-12, "{time_s} s");
        let expected_n = Vector3::new(-10.0 * sin, 10.0 * cos, -2.0);
        // The board turns by 0.1 mrad in a step; this is the state at its end.
        assert!((wrench_o(sample).force_n - expected_n).norm() < 5e-3, "{time_s} s: {:?}", wrench_o(sample));
    }
    // The other way around, clockwise.
    let cut = Operation::cut([radius_m, 0.0], -Vector3::y(), 10.0, THICKNESS_M);
    let profile = ForceProfile::Path { speed_m_s: 0.3, centre_m: [0.0, 0.0], normal_share: 0.0 };
    let trace = traced(robot, &baxter::plan(robot, cut, BOARD_KG, 30.0), profile);
    assert!(at(&trace, 0.4).p_ot_m.y < -0.05);
}

/// The share in words of the operation: 2 N of 10 N. A drill's 90 degrees are along -y_O; a cut's 0 degrees are left of it, and turn
/// with the path.
#[test]
fn a_sideways_push_grows_with_the_load_and_turns_with_a_path() {
    let robot = common::baxter();
    let pushed = |operation: Operation, profile, direction_deg| {
        let load = Load { profile, lateral_share: 0.2, ..Load::default() };
        let lateral_direction = LateralDirection::Given(direction_deg);
        let conditions = Conditions { load, lateral_direction, ..Conditions::new(0.6, SHORT) };
        simulate(robot, &baxter::plan(robot, operation, BOARD_KG, 30.0), &conditions).unwrap()
    };
    let trace = pushed(drill(10.0), ForceProfile::Ramp, 90.0);
    for (time_s, share) in [(0.15, 0.5), (0.3, 1.0)] {
        // The board turns by microradians between the start of the step, when the wrench is applied, and its end.
        let found_n = wrench_o(at(&trace, time_s)).force_n;
        assert!((found_n - Vector3::new(0.0, -2.0, -10.0) * share).norm() < 1e-3, "{time_s} s: {found_n}");
    }
    let radius_m = 0.12;
    let profile = ForceProfile::Path { speed_m_s: 0.3, centre_m: [0.0, 0.0], normal_share: 0.0 };
    let trace = pushed(Operation::cut([radius_m, 0.0], Vector3::y(), 10.0, THICKNESS_M), profile, 0.0);
    for (time_s, held_s) in [(0.2, 0.0), (0.4, 0.2)] {
        let (sin, cos) = f64::sin_cos(0.3 * held_s / radius_m);
        let expected_n = Vector3::new(-10.0 * sin - 2.0 * cos, 10.0 * cos - 2.0 * sin, 0.0);
        let found_n = wrench_o(at(&trace, time_s)).force_n;
        assert!((found_n - expected_n).norm() < 5e-3, "{time_s} s: {found_n}");
    }
}

#[test]
fn a_measured_load_is_linear_between_its_rows_and_constant_beyond() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(10.0), BOARD_KG, 30.0);
    let row = |time_s: f64, force_n: f64| [time_s, 0.0, 0.0, force_n, 0.0, 0.01 * force_n, 0.0];
    let samples = vec![row(0.05, 0.0), row(0.15, -8.0), row(0.25, -4.0)];
    let trace = traced(robot, &plan, ForceProfile::Measured { samples: samples.clone() });
    for (time_s, force_n, load_factor) in [(0.14, 0.0, 0.0), (0.2, -4.0, 0.5), (0.3, -6.0, 0.75), (0.39, -4.0, 0.5)] {
        let sample = at(&trace, time_s);
        assert!((wrench_o(sample).force_n.z - force_n).abs() < 1e-4, "{time_s} s: {:?}", wrench_o(sample));
        assert!((sample.load_factor - load_factor).abs() < 1e-9, "{time_s} s: {}", sample.load_factor);
    }
    let mut backwards = samples;
    backwards.swap(0, 1);
    let refused = simulate(robot, &plan, &under(ForceProfile::Measured { samples: backwards }));
    assert!(matches!(refused, Err(SimError::Profile { .. })));
}

#[test]
fn a_load_fixed_in_the_world_does_not_turn_with_the_board() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, Operation::drill([0.1, 0.1], 20.0, THICKNESS_M), BOARD_KG, 30.0);
    let last_hold = |frame| {
        let conditions = Conditions { load: Load { frame, ..Load::default() }, ..Conditions::new(0.6, SHORT) };
        last(&simulate(robot, &plan, &conditions).unwrap(), Phase::Hold).clone()
    };
    let planned_n = plan.object.x_wo.rotation * Vector3::new(0.0, 0.0, -20.0);
    let (world, board) = (last_hold(ForceFrame::World), last_hold(ForceFrame::Board));
    assert!((world.tool_wrench_w.force_n - planned_n).norm() < 1e-12);
    let turned_rad = board.x_wo.rotation.angle_to(&plan.object.x_wo.rotation);
    let off_rad = board.tool_wrench_w.force_n.angle(&planned_n);
    // A rotation of the board about the force itself does not change its direction.
    assert!(turned_rad > 1e-3 && off_rad > 0.3 * turned_rad && off_rad <= turned_rad * 1.01, "{off_rad} {turned_rad}");
}

#[test]
fn each_uncertainty_has_its_effect() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(1.5), 1.0, 15.0);
    let settings = SimulationSettings { settle_s: 1.0, ramp_s: 0.5, hold_s: 0.5, ..SHORT };
    let with = |uncertainty| {
        let trace = simulate(robot, &plan, &Conditions { uncertainty, ..Conditions::new(0.6, settings) }).unwrap();
        let sample = last(&trace, Phase::Hold).clone();
        (displacement_m(&trace, &sample).norm(), sample, trace.arms[0].grip_force_n)
    };
    let plain = with(Uncertainty::default());
    let soft = with(Uncertainty { joint_stiffness_scale: 0.5, ..Uncertainty::default() });
    // Twice, except for the share of the contacts; the board of 1 kg sags twice as far before the load, too.
    assert!((soft.0 / plain.0 - 2.0).abs() < 0.1, "{} {}", soft.0, plain.0);
    let tight = with(Uncertainty { grip_force_scale: 1.6, ..Uncertainty::default() });
    let normal_n = |sample: &Sample| sample.arms[0].pads.iter().map(|pad| pad.normal_force_n).sum::<f64>();
    assert!((normal_n(&tight.1) / normal_n(&plain.1) - 1.6).abs() < 0.01);
    assert_eq!(tight.2, 24.0);
    let yielding = with(Uncertainty { contact_stiffness_scale: 0.1, ..Uncertainty::default() });
    let ratio = yielding.1.self_check.penetration_m / plain.1.self_check.penetration_m;
    // The largest of all corners: how unevenly they press depends on how the hands came to rest.
    assert!((ratio - 10.0).abs() < 2.0, "{ratio}");

    let grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: LIGHT_KG };
    let slip_n = 2.0 * grip.friction * grip.force_n - grip.mass_kg * GRAVITY_M_S2;
    let bench_robot = bench::robot(fingers_level(), None);
    let block = bench::plan(&bench_robot, fingers_level(), &grip, force_along_x_g(0.9 * slip_n));
    let slid_m = |friction_scale| {
        let uncertainty = Uncertainty { friction_scale, ..Uncertainty::default() };
        let conditions = Conditions { uncertainty, ..Conditions::new(grip.friction, settings) };
        let trace = simulate(&bench_robot, &block, &conditions).unwrap();
        (trace.arms.len(), displacement_m(&trace, trace.samples.last().unwrap()).norm())
    };
    assert!(slid_m(1.0).1 < 1e-3 && slid_m(0.8).1 > 1e-2);
}

/// The wrench of a hand's pads on the board about O's origin, O axes.
fn hand_wrench_o(sample: &Sample, arm: usize) -> Wrench {
    let centre_w = sample.x_wo.translation.vector;
    let pads = sample.arms[arm].pads.iter();
    let total = pads.fold(Wrench::default(), |sum, pad| sum + pad.wrench_w.about(&(pad.p_wp_m - centre_w)));
    let back = sample.x_wo.rotation.inverse();
    Wrench::new(back * total.force_n, back * total.moment_nm)
}

#[test]
fn a_closed_chain_shares_load_and_internal_force_by_its_stiffness() {
    let robot = common::baxter();
    // A cut off the centre: the internal force is as large as the load.
    let cut = Operation::cut([0.12, 0.0], Vector3::y(), 3.0, THICKNESS_M);
    let plan = baxter::plan(robot, cut, 1.0, 30.0);
    let settings = SimulationSettings { settle_s: 1.0, ramp_s: 0.5, hold_s: 0.5, ..SHORT };
    let trace = simulate(robot, &plan, &Conditions::new(0.6, settings)).unwrap();
    let hold = ContactModel::of_plan(&checked(robot, &plan), 0.6).unwrap();
    let predicted = WeldedStiffness::new(&hold).unwrap().hand_wrenches(&hold.load);
    let (before, after) = (last(&trace, Phase::Settle), last(&trace, Phase::Hold));
    for (arm, predicted) in predicted.iter().enumerate() {
        let change = hand_wrench_o(after, arm) + hand_wrench_o(before, arm).scaled(-1.0);
        let off_n = (change.force_n - predicted.force_n).norm();
        println!(
            "hand {arm}: found {:.3?} N, welded {:.3?} N",
            change.force_n.as_slice(),
            predicted.force_n.as_slice()
        );
        // Pads are slightly compliant, unlike welds: 5 % of the load of 3 N.
        assert!(off_n < 0.15, "arm {arm}: found {change:?}, welded {predicted:?}");
    }
}

#[test]
fn a_release_below_the_slip_load_leaves_no_slip() {
    let grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: LIGHT_KG };
    let slip_n = 2.0 * grip.friction * grip.force_n - grip.mass_kg * GRAVITY_M_S2;
    let mut bench = Bench::welded(&grip, force_along_x_g(slip_n));
    let before = bench.run(0.2, 0.0, 0.0).arms[0].x_oc;
    bench.run(0.5, 0.0, 0.8);
    bench.run(0.5, 0.8, 0.8);
    bench.run(0.5, 0.8, 0.0);
    let moved_m = (before.inverse() * bench.run(0.5, 0.0, 0.0).arms[0].x_oc).translation.vector.norm();
    println!("left after the release: {moved_m:e} m");
    // A thousandth of the verdict's slip limit.
    assert!(moved_m < 1e-6, "{moved_m} m");
}

#[test]
fn the_energy_balance_closes_in_a_swing() {
    // A gripper on an undamped hinge swings under a moment: only the integrator dissipates.
    let hinge = Hinge { effort_nm: 50.0, stiffness_nm_rad: 50.0, damping_nm_s_rad: 0.0 };
    let x_wg = fingers_level();
    let robot = bench::robot(x_wg, Some(hinge));
    let grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: LIGHT_KG };
    let plan = bench::plan(&robot, x_wg, &grip, moment_g(-Vector3::x(), 1.0));
    let mut bench = Bench::new(&robot, &plan, grip.friction);
    bench.run(0.2, 0.0, 0.0);
    let settled_j = bench.sample.self_check.contact_energy_j;
    // The moment acts at once and does 0.02 J of work in the first swing.
    let mut most_j = 0.0_f64;
    for _ in 0..200 {
        bench.run(0.002, 1.0, 1.0);
        most_j = most_j.max(bench.sample.self_check.contact_energy_j - settled_j);
    }
    let swing_rad = bench.sample.arms[0].q_rad[0];
    println!("swing {swing_rad} rad, created {most_j:e} J, left {:e} J", bench.sample.self_check.contact_energy_j);
    // The largest work is 2 tau^2 / K = 0.04 J; the trapezoid rule of the balance is accurate to a per cent of it.
    assert!(most_j < 4e-4, "{most_j} J");
    assert!(bench.sample.self_check.coupling_m < 1e-6);
}

#[test]
fn the_frame_of_a_slanted_world_load_is_the_planned_one() {
    // Invariance: rotating the whole scene about the vertical changes nothing in the board's frame.
    let robot = |turn: f64| {
        let level = fingers_level();
        let x_wg = nalgebra::Isometry3::from_parts(
            level.translation,
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn) * level.rotation,
        );
        (bench::robot(x_wg, None), x_wg)
    };
    let grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: 0.2 };
    let found = [0.0, 0.7].map(|turn| {
        let (robot, x_wg) = robot(turn);
        let plan = bench::plan(&robot, x_wg, &grip, force_along_x_g(20.0));
        let load = Load { frame: ForceFrame::World, ..Load::default() };
        let trace = simulate(&robot, &plan, &Conditions { load, ..Conditions::new(0.6, SHORT) }).unwrap();
        last(&trace, Phase::Hold).arms[0].x_oc
    });
    // Rounding, and contacts in another order.
    assert!((found[0].inverse() * found[1]).translation.vector.norm() < 1e-6, "{found:?}");
}
