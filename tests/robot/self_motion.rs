//! The branches of the built-in Baxter's solutions, combinations of two arms, and figures of a posture.

use std::sync::LazyLock;

use approx::assert_relative_eq;
use benchdog::{
    model::{frames::Pose, wrench::Wrench},
    robot::{
        Chain, InverseKinematics, Robot, Solution,
        bimanual::{Combinations, RankedSolutions},
        inverse::{Branch, ClosedForm, RESIDUAL_TOLERANCE, SelfMotion},
    },
};
use nalgebra::{Isometry3, Matrix6xX, Vector3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};

use crate::chains::{assert_solves, chains, distance_rad, mirrored, posture, residual};

fn arms() -> &'static [ClosedForm; 2] {
    static ARMS: LazyLock<[ClosedForm; 2]> =
        LazyLock::new(|| [0, 1].map(|arm| ClosedForm::new(&chains()[arm]).unwrap()));
    &ARMS
}

fn random_posture(chain: &Chain, generator: &mut rand_pcg::Pcg64) -> Vec<f64> {
    let limits = chain.lower().iter().zip(chain.upper());
    limits.map(|(lower, upper)| generator.random_range(*lower..*upper)).collect()
}

/// True when a sample is at a limit of some joint.
fn at_a_limit(chain: &Chain, q_rad: &[f64]) -> bool {
    q_rad.iter().zip(chain.lower().iter().zip(chain.upper())).any(|(q, (lower, upper))| q == lower || q == upper)
}

#[test]
fn every_random_posture_is_on_one_branch() {
    let mut generator = rand_pcg::Pcg64::seed_from_u64(3);
    for (chain, arm) in chains().iter().zip(arms()) {
        for number in 0..150 {
            let q_rad = random_posture(chain, &mut generator);
            let motion = arm.branches(&chain.gripper_pose(&q_rad));
            // Both are solutions to 1e-9; the way between them is that over the smallest singular value.
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
                // The tracer's longest step with what the interpolation adds.
                assert!((from.arc_rad..from.arc_rad + 0.3).contains(&to.arc_rad), "{} {}", from.arc_rad, to.arc_rad);
            }
        }
    }
}

fn assert_intervals(chain: &Chain, target: &Pose, branch: &Branch) {
    let intervals = branch.intervals();
    assert_eq!(intervals[0].arc_rad[0], 0.0);
    assert_eq!(intervals[intervals.len() - 1].arc_rad[1], branch.length_rad());
    for interval in &intervals {
        let [from, to] = interval.redundancy_rad;
        let w1_rad = 0.5 * (from + to);
        let found = branch.at_redundancy(w1_rad);
        found.iter().for_each(|q_rad| {
            assert_solves(chain, target, q_rad);
            assert!((q_rad[5] - w1_rad).abs() < 1e-9);
        });
        let covering = intervals.iter().filter(|other| {
            let [a, b] = other.redundancy_rad;
            (a.min(b)..a.max(b)).contains(&w1_rad)
        });
        assert_eq!(found.len(), covering.count(), "{w1_rad} {intervals:?}");
    }
}

#[test]
fn an_interval_has_one_solution_for_each_value_of_the_redundancy() {
    let [chain, _] = chains();
    let [arm, _] = arms();
    let target = chain.gripper_pose(&[0.2, -0.4, 0.6, 1.3, -0.8, 0.9, 0.5]);
    let motion = arm.branches(&target);
    assert!(!motion.branches().is_empty());
    motion.branches().iter().filter(|branch| branch.length_rad() > 0.5).for_each(|branch| {
        assert_intervals(chain, &target, branch);
    });
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
fn places_on_a_branch_are_solutions_and_are_found_again() {
    let [chain, _] = chains();
    let [arm, _] = arms();
    let target = chain.gripper_pose(&[0.2, -0.4, 0.6, 1.3, -0.8, 0.9, 0.5]);
    let motion = arm.branches(&target);
    let branch = &motion.branches()[0];
    for share in [0.0, 0.1, 0.37, 0.5, 0.83, 1.0] {
        let arc_rad = share * branch.length_rad();
        let q_rad = branch.at(arc_rad).unwrap();
        assert_solves(chain, &target, &q_rad);
        let (found_rad, nearest) = branch.nearest(&q_rad).unwrap();
        assert!(distance_rad(&nearest, &q_rad) < 1e-7);
        // Places are told along chords, from which the branch strays by a few per cent of a step of 0.25 rad.
        assert!((found_rad - arc_rad).abs() < 0.02, "{found_rad} {arc_rad}");
    }
    assert_eq!(branch.at(-0.1), None);
    assert_eq!(branch.at(f64::NAN), None);
    assert_eq!(branch.nearest(&[f64::NAN; 7]), None);
    assert_eq!(branch.nearest(&[0.0; 3]), None);
}

#[test]
fn targets_without_branches_are_outcomes() {
    let [chain, _] = chains();
    let [arm, _] = arms();
    assert!(matches!(arm.branches(&Isometry3::translation(5.0, 0.0, 0.0)), SelfMotion::OutOfReach { .. }));
    let inside: Pose = Isometry3::from_parts(chain.shoulder_w().into(), nalgebra::UnitQuaternion::identity());
    assert!(matches!(arm.branches(&inside), SelfMotion::NotFound));
    assert!(matches!(arm.branches(&Isometry3::translation(f64::NAN, 0.0, 0.0)), SelfMotion::Malformed));
    // Stretched and turned in: singular, whatever is found must be true.
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
        // The URDF's mount is written with a dozen digits.
        let [a, b] = targets.map(|target| target.translation.vector);
        assert!((a - Vector3::new(b.x, -b.y, b.z)).norm() < 1e-6, "{a} {b}");
        let motions = [arms()[0].branches(&targets[0]), arms()[1].branches(&targets[1])];
        let lengths = motions.each_ref().map(|motion| motion.branches().iter().map(Branch::length_rad).sum::<f64>());
        // Lengths are those of chords, and the chords differ.
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
fn both_arms_hold_one_board() {
    let x_wo = Isometry3::translation(0.6, 0.0, 0.2);
    let turn = nalgebra::UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    // From either side, fingers along the board's y.
    let grasps = [0.25, -0.25].map(|y_m| {
        let flip = if y_m > 0.0 { turn } else { turn.inverse() };
        Isometry3::from_parts(Vector3::new(0.0, y_m, 0.0).into(), flip)
    });
    let middle: Vec<f64> = chains()[0].lower().iter().zip(chains()[0].upper()).map(|(a, b)| 0.5 * (a + b)).collect();
    let cost = |q_rad: &[f64]| q_rad.iter().zip(&middle).map(|(q, m)| (q - m).powi(2)).sum();
    let ranked = [0, 1].map(|arm| RankedSolutions::of_grasp(&arms()[arm], &x_wo, &grasps[arm], cost));
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

#[test]
fn manipulability_is_the_product_of_the_singular_values() {
    let [chain, _] = chains();
    let bent = chain.manipulability(&[0.2, -0.4, 0.6, 1.3, -0.8, 0.9, 0.5]);
    assert!(bent > 0.01, "{bent}");
    let six: f64 = {
        let jacobian: Matrix6xX<f64> = chain.jacobian_w(&[0.2, -0.4, 0.6, 1.3, -0.8, 0.9, 0.5]);
        jacobian.singular_values().iter().product()
    };
    // Both are products of the same singular values.
    assert_relative_eq!(bent, six, max_relative = 1e-9);
}

#[test]
fn distances_to_limits_are_shares() {
    let [chain, _] = chains();
    let middle: Vec<f64> = chain.lower().iter().zip(chain.upper()).map(|(a, b)| 0.5 * (a + b)).collect();
    chain.limit_distances(&middle).iter().for_each(|share| assert_relative_eq!(*share, 1.0, epsilon = 1e-12));
    chain.limit_distances(chain.lower()).iter().for_each(|share| assert_eq!(*share, 0.0));
    let beyond: Vec<f64> = chain.upper().iter().map(|upper| upper + 0.1).collect();
    chain.limit_distances(&beyond).iter().for_each(|share| assert!(*share < 0.0));
}

#[test]
fn a_weight_in_the_gripper_loads_the_motors_like_a_heavier_arm() {
    let [chain, _] = chains();
    let q_rad = [0.2, -0.4, 0.6, 1.3, -0.8, 0.9, 0.5];
    // A mass at G pushes the gripper down: the gripper pushes up. Its potential energy is m g z_G(q).
    let force_n = 10.0;
    let loaded = chain.holding_torque_nm(&q_rad, &Wrench::from_force(Vector3::new(0.0, 0.0, force_n)));
    let gravity = chain.gravity_torque_nm(&q_rad);
    for joint in 0..7 {
        let z_at = |step: f64| {
            let mut q_rad = q_rad;
            q_rad[joint] += step;
            chain.gripper_pose(&q_rad).translation.vector.z
        };
        let slope = (z_at(1e-6) - z_at(-1e-6)) / 2e-6;
        // Rounding of a metre over 2e-6 is 1e-10, times the force.
        assert_relative_eq!(loaded[joint] - gravity[joint], force_n * slope, epsilon = 1e-7);
    }
    let idle = chain.effort_distances(&q_rad, &Wrench::default());
    for (joint, share) in idle.iter().enumerate() {
        assert_relative_eq!(*share, 1.0 - gravity[joint].abs() / chain.effort_nm()[joint], epsilon = 1e-12);
    }
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
    fn what_a_search_finds_is_a_solution(q_rad in posture(), seed in posture()) {
        for chain in chains() {
            let target = chain.gripper_pose(&q_rad);
            if let Solution::Found(found) = InverseKinematics::for_chain(chain).local(&target, &seed) {
                assert_solves(chain, &target, &found);
            }
        }
    }
}
