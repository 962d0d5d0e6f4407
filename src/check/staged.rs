//! A staged plan that fits its robot: how the board is held before each stage, and a plan for each worked piece.

use super::tolerances::{GIVEN, LIMIT_RAD};
use crate::{
    model::{
        FORMAT,
        frames::Pose,
        operation::Operation,
        plan::{ArmHold, PlacedObject, Plan},
        staged_plan::{ArmPath, HoldStage, Holding, MoveStage, RegraspStage, Stage, StagedPlan, WorkedPiece},
        task::Task,
        tool_path::Stroke,
    },
    robot::{Chain, Robot},
};

/// Rounding of written lengths along the path, m.
const ROUNDING_M: f64 = 1e-6;

/// The plan of a worked piece.
#[derive(Clone, Debug)]
pub struct PiecePlan {
    /// The number of its stage.
    pub stage: usize,
    /// Its number in the stage.
    pub number: usize,
    /// The plan.
    pub plan: Plan,
}

/// What is wrong with a staged plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key}: found {found}, expected {expected}")]
pub struct StagedFlaw {
    /// The key.
    pub key: String,
    /// What was found.
    pub found: String,
    /// What was expected.
    pub expected: String,
}

/// A staged plan without flaws of its form, with what follows from it by kinematics.
#[derive(Clone, Debug)]
pub struct StagedStates {
    /// How the board is held before each stage, and after the last one.
    pub holdings: Vec<Holding>,
    /// The plans of all worked pieces in their order.
    pub pieces: Vec<PiecePlan>,
}

fn flaw<T>(key: impl Into<String>, found: impl ToString, expected: impl ToString) -> Result<T, StagedFlaw> {
    Err(StagedFlaw { key: key.into(), found: found.to_string(), expected: expected.to_string() })
}

/// The hold at the start as a plan for where the path begins, without a person; `None` if the task has no path.
#[must_use]
pub fn initial_plan(plan: &StagedPlan) -> Option<Plan> {
    let operation = plan.task.operation_at(0, 0.0, plan.object.size_m[2])?;
    Some(of_holding(plan, &Holding { x_wo: plan.object.x_wo, arms: plan.arms.clone() }, operation))
}

impl StagedStates {
    /// The states of a plan: the arms end a motion where its path ends, and the board goes with the first arm's hand.
    ///
    /// # Errors
    /// The first flaw: a path that does not begin where the arms are, does not keep the hands on the board, leaves the joint limits
    /// or has times that do not increase; an arm that is not known; pieces that are not those of the task in their order.
    pub fn new(robot: &Robot, plan: &StagedPlan) -> Result<Self, StagedFlaw> {
        let mut here = Holding { x_wo: plan.object.x_wo, arms: plan.arms.clone() };
        if here.arms.is_empty() {
            return flaw("arms", "none", "at least one arm");
        }
        let mut holdings = vec![here.clone()];
        let mut pieces = Vec::new();
        let mut order = PathOrder::default();
        for (number, stage) in plan.stages.iter().enumerate() {
            let key = |of: &str| format!("stages[{number}].{}.{of}", stage.name());
            match stage {
                Stage::Hold(hold) => pieces.extend(held(plan, &here, (number, hold), &mut order)?),
                Stage::Move(motion) => here = moved(robot, plan, &here, motion, key)?,
                Stage::Regrasp(regrasp) => here = regrasped(robot, plan, &here, regrasp, key)?,
            }
            holdings.push(here.clone());
        }
        order.finished(&plan.task)?;
        Ok(Self { holdings, pieces })
    }
}

/// How far the path has been worked on.
#[derive(Default)]
struct PathOrder {
    stroke: usize,
    along_m: f64,
    /// True if the present stroke has been begun.
    begun: bool,
}

impl PathOrder {
    /// Goes on with a piece.
    fn go_on(&mut self, task: &Task, worked: &WorkedPiece, key: &str) -> Result<(), StagedFlaw> {
        let piece = worked.piece;
        let length_m = |stroke: usize| task.path.get(stroke).map(Stroke::length_m);
        let is_over = self.begun && length_m(self.stroke).is_none_or(|length_m| self.along_m >= length_m - ROUNDING_M);
        if is_over {
            *self = Self { stroke: self.stroke + 1, along_m: 0.0, begun: false };
        }
        let Some(length_m) = length_m(piece.stroke) else {
            return flaw(format!("{key}.stroke"), piece.stroke, format!("a stroke from 0 to {}", task.path.len() - 1));
        };
        let goes_on = piece.stroke == self.stroke && (piece.from_m - self.along_m).abs() <= ROUNDING_M;
        if !goes_on {
            let found = format!("a piece from {} m of stroke {}", piece.from_m, piece.stroke);
            return flaw(key, found, format!("one from {} m of stroke {}", self.along_m, self.stroke));
        }
        let has_length = if length_m == 0.0 { piece.length_m() == 0.0 } else { piece.length_m() > 0.0 };
        if !has_length || piece.to_m > length_m + ROUNDING_M {
            return flaw(format!("{key}.to_m"), piece.to_m, format!("more than from_m and at most {length_m} m"));
        }
        *self = Self { stroke: piece.stroke, along_m: piece.to_m, begun: true };
        Ok(())
    }

    /// Requires that the whole path has been worked on.
    fn finished(&self, task: &Task) -> Result<(), StagedFlaw> {
        let last = task.path.len().saturating_sub(1);
        let length_m = task.path.last().map_or(0.0, Stroke::length_m);
        if self.begun && self.stroke == last && self.along_m >= length_m - ROUNDING_M {
            return Ok(());
        }
        let found = format!("pieces up to {} m of stroke {}", self.along_m, self.stroke);
        flaw("stages", found, format!("pieces up to the end of stroke {last}"))
    }
}

/// The plan of a hold for an operation, without a person.
fn of_holding(plan: &StagedPlan, here: &Holding, operation: Operation) -> Plan {
    Plan {
        format: FORMAT,
        name: plan.name.clone(),
        robot: plan.robot.clone(),
        operation,
        object: PlacedObject { x_wo: here.x_wo, ..plan.object.clone() },
        arms: here.arms.clone(),
        human: None,
        comfort: None,
        muscles: None,
        stability: None,
        clearance: None,
        planner: plan.planner,
        scenario: None,
        benchdog: None,
    }
}

/// The plans of a hold's pieces.
fn held(
    plan: &StagedPlan,
    here: &Holding,
    (stage, hold): (usize, &HoldStage),
    order: &mut PathOrder,
) -> Result<Vec<PiecePlan>, StagedFlaw> {
    if hold.pieces.is_empty() {
        return flaw(format!("stages[{stage}].hold.pieces"), "none", "at least one piece");
    }
    let of_piece = |(number, worked): (usize, &WorkedPiece)| {
        let key = format!("stages[{stage}].hold.pieces[{number}].piece");
        order.go_on(&plan.task, worked, &key)?;
        let thickness_m = plan.object.size_m[2];
        let operation = plan.task.operation_of(&worked.piece, thickness_m);
        let Some(mut operation) = operation else { return flaw(key, worked.piece.stroke, "a stroke of the task") };
        if let (true, Some(roll_rad)) = (operation.kind.roll_is_free(), worked.roll_rad) {
            operation = operation.rolled(roll_rad);
        }
        let of_plan = Plan {
            name: format!("{}-stage-{}-piece-{}", plan.name, stage + 1, number + 1),
            human: worked.human,
            comfort: worked.comfort,
            muscles: worked.muscles.clone(),
            stability: worked.stability.clone(),
            ..of_holding(plan, here, operation)
        };
        Ok(PiecePlan { stage, number, plan: of_plan })
    };
    hold.pieces.iter().enumerate().map(of_piece).collect()
}

/// How the board is held after a motion.
fn moved(
    robot: &Robot,
    plan: &StagedPlan,
    here: &Holding,
    motion: &MoveStage,
    key: impl Fn(&str) -> String,
) -> Result<Holding, StagedFlaw> {
    let names = |arms: &mut dyn Iterator<Item = &String>| arms.cloned().collect::<Vec<_>>().join(", ");
    let found = names(&mut motion.arms.iter().map(|arm| &arm.name));
    let expected = names(&mut here.arms.iter().map(|arm| &arm.name));
    if found != expected {
        return flaw(key("arms"), found, expected);
    }
    let mut chains = Vec::new();
    for (number, (path, hold)) in motion.arms.iter().zip(&here.arms).enumerate() {
        let key = |of: &str| key(&format!("arms[{number}].{of}"));
        chains.push(check_path(robot, plan, path, &motion.time_s, &hold.q_rad, key)?);
    }
    check_times(&motion.time_s, &key)?;
    let mut x_wo = here.x_wo;
    for row in 0..motion.time_s.len() {
        let poses = chains.iter().zip(&motion.arms).zip(&here.arms);
        let boards: Vec<_> =
            poses.map(|((chain, path), hold)| chain.gripper_pose(&path.q_rad[row]) * hold.x_og.inverse()).collect();
        let Some(first) = boards.first() else { continue };
        let off = |other: &Pose| {
            [(first.translation.vector - other.translation.vector).norm(), first.rotation.angle_to(&other.rotation)]
        };
        if let Some((arm, other)) = boards.iter().enumerate().find(|(_, other)| !GIVEN.allows(off(other))) {
            let [off_m, off_rad] = off(other);
            let found = format!("hands {off_m:.4} m and {off_rad:.4} rad apart from where they hold the board");
            return flaw(key(&format!("arms[{arm}].q_rad[{row}]")), found, "hands that keep their grasps");
        }
        x_wo = *first;
    }
    let ended = here.arms.iter().zip(&motion.arms).map(|(hold, path)| ArmHold {
        q_rad: path.q_rad.last().cloned().unwrap_or_else(|| hold.q_rad.clone()),
        ..hold.clone()
    });
    Ok(Holding { x_wo, arms: ended.collect() })
}

/// How the board is held after a regrasp.
fn regrasped(
    robot: &Robot,
    plan: &StagedPlan,
    here: &Holding,
    regrasp: &RegraspStage,
    key: impl Fn(&str) -> String,
) -> Result<Holding, StagedFlaw> {
    let Some(arm) = here.arms.iter().position(|hold| hold.name == regrasp.arm.name) else {
        let known: Vec<_> = here.arms.iter().map(|hold| hold.name.clone()).collect();
        return flaw(key("arm.name"), format!("\"{}\"", regrasp.arm.name), known.join(" or "));
    };
    if here.arms.len() < 2 {
        return flaw(key("arm"), "the only arm that holds the board", "another arm that holds it meanwhile");
    }
    let in_arm = |of: &str| key(&format!("arm.{of}"));
    let chain = check_path(robot, plan, &regrasp.arm, &regrasp.time_s, &here.arms[arm].q_rad, in_arm)?;
    check_times(&regrasp.time_s, &key)?;
    let q_rad = regrasp.arm.q_rad.last().cloned().unwrap_or_default();
    let (reached, wanted) = (chain.gripper_pose(&q_rad), here.x_wo * regrasp.x_og);
    let off =
        [(reached.translation.vector - wanted.translation.vector).norm(), reached.rotation.angle_to(&wanted.rotation)];
    if !GIVEN.allows(off) {
        let found = format!("a gripper {:.4} m and {:.4} rad from it", off[0], off[1]);
        return flaw(key("x_og"), found, "the pose where the path ends");
    }
    let mut after = here.clone();
    after.arms[arm] =
        ArmHold { q_rad, x_og: regrasp.x_og, grip_force_n: regrasp.grip_force_n, ..here.arms[arm].clone() };
    Ok(after)
}

/// Requires times from 0 that increase.
fn check_times(time_s: &[f64], key: impl Fn(&str) -> String) -> Result<(), StagedFlaw> {
    let first = time_s.first().copied().unwrap_or(f64::NAN);
    if first != 0.0 {
        return flaw(key("time_s[0]"), first, "0");
    }
    match time_s.windows(2).position(|pair| !(pair[1] > pair[0] && pair[1].is_finite())) {
        Some(row) => {
            flaw(key(&format!("time_s[{}]", row + 1)), time_s[row + 1], format!("a time after {}", time_s[row]))
        }
        None => Ok(()),
    }
}

/// The chain of an arm whose path begins at these angles and stays within the joint limits.
fn check_path(
    robot: &Robot,
    plan: &StagedPlan,
    path: &ArmPath,
    time_s: &[f64],
    from_rad: &[f64],
    key: impl Fn(&str) -> String,
) -> Result<Chain, StagedFlaw> {
    let Some(arm) = robot.arm_index(&path.name) else {
        let known: Vec<_> = robot.arms.iter().map(|arm| arm.name.clone()).collect();
        return flaw(key("name"), format!("\"{}\"", path.name), known.join(" or "));
    };
    let gripper = &robot.arms[arm].gripper;
    let chain = Chain::new(robot, arm, gripper.travel_for_gap_m(0, plan.object.size_m[2]));
    if path.q_rad.len() != time_s.len() || path.q_rad.is_empty() {
        return flaw(
            key("q_rad"),
            format!("{} rows", path.q_rad.len()),
            format!("{}, one a time", time_s.len().max(1)),
        );
    }
    for (row, q_rad) in path.q_rad.iter().enumerate() {
        let key = || key(&format!("q_rad[{row}]"));
        if q_rad.len() != chain.dof() {
            return flaw(key(), format!("{} angles", q_rad.len()), format!("{}, one a joint", chain.dof()));
        }
        if !q_rad.iter().all(|q| q.is_finite()) || !chain.within_limits(q_rad, LIMIT_RAD) {
            return flaw(key(), format!("{q_rad:.3?}"), "angles within the joint limits");
        }
    }
    let off_rad = path.q_rad[0].iter().zip(from_rad).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if off_rad > GIVEN.rotation_rad {
        return flaw(key("q_rad[0]"), format!("{off_rad:.4} rad from where the arm is"), "where the arm is");
    }
    Ok(chain)
}
