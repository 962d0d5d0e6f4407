//! From the steps of a way to the staged plan.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::{
    super::{
        candidate::Candidate,
        contact::{placed_object, plan_arms},
        library::{ArmGrasp, BoardGrasp, GraspingArm},
        params::task::DEFAULT_SPEED_RAD_S,
    },
    graph::{ArcKind, Step},
    hand_changes::HandChange,
    holds::Holds,
    inputs::TaskSearch,
    motion,
    problem::Posture,
    timing::{self, MotionLimits, Timed},
    transitions::Transitions,
};
use crate::{
    collision::{PersonPart, Scene},
    model::{
        frames::Pose,
        plan::{Plan, PlannerRecord},
        scenario::PlannerSettings,
        staged_plan::{
            ArmPath, HoldStage, MoveStage, PersonDuring, RegraspStage, STAGED_FORMAT, Stage, StagedPlan, WorkedPiece,
        },
    },
};

/// The staged plan as far as it is known.
pub struct Stages<'b> {
    search: &'b TaskSearch<'b>,
    /// May be exchanged for ones that begin with these.
    pub holds: &'b Holds<'b>,
    /// `None` before its first stage.
    pub plan: Option<StagedPlan>,
    /// The piece that was served last, with the person.
    last: Option<(usize, Posture)>,
    /// By the holds between which they are.
    regrasps: BTreeMap<[usize; 2], Option<Vec<TimedRegrasp>>>,
}

impl<'b> Stages<'b> {
    /// Without stages.
    pub fn new(search: &'b TaskSearch<'b>, holds: &'b Holds<'b>) -> Self {
        Self { search, holds, plan: None, last: None, regrasps: BTreeMap::new() }
    }

    /// The number of pieces that are served.
    pub fn served(&self) -> usize {
        self.last.map_or(0, |(piece, _)| piece + 1)
    }

    /// Adds the steps of a way. False, and nothing is added, if a hold's plan for a piece, a motion or a regrasp is not accepted,
    /// which is then excluded from the next search.
    pub fn add(&mut self, transitions: &mut Transitions<'_, '_>, steps: &[Step]) -> bool {
        self.added(transitions, steps).is_some()
    }

    fn added(&mut self, transitions: &mut Transitions<'_, '_>, steps: &[Step]) -> Option<()> {
        let served = self.served();
        let Self { search, holds, last, ref mut regrasps, .. } = *self;
        let first = holds.holds.get(steps.first()?.begin())?;
        let worked = worked_pieces(transitions, served, steps)?;
        let regrasps = timed_regrasps(search, transitions, regrasps, steps)?;
        let moves = timed_moves(search, transitions, holds, steps)?;
        let mut builder = Builder { search, transitions, stages: Vec::new(), last };
        let (mut worked, mut regrasps, mut moves) = (worked.into_iter(), regrasps.into_iter(), moves.into_iter());
        for (number, step) in steps.iter().enumerate() {
            match *step {
                Step::Serve { .. } => builder.serve(worked.next()?),
                // Several motions in a row are one.
                Step::Go { kind: ArcKind::Move, .. } if number > 0 && is_move(&steps[number - 1]) => {}
                Step::Go { kind: ArcKind::Move, .. } => builder.go(&moves.next()?),
                Step::Go { from, to, kind: ArcKind::Regrasp } => {
                    for change in transitions.regrasps(from, to)? {
                        builder.regrasp(change, regrasps.next()?, &holds.holds[to].grasp);
                    }
                }
            }
        }
        let Builder { mut stages, last, .. } = builder;
        step_back_once(&mut stages);
        let plan = self.plan.get_or_insert_with(|| without_stages(search, transitions, &first.grasp));
        plan.stages.extend(stages);
        self.last = last;
        Some(())
    }
}

/// The plan of a task whose board is held like this at the start.
fn without_stages(search: &TaskSearch<'_>, transitions: &Transitions<'_, '_>, first: &BoardGrasp) -> StagedPlan {
    let scenario = search.scenario;
    let PlannerSettings { kind, seed, .. } = scenario.planner;
    StagedPlan {
        format: STAGED_FORMAT,
        name: scenario.name.clone(),
        robot: search.robot.robot.description.clone(),
        task: search.task.clone(),
        object: placed_object(scenario, first.x_wo),
        arms: plan_arms(transitions.problem.of_piece(0), &Candidate::without_person(first)),
        stages: Vec::new(),
        planner: Some(PlannerRecord { kind, seed, wall_ms: None, map_ms: None, evaluations: 0, robust: None }),
        scenario: Some(scenario.clone()),
        benchdog: Some(env!("CARGO_PKG_VERSION").into()),
    }
}

/// A person who steps back for one motion between two holds steps back for all of them: they do not come forward in between.
fn step_back_once(stages: &mut [Stage]) {
    for between in stages.split_mut(|stage| matches!(stage, Stage::Hold(_))) {
        if between.iter().any(|stage| stage.person() == PersonDuring::StepsBack) {
            between.iter_mut().for_each(|stage| match stage {
                Stage::Move(MoveStage { person, .. }) | Stage::Regrasp(RegraspStage { person, .. }) => {
                    *person = PersonDuring::StepsBack;
                }
                Stage::Hold(_) => {}
            });
        }
    }
}

fn is_move(step: &Step) -> bool {
    matches!(step, Step::Go { kind: ArcKind::Move, .. })
}

/// The plans of the served pieces in their order from the first.
fn worked_pieces(
    transitions: &mut Transitions<'_, '_>,
    first: usize,
    steps: &[Step],
) -> Option<Vec<(WorkedPiece, Posture)>> {
    let served = steps.iter().filter_map(|step| match step {
        Step::Serve { hold } => Some(*hold),
        Step::Go { .. } => None,
    });
    let mut worked = Vec::with_capacity(steps.len());
    let mut all_accepted = true;
    for (number, hold) in (first..).zip(served) {
        let Some((plan, posture)) = transitions.accepted_plan(hold, number) else {
            transitions.exclude(hold, number);
            all_accepted = false;
            continue;
        };
        let Plan { operation, human, comfort, muscles, stability, .. } = plan;
        let roll_rad = Some(posture.roll_rad).filter(|_| operation.kind.roll_is_free());
        let piece = transitions.problem.piece(number);
        worked.push((WorkedPiece { piece, roll_rad, human, comfort, muscles, stability }, posture));
    }
    all_accepted.then_some(worked)
}

/// A change of an arm's grasp: the steps of its path, and its timing.
type TimedRegrasp = (Vec<Vec<f64>>, Timed);

/// All regrasps in their order, of which some are `known`; those between two holds without a path are excluded from the next search.
fn timed_regrasps(
    search: &TaskSearch<'_>,
    transitions: &mut Transitions<'_, '_>,
    known: &mut BTreeMap<[usize; 2], Option<Vec<TimedRegrasp>>>,
    steps: &[Step],
) -> Option<Vec<TimedRegrasp>> {
    let between = |step: &Step| match *step {
        Step::Go { from, to, kind: ArcKind::Regrasp } => Some([from, to]),
        _ => None,
    };
    let pairs: Vec<_> = steps.iter().filter_map(between).collect();
    let new: BTreeSet<_> = pairs.iter().copied().filter(|pair| !known.contains_key(pair)).collect();
    let problem = &*transitions.problem;
    let of_pair = |[from, to]: [usize; 2]| Some(([from, to], transitions.regrasps(from, to)?));
    let new: Vec<_> = new.into_iter().filter_map(of_pair).collect();
    let timed = |&(between, changes): &([usize; 2], &[HandChange])| {
        let timed = |change: &HandChange| {
            let path = change.path(problem, between)?;
            let timed = timed(search, &path, &[change.arm])?;
            Some((path, timed))
        };
        (between, changes.iter().map(timed).collect())
    };
    known.extend(new.par_iter().map(timed).collect::<Vec<(_, Option<Vec<_>>)>>());
    let without: Vec<_> = pairs.iter().filter(|&pair| known.get(pair).is_none_or(Option::is_none)).collect();
    without.iter().for_each(|&&[from, to]| transitions.exclude_regrasp(from, to));
    let found = pairs.iter().map(|pair| known.get(pair).cloned().flatten());
    Some(found.collect::<Option<Vec<_>>>()?.concat())
}

/// A motion of the board: its steps, and their timing.
type TimedMove = (Vec<BoardGrasp>, Timed);

/// All motions in their order, several in a row as one; one without a path or timing is excluded from the next search.
fn timed_moves(
    search: &TaskSearch<'_>,
    transitions: &mut Transitions<'_, '_>,
    holds: &Holds<'_>,
    steps: &[Step],
) -> Option<Vec<TimedMove>> {
    let in_rows = steps.chunk_by(|a, b| is_move(a) && is_move(b)).filter(|steps| is_move(&steps[0]));
    let rows: Vec<Vec<_>> = in_rows.map(|row| row.iter().filter_map(Step::between).collect()).collect();
    let moves: Vec<_> = rows.par_iter().map(|pairs| timed_move(search, holds, pairs)).collect();
    let without = rows.iter().zip(&moves).filter(|(_, found)| found.is_none()).flat_map(|(pairs, _)| pairs);
    without.for_each(|&[from, to]| transitions.exclude_move(from, to));
    moves.into_iter().collect()
}

/// A motion over these pairs of holds: straight to the end if that is possible, else over the holds in between.
fn timed_move(search: &TaskSearch<'_>, holds: &Holds<'_>, pairs: &[[usize; 2]]) -> Option<TimedMove> {
    let robot = search.robot;
    let between = |[from, to]: [usize; 2]| motion::between(robot, &holds.holds[from].grasp, &holds.holds[to].grasp);
    let ends = [pairs.first()?[0], pairs.last()?[1]];
    let path = between(ends)
        .or_else(|| Some(pairs.iter().map(|pair| between(*pair)).collect::<Option<Vec<_>>>()?.concat()))?;
    let joints = |grasp: &BoardGrasp| grasp.arms.iter().flat_map(|arm| arm.q_rad.clone()).collect();
    let arms: Vec<_> = (0..robot.arms.len()).collect();
    let timed = timed(search, &path.iter().map(joints).collect::<Vec<_>>(), &arms)?;
    Some((path, timed))
}

/// Collects stages.
struct Builder<'b, 'p, 'a> {
    search: &'b TaskSearch<'b>,
    transitions: &'b Transitions<'p, 'a>,
    stages: Vec<Stage>,
    /// The piece that was served last, with the person.
    last: Option<(usize, Posture)>,
}

impl Builder<'_, '_, '_> {
    fn serve(&mut self, (piece, posture): (WorkedPiece, Posture)) {
        self.last = Some((self.last.map_or(0, |(number, _)| number + 1), posture));
        match self.stages.last_mut() {
            Some(Stage::Hold(hold)) => hold.pieces.push(piece),
            _ => self.stages.push(Stage::Hold(HoldStage { pieces: vec![piece] })),
        }
    }

    fn go(&mut self, (path, Timed { time_s, q, .. }): &TimedMove) {
        let robot = self.search.robot;
        let person = self.person_during(path, |grasp| (robot.link_poses(&grasp.arms), grasp.x_wo));
        let mut first_joint = 0;
        let of_arm = |arm: &GraspingArm| {
            let joints = first_joint..first_joint + arm.chain.dof();
            first_joint = joints.end;
            let q_rad = q.iter().map(|q_rad| q_rad[joints.clone()].to_vec()).collect();
            ArmPath { name: arm.name.clone(), q_rad }
        };
        let arms = robot.arms.iter().map(of_arm).collect();
        self.stages.push(Stage::Move(MoveStage { person, arms, time_s: time_s.clone() }));
    }

    fn regrasp(&mut self, change: &HandChange, (path, timed): TimedRegrasp, after: &BoardGrasp) {
        let &HandChange { arm, ref before, .. } = change;
        let robot = self.search.robot;
        let with = |q_rad: &Vec<f64>| {
            let mut arms = before.arms.clone();
            arms[arm] = ArmGrasp { grasp: after.arms[arm].grasp, q_rad: q_rad.clone() };
            arms
        };
        let person = self.person_during(&path, |q_rad| (robot.link_poses(&with(q_rad)), before.x_wo));
        let problem = self.transitions.problem.of_piece(0);
        let hold = plan_arms(problem, &Candidate::without_person(after)).swap_remove(arm);
        self.stages.push(Stage::Regrasp(RegraspStage {
            person,
            time_s: timed.time_s,
            arm: ArmPath { name: hold.name, q_rad: timed.q },
            x_og: hold.x_og,
            grip_force_n: hold.grip_force_n,
        }));
    }

    /// What the person does during the steps of a path with these poses of links and board: they stay if nothing comes near them.
    fn person_during<S: Sync>(&self, path: &[S], poses: impl Fn(&S) -> (Vec<Pose>, Pose) + Sync) -> PersonDuring {
        let Some((piece, posture)) = self.last else { return PersonDuring::StepsBack };
        let problem = self.transitions.problem.of_piece(piece);
        let person = problem.human.capsules_w(&posture.x_wb, &posture.q_h_rad).map(PersonPart::from);
        let touched = path.par_iter().any(|step| {
            let (link_poses, x_wo) = poses(step);
            let scene = Scene { person: &person, ..problem.robot.scene(&link_poses, x_wo) };
            problem.robot.collision.first_violation_of_person(&scene).is_some()
        });
        if touched { PersonDuring::StepsBack } else { PersonDuring::Stays }
    }
}

/// The timing of a path of the joints of these arms.
fn timed(search: &TaskSearch<'_>, path: &[Vec<f64>], arms: &[usize]) -> Option<Timed> {
    let robot = &search.robot.robot;
    let motion = &search.task.motion;
    let joints = arms.iter().flat_map(|&arm| &robot.arms[search.robot.arms[arm].index].joints);
    let joints: Vec<_> = joints.copied().collect();
    let speed = |&joint: &usize| {
        let most = robot.joints[joint].most_speed;
        motion.speed_share * if most > 0.0 && most.is_finite() { most } else { DEFAULT_SPEED_RAD_S }
    };
    let velocity: Vec<_> = joints.iter().map(speed).collect();
    let acceleration = vec![motion.acceleration_rad_s2; velocity.len()];
    let mut timed = timing::time(path, &MotionLimits { velocity, acceleration }).ok()?;
    // The smooth path may pass a limit that its waypoints touch by a little.
    for q_rad in &mut timed.q {
        for (q, &joint) in q_rad.iter_mut().zip(&joints) {
            *q = q.clamp(robot.joints[joint].lower, robot.joints[joint].upper);
        }
    }
    Some(timed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_steps_back_once_between_two_holds() {
        use PersonDuring::{Stays, StepsBack};
        let go = |person| Stage::Move(MoveStage { person, arms: Vec::new(), time_s: Vec::new() });
        let hold = || Stage::Hold(HoldStage { pieces: Vec::new() });
        let mut stages = vec![go(Stays), go(StepsBack), go(Stays), hold(), go(Stays), go(Stays), hold(), go(StepsBack)];
        step_back_once(&mut stages);
        let people: Vec<_> = stages.iter().map(Stage::person).collect();
        assert_eq!(people, [StepsBack, StepsBack, StepsBack, Stays, Stays, Stays, Stays, StepsBack]);
    }
}
