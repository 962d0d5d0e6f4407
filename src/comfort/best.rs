//! The person's best answer to a hold.

use super::{
    Hold,
    answers::{self, Answer, Choice, HEADING_STEP_RAD, PLACE_STEP_M, ROLL_STEP_RAD, SWIVEL_STEP_RAD},
};

/// How many answers of the grid are refined.
const REFINED: usize = 8;
/// How often the steps of the refinement are halved, from half of the grid's: to 0.4 mm and 0.08 degrees of heading.
const HALVINGS: i32 = 6;

/// The best of the person's answers to a hold: the best few of the grid, each refined until no small change of standing
/// place, heading, roll (where it is free) or swivel makes it better. It is a local optimum at least as good as every
/// answer of the grid. None when there is no answer on the grid.
pub fn most(hold: &Hold<'_>) -> Option<Answer> {
    let mut best: Vec<Answer> = Vec::with_capacity(REFINED + 1);
    answers::visit(hold, |_, answer| {
        let place = best.partition_point(|better| better.objective >= answer.objective);
        if place < REFINED {
            best.insert(place, *answer);
            best.truncate(REFINED);
        }
    });
    best.into_iter().map(|start| refined(hold, start)).max_by(|a, b| a.objective.total_cmp(&b.objective))
}

/// Compass search: along each freedom a step either way; when none is better, half the step.
fn refined(hold: &Hold<'_>, start: Answer) -> Answer {
    let mut best = start;
    for halving in 1..=HALVINGS {
        let scale = 0.5_f64.powi(halving);
        while let Some(better) = neighbours(hold, &best.choice, scale)
            .into_iter()
            .filter_map(|choice| answers::answer(hold, &choice))
            .filter(|answer| answer.objective > best.objective)
            .max_by(|a, b| a.objective.total_cmp(&b.objective))
        {
            best = better;
        }
    }
    best
}

/// The choices one step away, with steps of `scale` times the grid's.
fn neighbours(hold: &Hold<'_>, from: &Choice, scale: f64) -> Vec<Choice> {
    let mut neighbours = Vec::with_capacity(10);
    for sign in [-scale, scale] {
        let place = |axis: usize| {
            let mut place_w_m = from.place_w_m;
            place_w_m[axis] += sign * PLACE_STEP_M;
            Choice { place_w_m, ..*from }
        };
        neighbours.extend([place(0), place(1)]);
        neighbours.push(Choice { heading_rad: from.heading_rad + sign * HEADING_STEP_RAD, ..*from });
        neighbours.push(Choice { swivel_rad: from.swivel_rad + sign * SWIVEL_STEP_RAD, ..*from });
        if hold.operation.kind.roll_is_free() {
            neighbours.push(Choice { roll_rad: from.roll_rad + sign * ROLL_STEP_RAD, ..*from });
        }
    }
    neighbours
}
