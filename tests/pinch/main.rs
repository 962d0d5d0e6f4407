//! The simulation against closed forms: a pinch grasp, a servo and two arms.
//!
//!
//! All scenes are built by the code that `simulate` uses.

#[path = "../common/mod.rs"]
mod common;

mod baxter;
mod bench;
mod deviations;
mod elastic_pads;
mod holds;
mod loads;
mod measured;
mod patch;
mod person;
mod plates;
mod prediction;
mod steps;
mod sweep;

use std::{ops::AddAssign, thread};

use baxter::{BOARD_KG, welded_displacement_m};
use bench::{Bench, Grip, Hinge, PAD_HALF_M, THICKNESS_M, fingers_level};
use benchdog::{
    model::{
        operation::{Operation, OperationKind},
        plan::Plan,
        scenario::SimulationSettings,
        trace::{Phase, Sample, Trace},
        wrench::Wrench,
    },
    robot::{Chain, Robot},
    sim::{self, Conditions, SimError},
};
use common::checked;
use nalgebra::{DMatrix, DVector, Point3, Vector3};

/// Mass of a light block, whose weight uses little of the friction.
const LIGHT_KG: f64 = 0.05;

const GRAVITY_M_S2: f64 = 9.81;

/// Mean distance of the points of a 40.4 x 36.0 mm pad from its centre, m (docs/method.md#62-pad-limits).
const MEAN_RADIUS_M: f64 = 0.014630;

/// Checks and simulates a plan.
fn simulate(robot: &Robot, plan: &Plan, conditions: &Conditions) -> Result<Trace, SimError> {
    sim::simulate(&checked(robot, plan), conditions)
}

fn force_along_x_g(force_n: f64) -> Wrench {
    Wrench::from_force(Vector3::x() * force_n)
}

fn moment_g(axis: Vector3<f64>, moment_nm: f64) -> Wrench {
    Wrench::new(Vector3::zeros(), axis * moment_nm)
}

#[test]
fn a_block_slips_when_two_pads_cannot_hold_it() {
    for (force_n, friction) in [(20.0, 0.3), (30.0, 0.4), (30.0, 0.6), (35.0, 0.5), (60.0, 0.8)] {
        let grip = Grip { force_n, friction, mass_kg: 0.2 };
        // x_G points down, so the weight uses part of the friction.
        let slip_n = 2.0 * friction * force_n - grip.mass_kg * GRAVITY_M_S2;
        let moved_m = |factor| Bench::welded(&grip, force_along_x_g(slip_n)).motion_under(factor).0;
        // Bisection finds the limit within 0.1 % of the theory; 0.5 % is required.
        assert!(moved_m(0.995) < 1e-3, "N {force_n}, mu {friction}: slipped {} m", moved_m(0.995));
        assert!(moved_m(1.005) > 1e-3, "N {force_n}, mu {friction}: held {} m", moved_m(1.005));
    }
}

#[test]
fn a_block_turns_when_the_pads_cannot_hold_the_moment() {
    for (force_n, mass_kg) in [(30.0, LIGHT_KG), (35.0, 0.1), (60.0, 0.21)] {
        let grip = Grip { force_n, friction: 0.6, mass_kg };
        let limit_nm = 2.0 * grip.friction * force_n * MEAN_RADIUS_M;
        let turned_rad = |factor| Bench::welded(&grip, moment_g(Vector3::y(), limit_nm)).motion_under(factor).1;
        // Bisection finds 0.9996 of the uniform patch with the lightest block; the weight of the heaviest reduces it by
        // 0.05 %. 3 % is required.
        assert!(turned_rad(0.97) < 0.02, "N {force_n}: turned {}", turned_rad(0.97));
        assert!(turned_rad(1.03) > 0.1, "N {force_n}: held, {}", turned_rad(1.03));
    }
}

#[test]
fn a_block_tilts_when_it_pries_the_pads_apart() {
    let grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: LIGHT_KG };
    for (axis, half_side_m) in [(Vector3::x(), PAD_HALF_M[1]), (Vector3::z(), PAD_HALF_M[0])] {
        let limit_nm = grip.force_n * (2.0 * half_side_m + grip.friction * THICKNESS_M);
        let tilted_rad = |factor| Bench::welded(&grip, moment_g(axis, limit_nm)).motion_under(factor).1;
        // A tilted block gains lever, t theta / (2 b + mu t) or 0.7 % at 12 mrad, so the limit is read at that angle.
        // Bisection finds 1.011 and 1.006; 2 % is required.
        assert!(tilted_rad(0.98) < 0.012, "{axis}: tilted {}", tilted_rad(0.98));
        assert!(tilted_rad(1.02) > 0.012, "{axis}: held, {}", tilted_rad(1.02));
    }
}

#[test]
fn a_block_does_not_creep_below_its_slip_load() {
    let grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: LIGHT_KG };
    let slip_n = 2.0 * grip.friction * grip.force_n - grip.mass_kg * GRAVITY_M_S2;
    for factor in [0.5, 0.9] {
        let mut bench = Bench::welded(&grip, force_along_x_g(slip_n));
        bench.motion_under(factor);
        let before = bench.sample.arms[0].x_oc;
        let moved = before.inverse() * bench.run(1.0, factor, factor).arms[0].x_oc;
        // Measured: 2e-10 mm in a second. The verdict's limit is 0.1 mm/s.
        assert!(moved.translation.vector.norm() < 1e-9, "crept {} m", moved.translation.vector.norm());
    }
}

#[test]
fn the_pads_carry_the_block_and_press_with_the_grip_force() {
    let grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: 0.4 };
    let mut bench = Bench::welded(&grip, Wrench::default());
    let pads = &bench.run(1.0, 0.0, 0.0).arms[0].pads;
    let carried_n: Vector3<f64> = pads.iter().map(|pad| pad.wrench_w.force_n).sum();
    // At rest the solver's impulses balance to rounding; 1e-6 N leaves room for the last of the settling.
    assert!((carried_n - Vector3::z() * grip.mass_kg * GRAVITY_M_S2).norm() < 1e-6, "{carried_n}");
    for pad in pads {
        // The spring that pushes a finger loses 1 N/m over the micrometres of penetration.
        assert!((pad.normal_force_n - grip.force_n).abs() < 1e-4, "{}", pad.normal_force_n);
    }
}

/// A gripper on a hinge whose servo has a torque limit of 1 N m, after two seconds under a moment about the hinge.
fn hinge_under(moment_nm: f64) -> Sample {
    let hinge = Hinge { effort_nm: 1.0, stiffness_nm_rad: 843.0, damping_nm_s_rad: 30.0 };
    let robot = bench::robot(fingers_level(), Some(hinge));
    let grip = Grip { force_n: 30.0, friction: 0.6, mass_kg: LIGHT_KG };
    // The hinge turns about the world's z, which is -x_G.
    let plan = bench::plan(&robot, fingers_level(), &grip, moment_g(-Vector3::x(), moment_nm));
    let mut bench = Bench::new(&robot, &plan, grip.friction);
    bench.motion_under(1.0);
    // The end of the ramp overshoots the limit; the swing takes time to decay.
    bench.run(1.0, 1.0, 1.0);
    bench.sample
}

#[test]
fn a_servo_holds_up_to_its_limit_and_yields_beyond() {
    let below = hinge_under(0.999).arms.remove(0);
    // tau / K; rounding and the rest of the settling are 1e-12 rad and 1e-9 N m.
    assert!((below.q_rad[0] - 0.999 / 843.0).abs() < 1e-10, "{}", below.q_rad[0]);
    assert!((below.torque_demanded_nm[0] + 0.999).abs() < 1e-7);
    assert!((below.torque_applied_nm[0] + 0.999).abs() < 1e-7);

    let beyond = hinge_under(1.001).arms.remove(0);
    // Beyond the servo's limit, 1e-3 N m turn gripper and block by tens of milliradians in a second.
    assert!(beyond.q_rad[0] > 0.01, "{}", beyond.q_rad[0]);
    assert!(beyond.torque_demanded_nm[0] < -1.5, "the demand must show the overload");
    // Within a step the torque drifts by D a dt, 0.3 % here.
    assert!((beyond.torque_applied_nm[0] + 1.0).abs() < 1e-2, "{}", beyond.torque_applied_nm[0]);
}

/// Long enough to settle, otherwise short.
const QUICK: SimulationSettings =
    SimulationSettings { settle_s: 1.0, ramp_s: 0.5, hold_s: 0.5, release_s: 0.8, timestep_s: 0.002 };

fn last(trace: &Trace, phase: Phase) -> &Sample {
    trace.samples.iter().rfind(|sample| sample.phase == phase).unwrap()
}

/// Displacement of the tool point from the end of settling, m, W axes.
fn displacement_m(trace: &Trace, sample: &Sample) -> Vector3<f64> {
    let tip = Point3::from(trace.p_ot_m);
    sample.x_wo * tip - last(trace, Phase::Settle).x_wo * tip
}

fn drill(force_n: f64) -> Operation {
    Operation::drill([0.0, 0.0], force_n, THICKNESS_M)
}

/// Displacement of the gripper under a force at G, m: `J (K + dg/dq)^-1 J' f`. The torque that holds the arm's weight
/// is fed forward for the planned angles, so the change of the weight's torque adds to the servos' stiffness.
fn free_arm_displacement_m(robot: &Robot, q_rad: &[f64], force_w: &Vector3<f64>) -> Vector3<f64> {
    let chain = Chain::new(robot, 0, 0.0);
    let mut stiffness = DMatrix::from_diagonal(&DVector::from_column_slice(&robot.arms[0].stiffness_nm_rad));
    for column in 0..q_rad.len() {
        // Central differences of a smooth function: wrong by 1e-8.
        let gravity = |step: f64| {
            let mut q = q_rad.to_vec();
            q[column] += step;
            chain.gravity_torque_nm(&q)
        };
        let slope = (gravity(1e-4) - gravity(-1e-4)) / 2e-4;
        stiffness.column_mut(column).add_assign(&slope);
    }
    let jacobian = chain.jacobian_w(q_rad);
    let linear = jacobian.rows(0, 3);
    let dq = stiffness.lu().solve(&(linear.transpose() * force_w)).unwrap();
    Vector3::from_iterator((linear * dq).iter().copied())
}

#[test]
fn a_free_arm_deflects_by_its_compliance() {
    let robot = common::baxter();
    // A board of ten grams in one hand, pushed where the hand holds it.
    let mut plan = baxter::plan(robot, drill(0.0), 0.01, 30.0);
    plan.arms.truncate(1);
    plan.operation.x_ot.translation = plan.arms[0].x_og.translation;
    plan.operation.kind = OperationKind::Wrench;
    for force_o in [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axis * 0.5) {
        plan.operation.wrench_o = Wrench::from_force(force_o);
        let settings = SimulationSettings { settle_s: 2.0, ramp_s: 1.0, hold_s: 2.0, ..QUICK };
        let trace = simulate(robot, &plan, &Conditions::new(0.6, settings)).unwrap();
        let p_wg = |sample: &Sample| {
            let p_cg = -robot.arms[0].gripper.grasp_point_g();
            sample.x_wo * sample.arms[0].x_oc * Point3::from(p_cg)
        };
        let settled = last(&trace, Phase::Settle);
        // Ten grams deflect the arm by 0.1 mrad; a kilogram of error in the arm's weight by 10 mrad.
        let sagged = settled.arms[0].q_rad.iter().zip(&plan.arms[0].q_rad).map(|(q, planned)| (q - planned).abs());
        assert!(sagged.fold(0.0, f64::max) < 5e-4);
        let moved_m = p_wg(last(&trace, Phase::Hold)) - p_wg(settled);
        let force_w = plan.object.x_wo.rotation * force_o;
        let predicted_m = free_arm_displacement_m(robot, &settled.arms[0].q_rad, &force_w);
        let error = (moved_m - predicted_m).norm() / predicted_m.norm();
        // The levers change by 1e-3 over such a displacement; 0.5 % is required.
        assert!(error < 5e-3, "moved {moved_m}, predicted {predicted_m}: off by {error}");
    }
}

#[test]
fn two_arms_deflect_as_if_welded_under_a_small_load() {
    let robot = common::baxter();
    let operations = [
        drill(1.5),
        Operation::drill([0.1, 0.1], 1.5, THICKNESS_M),
        Operation::cut([0.12, 0.0], Vector3::y(), 3.0, THICKNESS_M),
    ];
    // Contacts yield: measured, by up to 4 % (0.005 mm). (The weight of a board of 1 kg exceeds what the
    // pads hold without turning: in the compliant prediction the cut deflects it 2.3 times as far as with welded
    // hands.)
    for (mass_kg, tolerance) in [(0.5, 0.05), (BOARD_KG, 0.05)] {
        for operation in operations {
            let plan = baxter::plan(robot, operation, mass_kg, 30.0);
            let trace = simulate(robot, &plan, &Conditions::new(0.6, QUICK)).unwrap();
            let found_m = displacement_m(&trace, last(&trace, Phase::Hold));
            let welded_m = welded_displacement_m(robot, &plan);
            let error = (found_m - welded_m).norm() / welded_m.norm();
            println!("{mass_kg} kg: off by {:.4} mm, {:.2} %", (found_m - welded_m).norm() * 1e3, 100.0 * error);
            assert!(error < tolerance, "{mass_kg} kg, {operation:?}: found {found_m}, welded {welded_m}: {error}");
        }
    }
}

#[test]
fn forces_and_moments_on_the_board_balance_in_the_hold() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, Operation::cut([0.0, 0.1], Vector3::x(), 10.0, THICKNESS_M), BOARD_KG, 30.0);
    let trace = simulate(robot, &plan, &Conditions::new(0.6, QUICK)).unwrap();
    let sample = last(&trace, Phase::Hold);
    let centre_w = sample.x_wo.translation.vector;
    let tip_w = (sample.x_wo * Point3::from(trace.p_ot_m)).coords;
    let weight = Wrench::from_force(Vector3::z() * -GRAVITY_M_S2 * BOARD_KG);
    let pads = sample.arms.iter().flat_map(|arm| &arm.pads);
    let total = pads.fold(weight + sample.tool_wrench_w.about(&(tip_w - centre_w)), |sum, pad| {
        sum + pad.wrench_w.about(&(pad.p_wp_m - centre_w))
    });
    // The rest accelerates the board, whose inertia is that of 1 kg, at less than 10 mm/s^2.
    assert!(total.force_n.norm() < 1e-2, "{total:?}");
    assert!(total.moment_nm.norm() < 1e-3, "{total:?}");
}

#[test]
fn no_board_oscillates_between_the_hands() {
    let robot = common::baxter();
    let cut = Operation::cut([0.12, 0.0], Vector3::y(), 3.0, THICKNESS_M);
    for (operation, mass_kg) in [drill(15.0), cut].iter().flat_map(|operation| MASSES_KG.map(|kg| (*operation, kg))) {
        for timestep_s in [0.001, 0.002] {
            let plan = baxter::plan(robot, operation, mass_kg, 30.0);
            let settings = SimulationSettings { ramp_s: 0.3, hold_s: 0.3, release_s: 0.0, timestep_s, ..QUICK };
            let trace = simulate(robot, &plan, &Conditions::new(0.6, settings)).unwrap();
            let jump_n = largest_jump_n(&trace);
            println!("{mass_kg} kg, {timestep_s} s: {jump_n:.4} N from step to step");
            // 0.04 N a step is the end of a swing; boards that oscillate do so by 1 N and more.
            assert!(jump_n < 0.1, "{mass_kg} kg, {timestep_s} s: a pad's force jumps by {jump_n} N from step to step");
        }
    }
}

/// Masses from light foam to wood, kg.
const MASSES_KG: [f64; 9] = [0.03, 0.05, 0.07, 0.1, 0.21, 0.35, 0.5, 1.0, 2.0];

/// The largest change of a pad's force from one step to the next in the last fifty steps, N.
fn largest_jump_n(trace: &Trace) -> f64 {
    let force_n = |step: usize, arm: usize, pad: usize| trace.samples[step].arms[arm].pads[pad].wrench_w.force_n;
    let steps = trace.samples.len() - 50..trace.samples.len();
    let jumps_n = steps.flat_map(|step| {
        [(0, 0), (0, 1), (1, 0), (1, 1)]
            .map(|(arm, pad)| (force_n(step, arm, pad) - force_n(step - 1, arm, pad)).norm())
    });
    jumps_n.fold(0.0, f64::max)
}

#[test]
fn a_board_without_a_load_stays() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(0.0), BOARD_KG, 30.0);
    let settings = SimulationSettings { settle_s: 5.0, ramp_s: 0.0, hold_s: 0.0, release_s: 0.0, timestep_s: 0.002 };
    let trace = simulate(robot, &plan, &Conditions::new(0.6, settings)).unwrap();
    let drift_m = displacement_m(&trace, &trace.samples[1650]).norm();
    assert!(drift_m < 1e-8, "drifted {drift_m} m in the last 1.7 s");
}

#[test]
fn after_the_release_the_board_returns() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(1.5), BOARD_KG, 30.0);
    let trace = simulate(robot, &plan, &Conditions::new(0.6, QUICK)).unwrap();
    let bent_m = displacement_m(&trace, last(&trace, Phase::Hold)).norm();
    let left_m = displacement_m(&trace, last(&trace, Phase::Release)).norm();
    // The swing has decayed by then; at a sudden release the hands slide by micrometres, 5 % of the deflection.
    assert!(left_m < 0.1 * bent_m, "bent {bent_m} m, left {left_m} m");
}

#[test]
fn a_board_that_is_torn_out_is_lost_and_the_arms_stay() {
    let robot = common::baxter();
    let operation = Operation::cut([0.0, 0.1], -Vector3::y(), 200.0, THICKNESS_M);
    let trace = simulate(robot, &baxter::plan(robot, operation, BOARD_KG, 30.0), &Conditions::new(0.6, QUICK)).unwrap();
    // A lost board is an outcome, not a breakdown.
    assert_eq!(trace.broke_down, None);
    let (before, after) = (last(&trace, Phase::Settle), trace.samples.last().unwrap());
    assert!((after.x_wo.translation.vector - before.x_wo.translation.vector).norm() > 1.0);
    // The trace ends a tenth of a second after the last contact, long before the load ends.
    let touched = |sample: &&Sample| sample.arms.iter().flat_map(|arm| &arm.pads).any(|pad| pad.normal_force_n > 0.0);
    let last_touch_s = trace.samples.iter().rev().find(touched).unwrap().time_s;
    // One step on either side: the count of untouched steps is rounded.
    assert!((after.time_s - last_touch_s - 0.1).abs() < 2.1 * QUICK.timestep_s, "{} {last_touch_s}", after.time_s);
    assert!(after.phase.is_loaded());
    for (arm, settled) in after.arms.iter().zip(&before.arms) {
        // Without a board the fingers close to their limits, which are solved to micrometres.
        assert!(arm.finger_m.iter().all(|travel_m| travel_m.abs() < 1e-4), "{:?}", arm.finger_m);
        // The arms move back to the planned angles, as they no longer carry the board.
        let off_rad = arm.q_rad.iter().zip(&settled.q_rad).map(|(q, q_settled)| (q - q_settled).abs());
        assert!(off_rad.fold(0.0, f64::max) < 0.1, "{:?}", arm.q_rad);
    }
}

/// All numbers of a trace, in the shortest decimals that read back exactly.
fn bits(trace: &Trace) -> String {
    format!("{trace:?}")
}

#[test]
fn equal_inputs_give_equal_traces() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(15.0), BOARD_KG, 30.0);
    let settings = SimulationSettings { settle_s: 0.1, ramp_s: 0.1, hold_s: 0.1, release_s: 0.1, timestep_s: 0.002 };
    let run = || bits(&simulate(robot, &plan, &Conditions::new(0.6, settings)).unwrap());
    let here = run();
    let there = thread::scope(|scope| [scope.spawn(run), scope.spawn(run)].map(|thread| thread.join().unwrap()));
    assert!(there.iter().all(|other| *other == here));
}

#[test]
fn the_trace_describes_the_simulation() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(3.0), BOARD_KG, 30.0);
    let settings = SimulationSettings { settle_s: 0.1, ramp_s: 0.1, hold_s: 0.1, release_s: 0.1, timestep_s: 0.002 };
    let trace = simulate(robot, &plan, &Conditions::new(0.6, settings)).unwrap();
    assert_eq!(trace.broke_down, None);
    assert_eq!(trace.samples.len(), 201);
    assert_eq!(trace.arms.iter().map(|arm| arm.name.as_str()).collect::<Vec<_>>(), ["left", "right"]);
    let mut pads = trace.arms[0].pads.clone();
    pads.sort();
    assert_eq!(pads, ["lower", "upper"]);
    let first = &trace.samples[0];
    assert_eq!((first.time_s, first.load_factor, first.phase), (0.0, 0.0, Phase::Grip));
    for (arm, hold) in first.arms.iter().zip(&plan.arms) {
        assert_eq!(arm.q_rad, hold.q_rad);
        // Both pads are on the board: twice the travel is its thickness; the pads meet at a travel of -1.85 mm.
        assert!((arm.finger_m.iter().sum::<f64>() - (THICKNESS_M + 2.0 * 0.00185)).abs() < 1e-12);
    }
    // The tool pushes into the worked face, whose normal is +x_W, and the board moves with it.
    let hold = last(&trace, Phase::Hold);
    assert_eq!(hold.load_factor, 1.0);
    assert!((hold.tool_wrench_w.force_n - Vector3::new(-3.0, 0.0, 0.0)).norm() < 1e-2);
    assert!(displacement_m(&trace, hold).x < 0.0);
}

#[test]
fn an_upper_pad_pushes_the_board_down() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(0.0), BOARD_KG, 30.0);
    let settings = SimulationSettings { settle_s: 0.2, ramp_s: 0.0, hold_s: 0.0, release_s: 0.0, timestep_s: 0.002 };
    let trace = simulate(robot, &plan, &Conditions::new(0.6, settings)).unwrap();
    let sample = last(&trace, Phase::Settle);
    let face_w = sample.x_wo.rotation * Vector3::z();
    for (arm, names) in sample.arms.iter().zip(&trace.arms) {
        for (pad, name) in arm.pads.iter().zip(&names.pads) {
            let side = if name == "upper" { 1.0 } else { -1.0 };
            assert!(pad.wrench_w.force_n.dot(&face_w) * side < -29.0);
            assert!((pad.p_wp_m - sample.x_wo.translation.vector).dot(&face_w) * side > 0.0149);
        }
    }
}

#[test]
fn invalid_conditions_are_refused() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(15.0), BOARD_KG, 30.0);
    let short = SimulationSettings { settle_s: 0.0, ramp_s: 0.0, hold_s: 0.0, release_s: 0.0, timestep_s: 0.002 };
    assert!(simulate(robot, &plan, &Conditions::new(0.6, short)).is_ok());
    assert!(matches!(
        simulate(robot, &plan, &Conditions::new(-0.1, short)),
        Err(SimError::Settings { key: "friction", .. })
    ));
}

#[test]
fn a_simulation_that_breaks_down_reports_it() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, drill(1.0), BOARD_KG, 30.0);
    let trace = simulate(robot, &plan, &Conditions::new(0.6, QUICK).scaled(1e300)).unwrap();
    // The first step of the ramp is the 501st.
    assert_eq!(trace.broke_down.as_deref(), Some("at 1.002 s the state is no longer finite"));
    assert_eq!(trace.samples.len(), 501);
    assert!(trace.samples.iter().all(|sample| sample.x_wo.translation.vector.iter().all(|x| x.is_finite())));
}
