//! Plots over time as inline SVG. The style sheet of the page sets the colours, for light and dark mode.

use std::fmt::Write as _;

use super::xml::legal;
use crate::model::measures::axis_top;

/// Size of a plot, px.
const SIZE_PX: [f64; 2] = [460.0, 220.0];

/// The edges of the plot's axes, px: left, right, top, bottom.
const AREA_PX: [f64; 4] = [60.0, 450.0, 26.0, 172.0];

/// A series is reduced to this number of columns. Each keeps its smallest and its largest value, so no peak is lost.
const COLUMNS: usize = 203;

/// One line of a plot.
pub(super) struct Line<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// The CSS class that sets its colour.
    pub class: &'static str,
    /// One value for each time.
    pub values: &'a [f64],
}

/// A plot of several lines over the same times, s.
pub(super) struct Plot<'a> {
    /// What is plotted.
    pub title: &'a str,
    /// The quantity and its unit, along the vertical axis.
    pub axis: &'a str,
    /// The unit of the limit; empty for a ratio.
    pub unit: &'a str,
    /// The times, s.
    pub time_s: &'a [f64],
    /// The number of times that are judged, from the first; the rest is shaded.
    pub judged: usize,
    /// The lines.
    pub lines: Vec<Line<'a>>,
    /// The limit, drawn as a horizontal line.
    pub limit: Option<f64>,
    /// The time at which the limit was crossed, s, if it was the first one crossed.
    pub failed_s: Option<f64>,
}

impl Plot<'_> {
    /// The plot as SVG.
    #[must_use]
    pub fn svg(&self) -> String {
        let [width, height] = SIZE_PX;
        let mut body = String::new();
        let peak = self.lines.iter().flat_map(|line| line.values).copied().fold(0.0, f64::max);
        let top = axis_top(peak, self.limit);
        let (Some(&start_s), Some(&end_s)) = (self.time_s.first(), self.time_s.last()) else { return body };
        let scale = Scale { start_s, end_s: end_s.max(start_s + f64::EPSILON), top };
        scale.grid(&mut body);
        label(&mut body, "title", AREA_PX[0], 16.0, "start", self.title);
        // Writing to a string does not fail, so the results are ignored.
        let [left, right, above, below] = AREA_PX;
        let (w, h) = (right - left, below - above);
        let _ = write!(
            body,
            "<svg x=\"{left}\" y=\"{above}\" width=\"{w}\" height=\"{h}\" viewBox=\"{left} {above} {w} {h}\">"
        );
        if let Some(&until_s) = self.time_s.get(self.judged.wrapping_sub(1)).filter(|_| self.has_rest()) {
            let (x, w) = (scale.x_px(until_s), right - scale.x_px(until_s));
            let _ = write!(body, "<rect class=\"rest\" x=\"{x:.1}\" y=\"{above}\" width=\"{w:.1}\" height=\"{h}\"/>");
        }
        for line in &self.lines {
            let _ = write!(body, "<polyline class=\"{}\" points=\"{}\"/>", line.class, scale.points(self.time_s, line));
        }
        if let Some(limit) = self.limit {
            let y = scale.y_px(limit);
            let _ = write!(body, "<line class=\"limit\" x1=\"{left}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>");
        }
        if let Some(failed_s) = self.failed_s {
            let x = scale.x_px(failed_s);
            let _ = write!(body, "<line class=\"failed\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{above}\" y2=\"{below}\"/>");
        }
        body.push_str("</svg>");
        self.limit_label(&mut body, &scale);
        axis_titles(&mut body, AREA_PX, ["time, s", self.axis]);
        self.legend(&mut body);
        let name = escape(self.title);
        format!(
            "<svg class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{name}\">{body}</svg>\n"
        )
    }

    /// True if there is more than what is judged.
    fn has_rest(&self) -> bool {
        self.judged < self.time_s.len()
    }

    /// The value of the limit at the right end of its line: below it near the top of the plot, otherwise above it.
    fn limit_label(&self, body: &mut String, scale: &Scale) {
        let Some(limit) = self.limit else { return };
        let [_, right, above, _] = AREA_PX;
        let y = scale.y_px(limit);
        let y = if y < above + 16.0 { y + 12.0 } else { y - 4.0 };
        let gap = if self.unit.is_empty() { "" } else { " " };
        let text = format!("limit {}{gap}{}", number(limit), self.unit);
        label(body, "limit-name", right - 4.0, y, "end", &text);
    }

    fn legend(&self, body: &mut String) {
        let mut x = AREA_PX[0] + 4.0;
        let limit = self.limit.map(|_| ("limit", "limit"));
        let failed = self.failed_s.map(|_| ("first crossing", "failed"));
        let lines = self.lines.iter().map(|line| (line.name, line.class));
        let rest = self.has_rest().then_some(("not judged", "rest"));
        for (name, class) in lines.chain(limit).chain(failed).chain(rest) {
            let y = 210.0;
            let _ =
                write!(body, "<line class=\"{class}\" x1=\"{x:.1}\" x2=\"{:.1}\" y1=\"{y}\" y2=\"{y}\"/>", x + 14.0);
            label(body, "key", x + 18.0, y + 4.0, "start", name);
            // The width of the text in a common sans-serif font of 11 px, plus a gap.
            x += 34.0 + 5.6 * name.chars().count() as f64;
        }
    }
}

/// Converts times and values to pixels.
struct Scale {
    start_s: f64,
    end_s: f64,
    top: f64,
}

impl Scale {
    fn x_px(&self, time_s: f64) -> f64 {
        let [left, right, ..] = AREA_PX;
        left + (right - left) * (time_s - self.start_s) / (self.end_s - self.start_s)
    }

    fn y_px(&self, value: f64) -> f64 {
        let [.., above, below] = AREA_PX;
        // Values far above are clipped by the viewport; the bound keeps the coordinates short.
        below - (below - above) * (value / self.top).clamp(-1.0, 10.0)
    }

    fn grid(&self, body: &mut String) {
        let [left, right, _, below] = AREA_PX;
        for value in ticks(0.0, self.top) {
            let y = self.y_px(value);
            let _ = write!(body, "<line class=\"grid\" x1=\"{left}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>");
            label(body, "tick", left - 5.0, y + 4.0, "end", &number(value));
        }
        for time_s in ticks(self.start_s, self.end_s) {
            label(body, "tick", self.x_px(time_s), below + 13.0, "middle", &number(time_s));
        }
    }

    /// The coordinates of a line, reduced to the smallest and the largest value of each column.
    fn points(&self, time_s: &[f64], line: &Line) -> String {
        let samples: Vec<(f64, f64)> =
            time_s.iter().copied().zip(line.values.iter().copied()).filter(|(_, value)| value.is_finite()).collect();
        let mut text = String::new();
        for column in samples.chunks(samples.len().div_ceil(COLUMNS).max(1)) {
            let extreme = |wanted: std::cmp::Ordering| {
                (1..column.len())
                    .fold(0, |best, i| if column[i].1.total_cmp(&column[best].1) == wanted { i } else { best })
            };
            let (low, high) = (extreme(std::cmp::Ordering::Less), extreme(std::cmp::Ordering::Greater));
            let pair = [low.min(high), low.max(high)];
            for &index in &pair[..if low == high { 1 } else { 2 }] {
                let (time_s, value) = column[index];
                let gap = if text.is_empty() { "" } else { " " };
                let _ = write!(text, "{gap}{:.1},{:.1}", self.x_px(time_s), self.y_px(value));
            }
        }
        text
    }
}

/// Three to eight round values between `from` and `to`.
pub(super) fn ticks(from: f64, to: f64) -> Vec<f64> {
    let rough = (to - from) / 6.0;
    let decade = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * decade).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(rough);
    // A tick at the end counts in spite of rounding errors.
    let first = (from / step - 1e-9).ceil();
    (0..=8).map(|k| (first + f64::from(k)) * step).take_while(|value| *value <= to + 1e-9 * step).collect()
}

/// The label of a tick, without trailing zeros.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text.is_empty() || text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A text; `anchor` is the part of it that is at the point: `start`, `middle` or `end`.
pub(super) fn label(body: &mut String, class: &str, x: f64, y: f64, anchor: &str, text: &str) {
    let text = escape(text);
    let _ = write!(body, "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>");
}

/// The titles of the horizontal and of the vertical axis, outside of the labels of their ticks. `area_px` has the edges of the axes:
/// left, right, top, bottom.
pub(super) fn axis_titles(body: &mut String, area_px: [f64; 4], [horizontal, vertical]: [&str; 2]) {
    let [left, right, above, below] = area_px;
    label(body, "axis", f64::midpoint(left, right), below + 26.0, "middle", horizontal);
    let (x, y, text) = (left - 44.0, f64::midpoint(above, below), escape(vertical));
    let _ = write!(
        body,
        "<text class=\"axis\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" \
         transform=\"rotate(-90 {x:.1} {y:.1})\">{text}</text>"
    );
}

/// Text with the special characters of XML escaped.
pub(super) fn escape(text: &str) -> String {
    legal(text.to_owned()).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_few_and_inside() {
        assert_eq!(ticks(0.0, 1.05), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(0.5, 3.0), [0.5, 1.0, 1.5, 2.0, 2.5, 3.0]);
        for top in [0.003, 0.1, 2.1, 5.25, 8.4, 99.0, 1234.0] {
            let ticks = ticks(0.0, top);
            assert!((3..=8).contains(&ticks.len()) && ticks.iter().all(|tick| *tick <= top), "{top}: {ticks:?}");
        }
        assert_eq!([0.0, 0.6000000000000001, -0.0, 20.0].map(number), ["0", "0.6", "0", "20"]);
    }

    #[test]
    fn thinning_keeps_the_peak_and_the_ends_of_the_axis() {
        let time_s: Vec<f64> = (0..=10_000).map(|i| f64::from(i) * 1e-3).collect();
        let mut values = vec![0.0; time_s.len()];
        values[7_531] = 2.0;
        let line = Line { name: "left hand", class: "hand-0", values: &values };
        let svg = Plot {
            title: "slip of the hands",
            axis: "slip, mm",
            unit: "mm",
            time_s: &time_s,
            judged: time_s.len(),
            lines: vec![line],
            limit: Some(1.0),
            failed_s: None,
        }
        .svg();
        // The peak is 2 of an axis up to 2.2: y = 172 - 146 * 2 / 2.2.
        assert!(svg.contains(&format!(",{:.1}", 172.0 - 146.0 * 2.0 / 2.2)), "{svg}");
        assert!(svg.matches(',').count() < 2 * COLUMNS + 20);
        // The limit's line lies inside the plot, with its value above it.
        let limit_px = 172.0 - 146.0 / 2.2;
        assert!(svg.contains(&format!("y1=\"{limit_px:.1}\"")));
        assert!(svg.contains(&format!("y=\"{:.1}\" text-anchor=\"end\">limit 1 mm<", limit_px - 4.0)), "{svg}");
        assert!(svg.contains(">time, s<") && svg.contains(">slip, mm<"), "{svg}");
    }
}
