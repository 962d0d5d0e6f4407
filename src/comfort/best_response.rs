//! The person's best answer to a query.

use std::f64::consts::FRAC_PI_2;

use libm::atan2;
use nalgebra::Vector3;

use super::{
    ResponseQuery,
    responses::{self, Choice, HEADING_STEP_RAD, PLACE_STEP_M, ROLL_STEP_RAD, Response, SWIVEL_STEP_RAD},
};
use crate::{
    human::{ArmAngles, ShoulderBranch},
    model::frames::Pose,
};

/// How many answers of the grid are refined.
const REFINED: usize = 8;
/// How often the steps of the refinement are halved, from half of the grid's: to 0.4 mm and 0.08 degrees of heading.
const HALVINGS: i32 = 6;

/// The best of the person's answers to a query: the best few of the grid, each refined until no small change of standing
/// place, heading, roll (where it is free) or swivel makes it better. It is a local optimum at least as good as every
/// answer of the grid. None when there is no answer on the grid.
pub fn best_response(query: &ResponseQuery<'_>) -> Option<Response> {
    let mut best: Vec<Response> = Vec::with_capacity(REFINED + 1);
    responses::visit(query, |_, response| {
        let place = best.partition_point(|better| better.objective >= response.objective);
        if place < REFINED {
            best.insert(place, *response);
            best.truncate(REFINED);
        }
    });
    best.into_iter().map(|start| refined(query, start)).max_by(|a, b| a.objective.total_cmp(&b.objective))
}

/// The best answer near a posture: no small change of standing place, heading, roll (where it is free) or swivel makes it
/// better. The posture's own place and swivel are where the search starts; they need not answer the query, but something a
/// step of the grid away must. None when nothing there does. A local optimum, far cheaper than [`best_response`].
pub fn response_near(query: &ResponseQuery<'_>, x_wb: &Pose, q_rad: &ArmAngles) -> Option<Response> {
    let ahead = x_wb.rotation * Vector3::x();
    let place = x_wb.translation.vector;
    let choice = Choice {
        place_w_m: [place.x, place.y],
        heading_rad: atan2(ahead.y, ahead.x),
        roll_rad: 0.0,
        swivel_rad: query.human.swivel_rad(q_rad),
        // Abduction beyond 90 degrees is the other way of the shoulder.
        branch: if q_rad[1] > FRAC_PI_2 { ShoulderBranch::High } else { ShoulderBranch::Low },
    };
    let around =
        || neighbours(query, &choice, 1.0).into_iter().filter_map(|choice| responses::response_to(query, &choice));
    let start = responses::response_to(query, &choice)
        .or_else(|| around().max_by(|a, b| a.objective.total_cmp(&b.objective)))?;
    Some(refined(query, start))
}

/// Compass search: along each freedom a step either way; when none is better, half the step.
fn refined(query: &ResponseQuery<'_>, start: Response) -> Response {
    let mut best = start;
    for halving in 1..=HALVINGS {
        let scale = 0.5_f64.powi(halving);
        while let Some(better) = neighbours(query, &best.choice, scale)
            .into_iter()
            .filter_map(|choice| responses::response_to(query, &choice))
            .filter(|response| response.objective > best.objective)
            .max_by(|a, b| a.objective.total_cmp(&b.objective))
        {
            best = better;
        }
    }
    best
}

/// The choices one step away, with steps of `scale` times the grid's.
fn neighbours(query: &ResponseQuery<'_>, from: &Choice, scale: f64) -> Vec<Choice> {
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
        if query.operation.kind.roll_is_free() {
            neighbours.push(Choice { roll_rad: from.roll_rad + sign * ROLL_STEP_RAD, ..*from });
        }
    }
    neighbours
}
