//! The default tools of a scenario.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::model::{operation::OperationKind, scenario::Tool};

/// `assets/human/tools.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tools {
    drill: Tool,
    knife: Tool,
    #[serde(rename = "knife-thumb-side")]
    knife_thumb_side: Tool,
}

static TOOLS: LazyLock<Tools> = LazyLock::new(|| {
    // The file is compiled in and a test parses it.
    toml::from_str(include_str!("../../assets/human/tools.toml")).expect("the built-in tools are valid")
});

/// The tool for an operation (docs/method.md#44-tools-in-the-hand): a knife for a cut, a drill otherwise.
pub fn default_tool(kind: OperationKind) -> Tool {
    match kind {
        OperationKind::Cut => TOOLS.knife,
        OperationKind::Drill | OperationKind::Wrench => TOOLS.drill,
    }
}

/// The tool of the reproduction of the paper: for a cut the knife whose blade leaves the fist on the side of the thumb.
pub fn paper_tool(kind: OperationKind) -> Tool {
    match kind {
        OperationKind::Cut => TOOLS.knife_thumb_side,
        OperationKind::Drill | OperationKind::Wrench => TOOLS.drill,
    }
}

/// The names of the tools that a scenario may name.
pub const TOOL_NAMES: [&str; 3] = ["drill", "knife", "knife-thumb-side"];

/// The tool with one of [`TOOL_NAMES`].
pub fn named_tool(name: &str) -> Option<Tool> {
    match name {
        "drill" => Some(TOOLS.drill),
        "knife" => Some(TOOLS.knife),
        "knife-thumb-side" => Some(TOOLS.knife_thumb_side),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;
    use crate::model::frames::rotation_from_xyzw;

    fn axes_h(kind: OperationKind) -> Matrix3<f64> {
        rotation_from_xyzw(default_tool(kind).rotation_xyzw).unwrap().to_rotation_matrix().into_inner()
    }

    #[test]
    fn the_axes_of_the_tools_are_those_of_the_method() {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        // A quaternion of 16 digits: its matrix is good to a few roundings.
        assert!((axes_h(OperationKind::Drill) - Matrix3::from_columns(&[x, -y, -z])).norm() < 1e-15);
        assert!((axes_h(OperationKind::Cut) - Matrix3::from_columns(&[-z, y, x])).norm() < 1e-15);
    }

    #[test]
    fn both_tips_lie_on_the_side_of_the_thumb_beyond_the_wrist() {
        for kind in [OperationKind::Drill, OperationKind::Cut] {
            let tool = default_tool(kind);
            assert!(tool.mass_kg > 0.0 && tool.tip_h_m[0] > 0.0 && tool.tip_h_m[2] < 0.0);
        }
    }
}
