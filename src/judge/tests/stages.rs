//! Stages: which are judged, from where each is measured, and the planned motion of the board.

use super::*;
use crate::model::{
    plan::Plan,
    staged_plan::{ArmPath, HoldStage, PersonDuring, RegraspStage, STAGED_FORMAT, Stage, StagedPlan},
    staged_trace::{StageSpan, StagedTrace},
    task::{MotionSettings, Task},
};

/// A plan of these stages; of the rest the judge reads nothing.
fn plan_of(stages: Vec<Stage>) -> StagedPlan {
    let one: Plan = serde_json::from_str(include_str!("../../../scenarios/plans/cut-rim.json")).unwrap();
    let task = Task {
        kind: one.operation.kind,
        force_n: 10.0,
        path: Vec::new(),
        speed_m_s: Task::SPEED_M_S,
        piece_m: Task::PIECE_M,
        least_comfort: Task::LEAST_COMFORT,
        regrasp_cost: Task::REGRASP_COST,
        move_cost: Task::MOVE_COST,
        motion: MotionSettings::default(),
    };
    StagedPlan {
        format: STAGED_FORMAT,
        name: "stages".into(),
        robot: one.robot,
        task,
        object: one.object,
        arms: one.arms,
        stages,
        planner: None,
        scenario: None,
        benchdog: None,
    }
}

fn holds(count: usize) -> StagedPlan {
    plan_of((0..count).map(|_| Stage::Hold(HoldStage { pieces: Vec::new() })).collect())
}

fn regrasp_of(arm: &str) -> StagedPlan {
    plan_of(vec![Stage::Regrasp(RegraspStage {
        person: PersonDuring::Stays,
        time_s: Vec::new(),
        arm: ArmPath { name: arm.into(), q_rad: Vec::new() },
        x_og: Pose::identity(),
        grip_force_n: GRIP_N,
    })])
}

/// Stages that each are a trace, with the board planned to stand still.
fn staged(stages: Vec<Trace>) -> StagedTrace {
    let mut spans = Vec::new();
    let mut samples = Vec::new();
    for (stage, trace) in stages.iter().enumerate() {
        let first = samples.len();
        samples.extend(trace.samples.clone());
        spans.push(StageSpan { stage, first, last: samples.len() - 1 });
    }
    let count = samples.len();
    let trace = Trace { samples, ..stages[0].clone() };
    StagedTrace { trace, spans, x_wo_planned: vec![crooked(); count], pieces: vec![0; count] }
}

fn verdicts(judgement: &StagedJudgement) -> Vec<VerdictKind> {
    judgement.stages.iter().map(|stage| stage.judgement.verdict).collect()
}

#[test]
fn stages_are_judged_up_to_the_first_one_that_fails() {
    let slid = || changed(SETTLE + 60, |s| slide(s, 1, 1.1));
    let all = judge_staged(&staged(vec![still(), still()]), &holds(2), &limits());
    assert_eq!((verdicts(&all), all.verdict()), (vec![VerdictKind::Holds; 2], VerdictKind::Holds));
    assert!(all.failed().is_none());
    let second = judge_staged(&staged(vec![still(), slid(), still()]), &holds(3), &limits());
    assert_eq!(verdicts(&second), [VerdictKind::Holds, VerdictKind::Slips]);
    assert_eq!((second.verdict(), second.failed().unwrap().span.stage), (VerdictKind::Slips, 1));
}

#[test]
fn a_stage_that_holds_has_no_verdict_if_the_simulation_ended_after_it() {
    let early = judge_staged(&staged(vec![still(), still()]), &holds(3), &limits());
    assert_eq!(verdicts(&early), [VerdictKind::Holds, VerdictKind::NoVerdict]);
    let reason = early.stages[1].judgement.reason.as_deref();
    assert_eq!(reason, Some("the simulation ended before the last stage"));
    // One that failed keeps its verdict.
    let slid = changed(SETTLE + 60, |s| slide(s, 1, 1.1));
    let failed = judge_staged(&staged(vec![still(), slid]), &holds(3), &limits());
    assert_eq!(verdicts(&failed), [VerdictKind::Holds, VerdictKind::Slips]);
    assert_eq!(failed.stages[1].judgement.reason, None);
}

#[test]
fn a_simulation_that_broke_down_did_so_in_its_last_stage() {
    let mut trace = staged(vec![still(), still()]);
    trace.trace.broke_down = Some("the joint speeds have blown up".into());
    let judgement = judge_staged(&trace, &holds(2), &limits());
    assert_eq!(verdicts(&judgement), [VerdictKind::Holds, VerdictKind::NoVerdict]);
    assert_eq!(judgement.stages[1].judgement.reason.as_deref(), Some("the joint speeds have blown up"));
}

/// `X_WO(t)` is compared with the planned `X_WO(t)`: a board that is where it should be does not deflect, and one that is
/// 3 mm away from there deflects by 3 mm, in whatever direction it was carried.
#[test]
fn the_planned_motion_of_the_board_is_no_deflection() {
    let mut trace = staged(vec![still()]);
    for (index, planned) in trace.x_wo_planned.iter_mut().enumerate() {
        let share = index as f64 / LAST_JUDGED as f64;
        let moved = Isometry3::new(Vector3::new(0.2, -0.3, 0.1) * share, Vector3::new(0.4, 0.5, -0.6) * share);
        *planned = moved * crooked();
        trace.trace.samples[index].x_wo = *planned;
    }
    let planned = judge_staged(&trace, &holds(1), &limits());
    // Rounding of poses of half a metre.
    assert!(value(&planned.stages[0].judgement, CheckKind::Deflection) < 1e-11);
    for sample in &mut trace.trace.samples[SETTLE + 20..] {
        // Along an axis of the board.
        sample.x_wo *= Isometry3::translation(0.0, 3e-3, 0.0);
    }
    let away = judge_staged(&trace, &holds(1), &limits());
    assert!((value(&away.stages[0].judgement, CheckKind::Deflection) - 3.0).abs() < 1e-11);
}

#[test]
fn the_arm_that_changes_its_grasp_has_a_torque_alone() {
    let free = changed(SETTLE + 10, |s| {
        slide(s, 0, 80.0);
        s.arms[0].pads.iter_mut().for_each(|pad| pad.normal_force_n = 0.0);
    });
    let judged = |plan: &StagedPlan, trace: &Trace| {
        judge_staged(&staged(vec![trace.clone()]), plan, &limits()).stages.remove(0).judgement
    };
    let judgement = judged(&regrasp_of("left"), &free);
    assert_eq!(judgement.verdict, VerdictKind::Holds);
    assert_eq!(judgement.peak_torque_ratio["left_w1"], 6.0 / 15.0);
    // For the arm that holds the board all limits apply, and in a hold for both.
    assert_eq!(judged(&regrasp_of("right"), &free).verdict, VerdictKind::Drops);
    assert_eq!(judged(&holds(1), &free).verdict, VerdictKind::Drops);
}
