//! Reports on a sweep: console, HTML and JUnit.

mod charts;
mod console;
mod page;

use quick_junit::{NonSuccessKind, Property, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};

pub use console::text;
pub use page::report_page;

use crate::sweep::summary::SweepSummary;

/// The sweep as one test case: failed if the expected probability is not shown.
///
/// # Errors
/// If the XML writer fails.
pub fn junit(summary: &SweepSummary) -> Result<String, SerializeError> {
    let status = match summary.is_met() {
        true => TestCaseStatus::success(),
        false => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_type("probability");
            status.set_message(sentence(summary));
            status
        }
    };
    let mut case = TestCase::new(format!("{} sweep", summary.info.name), status);
    case.set_classname("benchdog");
    let estimate = &summary.estimate;
    let figures = [
        ("probability", estimate.probability),
        ("interval low", estimate.low),
        ("interval high", estimate.high),
        ("confidence", estimate.confidence),
    ];
    case.add_properties(figures.map(|(name, value)| Property::new(name, format!("{value:.4}"))));
    let mut suite = TestSuite::new("benchdog");
    suite.add_test_case(case);
    let mut report = Report::new("benchdog");
    report.add_test_suite(suite);
    report.to_string()
}

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
