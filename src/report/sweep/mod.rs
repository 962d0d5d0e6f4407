//! Reports on a sweep: console, HTML and JUnit.

mod charts;
mod console;
#[cfg(feature = "cli")]
mod junit;
mod page;

pub use console::text;
#[cfg(feature = "cli")]
pub use junit::junit;
pub use page::report_page;

use crate::sweep::summary::SweepSummary;

/// The result in one sentence: `holds with probability 0.965, 0.951 to 0.975 at 95 % confidence, expected at least 0.99`.
#[must_use]
pub fn sentence(summary: &SweepSummary) -> String {
    let estimate = &summary.estimate;
    let expected = summary.info.expect.probability.map(|expected| format!(", expected at least {expected}"));
    format!(
        "{} with probability {:.4}, {:.4} to {:.4} at {} % confidence{}",
        summary.info.expect.verdict,
        estimate.probability,
        estimate.low,
        estimate.high,
        // Without the rounding of a product: 99.9.
        (1e6 * estimate.confidence).round() / 1e4,
        expected.unwrap_or_default()
    )
}

#[cfg(test)]
mod tests;
