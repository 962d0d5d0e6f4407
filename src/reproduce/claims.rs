//! What the paper concludes from its table, put to the test on ours.

use super::{
    evaluation::{HoldRow, KINDS, Reproduction, task},
    printed,
    table::{self, Row},
};
use crate::model::{operation::OperationKind, scenario::PlannerKind, verdict::VerdictKind};

/// Largest loss of peripersonal comfort against the planner of that comfort alone that still counts as near: in the paper
/// the comfort planner loses less than a hundredth; ours may lose as much as a twentieth.
pub const NEAR_PERIPERSONAL: f64 = 0.95;

/// A sentence, and whether our figures bear it out.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The sentence.
    pub sentence: String,
    /// The figures that decide, in words.
    pub figures: String,
    /// True when they bear it out.
    pub holds: bool,
}

/// All claims that there are figures for.
pub fn claims(reproduction: &Reproduction) -> Vec<Claim> {
    let rows = table::rows(reproduction.holds.iter());
    let mut claims = Vec::new();
    for kind in KINDS {
        let row = |planner| rows.iter().find(|row| row.kind == kind && row.planner == planner).and_then(Figures::of);
        if let (Some(comfort), Some(peripersonal), Some(muscular), Some(random)) = (
            row(PlannerKind::Comfort),
            row(PlannerKind::Peripersonal),
            row(PlannerKind::Muscular),
            row(PlannerKind::Random),
        ) {
            claims.extend(near(kind, comfort, peripersonal, muscular));
            claims.extend(one_sided(kind, comfort, peripersonal, muscular, random));
        }
    }
    claims.extend(simulated(reproduction));
    claims
}

/// A row of the table: mean muscular comfort and mean peripersonal comfort as a sum.
#[derive(Clone, Copy)]
struct Figures {
    muscular: f64,
    peripersonal: f64,
}

impl Figures {
    fn of(row: &Row) -> Option<Self> {
        Some(Self { muscular: row.muscular?, peripersonal: row.peripersonal_scaled? })
    }

    fn sum(self) -> f64 {
        self.muscular + self.peripersonal
    }
}

/// The comfort planner beside those that look at one comfort alone.
fn near(kind: OperationKind, comfort: Figures, peripersonal: Figures, muscular: Figures) -> Vec<Claim> {
    let share = comfort.muscular / muscular.muscular;
    let in_paper = |planner| printed::table(kind, planner).map_or(f64::NAN, |row| row.muscular);
    let papers_share = in_paper(PlannerKind::Comfort) / in_paper(PlannerKind::Muscular);
    let near_muscular = Claim {
        sentence: format!(
            "{}: the comfort planner is as near to the muscular planner's muscular comfort as in the paper, or nearer",
            task(kind)
        ),
        figures: format!("{share:.2} of it; in the paper {papers_share:.2}"),
        holds: share >= papers_share,
    };
    let share = comfort.peripersonal / peripersonal.peripersonal;
    let near_peripersonal = Claim {
        sentence: format!(
            "{}: the comfort planner is near the peripersonal planner's peripersonal comfort",
            task(kind)
        ),
        figures: format!("{share:.3} of it; at least {NEAR_PERIPERSONAL} asked for"),
        holds: share >= NEAR_PERIPERSONAL,
    };
    vec![near_muscular, near_peripersonal]
}

/// What the planners of one comfort do to the other, and what chance does to both.
fn one_sided(
    kind: OperationKind,
    comfort: Figures,
    peripersonal: Figures,
    muscular: Figures,
    random: Figures,
) -> Vec<Claim> {
    // Of what the comfort planner gains over chance.
    let gain = |value: f64, of: f64, from: f64| (value - from) / (of - from);
    let of_peripersonal = gain(muscular.peripersonal, comfort.peripersonal, random.peripersonal);
    let of_muscular = gain(peripersonal.muscular, comfort.muscular, random.muscular);
    let poor = |subject: &str, what: &str, share: f64| Claim {
        sentence: format!("{}: the {subject} planner is poor in {what} comfort", task(kind)),
        figures: format!("{:.0} % of the comfort planner's gain over random; less than half asked for", 100.0 * share),
        holds: share < 0.5,
    };
    let least = comfort.sum().min(peripersonal.sum()).min(muscular.sum());
    let worst = Claim {
        sentence: format!("{}: random is the worst in the sum of both comforts", task(kind)),
        figures: format!("{:.1}; the worst of the others {least:.1}", random.sum()),
        holds: random.sum() < least,
    };
    vec![poor("muscular", "peripersonal", of_peripersonal), poor("peripersonal", "muscular", of_muscular), worst]
}

/// Not the paper's, but what this project adds to it.
fn simulated(reproduction: &Reproduction) -> Option<Claim> {
    let of_comfort = || reproduction.first_seeds().filter(|hold| hold.planner == PlannerKind::Comfort);
    let all = of_comfort().count();
    let held = of_comfort().filter(|hold| holds(hold)).count();
    (all > 0).then(|| Claim {
        sentence: "every hold of the comfort planner holds in simulation".to_owned(),
        figures: format!("{held} of {all}"),
        holds: held == all,
    })
}

/// True when a hold was simulated and held.
pub fn holds(hold: &HoldRow) -> bool {
    hold.verdict.as_ref().is_some_and(|verdict| verdict.verdict == VerdictKind::Holds)
}
