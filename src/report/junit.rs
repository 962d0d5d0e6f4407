//! JUnit XML for CI: an unexpected verdict is a failure, a crash is an error, a filtered scenario is skipped.

use quick_junit::{NonSuccessKind, Property, Report, SerializeError, TestCase, TestCaseStatus, TestSuite};

use super::{Outcome, xml};

/// The outcomes of a run as one test suite, without durations, so that equal runs give equal files.
///
/// # Errors
/// If the XML writer fails.
pub fn document(outcomes: &[Outcome]) -> Result<String, SerializeError> {
    let mut suite = TestSuite::new("benchdog");
    suite.add_test_cases(outcomes.iter().map(test_case));
    let mut report = Report::new("benchdog");
    report.add_test_suite(suite);
    report.to_string().map(xml::legal)
}

fn test_case(outcome: &Outcome) -> TestCase {
    let status = match outcome {
        Outcome::Judged { verdict, .. } if verdict.met => TestCaseStatus::success(),
        Outcome::Judged { verdict, .. } => failure(verdict.verdict.name(), &outcome.sentence()),
        Outcome::Crashed { message, .. } => {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
            status.set_message(message.as_str());
            status
        }
        Outcome::Skipped { reason, .. } => {
            let mut status = TestCaseStatus::skipped();
            status.set_message(reason.to_string());
            status
        }
    };
    let mut case = TestCase::new(outcome.name(), status);
    case.set_classname("benchdog");
    if let Outcome::Judged { verdict, .. } = outcome {
        let property = |check: &crate::model::verdict::Check| {
            Property::new(format!("{} [{}]", check.name, check.unit), format!("{:.4}", check.value))
        };
        case.add_properties(verdict.checks.iter().map(property));
    }
    case
}

fn failure(kind: &str, message: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
    status.set_type(kind);
    status.set_message(message);
    status
}
