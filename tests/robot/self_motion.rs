//! The branches of the built-in Baxter's solutions, and combinations of two arms.

use std::sync::LazyLock;

use approx::assert_relative_eq;
use benchdog::{
    model::frames::Pose,
    robot::{
        Chain, InverseKinematics, Solution,
        bimanual::{Combinations, RankedSolutions},
        inverse::{Branch, ClosedForm, SelfMotion},
    },
};
use nalgebra::{Isometry3, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};

use crate::chains::{assert_solves, chains, distance_rad, mirrored, posture};

fn arms() -> &'static [ClosedForm; 2] {
    static ARMS: LazyLock<[ClosedForm; 2]> =
        LazyLock::new(|| [0, 1].map(|arm| ClosedForm::new(&chains()[arm]).unwrap()));
    &ARMS
}

fn random_posture(chain: &Chain, generator: &mut rand_pcg::Pcg64) -> Vec<f64> {
    let limits = chain.lower().iter().zip(chain.upper());
    limits.map(|(lower, upper)| generator.random_range(*lower..*upper)).collect()
}

/// True if a joint of a sample is at a limit.
fn at_a_limit(chain: &Chain, q_rad: &[f64]) -> bool {
    q_rad.iter().zip(chain.lower().iter().zip(chain.upper())).any(|(q, (lower, upper))| q == lower || q == upper)
}

#[test]
fn every_random_posture_is_on_exactly_one_branch() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(3);
    for (chain, arm) in chains().iter().zip(arms()) {
        for number in 0..150 {
            let q_rad = random_posture(chain, &mut generator);
            let motion = arm.branches(&chain.gripper_pose(&q_rad));
            // Both are solutions to 1e-9, so they differ by that over the smallest singular value.
            let holding = motion.branches().iter().filter(|branch| branch.contains(&q_rad, 1e-6)).count();
            assert_eq!(holding, 1, "posture {number}: {q_rad:?}");
        }
    }
}

#[test]
fn branches_are_solutions_from_limit_to_limit() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(4);
    let [chain, _] = chains();
    let [arm, _] = arms();
    for _ in 0..30 {
        let target = chain.gripper_pose(&random_posture(chain, &mut generator));
        for branch in arm.branches(&target).branches() {
            let samples = branch.samples();
            samples.iter().for_each(|sample| assert_solves(chain, &target, &sample.q_rad));
            let ends = [samples[0].q_rad, samples[samples.len() - 1].q_rad];
            if branch.is_closed() {
                assert!(distance_rad(&ends[0], &ends[1]) < 1e-6);
            } else {
                assert!(ends.iter().all(|q_rad| at_a_limit(chain, q_rad)), "{ends:?}");
            }
            for [from, to] in samples.array_windows() {
                // The tracer's longest step plus the interpolation.
                assert!((from.arc_rad..from.arc_rad + 0.3).contains(&to.arc_rad), "{} {}", from.arc_rad, to.arc_rad);
            }
        }
    }
}

#[test]
fn slices_are_on_the_branches() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(5);
    let [chain, _] = chains();
    let [arm, _] = arms();
    for _ in 0..20 {
        let q_rad = random_posture(chain, &mut generator);
        let target = chain.gripper_pose(&q_rad);
        let motion = arm.branches(&target);
        for found in arm.slice(&target, q_rad[5] + 0.01) {
            assert!(motion.branches().iter().any(|branch| branch.contains(&found, 1e-6)), "{found:?}");
        }
    }
}

#[test]
fn targets_without_branches_are_outcomes() {
    let [chain, _] = chains();
    let [arm, _] = arms();
    assert!(matches!(arm.branches(&Isometry3::translation(5.0, 0.0, 0.0)), SelfMotion::OutOfReach { .. }));
    let inside: Pose = Isometry3::from_parts(chain.shoulder_w().into(), nalgebra::UnitQuaternion::identity());
    assert!(matches!(arm.branches(&inside), SelfMotion::NotFound));
    assert!(matches!(arm.branches(&Isometry3::translation(f64::NAN, 0.0, 0.0)), SelfMotion::Malformed));
    // Stretched and singular: any solution found must be exact.
    let stretched = chain.gripper_pose(&[0.3, -0.2, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for branch in arm.branches(&stretched).branches() {
        branch.samples().iter().for_each(|sample| assert_solves(chain, &stretched, &sample.q_rad));
    }
}

#[test]
fn the_arms_are_mirror_images() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(6);
    let [left, right] = chains();
    for _ in 0..10 {
        let q_rad = random_posture(left, &mut generator);
        let targets = [left.gripper_pose(&q_rad), right.gripper_pose(&mirrored(&q_rad))];
        // The URDF's mount has a dozen digits.
        let [a, b] = targets.map(|target| target.translation.vector);
        assert!((a - Vector3::new(b.x, -b.y, b.z)).norm() < 1e-6, "{a} {b}");
        let motions = [arms()[0].branches(&targets[0]), arms()[1].branches(&targets[1])];
        let lengths = motions.each_ref().map(|motion| motion.branches().iter().map(Branch::length_rad).sum::<f64>());
        // Lengths are sums of chords, and the chords differ.
        assert_relative_eq!(lengths[0], lengths[1], max_relative = 0.02);
    }
}

#[test]
fn combinations_come_in_the_order_of_their_cost() {
    let costs = [vec![3.0, 1.0, 2.5, f64::NAN], vec![0.5, 4.0, 0.25], vec![2.0, 1.0]];
    let ranked = costs.each_ref().map(|costs| RankedSolutions::new(costs.iter().map(|&cost| vec![cost]), |q| q[0]));
    for count in 1..=3 {
        let arms = &ranked[..count];
        let found: Vec<_> = Combinations::new(arms).collect();
        // Every combination once, by brute force.
        let mut sums = vec![0.0];
        for costs in &costs[..count] {
            let finite = costs.iter().filter(|cost| cost.is_finite());
            sums = finite.flat_map(|cost| sums.iter().map(move |sum| sum + cost)).collect();
        }
        sums.sort_by(f64::total_cmp);
        assert_eq!(found.iter().map(|combination| combination.cost).collect::<Vec<_>>(), sums);
        let mut distinct: Vec<_> = found.iter().map(|combination| format!("{:?}", combination.q_rad)).collect();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), sums.len());
    }
    let none = [ranked[0].clone(), RankedSolutions::new([], |_| 0.0)];
    assert_eq!(Combinations::new(&none).count(), 0);
    assert_eq!(Combinations::new(&[]).count(), 0);
}

#[test]
fn both_arms_grasp_one_board() {
    let x_wo = Isometry3::translation(0.6, 0.0, 0.2);
    let turn = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    // From either side, fingers along the board's y.
    let grasps = [0.25, -0.25].map(|y_m| {
        let flip = if y_m > 0.0 { turn } else { turn.inverse() };
        Isometry3::from_parts(Vector3::new(0.0, y_m, 0.0).into(), flip)
    });
    let middle: Vec<f64> = chains()[0].lower().iter().zip(chains()[0].upper()).map(|(a, b)| 0.5 * (a + b)).collect();
    let cost = |q_rad: &[f64]| q_rad.iter().zip(&middle).map(|(q, m)| (q - m).powi(2)).sum();
    let ranked = [0, 1].map(|arm| {
        let inverse = InverseKinematics::for_chain(&chains()[arm]);
        RankedSolutions::of_arm(&inverse, &(x_wo * grasps[arm]), 0, cost)
    });
    assert!(ranked.iter().all(|arm| !arm.is_empty()));
    let mut last = 0.0;
    for combination in Combinations::new(&ranked).filter(|pair| pair.q_rad[0][1] < pair.q_rad[1][1]).take(50) {
        assert!(combination.cost >= last);
        last = combination.cost;
        for ((chain, x_og), q_rad) in chains().iter().zip(&grasps).zip(&combination.q_rad) {
            assert_solves(chain, &(x_wo * x_og), q_rad);
        }
    }
    assert!(last > 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_jacobian_is_the_derivative_of_the_pose(q_rad in posture(), rate in prop::collection::vec(-1.0..1.0, 7)) {
        for chain in chains() {
            let moved = |step: f64| {
                let q_rad: Vec<f64> = q_rad.iter().zip(&rate).map(|(q, rate)| q + step * rate).collect();
                chain.gripper_pose(&q_rad)
            };
            let step = 1e-5;
            let [after, before] = [moved(step), moved(-step)];
            let linear = (after.translation.vector - before.translation.vector) / (2.0 * step);
            let angular = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * step);
            let twist = chain.jacobian_w(&q_rad) * nalgebra::DVector::from_column_slice(&rate);
            // Truncation step^2 |x'''| and rounding 1e-16 / step are both below 1e-8.
            prop_assert!((twist.fixed_rows::<3>(0) - linear).norm() < 1e-8);
            prop_assert!((twist.fixed_rows::<3>(3) - angular).norm() < 1e-8);
        }
    }

    #[test]
    fn a_found_solution_is_exact(q_rad in posture(), seed in posture()) {
        for chain in chains() {
            let target = chain.gripper_pose(&q_rad);
            if let Solution::Found(found) = InverseKinematics::for_chain(chain).local(&target, &seed) {
                assert_solves(chain, &target, &found);
            }
        }
    }
}
