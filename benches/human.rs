//! The cost of one evaluation of the person; a plan needs millions.
//!
//! Targets on one core of a common machine: a full evaluation (torques, activations, 64 x 56 distances) 6 us, its muscular
//! part 0.6 us by the metrics of joint strengths and 15 us by the muscles (30 us with gradient), the line of sight 5 us, the
//! arm's inverse kinematics at one swivel 0.5 us.

use std::{hint::black_box, path::Path};

use benchdog::{
    collision::{BoardBody, CollisionModel, PersonPart, Scene},
    human::{Human, ShoulderBranch, default_tool, peripersonal_m, standing_pose_w},
    model::{
        board::BoardShape,
        frames::Pose,
        operation::OperationKind,
        scenario::{ComfortSettings, MuscularMetric, PeripersonalForm, Person, PostureLimits},
        wrench::Wrench,
    },
    robot::Robot,
};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Point3, Vector3};

const METRICS: [(&str, MuscularMetric); 3] =
    [("paper", MuscularMetric::Paper), ("intrinsic", MuscularMetric::Intrinsic), ("muscles", MuscularMetric::Muscles)];

const Q_RAD: [f64; 7] = [0.6, 0.3, 0.2, 1.2, 0.3, 0.1, 0.05];

fn human(person: &Person) -> Human {
    Human::new(person, &default_tool(OperationKind::Drill)).unwrap()
}

fn evaluation(criterion: &mut Criterion) {
    let (human, q_rad) = (human(&Person::PAPER), Q_RAD);
    let x_wb = standing_pose_w(1.1, 0.1, 3.0, -0.9);
    let wrench_w = Wrench::from_force(Vector3::new(-15.0, 0.0, 0.0));
    // As many points as a robot has, on a spiral in the region of its arms.
    let robot: Vec<_> = (0..56)
        .map(f64::from)
        .map(|i| Point3::new(0.3 + 0.2 * i.cos(), 0.4 * (0.7 * i).sin(), 0.02 * i - 0.4))
        .collect();
    for (name, muscular) in METRICS {
        let settings = ComfortSettings { muscular, ..ComfortSettings::default() };
        criterion.bench_function(&format!("muscular comfort, {name}"), |bencher| {
            bencher.iter(|| human.muscular(black_box(&q_rad), &x_wb, &wrench_w, &settings));
        });
        criterion.bench_function(&format!("muscular gradient, {name}"), |bencher| {
            bencher.iter(|| human.muscular_gradient(black_box(&q_rad), &wrench_w, &settings));
        });
        criterion.bench_function(&format!("full evaluation, {name}"), |bencher| {
            bencher.iter(|| {
                let q_rad = black_box(&q_rad);
                let muscular = human.muscular(q_rad, &x_wb, &wrench_w, &settings);
                let points = human.body_points_w(&x_wb, q_rad);
                (muscular, peripersonal_m(PeripersonalForm::Weighted, None, &points, &robot))
            });
        });
    }
}

/// A free line of sight to a drill, with Baxter's arms beside the board and the person in front of it.
fn line_of_sight(criterion: &mut Criterion) {
    let (human, robot) = (human(&Person::default()), Robot::load("baxter", Path::new("")).unwrap());
    let model = CollisionModel::new(&robot);
    let link_poses = robot.link_poses(&vec![0.0; robot.joints.len()]);
    let x_wb = standing_pose_w(1.3, 0.1, 3.0, -0.9);
    let person = human.capsules_w(&x_wb, &Q_RAD).map(PersonPart::from);
    let [eye_w, tip_w] = human.line_of_sight_w(&x_wb, &Q_RAD);
    let x_wo = Pose::translation(tip_w.x - 0.2, tip_w.y, tip_w.z - 0.2);
    let scene = Scene {
        link_poses: &link_poses,
        holding: &[],
        board: &BoardBody::new(&BoardShape::cuboid([0.03, 0.5, 0.4])),
        x_wo,
        person: &person,
        clearance_m: 0.0,
    };
    assert_eq!(model.free_share_of_sight(&scene, &eye_w, &tip_w), 1.0);
    criterion.bench_function("line of sight", |bencher| {
        bencher.iter(|| model.free_share_of_sight(black_box(&scene), &eye_w, &tip_w));
    });
}

fn inverse_kinematics(criterion: &mut Criterion) {
    let (human, q_rad) = (human(&Person::PAPER), Q_RAD);
    let (x_bt, swivel_rad) = (human.tool_pose_b(&q_rad), human.swivel_rad(&q_rad));
    let circle = human.swivel_circle(&x_bt).unwrap();
    criterion.bench_function("inverse kinematics, one swivel of a known tool pose", |bencher| {
        bencher.iter(|| circle.solution(black_box(swivel_rad), ShoulderBranch::Low));
    });
    criterion.bench_function("inverse kinematics, one swivel of a new tool pose", |bencher| {
        bencher.iter(|| human.arm_solutions(black_box(&x_bt), swivel_rad));
    });
    criterion.bench_function("intervals of the swivel", |bencher| {
        bencher.iter(|| human.swivel_circle(black_box(&x_bt)).unwrap().intervals());
    });
    let swing_twist = self::human(&Person { posture: PostureLimits::UNRESTRICTED, ..Person::default() });
    criterion.bench_function("intervals of the swivel, swing-twist", |bencher| {
        bencher.iter(|| swing_twist.swivel_circle(black_box(&x_bt)).unwrap().intervals());
    });
}

criterion_group!(benches, evaluation, line_of_sight, inverse_kinematics);
criterion_main!(benches);
