//! Figures in cells, and names of pictures.

use crate::reproduce::evaluation::HoldRow;

/// A figure with this number of decimals; `-` without one.
pub fn figure(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}

/// The file name of a picture.
#[must_use]
pub fn picture_name(hold: &HoldRow) -> String {
    format!("{}-{}.svg", hold.operation, hold.planner)
}

/// The title of a picture.
#[must_use]
pub fn picture_title(hold: &HoldRow) -> String {
    format!(
        "{}, {} planner: muscular comfort {}, peripersonal comfort {}",
        hold.operation,
        hold.planner,
        figure(hold.muscular(), 1),
        figure(hold.peripersonal_scaled(), 1)
    )
}
