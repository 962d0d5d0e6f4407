//! The judgement of a staged plan: every stage by itself (docs/method.md#115-judgement-of-stages).

use super::{judge, judgement::Judgement};
use crate::model::{
    scenario::Limits,
    staged_plan::{Stage, StagedPlan},
    staged_trace::{StageSpan, StagedTrace},
    trace::Trace,
    verdict::VerdictKind,
};

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
/// samples, with the board's centre in place of the tool point; the arm that changes its grasp has a torque alone.
#[must_use]
pub fn judge_staged(trace: &StagedTrace, plan: &StagedPlan, limits: &Limits) -> Vec<StageJudgement> {
    let mut judged = Vec::with_capacity(trace.spans.len());
    for span in &trace.spans {
        let judgement = judge(&stage_trace(trace, plan, *span), limits);
        let holds = judgement.verdict == VerdictKind::Holds;
        judged.push(StageJudgement { span: *span, judgement });
        if !holds {
            break;
        }
    }
    judged
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
