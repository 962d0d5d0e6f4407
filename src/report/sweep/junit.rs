//! A sweep in JUnit XML.

use quick_junit::{NonSuccessKind, Property, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};

use super::sentence;
use crate::{report::xml, sweep::summary::SweepSummary};

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
    report.to_string().map(xml::legal)
}
