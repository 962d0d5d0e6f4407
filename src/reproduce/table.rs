//! The paper's Table I of any set of holds.

use super::{
    evaluation::{HoldRow, KINDS},
    statistics::{mean, quantile},
};
use crate::model::{operation::OperationKind, scenario::PlannerKind};

/// One planner on one kind of operation. A figure is none where no hold has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Cut or drill.
    pub kind: OperationKind,
    /// The planner.
    pub planner: PlannerKind,
    /// How many plans the averages are over.
    pub plans: usize,
    /// Mean of the candidates that the search for a plan looked at.
    pub candidates: Option<f64>,
    /// Mean of the regularised muscular comfort, [`HoldRow::muscular`].
    pub muscular: Option<f64>,
    /// Median of the postures' muscular comfort as printed in the paper: it has no bound, so a mean of it says nothing.
    pub muscular_printed_median: Option<f64>,
    /// Mean of the peripersonal comfort, as a sum over the body's points.
    pub peripersonal_scaled: Option<f64>,
    /// `muscular` over that of the random planner.
    pub muscular_normalised: Option<f64>,
    /// `peripersonal_scaled` over that of the random planner.
    pub peripersonal_normalised: Option<f64>,
}

/// The table of a set of holds: kind by kind, planner by planner; kinds without holds are left out. As in the paper the
/// averages are normalised, not the single figures.
pub fn rows<'a>(holds: impl Iterator<Item = &'a HoldRow> + Clone) -> Vec<Row> {
    let mut rows = Vec::new();
    for kind in KINDS {
        let of_kind = holds.clone().filter(move |hold| hold.kind == kind);
        if of_kind.clone().next().is_none() {
            continue;
        }
        let mut of_planners =
            PlannerKind::ALL.map(|planner| row(kind, planner, of_kind.clone().filter(|h| h.planner == planner)));
        if let Some(random) = of_planners.iter().find(|row| row.planner == PlannerKind::Random).cloned() {
            for row in &mut of_planners {
                row.muscular_normalised = ratio(row.muscular, random.muscular);
                row.peripersonal_normalised = ratio(row.peripersonal_scaled, random.peripersonal_scaled);
            }
        }
        rows.extend(of_planners);
    }
    rows
}

fn row<'a>(kind: OperationKind, planner: PlannerKind, holds: impl Iterator<Item = &'a HoldRow> + Clone) -> Row {
    let comforts = || holds.clone().filter_map(HoldRow::comfort);
    Row {
        kind,
        planner,
        plans: comforts().count(),
        candidates: mean(holds.clone().filter_map(|hold| Some(hold.plan.as_ref()?.planner?.evaluations as f64))),
        muscular: mean(holds.clone().filter_map(HoldRow::muscular)),
        muscular_printed_median: quantile(comforts().map(|comfort| comfort.muscular).collect(), 0.5),
        peripersonal_scaled: mean(holds.clone().filter_map(HoldRow::peripersonal_scaled)),
        muscular_normalised: None,
        peripersonal_normalised: None,
    }
}

fn ratio(value: Option<f64>, by: Option<f64>) -> Option<f64> {
    Some(value? / by?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{model::plan::MeanComfort, reproduce::testing::hold};

    #[test]
    fn averages_are_normalised_by_the_random_planners() {
        use PlannerKind::{Comfort, Random};
        let holds = [
            hold("cut-01", Comfort, 1, 40.0, 0.5),
            hold("cut-02", Comfort, 1, 20.0, 0.7),
            hold("cut-01", Random, 1, 5.0, 0.2),
            hold("cut-01", Random, 2, 1.0, 0.4),
        ];
        let rows = rows(holds.iter());
        assert_eq!(rows.len(), 4, "the paper's four planners, and no row of drills");
        let [comfort, random] = [Comfort, Random].map(|kind| rows.iter().find(|r| r.planner == kind).unwrap());
        // Exact in binary but for 0.7: means 30 and 3, 0.6 and 0.3 times 64 points.
        assert_eq!((comfort.muscular, comfort.muscular_normalised), (Some(30.0), Some(10.0)));
        assert!((comfort.peripersonal_normalised.unwrap() - 2.0).abs() < 1e-12);
        assert_eq!((random.plans, random.muscular_normalised), (2, Some(1.0)));
        let muscular = rows.iter().find(|row| row.planner == PlannerKind::Muscular).unwrap();
        assert_eq!((muscular.plans, muscular.muscular, muscular.muscular_normalised), (0, None, None));
    }

    #[test]
    fn where_the_person_answers_by_a_mean_the_table_averages_it() {
        let mut holds =
            [hold("drill-1", PlannerKind::Comfort, 1, 40.0, 0.5), hold("drill-2", PlannerKind::Comfort, 1, 20.0, 0.75)];
        let comfort = holds[0].plan.as_mut().and_then(|plan| plan.comfort.as_mut()).unwrap();
        comfort.average = Some(MeanComfort { responses: 3, muscular_regularised: 10.0, peripersonal_m: 0.25 });
        let rows = rows(holds.iter());
        let row = rows.iter().find(|row| row.planner == PlannerKind::Comfort).unwrap();
        // (10 + 20) / 2; 64 points times (1/4 + 3/4) / 2.
        assert_eq!((row.muscular, row.peripersonal_scaled), (Some(15.0), Some(32.0)));
    }
}
