//! The person's best response: search of the grid, then local refinement.

use std::f64::consts::FRAC_PI_2;

use libm::atan2;
use nalgebra::Vector3;

use super::{
    query::ResponseQuery,
    responses::{self, Choice, HEADING_STEP_RAD, PLACE_STEP_M, ROLL_STEP_RAD, Response, SWIVEL_STEP_RAD},
};
use crate::{
    human::{ArmAngles, ShoulderBranch},
    model::frames::Pose,
};

/// How many responses of the grid are refined.
const REFINED: usize = 8;
/// Number of step sizes of the refinement. The first is half of the grid's step, each next one half of the last; the last ones
/// are 0.8 mm and 0.16 degrees of heading.
const HALVINGS: i32 = 6;

/// The best response: the best few of the grid, each refined by compass search over standing place, heading, roll (where it
/// is free) and swivel. A local optimum, at least as good as every response of the grid. `None` if the grid has no feasible
/// response, and after a stop.
#[must_use]
pub fn best_response(query: &ResponseQuery<'_>) -> Option<Response> {
    let mut best: Vec<Response> = Vec::with_capacity(REFINED + 1);
    responses::visit(query, |_, response| {
        let place = best.partition_point(|better| better.objective >= response.objective);
        if place < REFINED {
            best.insert(place, *response);
            best.truncate(REFINED);
        }
    });
    if query.stop.is_stopped() {
        return None;
    }
    best.into_iter().map(|start| refined(query, start)).max_by(|a, b| a.objective.total_cmp(&b.objective))
}

/// The local optimum near a posture, by the refinement of [`best_response`] without its grid. It starts at the posture's
/// standing place and swivel or, if that is infeasible, at the best of the choices one grid step away; `None` if all of
/// them are infeasible.
#[must_use]
pub fn response_near(query: &ResponseQuery<'_>, x_wb: &Pose, q_rad: &ArmAngles) -> Option<Response> {
    let ahead = x_wb.rotation * Vector3::x();
    let place = x_wb.translation.vector;
    let choice = Choice {
        place_w_m: [place.x, place.y],
        heading_rad: atan2(ahead.y, ahead.x),
        roll_rad: 0.0,
        swivel_rad: query.human.swivel_rad(q_rad),
        // The branches meet at 90 degrees of abduction.
        branch: if q_rad[1] > FRAC_PI_2 { ShoulderBranch::High } else { ShoulderBranch::Low },
    };
    let around =
        || neighbours(query, &choice, 1.0).into_iter().filter_map(|choice| responses::response_to(query, &choice));
    let start = responses::response_to(query, &choice)
        .or_else(|| around().max_by(|a, b| a.objective.total_cmp(&b.objective)))?;
    Some(refined(query, start))
}

/// Compass search: moves to the best neighbour while that improves the objective, then halves the step.
fn refined(query: &ResponseQuery<'_>, start: Response) -> Response {
    let mut best = start;
    for halving in 1..=HALVINGS {
        if query.stop.is_stopped() {
            break;
        }
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
