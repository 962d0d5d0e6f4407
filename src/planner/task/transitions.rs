//! What is exact about the holds of a task: which pieces they serve, and how the robot gets from one to another.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::{
    graph::{Arc, ArcKind, Exact, Step},
    grasp_loads::GraspLoads,
    hand_changes::{FactFinder, HandChange, HoldFacts, hand_changes},
    holds::Holds,
    motion,
    problem::{Posture, TaskProblem},
};
use crate::{model::plan::Plan, statics::StabilityWorkspace};

/// Computes what is exact, each figure once.
pub struct Transitions<'p, 'a> {
    pub problem: &'p mut TaskProblem<'a>,
    /// May be exchanged for ones that begin with these.
    pub holds: &'p Holds<'p>,
    workspace: StabilityWorkspace,
    /// By hold.
    loads: BTreeMap<usize, Box<GraspLoads<'p>>>,
    served: BTreeMap<(usize, usize), Option<Posture>>,
    moves: BTreeMap<(usize, usize), bool>,
    regrasps: BTreeMap<(usize, usize), Option<Vec<HandChange>>>,
    facts: HoldFacts,
    accepted: BTreeMap<(usize, usize), Option<(Plan, Posture)>>,
}

impl<'p, 'a> Transitions<'p, 'a> {
    pub fn new(problem: &'p mut TaskProblem<'a>, holds: &'p Holds<'p>) -> Self {
        Self {
            problem,
            holds,
            workspace: StabilityWorkspace::new(),
            loads: BTreeMap::new(),
            served: BTreeMap::new(),
            moves: BTreeMap::new(),
            regrasps: BTreeMap::new(),
            facts: HoldFacts::default(),
            accepted: BTreeMap::new(),
        }
    }

    /// The person's posture at a piece that a hold serves.
    pub fn posture(&self, hold: usize, piece: usize) -> Option<Posture> {
        self.served.get(&(hold, piece)).copied().flatten()
    }

    /// The changes of grasps between two holds, if they are possible.
    pub fn regrasps(&self, from: usize, to: usize) -> Option<&[HandChange]> {
        self.regrasps.get(&(from, to))?.as_deref()
    }

    /// The plan of a hold for a piece with the person's best response near the posture that was found; that posture itself if the
    /// better one is not accepted.
    pub fn accepted_plan(&mut self, hold: usize, piece: usize) -> Option<(Plan, Posture)> {
        if let Some(known) = self.accepted.get(&(hold, piece)) {
            return known.clone();
        }
        let accepted = self.found_plan(hold, piece);
        self.accepted.insert((hold, piece), accepted.clone());
        accepted
    }

    fn found_plan(&mut self, hold: usize, piece: usize) -> Option<(Plan, Posture)> {
        let posture = self.posture(hold, piece)?;
        let grasp = &self.holds.holds[hold].grasp;
        let link_poses = self.problem.robot.link_poses(&grasp.arms);
        let points_w = self.problem.robot_points_w(&link_poses);
        let better = self.problem.response_near(piece, &grasp.x_wo, &posture, &link_poses, &points_w);
        let postures = better.into_iter().chain([posture]);
        postures.into_iter().find_map(|posture| Some((self.problem.plan(piece, grasp, &posture)?, posture)))
    }

    /// Excludes a hold for a piece.
    pub fn exclude(&mut self, hold: usize, piece: usize) {
        self.served.insert((hold, piece), None);
    }

    /// Excludes the motion between two holds.
    pub fn exclude_move(&mut self, from: usize, to: usize) {
        self.moves.insert((from, to), false);
    }

    /// Excludes the regrasps between two holds.
    pub fn exclude_regrasp(&mut self, from: usize, to: usize) {
        self.regrasps.insert((from, to), None);
    }

    fn moves(&mut self, from: usize, to: usize) -> bool {
        let (problem, holds) = (&*self.problem, self.holds);
        let Self { workspace, facts, .. } = self;
        let mut finder = FactFinder::new(facts, workspace);
        let carried = [from, to].iter().all(|&hold| finder.carries(problem, holds, hold, None));
        let new = finder.new;
        self.facts.extend(new);
        let [from, to] = [from, to].map(|hold| &holds.holds[hold].grasp);
        carried && motion::between(problem.robot, from, to).is_some()
    }
}

/// What is computed at once.
enum Asked<'p> {
    /// These pieces with a hold.
    Pieces { hold: usize, loads: Box<GraspLoads<'p>>, pieces: Vec<usize> },
    /// The regrasps between two holds.
    Regrasps([usize; 2]),
}

/// The answers.
enum Answer<'p> {
    Pieces { hold: usize, loads: Box<GraspLoads<'p>>, postures: Vec<(usize, Option<Posture>)> },
    Regrasps { between: [usize; 2], changes: Option<Vec<HandChange>>, facts: HoldFacts },
}

impl<'p> Asked<'p> {
    fn answer(
        self,
        problem: &TaskProblem<'_>,
        holds: &Holds<'_>,
        known: &HoldFacts,
        workspace: &mut StabilityWorkspace,
    ) -> Answer<'p> {
        match self {
            Self::Pieces { hold, mut loads, pieces } => {
                let served = |piece| (piece, posture(problem, holds, workspace, &mut loads, (hold, piece)));
                let postures = pieces.into_iter().map(served).collect();
                Answer::Pieces { hold, loads, postures }
            }
            Self::Regrasps(between) => {
                let mut finder = FactFinder::new(known, workspace);
                let changes = hand_changes(problem, holds, &mut finder, between);
                Answer::Regrasps { between, changes, facts: finder.new }
            }
        }
    }
}

/// The person's posture at a piece if the hold resists its load: that beside the board alone or, if it touches the robot or cannot
/// see, the best near it.
fn posture(
    problem: &TaskProblem<'_>,
    holds: &Holds<'_>,
    workspace: &mut StabilityWorkspace,
    loads: &mut GraspLoads<'_>,
    (hold, piece): (usize, usize),
) -> Option<Posture> {
    let posture = holds.posture(hold, piece)?;
    if !loads.resists_along(problem, workspace, piece, posture.roll_rad) {
        return None;
    }
    if holds.serving[hold][piece].is_finite() {
        return Some(posture);
    }
    let grasp = &holds.holds[hold].grasp;
    let link_poses = problem.robot.link_poses(&grasp.arms);
    let points_w = problem.robot_points_w(&link_poses);
    problem.response_near(piece, &grasp.x_wo, &posture, &link_poses, &points_w)
}

impl<'p> Exact for Transitions<'p, '_> {
    fn prepare(&mut self, steps: &[(usize, Step)]) {
        let (problem, holds, known) = (&*self.problem, self.holds, &self.facts);
        let mut pieces: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut asked = Vec::with_capacity(steps.len());
        for (piece, step) in steps.iter().filter(|(piece, step)| !self.is_known(*piece, step)) {
            match *step {
                Step::Serve { hold } => pieces.entry(hold).or_default().push(*piece),
                Step::Go { from, to, kind: ArcKind::Regrasp } => asked.push(Asked::Regrasps([from, to])),
                Step::Go { kind: ArcKind::Move, .. } => {}
            }
        }
        for (hold, pieces) in pieces {
            let loads = self
                .loads
                .remove(&hold)
                .unwrap_or_else(|| Box::new(GraspLoads::new(problem, &holds.holds[hold].grasp)));
            asked.push(Asked::Pieces { hold, loads, pieces });
        }
        let answer =
            |workspace: &mut StabilityWorkspace, asked: Asked<'p>| asked.answer(problem, holds, known, workspace);
        let answers: Vec<_> = asked.into_par_iter().with_max_len(1).map_init(StabilityWorkspace::new, answer).collect();
        for answer in answers {
            match answer {
                Answer::Pieces { hold, loads, postures } => {
                    self.loads.insert(hold, loads);
                    self.served.extend(postures.into_iter().map(|(piece, posture)| ((hold, piece), posture)));
                }
                Answer::Regrasps { between: [from, to], changes, facts } => {
                    self.regrasps.insert((from, to), changes);
                    self.facts.extend(facts);
                }
            }
        }
    }

    fn is_known(&self, piece: usize, step: &Step) -> bool {
        match *step {
            Step::Serve { hold } => self.served.contains_key(&(hold, piece)),
            Step::Go { from, to, kind: ArcKind::Regrasp } => self.regrasps.contains_key(&(from, to)),
            Step::Go { from, to, kind: ArcKind::Move } => self.moves.contains_key(&(from, to)),
        }
    }

    fn serving(&mut self, hold: usize, piece: usize) -> Option<f64> {
        self.prepare(&[(piece, Step::Serve { hold })]);
        let posture = self.posture(hold, piece)?;
        let known = self.holds.serving[hold][piece];
        if known.is_finite() {
            return Some(known);
        }
        let grasp = &self.holds.holds[hold].grasp;
        let points_w = self.problem.robot_points_w(&self.problem.robot.link_poses(&grasp.arms));
        let objective = self.problem.comfort(piece, &grasp.x_wo, &posture, &points_w).objective;
        self.problem.cost(piece, objective)
    }

    fn may_serve(&self, hold: usize, piece: usize) -> bool {
        self.served.get(&(hold, piece)).is_none_or(Option::is_some)
    }

    fn may_exist(&self, from: usize, arc: &Arc) -> bool {
        let key = (from, arc.to);
        match arc.kind {
            ArcKind::Move => self.moves.get(&key).is_none_or(|exists| *exists),
            ArcKind::Regrasp => self.regrasps.get(&key).is_none_or(Option::is_some),
        }
    }

    fn exists(&mut self, from: usize, arc: &Arc) -> bool {
        let key = (from, arc.to);
        match arc.kind {
            ArcKind::Move => {
                if !self.moves.contains_key(&key) {
                    let exists = self.moves(from, arc.to);
                    self.moves.insert(key, exists);
                }
                self.moves.get(&key).copied().unwrap_or(false)
            }
            ArcKind::Regrasp => {
                self.prepare(&[(0, Step::Go { from, to: arc.to, kind: arc.kind })]);
                self.regrasps(from, arc.to).is_some()
            }
        }
    }

    fn is_stopped(&self) -> bool {
        self.problem.watch.is_stopped()
    }
}
