//! The charts of a sweep as inline SVG: histograms, bars of indices, curve and calibration.

use std::fmt::Write as _;

use super::super::plot::{axis_titles, label, number, ticks};
use crate::sweep::{
    agreement::Agreement,
    summary::{Importance, SweepSummary},
};

/// Size of a chart, px.
const SIZE_PX: [f64; 2] = [460.0, 230.0];
/// The edges of the axes, px: left, right, top, bottom.
const AREA_PX: [f64; 4] = [60.0, 450.0, 26.0, 186.0];
/// Bins of a histogram.
const BINS: usize = 36;
/// Shares of the values that a histogram leaves out at each end: they are counted in the outer bins.
const TAIL: f64 = 0.005;

/// A chart with axes.
struct Chart {
    body: String,
    x: [f64; 2],
    y: [f64; 2],
}

impl Chart {
    fn new(title: &str, x: [f64; 2], y: [f64; 2]) -> Self {
        let mut chart = Self { body: String::new(), x, y };
        label(&mut chart.body, "title", AREA_PX[0], 16.0, "start", title);
        chart
    }

    fn x_px(&self, x: f64) -> f64 {
        AREA_PX[0] + (AREA_PX[1] - AREA_PX[0]) * (x - self.x[0]) / (self.x[1] - self.x[0])
    }

    fn y_px(&self, y: f64) -> f64 {
        AREA_PX[3] - (AREA_PX[3] - AREA_PX[2]) * (y - self.y[0]) / (self.y[1] - self.y[0])
    }

    /// Lines, labels and titles of both axes.
    fn grid(&mut self, titles: [&str; 2]) {
        let [left, right, _, below] = AREA_PX;
        for value in ticks(self.y[0], self.y[1]) {
            let y = self.y_px(value);
            let _ =
                write!(self.body, "<line class=\"grid\" x1=\"{left}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>");
            label(&mut self.body, "tick", left - 5.0, y + 4.0, "end", &number(value));
        }
        for value in ticks(self.x[0], self.x[1]) {
            let x = self.x_px(value);
            label(&mut self.body, "tick", x, below + 13.0, "middle", &number(value));
        }
        axis_titles(&mut self.body, AREA_PX, titles);
    }

    fn rect(&mut self, class: &str, [from, to]: [f64; 2], [low, high]: [f64; 2]) {
        let (x, y) = (self.x_px(from), self.y_px(high));
        let (w, h) = (self.x_px(to) - x, self.y_px(low) - y);
        let _ = write!(
            self.body,
            "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            (w - 1.0).max(0.5),
            h.max(0.0)
        );
    }

    fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let ([x1, y1], [x2, y2]) = ([self.x_px(from[0]), self.y_px(from[1])], [self.x_px(to[0]), self.y_px(to[1])]);
        let _ =
            write!(self.body, "<line class=\"{class}\" x1=\"{x1:.1}\" x2=\"{x2:.1}\" y1=\"{y1:.1}\" y2=\"{y2:.1}\"/>");
    }

    /// The name of a limit on the horizontal axis, beside the top of its line.
    fn name_limit(&mut self, limit: f64, name: &str) {
        let x = self.x_px(limit);
        let (x, anchor) = if x > AREA_PX[1] - 80.0 { (x - 4.0, "end") } else { (x + 4.0, "start") };
        label(&mut self.body, "limit-name", x, AREA_PX[2] + 10.0, anchor, name);
    }

    fn polyline(&mut self, class: &str, points: &[[f64; 2]]) {
        let points: Vec<String> =
            points.iter().map(|&[x, y]| format!("{:.1},{:.1}", self.x_px(x), self.y_px(y))).collect();
        let _ = write!(self.body, "<polyline class=\"{class}\" points=\"{}\"/>", points.join(" "));
    }

    fn legend(&mut self, entries: &[(&str, &str)]) {
        let mut x = AREA_PX[0] + 4.0;
        for (class, name) in entries {
            let _ = write!(
                self.body,
                "<line class=\"key {class}\" x1=\"{x:.1}\" x2=\"{:.1}\" y1=\"224\" y2=\"224\"/>",
                x + 14.0
            );
            label(&mut self.body, "key", x + 18.0, 228.0, "start", name);
            x += 34.0 + 5.6 * name.chars().count() as f64;
        }
    }

    fn finish(self, name: &str) -> String {
        let [width, height] = SIZE_PX;
        format!(
            "<svg class=\"plot sweep\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{name}\">{}</svg>\n",
            self.body
        )
    }
}

/// A histogram of a figure, split into runs that hold and runs that fail. `limit` is a line.
pub fn histogram(title: &str, axis: &str, values: &[(f64, bool)], limit: Option<(f64, &str)>) -> String {
    let mut sorted: Vec<f64> = values.iter().map(|(value, _)| *value).filter(|value| value.is_finite()).collect();
    if sorted.is_empty() {
        return String::new();
    }
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
    let (mut low, mut high) = (at(TAIL), at(1.0 - TAIL));
    if let Some((limit, _)) = limit {
        (low, high) = (low.min(limit), high.max(limit));
    }
    let margin = 0.02 * (high - low).max(1e-9 * high.abs()).max(1e-12);
    let [low, high] = [low - margin, high + margin];
    let width = (high - low) / BINS as f64;
    let mut counts = [[0_usize; 2]; BINS];
    for (value, held) in values {
        let bin = ((value.min(high) - low) / width).clamp(0.0, BINS as f64 - 1.0) as usize;
        counts[bin][usize::from(!held)] += 1;
    }
    let most = counts.iter().map(|[held, failed]| held + failed).max().unwrap_or(1).max(1) as f64;
    let mut chart = Chart::new(title, [low, high], [0.0, 1.05 * most]);
    chart.grid([axis, "runs"]);
    for (bin, [held, failed]) in counts.into_iter().enumerate() {
        let span = [bin, bin + 1].map(|edge| low + width * edge as f64);
        let (held, all) = (held as f64, (held + failed) as f64);
        chart.rect("held", span, [0.0, held]);
        chart.rect("other", span, [held, all]);
    }
    let mut entries = vec![("held", "runs that hold"), ("other", "other runs")];
    if let Some((limit, name)) = limit {
        chart.line("limit", [limit, 0.0], [limit, 1.05 * most]);
        chart.name_limit(limit, name);
        entries.push(("limit", name));
    }
    chart.legend(&entries);
    chart.finish(title)
}

/// Bars of the first-order indices with their standard errors: of the load factor and of holding.
pub fn importance(summary: &SweepSummary) -> String {
    const ROW_PX: f64 = 26.0;
    const LEFT_PX: f64 = 170.0;
    let shown: Vec<&Importance> = summary.importance.iter().collect();
    let height = 44.0 + ROW_PX * shown.len() as f64;
    let width_px = SIZE_PX[0] - LEFT_PX - 40.0;
    let mut body = String::new();
    label(&mut body, "title", 4.0, 16.0, "start", "Share of the variance that each explains by itself");
    for (row, of) in shown.iter().enumerate() {
        let y = 30.0 + ROW_PX * row as f64;
        label(&mut body, "tick", LEFT_PX - 6.0, y + 13.0, "end", &of.variable);
        for (class, index, offset) in [("held", of.load_factor, 0.0), ("other", of.holds, 10.0)] {
            let x = |value: f64| LEFT_PX + width_px * value.clamp(0.0, 1.0);
            let (end, top) = (x(index.value), y + offset);
            let _ = write!(
                body,
                "<rect class=\"{class}\" x=\"{LEFT_PX}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"9\"/>",
                (end - LEFT_PX).max(0.5)
            );
            let [from, to] = [index.value - index.error, index.value + index.error].map(x);
            let middle = top + 4.5;
            let _ = write!(
                body,
                "<line class=\"error\" x1=\"{from:.1}\" x2=\"{to:.1}\" y1=\"{middle:.1}\" y2=\"{middle:.1}\"/>"
            );
        }
        let percent = format!("{:.0} %", 100.0 * of.load_factor.value.max(0.0));
        label(&mut body, "tick", SIZE_PX[0] - 4.0, y + 9.0, "end", &percent);
    }
    let y = height - 8.0;
    for (class, name, x) in
        [("held", "of the predicted load factor", LEFT_PX), ("other", "of holding or not", LEFT_PX + 180.0)]
    {
        let _ = write!(body, "<line class=\"key {class}\" x1=\"{x}\" x2=\"{}\" y1=\"{y}\" y2=\"{y}\"/>", x + 14.0);
        label(&mut body, "key", x + 18.0, y + 4.0, "start", name);
    }
    format!(
        "<svg class=\"plot sweep indices\" viewBox=\"0 0 {} {height}\" role=\"img\" aria-label=\"What matters\">{body}</svg>\n",
        SIZE_PX[0]
    )
}

/// The curve of the prediction, and how often runs with a predicted load factor hold.
pub fn agreement(agreement: &Agreement) -> String {
    let mut text = String::new();
    if let Some(area) = agreement.area {
        let title = format!("Prediction against simulation: area {area:.3}");
        let mut chart = Chart::new(&title, [0.0, 1.0], [0.0, 1.0]);
        chart.grid(["share of failing runs above a threshold of the load factor, 1", "share of holding runs, 1"]);
        chart.line("rest", [0.0, 0.0], [1.0, 1.0]);
        chart.polyline("hand-0", &agreement.curve);
        text.push_str(&chart.finish(&title));
    }
    let bins = &agreement.calibration;
    if let (Some(first), Some(last)) = (bins.first(), bins.last()) {
        let margin = 0.05 * (last.load_factor - first.load_factor).max(0.01);
        let title = "Share of runs that hold, by predicted load factor";
        let range = [first.load_factor.min(1.0) - margin, last.load_factor.max(1.0) + margin];
        let mut chart = Chart::new(title, range, [0.0, 1.0]);
        chart.grid(["predicted load factor, 1, mean of a tenth of the simulated runs", "share that hold, 1"]);
        chart.line("limit", [1.0, 0.0], [1.0, 1.0]);
        chart.name_limit(1.0, "the load");
        for bin in bins {
            chart.line("error", [bin.load_factor, bin.low], [bin.load_factor, bin.high]);
        }
        let points: Vec<[f64; 2]> = bins.iter().map(|bin| [bin.load_factor, bin.held]).collect();
        chart.polyline("hand-0", &points);
        text.push_str(&chart.finish(title));
    }
    text
}
