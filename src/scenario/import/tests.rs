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

/// The same two poses in all forms.
#[test]
fn bare_matrices() {
    let isaac = read(ISAAC).unwrap();
    let expected = [isaac.grasps[0].x_fh, isaac.grasps[1].x_fh];
    let turned = ["1 0 0 0.1", "0 -1 0 0.2", "0 0 -1 3e-1", "0 0 0 1"];
    let unmoved = ["1.0,0,0,0", "0,1,0,0", "0,0,1,0", "0,0,0,1"];
    let list = |rows: [&str; 4]| format!("[{}]", rows.map(|row| format!("[{}]", row.replace(' ', ","))).join(", "));
    let texts = [
        format!("# from a planner\n{}\n\n{}\n", turned.join("\n"), unmoved.join("\n")),
        format!("{}\n{}\n", turned.join("\t"), unmoved.join(",")),
        format!("[{},\n {}]", list(turned), list(unmoved)),
        format!("[\n  {},\n  {}\n]\n", list(turned), list(unmoved)),
    ];
    for text in &texts {
        let grasps = read(text).unwrap().grasps;
        assert_eq!(
            grasps.iter().map(|grasp| grasp.name.as_str()).collect::<Vec<_>>(),
            ["grasp_0", "grasp_1"],
            "{text}"
        );
        assert!(grasps.iter().all(|grasp| grasp.frame == "object" && grasp.confidence.is_none()));
        for (grasp, expected) in grasps.iter().zip(&expected) {
            assert!((grasp.x_fh.to_homogeneous() - expected.to_homogeneous()).amax() < 1e-15, "{text}");
        }
    }
    assert_eq!(read(&list(turned)).unwrap().grasps[0].x_fh.translation, expected[0].translation);
    let rows = &texts[0];
    for (replace, with, message) in [
        (
            "0 -1 0 0.2",
            "0 -1 0",
            "grasps.yaml:3: matrix: found 3 numbers, expected rows of 4 numbers, four a matrix, or of 16",
        ),
        ("0 -1 0 0.2", "0 -1 x 0.2", "grasps.yaml:3: matrix: found \"x\", expected a number"),
        ("0 -1 0 0.2", "0 -2 0 0.2", "grasps.yaml:2: grasp_0: "),
        (
            "0 0 0 1\n",
            "",
            "grasps.yaml:7: matrix: found a matrix with 12 of 16 numbers, expected four rows of 4 numbers",
        ),
    ] {
        let error = read(&rows.replacen(replace, with, 1)).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
    assert!(read("[[1, 0, 0, 0], [0, 1, 0]]").unwrap_err().starts_with("grasps.yaml:1: "));
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
            "grasps.yaml: found no keys, expected `format: isaac_grasp` with `grasps`, messages of moveit_msgs/Grasp with \
             `grasp_pose`, or 4x4 matrices",
        ),
        (
            "poses: 3\n",
            "grasps.yaml: found the keys poses, expected `format: isaac_grasp` with `grasps`, messages of moveit_msgs/Grasp with \
             `grasp_pose`, or 4x4 matrices",
        ),
        ("format: isaac_grasp\ngrasps: {}\n", "grasps.yaml: found no grasp, expected at least one"),
    ] {
        assert_eq!(read(text).unwrap_err(), message);
    }
}
