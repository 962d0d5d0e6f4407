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
