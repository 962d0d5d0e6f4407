//! The judgement of a staged plan: every stage by itself (docs/method.md#115-judgement-of-stages).

use super::{judge, judgement::Judgement};
use crate::model::{
    scenario::Limits,
    staged_plan::{Stage, StagedPlan},
    staged_trace::{StageSpan, StagedTrace},
    trace::Trace,
    verdict::{Confirmation, VerdictKind},
};

/// The judgement of a staged plan.
#[derive(Clone, Debug, PartialEq)]
pub struct StagedJudgement {
    /// Those of its stages, up to the first one that does not hold.
    pub stages: Vec<StageJudgement>,
    /// Simulations at shorter time steps, if there were any, see [`confirmed_staged`](super::confirmed_staged).
    pub confirmation: Option<Confirmation>,
}

impl StagedJudgement {
    /// The verdict: that of the last stage that was judged.
    #[must_use]
    pub fn verdict(&self) -> VerdictKind {
        // Without a stage the engine broke down in the first step.
        self.stages.last().map_or(VerdictKind::NoVerdict, |last| last.judgement.verdict)
    }

    /// The first stage that does not hold; `None` if all that were judged do.
    #[must_use]
    pub fn failed(&self) -> Option<&StageJudgement> {
        self.stages.last().filter(|last| last.judgement.verdict != VerdictKind::Holds)
    }
}

/// The judgement of one stage.
#[derive(Clone, Debug, PartialEq)]
pub struct StageJudgement {
    /// Its samples.
    pub span: StageSpan,
    /// The judgement.
    pub judgement: Judgement,
}

/// Judges every stage that was simulated, up to the first one that fails.
///
/// A stage's trace begins at its first sample, to which slip, rotation and the board's displacement refer; the planned motion of
/// the board is taken out of it. In a hold the limits apply as to a plan of one hold. In a motion and in a regrasp they apply to all
/// samples, with the board's centre in place of the tool point; the arm that changes its grasp has a torque alone. A stage that
/// holds has no verdict if the simulation ended after it, before the last stage.
#[must_use]
pub fn judge_staged(trace: &StagedTrace, plan: &StagedPlan, limits: &Limits) -> StagedJudgement {
    let mut stages = Vec::with_capacity(trace.spans.len());
    for span in &trace.spans {
        let judgement = judge(&stage_trace(trace, plan, *span), limits);
        let holds = judgement.verdict == VerdictKind::Holds;
        stages.push(StageJudgement { span: *span, judgement });
        if !holds {
            break;
        }
    }
    let is_early = trace.spans.len() < plan.stages.len();
    if let Some(last) = stages.last_mut().filter(|last| is_early && last.judgement.verdict == VerdictKind::Holds) {
        // The board was lost after the load of a hold.
        last.judgement.verdict = VerdictKind::NoVerdict;
        last.judgement.reason = Some("the simulation ended before the last stage".to_owned());
    }
    StagedJudgement { stages, confirmation: None }
}

/// The trace of one stage.
fn stage_trace(staged: &StagedTrace, plan: &StagedPlan, span: StageSpan) -> Trace {
    let is_last = staged.spans.last() == Some(&span);
    let StageSpan { stage, first, last } = span;
    let trace = &staged.trace;
    let start = staged.x_wo_planned[first];
    let mut samples = trace.samples[first..=last].to_vec();
    for (sample, planned) in samples.iter_mut().zip(&staged.x_wo_planned[first..=last]) {
        sample.x_wo = start * planned.inverse() * sample.x_wo;
    }
    let mut arms = trace.arms.clone();
    if let Some(Stage::Regrasp(regrasp)) = plan.stages.get(stage)
        && let Some(free) = arms.iter().position(|arm| arm.name == regrasp.arm.name)
    {
        arms[free].pads.clear();
        let x_oc = samples[0].arms[free].x_oc;
        for sample in &mut samples {
            sample.arms[free].pads.clear();
            sample.arms[free].x_oc = x_oc;
        }
    }
    Trace {
        arms,
        p_ot_m: samples[0].p_ot_m,
        samples,
        broke_down: trace.broke_down.clone().filter(|_| is_last),
        person_touch: trace.person_touch.clone(),
        robot_touch: trace.robot_touch.clone(),
    }
}
