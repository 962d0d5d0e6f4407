use std::path::Path;

use nalgebra::{Translation3, UnitQuaternion, Vector3};

use super::*;
use crate::{human::BodyPart, model::plan::Plan, scenario::read_plan};

fn plan() -> (Plan, Robot) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/plans/cut-rim.json");
    read_plan(&path, None).unwrap()
}

fn tasks(plan: &Plan, robot: &Robot, seed_rad: impl Fn(&[f64]) -> Option<Vec<f64>>) -> Vec<ArmTask> {
    let task = |hold: &crate::model::plan::ArmHold| ArmTask {
        arm: robot.arm_index(&hold.name).unwrap(),
        target: Target::Gripper { x_wg: plan.object.x_wo * hold.x_og, seed_rad: seed_rad(&hold.q_rad) },
    };
    plan.arms.iter().map(task).collect()
}

fn found(completion: Completion) -> (Vec<Vec<f64>>, Option<Violation>) {
    match completion {
        Completion::Found(Reached { q_rad, contact }) => (q_rad, contact),
        other => panic!("{other:?}"),
    }
}

/// Seeds that are answers are the nearest answers.
#[test]
fn the_angles_of_a_plan_are_found_again_from_themselves() {
    let (plan, robot) = plan();
    let completer = Completer::new(&robot, &plan.object.shape());
    let tasks = tasks(&plan, &robot, |q_rad| Some(q_rad.to_vec()));
    let (q_rad, contact) = found(completer.complete(&tasks, &plan.object.x_wo, &[], 0.0, Effort::THOROUGH));
    assert_eq!(contact, None);
    for (hold, q_rad) in plan.arms.iter().zip(q_rad) {
        // The plan's residual is that of the inverse kinematics, 1e-9.
        assert!(hold.q_rad.iter().zip(&q_rad).all(|(a, b)| (a - b).abs() < 1e-8), "{q_rad:?}");
    }
}

/// From the middle of the ranges, and from seeds far away: the poses are reached, within the limits, and nothing meets.
#[test]
fn the_grippers_are_where_they_are_asked_to_be() {
    let (plan, robot) = plan();
    let completer = Completer::new(&robot, &plan.object.shape());
    for offset_rad in [None, Some(0.4), Some(-0.9)] {
        let seeded = |q_rad: &[f64]| offset_rad.map(|offset_rad| q_rad.iter().map(|q| q + offset_rad).collect());
        let tasks = tasks(&plan, &robot, seeded);
        let (q_rad, contact) = found(completer.complete(&tasks, &plan.object.x_wo, &[], 0.0, Effort::THOROUGH));
        assert_eq!(contact, None);
        for ((task, hold), q_rad) in tasks.iter().zip(&plan.arms).zip(q_rad) {
            let chain = &completer.chains()[task.arm];
            let off = chain.gripper_pose(&q_rad).inverse() * (plan.object.x_wo * hold.x_og);
            assert!(off.translation.vector.norm() < 2e-9 && off.rotation.angle() < 2e-9);
            assert!(chain.within_limits(&q_rad, 0.0));
        }
    }
}

/// A ball is where the nearest answer has its elbow. The angles that are found are free, and no other free answer is nearer.
#[test]
fn an_answer_with_a_contact_is_passed_over() {
    let (plan, robot) = plan();
    let completer = Completer::new(&robot, &plan.object.shape());
    let tasks = &tasks(&plan, &robot, |_| None)[..1];
    let Target::Gripper { x_wg, .. } = &tasks[0].target else { panic!("a pose") };
    let (chain, x_wo) = (&completer.chains[tasks[0].arm], plan.object.x_wo);
    let complete = |ball: &[PersonPart]| found(completer.complete(tasks, &x_wo, ball, 0.0, Effort::THOROUGH));
    let (nearest, contact) = complete(&[]);
    assert_eq!(contact, None);
    let elbow_w = chain.joint_frames(&nearest[0])[3].translation.vector.into();
    let ball = [PersonPart {
        name: BodyPart::Head,
        p0_w: elbow_w,
        p1_w: elbow_w,
        radius_m: 0.1,
        robot_clearance_m: 0.0,
        board_clearance_m: None,
    }];
    let is_free = |q_rad: &[f64]| completer.contact(tasks, &[q_rad], &x_wo, &ball, 0.0).is_none();
    assert!(!is_free(&nearest[0]));
    let (other, contact) = complete(&ball);
    assert!(contact.is_none() && is_free(&other[0]));
    let middle_rad = middle_rad(chain);
    let squared = |q_rad: &[f64]| q_rad.iter().zip(&middle_rad).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let samples = completer.solvers[tasks[0].arm].samples(x_wg, Effort::THOROUGH.samples);
    assert!(samples.iter().filter(|q_rad| is_free(q_rad)).all(|q_rad| squared(q_rad) >= squared(&other[0])));
    // Around a ball that fills the room there is no way: the nearest answer, and what it meets.
    let (blocked, contact) = complete(&[PersonPart { radius_m: 2.0, ..ball[0] }]);
    assert_eq!(blocked, nearest);
    assert!(contact.is_some_and(|contact| contact.is_of_person()));
}

#[test]
fn given_angles_stay_and_the_other_arm_avoids_them() {
    let (plan, robot) = plan();
    let completer = Completer::new(&robot, &plan.object.shape());
    let mut tasks = tasks(&plan, &robot, |_| None);
    tasks[0].target = Target::Angles(plan.arms[0].q_rad.clone());
    let (q_rad, contact) = found(completer.complete(&tasks, &plan.object.x_wo, &[], 0.0, Effort::THOROUGH));
    assert_eq!((contact, &q_rad[0]), (None, &plan.arms[0].q_rad));
}

#[test]
fn poses_that_no_arm_reaches() {
    let (plan, robot) = plan();
    let completer = Completer::new(&robot, &plan.object.shape());
    let complete = |x_wg: Pose| {
        let task = ArmTask { arm: 0, target: Target::Gripper { x_wg, seed_rad: None } };
        completer.complete(&[task], &plan.object.x_wo, &[], 0.0, Effort::QUICK)
    };
    let far = Pose::from_parts(Translation3::new(5.0, 0.0, 0.0), UnitQuaternion::identity());
    assert!(matches!(complete(far), Completion::OutOfReach { task: 0, distance_m, reach_m } if distance_m > reach_m));
    // At the shoulder, and at the end of the reach.
    let shoulder_w = completer.chains()[0].shoulder_w();
    let within = Pose::from_parts(Translation3::from(shoulder_w), UnitQuaternion::identity());
    assert!(matches!(complete(within), Completion::NotFound { task: 0 }));
    let stretched_m = completer.chains()[0].reach_m() - 1e-3;
    let p_w = shoulder_w - Vector3::x() * stretched_m;
    let behind = Pose::from_parts(Translation3::from(p_w), UnitQuaternion::identity());
    assert!(matches!(complete(behind), Completion::NotFound { task: 0 }));
}
