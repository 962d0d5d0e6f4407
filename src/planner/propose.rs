//! The first half of the search: where good holds may be.
//!
//! Two maps meet: the robot's knows holds of the board, the person's knows comfortable postures. A hold brings the tool to
//! some height and turn against the vertical; the postures that ask for just that are looked up and valued as if they
//! fitted exactly. The most promising pairs are then disposed of in earnest: the person's inverse kinematics makes the
//! posture fit, and strength, collisions and stability are tested.

use std::f64::consts::{FRAC_PI_4, PI};

use arrayvec::ArrayVec;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rand::{Rng, RngExt};
use rand_pcg::Pcg64;

use super::{
    Problem,
    assess::{self, Configured, Feasible, Rejection, Tally},
    bank::{BankedHold, KnownHold},
    candidate::{Candidate, hold_kind},
    effort::Effort,
    person_map::{GLANCE_POINTS, PersonMap, Posture, SKETCH_POINTS},
    work_map::canonical,
};
use crate::{
    human::{ArmAngles, peripersonal_m},
    model::{
        frames::Pose,
        grasp::{Edge, EdgeGrasp},
    },
};

/// Depth of G inside the edge, m (METHOD section 2).
pub const DEPTH_M: [f64; 2] = [0.020, 0.060];
/// Turn of the gripper in the plane of the board, rad (METHOD section 2).
pub const ANGLE_RAD: [f64; 2] = [-FRAC_PI_4, FRAC_PI_4];

/// How many of the pairs that look best at first are looked at again for each that is tested in earnest.
const SECOND_LOOKS: usize = 3;

/// A hold of the bank and a posture that nearly answers it.
#[derive(Clone, Copy)]
struct Proposal<'a> {
    known: &'a BankedHold,
    posture: &'a Posture,
    worth: f64,
}

/// The best pairs of a bank's holds and the person's postures that keep every constraint, the best first.
pub fn best_candidates(
    problem: &mut Problem<'_>,
    bank: &[BankedHold],
    effort: &Effort,
    tally: &mut Tally,
) -> Vec<Feasible> {
    let map = problem.map;
    let made;
    let person = match problem.person {
        Some(person) => person,
        None => {
            // The person's map of a work map, but for the weights of optima that only practice knows.
            made = PersonMap::of(&canonical(problem.scenario), &problem.human);
            &made
        }
    };
    if bank.is_empty() {
        tally.remove_all(map.drawn, Rejection::RobotReach);
    }
    let mut proposals = Vec::with_capacity(bank.len() * effort.postures_a_cell);
    for known in bank {
        if tally.is_exhausted() {
            break;
        }
        tally.draw();
        if person.is_empty() {
            tally.remove(Rejection::Strength);
            continue;
        }
        let x_wt = known.hold.x_wo * problem.scenario.operation.x_ot;
        let postures = person.postures(&x_wt, map.robot.floor_z_m);
        if postures.is_empty() {
            tally.remove(Rejection::PersonReach);
        }
        proposals.extend(postures.iter().map(|posture| {
            let (robot_w, body_b) = (known.glance_w.as_slice(), &posture.sketch_b[..GLANCE_POINTS]);
            Proposal { known, posture, worth: worth(problem, known, posture, robot_w, body_b) }
        }));
    }
    keep_best(&mut proposals, SECOND_LOOKS * effort.disposed);
    for Proposal { known, posture, worth: seen } in &mut proposals {
        *seen = worth(problem, known, posture, &known.robot_points_w, &posture.sketch_b);
    }
    keep_best(&mut proposals, effort.disposed);
    dispose(problem, effort, &proposals, tally)
}

/// Keeps so many of the proposals that are worth most, the best first.
fn keep_best(proposals: &mut Vec<Proposal<'_>>, count: usize) {
    // Stable, so that equals stay in the order of the maps.
    proposals.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    proposals.truncate(count);
}

/// Makes the most promising proposals fit, and returns those worth most then that keep every constraint, one a hold and a
/// few of a kind, the best first.
fn dispose(problem: &mut Problem<'_>, effort: &Effort, proposals: &[Proposal<'_>], tally: &mut Tally) -> Vec<Feasible> {
    let mut fitting = Vec::with_capacity(effort.disposed);
    for proposal in proposals {
        match fit(problem, &proposal.known.hold, &proposal.posture.q_h_rad, &proposal.posture.x_bt) {
            Some(candidate) => {
                let configured = Configured::new(problem, &candidate);
                let worth = assess::comfort(problem, &candidate, &configured).objective;
                fitting.push((worth, proposal.known, candidate));
            }
            None => {
                tally.draw();
                tally.remove(Rejection::PersonReach);
            }
        }
    }
    fitting.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut kept: Vec<Feasible> = Vec::new();
    let mut used: Vec<&BankedHold> = Vec::new();
    for (_, known, candidate) in fitting {
        if kept.len() == effort.starts || tally.is_exhausted() {
            break;
        }
        let kind = hold_kind(&known.hold.holds);
        let alike = used.iter().filter(|other| hold_kind(&other.hold.holds) == kind).count();
        if alike == effort.starts_of_a_kind || used.iter().any(|other| std::ptr::eq(*other, known)) {
            continue;
        }
        tally.draw();
        match assess::feasible(problem, candidate) {
            Ok(found) => {
                kept.push(found);
                used.push(known);
            }
            Err(why) => tally.remove(why),
        }
    }
    kept
}

/// What a hold and a posture would be worth if they fitted exactly, by these points of the robot (W) and of the body (B).
fn worth(
    problem: &Problem<'_>,
    known: &BankedHold,
    posture: &Posture,
    robot_w: &[Point3<f64>],
    body_b: &[Point3<f64>],
) -> f64 {
    let settings = &problem.objective;
    let x_wb = meeting(problem, &known.hold, &posture.x_bt).x_wb;
    let body_w: ArrayVec<_, SKETCH_POINTS> = body_b.iter().map(|p_b| x_wb * p_b).collect();
    let distance_m = peripersonal_m(settings.peripersonal, settings.saturation_m, &body_w, robot_w);
    settings.weight_muscular * posture.muscular + settings.weight_peripersonal * distance_m
}

/// How a posture answers a hold.
struct Meeting {
    roll_rad: f64,
    x_wt: Pose,
    x_wb: Pose,
}

fn meeting(problem: &Problem<'_>, hold: &KnownHold, x_bt: &Pose) -> Meeting {
    // Where the tool may roll, all rolls share a cell; which one a posture needs is worked out.
    let roll_rad = fitting_roll(problem, &hold.x_wo, x_bt);
    let x_wt = hold.x_wo * problem.scenario.operation.rolled(roll_rad).x_ot;
    Meeting { roll_rad, x_wt, x_wb: standing(&x_wt, x_bt, problem.map.robot.floor_z_m) }
}

/// The roll with which the tool on a board sees the vertical as from its pose in a body, as far as a roll can bring that about;
/// zero where the operation leaves none free.
pub fn fitting_roll(problem: &Problem<'_>, x_wo: &Pose, x_bt: &Pose) -> f64 {
    let operation = &problem.scenario.operation;
    if operation.kind.roll_is_free() { roll_between(&(x_wo * operation.x_ot), x_bt) } else { 0.0 }
}

/// The roll about the tool's axis that brings the vertical, seen from the tool, from one pose to another.
fn roll_between(x_wt: &Pose, x_bt: &Pose) -> f64 {
    let azimuth = |pose: &Pose| {
        let up_t = pose.rotation.inverse() * Vector3::z();
        up_t.y.atan2(up_t.x)
    };
    let roll_rad = azimuth(x_wt) - azimuth(x_bt);
    (roll_rad + PI).rem_euclid(2.0 * PI) - PI
}

/// Where an upright body stands so that its tool is at the tip's place and turned as closely to it as may be.
pub fn standing(x_wt: &Pose, x_bt: &Pose, floor_z_m: f64) -> Pose {
    let turn = (x_wt.rotation * x_bt.rotation.inverse()).to_rotation_matrix();
    let heading_rad = (turn[(1, 0)] - turn[(0, 1)]).atan2(turn[(0, 0)] + turn[(1, 1)]);
    let heading = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading_rad);
    let from_body = heading * x_bt.translation.vector;
    let tip = x_wt.translation.vector;
    Isometry3::from_parts(Vector3::new(tip.x - from_body.x, tip.y - from_body.y, floor_z_m).into(), heading)
}

/// A hold with a posture near this one that brings the tool exactly to its place; none when the arm cannot. `x_bt` is where
/// the posture has the tool.
pub fn fit(problem: &Problem<'_>, hold: &KnownHold, near_q_rad: &ArmAngles, x_bt: &Pose) -> Option<Candidate> {
    let Meeting { roll_rad, x_wt, x_wb } = meeting(problem, hold, x_bt);
    let x_bt = x_wb.inverse() * x_wt;
    let swivel_rad = problem.human.swivel_rad(near_q_rad);
    let apart = |q: &ArmAngles| q.iter().zip(near_q_rad).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let q_h_rad =
        problem.human.arm_solutions(&x_bt, swivel_rad).into_iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    let heading = x_wb.rotation * Vector3::x();
    let p_wo = hold.x_wo.translation.vector;
    Some(Candidate {
        q_h_rad,
        heading_rad: heading.y.atan2(heading.x),
        roll_rad,
        p_wo_xy_m: [p_wo.x, p_wo.y],
        holds: hold.holds.clone(),
    })
}

/// A grasp on this edge; its pads may be over the board's edge.
pub fn draw_grasp(edge: Edge, size_m: [f64; 3], random: &mut Pcg64) -> EdgeGrasp {
    let (_, half_length_m) = edge.reach_and_half_length_m(size_m);
    EdgeGrasp {
        edge,
        along_m: uniform(random, -half_length_m, half_length_m),
        depth_m: uniform(random, DEPTH_M[0], DEPTH_M[1]),
        angle_rad: uniform(random, ANGLE_RAD[0], ANGLE_RAD[1]),
        flipped: random.random_bool(0.5),
    }
}

/// A number drawn uniformly between two others.
pub fn uniform(random: &mut impl Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}
