//! The table of runs as an Arrow file (IPC, uncompressed): the columns of `runs.csv`, texts as text, absent numbers as null.

use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray, UInt64Array};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, Field, Schema};

use crate::{
    cli::exit::CliError,
    sweep::{record::RunRecord, table::RunRow},
};

/// The bytes of the file.
///
/// # Errors
/// Writing to memory does not fail, but `arrow` has errors for it.
pub fn bytes(header: &[String], records: &[RunRecord]) -> Result<Vec<u8>, CliError> {
    written(header, records).map_err(|error| CliError::Machine(format!("failed to write the Arrow table: {error}")))
}

fn written(header: &[String], records: &[RunRecord]) -> Result<Vec<u8>, ArrowError> {
    let rows: Vec<RunRow> = records.iter().map(RunRow::of).collect();
    let texts =
        |of: &dyn Fn(&RunRow) -> Option<String>| -> ArrayRef { Arc::new(rows.iter().map(of).collect::<StringArray>()) };
    let numbers =
        |of: &dyn Fn(&RunRow) -> Option<f64>| -> ArrayRef { Arc::new(rows.iter().map(of).collect::<Float64Array>()) };
    let mut columns: Vec<ArrayRef> = vec![
        Arc::new(UInt64Array::from_iter_values(rows.iter().map(|row| row.run))),
        texts(&|row| Some(row.verdict.name().into())),
        texts(&|row| Some(row.decided.name().into())),
        numbers(&|row| row.predicted_load_factor),
        numbers(&|row| row.predicted_deflection_mm),
        numbers(&|row| row.slip_mm),
        numbers(&|row| row.slip_deg),
        numbers(&|row| row.deflection_mm),
        numbers(&|row| row.torque_ratio),
        numbers(&|row| row.failed_at),
        texts(&|row| row.first_check.map(|check| check.name().into())),
    ];
    for place in 0..header.len() - RunRow::COLUMNS.len() {
        columns.push(Arc::new(Float64Array::from_iter_values(records.iter().map(|record| record.values[place]))));
    }
    let field = |(name, column): (&String, &ArrayRef)| Field::new(name, column.data_type().clone(), name != "run");
    let schema = Arc::new(Schema::new(header.iter().zip(&columns).map(field).collect::<Vec<_>>()));
    let mut bytes = Vec::new();
    let mut writer = FileWriter::try_new(&mut bytes, &schema)?;
    writer.write(&RecordBatch::try_new(schema.clone(), columns)?)?;
    writer.finish()?;
    drop(writer);
    Ok(bytes)
}
