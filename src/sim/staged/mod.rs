//! The simulation of a staged plan: one scene in which servo targets move, fingers open and close, and the tool travels
//! (docs/method.md#114-simulation-of-stages).

mod arms;
mod segment;
mod timeline;

use nalgebra::Vector3;

use super::{Conditions, SimError, SimScene, blank_sample, distance_monitor::DistanceMonitor, empty_trace};
use crate::{
    check::{CheckedPlan, StagedStates},
    collision::PersonPart,
    human::place,
    model::{
        staged_plan::{PersonDuring, Stage, StagedPlan},
        staged_trace::{StageSpan, StagedTrace},
        stop::Stop,
        trace::Trace,
    },
};
use arms::CarriedBy;
pub(super) use segment::ArmCommand;
use timeline::{Command, Timeline};

/// Simulates a staged plan from its first stage to the end of its last. `initial` is a checked plan of the board as it is held at the
/// start; `pieces` are those of all worked pieces.
///
/// The trace ends early if no pad has touched the board for a tenth of a second. Equal inputs give equal traces, bit for bit.
///
/// # Errors
/// If the settings are invalid, a moving part of the robot has no mass, or after a stop; [`SimError::Staged`] if a gripper has no
/// pads or elastic ones.
pub fn simulate_staged(
    plan: &StagedPlan,
    states: &StagedStates,
    initial: &CheckedPlan<'_>,
    pieces: &[CheckedPlan<'_>],
    conditions: &Conditions,
    stop: &dyn Stop,
) -> Result<StagedTrace, SimError> {
    let mut scene = SimScene::new(initial, conditions)?;
    scene.may_regrasp()?;
    let carried = CarriedBy::new(initial.robot(), initial.plan(), conditions.friction);
    let timeline = Timeline::new(plan, &states.holdings, &carried, &conditions.settings);
    let mut distances = Distances::new(plan, initial, pieces, conditions);
    let mut trace = empty_trace(initial, conditions, timeline.steps() + 1);
    trace.samples.truncate(1);
    let mut x_wo_planned = vec![initial.plan().object.x_wo];
    let mut spans: Vec<StageSpan> = Vec::new();
    scene.observe(&mut trace.samples[0]);
    let mut untouched_s = 0.0;
    for step in 1..=timeline.steps() {
        if stop.is_stopped() {
            return Err(SimError::Stopped);
        }
        let Some(command) = timeline.at(step) else { break };
        scene.command(&command.arms);
        if let Some((arm, x_og, grip_force_n)) = command.regrips {
            scene.regrip(initial, arm, &x_og, grip_force_n, conditions);
        }
        scene.step_under(command.tool);
        let time_s = step as f64 * timeline.timestep_s();
        if let Some(reason) = scene.breakdown() {
            trace.broke_down = Some(format!("at {time_s:.3} s {reason}"));
            break;
        }
        let mut sample = blank_sample(initial);
        (sample.time_s, sample.phase) = (time_s, command.phase);
        scene.observe(&mut sample);
        distances.observe(step, &command, &mut sample, &mut trace);
        untouched_s = if sample.has_contact() { 0.0 } else { untouched_s + timeline.timestep_s() };
        trace.samples.push(sample);
        x_wo_planned.push(command.x_wo);
        match spans.last_mut().filter(|span| span.stage == command.stage) {
            Some(span) => span.last = step,
            None => spans.push(StageSpan { stage: command.stage, first: if step == 1 { 0 } else { step }, last: step }),
        }
        if untouched_s > super::LOST_AFTER_S {
            break;
        }
    }
    distances.finish(&mut trace);
    Ok(StagedTrace { trace, spans, x_wo_planned, pieces: distances.pieces })
}

/// The distances of robot and board from each other and from the person, who is elsewhere in every piece.
struct Distances<'a> {
    plan: &'a StagedPlan,
    monitor: DistanceMonitor<'a>,
    /// The person at every piece.
    people: Vec<Vec<PersonPart>>,
    /// Where the person is now: the piece, and whether they have stepped back.
    now: Option<(usize, bool)>,
    /// The piece of every sample.
    pieces: Vec<usize>,
}

impl<'a> Distances<'a> {
    fn new(
        plan: &'a StagedPlan,
        initial: &'a CheckedPlan<'_>,
        pieces: &'a [CheckedPlan<'_>],
        conditions: &Conditions,
    ) -> Self {
        let people = pieces.iter().map(CheckedPlan::person_parts).collect();
        Self { plan, monitor: DistanceMonitor::of(initial, conditions), people, now: None, pieces: vec![0] }
    }

    fn observe(&mut self, step: usize, command: &Command, sample: &mut crate::model::trace::Sample, trace: &mut Trace) {
        let during = self.plan.stages[command.stage].person();
        // Between the pieces the person is where they worked last.
        let worked = matches!(self.plan.stages[command.stage], Stage::Hold(_));
        let last = if worked { command.piece } else { command.piece.saturating_sub(1) };
        let piece = last.min(self.people.len().saturating_sub(1));
        let now = (piece, during == PersonDuring::StepsBack);
        if self.now != Some(now) {
            let parts = self.people.get(piece).map_or(&[][..], Vec::as_slice);
            let back_w = if now.1 { step_back_w(parts) } else { Vector3::zeros() };
            let parts: Vec<_> = parts.iter().map(|part| part.moved(&back_w)).collect();
            self.monitor.replace_person(&parts, trace);
            self.now = Some(now);
        }
        self.pieces.push(piece);
        self.monitor.observe(step, sample);
    }

    fn finish(&self, trace: &mut Trace) {
        self.monitor.enter(trace);
    }
}

/// How a person steps back, W, m, from the tool's tip, the last part, with the head, the first.
#[must_use]
pub fn step_back_w(parts: &[PersonPart]) -> Vector3<f64> {
    let (Some(head), Some(tool)) = (parts.first(), parts.last()) else { return Vector3::zeros() };
    place::step_back_w(&head.p0_w, &tool.p1_w)
}
