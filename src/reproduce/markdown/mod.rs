//! `report.md`, of the whole run and of the evaluation as printed.

mod opening;
mod sensitivity;
mod simulation;
mod tables;
mod words;

pub use words::{picture_name, picture_title};

use std::fmt::Write as _;

use super::{
    evaluation::{Circle, HoldRow, KINDS, Reproduction, Results, task},
    statistics,
};
use crate::model::scenario::PlannerKind;
use words::figure;

// Writing to a string does not fail, so the results of `writeln!` are ignored.

/// The report of a run: both evaluations, with the details of the natural one. It refers to pictures and CSV files in the same
/// folder, and to those of the evaluation as printed in `printed/`.
#[must_use]
pub fn report(results: &Results) -> String {
    let natural = &results.natural;
    let mut text = String::from("# The paper again, with both comforts\n\n");
    opening::opening(&mut text, results);
    left_out(&mut text, natural);
    tables::table_one(&mut text, results);
    tables::claims(&mut text, results);
    tables::raw(&mut text, results);
    tables::ergonomics(&mut text, results);
    tables::effort(&mut text, results);
    tables::kept(&mut text, results);
    if let Some(circle) = &results.circle {
        whole_circle(&mut text, circle);
    }
    simulation::section(&mut text, natural);
    simulation::best_case(&mut text, natural);
    seeds(&mut text, natural);
    pictures(&mut text, natural);
    curve(&mut text);
    text
}

/// The report of the evaluation as printed.
#[must_use]
pub fn printed_report(results: &Results) -> String {
    let printed = &results.printed;
    let mut text = String::from("# The paper's formulas as printed\n\n");
    text.push_str(
        "Written by `benchdog reproduce`; do not edit. The metric of muscular comfort, the person without limits of the posture, the\n\
         shoulder and the first knife are those of the paper. [The report](../report.md) compares them with a person who stands\n\
         naturally; `docs/reproduction.md` explains both.\n",
    );
    left_out(&mut text, printed);
    simulation::section(&mut text, printed);
    simulation::best_case(&mut text, printed);
    seeds(&mut text, printed);
    pictures(&mut text, printed);
    curve(&mut text);
    sensitivity::section(&mut text, printed);
    text
}

fn left_out(text: &mut String, reproduction: &Reproduction) {
    if let Some(left_out) = &reproduction.left_out {
        let _ = writeln!(text, "\n**Not the whole evaluation**: {left_out}.");
    }
}

fn curve(text: &mut String) {
    text.push_str(
        "\n## Muscular comfort along the circle\n\nBest and worst posture of the person at each of the 16 cutting points, with the board upright in one place\n\
         (`muscular_curve.csv`).\n\n![Best and worst muscular comfort at 16 cutting points](muscular_curve.svg)\n",
    );
}

/// The circle from the task planner, beside what the paper says of it.
fn whole_circle(text: &mut String, circle: &Circle) {
    let [moves, regrasps] = circle.moves_and_regrasps;
    let _ = write!(
        text,
        "\n## Rotating the board\n\nThe paper expects that the effort can stay low during the cutting of the whole circle if a robot keeps rotating the\n\
         object. `benchdog task` plans it for a natural person: {} pieces, {moves} motions and {regrasps} regrasps, simulated as a\n\
         whole for {:.0} s: **{}** (`circle.csv`). The ratio is the staged plan's effort over that of the strategy, on the pieces that\n\
         both serve.\n\n| strategy | pieces | effort by muscles | ratio | objective |\n|---|---|---|---|---|\n",
        circle.pieces, circle.duration_s, circle.verdict
    );
    for row in &circle.rows {
        let _ = writeln!(
            text,
            "| {} | {} of {} | {} | {} | {} |",
            row.strategy,
            row.served,
            circle.pieces,
            figure(row.mean_effort, 3),
            figure(row.staged_ratio, 2),
            figure(row.mean_objective, 1)
        );
    }
}

/// The spread, over the seeds, of the means over the operations of a kind.
fn seeds(text: &mut String, reproduction: &Reproduction) {
    text.push_str(
        "\n## Spread of the random planner\n\nEach seed gives a mean over the operations, as in the paper's single run. The table shows mean, standard deviation and\n\
         range of these means over the seeds (`random.csv`).\n\n\
         | task | comfort | mean | deviation | range |\n|---|---|---|---|---|\n",
    );
    for kind in KINDS {
        let of_seed = |seed: u64| {
            let draws = reproduction.holds.iter().filter(move |h| h.planner == PlannerKind::Random && h.kind == kind);
            draws.filter(move |hold| hold.seed == seed)
        };
        let means = |figure: fn(&HoldRow) -> Option<f64>| -> Vec<f64> {
            (1..=reproduction.random_seeds)
                .filter_map(|seed| statistics::mean(of_seed(seed).filter_map(figure)))
                .collect()
        };
        let muscular = means(HoldRow::muscular);
        let peripersonal = means(HoldRow::peripersonal_scaled);
        for (name, means) in [("muscular", muscular), ("peripersonal", peripersonal)] {
            let quantile = |share| figure(statistics::quantile(means.clone(), share), 2);
            let _ = writeln!(
                text,
                "| {} | {name} | {} | {} | {} to {} |",
                task(kind),
                figure(statistics::mean(means.iter().copied()), 2),
                figure(statistics::standard_deviation(&means), 2),
                quantile(0.0),
                quantile(1.0)
            );
        }
    }
}

/// The pictures of all planners for one operation of each kind.
fn pictures(text: &mut String, reproduction: &Reproduction) {
    text.push_str(
        "\n## Configurations\n\nThe plan of each planner for one operation of each kind. The red arrow is the tool's force on the board, the\n\
         dashed line the line of sight. For a natural posture the view from above shows the sector in front of the person that the\n\
         tool tip must be over.\n",
    );
    for operation in KINDS.into_iter().filter_map(|kind| reproduction.drawn(kind)) {
        for planner in PlannerKind::ALL {
            if let Some(hold) = reproduction.hold(operation, planner).filter(|hold| hold.plan.is_some()) {
                let _ = writeln!(text, "\n![{}](pictures/{})", picture_title(hold), picture_name(hold));
            }
        }
    }
}
