//! Input that cannot be meant: values beyond their bounds, arrays of the wrong length, and what a rigid board hides.

use std::fs;

use crate::{
    bad_input::{PLAN, SCENARIO, assert_plan_refused, assert_refused, assert_scenario_refused},
    process::{benchdog, folder, stderr},
};

/// Values that cannot be meant: beyond the bounds of docs/method.md#13-bounds-of-input.
#[test]
fn values_beyond_their_bounds() {
    for (replace, with, message) in [
        (
            "force_n = 15.0",
            "force_n = 1e300",
            "bad.toml:10: operation.force_n: found 1e300, expected at most 10000 (N)",
        ),
        ("force_n = 30.0", "force_n = inf", "bad.toml:13: grip.force_n: found inf, expected at most 10000 (N)"),
        (
            "point_m = [0.0, 0.0]",
            "point_m = [0.0, 1e5]",
            "bad.toml:9: operation.point_m: found [0.0, 100000.0], expected numbers from -10 to 10 (m)",
        ),
        (
            "[grip]",
            "[comfort]\nweight_muscular = 1e308\n\n[grip]",
            "bad.toml:13: comfort.weight_muscular: found 1e308, expected at most 1000000 (a weight)",
        ),
        (
            "[grip]",
            "[limits]\ndeflection_mm = 1e9\n\n[grip]",
            "bad.toml:13: limits.deflection_mm: found 1e9, expected at most 1000000 (mm)",
        ),
        (
            "[grip]",
            "[human]\nplace = \"given\"\nx_m = 1e10\ny_m = 0.0\nheading_deg = 180.0\n\n[grip]",
            "bad.toml:14: human.x_m: found [10000000000.0], expected numbers from -10 to 10 (m)",
        ),
        (
            "kind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = 15.0\n",
            "kind = \"wrench\"\nwrench_o = [0.0, 0.0, -5.0, 0.0, 2e3, 0.0]\n\
             x_ot = { translation_m = [0.0, 0.0, 0.0], rotation_xyzw = [0.0, 0.0, 0.0, 1.0] }\n",
            "bad.toml:9: operation.wrench_o: found [0.0, 0.0, -5.0, 0.0, 2000.0, 0.0], expected forces up to 10000 N and \
             moments up to 1000 N m",
        ),
        (
            "kind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = 15.0\n",
            "kind = \"cut\"\npoint_m = [0.1, 0.0]\nforce_n = 15.0\ndirection_o = [0.0, 1.0, 0.0]\n\n[load]\nkind = \"path\"\n\
             speed_m_s = 0.1\ncentre_m = [1e300, 0.0]\n",
            "bad.toml:16: load.centre_m: found [1e300, 0.0], expected numbers from -10 to 10 (m)",
        ),
    ] {
        assert_scenario_refused(replace, with, message);
    }
    let csv = "time_s,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm\n0,0,0,0,0,0,0\n0.1,0,0,-1e5,0,0,0\n";
    let scenario = format!("{SCENARIO}\n[load]\nkind = \"measured\"\nfile = \"forces.csv\"\n");
    let folder = folder(&[("forces.csv", csv), ("bad.toml", &scenario)]);
    let message = "forces.csv:3: fz_n: found \"-1e5\", expected a number from -10000 to 10000";
    assert_refused(&benchdog(folder.path(), &["run", "bad.toml"]), message);
}

/// A share of a force that is not there, or that has its sideways part already.
#[test]
fn a_sideways_push_beyond_its_bounds_or_of_no_force() {
    for (replace, with, message) in [
        (
            "[grip]",
            "[load]\nlateral_share = 1.5\n\n[grip]",
            "bad.toml:13: load.lateral_share: found 1.5, expected a number from 0 to 1 (a share of the operation's force)",
        ),
        (
            "kind = \"drill\"\npoint_m = [0.0, 0.0]\nforce_n = 15.0\n",
            "kind = \"wrench\"\nwrench_o = [0.0, 0.0, 0.0, 0.0, 2.0, 0.0]\n\
             x_ot = { translation_m = [0.0, 0.0, 0.0], rotation_xyzw = [0.0, 0.0, 0.0, 1.0] }\n\n[load]\nlateral_share = 0.1\n",
            "bad.toml:13: load.lateral_share: found 0.1, expected 0 for an operation without a force",
        ),
    ] {
        assert_scenario_refused(replace, with, message);
    }
    let csv = "time_s,fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm\n0,0,0,0,0,0,0\n0.1,1,0,-5,0,0,0\n";
    let scenario = format!("{SCENARIO}\n[load]\nkind = \"measured\"\nfile = \"forces.csv\"\nlateral_share = 0.13\n");
    let folder = folder(&[("forces.csv", csv), ("bad.toml", &scenario)]);
    let message = "bad.toml:19: load.lateral_share: found 0.13, expected 0 with a measured force, which has its sideways part already";
    assert_refused(&benchdog(folder.path(), &["run", "bad.toml"]), message);
}

/// TOML would drop what is too much.
#[test]
fn arrays_that_are_too_long_or_too_short() {
    for (replace, with, message) in [
        (
            "0.030]",
            "0.030, 0.1]",
            "bad.toml:5: object.size_m: found an array of length 4, expected an array of length 3",
        ),
        (
            "point_m = [0.0, 0.0]",
            "point_m = [0.0, 0.0, 0.0]",
            "bad.toml:9: operation.point_m: found an array of length 3, expected an array of length 2",
        ),
        (
            "force_n = 15.0\n",
            "force_n = 15.0\nwrench_o = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n",
            "bad.toml:11: operation.wrench_o: found an array of length 8, expected an array of length 6",
        ),
        (
            "[grip]",
            "[human]\nelbow_deg = [30.0, 60.0, 90.0]\n\n[grip]",
            "bad.toml:13: human.elbow_deg: found an array of length 3, expected an array of length 2",
        ),
        (
            "point_m = [0.0, 0.0]",
            "point_m = [0.0]",
            "bad.toml:9: operation.point_m: invalid length 1, expected an array of length 2",
        ),
    ] {
        assert_scenario_refused(replace, with, message);
    }
    let line = 1 + PLAN.lines().position(|line| line.contains("\"size_m\"")).unwrap();
    let message = format!("bad.json:{line}: object.size_m: found an array of length 4, expected an array of length 3");
    assert_plan_refused("\"size_m\": [", "\"size_m\": [ 0.5,", &message);
}

#[test]
fn a_plan_with_a_force_beyond_its_bounds_or_a_tip_inside_the_board() {
    let line = |key: &str| 1 + PLAN.lines().position(|line| line.contains(key)).unwrap();
    let message = format!(
        "bad.json:{}: operation.wrench_o: found [0.0, 1e300, 0.0, 0.0, 0.0, 0.0], expected forces up to 10000 N and moments \
         up to 1000 N m",
        line("\"wrench_o\"")
    );
    assert_plan_refused("30.0,", "1e300,", &message);
    let message = format!(
        "bad.json:{}: operation.x_ot: found a tool tip 5.00 mm inside the board, expected a tip on a face of the board, \
         within 1 mm",
        line("\"x_ot\"")
    );
    assert_plan_refused("0.015", "0.010", &message);
}

/// A thin board of foam holds in the simulation, which does not know that it bends.
#[test]
fn a_board_that_bends_is_noted() {
    let thin = SCENARIO.replace("0.030]", "0.010]").replace("force_n = 15.0", "force_n = 8.0");
    let folder = folder(&[("thin.toml", &format!("{thin}\n[planner]\nbudget = \"fast\"\n"))]);
    let output = benchdog(folder.path(), &["run", "thin.toml", "--record", "never"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let verdict = fs::read_to_string(folder.path().join("out/bad/verdict.json")).unwrap();
    let verdict: serde_json::Value = serde_json::from_str(&verdict).unwrap();
    let note = verdict["notes"][0].as_str().unwrap();
    assert!(note.starts_with("the board bends by ") && note.contains("(foam, 10 mm thick)"), "{note}");
    assert!(String::from_utf8(output.stdout).unwrap().contains(note));
}
