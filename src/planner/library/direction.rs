//! Cells of directions: the unit sphere divided along the faces of a cube.

use std::f64::consts::PI;

/// Number of cells with `cells_per_side` along each side of a cube face.
pub const fn direction_cells(cells_per_side: usize) -> usize {
    6 * cells_per_side * cells_per_side
}

/// The cell of a direction: the cube face that it points through, and the place on that face. Cells are equal in angle.
pub fn direction_cell(v: [f64; 3], cells_per_side: usize) -> usize {
    let axis = (0..3).max_by(|&a, &b| v[a].abs().total_cmp(&v[b].abs())).unwrap_or(0);
    let face = 2 * axis + usize::from(v[axis] < 0.0);
    let place = |other: usize| {
        let share = (v[other] / v[axis].abs()).atan() / (PI / 2.0) + 0.5;
        ((share * cells_per_side as f64) as usize).min(cells_per_side - 1)
    };
    (face * cells_per_side + place((axis + 1) % 3)) * cells_per_side + place((axis + 2) % 3)
}
