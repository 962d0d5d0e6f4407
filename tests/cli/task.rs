//! Tasks: planned, simulated and judged stage by stage; staged plans that fail, each in its stage; bad paths.

use std::{collections::BTreeMap, fs, path::Path, sync::LazyLock};

use serde_json::{Value, json};
use tempfile::TempDir;

use crate::{
    common::root,
    process::{argument, benchdog, command, folder, json, stderr},
};

/// The folder in which `task` has planned and judged the whole circle.
fn circle() -> &'static Path {
    static OUT: LazyLock<TempDir> = LazyLock::new(|| {
        let out = tempfile::tempdir().unwrap();
        let output = benchdog(root(), &["task", "scenarios/whole-circle.toml", "--out", argument(out.path())]);
        assert_eq!(output.status.code(), Some(0), "{}{}", String::from_utf8_lossy(&output.stdout), stderr(&output));
        out
    });
    OUT.path()
}

/// The plan of the whole circle.
pub fn circle_plan() -> Value {
    json(&circle().join("whole-circle/plan.json"))
}

/// The verdict of `simulate` on a staged plan, and the exit code.
fn simulated(plan: &Value) -> (Value, Option<i32>) {
    let folder = folder(&[("plan.json", &plan.to_string())]);
    let out = argument(folder.path()).to_owned();
    let output = benchdog(folder.path(), &["simulate", "plan.json", "--out", &out]);
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", stderr(&output));
    let verdict = json(&folder.path().join(plan["name"].as_str().unwrap()).join("verdict.json"));
    assert_eq!(verdict["criteria"], benchdog::judge::CRITERIA);
    let hint = format!("benchdog explain {} says", verdict["verdict"].as_str().unwrap());
    let is_hinted = String::from_utf8_lossy(&output.stdout).contains(&hint);
    assert_eq!(is_hinted, verdict["met"] == false, "{verdict}");
    (verdict, output.status.code())
}

/// The numbers, from 1, of the stages of a kind.
fn stages_of(plan: &Value, kind: &str) -> Vec<usize> {
    let stages = plan["stages"].as_array().unwrap();
    (0..stages.len()).filter(|&number| stages[number].get(kind).is_some()).map(|number| number + 1).collect()
}

/// The number of the first stage with a check within a tenth of its limit, or 0.5 mm of a limit of 0.
fn near_a_limit(verdict: &Value) -> Option<usize> {
    let is_near = |check: &Value| {
        let (margin, limit) = (check["margin"].as_f64().unwrap().abs(), check["limit"].as_f64().unwrap());
        let is_loss = ["contact_lost", "drop"].contains(&check["name"].as_str().unwrap());
        !is_loss && margin <= if limit == 0.0 { 0.5 } else { 0.1 * limit }
    };
    let stages = verdict["stages"].as_array().unwrap();
    stages.iter().position(|stage| stage["checks"].as_array().unwrap().iter().any(is_near)).map(|stage| stage + 1)
}

#[test]
fn all_pieces_of_the_circle_are_served_and_every_stage_holds() {
    let (plan, verdict) = (circle_plan(), json(&circle().join("whole-circle/verdict.json")));
    assert_eq!((&verdict["verdict"], &verdict["met"]), (&Value::from("holds"), &Value::from(true)));
    let worked: usize = plan["stages"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|stage| stage["hold"]["pieces"].as_array())
        .map(Vec::len)
        .sum();
    assert_eq!(worked, 16);
    assert_eq!(verdict["stages"].as_array().unwrap().len(), plan["stages"].as_array().unwrap().len());
    assert_eq!(verdict.get("confirmation").is_some(), near_a_limit(&verdict).is_some());
    // No piece has less than the least comfort that the task asks for.
    let path = fs::read_to_string(circle().join("whole-circle/path.csv")).unwrap();
    let mut rows = csv::Reader::from_reader(path.as_bytes());
    let kept: Vec<f64> = rows.records().map(|row| row.unwrap()[6].parse().unwrap()).collect();
    assert!(kept.len() == 16 && kept.iter().all(|kept| (0.5..1.2).contains(kept)), "{kept:?}");
}

/// One hand cannot carry this board as the person has it, so its grips are changed with the board level.
#[test]
fn a_circle_twice_as_large_is_cut_and_every_stage_holds() {
    let out = tempfile::tempdir().unwrap();
    let arguments = ["task", "scenarios/large-circle.toml", "--no-recording", "--out", argument(out.path())];
    let output = benchdog(root(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}{}", String::from_utf8_lossy(&output.stdout), stderr(&output));
    let [plan, verdict] = ["plan", "verdict"].map(|file| json(&out.path().join(format!("large-circle/{file}.json"))));
    assert_eq!(verdict["verdict"], "holds");
    let pieces = plan["stages"].as_array().unwrap().iter().filter_map(|stage| stage["hold"]["pieces"].as_array());
    assert_eq!(pieces.map(Vec::len).sum::<usize>(), 31);
    assert!(!stages_of(&plan, "regrasp").is_empty());
}

/// The pads keep what they slid under the loads before: planned for each load from rest, a hand turned by 2.4 of 2 degrees here.
#[test]
fn a_hold_that_serves_many_pieces_of_an_arc_holds() {
    let task = "format = 1\nname = \"arc\"\n[task]\nkind = \"cut\"\nforce_n = 30.0\nlines_m = [[[0.12, -0.02387], [0.12, 0.02387], \
                [0.10173, 0.06797], [0.06797, 0.10173], [0.02387, 0.12], [-0.02387, 0.12], [-0.06797, 0.10173], \
                [-0.10173, 0.06797], [-0.12, 0.02387], [-0.12, -0.02387]]]\n";
    let folder = folder(&[("arc.toml", task)]);
    let output = benchdog(folder.path(), &["task", "arc.toml", "--no-recording", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", String::from_utf8_lossy(&output.stdout), stderr(&output));
    assert_eq!(json(&folder.path().join("out/arc/verdict.json"))["verdict"], "holds");
}

#[test]
fn the_report_has_a_picture_of_every_stage() {
    let page = fs::read_to_string(circle().join("whole-circle/report.html")).unwrap();
    let stages = circle_plan()["stages"].as_array().unwrap().len();
    assert_eq!((page.matches("<figure").count(), page.matches("stage fails").count()), (stages, 0));
    for number in 1..=stages {
        assert!(page.contains(&format!("id=\"stage-{number}\"")));
    }
    assert!(page.len() < 1_500_000, "{} bytes", page.len());
    // The same plan has the same pictures when it is simulated from its file.
    let folder = folder(&[("plan.json", &circle_plan().to_string())]);
    let out = argument(folder.path()).to_owned();
    benchdog(folder.path(), &["simulate", "plan.json", "--out", &out]);
    assert!(fs::read_to_string(folder.path().join("whole-circle/report.html")).unwrap() == page);
}

#[test]
fn a_staged_plan_from_a_file_has_the_verdict_of_the_task() {
    let (verdict, code) = simulated(&circle_plan());
    let first = json(&circle().join("whole-circle/verdict.json"));
    assert_eq!((verdict["fingerprint"].clone(), code), (first["fingerprint"].clone(), Some(0)));
}

/// The circle's plan under limits that it keeps by far, but for this share of its largest deflection; and the first stage beyond it.
fn with_deflection_limit(share: f64) -> (Value, Option<usize>) {
    let (mut plan, verdict) = (circle_plan(), json(&circle().join("whole-circle/verdict.json")));
    let deflection_mm = |stage: &Value| {
        let checks = stage["checks"].as_array().unwrap();
        checks.iter().find(|check| check["name"] == "deflection").unwrap()["value"].as_f64().unwrap()
    };
    let deflections_mm: Vec<f64> = verdict["stages"].as_array().unwrap().iter().map(deflection_mm).collect();
    let most_mm = deflections_mm.iter().copied().fold(0.0, f64::max);
    let stage = deflections_mm.iter().position(|&mm| mm > share * most_mm).map(|stage| stage + 1);
    let limits = &mut plan["scenario"]["limits"];
    (limits["slip_mm"], limits["slip_deg"]) = (10.0.into(), 20.0.into());
    limits["deflection_mm"] = (share * most_mm).into();
    (plan, stage)
}

#[test]
fn stages_that_are_clear_of_their_limits_are_simulated_once() {
    let (verdict, code) = simulated(&with_deflection_limit(1.3).0);
    assert_eq!((&verdict["verdict"], verdict.get("confirmation"), code), (&"holds".into(), None, Some(0)));
}

/// Deflections of holds at steps of 2 and 1 ms are within 0.5 % of each other.
#[test]
fn a_stage_beyond_its_limit_by_little_is_confirmed_at_half_the_step() {
    let (plan, stage) = with_deflection_limit(0.98);
    let stage = stage.unwrap();
    let (verdict, code) = simulated(&plan);
    let failed = (&verdict["verdict"], &verdict["failed"]["stage"], code);
    assert_eq!(failed, (&"deflects".into(), &stage.into(), Some(1)));
    let run = |timestep_s: f64| json!({"timestep_s": timestep_s, "verdict": "deflects", "stage": stage});
    assert_eq!(verdict["confirmation"]["runs"], json!([run(0.002), run(0.001)]));
    let because = verdict["confirmation"]["because"].as_str().unwrap();
    let near = near_a_limit(&verdict).unwrap();
    assert!(because.starts_with(&format!("stage {near}: deflection ")), "{because}");
}

#[test]
fn one_thread_plans_the_same_bytes_as_two() {
    let plan = |threads: &str| {
        let out = tempfile::tempdir().unwrap();
        let arguments = ["task", "scenarios/whole-circle.toml", "--plan-only", "--out", argument(out.path())];
        let output = command(root(), &arguments).env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let mut plan = json(&out.path().join("whole-circle/plan.json"));
        plan["planner"] = Value::Null;
        plan.to_string()
    };
    assert!(plan("1") == plan("2"));
}

/// The lines of a streamed task are its plan; a thread more changes no byte of it, and every stage holds.
#[test]
fn a_streamed_task_gives_out_its_stages_one_after_the_other() {
    let streamed = |threads: &str, options: &[&str]| {
        let out = tempfile::tempdir().unwrap();
        let arguments = ["task", "scenarios/whole-circle.toml", "--stream", "--out", argument(out.path())];
        let output = command(root(), &[&arguments[..], options].concat()).env("RAYON_NUM_THREADS", threads).output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let lines = fs::read_to_string(out.path().join("whole-circle/stages.jsonl")).unwrap();
        let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let mut plan = json(&out.path().join("whole-circle/plan.json"));
        plan["planner"] = Value::Null;
        (lines, plan, stderr(&output))
    };
    let (mut lines, mut plan, said) = streamed("2", &["--no-recording"]);
    assert!(said.contains("the person waits ") && said.contains(" s for the planner before the first stage"), "{said}");
    let mut first = lines.remove(0);
    first["planner"] = Value::Null;
    let planned_s: Vec<_> = lines.iter().map(|line| line["planned_s"].as_f64().unwrap()).collect();
    // Some stages are known before others.
    assert!(planned_s.is_sorted() && planned_s[0] > 0.0 && planned_s[0] < planned_s[planned_s.len() - 1]);
    let numbers: Vec<_> = lines.iter().map(|line| line["number"].as_u64().unwrap()).collect();
    assert_eq!(numbers, (1..=lines.len() as u64).collect::<Vec<_>>());
    let (_, of_one_thread, _) = streamed("1", &["--plan-only"]);
    assert!(plan == of_one_thread);
    let stages = std::mem::replace(&mut plan["stages"], Value::Array(Vec::new()));
    assert_eq!(first, plan);
    assert_eq!(stages, lines.iter().map(|line| line["stage"].clone()).collect::<Value>());
}

/// Five pieces of the circle on straight segments, which are cut in two holds.
const ARC: &str = "format = 1\nname = \"arc\"\n\n[task]\nkind = \"cut\"\nforce_n = 30.0\nlines_m = [[[-0.023869484, 0.12], \
                   [-0.06797454, 0.101731088], [-0.101731088, 0.06797454], [-0.12, 0.023869484], [-0.12, -0.023869484], \
                   [-0.101731088, -0.06797454]]]\n";

/// The rows of a CSV file, each a map from column to cell.
fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(path).unwrap().deserialize().map(Result::unwrap).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> Option<f64> {
    row[column].parse().ok()
}

#[test]
fn a_task_is_compared_with_other_strategies() {
    let folder = folder(&[("arc.toml", ARC)]);
    let output = benchdog(folder.path(), &["task", "arc.toml", "--compare"]);
    let printed = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(output.status.code(), Some(0), "{printed}{}", stderr(&output));
    let out = folder.path().join("out/arc");
    let (totals, pieces) = (rows(&out.join("comparison.csv")), rows(&out.join("comparison-pieces.csv")));
    let names: Vec<_> = totals.iter().map(|row| row["strategy"].as_str()).collect();
    assert_eq!((names, pieces.len()), (vec!["staged", "one_hold", "separate", "random"], 4 * 5));
    let of = |strategy: &str| pieces.iter().filter(|row| row["strategy"] == strategy).collect::<Vec<_>>();
    // The figures of the staged plan are those of its other tables.
    let path = rows(&out.join("path.csv"));
    for (row, piece) in of("staged").into_iter().zip(&path) {
        assert_eq!((&row["objective"], &row["effort"]), (&piece["objective"], &piece["effort"]));
    }
    let verdict = json(&out.join("verdict.json"));
    for (column, key) in [("mean_effort", "mean_effort"), ("accumulated_effort_s", "accumulated_effort_s")] {
        // Rounding to four digits and more.
        assert!((number(&totals[0], column).unwrap() - verdict["person"][key].as_f64().unwrap()).abs() < 1e-4);
    }
    // Separate plans are the best that a search finds, not the best that exist; another strategy has been seen to be better at a
    // piece by some percent at most, and is not in the mean.
    let separate: Vec<_> = of("separate").into_iter().map(|row| number(row, "objective").unwrap()).collect();
    for total in &totals {
        let served = of(&total["strategy"]).into_iter().map(|row| number(row, "objective"));
        let kept: Vec<_> = served.zip(&separate).filter_map(|(objective, best)| Some(objective? / best)).collect();
        assert_eq!(kept.len(), number(total, "served").unwrap() as usize);
        assert!(kept.iter().all(|kept| *kept < 1.05), "{} {kept:?}", total["strategy"]);
        assert!(kept.iter().sum::<f64>() / kept.len() as f64 <= 1.0, "{} {kept:?}", total["strategy"]);
    }
    // Holds that are chosen are better than random ones, which are the means of eight plans.
    assert!(number(&totals[3], "staged_ratio").unwrap() < 0.7, "{:?}", totals[3]);
    assert!(of("random").iter().all(|row| row["plans"] == "8"));
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let sentence = printed.lines().last().unwrap();
    let is_one_hold = verdict["stages"].as_array().unwrap().len() == 1;
    let start = if is_one_hold { "With one hold " } else { "While the robot " };
    assert!(sentence.starts_with(start) && page.contains(sentence), "{sentence}");
    assert_eq!(page.matches("class=\"plot comparison\"").count(), 2);
    // A task that is not compared leaves no comparison of another plan.
    benchdog(folder.path(), &["task", "arc.toml", "--plan-only"]);
    assert!(out.join("plan.json").exists() && !out.join("comparison.csv").exists());
    assert!(!out.join("comparison-pieces.csv").exists());
}

#[test]
fn a_comparison_is_the_same_with_one_thread_and_two() {
    let folder = folder(&[("arc.toml", ARC)]);
    let compared = |threads: &str| {
        let arguments = ["task", "arc.toml", "--compare", "--plan-only", "--out", threads];
        let output = command(folder.path(), &arguments).env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let file = |name: &str| fs::read(folder.path().join(threads).join("arc").join(name)).unwrap();
        (file("comparison.csv"), file("comparison-pieces.csv"), output.stdout)
    };
    assert!(compared("1") == compared("2"));
}

/// The circle's plan with its first motion twenty times as fast, with the inertia of arms and board in its way; and that stage.
pub fn too_fast() -> (Value, usize) {
    let mut plan = circle_plan();
    let stage = stages_of(&plan, "move")[0];
    for time_s in plan["stages"][stage - 1]["move"]["time_s"].as_array_mut().unwrap() {
        *time_s = (time_s.as_f64().unwrap() / 20.0).into();
    }
    (plan, stage)
}

/// `--record failed` records the failure, not the success.
#[test]
fn a_task_that_fails_is_recorded() {
    for (plan, is_recorded) in [(too_fast().0, true), (circle_plan(), false)] {
        let folder = folder(&[("plan.json", &plan.to_string())]);
        let output = benchdog(folder.path(), &["simulate", "plan.json", "--record", "failed"]);
        assert_eq!(output.status.code(), Some(i32::from(is_recorded)), "{}", stderr(&output));
        let recording = folder.path().join("out").join(plan["name"].as_str().unwrap()).join("recording.rrd");
        assert_eq!(recording.exists(), is_recorded);
    }
}

#[test]
fn a_motion_that_is_too_fast_fails_in_its_stage() {
    let (plan, stage) = too_fast();
    let (verdict, code) = simulated(&plan);
    assert_eq!((&verdict["failed"]["stage"], &verdict["failed"]["kind"]), (&stage.into(), &"move".into()));
    assert!(["slips", "pivots", "saturates", "deflects", "opens"].contains(&verdict["verdict"].as_str().unwrap()));
    assert_eq!(code, Some(1));
}

/// The grip of a new grasp is so weak that the hand slides under the next load.
#[test]
fn a_weak_new_grip_fails_after_its_regrasp() {
    let mut plan = circle_plan();
    let regrasp = stages_of(&plan, "regrasp")[0];
    plan["stages"][regrasp - 1]["regrasp"]["grip_force_n"] = 2.0.into();
    let (verdict, code) = simulated(&plan);
    let failed = verdict["failed"]["stage"].as_u64().unwrap() as usize;
    assert!(failed > regrasp, "{} in stage {failed}", verdict["verdict"]);
    assert_eq!(code, Some(1));
}

/// A board that two hands hold and one does not.
#[test]
fn a_board_that_is_too_heavy_for_one_hand_fails_in_the_first_regrasp() {
    let mut plan = circle_plan();
    let regrasp = stages_of(&plan, "regrasp")[0];
    plan["object"]["mass_kg"] = 1.2.into();
    plan["scenario"]["object"]["density_kg_m3"] = (1.2 / (0.5 * 0.4 * 0.03)).into();
    let (verdict, code) = simulated(&plan);
    assert_eq!(verdict["failed"]["stage"].as_u64().unwrap() as usize, regrasp, "{}", verdict["failed"]);
    assert!(["slips", "pivots", "deflects", "opens", "drops"].contains(&verdict["verdict"].as_str().unwrap()));
    assert_eq!(code, Some(1));
}

/// Asserts that `simulate` refuses the circle's plan after a change.
#[track_caller]
fn assert_plan_refused(change: impl Fn(&mut Value), message: &str) {
    let mut plan = circle_plan();
    change(&mut plan);
    let folder = folder(&[("plan.json", &plan.to_string())]);
    let output = benchdog(folder.path(), &["simulate", "plan.json"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("plan.json:") && said.contains(message), "{said}");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn staged_plans_that_do_not_fit_are_refused() {
    let first_move = stages_of(&circle_plan(), "move")[0] - 1;
    let first_regrasp = stages_of(&circle_plan(), "regrasp")[0] - 1;
    assert_plan_refused(
        |plan| plan["stages"][first_move]["move"]["arms"][0]["q_rad"][0][0] = 0.9.into(),
        &format!("stages[{first_move}].move.arms[0].q_rad[0]: found "),
    );
    assert_plan_refused(
        |plan| plan["stages"][first_move]["move"]["time_s"][1] = 0.0.into(),
        &format!("stages[{first_move}].move.time_s[1]: found 0, expected a time after 0"),
    );
    assert_plan_refused(
        |plan| plan["stages"][first_regrasp]["regrasp"]["arm"]["name"] = "middle".into(),
        &format!("stages[{first_regrasp}].regrasp.arm.name: found \"middle\", expected left or right"),
    );
    assert_plan_refused(
        |plan| {
            plan["stages"].as_array_mut().unwrap().pop();
        },
        "stages: found pieces up to ",
    );
    assert_plan_refused(|plan| plan["stages"][0]["hold"]["pieces"] = Value::Array(Vec::new()), "found none");
    assert_plan_refused(|plan| plan["surplus"] = 1.into(), "unknown field `surplus`");
    assert_plan_refused(
        |plan| plan["stages"][0]["hold"]["pieces"][0]["human"]["height_m"] = 9.0.into(),
        "stages[0].hold.pieces[0].human.height_m: found 9, expected a number from 1.2 to 2.3 (m)",
    );
    assert_plan_refused(
        |plan| plan["stages"][0]["hold"]["pieces"][0]["human"]["q_rad"][3] = 9.0.into(),
        "stages[0].hold.pieces[0].human.q_rad[3]: found ",
    );
    assert_plan_refused(|plan| plan["arms"][0]["q_rad"][2] = 9.0.into(), "arms[0].q_rad[2]: found 9");
}

/// The errors of a person name the line of the value, not that of the file's beginning.
#[test]
fn an_error_of_a_piece_names_its_line() {
    let mut plan = circle_plan();
    plan["stages"][0]["hold"]["pieces"][0]["human"]["height_m"] = 9.0.into();
    let text = serde_json::to_string_pretty(&plan).unwrap();
    let line = text.lines().position(|line| line.contains("\"height_m\": 9.0")).unwrap() + 1;
    let folder = folder(&[("plan.json", &text)]);
    let output = benchdog(folder.path(), &["simulate", "plan.json"]);
    assert!(stderr(&output).contains(&format!("plan.json:{line}: ")), "{}", stderr(&output));
}

#[test]
fn a_staged_plan_is_not_judged_by_a_scenario_file() {
    let folder = folder(&[("plan.json", &circle_plan().to_string())]);
    let scenario = root().join("scenarios/cut-rim.toml");
    let output = benchdog(folder.path(), &["simulate", "plan.json", "--scenario", argument(&scenario)]);
    assert_eq!(output.status.code(), Some(2));
    let expected = "format: found 2, expected 1, a plan of one hold, beside a scenario file";
    assert!(stderr(&output).contains(expected), "{}", stderr(&output));
}

/// Asserts that a task file with this path is refused.
#[track_caller]
fn assert_path_refused(path: &str, message: &str) {
    let text = format!("format = 1\nname = \"bad\"\n\n[task]\nkind = \"cut\"\nforce_n = 30.0\n{path}\n");
    let folder = folder(&[("bad.toml", &text)]);
    let output = benchdog(folder.path(), &["task", "bad.toml"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains(message), "{said}");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn bad_paths_are_refused_with_line_and_key() {
    assert_path_refused("circle = { radius_m = 0.3 }", "bad.toml:7: task.circle: found ");
    assert_path_refused("lines_m = [[[0.0, 0.0], [0.3, 0.0]]]", "bad.toml:7: task.lines_m[0]: found ");
    assert_path_refused(
        "lines_m = [[[0.0, 0.0]]]",
        "bad.toml:7: task.lines_m[0]: found 1 points, expected a line of at least two points",
    );
    assert_path_refused("lines_m = [[[0.0, nan], [0.1, 0.0]]]", "bad.toml:7: task.lines_m[0][0]: found ");
    assert_path_refused(
        "lines_m = [[[0.0, 0.0], [0.0, 0.0]]]",
        "bad.toml:7: task.lines_m[0][1]: found the point before, expected a point that differs from the one before",
    );
    let eight = "lines_m = [[[0.0, 0.0], [0.1, 0.1], [0.1, 0.0], [0.0, 0.1]]]";
    assert_path_refused(eight, "bad.toml:7: task.lines_m: found strokes 1 and 1 that meet at [0.0500, 0.0500]");
    assert_path_refused("lines_m = []", "task.lines_m: found an empty path");
    assert_path_refused("holes_m = [[0.0, 0.0]]", "bad.toml:7: task.holes_m: found a value, expected none");
    assert_path_refused("", "task: found 0 paths, expected one of circle, lines_m, holes_m and file");
    assert_path_refused("file = \"none.csv\"", "none.csv");
    assert_path_refused("circle = { radius_m = 0.1 }\nspeed_m_s = 0.0", "bad.toml:8: task.speed_m_s: found 0");
}

#[test]
fn a_path_from_a_file_names_its_line() {
    let task = "format = 1\nname = \"bad\"\n\n[task]\nkind = \"cut\"\nforce_n = 30.0\nfile = \"path.csv\"\n";
    for (rows, message) in [
        ("stroke,x_m,y_m\n1,0.0,0.0\n1,0.1,inf\n", "path.csv:3: y_m: found \"inf\", expected a finite number"),
        ("stroke,x_m,y_m\n1,0.0\n", "path.csv:2: found 2 cells, expected 3, one a column"),
        ("x_m,y_m\n0.0,0.0\n", "path.csv:1: found \"x_m, y_m\", expected the columns stroke, x_m, y_m"),
    ] {
        let folder = folder(&[("bad.toml", task), ("path.csv", rows)]);
        let output = benchdog(folder.path(), &["task", "bad.toml"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
    }
}

#[test]
fn a_task_is_no_scenario_and_a_scenario_no_task() {
    let output = benchdog(root(), &["plan", "scenarios/whole-circle.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("task: found [task], expected [operation] with one operation"),
        "{}",
        stderr(&output)
    );
    let output = benchdog(root(), &["task", "scenarios/cut-rim.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("operation: found [operation], expected [task]"), "{}", stderr(&output));
}
