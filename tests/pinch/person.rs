//! A person too close to robot and board, and one at a safe distance.

use benchdog::{
    collision::{BoardBody, CollisionModel, PersonClearance, PersonPart, Scene},
    human::{Human, default_tool, standing_pose_w},
    judge::{Judgement, judge},
    model::{
        operation::{Operation, OperationKind},
        plan::{HumanPosture, Plan},
        scenario::{Limits, Person, SimulationSettings},
        trace::Trace,
        verdict::{CheckKind, VerdictKind},
        wrench::Wrench,
    },
    robot::{ArmState, Robot},
    sim::Conditions,
};
use nalgebra::Vector3;

use crate::{
    THICKNESS_M,
    baxter::{self, BOARD_KG},
    common, simulate,
};

const FRICTION: f64 = 0.6;

const SETTINGS: SimulationSettings =
    SimulationSettings { settle_s: 0.3, ramp_s: 0.5, hold_s: 0.3, release_s: 0.0, timestep_s: 0.002 };

const LIMITS: Limits = Limits::CUT;

const PERSON: Person = Person::PAPER;

/// A board in front of the robot that is pulled away from it with this force, without a person.
fn pulled(robot: &Robot, force_n: f64) -> Plan {
    let mut plan = baxter::plan(robot, Operation::drill([0.0, 0.0], 0.0, THICKNESS_M), BOARD_KG, 30.0);
    plan.operation.kind = OperationKind::Wrench;
    plan.operation.wrench_o = Wrench::from_force(Vector3::z() * force_n);
    plan
}

/// A person who faces the robot from this distance, both arms hanging.
fn posture(robot: &Robot, x_m: f64) -> HumanPosture {
    HumanPosture::new(&PERSON, standing_pose_w(x_m, 0.0, std::f64::consts::PI, robot.floor_z_m), [0.0; 7])
}

/// Distance of the planned pose from a person who stands there, m.
fn distance_m(robot: &Robot, plan: &Plan, x_m: f64) -> f64 {
    let HumanPosture { x_wb, q_rad, .. } = posture(robot, x_m);
    let human = Human::new(&PERSON, &default_tool(OperationKind::Wrench)).unwrap();
    let board = BoardBody::new(&plan.object.shape());
    let person = PersonClearance::new(&human.capsules_w(&x_wb, &q_rad).map(PersonPart::from), &board);
    let poses = robot.planned_link_poses(&plan.arms, plan.object.size_m[2]);
    let model = CollisionModel::new(robot);
    model.nearest_to_person(&person, &poses, &plan.object.x_wo, f64::INFINITY).unwrap().distance_m
}

/// The plan with a person at this distance from robot and board.
pub fn with_person_at(robot: &Robot, plan: &Plan, wanted_m: f64) -> Plan {
    // The distance decreases monotonically: bisection.
    let (mut near_m, mut far_m) = (0.6, 2.0);
    for _ in 0..50 {
        let middle_m = (near_m + far_m) / 2.0;
        if distance_m(robot, plan, middle_m) < wanted_m { near_m = middle_m } else { far_m = middle_m }
    }
    Plan { human: Some(posture(robot, far_m)), ..plan.clone() }
}

fn simulated(robot: &Robot, plan: &Plan) -> (Trace, Judgement) {
    let trace = simulate(robot, plan, &Conditions::new(FRICTION, SETTINGS)).unwrap();
    let judgement = judge(&trace, &LIMITS);
    (trace, judgement)
}

fn overlap_mm(judgement: &Judgement) -> Option<f64> {
    judgement.checks.iter().find(|check| check.name == CheckKind::PersonOverlap).map(|check| check.value)
}

#[test]
fn deflecting_arms_touch_a_person_who_is_too_close() {
    let robot = common::baxter();
    let plan = pulled(robot, 20.0);
    let (alone, alone_judged) = simulated(robot, &plan);
    assert_eq!((alone_judged.verdict, overlap_mm(&alone_judged)), (VerdictKind::Holds, None));

    // Nothing touches in the plan, and everything but the person is as before.
    let (near, near_judged) = simulated(robot, &with_person_at(robot, &plan, 0.002));
    let touch = near.person_touch.as_ref().unwrap();
    println!("{touch:?}, {:?} mm", overlap_mm(&near_judged));
    assert!((near.samples[0].person_distance_m.unwrap() - 0.002).abs() < 1e-6);
    assert_eq!(near_judged.verdict, VerdictKind::Touches);
    assert!(near_judged.first_failure.as_ref().unwrap().load_factor < 1.0);
    assert!(near.samples.iter().zip(&alone.samples).all(|(near, alone)| near.x_wo == alone.x_wo));

    // A few centimetres are enough for deflections of millimetres.
    let (far, far_judged) = simulated(robot, &with_person_at(robot, &plan, 0.05));
    assert_eq!((far_judged.verdict, far.person_touch), (VerdictKind::Holds, None));
    let left_mm = -overlap_mm(&far_judged).unwrap();
    // The approach is the same as in the case with contact, up to the curvature of the surfaces.
    let approach_mm = [2.0 + overlap_mm(&near_judged).unwrap(), 50.0 - left_mm];
    println!("{approach_mm:?} mm nearer");
    assert!((approach_mm[0] - approach_mm[1]).abs() < 0.5, "{approach_mm:?}");
}

#[test]
fn the_distance_is_measured_in_every_step_if_small_and_every_fifth_otherwise() {
    let robot = common::baxter();
    let plan = pulled(robot, 20.0);
    let (near, _) = simulated(robot, &with_person_at(robot, &plan, 0.004));
    let moved = |trace: &Trace, step: usize| {
        trace.samples[step].person_distance_m.unwrap() != trace.samples[step - 1].person_distance_m.unwrap()
    };
    // In the middle of the ramp the distance decreases in every step.
    assert!((200..300).all(|step| moved(&near, step)));
    let (far, _) = simulated(robot, &with_person_at(robot, &plan, 0.05));
    assert!((200..300).all(|step| moved(&far, step) == (step % 5 == 0)));
}

#[test]
fn the_robots_distance_from_itself_and_the_board_is_that_of_its_links_in_the_sample() {
    let robot = common::baxter();
    let plan = pulled(robot, 20.0);
    let (trace, _) = simulated(robot, &plan);
    let (model, board) = (CollisionModel::new(robot), BoardBody::new(&plan.object.shape()));
    let arms: Vec<usize> = plan.arms.iter().map(|hold| robot.arm_index(&hold.name).unwrap()).collect();
    for sample in trace.samples.iter().step_by(5) {
        let states = arms.iter().zip(&sample.arms).map(|(&arm, state)| ArmState {
            arm,
            q_rad: &state.q_rad,
            finger_travel_m: [state.finger_m[0], state.finger_m[1]],
        });
        let link_poses = robot.link_poses(&robot.positions(&states.collect::<Vec<_>>()));
        let scene = Scene {
            link_poses: &link_poses,
            holding: &arms,
            board: &board,
            x_wo: sample.x_wo,
            person: &[],
            clearance_m: 0.0,
        };
        let nearest = model.nearest_of_robot(&scene, f64::INFINITY).unwrap();
        assert_eq!(sample.robot_clearance_m, Some(nearest.distance_m));
    }
}
