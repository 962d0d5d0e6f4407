//! The comparison as a section of a task's report.

use std::fmt::Write as _;

use maud::{Markup, PreEscaped, html};

use super::{
    super::plot::{axis_titles, escape, label, number, ticks},
    figures::{Comparison, PieceFigures, Strategy, StrategyKind},
    rows, sentence,
};

/// Size of a plot, px.
const SIZE_PX: [f64; 2] = [920.0, 252.0];

/// The edges of the plot's axes, px: left, right, top, bottom.
const AREA_PX: [f64; 4] = [60.0, 910.0, 26.0, 196.0];

/// How far the axis goes beyond the greatest figure.
const HEADROOM: f64 = 1.08;

/// The line of the staged plan is the strongest.
pub const STYLE: &str = "svg.comparison path{fill:none;stroke-width:1.6}svg.comparison path.hand-0{stroke-width:3}";

/// What was found, the strategies in a table, and plots along the path.
pub fn section(comparison: &Comparison) -> Markup {
    let rows = rows(comparison);
    html! {
        h2 { "Comparison" }
        p { (sentence(comparison)) }
        div.wide {
            table {
                @for (number, row) in rows.iter().enumerate() {
                    tr {
                        @for (column, cell) in row.iter().enumerate() {
                            @match (number, column) {
                                (0, 0) => th { (cell) },
                                (0, _) => th.n { (cell) },
                                (_, 0) => td { (cell) },
                                _ => td.n { (cell) },
                            }
                        }
                    }
                }
            }
        }
        (PreEscaped(plot(["muscular effort along the path", "effort, 1"], comparison, |figures| figures.effort)))
        (PreEscaped(plot(["objective along the path", "objective, 1"], comparison, |figures| figures.objective)))
    }
}

/// The CSS class of a strategy's line.
fn class(kind: StrategyKind) -> &'static str {
    match kind {
        StrategyKind::Staged => "hand-0",
        StrategyKind::OneHold => "hand-1",
        StrategyKind::Separate => "joint-2",
        StrategyKind::Random => "load",
    }
}

/// A figure of every strategy over the length of the path, or over the holes by number.
fn plot([title, axis]: [&str; 2], comparison: &Comparison, figure: fn(&PieceFigures) -> f64) -> String {
    let [left, right, above, below] = AREA_PX;
    let figures = comparison.strategies.iter().flat_map(|strategy| strategy.pieces.iter().flatten());
    let top = HEADROOM * figures.map(figure).fold(f64::MIN_POSITIVE, f64::max);
    let mut ends = vec![0.0];
    ends.extend((0..comparison.pieces.len()).scan(0.0, |end, piece| {
        *end += comparison.pieces[piece].weight();
        Some(*end)
    }));
    let length = ends[ends.len() - 1].max(f64::MIN_POSITIVE);
    let x_px = |along: f64| left + (right - left) * along / length;
    let y_px = |value: f64| below - (below - above) * value / top;
    let mut body = String::new();
    label(&mut body, "title", left, 16.0, "start", title);
    // Writing to a string does not fail, so the results are ignored.
    for value in ticks(0.0, top) {
        let y = y_px(value);
        let _ = write!(body, "<line class=\"grid\" x1=\"{left}\" x2=\"{right}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>");
        label(&mut body, "tick", left - 5.0, y + 4.0, "end", &number(value));
    }
    for along in ticks(0.0, length) {
        label(&mut body, "tick", x_px(along), below + 13.0, "middle", &number(along));
    }
    let along = if comparison.has_length() { "along the path, m" } else { "holes" };
    axis_titles(&mut body, AREA_PX, [along, axis]);
    let mut legend_px = left + 4.0;
    for strategy in &comparison.strategies {
        let (class, name) = (class(strategy.kind), strategy.kind.title());
        let y = below + 42.0;
        let _ = write!(body, "<path class=\"{class}\" d=\"{}\"/>", steps(strategy, figure, &ends, &x_px, &y_px));
        let _ = write!(body, "<path class=\"{class}\" d=\"M{legend_px:.1},{y}H{:.1}\"/>", legend_px + 14.0);
        label(&mut body, "key", legend_px + 18.0, y + 4.0, "start", name);
        // The width of the text in a common sans-serif font of 11 px, plus a gap.
        legend_px += 34.0 + 5.6 * name.chars().count() as f64;
    }
    let [width, height] = SIZE_PX;
    let name = escape(title);
    format!(
        "<svg class=\"plot comparison\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{name}\">{body}</svg>\n"
    )
}

/// A level line over every piece that is served, joined where the piece before is served too.
fn steps(
    strategy: &Strategy,
    figure: fn(&PieceFigures) -> f64,
    ends: &[f64],
    x_px: &impl Fn(f64) -> f64,
    y_px: &impl Fn(f64) -> f64,
) -> String {
    let mut path = String::new();
    let mut is_open = false;
    for (figures, ends) in strategy.pieces.iter().zip(ends.windows(2)) {
        if let Some(figures) = figures {
            let (from, to, y) = (x_px(ends[0]), x_px(ends[1]), y_px(figure(figures)));
            let _ = if is_open { write!(path, "V{y:.1}") } else { write!(path, "M{from:.1},{y:.1}") };
            let _ = write!(path, "H{to:.1}");
        }
        is_open = figures.is_some();
    }
    path
}
