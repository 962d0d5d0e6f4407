use nalgebra::Vector3;

use super::*;
use crate::model::frames::Pose;

const ISAAC: &str = "format: isaac_grasp
format_version: 1.0
object_frame_link: board
gripper_frame_link: gripper
grasps:
  grasp_b:
    confidence: 0.5
    position: [0.1, 0.2, 0.3]
    orientation: {w: 0.0, xyz: [1.0, 0.0, 0.0]}
    cspace_position: {finger: 0.02}
    pregrasp_cspace_position: {finger: 0.04}
  grasp_a:
    position: [0.0, 0.0, 0.0]
    orientation: {w: 1.0, xyz: [0.0, 0.0, 0.0]}
";

const MOVEIT: &str = "id: \"first\"
pre_grasp_posture:
  header: {seq: 0, stamp: {secs: 0, nsecs: 0}, frame_id: ''}
  joint_names: []
  points: []
grasp_pose:
  header:
    seq: 0
    frame_id: board
  pose:
    position:
      x: 0.1
      y: 0.2
      z: 0.3
    orientation:
      x: 1.0
      y: 0.0
      z: 0.0
      w: 0.0
grasp_quality: 0.75
max_contact_force: 20.0
allowed_touch_objects: []
---
id: ''
grasp_pose:
  header: {frame_id: base}
  pose: {position: {x: 0, y: 0, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 1}}
max_contact_force: 0.0
---
";

fn read(text: &str) -> Result<ForeignGrasps, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grasps.yaml");
    std::fs::write(&path, text).unwrap();
    read_grasps(&path).map_err(|error| error.to_string().replace(&format!("{}/", folder.path().display()), ""))
}

#[test]
fn an_isaac_file() {
    let read = read(ISAAC).unwrap();
    let [first, second] = &read.grasps[..] else { panic!("two grasps") };
    // In the order of the file, not of the names.
    assert_eq!([&*first.name, &*second.name], ["grasp_b", "grasp_a"]);
    assert_eq!((first.frame.as_str(), first.confidence, second.confidence), ("board", Some(0.5), None));
    assert_eq!((first.key.as_str(), first.line), ("grasps.grasp_b", 7));
    // Half a turn about x, with the scalar first.
    assert_eq!(first.x_fh.translation.vector, Vector3::new(0.1, 0.2, 0.3));
    assert!((first.x_fh.rotation * Vector3::y() + Vector3::y()).norm() < 1e-15);
    assert_eq!(second.x_fh, Pose::identity());
}

#[test]
fn messages_of_moveit() {
    let found = read(MOVEIT).unwrap();
    let [first, second] = &found.grasps[..] else { panic!("two grasps") };
    assert_eq!([&*first.name, &*second.name], ["first", "grasp_1"]);
    assert_eq!([&*first.frame, &*second.frame], ["board", "base"]);
    assert_eq!((first.confidence, first.max_force_n, second.max_force_n), (Some(0.75), Some(20.0), None));
    let isaac = read(ISAAC).unwrap();
    assert_eq!([first.x_fh, second.x_fh], [isaac.grasps[0].x_fh, isaac.grasps[1].x_fh]);
    // The same messages as a list.
    let list: String = MOVEIT
        .split("---\n")
        .filter(|message| !message.is_empty())
        .map(|message| format!("- {}\n", message.trim_end().replace('\n', "\n  ")))
        .collect();
    let as_list = read(&list).unwrap();
    assert_eq!(
        as_list.grasps.iter().map(|g| (&g.name, g.x_fh)).collect::<Vec<_>>(),
        [(&first.name, first.x_fh), (&second.name, second.x_fh)]
    );
}

#[test]
fn errors_name_the_line_and_the_key() {
    for (text, replace, with, message) in [
        (
            ISAAC,
            "format_version: 1.0",
            "format_version: 2.0",
            "grasps.yaml:2: format_version: found 2, expected 1.0, the only known version",
        ),
        (ISAAC, "isaac_grasp", "graspit", "grasps.yaml:1: format: found \"graspit\", expected isaac_grasp"),
        (
            ISAAC,
            "w: 0.0",
            "w: 0.5",
            "grasps.yaml:7: grasps.grasp_b: found a quaternion of length 1.118033988749895, expected unit length",
        ),
        (ISAAC, "0.2,", ".nan,", "grasps.yaml:8: non-finite float"),
        (ISAAC, "0.2, ", "", "grasps.yaml:8: "),
        (ISAAC, "    orientation: {w: 0.0, xyz: [1.0, 0.0, 0.0]}\n", "", "grasps.yaml:10: missing field `orientation`"),
        (ISAAC, "grasp_a", "grasp_b", "grasps.yaml:12: duplicate mapping key: grasp_b"),
        (
            MOVEIT,
            "---\nid: ''",
            "---\nid: first",
            "grasps.yaml:24: first.grasp_pose: found the name first again, expected every name once",
        ),
        (MOVEIT, "w: 0.0", "w: zero", "grasps.yaml:19: "),
        (
            MOVEIT,
            "w: 0.0",
            "w: 0.1",
            "grasps.yaml:1: first.grasp_pose: found a quaternion of length 1.004987562112089, expected unit length",
        ),
    ] {
        assert!(text.contains(replace));
        let error = read(&text.replacen(replace, with, 1)).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
    for (text, message) in [
        (
            "",
            "grasps.yaml: found no keys, expected `format: isaac_grasp` with `grasps`, or messages of moveit_msgs/Grasp with `grasp_pose`",
        ),
        (
            "poses: 3\n",
            "grasps.yaml: found the keys poses, expected `format: isaac_grasp` with `grasps`, or messages of moveit_msgs/Grasp with `grasp_pose`",
        ),
        ("format: isaac_grasp\ngrasps: {}\n", "grasps.yaml: found no grasp, expected at least one"),
    ] {
        assert_eq!(read(text).unwrap_err(), message);
    }
}
