//! Colours with one meaning each, from the palette of Okabe and Ito, which colour-blind readers can tell apart; those of muscles
//! are a scale.

use rerun::Color;

use crate::model::{activation_colour::activation_rgb, tool_part::ToolMaterial};

/// Background of the scene.
pub(super) fn background() -> Color {
    Color::from_rgb(28, 30, 34)
}

/// The lines of limits, and nothing else.
pub(super) fn limit_line() -> Color {
    Color::from_rgb(255, 80, 120)
}

/// Bodies that crossed a limit, and the mark of the first crossing.
pub(super) fn limit() -> Color {
    Color::from_rgb(213, 94, 0)
}

/// The board and its deflection.
pub(super) fn board() -> Color {
    Color::from_rgb(240, 228, 120)
}

/// The tool and the load.
pub(super) fn load() -> Color {
    Color::from_rgb(204, 121, 167)
}

/// The person: translucent, so that the board stays visible.
pub(super) fn person() -> Color {
    Color::from_unmultiplied_rgba(0, 158, 115, 110)
}

/// The person's eyes.
pub(super) fn eyes() -> Color {
    Color::from_rgb(12, 12, 14)
}

/// Where the person looks and works: the line of sight and the sector in front of them.
pub(super) fn sight() -> Color {
    Color::from_rgb(150, 240, 210)
}

/// Shades of [`load`] that tell the parts of the tool apart.
pub(super) fn tool(material: ToolMaterial) -> Color {
    match material {
        ToolMaterial::Steel => Color::from_rgb(240, 222, 234),
        ToolMaterial::Housing => load(),
        ToolMaterial::Grip => Color::from_rgb(122, 68, 100),
    }
}

/// The robot except its hands.
pub(super) fn robot() -> Color {
    Color::from_rgb(150, 150, 150)
}

/// The hand and the joints of the arm with this index.
pub(super) fn hand(arm: usize) -> Color {
    const HANDS: [[u8; 3]; 2] = [[86, 180, 233], [230, 159, 0]];
    let [r, g, b] = HANDS[arm % HANDS.len()];
    Color::from_rgb(r, g, b)
}

/// A shade of an arm's colour: from 0 for the colour itself to 1 for black.
pub(super) fn shade(arm: usize, darker: f32) -> Color {
    let [r, g, b, _] = hand(arm).to_array();
    let dim = |channel: u8| (f32::from(channel) * (1.0 - darker)) as u8;
    Color::from_rgb(dim(r), dim(g), dim(b))
}

/// Series after the last judged sample.
pub(super) fn not_judged() -> Color {
    Color::from_rgb(110, 110, 110)
}

/// The points of the peripersonal metric.
pub(super) fn points() -> Color {
    Color::from_rgb(255, 255, 255)
}

/// Lines and texts of the chart of muscles.
pub(super) fn chart() -> Color {
    Color::from_rgb(230, 230, 230)
}

/// A muscle with this activation.
pub(super) fn activation(activation: f64) -> Color {
    let [r, g, b] = activation_rgb(activation);
    Color::from_rgb(r, g, b)
}
