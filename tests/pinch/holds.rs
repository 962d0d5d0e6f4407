//! Whole simulations: the ten plans of `tests/data/holds`, and properties of every simulation.

use benchdog::{
    judge::{Judgement, judge},
    model::{
        load::{ForceFrame, ForceProfile, Load},
        operation::{Operation, OperationKind},
        plan::Plan,
        scenario::{Limits, SimulationSettings},
        trace::Trace,
        uncertainty::Uncertainty,
        verdict::{CheckKind, VerdictKind},
        wrench::Wrench,
    },
    robot::Robot,
    sim::Conditions,
    statics::{ContactModel, LoadFactorOutcome, StabilityWorkspace},
};
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};

use crate::{
    THICKNESS_M,
    baxter::{self, BOARD_KG},
    common::{self, checked, ten_plans},
    simulate,
};

/// The default friction of the pads.
pub const FRICTION: f64 = 0.6;

/// The default settings without the release, which is not judged.
pub const SETTINGS: SimulationSettings =
    SimulationSettings { settle_s: 0.5, ramp_s: 1.0, hold_s: 1.0, release_s: 0.0, timestep_s: 0.002 };

/// docs/method.md#810-default-limits.
pub fn limits(kind: OperationKind) -> Limits {
    let deflection_mm = if kind == OperationKind::Drill { 5.0 } else { 15.0 };
    Limits { deflection_mm, ..Limits::USUAL }
}

/// Judges the grasp and the deflection alone. In the ten plans no bodies of the robot touch, but some nearly do, and they meet as
/// the arms give way.
pub fn judged_grasp(mut trace: Trace, limits: &Limits) -> Judgement {
    trace.samples.iter_mut().for_each(|sample| sample.robot_clearance_m = None);
    judge(&trace, limits)
}

fn judged(robot: &Robot, plan: &Plan, conditions: &Conditions) -> Judgement {
    judged_grasp(simulate(robot, plan, conditions).unwrap(), &limits(plan.operation.kind))
}

fn value(judgement: &Judgement, kind: CheckKind) -> f64 {
    judgement.checks.iter().find(|check| check.name == kind).unwrap().value
}

/// Differences between two time steps below these are negligible: three thousandths of the verdict's limits of slip.
/// Hands that stick move by 0.006 mm and 0.02 degrees in all, with differences of 0.001 mm and 0.002 degrees.
const SLIP_FLOOR_MM: f64 = 0.003;
const SLIP_FLOOR_DEG: f64 = 0.006;

/// The values that differ too much between time steps of 2 and 0.5 ms.
fn differences(robot: &Robot, plan: &Plan) -> Vec<String> {
    let at = |timestep_s| {
        let settings = SimulationSettings { timestep_s, ..SETTINGS };
        judged(robot, plan, &Conditions::new(FRICTION, settings))
    };
    let (coarse, fine) = (at(1.0 / 500.0), at(1.0 / 2000.0));
    let bounds =
        [(CheckKind::Deflection, 0.0), (CheckKind::Slip, SLIP_FLOOR_MM), (CheckKind::SlipRotation, SLIP_FLOOR_DEG)];
    let mut too_far = Vec::new();
    for (kind, floor) in bounds {
        let (coarse, fine) = (value(&coarse, kind), value(&fine, kind));
        println!("{} {kind}: {coarse:.4} and {fine:.4}, {:+.2} %", plan.name, 100.0 * (coarse / fine - 1.0));
        if (coarse - fine).abs() > (0.03 * fine).max(floor) {
            too_far.push(format!("{} {kind}: {coarse} and {fine}", plan.name));
        }
    }
    too_far
}

#[test]
fn a_quarter_of_the_time_step_changes_little() {
    let too_far: Vec<String> = ten_plans().iter().flat_map(|plan| differences(common::baxter(), plan)).collect();
    assert!(too_far.is_empty(), "{too_far:#?}");
}

#[test]
fn ten_times_the_certificates_load_always_fails() {
    let robot = common::baxter();
    for plan in ten_plans() {
        let hold = ContactModel::of_plan(&checked(robot, &plan), FRICTION).unwrap();
        let found = StabilityWorkspace::new().load_factor(&hold).unwrap();
        let LoadFactorOutcome::Solved(certificate) = found else { panic!("{}: {found:?}", plan.name) };
        let conditions = Conditions::new(FRICTION, SETTINGS).scaled(10.0 * certificate.load_factor);
        let judgement = judged(robot, &plan, &conditions);
        println!("{}: {} {:?}", plan.name, judgement.verdict, judgement.first_failure);
        // Under such a load the engine may break down, but only after a limit that determines the verdict.
        assert!(judgement.first_failure.is_some(), "{}: {} {:?}", plan.name, judgement.verdict, judgement.reason);
        assert_ne!(judgement.verdict, VerdictKind::NoVerdict, "{}", plan.name);
    }
}

#[test]
fn a_board_without_a_load_stays_for_a_minute() {
    let robot = common::baxter();
    let plan = baxter::plan(robot, Operation::drill([0.0, 0.0], 15.0, THICKNESS_M), BOARD_KG, 30.0);
    let settings = SimulationSettings { settle_s: 1.0, ramp_s: 1.0, hold_s: 59.0, ..SETTINGS };
    let judgement = judged(robot, &plan, &Conditions::new(FRICTION, settings).scaled(0.0));
    assert_eq!(judgement.verdict, VerdictKind::Holds);
    for kind in [CheckKind::Slip, CheckKind::Deflection] {
        println!("{kind} after a minute: {:e} mm", value(&judgement, kind));
        assert!(value(&judgement, kind) < 0.01, "{kind}: {} mm", value(&judgement, kind));
    }
}

/// A random load of any kind and size that a scenario may have.
fn random_load(draw: &mut impl FnMut(f64, f64) -> f64) -> Load {
    let profile = match draw(0.0, 4.0) as usize {
        0 => ForceProfile::Ramp,
        1 => ForceProfile::Drill {
            spindle_torque_nm: draw(-3.0, 3.0),
            vibration_n: draw(0.0, 20.0),
            vibration_hz: draw(0.0, 125.0),
            breakthrough_s: (draw(0.0, 1.0) < 0.5).then_some(draw(0.0, 0.1)),
        },
        2 => ForceProfile::Path {
            speed_m_s: draw(0.0, 2.0),
            centre_m: [draw(-0.1, 0.1), 0.2],
            normal_share: draw(-1.0, 1.0),
        },
        _ => ForceProfile::Measured {
            samples: (0..5)
                .map(|k| std::array::from_fn(|c| if c == 0 { f64::from(k) * 0.05 } else { draw(-30.0, 30.0) }))
                .collect(),
        },
    };
    let frame = if draw(0.0, 1.0) < 0.5 { ForceFrame::Board } else { ForceFrame::World };
    Load { frame, profile, ..Load::default() }
}

#[test]
fn two_hundred_random_scenarios_end_with_a_judgement() {
    let robot = common::baxter();
    let mut random = rand_pcg::Pcg64::seed_from_u64(7);
    let mut draw = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let still = baxter::plan(robot, Operation::drill([0.0, 0.0], 15.0, THICKNESS_M), BOARD_KG, 30.0);
    let (mut holds, mut without_verdict) = (0, Vec::new());
    for case in 0..200 {
        let mut plan = still.clone();
        let size = 10.0_f64.powf(draw(-1.0, 3.0));
        let wrench: [f64; 6] = std::array::from_fn(|k| draw(-1.0, 1.0) * if k < 3 { size } else { 0.1 * size });
        plan.operation.wrench_o = Wrench::from(wrench);
        plan.operation.kind = OperationKind::Wrench;
        plan.operation.x_ot.translation.vector = Vector3::new(draw(-0.25, 0.25), draw(-0.2, 0.2), 0.015);
        plan.object.mass_kg = 10.0_f64.powf(draw(-1.5, 1.0));
        plan.arms.iter_mut().for_each(|hold| hold.grip_force_n = draw(1.0, 35.0));
        if draw(0.0, 1.0) < 0.2 {
            plan.arms.truncate(1);
        }
        let settings =
            SimulationSettings { settle_s: 0.1, ramp_s: 0.1, hold_s: 0.2, release_s: 0.05, timestep_s: 0.002 };
        let conditions = Conditions {
            load: random_load(&mut draw),
            uncertainty: Uncertainty {
                friction_scale: draw(0.0, 2.0),
                grip_force_scale: draw(0.1, 2.0),
                contact_stiffness_scale: 10.0_f64.powf(draw(-3.0, 0.24)),
                joint_stiffness_scale: 10.0_f64.powf(draw(-2.0, 2.0)),
                friction_scales: vec![draw(0.0, 2.0), draw(0.0, 2.0)],
                grip_force_scales: vec![draw(0.1, 2.0), draw(0.1, 2.0)],
                board_mass_scale: 10.0_f64.powf(draw(-0.5, 0.5)),
                board_thickness_mm: draw(-5.0, 2.0),
                force_scale: draw(0.0, 1.5),
                tool_tilt_deg: [draw(-20.0, 20.0), draw(-20.0, 20.0)],
                tool_offset_mm: [draw(-20.0, 20.0), draw(-20.0, 20.0)],
                person_offset_mm: [draw(-500.0, 500.0), draw(-500.0, 500.0)],
                joint_offset_deg: (0..2).map(|_| (0..7).map(|_| draw(-0.2, 0.2)).collect()).collect(),
                ramp_scale: draw(0.1, 1.0),
            },
            ..Conditions::new(FRICTION, settings)
        };
        let trace = simulate(robot, &plan, &conditions).unwrap();
        // As many samples as steps, or fewer if the board is lost or the engine breaks down.
        assert!(trace.samples.len() <= 226, "case {case}");
        let judgement = judge(&trace, &limits(OperationKind::Cut));
        if judgement.verdict == VerdictKind::NoVerdict {
            without_verdict.push(format!("{case}: {}", judgement.reason.unwrap()));
        } else {
            holds += usize::from(judgement.verdict == VerdictKind::Holds);
            assert!(judgement.checks.iter().all(|check| check.value.is_finite()), "case {case}");
        }
    }
    println!("{holds} hold; without a verdict: {without_verdict:#?}");
    // The loads range from those that every grasp resists to those that none does.
    assert!((5..150).contains(&holds), "{holds}");
    // There are 21, nearly all with loads far above what the arms resist.
    assert!(without_verdict.len() < 25, "{without_verdict:#?}");
}
