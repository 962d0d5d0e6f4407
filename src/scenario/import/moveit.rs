//! Messages of `moveit_msgs/Grasp` as ROS prints them: one document each, or lists of them.

use std::path::Path;

use serde::Deserialize;
use serde_saphyr::Spanned;

use super::{
    super::InputError,
    grasp::ForeignGrasp,
    yaml::{self, Xyz, Xyzw},
};
use crate::model::frames::PoseRecord;

/// A message. The keys that a hold does not need are ignored.
#[derive(Deserialize)]
struct Message {
    id: Option<String>,
    grasp_pose: PoseStamped,
    grasp_quality: Option<f64>,
    max_contact_force: Option<f64>,
}

#[derive(Deserialize)]
struct PoseStamped {
    header: Header,
    pose: RosPose,
}

#[derive(Deserialize)]
struct Header {
    frame_id: String,
}

#[derive(Deserialize)]
struct RosPose {
    position: Xyz,
    orientation: Xyzw,
}

/// The grasps of a text; without an `id` their names are `grasp_0`, `grasp_1`, and so on.
pub fn grasps(path: &Path, text: &str) -> Result<Vec<ForeignGrasp>, InputError> {
    let is_list = text.trim_start().starts_with(['-', '[']) && !text.trim_start().starts_with("---");
    let messages: Vec<Spanned<Message>> = if is_list {
        yaml::documents::<Vec<Spanned<Message>>>(path, text)?.into_iter().flatten().collect()
    } else {
        yaml::documents(path, text)?
    };
    let grasp = |(number, message): (usize, Spanned<Message>)| {
        let Message { id, grasp_pose: PoseStamped { header, pose }, grasp_quality, max_contact_force } = &message.value;
        let name = id.clone().filter(|id| !id.is_empty()).unwrap_or_else(|| format!("grasp_{number}"));
        let key = format!("{name}.grasp_pose");
        let (Xyz { x, y, z }, turn) = (pose.position, pose.orientation);
        let record = PoseRecord { translation_m: [x, y, z], rotation_xyzw: [turn.x, turn.y, turn.z, turn.w] };
        Ok(ForeignGrasp {
            x_fh: yaml::pose(path, &key, &message, record)?,
            line: yaml::line(&message),
            frame: header.frame_id.clone(),
            confidence: *grasp_quality,
            // A value of 0 disables the limit.
            max_force_n: max_contact_force.filter(|force_n| *force_n > 0.0),
            name,
            key,
        })
    };
    messages.into_iter().enumerate().map(grasp).collect()
}
