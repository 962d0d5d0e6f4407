//! The committed results as printed confirm the paper's conclusions, every plan of the comfort planner holds in simulation, and
//! the program still computes the committed figures of both evaluations.
//!
//! If the last test fails because planner or simulation were changed on purpose, `cargo run --release -- reproduce` updates
//! the results; the other tests then check the new figures.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Component, Path, PathBuf},
    process::Output,
    time::SystemTime,
};

use benchdog::reproduce::paper;
use rand::{SeedableRng as _, seq::SliceRandom as _};
use rand_pcg::Pcg64;

use crate::{
    common::root,
    process::{Files, argument, benchdog, contents, stderr},
};

/// Half a step of the last digit in the files.
const ROUNDING: f64 = 0.5e-6;

const PLANNERS: [&str; 4] = ["comfort", "peripersonal", "muscular", "random"];

fn results() -> PathBuf {
    root().join("results")
}

/// The results of the evaluation as printed.
fn printed() -> PathBuf {
    results().join("printed")
}

/// The rows of a CSV file, by column name.
struct Table {
    rows: Vec<BTreeMap<String, String>>,
}

impl Table {
    fn read(name: &str, header: &str) -> Self {
        let text = fs::read_to_string(printed().join(name)).unwrap();
        assert_eq!(text.lines().next(), Some(header), "{name}");
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        Self { rows: reader.deserialize().map(Result::unwrap).collect() }
    }

    /// The figures of a column in the rows that pass a filter.
    fn figures(&self, column: &str, wanted: impl Fn(&BTreeMap<String, String>) -> bool) -> Vec<f64> {
        self.rows.iter().filter(|row| wanted(row)).map(|row| row[column].parse().unwrap()).collect()
    }
}

fn table1() -> Table {
    Table::read(
        "table1.csv",
        "task,planner,muscular,muscular_printed_median,peripersonal_scaled,muscular_normalised,peripersonal_normalised",
    )
}

fn plans() -> Table {
    Table::read("plans.csv", "operation,planner,muscular,peripersonal_m,objective,load_factor,compliant_load_factor")
}

fn physics() -> Table {
    Table::read(
        "physics.csv",
        "operation,planner,verdict,slip_mm,slip_deg,deflection_mm,predicted_deflection_mm,torque_ratio,\
         load_factor_simulated",
    )
}

fn random() -> Table {
    Table::read("random.csv", "operation,seed,muscular,muscular_printed,peripersonal_scaled")
}

/// A figure of table 1.
fn of(table: &Table, task: &str, planner: &str, column: &str) -> f64 {
    let found = table.figures(column, |row| row["task"] == task && row["planner"] == planner);
    assert_eq!(found.len(), 1, "{task} {planner}");
    found[0]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn there_are_twenty_five_operations_and_four_planners() {
    for table in [plans(), physics()] {
        assert_eq!(table.rows.len(), 100);
        for planner in PLANNERS {
            let of = |kind| {
                table.rows.iter().filter(|r| r["planner"] == planner && r["operation"].starts_with(kind)).count()
            };
            assert_eq!((of("cut-"), of("drill-")), (16, 9), "{planner}");
        }
    }
    assert_eq!(table1().rows.len(), 8);
}

#[test]
fn the_table_is_the_mean_of_the_plans_over_the_mean_of_the_random_ones() {
    let (table, plans, random) = (table1(), plans(), random());
    for (task, kind) in [("cutting", "cut-"), ("drilling", "drill-")] {
        let draws = |column| mean(&random.figures(column, |row| row["operation"].starts_with(kind)));
        let (muscular_random, peripersonal_random) = (draws("muscular"), draws("peripersonal_scaled"));
        for planner in PLANNERS {
            let own = |column| {
                mean(&plans.figures(column, |row| row["planner"] == planner && row["operation"].starts_with(kind)))
            };
            let (muscular, peripersonal) = match planner {
                "random" => (muscular_random, peripersonal_random),
                // 64 body points.
                _ => (own("muscular"), 64.0 * own("peripersonal_m")),
            };
            let same = |column, value: f64, rounding: f64| {
                let written = of(&table, task, planner, column);
                assert!((written - value).abs() <= rounding, "{task} {planner} {column}: {written} and {value}");
            };
            same("muscular", muscular, 2.0 * ROUNDING);
            same("peripersonal_scaled", peripersonal, 65.0 * ROUNDING);
            // Ratios below 100 of figures above 1.
            same("muscular_normalised", muscular / muscular_random, 100.0 * ROUNDING);
            same("peripersonal_normalised", peripersonal / peripersonal_random, 100.0 * ROUNDING);
        }
    }
}

/// The best known objectives, found with the budget `exhaustive` (about 100 times the work), two other seeds and other
/// attempts. The operations of a pair are equal up to half a turn of the board.
const BEST_KNOWN: [(&str, &str, f64); 13] = [
    ("cut-01", "cut-09", 138.837),
    ("cut-02", "cut-10", 136.776),
    ("cut-03", "cut-11", 137.398),
    ("cut-04", "cut-12", 141.831),
    ("cut-05", "cut-13", 140.826),
    ("cut-06", "cut-14", 139.826),
    ("cut-07", "cut-15", 141.748),
    ("cut-08", "cut-16", 142.174),
    ("drill-1", "drill-9", 180.989),
    ("drill-2", "drill-8", 180.691),
    ("drill-3", "drill-7", 180.940),
    ("drill-4", "drill-6", 180.143),
    ("drill-5", "drill-5", 180.436),
];

#[test]
fn every_comfort_plan_is_near_the_best_known() {
    let plans = plans();
    for (one, other, best_known) in BEST_KNOWN {
        for operation in [one, other] {
            let of = |row: &BTreeMap<String, String>| row["operation"] == operation && row["planner"] == "comfort";
            let objective = plans.figures("objective", of)[0];
            assert!(objective >= 0.99 * best_known, "{operation}: {objective}, known {best_known}");
            // If a plan is better by more than rounding, update the table above.
            assert!(
                objective <= 1.002 * best_known,
                "{operation}: {objective} is better than the best known {best_known}"
            );
        }
    }
}

/// Muscular comfort of the comfort planner over that of the muscular planner in the paper's Table I.
const PAPERS_MUSCULAR_SHARE: [(&str, f64); 2] = [("cutting", 11.19 / 15.66), ("drilling", 19.24 / 22.45)];

#[test]
fn the_comfort_planner_is_near_both_planners_of_one_comfort() {
    let table = table1();
    for (task, papers_share) in PAPERS_MUSCULAR_SHARE {
        let share = |column, planner| of(&table, task, "comfort", column) / of(&table, task, planner, column);
        let muscular = share("muscular", "muscular");
        assert!(
            muscular >= papers_share.max(0.9),
            "{task}: {muscular} of the muscular planner's, in the paper {papers_share}"
        );
        // In the paper 2.08 of 2.09 and 2.55 of 2.51. Ours trades some hundredths for muscular comfort.
        let peripersonal = share("peripersonal_scaled", "peripersonal");
        assert!(peripersonal >= 0.95, "{task}: {peripersonal} of the peripersonal planner's");
    }
}

#[test]
fn a_planner_of_one_comfort_is_poor_in_the_other() {
    let table = table1();
    for (task, _) in PAPERS_MUSCULAR_SHARE {
        // The planner's gain over random as a share of the comfort planner's gain.
        let gain = |planner, column| {
            let value = |planner| of(&table, task, planner, column);
            (value(planner) - value("random")) / (value("comfort") - value("random"))
        };
        let (of_muscular, of_peripersonal) =
            (gain("peripersonal", "muscular"), gain("muscular", "peripersonal_scaled"));
        assert!(of_muscular < 0.5, "{task}: the peripersonal planner gains {of_muscular} of muscular comfort");
        // In drilling both planners reach the upper bound of muscular comfort. It hardly distinguishes plans there, so the
        // choice of the muscular planner is arbitrary: its gain is 61 %, and the report says that the conclusion fails.
        let saturated = of(&table, task, "comfort", "muscular") > 99.5;
        let bound = if saturated { 0.7 } else { 0.5 };
        assert!(
            of_peripersonal < bound,
            "{task}: the muscular planner gains {of_peripersonal} of peripersonal comfort"
        );
    }
}

#[test]
fn random_is_the_worst_in_both_comforts_together() {
    let (table, random) = (table1(), random());
    for (task, _) in PAPERS_MUSCULAR_SHARE {
        let sum = |planner| of(&table, task, planner, "muscular") + of(&table, task, planner, "peripersonal_scaled");
        for planner in ["comfort", "peripersonal", "muscular"] {
            // In drilling the peripersonal planner gives up nearly all muscular comfort, while the person's response to a
            // random plan is still the best one. Its sum is 1 % less than random's, and the report says that the
            // conclusion fails.
            let least = if (task, planner) == ("drilling", "peripersonal") { 0.97 } else { 1.0 };
            assert!(least * sum("random") < sum(planner), "{task} {planner}");
        }
        // The mean of each single seed is below the comfort planner in both comforts.
        let kind = if task == "cutting" { "cut-" } else { "drill-" };
        for seed in (1..=20).map(|seed| seed.to_string()) {
            for column in ["muscular", "peripersonal_scaled"] {
                let draws = random.figures(column, |row| row["seed"] == seed && row["operation"].starts_with(kind));
                assert!(mean(&draws) < of(&table, task, "comfort", column), "{task} {column} seed {seed}");
            }
        }
    }
}

/// `docs/reproduction.md` explains every conclusion that the report does not confirm.
#[test]
fn claims_that_fail_are_explained() {
    let report = fs::read_to_string(results().join("report.md")).unwrap();
    let page = fs::read_to_string(root().join("docs/reproduction.md")).unwrap().replace('\n', " ");
    let denied: Vec<_> = report.lines().filter(|line| line.contains("| **no**: ")).collect();
    for row in denied {
        let claim = row.split(" | ").next().unwrap().trim_start_matches("| ");
        assert!(page.contains(claim), "docs/reproduction.md does not explain: {claim}");
    }
}

#[test]
fn the_order_of_the_planners_is_the_same_under_every_assumption() {
    let table = Table::read(
        "sensitivity.csv",
        "assumption,task,planner,plans,muscular,peripersonal_scaled,muscular_normalised,peripersonal_normalised",
    );
    let assumptions: BTreeSet<_> = table.rows.iter().map(|row| row["assumption"].clone()).collect();
    assert_eq!(assumptions.len(), 11, "as reproduced, and ten changes: {assumptions:?}");
    for assumption in &assumptions {
        for (task, _) in PAPERS_MUSCULAR_SHARE {
            let of = |planner, column| {
                let found = table.figures(column, |row| {
                    row["assumption"] == *assumption && row["task"] == task && row["planner"] == planner
                });
                assert_eq!(found.len(), 1, "{assumption} {task} {planner}");
                found[0]
            };
            for (column, other) in [("muscular_normalised", "peripersonal"), ("peripersonal_normalised", "muscular")] {
                let comfort = of("comfort", column);
                assert!(comfort > 1.0, "{assumption}, {task}: {comfort} of random's {column}");
                assert!(comfort > of(other, column), "{assumption}, {task}: the {other} planner has more {column}");
            }
        }
    }
}

#[test]
fn every_plan_of_the_comfort_planner_holds_in_simulation() {
    let physics = physics();
    let of_comfort: Vec<_> = physics.rows.iter().filter(|row| row["planner"] == "comfort").collect();
    assert_eq!(of_comfort.len(), 25);
    for row in of_comfort {
        assert_eq!(row["verdict"], "holds", "{}", row["operation"]);
        let factor: f64 = row["load_factor_simulated"].parse().unwrap();
        assert!(factor >= 1.0, "{}: a plan that holds has a load factor of at least 1", row["operation"]);
    }
}

#[test]
fn the_best_case_alone_is_not_enough() {
    let text = fs::read_to_string(printed().join("best_case.csv")).unwrap();
    let verdicts: Vec<_> = text.lines().skip(1).map(|line| line.split(',').nth(2).unwrap()).collect();
    assert_eq!(verdicts.len(), 25);
    // Most plans for the best case fail; those for compliant arms do not (the test above).
    assert!(verdicts.iter().filter(|&&verdict| verdict == "holds").count() < 13, "{verdicts:?}");
}

#[test]
fn simulations_agree_with_predictions() {
    let (plans, physics) = (plans(), physics());
    for (plan, row) in plans.rows.iter().zip(&physics.rows) {
        let hold = format!("{} {}", row["operation"], row["planner"]);
        assert_eq!((&plan["operation"], &plan["planner"]), (&row["operation"], &row["planner"]));
        let figure = |row: &BTreeMap<String, String>, column: &str| row[column].parse::<f64>().unwrap();
        // The prediction is static and ignores the compliance of the pads and the oscillation after the ramp. The planner's
        // safety factor is 1.1; the bound is 1.5 times that margin. Hands near their limits may share the load otherwise and
        // deflect less, as those of cut-02 and of its mirror image cut-10 do, by a fifth; that is on the safe side.
        let deflection = figure(row, "deflection_mm") / figure(row, "predicted_deflection_mm");
        assert!((0.75..1.15).contains(&deflection), "{hold}: deflection {deflection} of the predicted");
        let load = figure(row, "load_factor_simulated") / figure(plan, "compliant_load_factor");
        assert!(load > 0.85, "{hold}: resists {load} of the predicted load");
        // The certificate bounds the load for all contact forces with the pads in their planned poses. A rotation by the
        // two degrees that are allowed changes lever arms by sin 2 deg = 3.5 %.
        let bound = figure(row, "load_factor_simulated") / figure(plan, "load_factor");
        assert!(bound < 1.035, "{hold}: resists {bound} of the certified load");
    }
}

fn reproduce(arguments: &[&str], out: &Path) -> Output {
    benchdog(root(), &[&["reproduce", "--quick", "--out", argument(out)], arguments].concat())
}

/// The files of a run that are committed, by path.
fn written(folder: &Path) -> Files {
    let is_own = |name: Component<'_>| ["work", "recordings", "timing.csv"].iter().any(|own| name.as_os_str() == *own);
    contents(folder).into_iter().filter(|(path, _)| !path.components().any(is_own)).collect()
}

/// A cut and a hole, which threads finish in any order.
const TWO_OPERATIONS: [&str; 4] = ["--filter", "cut-05", "--filter", "drill-5"];

#[test]
fn two_runs_agree_with_each_other() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let first = reproduce(&[&TWO_OPERATIONS[..], &["--jobs", "1"]].concat(), one.path());
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    let second = reproduce(&[&TWO_OPERATIONS[..], &["--jobs", "2"]].concat(), two.path());
    assert_eq!(second.status.code(), Some(0));
    let files = written(one.path());
    // Of each evaluation the report, seven tables, four pictures of each kind, and the curve as CSV and SVG; the plans by muscles.
    assert_eq!(files.len(), 2 * 18 + 1, "{:?}", files.keys());
    assert!(files == written(two.path()), "the same files whatever the number of threads");
    a_second_run_continues(one.path());
    assert!(files == written(one.path()), "the same files from the cache");
}

/// Six operations, others each day.
fn operations_of_the_day() -> Vec<String> {
    let days = SystemTime::UNIX_EPOCH.elapsed().unwrap().as_secs() / 86_400;
    let mut names: Vec<_> = paper::operations().into_iter().map(|operation| operation.name).collect();
    names.shuffle(&mut Pcg64::seed_from_u64(days));
    names.truncate(6);
    names
}

/// What is committed is what the program computes, in any of the 25 operations: six are computed again, others each day.
#[test]
fn the_program_still_computes_the_committed_results() {
    let operations = operations_of_the_day();
    let out = tempfile::tempdir().unwrap();
    let filters: Vec<_> = operations.iter().flat_map(|name| ["--filter", name.as_str()]).collect();
    let output = reproduce(&filters, out.path());
    assert_eq!(output.status.code(), Some(0), "{operations:?}: {}", stderr(&output));
    for operation in &operations {
        for (again, committed) in [(out.path().to_owned(), results()), (out.path().join("printed"), printed())] {
            committed_rows_agree(&again, &committed, operation);
        }
    }
}

/// The rows of an operation equal those of the committed tables; failing loads are empty with `--quick`, which has the first of the
/// random planner's seeds: three, or one as printed.
fn committed_rows_agree(again: &Path, committed: &Path, operation: &str) {
    let of_operation = format!("{operation},");
    let rows = |folder: &Path, name: &str| {
        let text = fs::read_to_string(folder.join(name)).unwrap();
        text.lines().filter(|line| line.starts_with(&of_operation)).map(str::to_owned).collect::<Vec<_>>()
    };
    let update = "the results differ from the committed ones: `cargo run --release -- reproduce` updates them";
    for name in ["plans.csv", "postures.csv", "best_case.csv"] {
        assert_eq!(rows(again, name), rows(committed, name), "{update}");
    }
    let seeds = rows(again, "random.csv");
    assert!([1, 3].contains(&seeds.len()));
    assert_eq!(seeds, rows(committed, "random.csv")[..seeds.len()], "{update}");
    let effort = rows(committed, "effort.csv");
    for row in rows(again, "effort.csv") {
        assert!(effort.contains(&row), "{row}: {update}");
    }
    let simulated = rows(again, "physics.csv");
    assert_eq!(simulated.len(), 4);
    for (quick, whole) in simulated.iter().zip(rows(committed, "physics.csv")) {
        assert_eq!(quick.rsplit_once(',').unwrap(), (whole.rsplit_once(',').unwrap().0, ""), "{update}");
    }
}

/// Only missing or damaged results are computed again.
fn a_second_run_continues(out: &Path) {
    let work = out.join("work");
    assert_eq!(
        fs::read_dir(&work).unwrap().count(),
        14,
        "per operation three planners and three random plans; a folder for the best case, and one by muscles"
    );
    fs::remove_file(work.join("drill-5-comfort-1.json")).unwrap();
    let damaged = work.join("drill-5-random-1.json");
    let text = fs::read_to_string(&damaged).unwrap();
    fs::write(&damaged, &text[..text.len() / 2]).unwrap();
    let output = reproduce(&[&TWO_OPERATIONS[..], &["--jobs", "1"]].concat(), out);
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "drill-5 comfort 1: holds\ndrill-5 random 1: holds\n");
}

#[test]
fn an_unknown_operation_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = reproduce(&["--filter", "saw"], &out);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.starts_with("error: --filter saw: found no operation that passes, expected one of cut-01, cut-02"));
    assert!(!out.exists());
}
