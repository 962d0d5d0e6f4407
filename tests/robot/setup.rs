//! Descriptions that are written from a URDF.

use std::path::{Path, PathBuf};

use benchdog::{
    collision::CollisionModel,
    robot::{Chain, Robot},
    setup::{Overlaps, Reason, Setup, SetupError, SetupInput, middle, positions, setup},
};

use crate::common::{baxter, root};

fn made_from(urdf: &str) -> Setup {
    let input = SetupInput { urdf: root().join("assets").join(urdf), ..SetupInput::default() };
    setup(&input, Path::new("")).unwrap()
}

/// What is found of Baxter is what its description was written with by hand.
#[test]
fn baxter_is_found_as_it_is_described() {
    let Setup { robot, clamps, .. } = made_from("baxter.urdf");
    assert_eq!(clamps, []);
    for (found, expected) in robot.arms.iter().zip(&baxter().arms) {
        assert_eq!((&found.name, &found.joints), (&expected.name, &expected.joints));
        assert_eq!(found.effort_nm[0], expected.effort_nm[0]);
        let (gripper, by_hand) = (&found.gripper, &expected.gripper);
        assert_eq!((gripper.frame_link, gripper.palm_link), (by_hand.frame_link, by_hand.palm_link));
        for (finger, by_hand) in gripper.fingers.iter().zip(&by_hand.fingers) {
            assert_eq!((finger.joint, finger.pad.link), (by_hand.joint, by_hand.pad.link));
            assert_eq!(finger.pad.offset_m, by_hand.pad.offset_m);
            // The pads were measured on the tips; the boxes are a few millimetres larger.
            for (side, by_hand) in finger.pad.size_m.iter().zip(by_hand.pad.size_m) {
                assert!((side - by_hand).abs() < 0.004, "{side} {by_hand}");
            }
        }
        // Published gaps are rounded to 0.1 mm, and openings inside what the joints allow.
        assert!((gripper.opening_m[1] - by_hand.opening_m[1]).abs() <= 1.01e-4, "{:?}", gripper.opening_m);
    }
    for arm in 0..2 {
        let q_rad = [0.1, -0.2, 0.3, 0.4, -0.5, 0.6, -0.7];
        let pose = |robot: &Robot| Chain::new(robot, arm, 0.01).gripper_pose(&q_rad);
        assert_eq!(pose(&robot), pose(baxter()));
    }
}

/// What may overlap by hand and moves against each other may overlap by the sample.
#[test]
fn allowed_collisions_are_found() {
    let Setup { robot, allowed, .. } = made_from("baxter.urdf");
    let pairs = CollisionModel::new(baxter()).link_pairs();
    let missing: Vec<_> =
        CollisionModel::new(&robot).link_pairs().into_iter().filter(|pair| !pairs.contains(pair)).collect();
    assert_eq!(missing, Vec::<[usize; 2]>::new(), "checked, but allowed by hand");
    assert!(allowed.iter().any(|pair| pair.reason == Reason::Adjacent));
    // Nothing overlaps in the posture that is recorded, and many random postures are free.
    let x_wl = robot.link_poses(&positions(&robot, &middle(&robot), 0.5));
    assert_eq!(CollisionModel::new(&robot).overlapping_links(&x_wl), Vec::<[usize; 2]>::new());
    assert!(Overlaps::of(&robot).free > 0.2);
}

/// Points lie on the surface; floor and search box are those of a robot of this size.
#[test]
fn the_rest_of_a_description_is_plausible() {
    for urdf in ["baxter.urdf", "dual-panda.urdf", "dual-ur5.urdf"] {
        let Setup { robot, .. } = made_from(urdf);
        assert!((20..=150).contains(&robot.body_points.len()), "{urdf}: {}", robot.body_points.len());
        for point in &robot.body_points {
            let shapes = robot.links[point.link].shapes.iter();
            let nearest =
                shapes.flat_map(|placed| placed.shape.surface_points().into_iter().map(|p_s| placed.x_ls * p_s));
            let nearest = nearest.map(|p_l| (p_l - point.p_l).norm()).fold(f64::INFINITY, f64::min);
            // Written in tenths of a millimetre: half a tenth along each axis.
            assert!(nearest < 1e-4, "{urdf}: {nearest}");
        }
        let search = robot.search_box.unwrap();
        assert!(search.x_m[0] > 0.0 && search.x_m[1] < 1.2, "{urdf}: {search:?}");
        // Symmetric robots, up to the grid of the sample.
        assert!((search.y_m[0] + search.y_m[1]).abs() < 0.25, "{urdf}: {search:?}");
        let height_m = search.z_m.map(|z_m| z_m - robot.floor_z_m);
        assert!(height_m[0] >= 0.5 && height_m[1] <= 1.6, "{urdf}: {height_m:?}");
    }
}

#[test]
fn equal_urdfs_give_equal_texts() {
    assert_eq!(made_from("dual-panda.urdf").text, made_from("dual-panda.urdf").text);
}

#[test]
fn a_urdf_without_arms_and_a_broken_srdf_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| -> PathBuf {
        std::fs::write(folder.path().join(name), text).unwrap();
        folder.path().join(name)
    };
    let table = file("table.urdf", "<robot name=\"table\"><link name=\"top\"/></robot>");
    let no_arm = setup(&SetupInput { urdf: table.clone(), ..SetupInput::default() }, folder.path()).unwrap_err();
    assert!(matches!(&no_arm, SetupError::NoArm { .. }), "{no_arm}");
    for (text, expected) in [
        ("<robot", "found malformed xml"),
        ("<html/>", "found the element html, expected an SRDF"),
        ("<robot>\n<disable_collisions link1=\"a\"/></robot>", "line 2: found disable_collisions without link2"),
    ] {
        let srdf = Some(file("robot.srdf", text));
        let error =
            setup(&SetupInput { urdf: table.clone(), srdf, ..SetupInput::default() }, folder.path()).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}

/// Pairs of an SRDF may overlap; names that the URDF does not have are no error, since one SRDF may be for several robots.
#[test]
fn an_srdf_adds_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let srdf = folder.path().join("robot.srdf");
    let text = "<robot name=\"baxter\"><disable_collisions link1=\"torso\" link2=\"right_wrist\" reason=\"Never\"/>\
                <disable_collisions link1=\"torso\" link2=\"tail\" reason=\"Never\"/></robot>";
    std::fs::write(&srdf, text).unwrap();
    let urdf = root().join("assets/baxter.urdf");
    let made = setup(&SetupInput { urdf, srdf: Some(srdf), packages: Vec::new() }, folder.path()).unwrap();
    let by_srdf: Vec<_> = made.allowed.iter().filter(|pair| pair.reason == Reason::Srdf).collect();
    assert_eq!(by_srdf.len(), 1);
    let links = by_srdf[0].links.map(|link| made.robot.links[link].name.as_str());
    assert_eq!(links, ["torso", "right_wrist"]);
}

/// An arm of six joints named after the left side, 0.15 m apart, with a hand on the link `palm`.
fn arm_with(hand: &str) -> String {
    let inertial = "<inertial><mass value=\"1\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial>";
    let names = ["base", "a", "b", "c", "d", "e", "palm"];
    let links = names.map(|name| format!("<link name=\"{name}\">{inertial}</link>"));
    let joints = names.windows(2).enumerate().map(|(number, pair)| {
        let axis = if number % 2 == 0 { "0 0 1" } else { "0 1 0" };
        format!(
            "<joint name=\"L{number}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}\"/><origin xyz=\"0 0 0.15\"/>\
             <axis xyz=\"{axis}\"/><limit lower=\"-2\" upper=\"2\" effort=\"50\" velocity=\"1\"/></joint>",
            pair[0], pair[1]
        )
    });
    format!("<robot name=\"arm\">{}{}{hand}</robot>", links.concat(), joints.collect::<String>())
}

fn made_of(urdf: &str) -> Setup {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.urdf");
    std::fs::write(&path, urdf).unwrap();
    setup(&SetupInput { urdf: path, ..SetupInput::default() }, folder.path()).unwrap()
}

/// A link with boxes at these places with these sides, each `x y z`, m.
fn link_of(name: &str, boxes: &[[&str; 2]]) -> String {
    let shape = |[xyz, size]: &[&str; 2]| {
        format!("<collision><origin xyz=\"{xyz}\"/><geometry><box size=\"{size}\"/></geometry></collision>")
    };
    let shapes: String = boxes.iter().map(shape).collect();
    format!(
        "<link name=\"{name}\"><inertial><mass value=\"0.1\"/><inertia ixx=\"1e-4\" ixy=\"0\" ixz=\"0\" iyy=\"1e-4\" iyz=\"0\" \
         izz=\"1e-4\"/></inertial>{shapes}</link>"
    )
}

fn joint_of(name: &str, kind: &str, [parent, child]: [&str; 2], [xyz, axis]: [&str; 2], rest: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/><origin xyz=\"{xyz}\"/>\
         <axis xyz=\"{axis}\"/>{rest}</joint>"
    )
}

/// A finger whose link also has a block that reaches across the middle plane: the gap is that of the parts which face each other.
#[test]
fn a_block_across_the_middle_plane_is_no_pad() {
    let limit = "<limit lower=\"0\" upper=\"0.03\" effort=\"20\" velocity=\"1\"/>";
    // Faces at 0.01 m from the middle with the joints at 0. The block is beside them along x.
    let pad = |y: &'static str| ["0 ".to_owned() + y + " 0.05", "0.02 0.01 0.03".to_owned()];
    let [left, right] = [pad("0.015"), pad("-0.015")];
    let hand = [
        link_of("left", &[[&left[0], &left[1]], ["0.04 0 0.05", "0.02 0.04 0.03"]]),
        link_of("right", &[[&right[0], &right[1]]]),
        joint_of("slide_left", "prismatic", ["palm", "left"], ["0 0 0.05", "0 1 0"], limit),
        joint_of("slide_right", "prismatic", ["palm", "right"], ["0 0 0.05", "0 -1 0"], limit),
    ];
    let made = made_of(&arm_with(&hand.concat()));
    let gripper = &made.robot.arms[0].gripper;
    assert_eq!(gripper.opening_m, [0.02, 0.08]);
    assert_eq!(gripper.fingers[0].pad.size_m, [0.02, 0.03]);
    for finger in &gripper.fingers {
        assert!((finger.pad.offset_m - 0.01).abs() < 1e-12, "{}", finger.pad.offset_m);
    }
}

/// Two fingertips on one side, between them one on the other: no two of them face each other, but the two do face the one.
fn three_fingertips() -> String {
    let limit = "<limit lower=\"-0.1\" upper=\"0.6\" effort=\"10\" velocity=\"1\"/>";
    let mimic = |times: &str| format!("{limit}<mimic joint=\"drive\" multiplier=\"{times}\"/>");
    let tip = |name: &str| link_of(name, &[["0 0 0.01", "0.02 0.01 0.04"]]);
    [
        link_of("upper", &[["0 0.01 0.02", "0.08 0.004 0.03"]]),
        link_of("lower", &[["0 -0.01 0.02", "0.02 0.004 0.03"]]),
        tip("tip_1"),
        tip("tip_2"),
        tip("tip_3"),
        joint_of("drive", "revolute", ["palm", "upper"], ["0 0.02 0.05", "-1 0 0"], limit),
        joint_of("follow", "revolute", ["palm", "lower"], ["0 -0.02 0.05", "1 0 0"], &mimic("1")),
        joint_of("level_1", "revolute", ["upper", "tip_1"], ["0.03 0 0.06", "-1 0 0"], &mimic("-1")),
        joint_of("level_2", "revolute", ["upper", "tip_2"], ["-0.03 0 0.06", "-1 0 0"], &mimic("-1")),
        joint_of("level_3", "revolute", ["lower", "tip_3"], ["0 0 0.06", "1 0 0"], &mimic("-1")),
    ]
    .concat()
}

#[test]
fn links_that_move_as_one_are_a_pad() {
    let made = made_of(&arm_with(&three_fingertips()));
    assert_eq!(made.clamps, []);
    assert!(made.text.contains("pad_link = \"tip_1\", beside = [\"tip_2\"]"), "{}", made.text);
    // The middle fingertip's width and length.
    assert_eq!(made.robot.arms[0].gripper.fingers[0].pad.size_m, [0.02, 0.04]);
    let index = |robot: &Robot, name: &str| robot.link_index(name).unwrap();
    for gap_m in [0.02, 0.03, 0.06] {
        let robot = made.robot.at_gap(gap_m);
        let gripper = &robot.arms[0].gripper;
        let finger_travel_m = [0, 1].map(|finger| gripper.travel_for_gap_m(finger, gap_m + 0.004));
        let state = benchdog::robot::ArmState { arm: 0, q_rad: &[0.1, 0.2, -0.3, 0.4, 0.5, -0.6], finger_travel_m };
        let x_wl = robot.link_poses(&robot.positions(&[state]));
        let in_g = |name: &str| x_wl[gripper.frame_link].inverse() * x_wl[index(&robot, name)];
        // All fingertips slide apart to the wider gap, half their thickness outside it.
        for name in ["tip_1", "tip_2", "tip_3"] {
            let y_m = in_g(name).translation.y.abs();
            assert!((y_m - (gap_m + 0.004) / 2.0 - 0.005).abs() < 1e-12, "{name}: {y_m}");
        }
        let apart_m = (in_g("tip_1").translation.vector - in_g("tip_2").translation.vector).norm();
        assert!((apart_m - 0.06).abs() < 1e-12, "{apart_m}");
    }
    let loose = made.text.replace("beside = [\"tip_2\"]", "beside = [\"lower\"]");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.urdf"), arm_with(&three_fingertips())).unwrap();
    let error = Robot::from_text("arm.toml", &loose, folder.path()).unwrap_err().to_string();
    assert!(error.contains("found lower, which moves against tip_1 as the gripper opens"), "{error}");
}

/// The bars that carry the pads may be nearer to the board than other links: they are always beside it.
#[test]
fn bars_of_a_linkage_keep_a_part_of_their_distance() {
    let made = made_of(&arm_with(&three_fingertips()));
    let robot = made.robot.at_gap(0.02);
    let model = CollisionModel::new(&robot);
    let clearance_m = |name: &str| model.board_clearance_m(robot.link_index(name).unwrap(), 0.005);
    assert_eq!(clearance_m("palm"), 0.005);
    for bar in ["upper", "lower"] {
        assert!(clearance_m(bar) > 0.0 && clearance_m(bar) <= 0.005, "{bar}: {}", clearance_m(bar));
    }
    assert_eq!(robot.bars(&robot.arms[0]).len(), 2);
}

/// The joint of a gripper's only finger is not the arm's last one.
#[test]
fn a_single_finger_is_no_joint_of_the_arm() {
    let limit = "<limit lower=\"-0.17\" upper=\"1.7\" effort=\"10\" velocity=\"1\"/>";
    let hand = [
        link_of("jaw", &[["0 0 0.03", "0.02 0.01 0.06"]]),
        joint_of("gripper", "revolute", ["palm", "jaw"], ["0 0 0.05", "1 0 0"], limit),
    ];
    let made = made_of(&arm_with(&hand.concat()));
    assert_eq!(made.robot.arms[0].joints.len(), 6);
    assert_eq!(made.robot.arms[0].name, "arm");
    let [(_, why)] = &made.clamps[..] else { panic!("{:?}", made.clamps) };
    assert!(why.contains("found jaw alone"), "{why}");
}
