//! The committed results for a person who stands naturally: every limit is kept, every plan holds, the comfort planner is near
//! the best known. `cargo run --release -- reproduce` updates them.

use std::{collections::BTreeMap, fs, path::Path};

use benchdog::{model::scenario::PostureLimits, reproduce::paper};

use crate::common::{best_known, root};

type Row = BTreeMap<String, String>;

fn rows(folder: &Path, name: &str) -> Vec<Row> {
    let text = fs::read_to_string(folder.join(name)).unwrap();
    csv::Reader::from_reader(text.as_bytes()).deserialize().map(Result::unwrap).collect()
}

fn committed(name: &str) -> Vec<Row> {
    rows(&root().join("results"), name)
}

#[test]
fn every_plan_of_every_planner_keeps_every_limit() {
    let PostureLimits {
        facing_deg,
        view_deg,
        gaze_yaw_deg,
        gaze_pitch_deg,
        eye_distance_m,
        face_elevation_deg,
        upper_arm_deg,
        reach,
        elbow_deg,
        limit_margin_deg,
        deviation_margin_deg,
        ..
    } = PostureLimits::NATURAL;
    let above = |low: f64| [low, f64::INFINITY];
    let below = |high: f64| [f64::NEG_INFINITY, high];
    let limits = [
        ("facing_deg", [-facing_deg, facing_deg]),
        ("view_deg", below(view_deg)),
        ("gaze_yaw_deg", [-gaze_yaw_deg, gaze_yaw_deg]),
        ("gaze_pitch_deg", gaze_pitch_deg),
        ("eye_distance_m", eye_distance_m),
        ("line_of_sight", above(1.0)),
        ("face_elevation_deg", above(face_elevation_deg)),
        ("upper_arm_deg", below(upper_arm_deg)),
        ("reach", below(reach)),
        ("elbow_deg", elbow_deg),
        ("limit_margin_deg", above(limit_margin_deg)),
        ("deviation_margin_deg", above(deviation_margin_deg)),
    ];
    let postures = committed("postures.csv");
    // 25 operations, four planners: all found.
    assert_eq!(postures.len(), 100);
    for row in postures {
        for (key, [low, high]) in limits {
            let value: f64 = row[key].parse().unwrap();
            // Six decimals are written.
            let half_digit = 0.5e-6;
            let kept = low - half_digit <= value && value <= high + half_digit;
            assert!(kept, "{} {}: {key} {value}", row["operation"], row["planner"]);
        }
    }
}

#[test]
fn every_plan_holds_in_simulation() {
    let physics = committed("physics.csv");
    assert_eq!(physics.len(), 100);
    for row in physics {
        assert_eq!(row["verdict"], "holds", "{} {}", row["operation"], row["planner"]);
    }
}

#[test]
fn every_comfort_plan_is_near_the_best_known() {
    let plans = committed("plans.csv");
    for operation in paper::operations() {
        let name = &operation.name;
        let row = plans.iter().find(|row| row["operation"] == *name && row["planner"] == "comfort").unwrap();
        let share = row["objective"].parse::<f64>().unwrap() / best_known::natural(name).unwrap();
        assert!((0.985..1.002).contains(&share), "{name}: {share} of the best known");
    }
}

#[test]
fn each_planner_is_best_at_its_own_comfort() {
    let plans = committed("plans.csv");
    for task in ["cut", "drill"] {
        let mean = |planner: &str, column: &str| {
            let of = plans.iter().filter(|row| row["operation"].starts_with(task) && row["planner"] == planner);
            let values: Vec<f64> = of.map(|row| row[column].parse().unwrap()).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        for other in ["comfort", "peripersonal", "random"] {
            assert!(mean("muscular", "muscular") > mean(other, "muscular"), "{task} {other}");
        }
        for other in ["comfort", "muscular", "random"] {
            assert!(mean("peripersonal", "peripersonal_m") > mean(other, "peripersonal_m"), "{task} {other}");
        }
        for other in ["muscular", "peripersonal", "random"] {
            assert!(mean("comfort", "objective") > mean(other, "objective"), "{task} {other}");
        }
    }
}

/// At the same weights the comfort planner has at least 99 % of what any plan of the front has.
#[test]
fn the_comfort_planner_is_on_the_front() {
    let front = committed("front.csv");
    assert_eq!(front.len(), 25);
    for row in front {
        let share: f64 = row["objective_kept"].parse().unwrap();
        assert!(share >= 0.99, "{}: {share} of the front's best objective", row["operation"]);
    }
}

/// The muscles are a model that the planner does not know: its holds need less than half the effort of random ones in each task, and those
/// planned by the muscles still less.
#[test]
fn comfortable_holds_need_less_effort_than_random_ones() {
    let effort = committed("effort.csv");
    for task in ["cut", "drill"] {
        let mean = |planner: &str| {
            let of = effort.iter().filter(|row| row["operation"].starts_with(task) && row["planner"] == planner);
            let values: Vec<f64> = of.map(|row| row["effort"].parse().unwrap()).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        let (by_muscles, comfort, random) = (mean("by-muscles"), mean("comfort"), mean("random"));
        assert!(by_muscles < comfort && 2.0 * comfort < random, "{task}: {by_muscles}, {comfort}, {random}");
    }
    let by_muscles = committed("by_muscles.csv");
    assert_eq!(by_muscles.len(), 25);
    for row in by_muscles {
        assert_eq!(row["verdict"], "holds", "{} by muscles", row["operation"]);
    }
}

#[test]
fn the_whole_circle_is_served_with_less_effort_than_any_other_way_but_separate_holds() {
    let circle = committed("circle.csv");
    let of = |strategy: &str| circle.iter().find(|row| row["strategy"].starts_with(strategy)).unwrap();
    assert_eq!(of("staged")["pieces"], "16");
    for other in ["one hold", "random"] {
        let ratio: f64 = of(other)["staged_ratio"].parse().unwrap();
        assert!(ratio < 0.5, "{other}: {ratio}");
    }
}
