//! Grips of the board, each with the board poses at which the arms have it without regrasping.

use std::collections::{BTreeMap, VecDeque};

use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::{
    super::{
        domain::{ANGLE_RAD, uniform},
        library::{BoardGrasp, GraspingRobot, grasps_of_board},
        params::task::{DRAWN_BOARDS, GRIP_STREAM, GRIPS_PER_PIECE, MOST_FOLLOWED_RAD, NEAR_GRASP, NEAR_GRIPS},
    },
    grasp_loads::GraspLoads,
    places::Places,
    problem::TaskProblem,
    root::Root,
};
use crate::statics::StabilityWorkspace;

/// A grasp of the board at a board pose.
type Source = (usize, BoardGrasp);

/// A grip: a grasp of every arm, and the arms' configurations at board poses that they reach from one another.
pub struct Grip {
    /// By board pose.
    pub at: BTreeMap<usize, BoardGrasp>,
    /// True if it is that of a best hold of a piece.
    is_of_root: bool,
}

/// The grips of the best holds of single pieces, grips near these, and grips drawn for the board poses; for each piece those that
/// resist its load and that of most other pieces.
pub fn grips(problem: &TaskProblem<'_>, roots: &[Root], places: &Places) -> Vec<Grip> {
    let robot = problem.robot;
    let random =
        |number: usize| Pcg64::new(u128::from(problem.of_piece(0).scenario.planner.seed), GRIP_STREAM + number as u128);
    let of_roots = roots.iter().enumerate().filter_map(|(number, root)| {
        let place = places.of_root(number);
        Some(((place, followed(robot, &root.grasp, places, place)?), true))
    });
    let near = |number: usize| near_root(robot, &roots[number % roots.len()], places, &mut random(number));
    let count = if roots.is_empty() { 0 } else { NEAR_GRIPS * problem.pieces() };
    let near: Vec<_> = (0..count).into_par_iter().filter_map(near).collect();
    let drawn = |number: usize| {
        let mut random = random(count + number);
        let Some((place, x_wo)) = places.drawn(&mut random) else { return Vec::new() };
        let entries = grasps_of_board(robot, &x_wo, &mut random).unwrap_or_default();
        entries.into_iter().map(|entry| (place, entry.grasp)).collect::<Vec<_>>()
    };
    let drawn: Vec<_> = (0..DRAWN_BOARDS * problem.pieces()).into_par_iter().flat_map_iter(drawn).collect();
    let sources: Vec<_> = of_roots.chain(near.into_iter().chain(drawn).map(|source| (source, false))).collect();
    // Most grips that resist nothing where they were drawn resist nothing elsewhere.
    let is_useful = |workspace: &mut StabilityWorkspace, ((place, grasp), of_root): &(Source, bool)| {
        let mut loads = GraspLoads::new(problem, grasp);
        *of_root || (0..problem.pieces()).any(|piece| resists(problem, places, workspace, &mut loads, *place, piece))
    };
    let useful: Vec<_> = sources.par_iter().map_init(StabilityWorkspace::new, is_useful).collect();
    let sources: Vec<_> = sources.into_iter().zip(useful).filter(|(_, useful)| *useful).map(|(of, _)| of).collect();
    let grips: Vec<_> = sources.into_par_iter().map(|(source, of)| grown(robot, places, source, of)).collect();
    selected(problem, grips, places)
}

/// A grip near that of a best hold, drawn at random, at one of the board poses of its piece; `None` if it does not fit or the arms do
/// not reach it there.
fn near_root(robot: &GraspingRobot, root: &Root, places: &Places, random: &mut Pcg64) -> Option<Source> {
    let place = places.drawn_of(root.piece, random)?;
    let mut from = root.grasp.clone();
    for (arm, own) in robot.arms.iter().zip(&mut from.arms) {
        let [along_m, depth_m, angle_rad] = NEAR_GRASP.map(|most| uniform(random, -most, most));
        own.grasp.along_m += along_m;
        own.grasp.depth_m = (own.grasp.depth_m + depth_m).clamp(arm.depth_m[0], arm.depth_m[1]);
        own.grasp.angle_rad = (own.grasp.angle_rad + angle_rad).clamp(ANGLE_RAD[0], ANGLE_RAD[1]);
        if !robot.fits(arm, &own.grasp) {
            return None;
        }
    }
    Some((place, followed(robot, &from, places, place)?))
}

/// The same grip at another board pose, if the arms follow the board there without a collision.
fn followed(robot: &GraspingRobot, from: &BoardGrasp, places: &Places, place: usize) -> Option<BoardGrasp> {
    robot.followed(from, places.x_wo(place)?, MOST_FOLLOWED_RAD)
}

/// A grip with all board poses that it reaches over neighbouring ones.
fn grown(robot: &GraspingRobot, places: &Places, (place, grasp): Source, is_of_root: bool) -> Grip {
    let mut at = BTreeMap::from([(place, grasp)]);
    let mut tried = vec![false; places.count()];
    tried[place] = true;
    let mut open = VecDeque::from([place]);
    while let Some(here) = open.pop_front() {
        for next in places.beside(here) {
            if std::mem::replace(&mut tried[next], true) {
                continue;
            }
            if let Some(there) = at.get(&here).and_then(|from| followed(robot, from, places, next)) {
                at.insert(next, there);
                open.push_back(next);
            }
        }
    }
    Grip { at, is_of_root }
}

/// True if the person has a posture for a piece with the board at a place, and a grasp there resists its load.
fn resists(
    problem: &TaskProblem<'_>,
    places: &Places,
    workspace: &mut StabilityWorkspace,
    loads: &mut GraspLoads<'_>,
    place: usize,
    piece: usize,
) -> bool {
    places.posture(place, piece).is_some_and(|posture| loads.resists(problem, workspace, piece, posture.roll_rad))
}

/// Of each piece the grips that serve it and most other pieces, and all those of best holds. Each is tested at one board pose for
/// each piece at the tool: a shift hardly changes what hands resist.
fn selected(problem: &TaskProblem<'_>, grips: Vec<Grip>, places: &Places) -> Vec<Grip> {
    let pieces = problem.pieces();
    let served = |workspace: &mut StabilityWorkspace, grip: &Grip| {
        let mut served = vec![false; pieces];
        let mut tested = vec![false; pieces];
        for (&place, grasp) in &grip.at {
            if std::mem::replace(&mut tested[places.piece(place)], true) {
                continue;
            }
            let mut loads = GraspLoads::new(problem, grasp);
            for (piece, served) in served.iter_mut().enumerate().filter(|(_, served)| !**served) {
                *served = resists(problem, places, workspace, &mut loads, place, piece);
            }
        }
        served
    };
    let served: Vec<_> = grips.par_iter().map_init(StabilityWorkspace::new, served).collect();
    let counts: Vec<_> = served.iter().map(|pieces| pieces.iter().filter(|served| **served).count()).collect();
    let mut kept: Vec<bool> = grips.iter().map(|grip| grip.is_of_root).collect();
    let best_of = |piece: usize| {
        let mut of_piece: Vec<_> = (0..grips.len()).filter(|&grip| served[grip][piece]).collect();
        of_piece.sort_by_key(|&grip| std::cmp::Reverse((counts[grip], grips[grip].at.len())));
        of_piece.truncate(GRIPS_PER_PIECE);
        of_piece
    };
    for grip in (0..pieces).flat_map(best_of) {
        kept[grip] = true;
    }
    grips.into_iter().zip(kept).filter(|(_, kept)| *kept).map(|(grip, _)| grip).collect()
}
