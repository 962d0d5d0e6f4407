//! The runs of a sweep as a table: the columns of `runs.csv`.
//!
//! A number is written with the fewest digits that give it back exactly, so what is read is what was written, bit for bit.

use serde::{Deserialize, Serialize};

use super::record::{Decided, MeasuredRun, PredictedRun, RunRecord};
use crate::model::verdict::{CheckKind, VerdictKind};

/// The columns before the drawn values.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunRow {
    /// The run's index.
    pub run: u64,
    /// The verdict.
    pub verdict: VerdictKind,
    /// How it was found.
    pub decided: Decided,
    /// Predicted compliant load factor.
    pub predicted_load_factor: Option<f64>,
    /// Predicted deflection, mm.
    pub predicted_deflection_mm: Option<f64>,
    /// Simulated slip, mm.
    pub slip_mm: Option<f64>,
    /// Simulated rotation of a hand on the board, degrees.
    pub slip_deg: Option<f64>,
    /// Simulated deflection, mm.
    pub deflection_mm: Option<f64>,
    /// Simulated torque ratio.
    pub torque_ratio: Option<f64>,
    /// The multiple of the load at the first crossing of a limit.
    pub failed_at: Option<f64>,
    /// The check of this limit.
    pub first_check: Option<CheckKind>,
}

impl RunRow {
    /// The names of the columns, in their order.
    pub const COLUMNS: [&str; 11] = [
        "run",
        "verdict",
        "decided",
        "predicted_load_factor",
        "predicted_deflection_mm",
        "slip_mm",
        "slip_deg",
        "deflection_mm",
        "torque_ratio",
        "failed_at",
        "first_check",
    ];

    /// The row of a run.
    #[must_use]
    pub fn of(record: &RunRecord) -> Self {
        let (predicted, measured) = (record.predicted.as_ref(), record.measured.as_ref());
        Self {
            run: record.index,
            verdict: record.verdict,
            decided: record.decided,
            predicted_load_factor: predicted.map(|run| run.load_factor),
            predicted_deflection_mm: predicted.map(|run| run.deflection_mm),
            slip_mm: measured.map(|run| run.slip_mm),
            slip_deg: measured.map(|run| run.slip_deg),
            deflection_mm: measured.map(|run| run.deflection_mm),
            torque_ratio: measured.map(|run| run.torque_ratio),
            failed_at: measured.and_then(|run| run.failed_at),
            first_check: measured.and_then(|run| run.first_check),
        }
    }

    /// The run of a row and its drawn values.
    #[must_use]
    pub fn into_record(self, values: Vec<f64>) -> RunRecord {
        let predicted = self.predicted_load_factor.zip(self.predicted_deflection_mm);
        let measured = self.slip_mm.zip(self.slip_deg).zip(self.deflection_mm.zip(self.torque_ratio));
        RunRecord {
            index: self.run,
            values,
            predicted: predicted.map(|(load_factor, deflection_mm)| PredictedRun { load_factor, deflection_mm }),
            decided: self.decided,
            verdict: self.verdict,
            measured: measured.map(|((slip_mm, slip_deg), (deflection_mm, torque_ratio))| MeasuredRun {
                slip_mm,
                slip_deg,
                deflection_mm,
                torque_ratio,
                failed_at: self.failed_at,
                first_check: self.first_check,
            }),
        }
    }
}

/// The header of the table of a sweep with these dimensions.
pub fn header<'a>(dimensions: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    RunRow::COLUMNS.into_iter().chain(dimensions).map(str::to_owned).collect()
}

/// Rows of the table, with its header if there is one.
///
/// # Errors
/// Writing to memory does not fail, but `csv` has errors for it.
pub fn rows(header: Option<&[String]>, records: &[RunRecord]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    header.map_or(Ok(()), |header| writer.write_record(header))?;
    for record in records {
        writer.serialize((RunRow::of(record), &record.values))?;
    }
    writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
}

/// Why a table cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The header is that of another sweep.
    #[error("1: found the columns {found}, expected {expected}")]
    Header {
        /// The header.
        found: String,
        /// That of the sweep.
        expected: String,
    },
    /// A row cannot be read.
    #[error("{line}: {problem}")]
    Row {
        /// Its line.
        line: u64,
        /// What is wrong.
        problem: String,
    },
}

/// The runs of a table with this header. Rows after the last complete line are left out if `unfinished`: of a table that is being
/// written.
///
/// # Errors
/// If the header differs or a row is invalid.
pub fn read(text: &str, header: &[String], unfinished: bool) -> Result<Vec<RunRecord>, TableError> {
    let whole = if unfinished { &text[..text.rfind('\n').map_or(0, |end| end + 1)] } else { text };
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(whole.as_bytes());
    let mut records = Vec::new();
    for (number, row) in reader.records().enumerate() {
        let problem = |problem: String| TableError::Row { line: number as u64 + 1, problem };
        let row = row.map_err(|error| problem(error.to_string()))?;
        if number == 0 {
            if row != *header {
                let found = row.iter().collect::<Vec<_>>().join(",");
                return Err(TableError::Header { found, expected: header.join(",") });
            }
            continue;
        }
        let (run, values): (RunRow, Vec<f64>) = row.deserialize(None).map_err(|error| problem(error.to_string()))?;
        records.push(run.into_record(values));
    }
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_what_was_written_bit_for_bit() {
        let measured = MeasuredRun {
            slip_mm: 0.1 + 0.2,
            slip_deg: 1e-17,
            deflection_mm: 1.0 / 3.0,
            torque_ratio: 0.5,
            failed_at: None,
            first_check: None,
        };
        let record = RunRecord {
            index: 3,
            values: vec![-1.0 / 7.0, 1e300],
            predicted: Some(PredictedRun { load_factor: 1.1, deflection_mm: f64::INFINITY }),
            decided: Decided::Audited,
            verdict: VerdictKind::Holds,
            measured: Some(measured),
        };
        let failed = MeasuredRun { failed_at: Some(0.7), first_check: Some(CheckKind::SlipRotation), ..measured };
        let records = [
            record.clone(),
            RunRecord { index: 4, measured: Some(failed), verdict: VerdictKind::Pivots, ..record.clone() },
            RunRecord { index: 5, measured: None, predicted: None, decided: Decided::Predicted, ..record },
        ];
        let header = header(["friction_factor", "tool_tilt_deg.x"]);
        let bytes = rows(Some(&header), &records).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(read(&text, &header, false).unwrap(), records);
        // Of a table that is being written the last line may be cut anywhere.
        for cut in 1..40 {
            let found = read(&text[..text.len() - cut], &header, true).unwrap();
            assert_eq!(found, records[..2], "{cut}");
        }
    }

    #[test]
    fn a_wrong_table_is_refused_with_its_line() {
        let header = header(["friction_factor"]);
        let other = read("run,verdict\n", &header, false).unwrap_err().to_string();
        assert!(other.starts_with("1: found the columns run,verdict, expected run,verdict,decided"), "{other}");
        let text = format!("{}\n0,holds,simulated,,,,,,,,,1.0\n1,hold,simulated,,,,,,,,,1.0\n", header.join(","));
        assert!(read(&text, &header, false).unwrap_err().to_string().starts_with("3: "));
    }
}
