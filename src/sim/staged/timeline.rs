//! What arms, grippers and tool do over the time of a staged plan (docs/method.md#114-simulation-of-stages).
//!
//! A stage is a row of segments. In each of them every arm follows a joint path, or stays, while the torques that it feeds forward
//! and the share of its grip force change linearly.

use nalgebra::Vector3;

use super::{
    super::{phases::grip_steps, tool_load::ToolState},
    arms::CarriedBy,
    segment::{ArmCommand, ArmSegment, Knot, NewGrasp},
};
use crate::model::{
    frames::Pose,
    plan::ArmHold,
    scenario::SimulationSettings,
    staged_plan::{HoldStage, Holding, MoveStage, RegraspStage, Stage, StagedPlan},
    task::Task,
    tool_path::Piece,
    trace::Phase,
    wrench::Wrench,
};

/// Time for which the arms hold the board still before a tool works on it, s: their swing after a motion has died away.
const STILL_S: f64 = 0.4;

/// Time after the tool has left the board, s.
const LIFTED_S: f64 = 0.2;

/// Time in which the weight goes from one distribution among the hands to another, s, as in the hand-over at the start.
const SHIFT_S: f64 = 0.3;

/// Time in which a gripper opens, s.
const OPEN_S: f64 = 0.4;

/// Share of its grip force with which a gripper opens: against the dampers of the fingers some cm/s.
const OPEN_SHARE: f64 = -0.15;

/// Share of its grip force with which a gripper closes on the board: some cm/s. With three times as much its knock shakes the other
/// hand's pads (chatter of 0.12).
const CLOSE_SHARE: f64 = 0.05;

/// Time in which a gripper closes on the board, s; then its force grows.
const CLOSE_S: f64 = 0.8;

/// Time in which the force of a closed gripper grows, s.
const GRIP_S: f64 = 0.1;

/// What happens in a step.
#[derive(Clone, Debug)]
pub struct Command {
    /// The number of the stage.
    pub stage: usize,
    /// The piece that is worked on last or next.
    pub piece: usize,
    /// The phase.
    pub phase: Phase,
    /// Every arm of the plan.
    pub arms: Vec<ArmCommand>,
    /// The tool.
    pub tool: ToolState,
    /// The planned pose of the board.
    pub x_wo: Pose,
    /// The grasp by which an arm grips the board from this step on.
    pub regrips: Option<NewGrasp>,
}

/// What the tool does in a part of a stage.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    pub stroke: usize,
    /// The lengths along the stroke from which and to which the tool works, m.
    pub along_m: [f64; 2],
    /// The load factor at both ends.
    pub load_factor: [f64; 2],
}

/// A part of a stage.
#[derive(Clone, Debug)]
pub struct Segment {
    pub stage: usize,
    pub piece: usize,
    pub phase: Phase,
    pub duration_s: f64,
    pub arms: Vec<ArmSegment>,
    /// The planned poses of the board at the knots of a motion; one if it stays.
    pub x_wo: Vec<Pose>,
    pub work: Option<Work>,
    pub regrips: Option<NewGrasp>,
}

/// All segments of a plan.
pub struct Timeline<'a> {
    task: &'a Task,
    thickness_m: f64,
    rolls_rad: Vec<f64>,
    segments: Vec<Segment>,
    /// The number of steps of every segment.
    steps: Vec<usize>,
}

impl<'a> Timeline<'a> {
    /// The timeline of a plan whose board is held like this before each stage.
    pub fn new(
        plan: &'a StagedPlan,
        holdings: &[Holding],
        carried: &CarriedBy<'_>,
        settings: &SimulationSettings,
    ) -> Self {
        let mut builder = Builder { carried, settings, task: &plan.task, segments: Vec::new(), piece: 0 };
        for (number, (stage, holding)) in plan.stages.iter().zip(holdings).enumerate() {
            if number == 0 {
                // The scene's grippers close in these steps, and its arms take over the weight.
                let grip_s = grip_steps(settings) as f64 * settings.timestep_s;
                builder.still(Phase::Grip, 0, holding, grip_s);
                builder.still(Phase::Settle, 0, holding, settings.settle_s - grip_s);
            }
            match stage {
                Stage::Hold(hold) => builder.hold(number, holding, hold),
                Stage::Move(motion) => builder.motion(number, holding, motion),
                Stage::Regrasp(regrasp) => builder.regrasp(number, [holding, &holdings[number + 1]], regrasp),
            }
        }
        let segments = builder.segments;
        let steps = |segment: &Segment| ((segment.duration_s / settings.timestep_s).round() as usize).max(1);
        let steps = segments.iter().map(steps).collect();
        let rolls_rad = plan.worked_pieces().map(|(_, worked)| worked.roll_rad.unwrap_or(0.0)).collect();
        Self { task: &plan.task, thickness_m: plan.object.size_m[2], rolls_rad, segments, steps }
    }

    /// The number of steps.
    pub fn steps(&self) -> usize {
        self.steps.iter().sum()
    }

    /// What happens in each step.
    pub fn commands(&self) -> impl Iterator<Item = Command> {
        self.segments.iter().zip(&self.steps).flat_map(move |(segment, &steps)| {
            (1..=steps).map(move |step| Command {
                regrips: segment.regrips.filter(|_| step == 1),
                ..self.command(segment, step as f64 / steps as f64)
            })
        })
    }

    /// What happens after a share of a segment.
    fn command(&self, segment: &Segment, share: f64) -> Command {
        let time_s = share * segment.duration_s;
        Command {
            stage: segment.stage,
            piece: segment.piece,
            phase: segment.phase,
            arms: segment.arms.iter().map(|arm| arm.at(time_s, share)).collect(),
            tool: self.tool(segment, share),
            x_wo: board_at(segment, time_s),
            regrips: None,
        }
    }

    fn tool(&self, segment: &Segment, share: f64) -> ToolState {
        let none = ToolState { load_factor: 0.0, wrench_o: Wrench::default(), p_ot_m: Vector3::zeros() };
        let Some(work) = segment.work else { return none };
        let at_share = |[from, to]: [f64; 2]| from + share * (to - from);
        let along_m = at_share(work.along_m);
        let Some(operation) = self.task.operation_at(work.stroke, along_m, self.thickness_m) else { return none };
        let operation = operation.rolled(self.rolls_rad.get(segment.piece).copied().unwrap_or(0.0));
        let load_factor = at_share(work.load_factor);
        let wrench_o = operation.wrench_o.scaled(load_factor);
        ToolState { load_factor, wrench_o, p_ot_m: operation.x_ot.translation.vector }
    }
}

/// The planned pose of the board.
fn board_at(segment: &Segment, time_s: f64) -> Pose {
    let knots = segment.arms.first().map_or(&[][..], |arm| &arm.knots);
    let next = knots.partition_point(|knot| knot.time_s <= time_s).min(segment.x_wo.len() - 1);
    match next.checked_sub(1) {
        Some(last) if next < knots.len() && knots[next].time_s > knots[last].time_s => {
            let share = (time_s - knots[last].time_s) / (knots[next].time_s - knots[last].time_s);
            let share = share.clamp(0.0, 1.0);
            segment.x_wo[last].try_lerp_slerp(&segment.x_wo[next], share, 1e-9).unwrap_or(segment.x_wo[next])
        }
        _ => segment.x_wo[next],
    }
}

/// Builds segments.
struct Builder<'b, 'a> {
    carried: &'b CarriedBy<'a>,
    settings: &'b SimulationSettings,
    task: &'b Task,
    segments: Vec<Segment>,
    /// The next piece.
    piece: usize,
}

impl Builder<'_, '_> {
    /// All arms as they hold the board, for a time; torques go from one distribution to another.
    fn resting(&self, holding: &Holding, duration_s: f64, from: &[Vec<f64>], to: &[Vec<f64>]) -> Vec<ArmSegment> {
        let arm = |(number, hold): (usize, &ArmHold)| {
            let arm_nm = self.carried.arm_nm(number, &hold.q_rad);
            let knot = |time_s: f64, board_nm: &Vec<f64>| Knot {
                time_s,
                q_rad: hold.q_rad.clone(),
                arm_nm: arm_nm.clone(),
                board_nm: board_nm.clone(),
            };
            ArmSegment { knots: vec![knot(0.0, &from[number]), knot(duration_s, &to[number])], grip: [1.0; 2] }
        };
        holding.arms.iter().enumerate().map(arm).collect()
    }

    /// Adds a segment in which no tool works.
    fn push(
        &mut self,
        stage: usize,
        phase: Phase,
        duration_s: f64,
        arms: Vec<ArmSegment>,
        x_wo: Vec<Pose>,
    ) -> &mut Segment {
        let piece = self.piece;
        let number = self.segments.len();
        self.segments.push(Segment { stage, piece, phase, duration_s, arms, x_wo, work: None, regrips: None });
        &mut self.segments[number]
    }

    fn still(&mut self, phase: Phase, stage: usize, holding: &Holding, duration_s: f64) {
        let board_nm = self.carried.board_nm(holding, None);
        let arms = self.resting(holding, duration_s, &board_nm, &board_nm);
        self.push(stage, phase, duration_s, arms, vec![holding.x_wo]);
    }

    /// The tool is put on, works along pieces without a corner, and is lifted.
    fn hold(&mut self, stage: usize, holding: &Holding, hold: &HoldStage) {
        self.still(Phase::Settle, stage, holding, STILL_S);
        let board_nm = self.carried.board_nm(holding, None);
        let pieces: Vec<Piece> = hold.pieces.iter().map(|worked| worked.piece).collect();
        let mut first = 0;
        for number in 0..pieces.len() {
            let goes_on = pieces.get(number + 1).is_some_and(|next| {
                next.stroke == pieces[number].stroke
                    && !self.task.path[next.stroke].has_corner_at(next.from_m)
                    && next.to_m > next.from_m
            });
            if goes_on {
                continue;
            }
            self.run(stage, holding, &board_nm, &pieces[first..=number]);
            first = number + 1;
        }
    }

    /// Works on pieces of one stroke without lifting the tool.
    fn run(&mut self, stage: usize, holding: &Holding, board_nm: &[Vec<f64>], pieces: &[Piece]) {
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else { return };
        let (stroke, begin_m, end_m) = (first.stroke, first.from_m, last.to_m);
        let ramp_s = self.settings.ramp_s;
        let mut parts = vec![(Phase::Ramp, ramp_s, [begin_m; 2], [0.0, 1.0], 0)];
        for (number, piece) in pieces.iter().enumerate() {
            let is_hole = end_m == begin_m;
            let duration_s = if is_hole { self.settings.hold_s } else { piece.length_m() / self.task.speed_m_s };
            parts.push((Phase::Hold, duration_s, [piece.from_m, piece.to_m], [1.0; 2], number));
        }
        parts.push((Phase::Release, LIFTED_S, [end_m; 2], [0.0; 2], pieces.len() - 1));
        let first_piece = self.piece;
        for (phase, duration_s, along_m, load_factor, number) in parts {
            self.piece = first_piece + number;
            let arms = self.resting(holding, duration_s, board_nm, board_nm);
            let segment = self.push(stage, phase, duration_s, arms, vec![holding.x_wo]);
            segment.work = Some(Work { stroke, along_m, load_factor });
        }
        self.piece = first_piece + pieces.len();
    }

    fn motion(&mut self, stage: usize, holding: &Holding, motion: &MoveStage) {
        let (arms, x_wo) = self.carried.along(holding, motion);
        let duration_s = motion.time_s.last().copied().unwrap_or(0.0);
        self.push(stage, Phase::Move, duration_s, arms, x_wo);
    }

    fn regrasp(&mut self, stage: usize, [before, after]: [&Holding; 2], regrasp: &RegraspStage) {
        let Some(arm) = before.arms.iter().position(|hold| hold.name == regrasp.arm.name) else { return };
        let shared_nm = self.carried.board_nm(before, None);
        let alone_nm = self.carried.board_nm(before, Some(arm));
        let then_nm = self.carried.board_nm(after, None);
        let x_wo = vec![before.x_wo];
        let with_grip = |builder: &mut Self, holding: &Holding, duration_s: f64, torques: [&[Vec<f64>]; 2], grip| {
            let mut arms = builder.resting(holding, duration_s, torques[0], torques[1]);
            arms[arm].grip = grip;
            builder.push(stage, Phase::Regrasp, duration_s, arms, x_wo.clone());
        };
        with_grip(self, before, SHIFT_S, [&shared_nm, &alone_nm], [1.0; 2]);
        with_grip(self, before, OPEN_S, [&alone_nm, &alone_nm], [OPEN_SHARE; 2]);
        let duration_s = regrasp.time_s.last().copied().unwrap_or(0.0);
        let mut arms = self.resting(before, duration_s, &alone_nm, &alone_nm);
        arms[arm] = self.carried.free_path(arm, &regrasp.time_s, &regrasp.arm.q_rad);
        arms[arm].grip = [OPEN_SHARE; 2];
        self.push(stage, Phase::Regrasp, duration_s, arms, x_wo.clone());
        with_grip(self, after, CLOSE_S, [&alone_nm, &alone_nm], [CLOSE_SHARE; 2]);
        if let Some(closing) = self.segments.last_mut() {
            closing.regrips = Some(NewGrasp { arm, x_og: regrasp.x_og, grip_force_n: regrasp.grip_force_n });
        }
        with_grip(self, after, GRIP_S, [&alone_nm, &alone_nm], [CLOSE_SHARE, 1.0]);
        with_grip(self, after, SHIFT_S, [&alone_nm, &then_nm], [1.0; 2]);
    }
}
