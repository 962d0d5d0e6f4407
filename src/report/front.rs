//! A Pareto front as CSV, plot and console table.

use super::{
    columns::aligned,
    csv_text::csv_text,
    picture::{circle, document, label, line, number, ticks, vertical_label},
};
use crate::{human::muscular::formula_in_words, model::scenario::MuscularMetric};

/// A plan on the front, or the plan for the scenario's own weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Weight of the peripersonal comfort, from 0 to 1; both comforts are divided by their optima.
    pub share: f64,
    /// Regularised muscular comfort.
    pub muscular: f64,
    /// Peripersonal comfort, m.
    pub peripersonal_m: f64,
    /// True for the plan for the scenario's own weights.
    pub own: bool,
}

impl Row {
    /// Muscular and peripersonal comfort over their optima, from 0 to 1.
    fn kept(&self, optima: [f64; 2]) -> [f64; 2] {
        [self.muscular / optima[0], self.peripersonal_m / optima[1]]
    }

    fn name(&self, index: usize) -> String {
        if self.own { "own-weights".to_owned() } else { format!("front-{}", index + 1) }
    }
}

/// The front as CSV: one row per plan, named like the plan's file.
pub fn csv(rows: &[Row], optima: [f64; 2]) -> String {
    let header =
        ["plan", "share_peripersonal", "muscular_regularised", "peripersonal_m", "muscular_kept", "peripersonal_kept"];
    let lines = rows.iter().enumerate().map(|(index, row)| {
        let kept = row.kept(optima).map(|kept| format!("{kept:.4}"));
        let figures = [
            row.name(index),
            format!("{:.4}", row.share),
            format!("{:.6}", row.muscular),
            format!("{:.6}", row.peripersonal_m),
        ];
        figures.into_iter().chain(kept).collect()
    });
    csv_text(&header, lines)
}

/// The front for the console, with the comforts over their optima in per cent.
pub fn table(rows: &[Row], optima: [f64; 2]) -> String {
    let header = ["plan", "share", "muscular", "peripersonal m", "muscular kept %", "peripersonal kept %"];
    let mut lines = vec![header.map(str::to_owned).to_vec()];
    for (index, row) in rows.iter().enumerate() {
        let [muscular, peripersonal] = row.kept(optima).map(|kept| format!("{:.1}", 100.0 * kept));
        let figures =
            [format!("{:.2}", row.share), format!("{:.2}", row.muscular), format!("{:.3}", row.peripersonal_m)];
        lines.push([vec![row.name(index)], figures.to_vec(), vec![muscular, peripersonal]].concat());
    }
    aligned(&lines, 1)
}

/// The edges of the plot's axes, px: left, right, top, bottom.
const AREA_PX: [f64; 4] = [64.0, 620.0, 56.0, 380.0];
const FRONT: &str = "#0072b2";
const OWN: &str = "#d55e00";

/// The front as SVG: muscular comfort on the horizontal axis, peripersonal comfort on the vertical one.
pub fn svg(rows: &[Row], optima: [f64; 2], metric: MuscularMetric) -> String {
    let [left, right, top, bottom] = AREA_PX;
    let range = |value: fn(&Row) -> f64| {
        let low = rows.iter().map(value).fold(f64::INFINITY, f64::min);
        let high = rows.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
        // A margin around the points; a front of one point also needs an axis.
        let margin = (0.06 * (high - low)).max(1e-3 * high.abs()).max(1e-9);
        [low - margin, high + margin]
    };
    let (xs, ys) = (range(|row| row.muscular), range(|row| row.peripersonal_m));
    let x_px = |muscular: f64| left + (right - left) * (muscular - xs[0]) / (xs[1] - xs[0]);
    let y_px = |metres: f64| bottom - (bottom - top) * (metres - ys[0]) / (ys[1] - ys[0]);
    let mut body = String::new();
    for tick in ticks(xs[0], xs[1]) {
        line(&mut body, [x_px(tick), top, x_px(tick), bottom], "#dddddd", 1.0);
        label(&mut body, x_px(tick), bottom + 18.0, "middle", &number(tick));
    }
    for tick in ticks(ys[0], ys[1]) {
        line(&mut body, [left, y_px(tick), right, y_px(tick)], "#dddddd", 1.0);
        label(&mut body, left - 6.0, y_px(tick) + 4.0, "end", &number(tick));
    }
    let front: Vec<&Row> = rows.iter().filter(|row| !row.own).collect();
    for pair in front.windows(2) {
        // A step, not a slope: a mixture of two plans is not a plan.
        let [a, b] = [pair[0], pair[1]].map(|row| [x_px(row.muscular), y_px(row.peripersonal_m)]);
        line(&mut body, [a[0], a[1], b[0], a[1]], FRONT, 1.5);
        line(&mut body, [b[0], a[1], b[0], b[1]], FRONT, 1.5);
    }
    for row in rows {
        let (colour, radius_px) = if row.own { (OWN, 6.0) } else { (FRONT, 4.0) };
        circle(&mut body, x_px(row.muscular), y_px(row.peripersonal_m), radius_px, colour, row.own);
    }
    let points: Vec<[f64; 2]> = front.iter().map(|row| [x_px(row.muscular), y_px(row.peripersonal_m)]).collect();
    numbers(&mut body, &points);
    legend(&mut body, rows, optima, metric);
    document(&body, [640.0, 430.0])
}

/// The number N of each plan's file, `front-N.json`, beside its point. Numbers of points that would lie on one another are moved
/// up, one by one.
fn numbers(body: &mut String, points: &[[f64; 2]]) {
    const WIDTH_PX: f64 = 16.0;
    const HEIGHT_PX: f64 = 12.0;
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for (index, [x, y]) in points.iter().enumerate() {
        let mut at = [x + 6.0, y - 5.0];
        let is_near = |at: &[f64; 2], other: &[f64; 2]| {
            (at[0] - other[0]).abs() < WIDTH_PX && (at[1] - other[1]).abs() < HEIGHT_PX
        };
        while taken.iter().any(|other| is_near(&at, other)) {
            at[1] -= HEIGHT_PX;
        }
        taken.push(at);
        label(body, at[0], at[1], "start", &(index + 1).to_string());
    }
}

fn legend(body: &mut String, rows: &[Row], optima: [f64; 2], metric: MuscularMetric) {
    let [left, right, top, bottom] = AREA_PX;
    let title = format!("Peripersonal comfort, m, over muscular comfort {}", formula_in_words(metric));
    label(body, left, 20.0, "start", &title);
    label(body, f64::midpoint(left, right), bottom + 40.0, "middle", "muscular comfort, 1");
    vertical_label(body, left - 50.0, f64::midpoint(top, bottom), "peripersonal comfort, m");
    circle(body, left + 8.0, top - 17.0, 4.0, FRONT, false);
    label(body, left + 18.0, top - 13.0, "start", "front-N.json");
    let Some(own) = rows.iter().find(|row| row.own) else { return };
    let [muscular, peripersonal] = own.kept(optima).map(|kept| 100.0 * kept);
    circle(body, left + 128.0, top - 17.0, 6.0, OWN, true);
    let text = format!("the scenario's weights: {muscular:.0} % muscular, {peripersonal:.0} % peripersonal kept");
    label(body, left + 142.0, top - 13.0, "start", &text);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Row> {
        let row = |share, muscular, peripersonal_m, own| Row { share, muscular, peripersonal_m, own };
        vec![
            row(0.0, 80.0, 0.5, false),
            row(0.5, 60.0, 1.0, false),
            row(1.0, 20.0, 1.25, false),
            row(0.4, 60.0, 1.0, true),
        ]
    }

    #[test]
    fn the_table_says_what_is_kept_of_each_optimum() {
        let text = csv(&rows(), [80.0, 1.25]);
        assert!(text.contains("\nfront-2,0.5000,60.000000,1.000000,0.7500,0.8000\n"), "{text}");
        assert!(text.ends_with("\nown-weights,0.4000,60.000000,1.000000,0.7500,0.8000\n"), "{text}");
    }

    #[test]
    fn numbers_of_points_at_one_place_do_not_lie_on_one_another() {
        let mut body = String::new();
        numbers(&mut body, &[[10.0, 100.0], [11.0, 101.0], [10.0, 99.0]]);
        for place in ["x=\"16.0\" y=\"95.0\"", "x=\"17.0\" y=\"72.0\"", "x=\"16.0\" y=\"58.0\""] {
            assert!(body.contains(place), "{place}: {body}");
        }
    }

    #[test]
    fn the_picture_has_every_plan_inside_its_axes() {
        let text = svg(&rows(), [80.0, 1.25], MuscularMetric::Intrinsic);
        assert!(text.contains("over muscular comfort 1 / (sum of squared activations + 0.0175)<"), "{text}");
        // Three plans of the front and the scenario's own, and one of each in the legend.
        assert_eq!(text.matches("<circle").count(), 6);
        // Two steps between three plans.
        assert_eq!(text.matches("stroke-width=\"1.5\"").count(), 4);
        // Each plan of the front has the number of its file; the scenario's own has its name in the legend.
        for (number, row) in (1..).zip(rows().iter().filter(|row| !row.own)) {
            assert!(text.contains(&format!("text-anchor=\"start\">{number}</text>")), "{row:?}: {text}");
        }
        assert!(!text.contains("text-anchor=\"start\">4</text>"), "{text}");
        assert!(text.contains(">peripersonal comfort, m</text>"), "{text}");
        // The plan with the best muscular comfort is 6 parts of 112 from the right end of the axis.
        let x = 620.0 - (620.0 - 64.0) * 0.06 / 1.12;
        assert!(text.contains(&format!("cx=\"{x:.1}\"")), "{text}");
    }
}
