//! The cost of one evaluation of the person; a plan needs millions.
//!
//! Targets on one core of a common machine: a full evaluation (torques, activations, 64 x 56 distances) 6 us, its muscular
//! part 0.5 us, the arm's inverse kinematics at one swivel 0.5 us.

use std::hint::black_box;

use benchdog::{
    human::{Human, ShoulderBranch, default_tool, peripersonal_m, standing_pose_w},
    model::{
        operation::OperationKind,
        scenario::{PeripersonalForm, Person, StrengthDirection},
        wrench::Wrench,
    },
};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Point3, Vector3};

const AVERAGE_MAN: Person = Person::PAPER;

fn evaluation(criterion: &mut Criterion) {
    let human = Human::new(&AVERAGE_MAN, &default_tool(OperationKind::Drill)).unwrap();
    let q_rad = [0.6, 0.3, 0.2, 1.2, 0.3, 0.1, 0.05];
    let x_wb = standing_pose_w(1.1, 0.1, 3.0, -0.9);
    let wrench_w = Wrench::from_force(Vector3::new(-15.0, 0.0, 0.0));
    // As many points as a robot has, on a spiral in the region of its arms.
    let robot: Vec<_> = (0..56)
        .map(f64::from)
        .map(|i| Point3::new(0.3 + 0.2 * i.cos(), 0.4 * (0.7 * i).sin(), 0.02 * i - 0.4))
        .collect();
    criterion.bench_function("muscular comfort", |bencher| {
        bencher.iter(|| human.muscular(black_box(&q_rad), &x_wb, &wrench_w, StrengthDirection::Paper));
    });
    criterion.bench_function("muscular gradient", |bencher| {
        bencher.iter(|| human.muscular_gradient(black_box(&q_rad), &wrench_w, StrengthDirection::Paper));
    });
    criterion.bench_function("full evaluation", |bencher| {
        bencher.iter(|| {
            let q_rad = black_box(&q_rad);
            let muscular = human.muscular(q_rad, &x_wb, &wrench_w, StrengthDirection::Paper);
            let points = human.body_points_w(&x_wb, q_rad);
            (muscular, peripersonal_m(PeripersonalForm::Weighted, None, &points, &robot))
        });
    });
}

fn inverse_kinematics(criterion: &mut Criterion) {
    let human = Human::new(&AVERAGE_MAN, &default_tool(OperationKind::Drill)).unwrap();
    let q_rad = [0.6, 0.3, 0.2, 1.2, 0.3, 0.1, 0.05];
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
}

criterion_group!(benches, evaluation, inverse_kinematics);
criterion_main!(benches);
