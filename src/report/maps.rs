//! A table of the maps that are kept between runs.

use super::columns::aligned;

/// The columns: what the map is, of which robot, board and kind of task, its size, the time since it was last used, and whether this
/// program reads it.
pub const COLUMNS: [&str; 7] = ["map", "robot", "board", "task", "size", "unused for", "state"];

/// One line per map, its cells in the order of [`COLUMNS`].
#[must_use]
pub fn table(maps: &[[String; COLUMNS.len()]]) -> String {
    let header = COLUMNS.map(str::to_owned);
    let rows: Vec<_> = std::iter::once(&header).chain(maps).map(|cells| cells.to_vec()).collect();
    aligned(&rows, COLUMNS.len())
}
