//! Muscular comfort against a musculoskeletal model that was made by others (`tests/data/muscle_referee.csv`).

use benchdog::{
    human::{Human, paper_tool},
    model::{
        frames::Pose,
        operation::OperationKind,
        scenario::{ComfortSettings, MuscularMetric, Person, StrengthDirection},
        wrench::Wrench,
    },
};
use nalgebra::Vector3;

const DATA: &str = include_str!("../data/muscle_referee.csv");

/// A posture of the referee.
struct Row {
    task: OperationKind,
    is_natural: bool,
    q_rad: [f64; 7],
    force_b_n: Vector3<f64>,
    shoulder_nm: Vector3<f64>,
    effort: f64,
}

fn rows() -> Vec<Row> {
    let lines = DATA.lines().filter(|line| !line.starts_with('#')).skip(1);
    let rows = lines.map(|line| {
        let cells: Vec<_> = line.split(',').collect();
        let number = |column: usize| cells[column].parse::<f64>().unwrap();
        let vector = |first: usize| Vector3::new(number(first), number(first + 1), number(first + 2));
        Row {
            task: if cells[0] == "cut" { OperationKind::Cut } else { OperationKind::Drill },
            is_natural: cells[1] == "natural",
            q_rad: std::array::from_fn(|joint| number(2 + joint)),
            force_b_n: vector(9),
            shoulder_nm: vector(12),
            effort: number(15),
        }
    });
    rows.collect()
}

fn human(task: OperationKind) -> Human {
    Human::new(&Person::PAPER, &paper_tool(task)).unwrap()
}

/// `||alpha||^2` of a posture by a metric.
fn effort(row: &Row, muscular: MuscularMetric) -> f64 {
    let settings = ComfortSettings { muscular, direction: StrengthDirection::Paper, ..ComfortSettings::default() };
    let wrench = Wrench::from_force(row.force_b_n);
    let found = human(row.task).muscular(&row.q_rad, &Pose::identity(), &wrench, &settings);
    found.activations.iter().map(|alpha| alpha * alpha).sum()
}

/// Ranks from 0, the mean rank for equal values.
fn ranks(values: &[f64]) -> Vec<f64> {
    let below = |value: f64| values.iter().filter(|other| **other < value).count() as f64;
    let equal = |value: f64| values.iter().filter(|other| **other == value).count() as f64;
    values.iter().map(|&value| below(value) + (equal(value) - 1.0) / 2.0).collect()
}

/// Spearman's rank correlation: Pearson's of the ranks.
fn spearman(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (ranks(a), ranks(b));
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

#[test]
fn the_moments_about_the_shoulder_are_the_referees() {
    for row in rows() {
        let torques = human(row.task).joint_torques(&row.q_rad, &Pose::identity(), &Wrench::from_force(row.force_b_n));
        // The file has six decimals.
        assert!((torques.shoulder_v_nm() - row.shoulder_nm).norm() < 5e-6, "{torques:?} {:?}", row.shoulder_nm);
    }
}

/// The effort of the muscles in a posture.
fn muscle_effort(row: &Row) -> f64 {
    let program = human(row.task).muscle_program(&row.q_rad, &Pose::identity(), &Wrench::from_force(row.force_b_n));
    program.solve().unwrap().effort
}

#[test]
fn the_effort_of_the_muscles_is_the_referees() {
    let rows = rows();
    // The musculoskeletal model itself has corners where a muscle begins to wrap around a bone; ours are polynomials.
    for (is_natural, at_least) in [(true, 0.985), (false, 0.97)] {
        let rows: Vec<_> = rows.iter().filter(|row| row.is_natural == is_natural).collect();
        let [ours, theirs] =
            [muscle_effort, |row: &Row| row.effort].map(|of| rows.iter().map(|row| of(row)).collect::<Vec<_>>());
        let mut off: Vec<_> = ours.iter().zip(&theirs).map(|(ours, theirs)| (ours / theirs - 1.0).abs()).collect();
        off.sort_by(f64::total_cmp);
        let (median, ninth) = (off[off.len() / 2], off[off.len() * 9 / 10]);
        let correlation = spearman(&ours, &theirs);
        println!(
            "natural: {is_natural}, {} postures: median error {median:.4}, nine tenths below {ninth:.3}, Spearman {correlation:.4}",
            rows.len()
        );
        assert!(median < 0.06 && correlation >= at_least, "natural {is_natural}: {median} {correlation}");
    }
}

#[test]
fn the_intrinsic_metric_ranks_postures_as_the_muscles_do() {
    let rows = rows();
    for (task, is_natural, at_least) in [
        (OperationKind::Cut, true, 0.70),
        (OperationKind::Drill, true, 0.70),
        (OperationKind::Cut, false, 0.55),
        (OperationKind::Drill, false, 0.55),
    ] {
        let rows: Vec<_> = rows.iter().filter(|row| row.task == task && row.is_natural == is_natural).collect();
        assert!(rows.len() >= 70, "{}", rows.len());
        let muscles: Vec<_> = rows.iter().map(|row| row.effort).collect();
        let by = |metric| spearman(&rows.iter().map(|row| effort(row, metric)).collect::<Vec<_>>(), &muscles);
        let (intrinsic, paper) = (by(MuscularMetric::Intrinsic), by(MuscularMetric::Paper));
        println!("{task} natural: {is_natural}, {} postures: intrinsic {intrinsic:.3}, paper {paper:.3}", rows.len());
        assert!(intrinsic >= at_least, "{task} natural {is_natural}: {intrinsic} (paper {paper})");
    }
}
