//! The grasp library: collision-free grasps of boards of one shape.
//!
//! Whether a robot can grasp a board in some pose depends neither on the person nor on the task, and is the constraint that
//! random candidates satisfy least often. So grasps are found once and serve all tasks on boards of that shape: the first
//! arm's configuration and grasp are drawn, which gives the board's pose; inverse kinematics brings the other arms there.

use std::sync::Arc;

use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    board_grasps::grasps_of_board,
    draws::{draw_arm_grasp, draw_grasp},
    entry::LibraryEntry,
    failures::{DrawFailure, DrawFailures},
    grasp::{ArmGrasp, BoardGrasp},
    grasping_robot::GraspingRobot,
};
use crate::{
    collision::Violation,
    model::{board::BoardShape, frames::Pose, scenario::Scenario, stop::Stop as _},
    planner::{
        domain::{draw_edge, draw_other_edge},
        made_once::MadeOnce,
        map_store::{self, MapKind, MapSource, MapStore},
        outcome::PlanError,
        params::library::{
            BOARDS_AT_ONCE, BOARDS_PER_GRASP, DRAWS_AT_ONCE, DRAWS_PER_GRASP, FIRST_ARM_ATTEMPTS, FURTHER_GRASPS,
            GRASPS, GRASPS_PER_BOARD, HOPELESS_SHARE, SEED,
        },
        watch::{Counter, Phase, Watch, go_on},
    },
    robot::Robot,
};

/// Collision-free grasps of a robot for boards of one shape with one clearance. It depends on nothing else. The grasps are
/// drawn when they are first asked for.
pub struct GraspLibrary {
    /// The robot, prepared for boards of that shape.
    pub robot: GraspingRobot,
    store: Option<Arc<dyn MapStore>>,
    drawn: MadeOnce<DrawnGrasps>,
    further: MadeOnce<DrawnGrasps>,
}

/// Drawn grasps.
struct DrawnGrasps {
    entries: Vec<LibraryEntry>,
    /// What the draws failed at that gave no grasp.
    failures: DrawFailures,
}

/// Drawn grasps as they are kept.
#[derive(Serialize, Deserialize)]
struct KeptGrasps {
    grasps: Vec<BoardGrasp>,
    failures: DrawFailures,
}

impl GraspLibrary {
    /// A library without a store.
    #[cfg(test)]
    pub fn new(robot: &Robot, board: &BoardShape, clearance_m: f64) -> Self {
        Self::kept_in(None, robot, board, clearance_m)
    }

    /// The library of a robot for boards of this shape that keeps a clearance, m, with a store that the grasps are read from and
    /// written to; it has fewer than the usual number of entries where grasps are rare.
    pub fn kept_in(store: Option<Arc<dyn MapStore>>, robot: &Robot, board: &BoardShape, clearance_m: f64) -> Self {
        let robot = GraspingRobot::new(robot, board, clearance_m);
        Self { robot, store, drawn: MadeOnce::default(), further: MadeOnce::default() }
    }

    /// The grasps.
    ///
    /// # Errors
    /// After a stop.
    pub fn entries(&self, watch: &dyn Watch) -> Result<&[LibraryEntry], PlanError> {
        Ok(&self.drawn(watch)?.entries)
    }

    /// What the draws failed at that gave no grasp.
    ///
    /// # Errors
    /// After a stop.
    pub fn failures(&self, watch: &dyn Watch) -> Result<&DrawFailures, PlanError> {
        Ok(&self.drawn(watch)?.failures)
    }

    /// Further grasps for the same boards, from random numbers of their own: for a search that found nothing among the
    /// library's.
    ///
    /// # Errors
    /// After a stop.
    pub fn further_entries(&self, watch: &dyn Watch) -> Result<&[LibraryEntry], PlanError> {
        let make = || {
            let counter = Counter::new(watch, Phase::SecondSearch, FURTHER_GRASPS);
            self.kept_or_drawn(MapKind::FurtherGrasps, FURTHER_GRASPS, 1, &counter)
        };
        Ok(&self.further.get_or_make(make)?.entries)
    }

    /// True if there is no grasp, neither among the library's nor among further ones if these were drawn.
    ///
    /// # Errors
    /// After a stop.
    pub fn is_empty(&self, watch: &dyn Watch) -> Result<bool, PlanError> {
        Ok(self.entries(watch)?.is_empty() && self.further.get().is_none_or(|further| further.entries.is_empty()))
    }

    /// The store of its maps.
    pub fn store(&self) -> Option<&dyn MapStore> {
        self.store.as_deref()
    }

    /// The source of a map of this robot and these boards.
    pub fn source<'a>(&'a self, kind: MapKind, task: Option<&'a Scenario>) -> MapSource<'a> {
        let GraspingRobot { robot, board, clearance_m, .. } = &self.robot;
        MapSource { kind, robot, board, clearance_m: *clearance_m, task }
    }

    fn drawn(&self, watch: &dyn Watch) -> Result<&DrawnGrasps, PlanError> {
        self.drawn.get_or_make(|| {
            let counter = Counter::new(watch, Phase::GraspLibrary, GRASPS);
            self.kept_or_drawn(MapKind::Grasps, GRASPS, 0, &counter)
        })
    }

    /// At most `wanted` grasps from a stream of random numbers, from the store if it has them.
    fn kept_or_drawn(
        &self,
        kind: MapKind,
        wanted: usize,
        stream: u128,
        counter: &Counter<'_>,
    ) -> Result<DrawnGrasps, PlanError> {
        let source = self.source(kind, None);
        let kept = map_store::read(self.store(), &source).and_then(|kept| self.of_kept(kept));
        if let Some(kept) = kept {
            return Ok(kept);
        }
        let (entries, failures) = draw_entries(&self.robot, wanted, stream, counter);
        go_on(counter)?;
        let grasps = entries.iter().map(|entry| entry.grasp.clone()).collect();
        let kept = KeptGrasps { grasps, failures };
        map_store::write(self.store(), &source, &kept);
        Ok(DrawnGrasps { entries, failures: kept.failures })
    }

    /// The drawn grasps of kept ones; `None` if these are not of this robot and board.
    fn of_kept(&self, KeptGrasps { grasps, failures }: KeptGrasps) -> Option<DrawnGrasps> {
        let entry = |grasp: BoardGrasp| {
            let link_poses = self.robot.has_form_of(&grasp.arms).then(|| self.robot.link_poses(&grasp.arms))?;
            Some(LibraryEntry::new(&self.robot, grasp, &link_poses))
        };
        let entries = grasps.into_iter().map(entry).collect::<Option<_>>()?;
        failures.are_of(&self.robot.robot).then_some(DrawnGrasps { entries, failures })
    }
}

/// At most `wanted` grasps from a stream of random numbers, and what the other draws failed at. After a stop they are not
/// complete.
fn draw_entries(
    robot: &GraspingRobot,
    wanted: usize,
    stream: u128,
    counter: &Counter<'_>,
) -> (Vec<LibraryEntry>, DrawFailures) {
    // Single draws of more than two arms hardly ever fit together: grasps of all arms are drawn for each board.
    let by_board = robot.arms.len() > 2;
    let (most, at_once) =
        if by_board { (BOARDS_PER_GRASP * wanted, BOARDS_AT_ONCE) } else { (DRAWS_PER_GRASP * wanted, DRAWS_AT_ONCE) };
    let of_draw = |number: usize| {
        if counter.is_stopped() {
            return Ok(Vec::new());
        }
        let mut random = Pcg64::new(SEED, (stream << 64) + number as u128 + 1);
        if by_board { draw_board(robot, &mut random) } else { draw_entry(robot, &mut random).map(|entry| vec![entry]) }
    };
    let mut entries = Vec::with_capacity(wanted);
    let mut failures = DrawFailures::default();
    for first in (0..most).step_by(at_once) {
        // The search ends sooner if nothing at all was found.
        let is_hopeless = entries.is_empty() && first >= most / HOPELESS_SHARE;
        if entries.len() >= wanted || is_hopeless || counter.is_stopped() {
            break;
        }
        let draws = first..most.min(first + at_once);
        for found in draws.into_par_iter().map(of_draw).collect::<Vec<_>>() {
            match found {
                Ok(found) => entries.extend(found.into_iter().inspect(|_| counter.advance())),
                Err(failure) => failures.count(failure),
            }
        }
    }
    entries.truncate(wanted);
    (entries, failures)
}

/// Grasps of all arms on a board that the first one holds.
fn draw_board(robot: &GraspingRobot, random: &mut Pcg64) -> Result<Vec<LibraryEntry>, DrawFailure> {
    let (_, x_wo) = draw_first(robot, random)?;
    let mut found = grasps_of_board(robot, &x_wo, random)?;
    found.truncate(GRASPS_PER_BOARD);
    Ok(found)
}

/// A grasp of the first arm and the pose of the board that it holds.
fn draw_first(robot: &GraspingRobot, random: &mut Pcg64) -> Result<(ArmGrasp, Pose), DrawFailure> {
    let first = robot.arms.first().ok_or(DrawFailure::NoArm)?;
    let edge = draw_edge(&robot.edges, random).ok_or(DrawFailure::NoEdge)?;
    let grasp = draw_grasp(robot, first, edge, |_| true, random).ok_or(DrawFailure::Pads { arm: 0 })?;
    let x_go = grasp.x_og(&robot.board).inverse();
    let in_domain = |x_wo: &Pose| robot.domain.contains(x_wo);
    let (q_rad, x_wo) = (0..FIRST_ARM_ATTEMPTS)
        .find_map(|_| first.reach().draw(&first.chain, &x_go, in_domain, random))
        .ok_or(DrawFailure::Domain)?;
    Ok((ArmGrasp { grasp, q_rad }, x_wo))
}

fn draw_entry(robot: &GraspingRobot, random: &mut Pcg64) -> Result<LibraryEntry, DrawFailure> {
    let (first, x_wo) = draw_first(robot, random)?;
    let edge = first.grasp.edge;
    let mut arms = vec![first];
    for (number, arm) in robot.arms.iter().skip(1).enumerate() {
        let edge = draw_other_edge(edge, robot.opposite(edge), random);
        let reached = draw_arm_grasp(robot, arm, edge, &x_wo, random);
        arms.push(reached.ok_or(DrawFailure::Reach { arm: number + 1 })?);
    }
    let link_poses = robot.link_poses(&arms);
    match robot.collision.first_violation(&robot.scene(&link_poses, x_wo)) {
        None => Ok(LibraryEntry::new(robot, BoardGrasp { x_wo, arms }, &link_poses)),
        Some(Violation { bodies, .. }) => Err(DrawFailure::Collision { bodies }),
    }
}
