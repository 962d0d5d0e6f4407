//! Rows of text in columns.

use comfy_table::{CellAlignment, Table, presets};

/// Rows as text with two spaces between columns: the first `left` columns are aligned left, the others right.
pub(crate) fn aligned(rows: &[Vec<String>], left: usize) -> String {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING).add_rows(rows.iter().cloned());
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        column.set_cell_alignment(if index < left { CellAlignment::Left } else { CellAlignment::Right });
    }
    format!("{}\n", table.trim_fmt())
}
