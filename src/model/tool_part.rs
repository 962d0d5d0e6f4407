//! The parts of a hand-held tool as they are drawn in recordings and pictures.

use nalgebra::Point3;

/// What a part is made of; it decides the part's colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolMaterial {
    /// A bit, a chuck or a blade.
    Steel,
    /// A housing or a rod.
    Housing,
    /// What the hand holds, or a battery.
    Grip,
}

/// A convex part of a tool: the solid between two parallel convex polygons.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolPart {
    /// What it is made of.
    pub material: ToolMaterial,
    /// The corners of both polygons in W, m. They have the same number of corners, and equal indices are joined by an edge.
    pub ends_w: [Vec<Point3<f64>>; 2],
}
