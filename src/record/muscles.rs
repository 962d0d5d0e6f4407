//! The muscles of the working arm: spindles on the arm, and a chart of the busiest ones, coloured by activation.

use nalgebra::Vector3;
use rerun::{Ellipsoids3D, FillMode, LineStrips2D, Points2D};

use super::{
    entity::entity,
    error::RecordError,
    frames::{from_z, quaternion, vec3},
    messages::Messages,
    palette,
};
use crate::model::{
    activation_colour::FULL_ACTIVATION,
    muscle_work::{BusyMuscle, ENDLESS_ACTIVATION, MuscleBelly, MuscleWork},
};

/// The entity of the chart.
pub(super) const CHART: &str = "muscles";

/// Width of the chart and height of a row, in units of the chart, and radius of a bar.
const WIDTH: f64 = 100.0;
const ROW: f64 = 11.0;
const BAR_RADIUS: f32 = 1.8;

/// Number of pieces of the coloured axis.
const AXIS_PIECES: usize = 50;

/// Logs the spindles of the regions, from a time on, s, or without time; the busiest one carries the name of its muscle.
pub(super) fn log_bellies(
    messages: &mut Messages,
    bellies: &[MuscleBelly],
    from_s: Option<f64>,
) -> Result<(), RecordError> {
    let busiest = bellies.iter().map(|belly| belly.busiest.activation).fold(0.0, f64::max);
    for belly in bellies {
        let [from_w, to_w] = &belly.ends_w;
        let centre_w = nalgebra::center(from_w, to_w);
        let along = to_w - from_w;
        let half_sizes = Vector3::new(belly.radius_m, belly.radius_m, along.norm() / 2.0);
        let shape = Ellipsoids3D::from_half_sizes([vec3(&half_sizes)])
            .with_centers([vec3(&centre_w.coords)])
            .with_quaternions([quaternion(&from_z(&along))])
            .with_colors([palette::activation(belly.busiest.activation)])
            .with_labels([belly.busiest.to_string()])
            .with_show_labels(belly.busiest.activation == busiest)
            .with_fill_mode(FillMode::Solid);
        messages.log(&entity(&["scene", "person", "muscles", &belly.region]), from_s, &shape)?;
    }
    Ok(())
}

/// Logs the chart: a bar for each of the busiest muscles over an axis in the colours of the scale.
pub(super) fn log_chart(messages: &mut Messages, work: &MuscleWork) -> Result<(), RecordError> {
    let bar = |row: usize, muscle: &BusyMuscle| strip(row_y(row) + 0.82 * ROW, [0.0, muscle.activation]);
    let rows = || work.busiest.iter().enumerate();
    let bars = LineStrips2D::new(rows().map(|(row, muscle)| bar(row, muscle)))
        .with_radii([BAR_RADIUS])
        .with_colors(work.busiest.iter().map(|muscle| palette::activation(muscle.activation)));
    messages.log_static(&entity(&[CHART, "bars"]), &bars)?;
    let names = rows().map(|(row, muscle)| (row_y(row), FULL_ACTIVATION / 2.0, muscle.to_string()));
    messages.log_static(&entity(&[CHART, "names"]), &texts(names))?;

    let axis_y = row_y(work.busiest.len()) + 0.4 * ROW;
    let piece = |index: usize| index as f64 / AXIS_PIECES as f64 * FULL_ACTIVATION;
    let axis = LineStrips2D::new((0..AXIS_PIECES).map(|index| strip(axis_y, [piece(index), piece(index + 1)])))
        .with_radii([BAR_RADIUS / 2.0])
        .with_colors((0..AXIS_PIECES).map(|index| palette::activation(piece(index))));
    messages.log_static(&entity(&[CHART, "axis"]), &axis)?;
    let endless = [strip_point(0.0, ENDLESS_ACTIVATION), strip_point(axis_y, ENDLESS_ACTIVATION)];
    let endless = LineStrips2D::new([endless]).with_radii([0.15]).with_colors([palette::chart()]);
    messages.log_static(&entity(&[CHART, "endless"]), &endless)?;
    let tick = |activation: f64, note| {
        // Texts are centred; those at the ends stay inside.
        let inside = activation.clamp(0.02 * FULL_ACTIVATION, 0.96 * FULL_ACTIVATION);
        (axis_y + 0.15 * ROW, inside, format!("{:.0} %{note}", 100.0 * activation))
    };
    let ticks = [(0.0, ""), (ENDLESS_ACTIVATION, ": for hours"), (2.0 * ENDLESS_ACTIVATION, ""), (FULL_ACTIVATION, "")];
    let ticks = ticks.map(|(activation, note)| tick(activation, note));
    messages.log_static(&entity(&[CHART, "ticks"]), &texts(ticks.into_iter()))
}

/// The part of the chart's plane to show: its ranges to the right and down.
pub(super) fn bounds(work: &MuscleWork) -> [[f64; 2]; 2] {
    [[-0.05 * WIDTH, 1.05 * WIDTH], [-0.3 * ROW, row_y(work.busiest.len()) + 1.3 * ROW]]
}

/// Top of a row.
fn row_y(row: usize) -> f64 {
    ROW * row as f64
}

/// A point of the chart: down, and to the right in proportion to an activation.
fn strip_point(y: f64, activation: f64) -> [f32; 2] {
    [(WIDTH * (activation / FULL_ACTIVATION).min(1.0)) as f32, y as f32]
}

fn strip(y: f64, activations: [f64; 2]) -> [[f32; 2]; 2] {
    activations.map(|activation| strip_point(y, activation))
}

/// Texts at heights and activations.
fn texts(rows: impl Iterator<Item = (f64, f64, String)>) -> Points2D {
    let (points, texts): (Vec<_>, Vec<_>) =
        rows.map(|(y, activation, text)| (strip_point(y, activation), text)).unzip();
    Points2D::new(points).with_radii([0.01]).with_colors([palette::chart()]).with_labels(texts).with_show_labels(true)
}
