//! One hold for a whole path: one grasp and one pose of the board for as many pieces as possible, each with the person's best
//! response (docs/method.md#117-comparison). It is what a staged plan is compared with.
//!
//! A piece may have no response: a knife turns once around a circle and the wrist does not.

mod coverage;
mod search;

use coverage::{Coverage, PersonResponse, PiecesProblem};

use super::{
    library::GraspLibrary,
    outcome::PlanError,
    watch::{Watch, go_on},
};
use crate::model::{plan::Plan, scenario::Scenario};

/// A checked plan for every piece of a path; `None` where the piece is not served.
pub type PlansByPiece = Vec<Option<Plan>>;

/// The plans of one hold, the best that the search finds: all have the same arms and the same board. The search looks at these of
/// the pieces, and its hold then serves of all pieces those that it can.
///
/// # Errors
/// When the scenario's person or tool is invalid, and after a stop.
pub fn plans<'a>(
    pieces: &'a [Scenario],
    searched: &[usize],
    library: &'a GraspLibrary,
    watch: &'a dyn Watch,
) -> Result<PlansByPiece, PlanError> {
    let nothing = vec![None; pieces.len()];
    let Some(mut problem) = PiecesProblem::new(pieces, searched, library, watch)? else { return Ok(nothing) };
    let best = search::search(&mut problem);
    go_on(watch)?;
    let plans = best.map_or(nothing, |best| plans_of(&mut problem, &best));
    go_on(watch)?;
    Ok(plans)
}

/// The plans of a grasp, each with the best response of the whole grid.
fn plans_of(problem: &mut PiecesProblem<'_>, Coverage { grasp, responses, .. }: &Coverage) -> PlansByPiece {
    let mut known: Vec<Option<PersonResponse>> = vec![None; problem.pieces()];
    let mut is_searched = vec![false; problem.pieces()];
    for (&piece, response) in problem.searched().iter().zip(responses) {
        (known[piece], is_searched[piece]) = (*response, true);
    }
    let plan = |(piece, known): (usize, Option<PersonResponse>)| {
        let response = if is_searched[piece] { known } else { problem.response(grasp, piece, None) };
        let response = problem.best_response(grasp, piece, response?);
        problem.plan(grasp, piece, &response)
    };
    known.into_iter().enumerate().map(plan).collect()
}
