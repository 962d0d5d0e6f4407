//! How the person stands and sees the work: each figure with its limits.

use super::columns::aligned;
use crate::model::plan::{PostureConstraint, PostureFigure, PostureFigures};

/// The head of the table.
pub(super) const HEAD: [&str; 5] = ["posture", "unit", "value", "limit", "margin"];

/// The table as text, one line per figure.
#[must_use]
pub fn table(figures: &PostureFigures) -> String {
    let mut rows = vec![HEAD.map(str::to_owned).to_vec()];
    rows.extend(figures.iter().map(|(constraint, figure)| row(constraint, &figure).to_vec()));
    aligned(&rows, 2)
}

/// The cells of one figure.
pub(super) fn row(constraint: PostureConstraint, figure: &PostureFigure) -> [String; 5] {
    let digits = if constraint.unit() == "deg" { 1 } else { 3 };
    let limit = figure.limits_in_words().unwrap_or_else(|| "-".to_owned());
    let margin = figure.margin();
    let margin = if margin.is_finite() { format!("{margin:.digits$}") } else { "-".to_owned() };
    [constraint.key().to_owned(), constraint.unit().to_owned(), format!("{:.digits$}", figure.value), limit, margin]
}
