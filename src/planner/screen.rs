//! Screening: candidates from the grasp library and the posture map.
//!
//! A grasp brings the tool to some height and tilt against the vertical; the postures of that cell of the map are ranked with
//! it as if they fitted exactly, first by the coarse and then by the medium point sets. The best pairs are aligned by the
//! person's inverse kinematics and evaluated.

use std::f64::consts::PI;

use arrayvec::ArrayVec;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};

use super::{
    candidate::{Candidate, WorkPose},
    evaluate::{self, Configuration, Evaluator, Feasible},
    library::{BoardGrasp, COARSE_POINTS, LibraryEntry, MEDIUM_POINTS, Posture, PostureMap, pattern},
    outcome::Rejection,
    params::{SearchBudget, per_pattern, screening::SECOND_RANKING},
    problem::Problem,
};
use crate::{
    human::{ArmAngles, Standing, peripersonal_m},
    model::frames::Pose,
};

/// A grasp and a posture that nearly responds to it.
#[derive(Clone, Copy)]
struct Pair<'a> {
    entry: &'a LibraryEntry,
    posture: &'a Posture,
    /// Estimated objective.
    estimate: f64,
}

/// The best pairs of the entries and the postures that satisfy every constraint, the best first.
pub fn screen<'e>(
    evaluator: &mut Evaluator<'_>,
    entries: impl Iterator<Item = &'e LibraryEntry>,
    postures: &PostureMap,
    budget: &SearchBudget,
) -> Vec<Feasible> {
    let Evaluator { problem, stats, .. } = evaluator;
    let place_is_given = problem.human.place_is_given();
    let mut pairs = Vec::new();
    for entry in entries {
        if stats.is_exhausted() {
            break;
        }
        stats.count();
        if postures.is_empty() {
            stats.reject(if postures.has_natural() { Rejection::Strength } else { Rejection::NaturalPosture });
            continue;
        }
        let x_wt = entry.grasp.x_wo * problem.scenario.operation.x_ot;
        // Near the limits of a natural posture another one of the cell hardly ever fits.
        let matching = match &entry.posture {
            Some(own) => std::slice::from_ref(own),
            None => postures.postures(&x_wt, problem.robot.robot.floor_z_m),
        };
        let before = pairs.len();
        pairs.extend(matching.iter().filter_map(|posture| {
            let x_wb = Alignment::new(problem, &entry.grasp, &posture.x_bt).x_wb;
            let (robot_w, body_b) = (&entry.coarse_points_w, &posture.medium_points_b[..COARSE_POINTS]);
            let pair = || Pair { entry, posture, estimate: estimate(problem, &x_wb, posture, robot_w, body_b) };
            (!place_is_given || problem.human.may_stand(&Standing::of(&x_wb))).then(pair)
        }));
        if pairs.len() == before {
            stats.reject(if matching.is_empty() { Rejection::PersonReach } else { Rejection::PersonPlace });
        }
    }
    keep_best(&mut pairs, SECOND_RANKING * budget.evaluated_pairs);
    for Pair { entry, posture, estimate: estimated } in &mut pairs {
        if problem.stop.is_stopped() {
            break;
        }
        let x_wb = Alignment::new(problem, &entry.grasp, &posture.x_bt).x_wb;
        *estimated = estimate(problem, &x_wb, posture, &entry.robot_points_w, &posture.medium_points_b);
    }
    keep_best(&mut pairs, budget.evaluated_pairs);
    evaluate_pairs(evaluator, budget, &pairs)
}

/// Keeps the pairs with the highest estimates, the best first.
fn keep_best(pairs: &mut Vec<Pair<'_>>, count: usize) {
    // A stable sort keeps equal pairs in the order of the maps.
    pairs.sort_by(|a, b| b.estimate.total_cmp(&a.estimate));
    pairs.truncate(count);
}

/// Aligns the pairs and returns the best that satisfy every constraint: at most one per library entry and a few per grasp
/// pattern, the best first.
fn evaluate_pairs(evaluator: &mut Evaluator<'_>, budget: &SearchBudget, pairs: &[Pair<'_>]) -> Vec<Feasible> {
    let mut aligned = Vec::with_capacity(budget.evaluated_pairs);
    for Pair { entry, posture, .. } in pairs {
        if evaluator.stats.is_exhausted() {
            break;
        }
        let problem = &evaluator.problem;
        match align(problem, &entry.grasp, &posture.q_h_rad, &posture.x_bt) {
            Some(candidate) => {
                let configuration = Configuration::new(problem, &candidate);
                let objective = evaluate::comfort(problem, &candidate, &configuration).objective;
                aligned.push((objective, *entry, candidate));
            }
            None => {
                evaluator.stats.count();
                evaluator.stats.reject(Rejection::PersonReach);
            }
        }
    }
    aligned.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<Feasible> = Vec::new();
    let mut used: Vec<&LibraryEntry> = Vec::new();
    let most_alike = per_pattern(budget.starts_per_pattern, evaluator.problem.robot.arms.len());
    for (_, entry, candidate) in aligned {
        if kept.len() == budget.starts || evaluator.stats.is_exhausted() {
            break;
        }
        let own = pattern(&entry.grasp.arms);
        let alike = used.iter().filter(|other| pattern(&other.grasp.arms) == own).count();
        if alike == most_alike || used.iter().any(|other| std::ptr::eq(*other, entry)) {
            continue;
        }
        evaluator.stats.count();
        match evaluator.evaluate(candidate) {
            Ok(found) => {
                kept.push(found);
                used.push(entry);
            }
            Err(rejected) => evaluator.stats.reject(rejected.why),
        }
    }
    kept
}

/// The objective of a grasp and a posture if they fitted exactly with the body at `x_wb`, by the given points of the robot (W) and
/// the body (B).
fn estimate(
    problem: &Problem<'_>,
    x_wb: &Pose,
    posture: &Posture,
    robot_w: &[Point3<f64>],
    body_b: &[Point3<f64>],
) -> f64 {
    let settings = &problem.objective;
    let body_w: ArrayVec<_, MEDIUM_POINTS> = body_b.iter().map(|p_b| x_wb * p_b).collect();
    let distance_m = peripersonal_m(settings.peripersonal, settings.saturation_m, &body_w, robot_w);
    settings.weight_muscular * posture.muscular + settings.weight_peripersonal * distance_m
}

/// How a posture that has its tool at `x_bt` responds to a grasp.
struct Alignment {
    roll_rad: f64,
    x_wt: Pose,
    x_wb: Pose,
}

impl Alignment {
    fn new(problem: &Problem<'_>, grasp: &BoardGrasp, x_bt: &Pose) -> Self {
        let roll_rad = aligning_roll(problem, &grasp.x_wo, x_bt);
        let x_wt = grasp.x_wo * problem.scenario.operation.rolled(roll_rad).x_ot;
        Self { roll_rad, x_wt, x_wb: standing_pose(&x_wt, x_bt, problem.robot.robot.floor_z_m) }
    }
}

/// The roll with which the tool on a board sees the vertical as it does at `x_bt` in the body frame, as far as a roll can
/// achieve that; zero if the roll is not free.
pub fn aligning_roll(problem: &Problem<'_>, x_wo: &Pose, x_bt: &Pose) -> f64 {
    let operation = &problem.scenario.operation;
    if operation.kind.roll_is_free() { roll_between(&(x_wo * operation.x_ot), x_bt) } else { 0.0 }
}

/// The roll about the tool's axis that turns the azimuth of the vertical, seen from the tool, from one pose to another.
fn roll_between(x_wt: &Pose, x_bt: &Pose) -> f64 {
    let azimuth = |pose: &Pose| {
        let up_t = pose.rotation.inverse() * Vector3::z();
        up_t.y.atan2(up_t.x)
    };
    let roll_rad = azimuth(x_wt) - azimuth(x_bt);
    (roll_rad + PI).rem_euclid(2.0 * PI) - PI
}

/// The pose of an upright body whose tool is at the tip's position, with the heading that brings the tool's rotation closest.
pub fn standing_pose(x_wt: &Pose, x_bt: &Pose, floor_z_m: f64) -> Pose {
    let turn = (x_wt.rotation * x_bt.rotation.inverse()).to_rotation_matrix();
    let heading_rad = (turn[(1, 0)] - turn[(0, 1)]).atan2(turn[(0, 0)] + turn[(1, 1)]);
    let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
    let from_body = heading * x_bt.translation.vector;
    let tip = x_wt.translation.vector;
    Isometry3::from_parts(Vector3::new(tip.x - from_body.x, tip.y - from_body.y, floor_z_m).into(), heading)
}

/// A candidate from a grasp and the posture nearest to `near_q_rad` that brings the tool exactly to its pose; `None` if the
/// person's arm cannot. `x_bt` is the tool pose of `near_q_rad`. If the place is given, the person stands there.
pub fn align(problem: &Problem<'_>, grasp: &BoardGrasp, near_q_rad: &ArmAngles, x_bt: &Pose) -> Option<Candidate> {
    let Alignment { roll_rad, x_wt, x_wb } = Alignment::new(problem, grasp, x_bt);
    let x_wb = problem.as_given(x_wb);
    let x_bt = x_wb.inverse() * x_wt;
    let swivel_rad = problem.human.swivel_rad(near_q_rad);
    let distance = |q: &ArmAngles| q.iter().zip(near_q_rad).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let q_h_rad = problem
        .human
        .arm_solutions(&x_bt, swivel_rad)
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    let heading = x_wb.rotation * Vector3::x();
    let p_wo = grasp.x_wo.translation.vector;
    let work = WorkPose { q_h_rad, heading_rad: heading.y.atan2(heading.x), roll_rad, p_wo_xy_m: [p_wo.x, p_wo.y] };
    Some(Candidate { work, arms: grasp.arms.clone() })
}
