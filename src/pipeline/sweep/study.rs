//! What the runs of a sweep share, and a single run.

use crate::{
    check::CheckedPlan,
    judge::{Judgement, failing_load},
    model::{
        load::ForceProfile,
        plan::Plan,
        scenario::Scenario,
        stop::Stop,
        sweep::Sweep,
        uncertainty::Uncertainty,
        verdict::{CheckKind, VerdictKind},
    },
    pipeline::{RunError, judge_at, simulated_and_judged},
    statics::{LoadCases, ResponseOutcome, StabilityWorkspace},
    sweep::{
        Drawn, Draws,
        record::{Decided, MeasuredRun, PredictedRun, RunRecord},
        screen::Screen,
    },
};

/// A plan whose runs are drawn, and how they are decided.
pub struct Study<'a> {
    /// The scenario; its `uncertainty` is that of the run without drawn deviations.
    pub scenario: &'a Scenario,
    /// The plan.
    pub checked: &'a CheckedPlan<'a>,
    /// What is drawn for each run.
    pub draws: &'a Draws,
    /// What the statics decide; `None` if every run is simulated.
    pub screen: Option<Screen>,
}

impl Study<'_> {
    /// The scenario of a run.
    pub fn scenario_of(&self, index: u64) -> Scenario {
        self.scenario_under(&self.draws.draw(index).uncertainty)
    }

    /// The scenario with drawn deviations beside its own.
    fn scenario_under(&self, drawn: &Uncertainty) -> Scenario {
        Scenario { uncertainty: self.scenario.uncertainty.and(drawn), ..self.scenario.clone() }
    }

    /// The predicted load factor of a run; 0 without a prediction.
    pub fn predicted(&self, index: u64) -> f64 {
        predicted(self.checked, &self.scenario_of(index)).map_or(0.0, |run| run.load_factor)
    }

    /// One run: predicted, and simulated unless the prediction decides it.
    ///
    /// # Errors
    /// If the simulation cannot be set up, and after a stop.
    pub fn run(&self, index: u64, stop: &dyn Stop) -> Result<RunRecord, RunError> {
        let Drawn { values, uncertainty } = self.draws.draw(index);
        let scenario = self.scenario_under(&uncertainty);
        let predicted = predicted(self.checked, &scenario);
        let screened = self.screen.zip(predicted).is_some_and(|(screen, run)| screen.holds(run.load_factor));
        let audited = self.screen.is_some_and(|screen| screen.is_audited(index));
        let record = |decided, verdict, measured| RunRecord { index, values, predicted, decided, verdict, measured };
        if screened && !audited {
            return Ok(record(Decided::Predicted, VerdictKind::Holds, None));
        }
        let (_, judgement) = simulated_and_judged(self.checked, &scenario, stop)?;
        let decided = if screened { Decided::Audited } else { Decided::Simulated };
        Ok(record(decided, judgement.verdict, Some(measured(&judgement))))
    }
}

/// What the statics predict for a plan under the deviations of a scenario; `None` without a prediction.
fn predicted(checked: &CheckedPlan<'_>, scenario: &Scenario) -> Option<PredictedRun> {
    let cases = LoadCases::under(checked, scenario.grip.friction, &scenario.load, &scenario.uncertainty).ok()?;
    let mut workspace = StabilityWorkspace::new();
    let (case, found) = workspace.least_compliant_load_factor(&cases, &scenario.limits).ok()?;
    let deflection_mm = match workspace.response(&cases.into_case(case), 1.0) {
        Ok(ResponseOutcome::Found(response)) => response.deflection_mm(),
        _ => f64::INFINITY,
    };
    Some(PredictedRun { load_factor: found.load_factor, deflection_mm })
}

fn measured(judgement: &Judgement) -> MeasuredRun {
    let value = |kind| judgement.checks.iter().find(|check| check.name == kind).map_or(0.0, |check| check.value);
    let failure = judgement.first_failure.as_ref();
    MeasuredRun {
        slip_mm: value(CheckKind::Slip),
        slip_deg: value(CheckKind::SlipRotation),
        deflection_mm: value(CheckKind::Deflection),
        torque_ratio: value(CheckKind::TorqueRatio),
        failed_at: failure.map(|failure| failure.load_factor),
        first_check: failure.map(|failure| failure.check),
    }
}

/// The screen of a plan that is expected to hold a load that grows and stays: its predictions are corrected by the simulated
/// failing load without drawn deviations. `None` where a prediction does not tell how the simulation ends.
///
/// # Errors
/// If the simulation cannot be set up, and after a stop.
pub fn screen(
    checked: &CheckedPlan<'_>,
    scenario: &Scenario,
    sweep: &Sweep,
    audit_share: f64,
    stop: &dyn Stop,
) -> Result<Option<Screen>, RunError> {
    let is_ramp = scenario.load.profile == ForceProfile::Ramp;
    if !is_ramp || scenario.expect.verdict != VerdictKind::Holds {
        return Ok(None);
    }
    let Some(PredictedRun { load_factor, .. }) = predicted(checked, scenario) else { return Ok(None) };
    let simulated = failing_load(load_factor, |factor| judge_at(checked, scenario, factor, stop))?;
    let ratio = simulated.holds_at / load_factor;
    Ok((ratio.is_finite() && ratio > 0.0).then_some(Screen { ratio, audit_share, seed: sweep.seed }))
}

/// A plan as a sweep writes it: without durations, so that equal sweeps give equal files, and with the sweep in its scenario.
#[must_use]
pub fn as_swept(mut plan: Plan, scenario: &Scenario, sweep: &Sweep) -> Plan {
    if let Some(planner) = &mut plan.planner {
        (planner.wall_ms, planner.map_ms) = (None, None);
    }
    plan.scenario = Some(Scenario { sweep: Some(sweep.clone()), ..scenario.clone() });
    plan
}
