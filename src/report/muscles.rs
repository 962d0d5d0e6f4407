//! The work of the person's muscles, in lines of text and as a bar chart.

use std::fmt::Write as _;

use super::{
    columns::aligned,
    plot::{escape, label},
};
use crate::model::{
    activation_colour::activation_rgb,
    muscle_work::{BusyMuscle, ENDLESS_ACTIVATION, MuscleWork},
};

/// Two lines: effort and endurance, the busiest muscles.
#[must_use]
pub fn table(work: &MuscleWork) -> String {
    aligned(&rows(work), 2)
}

/// The cells of these lines.
pub(super) fn rows(work: &MuscleWork) -> [Vec<String>; 2] {
    [["muscles".to_owned(), work.to_string()], ["busiest".to_owned(), work.busiest_in_words()]].map(Vec::from)
}

/// Effort and endurance as a sentence of a page.
pub(super) fn sentence(work: &MuscleWork) -> String {
    let source = match (work.missing_nm, work.endurance_s) {
        (Some(_), _) => "the muscles of the model are too weak for this posture under its load",
        (None, Some(_)) => "by the busiest muscle's activation, Rohmert 1960, an estimate",
        (None, None) => "no muscle is beyond the line in the chart, Rohmert 1960, an estimate",
    };
    let effort = format!("Muscles of the working arm: effort {:.3} (sum of squared activations)", work.effort);
    format!("{effort}; {} ({source}).", work.endurance_in_words())
}

/// Width of the chart, px.
const WIDTH_PX: f64 = 730.0;

/// Left and right edge of the bars, px. Names are to the left, regions to the right.
const BARS_PX: [f64; 2] = [290.0, 530.0];

/// Distance of the regions from the bars, px: a percentage fits between a full bar and its region.
const REGION_GAP_PX: f64 = 50.0;

/// Bottom edge of the chart's title and of the line below it, px.
const HEAD_PX: f64 = 46.0;

/// Height of a row and of its bar, px.
const ROW_PX: f64 = 24.0;
const BAR_PX: f64 = 14.0;

/// The activations of the busiest muscles as SVG: a bar each with its name, percentage and region, and the line up to which an
/// activation can be held for hours. Bars have the colours of the recording.
pub(super) fn svg(work: &MuscleWork) -> String {
    let [left, right] = BARS_PX;
    let top = work.chart_top();
    let x_px = |activation: f64| left + (right - left) * activation / top;
    let height_px = HEAD_PX + ROW_PX * work.busiest.len() as f64 + 8.0;
    let mut body = String::new();
    label(&mut body, "title", 0.0, 14.0, "start", "activation of the busiest muscles of the working arm");
    let endless = format!("{:.0} %: can be held for hours up to here", 100.0 * ENDLESS_ACTIVATION);
    label(&mut body, "tick", x_px(ENDLESS_ACTIVATION), HEAD_PX - 10.0, "middle", &endless);
    for (row, muscle) in work.busiest.iter().enumerate() {
        let middle_px = HEAD_PX + ROW_PX * (row as f64 + 0.5);
        let BusyMuscle { name, region, activation } = muscle;
        let end_px = x_px(*activation);
        label(&mut body, "name", left - 8.0, middle_px + 4.0, "end", name);
        // Writing to a string does not fail, so the results are ignored.
        let [r, g, b] = activation_rgb(*activation);
        let (y, width) = (middle_px - BAR_PX / 2.0, end_px - left);
        let _ = write!(
            body,
            "<rect class=\"track\" x=\"{left}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{BAR_PX}\"/>\
             <rect class=\"muscle\" fill=\"rgb({r},{g},{b})\" x=\"{left}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{BAR_PX}\"/>",
            right - left
        );
        label(&mut body, "key", end_px + 5.0, middle_px + 4.0, "start", &format!("{:.1} %", 100.0 * activation));
        label(&mut body, "tick", right + REGION_GAP_PX, middle_px + 4.0, "start", region);
    }
    let (x, above, below) = (x_px(ENDLESS_ACTIVATION), HEAD_PX - 4.0, height_px - 6.0);
    let _ = write!(body, "<line class=\"limit\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{above}\" y2=\"{below:.1}\"/>");
    let words = escape(&work.busiest_in_words());
    format!(
        "<svg class=\"muscles\" viewBox=\"0 0 {WIDTH_PX} {height_px}\" role=\"img\">\
         <title>Activation of the busiest muscles</title><desc>{words}</desc>{body}</svg>\n"
    )
}
