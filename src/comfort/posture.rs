//! The comfort of one posture, and the objective.

use nalgebra::Point3;

use crate::{
    human::{ArmAngles, BODY_POINTS, Human, Muscular, MuscularFigures, peripersonal_m},
    model::{
        frames::Pose,
        plan::{Comfort, MeanComfort},
        scenario::{ComfortSettings, MuscularMetric},
        wrench::Wrench,
    },
};

/// The comfort of one posture of the person (docs/method.md#4-muscular-comfort, docs/method.md#5-peripersonal-comfort).
/// `wrench_w` is the operation's about the tool tip, W axes. The scores are left out, since they are not optimised:
/// [`Human::rula`] and [`Human::reba`] compute them for plans.
#[must_use]
pub fn posture_comfort(
    human: &Human,
    settings: &ComfortSettings,
    robot_points_w: &[Point3<f64>],
    x_wb: &Pose,
    q_rad: &ArmAngles,
    wrench_w: &Wrench,
) -> Comfort {
    let MuscularFigures { paper, intrinsic, shoulder } = human.muscular_figures(q_rad, x_wb, wrench_w, settings);
    let Muscular { activations, regularised, .. } = match settings.muscular {
        MuscularMetric::Paper => paper,
        MuscularMetric::Intrinsic => intrinsic,
        MuscularMetric::Muscles => human.muscular(q_rad, x_wb, wrench_w, settings),
    };
    let body = human.body_points_w(x_wb, q_rad);
    let peripersonal_m = peripersonal_m(settings.peripersonal, settings.saturation_m, &body, robot_points_w);
    Comfort {
        muscular: paper.printed,
        muscular_regularised: regularised,
        peripersonal_m,
        peripersonal_scaled: Some(BODY_POINTS as f64 * peripersonal_m),
        objective: objective(settings, regularised, peripersonal_m),
        activations,
        muscular_intrinsic: Some(intrinsic.regularised),
        shoulder: Some(shoulder),
        average: None,
        rula: None,
        reba: None,
    }
}

/// The objective `w_M muscular + w_P peripersonal` (docs/method.md#32-objective).
pub(super) fn objective(settings: &ComfortSettings, muscular_regularised: f64, peripersonal_m: f64) -> f64 {
    let [weight_muscular, weight_peripersonal] = settings.weights();
    weight_muscular * muscular_regularised + weight_peripersonal * peripersonal_m
}

/// The comfort with the objective of other weights: of the mean response if `comfort` has one.
#[must_use]
pub fn weighted(comfort: Comfort, settings: &ComfortSettings) -> Comfort {
    let (muscular_regularised, peripersonal_m) = match comfort.average {
        Some(average) => (average.muscular_regularised, average.peripersonal_m),
        None => (comfort.muscular_regularised, comfort.peripersonal_m),
    };
    Comfort { objective: objective(settings, muscular_regularised, peripersonal_m), ..comfort }
}

/// Adds the mean response to the comfort of a posture, and takes the objective from it.
pub fn use_mean_response(comfort: &mut Comfort, average: MeanComfort, settings: &ComfortSettings) {
    comfort.objective = objective(settings, average.muscular_regularised, average.peripersonal_m);
    comfort.average = Some(average);
}
