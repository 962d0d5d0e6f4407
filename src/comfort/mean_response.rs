//! The mean over the person's responses.

use super::{query::ResponseQuery, responses};
use crate::model::plan::MeanComfort;

/// The mean comfort over the person's responses on the grid of [`responses::Response`]
/// (docs/method.md#33-the-persons-response); `None` if there is no response, and after a stop.
#[must_use]
pub fn mean_response(query: &ResponseQuery<'_>) -> Option<MeanComfort> {
    let (mut responses, mut muscular, mut peripersonal_m) = (0_u64, 0.0, 0.0);
    responses::visit(query, |_, response| {
        responses += 1;
        muscular += response.muscular.regularised;
        peripersonal_m += response.peripersonal_m;
    });
    let n = responses as f64;
    (responses > 0 && !query.stop.is_stopped()).then(|| MeanComfort {
        responses,
        muscular_regularised: muscular / n,
        peripersonal_m: peripersonal_m / n,
    })
}
