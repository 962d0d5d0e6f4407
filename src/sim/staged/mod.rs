//! The simulation of a staged plan: one scene in which servo targets move, fingers open and close, and the tool travels
//! (docs/method.md#114-simulation-of-stages).

mod arms;
mod segment;
mod timeline;

use nalgebra::Vector3;

use super::{Conditions, LOST_AFTER_S, SimError, SimScene, distance_monitor::DistanceMonitor, empty_trace};
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
pub(super) use segment::{ArmCommand, NewGrasp};
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
    let mut x_wo_planned = vec![initial.plan().object.x_wo];
    let mut spans: Vec<StageSpan> = Vec::new();
    scene.observe(&mut trace.samples[0]);
    let timestep_s = conditions.settings.timestep_s;
    let mut untouched_s = 0.0;
    tracing::info!(plan = plan.name, steps = timeline.steps(), timestep_s, "simulating a task");
    for (step, command) in (1..).zip(timeline.commands()) {
        if stop.is_stopped() {
            return Err(SimError::Stopped);
        }
        scene.command(&command.arms);
        if let Some(grasp) = &command.regrips {
            scene.regrip(initial, grasp, conditions);
        }
        scene.step_under(command.tool);
        let time_s = step as f64 * timestep_s;
        if let Some(reason) = scene.breakdown() {
            trace.samples.truncate(step);
            trace.broke_down = Some(format!("at {time_s:.3} s {reason}"));
            break;
        }
        distances.place_person(&command, &mut trace);
        let sample = &mut trace.samples[step];
        (sample.time_s, sample.phase) = (time_s, command.phase);
        scene.observe(sample);
        distances.monitor.observe(step, sample);
        untouched_s = if sample.has_contact() { 0.0 } else { untouched_s + timestep_s };
        x_wo_planned.push(command.x_wo);
        match spans.last_mut().filter(|span| span.stage == command.stage) {
            Some(span) => span.last = step,
            None => {
                tracing::debug!(time_s, stage = command.stage + 1, phase = command.phase.name(), "a stage begins");
                spans.push(StageSpan { stage: command.stage, first: if step == 1 { 0 } else { step }, last: step });
            }
        }
        if untouched_s > LOST_AFTER_S {
            trace.samples.truncate(step + 1);
            break;
        }
    }
    distances.monitor.enter(&mut trace);
    Ok(StagedTrace { trace, spans, x_wo_planned, pieces: distances.pieces })
}

/// The distances of robot and board from each other and from the person, who is elsewhere in every piece.
struct Distances<'a> {
    plan: &'a StagedPlan,
    monitor: DistanceMonitor<'a>,
    /// The person at every piece.
    people: Vec<Vec<PersonPart>>,
    /// The piece where the person is, and what they do.
    now: Option<(usize, PersonDuring)>,
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

    /// The person where they are during a step.
    fn place_person(&mut self, command: &Command, trace: &mut Trace) {
        let stage = &self.plan.stages[command.stage];
        // Between the pieces the person is where they worked last.
        let worked = matches!(stage, Stage::Hold(_));
        let last = if worked { command.piece } else { command.piece.saturating_sub(1) };
        let piece = last.min(self.people.len().saturating_sub(1));
        self.pieces.push(piece);
        let now = Some((piece, stage.person()));
        if self.now == now {
            return;
        }
        self.now = now;
        let parts = self.people.get(piece).map_or(&[][..], Vec::as_slice);
        let moved_w = match stage.person() {
            PersonDuring::Stays => Vector3::zeros(),
            PersonDuring::StepsBack => step_back_w(parts),
        };
        let parts: Vec<_> = parts.iter().map(|part| part.moved(&moved_w)).collect();
        self.monitor.replace_person(&parts, trace);
    }
}

/// How a person steps back, W, m, from the tool's tip, the last part, with the head, the first.
#[must_use]
pub fn step_back_w(parts: &[PersonPart]) -> Vector3<f64> {
    let (Some(head), Some(tool)) = (parts.first(), parts.last()) else { return Vector3::zeros() };
    place::step_back_w(&head.p0_w, &tool.p1_w)
}
