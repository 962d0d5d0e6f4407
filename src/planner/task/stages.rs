//! From the steps of a way to the staged plan.

use super::{
    super::{
        candidate::Candidate,
        contact::{placed_object, plan_arms},
        library::{ArmGrasp, BoardGrasp},
        params::task::DEFAULT_SPEED_RAD_S,
    },
    graph::{ArcKind, Step},
    holds::Holds,
    inputs::TaskSearch,
    motion,
    problem::Posture,
    timing::{self, MotionLimits, Timed},
    transitions::{HandChange, Transitions},
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

/// The staged plan of a way; `None` if a hold's plan for a piece is not accepted, which is then excluded from the next search.
pub fn staged(
    search: &TaskSearch<'_>,
    transitions: &mut Transitions<'_, '_>,
    holds: &Holds,
    steps: &[Step],
) -> Option<StagedPlan> {
    let first = holds.holds.get(first_hold(steps)?)?;
    let worked = worked_pieces(search, transitions, holds, steps)?;
    let paths = regrasp_paths(transitions, steps)?;
    let mut builder = Builder { search, transitions, holds, stages: Vec::new(), moving: Vec::new(), last: None };
    let mut worked = worked.into_iter();
    let mut paths = paths.into_iter();
    for step in steps {
        builder.add(step, &mut worked, &mut paths)?;
    }
    let stages = builder.stages;
    let problem = transitions.problem.of_piece(0);
    let scenario = search.scenario;
    let PlannerSettings { kind, seed, .. } = scenario.planner;
    let candidate = Candidate::without_person(&first.grasp);
    Some(StagedPlan {
        format: STAGED_FORMAT,
        name: scenario.name.clone(),
        robot: search.robot.robot.description.clone(),
        task: search.task.clone(),
        object: placed_object(scenario, first.grasp.x_wo),
        arms: plan_arms(problem, &candidate),
        stages,
        planner: Some(PlannerRecord { kind, seed, wall_ms: None, map_ms: None, evaluations: 0, robust: None }),
        scenario: Some(scenario.clone()),
        benchdog: Some(env!("CARGO_PKG_VERSION").into()),
    })
}

fn first_hold(steps: &[Step]) -> Option<usize> {
    steps.first().map(|step| match *step {
        Step::Serve { hold } => hold,
        Step::Go { from, .. } => from,
    })
}

/// The plans of all served pieces in their order, each with its hold.
fn worked_pieces(
    search: &TaskSearch<'_>,
    transitions: &mut Transitions<'_, '_>,
    holds: &Holds,
    steps: &[Step],
) -> Option<Vec<(WorkedPiece, Posture)>> {
    let served = steps.iter().filter_map(|step| match step {
        Step::Serve { hold } => Some(*hold),
        Step::Go { .. } => None,
    });
    let pieces = search.task.pieces();
    let mut worked = Vec::with_capacity(pieces.len());
    let mut all_accepted = true;
    for ((number, hold), piece) in served.enumerate().zip(&pieces) {
        let grasp = &holds.holds[hold].grasp;
        let Some((plan, posture)) = transitions.accepted_plan(hold, number, grasp) else {
            transitions.exclude(hold, number);
            all_accepted = false;
            continue;
        };
        let Plan { operation, human, comfort, muscles, stability, .. } = plan;
        let roll_rad = Some(posture.roll_rad).filter(|_| operation.kind.roll_is_free());
        worked.push((WorkedPiece { piece: *piece, roll_rad, human, comfort, muscles, stability }, posture));
    }
    all_accepted.then_some(worked)
}

/// The joint paths of all regrasps in their order; those between two holds without one are excluded from the next search.
fn regrasp_paths(transitions: &mut Transitions<'_, '_>, steps: &[Step]) -> Option<Vec<Vec<Vec<f64>>>> {
    let mut paths = Vec::new();
    let mut all_found = true;
    for step in steps {
        let &Step::Go { from, to, kind: ArcKind::Regrasp } = step else { continue };
        let found = |change: &HandChange| change.path(transitions.problem, [from, to]);
        match transitions.regrasps(from, to)?.iter().map(found).collect::<Option<Vec<_>>>() {
            Some(found) => paths.extend(found),
            None => {
                transitions.exclude_regrasp(from, to);
                all_found = false;
            }
        }
    }
    all_found.then_some(paths)
}

/// Collects stages.
struct Builder<'b, 'p, 'a> {
    search: &'b TaskSearch<'b>,
    transitions: &'b Transitions<'p, 'a>,
    holds: &'b Holds,
    stages: Vec<Stage>,
    /// The holds of the motion that is under way.
    moving: Vec<usize>,
    /// The piece that was served last, with the person.
    last: Option<(usize, Posture)>,
}

impl Builder<'_, '_, '_> {
    fn add(
        &mut self,
        step: &Step,
        worked: &mut impl Iterator<Item = (WorkedPiece, Posture)>,
        paths: &mut impl Iterator<Item = Vec<Vec<f64>>>,
    ) -> Option<()> {
        match *step {
            Step::Serve { .. } => {
                self.finish_motion()?;
                let (piece, posture) = worked.next()?;
                self.last = Some((self.last.map_or(0, |(number, _)| number + 1), posture));
                match self.stages.last_mut() {
                    Some(Stage::Hold(hold)) => hold.pieces.push(piece),
                    _ => self.stages.push(Stage::Hold(HoldStage { pieces: vec![piece] })),
                }
            }
            Step::Go { from, to, kind: ArcKind::Move } => {
                if self.moving.is_empty() {
                    self.moving.push(from);
                }
                self.moving.push(to);
            }
            Step::Go { from, to, kind: ArcKind::Regrasp } => {
                self.finish_motion()?;
                for change in self.transitions.regrasps(from, to)? {
                    let stage = self.regrasp(change, &paths.next()?, &self.holds.holds[to].grasp)?;
                    self.stages.push(Stage::Regrasp(stage));
                }
            }
        }
        Some(())
    }

    /// Ends the motion that is under way.
    fn finish_motion(&mut self) -> Option<()> {
        let moving = std::mem::take(&mut self.moving);
        let (Some(first), Some(last)) = (moving.first(), moving.last()) else { return Some(()) };
        let robot = self.search.robot;
        let grasp = |hold: usize| &self.holds.holds[hold].grasp;
        // Straight to the end if that is possible, else over the holds in between.
        let path = motion::between(robot, grasp(*first), grasp(*last)).or_else(|| {
            let parts = moving.windows(2).map(|pair| motion::between(robot, grasp(pair[0]), grasp(pair[1])));
            Some(parts.collect::<Option<Vec<_>>>()?.concat())
        })?;
        let person = self.person_during(path.iter().map(|grasp| (robot.link_poses(&grasp.arms), grasp)));
        let joints = |grasp: &BoardGrasp| grasp.arms.iter().flat_map(|arm| arm.q_rad.clone()).collect();
        let arms: Vec<_> = (0..robot.arms.len()).collect();
        let Timed { time_s, q, .. } = self.timed(&path.iter().map(joints).collect::<Vec<_>>(), &arms)?;
        let mut first_joint = 0;
        let of_arm = |arm: usize| {
            let joints = first_joint..first_joint + robot.arms[arm].chain.dof();
            first_joint = joints.end;
            ArmPath {
                name: robot.arms[arm].name.clone(),
                q_rad: q.iter().map(|q_rad| q_rad[joints.clone()].to_vec()).collect(),
            }
        };
        let stage = MoveStage { person, arms: arms.into_iter().map(of_arm).collect(), time_s };
        self.stages.push(Stage::Move(stage));
        Some(())
    }

    fn regrasp(&self, change: &HandChange, path: &[Vec<f64>], after: &BoardGrasp) -> Option<RegraspStage> {
        let &HandChange { arm, ref before, .. } = change;
        let robot = self.search.robot;
        let with = |q_rad: &Vec<f64>| {
            let mut arms = before.arms.clone();
            arms[arm] = ArmGrasp { grasp: after.arms[arm].grasp, q_rad: q_rad.clone() };
            arms
        };
        let person = self.person_during(path.iter().map(|q_rad| (robot.link_poses(&with(q_rad)), before)));
        let Timed { time_s, q, .. } = self.timed(path, &[arm])?;
        let problem = self.transitions.problem.of_piece(0);
        let hold = plan_arms(problem, &Candidate::without_person(after)).swap_remove(arm);
        Some(RegraspStage {
            person,
            time_s,
            arm: ArmPath { name: hold.name, q_rad: q },
            x_og: hold.x_og,
            grip_force_n: hold.grip_force_n,
        })
    }

    /// What the person does while links and board are at these poses: they stay if nothing comes near them.
    fn person_during<'g>(&self, mut poses: impl Iterator<Item = (Vec<Pose>, &'g BoardGrasp)>) -> PersonDuring {
        let Some((piece, posture)) = self.last else { return PersonDuring::StepsBack };
        let problem = self.transitions.problem.of_piece(piece);
        let person = problem.human.capsules_w(&posture.x_wb, &posture.q_h_rad).map(PersonPart::from);
        let touched = poses.any(|(link_poses, grasp)| {
            let scene = Scene { person: &person, ..problem.robot.scene(&link_poses, grasp.x_wo) };
            problem.robot.collision.first_violation_of_person(&scene).is_some()
        });
        if touched { PersonDuring::StepsBack } else { PersonDuring::Stays }
    }

    /// The timing of a path of the joints of these arms.
    fn timed(&self, path: &[Vec<f64>], arms: &[usize]) -> Option<Timed> {
        let robot = &self.search.robot.robot;
        let motion = &self.search.task.motion;
        let joints = arms.iter().flat_map(|&arm| &robot.arms[self.search.robot.arms[arm].index].joints);
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
}
