//! The paper's conclusions from its Table I, tested on ours.

use super::{
    evaluation::{HoldRow, KINDS, Reproduction, task},
    printed,
    table::{self, Row},
};
use crate::model::{operation::OperationKind, scenario::PlannerKind, verdict::VerdictKind};

/// Smallest ratio of peripersonal comfort, comfort planner over peripersonal planner, that counts as near. In the paper it is
/// above 0.99.
pub const NEAR_PERIPERSONAL: f64 = 0.95;

/// A conclusion, and whether our figures confirm it.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The conclusion.
    pub sentence: String,
    /// The deciding figures.
    pub figures: String,
    /// True if they confirm it.
    pub holds: bool,
}

/// All claims for which there are figures.
#[must_use]
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

/// The mean comforts of a row of the table.
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

/// The comfort planner compared with the planners of one comfort.
fn near(kind: OperationKind, comfort: Figures, peripersonal: Figures, muscular: Figures) -> Vec<Claim> {
    let share = comfort.muscular / muscular.muscular;
    let in_paper = |planner| printed::table(kind, planner).map_or(f64::NAN, |row| row.muscular);
    let papers_share = in_paper(PlannerKind::Comfort) / in_paper(PlannerKind::Muscular);
    let near_muscular = Claim {
        sentence: format!(
            "{}: the comfort planner reaches as much of the muscular planner's muscular comfort as in the paper",
            task(kind)
        ),
        figures: format!("{share:.2} of it; {papers_share:.2} in the paper"),
        holds: share >= papers_share,
    };
    let share = comfort.peripersonal / peripersonal.peripersonal;
    let near_peripersonal = Claim {
        sentence: format!(
            "{}: the comfort planner is near the peripersonal planner's peripersonal comfort",
            task(kind)
        ),
        figures: format!("{share:.3} of it; at least {NEAR_PERIPERSONAL} required"),
        holds: share >= NEAR_PERIPERSONAL,
    };
    vec![near_muscular, near_peripersonal]
}

/// The planners of one comfort are poor in the other, and the random planner is the worst in the sum.
fn one_sided(
    kind: OperationKind,
    comfort: Figures,
    peripersonal: Figures,
    muscular: Figures,
    random: Figures,
) -> Vec<Claim> {
    // As a share of the comfort planner's gain over the random planner.
    let gain = |value: f64, of: f64, from: f64| (value - from) / (of - from);
    let of_peripersonal = gain(muscular.peripersonal, comfort.peripersonal, random.peripersonal);
    let of_muscular = gain(peripersonal.muscular, comfort.muscular, random.muscular);
    let poor = |subject: &str, what: &str, share: f64| Claim {
        sentence: format!("{}: the {subject} planner is poor in {what} comfort", task(kind)),
        figures: format!("{:.0} % of the comfort planner's gain over random; less than half required", 100.0 * share),
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

/// All plans of the comfort planner hold in simulation. Not a conclusion of the paper.
fn simulated(reproduction: &Reproduction) -> Option<Claim> {
    let of_comfort = || reproduction.first_seeds().filter(|hold| hold.planner == PlannerKind::Comfort);
    let count = of_comfort().count();
    let held = of_comfort().filter(|hold| holds(hold)).count();
    (count > 0).then(|| Claim {
        sentence: "every plan of the comfort planner holds in simulation".to_owned(),
        figures: format!("{held} of {count}"),
        holds: held == count,
    })
}

/// True if the plan was simulated and its verdict is `holds`.
#[must_use]
pub fn holds(hold: &HoldRow) -> bool {
    hold.verdict.as_ref().is_some_and(|verdict| verdict.verdict == VerdictKind::Holds)
}
