//! A sweep as a page.

use crate::sweep::{record::RunRecord, summary::SweepSummary};

/// `report.html`.
#[must_use]
pub fn html(summary: &SweepSummary, _records: &[RunRecord]) -> String {
    super::text(summary)
}
