//! The format `isaac_grasp` 1.0 of Isaac Sim: grasps by name, as poses of the gripper in the object's frame.

use std::{collections::BTreeMap, path::Path};

use serde::Deserialize;
use serde_saphyr::Spanned;

use super::{
    super::{InputError, InputErrorKind},
    grasp::ForeignGrasp,
    yaml,
};
use crate::model::frames::PoseRecord;

/// A file. Keys for other purposes are ignored.
#[derive(Deserialize)]
struct File {
    format: Spanned<String>,
    format_version: Option<Spanned<f64>>,
    object_frame_link: Option<String>,
    grasps: BTreeMap<String, Spanned<Grasp>>,
}

#[derive(Deserialize)]
struct Grasp {
    confidence: Option<f64>,
    position: [f64; 3],
    orientation: Orientation,
}

#[derive(Deserialize)]
struct Orientation {
    w: f64,
    xyz: [f64; 3],
}

/// The grasps of a text, in the order of the file.
pub fn grasps(path: &Path, text: &str) -> Result<Vec<ForeignGrasp>, InputError> {
    let mut grasps = Vec::new();
    for file in yaml::documents::<File>(path, text)? {
        let wrong = |key: &str, line: usize, found: String, expected: &str| InputError {
            file: path.to_owned(),
            line: Some(line),
            key: Some(key.into()),
            kind: InputErrorKind::Value { found, expected: expected.into() },
        };
        if file.format.value != "isaac_grasp" {
            let found = format!("\"{}\"", file.format.value);
            return Err(wrong("format", yaml::line(&file.format), found, "isaac_grasp"));
        }
        if let Some(version) = file.format_version.filter(|version| version.value != 1.0) {
            let line = yaml::line(&version);
            return Err(wrong("format_version", line, version.value.to_string(), "1.0, the only known version"));
        }
        let frame = file.object_frame_link.unwrap_or_else(|| "object".into());
        for (name, grasp) in file.grasps {
            let key = format!("grasps.{name}");
            let Orientation { w, xyz: [x, y, z] } = grasp.value.orientation;
            let record = PoseRecord { translation_m: grasp.value.position, rotation_xyzw: [x, y, z, w] };
            grasps.push(ForeignGrasp {
                x_fh: yaml::pose(path, &key, &grasp, record)?,
                line: yaml::line(&grasp),
                name,
                key,
                frame: frame.clone(),
                confidence: grasp.value.confidence,
                max_force_n: None,
            });
        }
    }
    grasps.sort_by_key(|grasp| grasp.line);
    Ok(grasps)
}
