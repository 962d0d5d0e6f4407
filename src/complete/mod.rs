//! Joint angles for grippers whose poses are given: what a plan of a grasp planner leaves open.
//!
//! An arm reaches a pose in many ways, or in none. Of the combinations of all arms' answers the one nearest to given angles is
//! taken in which no bodies meet. The module does not know files, comfort or stability.

use crate::{
    collision::{BoardBody, CollisionModel, PersonPart, Scene, Violation},
    model::{board::BoardShape, frames::Pose},
    robot::{
        ArmState, Chain, InverseKinematics, Robot, Solution,
        bimanual::{Combinations, RankedSolutions},
    },
};

/// How many answers are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Slices or starts of the inverse kinematics of an arm, as [`InverseKinematics::samples`] has them.
    pub samples: usize,
    /// Combinations of the arms' answers that are tested for contacts.
    pub combinations: usize,
}

impl Effort {
    /// For one plan: the slices are about 0.05 rad apart. Takes up to a second if no combination is free.
    pub const THOROUGH: Self = Self { samples: 64, combinations: 10_000 };
    /// For one of many poses of the board.
    pub const QUICK: Self = Self { samples: 12, combinations: 200 };
}

/// An arm, and what is known of it.
#[derive(Clone, Debug)]
pub struct ArmTask {
    /// Index into [`Robot::arms`].
    pub arm: usize,
    /// What is known.
    pub target: Target,
}

/// What is known of an arm.
#[derive(Clone, Debug)]
pub enum Target {
    /// Its joint angles, rad.
    Angles(Vec<f64>),
    /// The pose of its gripper.
    Gripper {
        /// X_WG.
        x_wg: Pose,
        /// The angles to be near to, rad; `None` for the middle of the joint ranges.
        seed_rad: Option<Vec<f64>>,
    },
}

/// The angles of all arms.
#[derive(Clone, Debug)]
pub struct Reached {
    /// The angles of each task, rad.
    pub q_rad: Vec<Vec<f64>>,
    /// The first contact; `None` if the angles are free of contacts. With a contact, none of the combinations that were tested
    /// was free, and this is the one nearest to the seeds.
    pub contact: Option<Violation>,
}

/// The angles of all arms, or why there are none.
#[derive(Clone, Debug)]
pub enum Completion {
    /// Every arm reaches its pose.
    Found(Reached),
    /// A pose is farther from the arm's first joint than its reach.
    OutOfReach {
        /// Index of the task.
        task: usize,
        /// Distance of the gripper from the first joint, m.
        distance_m: f64,
        /// The arm's reach, m.
        reach_m: f64,
    },
    /// No angles within the limits were found for a pose.
    NotFound {
        /// Index of the task.
        task: usize,
    },
}

impl Completion {
    /// The angles.
    ///
    /// # Errors
    /// The index of the task whose pose is not reached, and what was found, in words.
    pub fn reached(self) -> Result<Reached, (usize, String)> {
        match self {
            Self::Found(reached) => Ok(reached),
            Self::OutOfReach { task, distance_m, reach_m } => Err((
                task,
                format!("a gripper {distance_m:.3} m from the shoulder of an arm that reaches at most {reach_m:.3} m"),
            )),
            Self::NotFound { task } => Err((task, "a pose without an answer of the inverse kinematics".into())),
        }
    }
}

/// Finds the angles of a robot's arms.
pub struct Completer<'a> {
    robot: &'a Robot,
    board: BoardBody,
    chains: Vec<Chain>,
    solvers: Vec<InverseKinematics>,
    collision: CollisionModel,
}

impl<'a> Completer<'a> {
    /// For a robot whose fingers close on this board.
    #[must_use]
    pub fn new(robot: &'a Robot, board: &BoardShape) -> Self {
        let travel_m = |arm: usize| robot.arms[arm].gripper.travel_for_gap_m(0, board.thickness_m());
        let chains: Vec<_> = (0..robot.arms.len()).map(|arm| Chain::new(robot, arm, travel_m(arm))).collect();
        let solvers = chains.iter().map(InverseKinematics::for_chain).collect();
        Self { robot, board: BoardBody::new(board), chains, solvers, collision: CollisionModel::new(robot) }
    }

    /// The arms' chains, in the order of [`Robot::arms`].
    #[must_use]
    pub fn chains(&self) -> &[Chain] {
        &self.chains
    }

    /// The angles of arms that hold the board at `x_wo`: of the combinations without a contact the one with the least sum of
    /// squared differences from the seeds, as far as they are tested. `clearance_m` is that of the robot from itself and from
    /// the board. The same arguments give the same angles.
    #[must_use]
    pub fn complete(
        &self,
        tasks: &[ArmTask],
        x_wo: &Pose,
        person: &[PersonPart],
        clearance_m: f64,
        effort: Effort,
    ) -> Completion {
        let mut answers = Vec::with_capacity(tasks.len());
        for (number, task) in tasks.iter().enumerate() {
            match self.answers(task, effort.samples) {
                Ok(found) => answers.push(found),
                Err(Solution::OutOfReach { distance_m, reach_m }) => {
                    return Completion::OutOfReach { task: number, distance_m, reach_m };
                }
                Err(_) => return Completion::NotFound { task: number },
            }
        }
        let mut nearest: Option<Reached> = None;
        for combination in Combinations::new(&answers).take(effort.combinations) {
            let contact = self.contact(tasks, &combination.q_rad, x_wo, person, clearance_m);
            let q_rad = || combination.q_rad.iter().map(|q_rad| q_rad.to_vec()).collect();
            match (contact, &nearest) {
                (None, _) => return Completion::Found(Reached { q_rad: q_rad(), contact: None }),
                (Some(contact), None) => nearest = Some(Reached { q_rad: q_rad(), contact: Some(contact) }),
                (Some(_), Some(_)) => {}
            }
        }
        // Every task has an answer, so there is a combination unless there are no tasks.
        Completion::Found(nearest.unwrap_or_else(|| Reached { q_rad: Vec::new(), contact: None }))
    }

    /// As [`Completer::complete`]: the angles with the clearance; else those without a contact, else the nearest.
    #[must_use]
    pub fn complete_with_clearance(
        &self,
        tasks: &[ArmTask],
        x_wo: &Pose,
        person: &[PersonPart],
        clearance_m: f64,
        effort: Effort,
    ) -> Completion {
        match self.complete(tasks, x_wo, person, clearance_m, effort) {
            Completion::Found(Reached { contact: Some(_), .. }) if clearance_m > 0.0 => {
                self.complete(tasks, x_wo, person, 0.0, effort)
            }
            completion => completion,
        }
    }

    /// The answers of one arm, nearest to its seed first; not empty.
    fn answers(&self, task: &ArmTask, samples: usize) -> Result<RankedSolutions, Solution> {
        let (x_wg, seed_rad) = match &task.target {
            Target::Angles(q_rad) => return Ok(RankedSolutions::new([q_rad.clone()], |_| 0.0)),
            Target::Gripper { x_wg, seed_rad } => (x_wg, seed_rad),
        };
        let (chain, solver) = (&self.chains[task.arm], &self.solvers[task.arm]);
        let seed_rad = seed_rad.clone().unwrap_or_else(|| middle_rad(chain));
        let local = solver.local(x_wg, &seed_rad);
        if matches!(local, Solution::OutOfReach { .. } | Solution::Malformed) {
            return Err(local);
        }
        let all = local.clone().found().into_iter().chain(solver.samples(x_wg, samples));
        let squared = |q_rad: &[f64]| q_rad.iter().zip(&seed_rad).map(|(q, seed)| (q - seed).powi(2)).sum();
        let ranked = RankedSolutions::new(all, squared);
        if ranked.is_empty() { Err(local) } else { Ok(ranked) }
    }

    /// The first contact with these angles of each task.
    fn contact(
        &self,
        tasks: &[ArmTask],
        q_rad: &[&[f64]],
        x_wo: &Pose,
        person: &[PersonPart],
        clearance_m: f64,
    ) -> Option<Violation> {
        let arms = tasks.iter().zip(q_rad).map(|(task, &q_rad)| {
            let gripper = &self.robot.arms[task.arm].gripper;
            let finger_travel_m = [0, 1].map(|finger| gripper.travel_for_gap_m(finger, self.board.thickness_m()));
            ArmState { arm: task.arm, q_rad, finger_travel_m }
        });
        let arms: Vec<_> = arms.collect();
        self.collision.first_violation(&Scene {
            link_poses: &self.robot.link_poses(&self.robot.positions(&arms)),
            holding: &tasks.iter().map(|task| task.arm).collect::<Vec<_>>(),
            board: &self.board,
            x_wo: *x_wo,
            person,
            clearance_m,
        })
    }
}

/// The middle of each joint's range, rad.
fn middle_rad(chain: &Chain) -> Vec<f64> {
    chain.lower().iter().zip(chain.upper()).map(|(low, high)| f64::midpoint(*low, *high)).collect()
}

#[cfg(test)]
mod tests;
