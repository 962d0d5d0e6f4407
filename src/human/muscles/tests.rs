//! The muscles against their source, anatomy, and their own derivatives.

use super::*;
use crate::{
    human::{
        ArmAngles, Human,
        testing::{HANDS, generator, leaning, random_shares, random_wrench, within, worker},
    },
    model::{
        frames::Pose,
        operation::OperationKind,
        scenario::{ComfortSettings, Hand, MuscularMetric, PostureLimits},
        wrench::Wrench,
    },
};

/// Moments of the muscles in MyoArm itself (`tools/muscle_model.py`).
const REFERENCE: &str = include_str!("../../../tests/data/muscle_arms.csv");

#[test]
fn the_moments_of_the_muscles_are_those_of_their_source() {
    let human = worker(Hand::Right, OperationKind::Drill);
    let (mut errors, mut sizes) = (Vec::new(), Vec::new());
    for line in REFERENCE.lines().filter(|line| !line.starts_with('#')).skip(1) {
        let cells: Vec<_> = line.split(',').collect();
        let number = |column: usize| cells[column].parse::<f64>().unwrap();
        let q_rad: ArmAngles = std::array::from_fn(number);
        let muscle = DATA.muscles.iter().position(|muscle| muscle.name == cells[7]).unwrap();
        let program = human.muscle_program(&q_rad, &Pose::identity(), &Wrench::default());
        let expected = Moments::from_fn(|moment, _| number(8 + moment));
        errors.push((program.of_muscles[muscle] - expected).norm());
        sizes.push(expected.norm());
    }
    assert_eq!(errors.len(), 120 * MUSCLES);
    let rms = |values: &[f64]| (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt();
    errors.sort_by(f64::total_cmp);
    let (error, size) = (rms(&errors), rms(&sizes));
    println!("moments: rms {size:.2} N m, error rms {error:.3}, median {:.3} N m", errors[errors.len() / 2]);
    // A path that wraps around a bone has corners, which polynomials round off: about 2 mm at the shoulder.
    assert!(error < 0.15 * size && errors[errors.len() / 2] < 0.1, "{error} {size}");
}

/// A posture within the arm's ranges under a random wrench.
fn random_program(human: &Human, generator: &mut rand_pcg::Pcg64) -> MuscleProgram {
    let q_rad = random_shares(human.arm(), generator);
    human.muscle_program(&q_rad, &Pose::identity(), &random_wrench(generator))
}

#[test]
fn the_optimum_keeps_the_conditions_of_karush_kuhn_and_tucker() {
    let (human, mut generator) = (within(PostureLimits::UNRESTRICTED), generator(51));
    for _ in 0..2_000 {
        let program = random_program(&human, &mut generator);
        let found = optimum(&program.of_muscles, &program.demanded_nm).unwrap();
        let exerted: Moments =
            program.of_muscles.iter().zip(found.activations).map(|(moments, activation)| moments * activation).sum();
        let size = 1.0 + program.demanded_nm.norm();
        assert!((exerted + found.reserves_nm - program.demanded_nm).norm() < 1e-10 * size);
        for (moments, activation) in program.of_muscles.iter().zip(found.activations) {
            // The derivative of the cost by an activation, 2 a - b . y: zero between the limits, outward at them.
            let slope = 2.0 * activation - moments.dot(&found.multipliers);
            match activation {
                0.0 => assert!(slope >= 0.0),
                1.0 => assert!(slope <= 0.0),
                _ => assert!(slope.abs() < 1e-12 && (0.0..=1.0).contains(&activation), "{slope} {activation}"),
            }
        }
        for moment in 0..MOMENTS {
            let r0_nm = if moment < 4 { 1.0 } else { 0.5 };
            let slope = 100.0 * found.reserves_nm[moment] / (r0_nm * r0_nm) - found.multipliers[moment];
            assert!(slope.abs() < 1e-12 * (1.0 + found.multipliers[moment].abs()));
        }
    }
}

#[test]
fn the_gradient_equals_central_differences() {
    const STEP: f64 = 1e-6;
    let wrench_t = Wrench::from([12.0, -7.0, 20.0, 0.4, -0.3, 0.8]);
    let settings = ComfortSettings { muscular: MuscularMetric::Muscles, ..ComfortSettings::default() };
    let mut compared = 0;
    for hand in HANDS {
        let (human, mut generator) = (leaning(hand, 8.0), generator(52));
        let at = |q_rad: &ArmAngles| {
            let r_bt = human.tool_pose_b(q_rad).rotation;
            let wrench_b = Wrench::new(r_bt * wrench_t.force_n, r_bt * wrench_t.moment_nm);
            human.muscle_program(q_rad, &Pose::identity(), &wrench_b).solve().unwrap()
        };
        for _ in 0..400 {
            let q_rad = random_shares(human.arm(), &mut generator);
            let (found, here) = (human.muscular_gradient(&q_rad, &wrench_t, &settings), at(&q_rad));
            assert_eq!(found.muscular, human_muscles(&here));
            for joint in 0..7 {
                let [back, forth] = [-STEP, STEP].map(|by| {
                    let mut q_rad = q_rad;
                    q_rad[joint] += by;
                    at(&q_rad)
                });
                // A muscle that starts, saturates or leaves its piece of the force curve within a step bends the slope.
                let is_near_kink = back
                    .activations
                    .iter()
                    .zip(&forth.activations)
                    .any(|(a, b)| (*a == 0.0) != (*b == 0.0) || (*a == 1.0) != (*b == 1.0));
                if is_near_kink {
                    continue;
                }
                compared += 1;
                let slope = |pick: &dyn Fn(&MuscleEffort) -> f64| (pick(&forth) - pick(&back)) / (2.0 * STEP);
                let regularised = slope(&|effort| human_muscles(effort).regularised);
                // Between pieces of a muscle's force the slope bends: a difference is off by a step times the bend, where the arm is
                // too weak up to 1e-5 of the steepest slope.
                let close = |a: f64, b: f64, row: &[f64; 7]| {
                    (a - b).abs() < 1e-5 * (1.0 + row.iter().map(|slope| slope.abs()).fold(0.0, f64::max))
                };
                assert!(
                    close(found.regularised[joint], regularised, &found.regularised),
                    "{:?} {regularised}",
                    found.regularised
                );
                for moment in 0..MOMENTS {
                    let missing = slope(&|effort| effort.missing_shares()[moment]);
                    let row = &found.activations[moment];
                    assert!(close(row[joint], missing, row), "{missing} {row:?}");
                }
            }
        }
    }
    assert!(compared > 5_000, "{compared}");
}

fn human_muscles(effort: &MuscleEffort) -> crate::human::Muscular {
    crate::human::Muscular::of_muscles(Some(effort))
}
