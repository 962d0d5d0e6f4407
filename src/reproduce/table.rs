//! The paper's Table I, for any set of results.

use super::{
    evaluation::{HoldRow, KINDS},
    statistics::{mean, quantile},
};
use crate::model::{operation::OperationKind, scenario::PlannerKind};

/// One planner and one kind of operation. A figure is `None` if no result has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Cut or drill.
    pub kind: OperationKind,
    /// The planner.
    pub planner: PlannerKind,
    /// Number of plans.
    pub plans: usize,
    /// Mean number of candidates that a search evaluated.
    pub candidates: Option<f64>,
    /// Mean of the regularised muscular comfort, [`HoldRow::muscular`].
    pub muscular: Option<f64>,
    /// Median of the muscular comfort as printed in the paper, which is unbounded, so its mean has no meaning.
    pub muscular_printed_median: Option<f64>,
    /// Mean of the peripersonal comfort as a sum over the body points.
    pub peripersonal_scaled: Option<f64>,
    /// `muscular` divided by that of the random planner.
    pub muscular_normalised: Option<f64>,
    /// `peripersonal_scaled` divided by that of the random planner.
    pub peripersonal_normalised: Option<f64>,
}

/// The rows by kind of operation and planner; kinds without results are left out. As in the paper, the means are normalised,
/// not the single figures.
#[must_use]
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
    fn means_are_divided_by_those_of_the_random_planner() {
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
    fn the_table_uses_the_mean_response_if_there_is_one() {
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
