//! The comparison of a task's staged plan with other strategies for the same path (docs/method.md#117-comparison): tables for
//! programs and the console, a section of the report, and what was found in one sentence.

mod figures;
mod section;
#[cfg(test)]
mod tests;

pub use figures::{Comparison, PieceFigures, Strategy, StrategyKind, Totals};
pub(super) use section::{STYLE, section};

use super::{
    columns::aligned,
    csv_text::{cell, csv_text},
};
use crate::model::tool_path::Piece;

/// One row per strategy: the pieces that it serves, and its figures over them; `staged_ratio` is the staged plan's mean effort divided
/// by the strategy's, over the pieces that both serve.
#[must_use]
pub fn csv(comparison: &Comparison) -> String {
    let header = [
        "strategy",
        "pieces",
        "served",
        "mean_objective",
        "least_objective",
        "mean_effort",
        "effort_s_per_m",
        "effort_s_per_hole",
        "accumulated_effort_s",
        "served_by_both",
        "staged_ratio",
    ];
    let rows = comparison.strategies.iter().map(|strategy| {
        let totals = comparison.totals(strategy);
        let [per_m, per_hole] = per_length(comparison, &totals);
        let (both, ratio) = comparison.staged_ratio(strategy);
        vec![
            strategy.kind.name().to_owned(),
            strategy.pieces.len().to_string(),
            totals.served.to_string(),
            cell(totals.mean_objective, 4),
            cell(totals.least_objective, 4),
            cell(totals.mean_effort, 6),
            cell(per_m, 4),
            cell(per_hole, 4),
            cell(totals.accumulated_effort_s, 4),
            both.to_string(),
            cell(ratio, 4),
        ]
    });
    csv_text(&header, rows)
}

/// The effort per metre and per hole, of which a path has one.
fn per_length(comparison: &Comparison, totals: &Totals) -> [Option<f64>; 2] {
    if comparison.has_length() { [totals.effort_rate_s, None] } else { [None, totals.effort_rate_s] }
}

/// One row per strategy and piece; the figures are empty if the strategy does not serve the piece.
#[must_use]
pub fn pieces_csv(comparison: &Comparison) -> String {
    let header = [
        "strategy",
        "piece",
        "stroke",
        "from_m",
        "to_m",
        "plans",
        "objective",
        "muscular_regularised",
        "peripersonal_m",
        "effort",
    ];
    let of_strategy = |strategy: &Strategy| {
        let row = |(number, (figures, piece)): (usize, (&Option<PieceFigures>, &Piece))| {
            let figure = |of: fn(&PieceFigures) -> f64| figures.as_ref().map(of);
            vec![
                strategy.kind.name().to_owned(),
                (number + 1).to_string(),
                (piece.stroke + 1).to_string(),
                format!("{:.4}", piece.from_m),
                format!("{:.4}", piece.to_m),
                figures.map_or(0, |figures| figures.plans).to_string(),
                cell(figure(|figures| figures.objective), 4),
                cell(figure(|figures| figures.muscular_regularised), 4),
                cell(figure(|figures| figures.peripersonal_m), 4),
                cell(figure(|figures| figures.effort), 6),
            ]
        };
        strategy.pieces.iter().zip(&comparison.pieces).enumerate().map(row).collect::<Vec<_>>()
    };
    csv_text(&header, comparison.strategies.iter().flat_map(of_strategy))
}

/// The cells of a table with a row for each strategy, its header first.
fn rows(comparison: &Comparison) -> Vec<Vec<String>> {
    let per = if comparison.has_length() { "s/m" } else { "s/hole" };
    let header =
        ["strategy", "pieces", "objective mean", "least", "effort mean", per, "accumulated s", "staged / this"];
    let row = |strategy: &Strategy| {
        let totals = comparison.totals(strategy);
        let shown = |figure: Option<f64>, digits| if figure.is_some() { cell(figure, digits) } else { "-".to_owned() };
        vec![
            strategy.kind.title().to_owned(),
            format!("{}/{}", totals.served, strategy.pieces.len()),
            shown(totals.mean_objective, 1),
            shown(totals.least_objective, 1),
            shown(totals.mean_effort, 4),
            shown(totals.effort_rate_s, 3),
            shown(totals.accumulated_effort_s, 3),
            shown(comparison.staged_ratio(strategy).1, 3),
        ]
    };
    std::iter::once(header.map(str::to_owned).to_vec()).chain(comparison.strategies.iter().map(row)).collect()
}

/// The strategies in a table for the console, and what was found.
#[must_use]
pub fn table(comparison: &Comparison) -> String {
    format!("{}{}\n", aligned(&rows(comparison), 1), sentence(comparison))
}

/// What was found in one sentence, such as `While the robot moves and regrasps the board, the effort is 0.24 in the mean, 26 % of that of
/// random holds; one fixed hold serves 9 of 16 pieces, with an effort of 0.70 where the staged plan has 0.24.`
#[must_use]
pub fn sentence(comparison: &Comparison) -> String {
    let part = |kind| comparison.strategy(kind).map(|strategy| (comparison.totals(strategy), strategy));
    let staged = part(StrategyKind::Staged).and_then(|(totals, _)| totals.mean_effort);
    let staged = staged.map_or_else(|| "unknown".to_owned(), |effort| format!("{effort:.2} in the mean"));
    let random = part(StrategyKind::Random).and_then(|(_, strategy)| comparison.staged_ratio(strategy).1);
    let random = random.map_or_else(
        || "no random hold was found".to_owned(),
        |ratio| format!("{:.0} % of that of random holds", 100.0 * ratio),
    );
    let one_hold = part(StrategyKind::OneHold).map_or_else(String::new, |(totals, strategy)| {
        let of = strategy.pieces.len();
        match (totals.mean_effort, comparison.staged_effort_beside(strategy)) {
            (Some(effort), Some(staged)) => format!(
                "; one fixed hold serves {} of {of} pieces, with an effort of {effort:.2} where the staged plan has {staged:.2}",
                totals.served
            ),
            _ => format!("; no fixed hold serves any of the {of} pieces"),
        }
    });
    format!("{}, the effort is {staged}, {random}{one_hold}.", comparison.motion_in_words())
}
