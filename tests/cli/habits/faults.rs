//! All faults of a file at once, and what a mistyped name may have meant.

use std::fs;

use crate::{
    bad_input::{PLAN, SCENARIO, assert_plan_refused, assert_refused, assert_scenario_refused},
    common::root,
    process::{benchdog, folder, stderr},
};

/// The standard error of `run` on a scenario.
#[track_caller]
fn refused(text: &str) -> String {
    let folder = folder(&[("bad.toml", text)]);
    let output = benchdog(folder.path(), &["run", "bad.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "files were written");
    stderr(&output)
}

#[test]
fn keys_types_and_values_are_listed_together_in_the_order_of_their_lines() {
    let text = "format = 1
name = \"bad\"
colour = \"blue\"

[human]
hight_m = 1.8
percentile = 120

[operation]
kind = \"drill\"
point_m = [0.0, 0.0]
force_n = 15.0

[grip]
friction = \"high\"

[simulation]
settle_s = -1.0
ramp_s = 0.0

[limits]
slip_mm = [1.0]
sag_mm = 0.0
";
    assert_eq!(
        refused(text),
        "error: bad.toml:3: colour: unknown field `colour`, expected one of `format`, `name`, `robot`, `human`, `tool`, `object`, \
         `operation`, `task`, `comfort`, `planner`, `grip`, `simulation`, `load`, `uncertainty`, `sweep`, `limits`, `expect`
bad.toml:6: human.hight_m: unknown field `hight_m`, expected one of `height_m`, `mass_kg`, `sex`, `hand`, `percentile`, `lean_deg`, \
         `shoulder`, `posture`, `facing_deg`, `view_deg`, `gaze_yaw_deg`, `gaze_pitch_deg`, `eye_distance_m`, `line_of_sight`, \
         `face_elevation_deg`, `upper_arm_deg`, `reach`, `elbow_deg`, `limit_margin_deg`, `deviation_margin_deg`, `place`, `x_m`, \
         `y_m`, `heading_deg`, `place_tolerance_m`, `heading_tolerance_deg`; did you mean \"height_m\"?
bad.toml:15: grip.friction: invalid type: string \"high\", expected f64
bad.toml:18: simulation.settle_s: found -1, expected a positive number (s)
bad.toml:19: simulation.ramp_s: found 0, expected a positive number (s)
bad.toml:22: limits.slip_mm: invalid type: sequence, expected f64
6 faults in bad.toml
"
    );
}

/// Values of a section whose keys or types are wrong may follow from those.
#[test]
fn what_follows_from_another_fault_is_not_listed() {
    for (replace, with, message) in [
        // The force is there, under another name.
        ("force_n = 15.0", "forc_n = 15.0", "bad.toml:10: operation.forc_n: unknown field `forc_n`"),
        ("kind = \"drill\"", "knd = \"drill\"", "bad.toml:8: operation.knd: unknown field `knd`"),
        // Its other keys belong to the kind.
        (
            "kind = \"drill\"",
            "kind = \"dril\"",
            "bad.toml:8: operation.kind: unknown variant `dril`, expected one of `drill`, `cut`, `wrench`; did you mean \"drill\"?",
        ),
        ("name = \"bad\"", "nam = \"bad\"", "bad.toml:2: nam: unknown field `nam`"),
        ("format = 1", "format = \"1\"", "bad.toml:1: format: invalid type: string \"1\", expected u32"),
        // The point may be on the board that was meant.
        (
            "size_m = [0.50, 0.40, 0.030]",
            "size_m = [0.50, 9.0, 0.030]",
            "bad.toml:5: object.size_m[1]: found 9, expected a number from ",
        ),
        (
            "[grip]",
            "[human]\nplace = \"givn\"\nx_m = 1.0\ny_m = 0.0\n\n[grip]",
            "bad.toml:13: human.place: unknown variant `givn`, expected `free` or `given`; did you mean \"given\"?",
        ),
        ("kind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = 15.0", "", "bad.toml:7: operation: missing field `kind`"),
    ] {
        assert!(SCENARIO.contains(replace), "{replace}");
        let said = refused(&SCENARIO.replacen(replace, with, 1));
        assert!(said.starts_with(&format!("error: {message}")), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}

/// Without its section, what is checked against it may be wrong: the header alone is listed.
#[test]
fn a_misspelt_header_is_one_fault() {
    let mut headers = 0;
    let files = fs::read_dir(root().join("scenarios")).unwrap().map(|file| file.unwrap().path());
    for path in files.filter(|path| path.is_file()) {
        let text = fs::read_to_string(&path).unwrap();
        // The files that it names are not in the other folder.
        let text: String =
            text.lines().filter(|line| !line.contains(".toml\"")).map(|line| format!("{line}\n")).collect();
        for header in text.lines().filter(|line| line.starts_with('[')) {
            let misspelt = header.replacen(&header[2..3], "", 1);
            let said = refused(&text.replacen(header, &misspelt, 1));
            let name = path.display();
            assert_eq!(said.lines().count(), 1, "{name}: {misspelt}: {said}");
            assert!(
                said.contains(": unknown field `") && said.contains("; did you mean "),
                "{name}: {misspelt}: {said}"
            );
            headers += 1;
        }
    }
    assert!(headers > 50, "{headers} headers");
}

/// The load is checked against the times of the simulation.
#[test]
fn a_load_is_not_blamed_for_the_section_of_times() {
    let drill = "[load]\nkind = \"drill\"\nspindle_torque_nm = 1.0\nvibration_n = 2.0\nvibration_hz = 300.0\nbreakthrough_s = 5.0\n";
    for (simulation, message) in [
        ("hold_s = \"10.0\"", "simulation.hold_s: invalid type: string \"10.0\", expected f64"),
        ("hold_s = 10.0\ntimestep = 0.0005", "simulation.timestep: unknown field `timestep`"),
    ] {
        let said = refused(&format!("{SCENARIO}\n{drill}\n[simulation]\n{simulation}\n"));
        assert!(said.contains(message), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}

#[test]
fn a_missing_key_is_listed_beside_faults_of_other_sections() {
    let said = refused(&SCENARIO.replace("force_n = 15.0\n", "").replace("friction = 0.6", "friction = 6.0"));
    assert_eq!(
        said,
        "error: bad.toml:7: operation.force_n: found nothing, expected a force in N
bad.toml:13: grip.friction: found 6, expected at most 2 (a Coulomb coefficient)
2 faults in bad.toml
"
    );
}

#[test]
fn a_fault_of_the_robot_is_listed_beside_those_that_no_robot_changes() {
    let text =
        SCENARIO.replace("[grip]\nforce_n = 30.0", "[robot]\ndescription = \"bakster\"\n\n[grip]\nforce_n = 300.0");
    let said = refused(&format!("{text}\n[human]\nheight_m = 17.5\n"));
    assert_eq!(
        said,
        "error: bad.toml:13: robot.description: found robot \"bakster\", expected a built-in robot (baxter, dual-panda, dual-ur5) or \
         the path of a description file; did you mean \"baxter\"?
bad.toml:20: human.height_m: found 17.5, expected a number from 1.2 to 2.3 (m)
2 faults in bad.toml
"
    );
}

#[test]
fn of_many_faults_the_first_twenty_are_listed() {
    let keys: String = (0..30).map(|number| format!("key-{number} = 1\n")).collect();
    let said = refused(&format!("{SCENARIO}\n{keys}"));
    assert_eq!(said.lines().count(), 21);
    assert_eq!(said.lines().last(), Some("30 faults in bad.toml, of which the first 20 are listed"));
}

#[test]
fn a_plan_with_several_unknown_keys_lists_them_all() {
    let spoilt = PLAN.replacen("\"grip_force_n\"", "\"grip\"", 1).replacen("\"mass_kg\"", "\"mass\"", 1);
    let folder = folder(&[("bad.json", &spoilt)]);
    let output = benchdog(folder.path(), &["simulate", "bad.json"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2));
    let lines: Vec<&str> = said.lines().collect();
    assert!(
        lines[0].starts_with("error: bad.json:") && lines[0].contains(": object.mass: unknown field `mass`"),
        "{said}"
    );
    assert!(lines[1].starts_with("bad.json:84: arms[0].grip: unknown field `grip`"), "{said}");
    assert_eq!((lines.len(), lines[2]), (3, "2 faults in bad.json"));
}

#[test]
fn a_mistyped_name_has_a_suggestion() {
    for (replace, with, meant) in [
        ("[operation]", "material = \"fome\"\n\n[operation]", "foam"),
        ("[grip]", "[tool]\nname = \"knif\"\n\n[grip]", "knife"),
        ("[grip]", "[expect]\nverdict = \"hold\"\n\n[grip]", "holds"),
        ("[grip]", "[planner]\nbudget = \"exhaustiv\"\n\n[grip]", "exhaustive"),
        ("[grip]", "[comfort]\nmuscular = \"intrinsik\"\n\n[grip]", "intrinsic"),
        ("[grip]", "[robot]\ndescription = \"dual-pandas\"\n\n[grip]", "dual-panda"),
        ("[grip]", "[sweep.friktion]\nkind = \"none\"\n\n[grip]", "friction"),
        ("[grip]", "[sweep.friction]\nkind = \"unifrom\"\n\n[grip]", "uniform"),
        ("[grip]", "[gripp]\nforce_n = 1.0\n\n[grip]", "grip"),
    ] {
        let said = refused(&SCENARIO.replacen(replace, with, 1));
        assert!(said.ends_with(&format!("; did you mean \"{meant}\"?\n")), "{with}: {said}");
    }
    assert_plan_refused(
        "\"name\": \"left\"",
        "\"name\": \"letf\"",
        "bad.json:52: arms[0].name: found \"letf\", expected an arm of the robot: left, right; did you mean \"left\"?",
    );
}

#[test]
fn a_name_that_is_like_no_other_has_no_suggestion() {
    assert_scenario_refused(
        "[operation]",
        "material = \"cheese\"\n\n[operation]",
        "bad.toml:7: object.material: found \"cheese\", expected one of acrylic, balsa, foam, mdf, plywood, softwood",
    );
}

#[test]
fn a_missing_file_is_compared_with_the_files_beside_it() {
    let folder = folder(&[("holds/good.toml", SCENARIO), ("plan.json", PLAN)]);
    let missing = fs::read(folder.path().join("nowhere")).unwrap_err();
    let refused = |arguments: &[&str], message: &str| assert_refused(&benchdog(folder.path(), arguments), message);
    let read = format!("failed to read the file: {missing}; did you mean");
    refused(&["run", "holds/god.toml"], &format!("holds/god.toml: {read} \"holds/good.toml\"?"));
    refused(&["run", "hold/good.toml"], &format!("hold/good.toml: {read} \"holds/good.toml\"?"));
    refused(&["simulate", "plan.jsn"], &format!("plan.jsn: {read} \"plan.json\"?"));
    let named = format!("{SCENARIO}\n[planner]\nplan = \"pan.json\"\n");
    fs::write(folder.path().join("named.toml"), named).unwrap();
    refused(
        &["run", "named.toml"],
        &format!("named.toml:17: planner.plan: failed to read pan.json: {missing}; did you mean \"plan.json\"?"),
    );
}
