//! Units in sentences.

use crate::model::verdict::CheckKind;

/// The unit of a check after a space; empty for a ratio.
pub(super) fn unit_suffix(kind: CheckKind) -> String {
    match kind.unit() {
        "1" => String::new(),
        unit => format!(" {unit}"),
    }
}
