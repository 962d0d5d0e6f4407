//! The commands `margin` and `export`.

use std::fs;

use benchdog::{
    model::{
        GRAVITY_W,
        scenario::{Limits, SimulationSettings},
    },
    robot::{Chain, Robot},
    scenario::{load_plan, read_plan},
    sim::{Conditions, mjcf},
};
use quick_xml::{Reader, events::Event};
use serde_json::Value;

use crate::{
    common::{checked, root},
    process::{argument, benchdog, folder, json, stderr},
};

/// Runs benchdog in the repository; returns all that it prints, and the exit code.
fn printed(arguments: &[&str]) -> (String, Option<i32>) {
    let output = benchdog(root(), arguments);
    (String::from_utf8_lossy(&output.stdout).into_owned() + &stderr(&output), output.status.code())
}

#[test]
fn a_margin_agrees_with_the_predictions() {
    let (text, code) = printed(&["margin", "tests/data/holds/cut-04.json", "--format", "json"]);
    assert_eq!(code, Some(0), "{text}");
    let margin: Value = serde_json::from_str(&text).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let (holds, fails) = (number(&margin["load_factor"]), number(&margin["fails_at"]));
    assert!(fails > holds && fails - holds <= 1e-3 * fails);
    assert_eq!(margin["ended_by"], "pivots");
    // The failed check exceeds its limit at the failing load.
    assert_eq!(margin["check"]["name"], "slip_rotation");
    assert!(number(&margin["check"]["value"]) > number(&margin["check"]["limit"]));
    let predicted = &margin["predicted"];
    // The load factor is an upper bound; the compliant one is accurate to 10 %.
    assert!(holds < number(&predicted["best_case"]));
    assert!((number(&predicted["compliant"]) / holds - 1.0).abs() < 0.1);
}

#[test]
fn a_margin_below_one_is_exit_code_1() {
    let (text, code) = printed(&["margin", "scenarios/plans/long-lever.json"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("FAIL") && text.contains("then deflects (deflection "), "{text}");
}

/// A person who does not see the work is no margin of the load.
#[test]
fn a_plan_whose_person_does_not_see_the_work_has_no_margin() {
    let plan = "scenarios/plans/looks-down.json";
    let (text, code) = printed(&["margin", plan]);
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("not_visible: human.posture.view_deg: found 91"), "{text}");
    assert!(text.contains("not_visible: human.posture.face_elevation_deg: found -51.964"), "{text}");
    let (text, code) = printed(&["margin", plan, "--scenario", "scenarios/fails-not-visible.toml"]);
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn a_margin_says_what_larger_limits_and_uncertainty_change() {
    let folder = tempfile::tempdir().unwrap();
    let plan = "tests/data/holds/cut-04.json";
    let scenario = folder.path().join("slippery.toml");
    // The plan's operation, with slippery pads.
    let text = r#"
        format = 1
        name = "slippery"
        operation = { kind = "cut", point_m = [0.04592201188381078, 0.1108655439013544], direction_o = [-27.716385975338603, 11.480502970952696, 0.0], force_n = 30.0 }
        uncertainty = { friction_scale = 0.8 }
    "#;
    fs::write(&scenario, text).unwrap();
    let (text, _) = printed(&["margin", plan, "--scenario", argument(&scenario), "--format", "json"]);
    let margin: Value = serde_json::from_str(&text).unwrap();
    let predicted = &margin["predicted"];
    let number = |value: &Value| value.as_f64().unwrap();
    let (best, bound) = (number(&predicted["best_case"]), number(&predicted["best_case_bound"]));
    // The certificate bounds the best case, and tightly.
    assert!(bound >= best - 1e-5 * best && bound <= best + 1e-4 * best, "{best} {bound}");
    let robust = &predicted["robust"];
    assert_eq!(number(&robust["friction_scale"]), 0.8);
    assert!(number(&robust["load_factor"]) < best && number(&robust["load_factor"]) > 0.0, "{robust}");
    let gains: Vec<f64> =
        predicted["gains"].as_array().unwrap().iter().map(|gain| number(&gain["load_factor"])).collect();
    assert!(!gains.is_empty() && gains.is_sorted_by(|one, other| one >= other), "{gains:?}");
}

/// All start tags of a document with their attributes; panics if it is not well formed.
fn elements(text: &str) -> Vec<(String, Vec<(String, String)>)> {
    let mut reader = Reader::from_str(text);
    let mut found = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Eof => return found,
            Event::Start(tag) | Event::Empty(tag) => {
                let name = String::from_utf8(tag.name().as_ref().to_vec()).unwrap();
                let attributes = tag.attributes().map(|attribute| {
                    let attribute = attribute.unwrap();
                    let key = String::from_utf8(attribute.key.as_ref().to_vec()).unwrap();
                    (key, String::from_utf8(attribute.value.to_vec()).unwrap())
                });
                found.push((name, attributes.collect()));
            }
            _ => {}
        }
    }
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|number| number.parse().unwrap()).collect()
}

/// The elements of a document.
struct Exported(Vec<(String, Vec<(String, String)>)>);

impl Exported {
    /// The scene of a plan of the repository, exported with these further arguments.
    fn of(plan: &str, arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("scene.xml");
        let (text, code) = printed(&[&["export", plan, "--mjcf", argument(&file)], arguments].concat());
        assert_eq!(code, Some(0), "{text}");
        Self(elements(&fs::read_to_string(&file).unwrap()))
    }

    /// The attributes of all elements with a tag.
    fn all(&self, tag: &str) -> Vec<&[(String, String)]> {
        self.0.iter().filter(|element| element.0 == tag).map(|element| element.1.as_slice()).collect()
    }

    /// The attributes of the element with a tag and a name.
    fn named(&self, tag: &str, name: &str) -> &[(String, String)] {
        let found = self.all(tag).into_iter().find(|attributes| get(attributes, "name") == name);
        found.unwrap_or_else(|| panic!("no {tag} {name}"))
    }

    /// A numeric field.
    fn field(&self, name: &str) -> Vec<f64> {
        numbers(get(self.named("numeric", name), "data"))
    }

    /// The tool's wrenches, six numbers a sample.
    fn tool_wrenches_o(&self) -> Vec<f64> {
        let fields = self.all("numeric").into_iter();
        let tables = fields.filter(|numeric| get(numeric, "name").starts_with("tool_wrench_o "));
        tables.flat_map(|numeric| numbers(get(numeric, "data"))).collect()
    }
}

fn get<'a>(attributes: &'a [(String, String)], key: &str) -> &'a str {
    attributes.iter().find(|(name, _)| name == key).map(|(_, value)| value).unwrap()
}

#[test]
fn an_exported_scene_has_the_masses_joints_gains_and_load_of_the_plan() {
    let scene = Exported::of("scenarios/plans/cut-rim.json", &[]);
    let (plan, robot) = read_plan(&root().join("scenarios/plans/cut-rim.json"), None).unwrap();

    let mass_kg: f64 = scene.all("inertial").iter().map(|inertial| get(inertial, "mass").parse::<f64>().unwrap()).sum();
    let expected_kg = moving_mass_kg(&robot) + plan.object.mass_kg;
    assert!((mass_kg - expected_kg).abs() < 1e-12 * expected_kg, "{mass_kg} {expected_kg}");
    assert_eq!(numbers(get(scene.all("option")[0], "gravity")), GRAVITY_W.as_slice());

    let servos = scene.all("general");
    assert_eq!(servos.len(), 14);
    let arm = &robot.arms[robot.arm_index("left").unwrap()];
    let left: Vec<f64> = servos.iter().take(7).map(|servo| get(servo, "gainprm").parse().unwrap()).collect();
    assert_eq!(left, arm.stiffness_nm_rad);
    // Two fingers a hand, and force and moment of the tool along three axes.
    assert_eq!(scene.all("motor").len(), 4 + 6);

    // The full load in the middle of the hold: 0.5 s settle, 1 s ramp, 0.5 s hold at 2 ms.
    let rows = scene.tool_wrenches_o();
    let wrench: [f64; 6] = plan.operation.wrench_o.into();
    assert_eq!(rows[6 * 1000..6 * 1001], wrench);
    assert_eq!(rows[6 * 250..6 * 251], [0.0; 6]);
    // Nine joints per arm and the board's seven numbers; the plan's angles come first.
    let positions = numbers(get(scene.named("key", "planned"), "qpos"));
    assert_eq!(positions.len(), 25);
    assert_eq!(positions[..7], plan.arms[0].q_rad[..]);
}

/// Verdict, export and library name the same force, in the worst direction.
#[test]
fn a_sideways_push_is_in_the_verdict_and_in_the_exported_scene() {
    let plan = "scenarios/plans/cut-rim.json";
    let text = fs::read_to_string(root().join("scenarios/cut-rim.toml")).unwrap() + "\n[load]\nlateral_share = 0.2\n";
    let folder = folder(&[("pushed.toml", &text)]);
    let (scenario, out) = (folder.path().join("pushed.toml"), folder.path().join("out"));
    let given = ["--scenario", argument(&scenario)];

    let loaded = load_plan(&root().join(plan), Some(&scenario)).unwrap();
    let checked = checked(&loaded.robot, &loaded.plan);
    let push = Conditions::of(&loaded.scenario).lateral_push(&checked).unwrap();
    // 0.2 of 30 N, perpendicular to a cut along y_O.
    let [x_n, y_n, z_n] = push.force_o_n;
    assert!((x_n.hypot(z_n) - 6.0).abs() < 1e-9 && y_n.abs() < 1e-9, "{push}");

    let rows = Exported::of(plan, &given).tool_wrenches_o();
    let mut wrench: [f64; 6] = loaded.plan.operation.wrench_o.into();
    wrench[..3].iter_mut().zip(push.force_o_n).for_each(|(of_tool, of_push)| *of_tool += of_push);
    assert_eq!(rows[6 * 1000..6 * 1001], wrench);

    let (said, code) = printed(&[&["simulate", plan, "--out", argument(&out)], &given[..]].concat());
    assert!([Some(0), Some(1)].contains(&code), "{said}");
    let note =
        format!("the hand also pushes sideways with 0.2 of the force, {push}, the worst direction by the statics");
    assert!(said.contains(&note), "{said}");
    let written = json(&out.join("cut-rim/verdict.json"));
    assert!(written["notes"].as_array().unwrap().contains(&Value::String(note)), "{written}");
}

#[test]
fn exported_elastic_pads_are_the_springs_of_the_hand() {
    let (plan, mut robot) = read_plan(&root().join("scenarios/plans/cut-rim.json"), None).unwrap();
    robot.arms.iter_mut().for_each(|arm| arm.gripper.holding.pads_mut().unwrap().pad_stiffness_n_m = Some(8e5));
    let checked = checked(&robot, &plan);
    let conditions = Conditions::new(0.6, SimulationSettings::default());
    let scene = Exported(elements(&mjcf(&checked, &conditions, &Limits::CUT).unwrap()));
    // Two pads in parallel; in the plane of the face two thirds of that (docs/method.md#612-pad-compliance).
    let stiffness = |number: usize| -> f64 {
        get(scene.named("joint", &format!("left pads {number}")), "stiffness").parse().unwrap()
    };
    assert!((stiffness(3) - 1.6e6).abs() < 1e-6 && (stiffness(1) - 1.6e6 * 2.0 / 3.0).abs() < 1e-6);
    let [a, b] = [0.0202, 0.018].map(|half: f64| half * half / 3.0);
    assert!((stiffness(6) - 1.6e6 * 2.0 / 3.0 * (a + b)).abs() < 1e-6, "{}", stiffness(6));
    // The rest positions carry the hand's weight: together the slides have its force.
    let rest_n = |number: usize| {
        let joint = scene.named("joint", &format!("left pads {number}"));
        get(joint, "springref").parse::<f64>().unwrap() * stiffness(number)
    };
    let carried_n = (1..=3).map(|number| rest_n(number).powi(2)).sum::<f64>().sqrt();
    let hand_kg: f64 = robot.links.iter().filter(|link| is_of_hand(&link.name)).map(|link| link.mass_kg).sum();
    assert!((carried_n - 9.81 * hand_kg).abs() < 1e-9, "{carried_n} {hand_kg}");
    // Six more positions a hand, zero in the planned state.
    assert_eq!(numbers(get(scene.named("key", "planned"), "qpos")).len(), 25 + 12);
}

fn is_of_hand(link: &str) -> bool {
    link.starts_with("left_gripper") || link.starts_with("l_gripper")
}

#[test]
fn an_exported_scene_says_what_its_player_needs() {
    let (plan, scenario) = ("scenarios/plans/cut-rim.json", "scenarios/fails-slippery-pads.toml");
    let scene = Exported::of(plan, &["--scenario", scenario]);
    let (plan, _) = read_plan(&root().join(plan), None).unwrap();
    // 0.05 s grip and 0.45 s settle, 1 s ramp, 1 s hold, 0.5 s release and 0.15 s hand-over at 2 ms
    // (docs/method.md#74-phases).
    assert_eq!(scene.field("tool_timestep_s"), [0.002]);
    assert_eq!(scene.field("phase_samples"), [25.0, 225.0, 500.0, 500.0, 250.0]);
    assert_eq!(scene.field("hand_over_samples"), [75.0]);
    assert_eq!(scene.field("grip_force_n"), [30.0, 30.0]);
    // The default limits of a cut (docs/method.md#810-default-limits).
    let limits = ["slip_mm", "slip_deg", "sag_mm", "deflection_mm", "creep_mm_s", "torque_ratio"];
    let limits = limits.map(|name| scene.field(&format!("limit_{name}"))[0]);
    assert_eq!(limits, [1.0, 2.0, 10.0, 15.0, 0.1, 1.0]);
    assert_eq!(get(scene.named("text", "tool_frame"), "data"), "board");
    let hands: Vec<&str> = get(scene.named("text", "hands"), "data").split("; ").collect();
    assert_eq!(hands, plan.arms.iter().map(|arm| arm.name.as_str()).collect::<Vec<_>>());
    for hand in hands {
        scene.named("site", &format!("{hand} hand"));
    }
    // The friction is that of the scenario.
    assert!(scene.all("pair").iter().all(|pair| numbers(get(pair, "friction"))[..2] == [0.2, 0.2]));
    // MuJoCo 3 reads at most 500 numbers a field.
    assert!(scene.all("numeric").iter().all(|numeric| numbers(get(numeric, "data")).len() <= 500));
    // The tool's motors come last; the key frame `loaded` has the full load.
    let controls = numbers(get(scene.named("key", "loaded"), "ctrl"));
    assert_eq!(controls[controls.len() - 6..], <[f64; 6]>::from(plan.operation.wrench_o));
}

/// Before the hand-over the servos carry the arms alone, after it the board too: the difference is what a player
/// subtracts.
#[test]
fn an_exported_scene_says_what_the_board_adds_to_the_controls() {
    let scene = Exported::of("scenarios/plans/cut-rim.json", &[]);
    let (plan, robot) = read_plan(&root().join("scenarios/plans/cut-rim.json"), None).unwrap();
    let controls = numbers(get(scene.named("key", "planned"), "ctrl"));
    let board_control = scene.field("board_control 0");
    // Two arms of seven joints and two fingers, and the tool's motors.
    assert_eq!((controls.len(), board_control.len()), (24, 24));
    let mut not_carried_n = GRAVITY_W * -plan.object.mass_kg;
    for (hold, start) in plan.arms.iter().zip([0, 9]) {
        let index = robot.arm_index(&hold.name).unwrap();
        let (arm, chain) = (&robot.arms[index], Chain::new(&robot, index, 0.0));
        let weight_nm = chain.gravity_torque_nm(&hold.q_rad);
        let mut board_nm = weight_nm.clone();
        for k in 0..7 {
            let stiffness_nm_rad = arm.stiffness_nm_rad[k];
            let fed_nm = stiffness_nm_rad * (controls[start + k] - hold.q_rad[k]);
            board_nm[k] = stiffness_nm_rad * board_control[start + k];
            // Rounding of angles of a radian times 843 N m/rad.
            assert!((fed_nm - board_nm[k] - weight_nm[k]).abs() < 1e-11, "{} {k}", hold.name);
        }
        assert_eq!(board_control[start + 7..start + 9], [0.0; 2]);
        // The wrench of the hand on the board with these torques; there are more joints than its components.
        let jacobian = chain.jacobian_w(&hold.q_rad);
        let wrench = (&jacobian * jacobian.transpose()).try_inverse().unwrap() * &jacobian * &board_nm;
        not_carried_n -= wrench.fixed_rows::<3>(0);
    }
    assert_eq!(board_control[18..], [0.0; 6]);
    // Rounding of torques of a newton metre, divided by arms of a decimetre.
    assert!(not_carried_n.norm() < 1e-11, "{not_carried_n}");
}

/// Every body is seen, also those that do not move, and nothing collides but the pairs of pads and board.
#[test]
fn the_robot_in_an_exported_scene_is_visible_and_collides_with_nothing() {
    let scene = Exported::of("scenarios/plans/cut-rim.json", &[]);
    let (_, robot) = read_plan(&root().join("scenarios/plans/cut-rim.json"), None).unwrap();
    for geom in scene.all("geom") {
        assert_eq!([get(geom, "contype"), get(geom, "conaffinity"), get(geom, "mass")], ["0"; 3]);
        assert!(numbers(get(geom, "rgba"))[3] > 0.0);
    }
    let shapes: usize = robot.links.iter().map(|link| link.shapes.len()).sum();
    let seen = scene.all("geom").iter().filter(|geom| get(geom, "name").contains(" shape ")).count();
    assert!(shapes > 0 && seen == shapes, "{seen} {shapes}");
    // Of nested elements the last body before a geom need not be its parent, but the exporter writes the geoms of a body
    // before its children.
    let mut body = "world";
    let mut without = Vec::new();
    for (tag, attributes) in &scene.0 {
        match tag.as_str() {
            "body" => {
                body = get(attributes, "name");
                without.push(body);
            }
            "geom" => without.retain(|&name| name != body),
            _ => {}
        }
    }
    assert_eq!(without, Vec::<&str>::new());
}

/// Impedance and recess come from the same compliance: the core's corners penetrate by their share of the grip force, and the
/// face is three times as far behind (docs/method.md#77-the-scene-for-mujoco).
#[test]
fn the_recess_of_exported_pads_is_that_of_their_contacts() {
    for scale in [1.0, 0.25] {
        let folder = tempfile::tempdir().unwrap();
        let scenario = folder.path().join("soft.toml");
        let text = fs::read_to_string(root().join("scenarios/cut-rim.toml")).unwrap();
        fs::write(&scenario, format!("{text}\n[uncertainty]\ncontact_stiffness_scale = {scale:?}\n")).unwrap();
        let scene = Exported::of("scenarios/plans/cut-rim.json", &["--scenario", argument(&scenario)]);
        let board_kg: f64 = get(scene.all("inertial").last().unwrap(), "mass").parse().unwrap();
        for pad in get(scene.named("text", "pads"), "data").split("; ") {
            let part = |name: &str| numbers(get(scene.named("geom", &format!("{pad} {name}")), "pos"))[1].abs();
            let recess_m = (part("face") - part("core")).abs();
            let pairs = scene.all("pair");
            let pair = pairs.iter().find(|pair| get(pair, "geom1") == format!("{pad} core")).unwrap();
            let (t, d) = (numbers(get(pair, "solref"))[0], numbers(get(pair, "solimp"))[0]);
            // 0.83 / 4 of 30 N; MuJoCo's inverse mass of a Baxter finger with a drive of 0.3 kg is 1.944 1/kg, which MuJoCo
            // reports as `body_invweight0`; the estimate in the file differs by a per cent.
            let penetration_m = 0.83 / 4.0 * 30.0 * (1.0 - d) * t * t * (1.944 + 1.0 / board_kg);
            assert!((recess_m / (3.0 * penetration_m) - 1.0).abs() < 0.01, "{pad}: {recess_m} {penetration_m}");
        }
    }
}

/// Mass of all links that arm and finger joints move, kg.
fn moving_mass_kg(robot: &Robot) -> f64 {
    let moves = |joint: usize| {
        robot
            .arms
            .iter()
            .any(|arm| arm.joints.contains(&joint) || arm.gripper.fingers.iter().any(|finger| finger.joint == joint))
    };
    let is_moved = |mut link: usize| {
        while let Some(joint) = robot.links[link].parent_joint {
            if moves(joint) {
                return true;
            }
            link = robot.joints[joint].parent_link;
        }
        false
    };
    (0..robot.links.len()).filter(|&link| is_moved(link)).map(|link| robot.links[link].mass_kg).sum()
}
