//! A person who stands too near to arms and board that give way, and one who does not.

use benchdog::{
    collision::{CollisionModel, PersonClearance, PersonPart},
    human::{Human, default_tool, standing_pose_w},
    judge::{Judgement, judge},
    model::{
        operation::{Operation, OperationKind},
        plan::{HumanPosture, Plan},
        scenario::{Hand, Limits, Person, Sex, SimulationSettings},
        trace::Trace,
        verdict::{CheckKind, VerdictKind},
        wrench::Wrench,
    },
    robot::Robot,
    sim::{Conditions, simulate},
};
use nalgebra::Vector3;

use crate::{
    THICKNESS_M,
    baxter::{self, BOARD_KG},
};

const FRICTION: f64 = 0.6;

const SETTINGS: SimulationSettings =
    SimulationSettings { settle_s: 0.3, ramp_s: 0.5, hold_s: 0.3, release_s: 0.0, timestep_s: 0.002 };

const LIMITS: Limits =
    Limits { slip_mm: 1.0, slip_deg: 2.0, deflection_mm: 15.0, creep_mm_s: 0.1, torque_ratio: 1.0, load_factor: 1.0 };

const PERSON: Person =
    Person { height_m: 1.75, mass_kg: 75.0, sex: Sex::Male, hand: Hand::Right, percentile: 50.0, lean_deg: 0.0 };

/// A board before the robot that is pulled towards the person with this force, and nobody there yet.
fn pulled(robot: &Robot, force_n: f64) -> Plan {
    let mut plan = baxter::plan(robot, Operation::drill([0.0, 0.0], 0.0, THICKNESS_M), BOARD_KG, 30.0);
    plan.operation.kind = OperationKind::Wrench;
    plan.operation.wrench_o = Wrench::from_force(Vector3::z() * force_n);
    plan
}

/// Someone who looks at the robot from this far before it, both arms hanging.
fn posture(robot: &Robot, x_m: f64) -> HumanPosture {
    HumanPosture::new(&PERSON, standing_pose_w(x_m, 0.0, std::f64::consts::PI, robot.floor_z_m), [0.0; 7])
}

/// Distance of the planned pose from someone who stands there, m, and which bodies are nearest.
fn distance_m(robot: &Robot, plan: &Plan, x_m: f64) -> f64 {
    let HumanPosture { x_wb, q_rad, .. } = posture(robot, x_m);
    let human = Human::new(&PERSON, &default_tool(OperationKind::Wrench)).unwrap();
    let person = PersonClearance::new(&human.capsules_w(&x_wb, &q_rad).map(PersonPart::from), plan.object.size_m);
    let poses = robot.planned_link_poses(&plan.arms, plan.object.size_m[2]);
    let model = CollisionModel::new(robot);
    model.nearest_to_person(&person, &poses, &plan.object.x_wo, f64::INFINITY).unwrap().distance_m
}

/// The plan with someone at this distance from it.
fn with_someone_at(robot: &Robot, plan: &Plan, wanted_m: f64) -> Plan {
    // They come nearer as they come nearer: bisection.
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
fn arms_that_give_way_touch_who_stands_too_near() {
    let robot = baxter::robot();
    let plan = pulled(&robot, 20.0);
    let (alone, alone_judged) = simulated(&robot, &plan);
    assert_eq!((alone_judged.verdict, overlap_mm(&alone_judged)), (VerdictKind::Holds, None));

    // Nothing touches in the plan, and everything is as before but for the person.
    let (near, near_judged) = simulated(&robot, &with_someone_at(&robot, &plan, 0.002));
    let touch = near.person_touch.as_ref().unwrap();
    println!("{touch:?}, {:?} mm", overlap_mm(&near_judged));
    assert!((near.samples[0].person_distance_m.unwrap() - 0.002).abs() < 1e-6);
    assert_eq!(near_judged.verdict, VerdictKind::Touches);
    assert!(near_judged.first_failure.as_ref().unwrap().load_factor < 1.0);
    assert!(near.samples.iter().zip(&alone.samples).all(|(near, alone)| near.x_wo == alone.x_wo));

    // A few centimetres are enough for what gives way by millimetres.
    let (far, far_judged) = simulated(&robot, &with_someone_at(&robot, &plan, 0.05));
    assert_eq!((far_judged.verdict, far.person_touch), (VerdictKind::Holds, None));
    let left_mm = -overlap_mm(&far_judged).unwrap();
    // They come nearer by as much as to the one who is touched, up to how their surfaces curve.
    let approach_mm = [2.0 + overlap_mm(&near_judged).unwrap(), 50.0 - left_mm];
    println!("{approach_mm:?} mm nearer");
    assert!((approach_mm[0] - approach_mm[1]).abs() < 0.5, "{approach_mm:?}");
}

#[test]
fn the_distance_is_exact_where_it_is_near_and_held_where_it_is_far() {
    let robot = baxter::robot();
    let plan = pulled(&robot, 20.0);
    let (near, _) = simulated(&robot, &with_someone_at(&robot, &plan, 0.004));
    let moved = |trace: &Trace, step: usize| {
        trace.samples[step].person_distance_m.unwrap() != trace.samples[step - 1].person_distance_m.unwrap()
    };
    // In the middle of the ramp every step brings them nearer.
    assert!((200..300).all(|step| moved(&near, step)));
    let (far, _) = simulated(&robot, &with_someone_at(&robot, &plan, 0.05));
    assert!((200..300).all(|step| moved(&far, step) == (step % 5 == 0)));
}
