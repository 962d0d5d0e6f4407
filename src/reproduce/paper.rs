//! The 25 operations of the paper's evaluation: 16 cuts of a circle (`docs/method.md#23-cutting`) and a grid of nine holes
//! (`docs/method.md#22-drilling`). The paper states no sizes; board, pitch and radius are assumptions.
//!
//! The operations are texts of scenario files, so they pass the same checks. [`operations`] have the format's defaults;
//! [`printed_operations`] have the paper's person: its muscular metric, a shoulder limited by its angles, no limits of the
//! posture, and the first knife.

use std::{f64::consts::TAU, path::Path};

use crate::{
    model::operation::OperationKind,
    scenario::{InputError, LoadedScenario, load_text},
};

/// Number of cuts.
pub const CUTS: usize = 16;

/// Number of holes, in three rows of three.
pub const DRILLS: usize = 9;

/// Radius of the circle, m. An assumption, see `docs/method.md#23-cutting`.
const RADIUS_M: f64 = 0.12;

/// Force of a cut, N.
const CUT_N: f64 = 30.0;

/// Distance between neighbouring holes, m. An assumption, see `docs/method.md#22-drilling`.
const PITCH_M: f64 = 0.10;

/// Thrust of a drill, N.
const DRILL_N: f64 = 15.0;

/// One operation of the evaluation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PaperOperation {
    /// `cut-01` to `cut-16`, `drill-1` to `drill-9`.
    pub name: String,
    /// Cut or drill.
    pub kind: OperationKind,
    /// The text of its scenario file.
    pub text: String,
}

impl PaperOperation {
    /// The resolved scenario.
    ///
    /// # Errors
    /// As [`load_text`]. The operations of this module are valid.
    pub fn load(&self) -> Result<LoadedScenario, InputError> {
        load_text(Path::new(&self.name), &self.text)
    }
}

/// Keys of the paper's person.
const PAPER_PERSON: &str =
    "\n[human]\nshoulder = \"box\"\nposture = \"unrestricted\"\n\n[comfort]\nmuscular = \"paper\"\n";

/// Keys of the knife that the reproduction uses.
const PAPER_KNIFE: &str = "\n[tool]\nname = \"knife-thumb-side\"\n";

/// The person and the metric of an evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evaluation {
    /// A person who stands as people stand, with the intrinsic metric and the knife that is drawn: the defaults of a scenario.
    Natural,
    /// The paper's formulas as they are printed, without limits of the posture.
    Printed,
}

impl Evaluation {
    /// Both, in the order in which they are run.
    pub const ALL: [Self; 2] = [Self::Natural, Self::Printed];

    /// The operations.
    #[must_use]
    pub fn operations(self) -> Vec<PaperOperation> {
        match self {
            Self::Natural => operations(),
            Self::Printed => printed_operations(),
        }
    }

    /// The name in messages and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Natural => "natural",
            Self::Printed => "as printed",
        }
    }
}

/// All operations in the order of tables, for a person who stands as people stand: the cuts counter-clockwise about +z_O, starting
/// at +x_O; the holes row by row from (-x_O, -y_O).
#[must_use]
pub fn operations() -> Vec<PaperOperation> {
    (1..=CUTS).map(cut).chain((1..=DRILLS).map(drill)).collect()
}

/// The same operations with the paper's person and metric, as printed.
#[must_use]
pub fn printed_operations() -> Vec<PaperOperation> {
    let mut operations = operations();
    for operation in &mut operations {
        operation.text.push_str(PAPER_PERSON);
        if operation.kind == OperationKind::Cut {
            operation.text.push_str(PAPER_KNIFE);
        }
    }
    operations
}

/// Cut `k` at the angle `2 pi (k - 1) / 16`, along the tangent, counter-clockwise.
fn cut(k: usize) -> PaperOperation {
    let (sin, cos) = libm::sincos(TAU * (k - 1) as f64 / CUTS as f64);
    let (x_m, y_m) = (RADIUS_M * cos, RADIUS_M * sin);
    let name = format!("cut-{k:02}");
    // `{:?}` writes the shortest decimal that reads back as the same number.
    let text = format!(
        "format = 1\nname = \"{name}\"\n\n[operation]\nkind = \"cut\"\npoint_m = [{x_m:?}, {y_m:?}]\n\
         direction_o = [{:?}, {cos:?}, 0.0]\nforce_n = {CUT_N:?}\n",
        -sin
    );
    PaperOperation { name, kind: OperationKind::Cut, text }
}

fn drill(k: usize) -> PaperOperation {
    let [x_m, y_m] = [(k - 1) % 3, (k - 1) / 3].map(|step| PITCH_M * (step as f64 - 1.0));
    let name = format!("drill-{k}");
    let text = format!(
        "format = 1\nname = \"{name}\"\n\n[operation]\nkind = \"drill\"\npoint_m = [{x_m:?}, {y_m:?}]\nforce_n = {DRILL_N:?}\n"
    );
    PaperOperation { name, kind: OperationKind::Drill, text }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn cuts_are_on_a_circle_and_along_its_tangent() {
        let cuts: Vec<_> = operations().into_iter().filter(|o| o.kind == OperationKind::Cut).collect();
        assert_eq!(cuts.len(), CUTS);
        for (index, operation) in cuts.iter().enumerate() {
            let cut = operation.load().unwrap().scenario.operation;
            let (p_ot, force_n) = (cut.x_ot.translation.vector, cut.wrench_o.force_n);
            // On the circle and along its tangent, with a positive moment about z_O: counter-clockwise. The tolerances are a few
            // rounding errors of numbers below 30.
            assert!((p_ot.xy().norm() - 0.12).abs() < 1e-15 && (force_n.norm() - 30.0).abs() < 1e-13, "{index}");
            assert!((p_ot.cross(&force_n).z - 0.12 * 30.0).abs() < 1e-13, "{index}");
            let angle_rad = libm::atan2(p_ot.y, p_ot.x).rem_euclid(TAU);
            assert!((angle_rad - TAU * index as f64 / 16.0).abs() < 1e-14, "{index}");
        }
    }

    #[test]
    fn holes_are_in_rows_from_the_lower_left() {
        let holes: Vec<_> = operations().into_iter().filter(|o| o.kind == OperationKind::Drill).collect();
        let points: Vec<_> = holes
            .iter()
            .map(|hole| {
                let drill = hole.load().unwrap().scenario.operation;
                assert_eq!(drill.wrench_o.force_n, Vector3::new(0.0, 0.0, -15.0), "{}", hole.name);
                (drill.x_ot.translation.vector.xy() * 10.0).map(f64::round)
            })
            .collect();
        let expected: Vec<_> = [-1.0, 0.0, 1.0].into_iter().flat_map(|y| [-1.0, 0.0, 1.0].map(|x| (x, y))).collect();
        assert_eq!(points.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>(), expected);
    }
}
