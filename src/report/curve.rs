//! Muscular comfort along the circle (`docs/method.md#411-muscular-comfort-along-a-circle`), as CSV and as a plot.

use std::fmt::Write as _;

use super::{
    csv_text::csv_text,
    picture::{document, label, line, vertical_label},
};
use crate::{
    comfort::curve::{Curve, CurvePoint, POINTS, Span},
    human::muscular::formula_in_words,
};

/// One way of standing: its name in the CSV, its legend, and the colour of its bars and their offset from the tick, px.
struct Series {
    name: &'static str,
    legend: &'static str,
    colour: &'static str,
    offset_px: f64,
    span: fn(&CurvePoint) -> Option<Span>,
}

/// Blue and vermilion of the palette of Okabe and Ito, which colour-blind readers can tell apart.
const SERIES: [Series; 2] = [
    Series { name: "free", legend: "standing anywhere", colour: "#0072b2", offset_px: -7.0, span: |point| point.free },
    Series {
        name: "fixed",
        legend: "standing in one place for all points",
        colour: "#d55e00",
        offset_px: 7.0,
        span: |point| point.fixed,
    },
];

/// The curve as CSV: one row per point and way of standing; the figures are empty if the person has no solution.
#[must_use]
pub fn csv(curve: &Curve) -> String {
    let header = [
        "point",
        "angle_deg",
        "standing",
        "reachable",
        "worst_regularised",
        "best_regularised",
        "worst_printed",
        "best_printed",
    ];
    let rows = curve.points.iter().enumerate().flat_map(|(index, point)| {
        SERIES.iter().map(move |series| {
            let span = (series.span)(point);
            let figures = span.map_or_else(Default::default, |Span { worst, best }| {
                [worst.regularised, best.regularised, worst.printed, best.printed]
                    .map(|comfort| format!("{comfort:.4}"))
            });
            let angle_deg = point.angle_rad.to_degrees();
            let place = [(index + 1).to_string(), format!("{angle_deg:.1}"), series.name.to_owned()];
            place.into_iter().chain([span.is_some().to_string()]).chain(figures).collect()
        })
    });
    csv_text(&header, rows)
}

/// The edges of the plot's axes, px: left, right, top, bottom.
const AREA_PX: [f64; 4] = [64.0, 784.0, 64.0, 360.0];

/// The curve as SVG: for each point and way of standing a bar from the worst to the best comfort, or a cross if the person
/// has no solution.
#[must_use]
pub fn svg(curve: &Curve) -> String {
    let [left, right, top, bottom] = AREA_PX;
    let highest = curve.points.iter().flat_map(|point| [point.free, point.fixed]).flatten();
    let highest = highest.map(|span| span.best.regularised).fold(0.0, f64::max);
    let step = grid_step(highest);
    let steps = (highest / step).ceil().max(1.0);
    let y_px = |comfort: f64| bottom - (bottom - top) * comfort / (steps * step);
    let x_px = |index: usize| left + (right - left) * (index as f64 + 0.5) / POINTS as f64;
    let mut body = String::new();
    for k in 0..=steps as u32 {
        let comfort = step * f64::from(k);
        let y = y_px(comfort);
        line(&mut body, [left, y, right, y], "#dddddd", 1.0);
        label(&mut body, left - 8.0, y + 4.0, "end", &format!("{comfort}"));
    }
    for (index, point) in curve.points.iter().enumerate() {
        label(&mut body, x_px(index), bottom + 18.0, "middle", &format!("{}", index + 1));
        for series in &SERIES {
            let x = x_px(index) + series.offset_px;
            match (series.span)(point) {
                Some(Span { worst, best }) => {
                    bar(&mut body, x, y_px(best.regularised), y_px(worst.regularised), series.colour);
                }
                None => cross(&mut body, x, bottom - 6.0, series.colour),
            }
        }
    }
    legend(&mut body);
    label(&mut body, (left + right) / 2.0, bottom + 40.0, "middle", "cutting point, counter-clockwise from the right");
    vertical_label(&mut body, left - 44.0, f64::midpoint(top, bottom), "muscular comfort, 1");
    let formula = formula_in_words(curve.metric);
    let title = format!("Muscular comfort {formula}, from the worst to the best solution");
    label(&mut body, left, 22.0, "start", &title);
    document(&body, [800.0, 410.0])
}

/// The distance of grid lines, a round number for at most eight lines.
fn grid_step(highest: f64) -> f64 {
    [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| highest <= 8.0 * step).unwrap_or(20.0)
}

fn legend(body: &mut String) {
    let [left, ..] = AREA_PX;
    for (index, series) in SERIES.iter().enumerate() {
        let x = left + 8.0 + 260.0 * index as f64;
        line(body, [x, 42.0, x + 18.0, 42.0], series.colour, 5.0);
        label(body, x + 24.0, 46.0, "start", series.legend);
    }
    cross(body, left + 536.0, 42.0, "#222222");
    label(body, left + 548.0, 46.0, "start", "no solution");
}

/// A bar, at least one pixel high.
fn bar(body: &mut String, x: f64, top: f64, bottom: f64, colour: &str) {
    let height = (bottom - top).max(1.0);
    let x = x - 4.5;
    let _ = writeln!(body, "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"9\" height=\"{height:.1}\" fill=\"{colour}\"/>");
}

fn cross(body: &mut String, x: f64, y: f64, colour: &str) {
    line(body, [x - 4.0, y - 4.0, x + 4.0, y + 4.0], colour, 2.0);
    line(body, [x - 4.0, y + 4.0, x + 4.0, y - 4.0], colour, 2.0);
}

#[cfg(test)]
mod tests {
    use nalgebra::Isometry3;

    use super::*;
    use crate::{human::Muscular, model::scenario::MuscularMetric};

    fn curve() -> Curve {
        let of = |activation| Muscular::of([activation; 7], 0.01);
        let span = Span { worst: of(0.5), best: of(0.1) };
        let mut points = [CurvePoint { angle_rad: 0.0, free: Some(span), fixed: Some(span) }; POINTS];
        points[3] = CurvePoint { angle_rad: std::f64::consts::FRAC_PI_2, free: Some(span), fixed: None };
        Curve { metric: MuscularMetric::Paper, x_wo: Isometry3::identity(), x_wb_fixed: None, points }
    }

    #[test]
    fn the_table_has_a_row_a_point_and_way_of_standing() {
        let text = csv(&curve());
        assert_eq!(text.lines().count(), 1 + 2 * POINTS);
        // 1 / 1.75 and 1 / 0.07, and with 0.01 more below.
        assert!(text.contains("\n1,0.0,free,true,0.5682,12.5000,0.5714,14.2857\n"), "{text}");
        assert!(text.contains("\n4,90.0,fixed,false,,,,\n"), "{text}");
        let columns = |row: &str| row.split(',').count();
        assert!(text.lines().all(|row| columns(row) == 8));
    }

    #[test]
    fn the_picture_has_a_bar_for_every_span_and_a_cross_where_there_is_none() {
        let text = svg(&curve());
        // The background and 31 bars; two strokes of the cross and two of the legend's.
        assert_eq!(text.matches("<rect").count(), 1 + 2 * POINTS - 1);
        assert_eq!(text.matches("stroke-width=\"2\"").count(), 4);
        assert!(text.contains("Muscular comfort 1 / (sum of squared activations + 0.01), from"), "{text}");
        let of_muscles = svg(&Curve { metric: MuscularMetric::Muscles, ..curve() });
        assert!(of_muscles.contains("Muscular comfort 1 / (sum of squared muscle activations + 0.02), from"));
        // 12.5 on a scale up to 14 in steps of 2, over 296 px from 360 up.
        assert!(text.contains(&format!("y=\"{:.1}\"", 360.0 - 296.0 * 12.5 / 14.0)), "{text}");
    }
}
