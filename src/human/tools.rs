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

    fn axes_h(tool: &Tool) -> Matrix3<f64> {
        rotation_from_xyzw(tool.rotation_xyzw).unwrap().to_rotation_matrix().into_inner()
    }

    #[test]
    fn the_axes_of_the_tools_are_those_of_the_method() {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        // Handle and blade of the knife are at 30 degrees to the face.
        let (sin, cos) = libm::sincos(30_f64.to_radians());
        let expected = [
            ("drill", [x, -y, -z]),
            ("knife", [z * cos - x * sin, y, -x * cos - z * sin]),
            ("knife-thumb-side", [-z, y, x]),
        ];
        for (name, axes) in expected {
            let found = axes_h(&named_tool(name).unwrap());
            // A quaternion of 16 digits: its matrix is good to a few roundings.
            assert!((found - Matrix3::from_columns(&axes)).norm() < 1e-15, "{name}: {found}");
            assert!((found.transpose() * found - Matrix3::identity()).norm() < 1e-15, "{name}: {found}");
            assert!((found.determinant() - 1.0).abs() < 1e-15, "{name}: {found}");
        }
    }

    #[test]
    fn the_reproduction_of_the_paper_has_another_knife_and_the_same_drill() {
        for kind in [OperationKind::Drill, OperationKind::Wrench] {
            assert_eq!([default_tool(kind), paper_tool(kind)], [TOOLS.drill; 2]);
        }
        assert_eq!(default_tool(OperationKind::Cut), named_tool("knife").unwrap());
        assert_eq!(paper_tool(OperationKind::Cut), named_tool("knife-thumb-side").unwrap());
        assert!(TOOL_NAMES.iter().all(|name| named_tool(name).is_some()) && named_tool("saw").is_none());
    }

    #[test]
    fn every_tip_lies_on_the_side_of_the_thumb_beyond_the_wrist() {
        for tool in TOOL_NAMES.map(|name| named_tool(name).unwrap()) {
            assert!(tool.mass_kg > 0.0 && tool.tip_h_m[0] > 0.0 && tool.tip_h_m[2] < 0.0);
        }
    }
}
