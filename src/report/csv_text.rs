//! CSV files with a header and rows of text.

/// The text of a figure with this number of digits after the point; empty if it does not exist.
pub(crate) fn cell(figure: Option<f64>, digits: usize) -> String {
    figure.map_or_else(String::new, |figure| format!("{figure:.digits$}"))
}

/// The text of a CSV file: comma-separated, lines end with `\n`, cells are quoted if necessary.
///
/// # Panics
/// If a row is not as long as the header.
pub(crate) fn csv_text<Cell: AsRef<[u8]>>(header: &[Cell], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail.
    writer.write_record(header).expect("a header can be written to memory");
    for row in rows {
        writer.write_record(row).expect("a row is as long as the header");
    }
    let bytes = writer.into_inner().expect("rows can be flushed to memory");
    String::from_utf8(bytes).expect("cells are strings")
}
