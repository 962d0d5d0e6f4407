//! What the captions of the pictures say.

use super::{input::JudgedPlan, scene::StageScene};
use crate::model::{
    staged_plan::{Holding, PersonDuring, STEP_BACK_M, Stage},
    verdict::VerdictKind,
};

/// The caption of a picture.
pub struct Caption {
    /// The number of the stage, from 1.
    pub number: usize,
    /// Its kind.
    pub kind: &'static str,
    /// Its verdict in words.
    pub verdict: String,
    /// True if it does not hold.
    pub failed: bool,
    /// What happens in it, when, and why it fails.
    pub lines: Vec<String>,
}

/// The captions of all stages.
#[must_use]
pub fn captions(input: &JudgedPlan<'_>, scenes: &[StageScene]) -> Vec<Caption> {
    (0..input.plan.stages.len()).map(|number| caption(input, number, &scenes[number])).collect()
}

fn caption(input: &JudgedPlan<'_>, number: usize, scene: &StageScene) -> Caption {
    let JudgedPlan { plan, holdings, verdict, .. } = *input;
    let stage = &plan.stages[number];
    let judged = verdict.stages.iter().find(|judged| judged.stage == number + 1);
    let failed = verdict.failed.as_ref().filter(|failed| failed.stage == number + 1);
    let found = match (judged, failed) {
        (_, Some(_)) => verdict.verdict.to_string(),
        (Some(judged), None) => judged.verdict.to_string(),
        (None, None) => "not simulated".to_owned(),
    };
    let mut lines = vec![match stage {
        Stage::Hold(hold) => pieces(input, number, hold.pieces.len()),
        Stage::Move(_) => moved(&holdings[number], &holdings[number + 1]),
        Stage::Regrasp(regrasp) => regrasped(&regrasp.arm.name, scene),
    }];
    if !matches!(stage, Stage::Hold(_)) && input.has_person() {
        lines.push(match (stage.person(), input.is_back_before(number)) {
            (PersonDuring::Stays, false) => "person stays".to_owned(),
            (PersonDuring::Stays, true) => "person comes forward".to_owned(),
            (PersonDuring::StepsBack, false) => format!("person steps back {STEP_BACK_M} m"),
            (PersonDuring::StepsBack, true) => "person stays a step back".to_owned(),
        });
    }
    lines.extend(judged.map(|judged| format!("{:.1} to {:.1} s", judged.from_s, judged.to_s)));
    lines.extend(failed.map(|failed| failed.reason.clone()));
    let is_bad = failed.is_some() || judged.is_some_and(|judged| judged.verdict != VerdictKind::Holds);
    Caption { number: number + 1, kind: stage.name(), verdict: found, failed: is_bad, lines }
}

/// `pieces 3 to 5 of 16`.
fn pieces(input: &JudgedPlan<'_>, number: usize, count: usize) -> String {
    let before = input.plan.worked_pieces().filter(|(stage, _)| *stage < number).count();
    let all = input.plan.worked_pieces().count();
    if count == 1 {
        format!("piece {} of {all}", before + 1)
    } else {
        format!("pieces {} to {} of {all}", before + 1, before + count)
    }
}

/// `board moves 12 cm, turns 34°`; a turn of less than half a degree is left out.
fn moved(before: &Holding, after: &Holding) -> String {
    let away_m = (after.x_wo.translation.vector - before.x_wo.translation.vector).norm();
    let turn_deg = before.x_wo.rotation.angle_to(&after.x_wo.rotation).to_degrees();
    let turns = if turn_deg < 0.5 { String::new() } else { format!(", turns {turn_deg:.0}°") };
    format!("board moves {:.0} cm{turns}", 100.0 * away_m)
}

/// `left hand: new grasp, 21 cm away`.
fn regrasped(name: &str, scene: &StageScene) -> String {
    let changed = scene.hands.iter().find_map(|hand| Some((hand.point_o - hand.before_o?.0).norm()));
    let away = changed.map_or_else(String::new, |away_m| format!(", {:.0} cm away", 100.0 * away_m));
    format!("{name} hand: new grasp{away}")
}
