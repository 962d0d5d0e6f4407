//! Elements of SVG files.

use std::fmt::Write as _;

pub(super) use super::plot::{number, ticks};

/// An SVG file of this size, px, with a white background.
pub(super) fn document(body: &str, [width, height]: [f64; 2]) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"12\" fill=\"#222222\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{body}</svg>\n"
    )
}

// Writing to a string does not fail, so the results are ignored.

/// A line from one point to another.
pub(super) fn line(body: &mut String, [x1, y1, x2, y2]: [f64; 4], colour: &str, width_px: f64) {
    let _ = writeln!(
        body,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{colour}\" \
         stroke-width=\"{width_px}\"/>"
    );
}

/// A text; `anchor` is the part of it that is at the point: `start`, `middle` or `end`.
pub(super) fn label(body: &mut String, x: f64, y: f64, anchor: &str, text: &str) {
    let _ = writeln!(body, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>");
}

/// A text from below upward, centred at a point: the title of a vertical axis.
pub(super) fn vertical_label(body: &mut String, x: f64, y: f64, text: &str) {
    let _ = writeln!(
        body,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 {x:.1} {y:.1})\">{text}</text>"
    );
}

/// A filled or a hollow circle.
pub(super) fn circle(body: &mut String, x: f64, y: f64, radius_px: f64, colour: &str, hollow: bool) {
    let fill = if hollow { "none" } else { colour };
    let _ = writeln!(
        body,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius_px}\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"2\"/>"
    );
}
