//! The main path for a staged plan: check, simulate, judge.

use super::super::{exit::CliError, progress::Progress};
use crate::{
    check::{CheckedPlan, StagedStates, initial_plan},
    judge::{CRITERIA, Judgement, StageJudgement, StagedJudgement, confirmed_staged, fingerprint, judge_staged},
    model::{
        measures::EventKind,
        scenario::Scenario,
        staged_plan::{STAGED_FORMAT, StagedPlan, WorkedPiece},
        staged_trace::StagedTrace,
        staged_verdict::{FailedStage, PersonOverTask, StageVerdict, StagedVerdict},
        verdict::VerdictKind,
    },
    pipeline::versions::versions,
    report::comparison::{PieceFigures, Totals},
    robot::Robot,
    sim::{self, Conditions},
};

/// A staged plan with its verdict.
pub struct StagedRun {
    /// The verdict.
    pub verdict: StagedVerdict,
    /// Trace and judgement; `None` if nothing was simulated.
    pub simulated: Option<(StagedTrace, StagedJudgement)>,
}

/// Simulates and judges a staged plan; the verdict is confirmed at shorter time steps if a stage is near to a limit. A plan whose
/// bodies meet at a piece, or whose person would not stand or see so, is not simulated.
///
/// # Errors
/// If the simulation cannot be set up from the plan, and after a stop.
pub fn run_staged(
    scenario: &Scenario,
    robot: &Robot,
    plan: &StagedPlan,
    states: &StagedStates,
    progress: &Progress,
) -> Result<StagedRun, CliError> {
    let pieces = states
        .pieces
        .iter()
        .map(|piece| CheckedPlan::new(robot, &piece.plan, &scenario.human, &scenario.tool))
        .collect::<Result<Vec<_>, _>>()?;
    let empty = empty_verdict(scenario, plan);
    for (piece, checked) in states.pieces.iter().zip(&pieces) {
        if let Some((verdict, reason)) = checked.refusal(&scenario.limits) {
            let reason = format!("piece {} of the hold: {reason}", piece.number + 1);
            let failed = FailedStage { stage: piece.stage + 1, kind: "hold".into(), first_failure: None, reason };
            return Ok(StagedRun { verdict: with_kind(empty, verdict, Some(failed)), simulated: None });
        }
    }
    progress.does("simulating");
    // The board as it is held at the start; a plan of a piece for its operation alone.
    let initial = initial_plan(plan).ok_or(CliError::Simulation(sim::SimError::Engine))?;
    let initial = CheckedPlan::new(robot, &initial, &scenario.human, &scenario.tool)?;
    let run = |timestep_s: f64| {
        let mut conditions = Conditions::of(scenario);
        conditions.settings.timestep_s = timestep_s;
        let trace = sim::simulate_staged(plan, states, &initial, &pieces, &conditions, progress)
            .map_err(CliError::Simulation)?;
        let judgement = judge_staged(&trace, plan, &scenario.limits);
        Ok::<_, CliError>((trace, judgement))
    };
    let (trace, judgement) = confirmed_staged(scenario.simulation.timestep_s, run)?;
    let verdict = verdict(empty, plan, &trace, &judgement);
    Ok(StagedRun { verdict, simulated: Some((trace, judgement)) })
}

fn empty_verdict(scenario: &Scenario, plan: &StagedPlan) -> StagedVerdict {
    StagedVerdict {
        format: STAGED_FORMAT,
        criteria: CRITERIA,
        name: plan.name.clone(),
        verdict: VerdictKind::NoVerdict,
        expected: scenario.expect.verdict,
        met: false,
        failed: None,
        confirmation: None,
        stages: Vec::new(),
        regrasps: plan.regrasps(),
        moves: plan.moves(),
        duration_s: 0.0,
        person: person_over_task(plan, scenario),
        versions: versions(),
        seed: plan.planner.map_or(scenario.planner.seed, |record| record.seed),
        fingerprint: String::new(),
    }
}

/// A verdict of this kind.
fn with_kind(verdict: StagedVerdict, kind: VerdictKind, failed: Option<FailedStage>) -> StagedVerdict {
    let met = kind == verdict.expected && kind != VerdictKind::NoVerdict;
    StagedVerdict { verdict: kind, met, failed, ..verdict }
}

fn verdict(empty: StagedVerdict, plan: &StagedPlan, trace: &StagedTrace, judged: &StagedJudgement) -> StagedVerdict {
    let samples = &trace.trace.samples;
    let time_s = |sample: usize| samples.get(sample).map_or(0.0, |sample| sample.time_s);
    let kind = |stage: usize| plan.stages[stage].name().to_owned();
    let stages = judged.stages.iter().map(|StageJudgement { span, judgement }| StageVerdict {
        stage: span.stage + 1,
        kind: kind(span.stage),
        from_s: time_s(span.first),
        to_s: time_s(span.last),
        verdict: judgement.verdict,
        checks: judgement.checks.clone(),
        self_checks: judgement.self_checks.clone(),
    });
    let whole = StagedVerdict {
        confirmation: judged.confirmation.clone(),
        stages: stages.collect(),
        duration_s: samples.last().map_or(0.0, |sample| sample.time_s),
        fingerprint: fingerprint(&trace.trace),
        ..empty
    };
    let failed = judged.failed().map(|StageJudgement { span, judgement }| FailedStage {
        stage: span.stage + 1,
        kind: kind(span.stage),
        first_failure: judgement.first_failure.clone(),
        reason: reason(judgement),
    });
    with_kind(whole, judged.verdict(), failed)
}

/// The first failure of a stage in words.
fn reason(judgement: &Judgement) -> String {
    let crossed = judgement.first_failure.as_ref().and_then(|failure| {
        let is_it = |kind| kind == EventKind::LimitCrossed(failure.check);
        judgement.events.iter().find(|event| is_it(event.kind)).map(|event| event.text.clone())
    });
    crossed.or_else(|| judgement.reason.clone()).unwrap_or_default()
}

/// The person over the pieces of a plan; `None` unless all of them have comfort and muscles.
fn person_over_task(plan: &StagedPlan, scenario: &Scenario) -> Option<PersonOverTask> {
    let of_piece = |worked: &WorkedPiece| {
        let work_s = plan.task.work_s(&worked.piece, scenario.simulation.hold_s);
        Some((worked.piece.weight(), work_s, PieceFigures::of_worked(worked)?))
    };
    let totals = Totals::over(&plan.worked_pieces().map(|(_, worked)| of_piece(worked)).collect::<Option<Vec<_>>>()?);
    let place = |worked: &WorkedPiece| Some(worked.human?.x_wb.translation.vector);
    let places: Vec<_> = plan.worked_pieces().map(|(_, worked)| place(worked)).collect::<Option<_>>()?;
    let steps_m: Vec<_> = places.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
    Some(PersonOverTask {
        mean_objective: totals.mean_objective?,
        least_objective: totals.least_objective?,
        mean_effort: totals.mean_effort?,
        accumulated_effort_s: totals.accumulated_effort_s?,
        largest_step_m: steps_m.iter().copied().fold(0.0, f64::max),
        steps_m: steps_m.iter().sum(),
    })
}
