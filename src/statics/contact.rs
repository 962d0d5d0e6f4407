//! What a pad or a gripper can hold: the models of contact that a hold may be made of.

use nalgebra::{UnitQuaternion, Vector6};

use crate::model::wrench::Wrench;

/// How friction and pressure of a pad are limited.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum PadKind {
    /// A soft finger with the whole rectangle for its patch, the default: `(mu fn, ft1, ft2, mn / e)` in SOC(4), e the
    /// mean distance of the patch from its centre, and the centre of pressure inside the patch. Torsion and tilt have
    /// the limits of a uniformly pressed patch.
    #[default]
    SoftFinger,
    /// Coulomb friction `(mu fn_k, ft1_k, ft2_k)` in SOC(3) at single points, along x_P and y_P from the pad's centre, m.
    ///
    /// The points' normal forces are free, so that the optimum moves all pressure to the outermost: for the pad of
    /// 40.4 x 36.0 mm the torsion of a uniform patch is overstated by 85 % with corners, by 15 % with 2 x 4 tile
    /// centres, by 62 % with 8 x 8.
    Points(Vec<[f64; 2]>),
}

impl PadKind {
    /// Coulomb points in the four corners of a pad.
    pub fn corners([a, b]: [f64; 2]) -> Self {
        Self::Points(vec![[a, b], [-a, b], [-a, -b], [a, -b]])
    }

    /// Coulomb points in the centres of equal tiles of a pad, this many along x_P and y_P.
    pub fn tile_centres(half_sides_m: [f64; 2], tiles: [usize; 2]) -> Self {
        let at = |axis: usize, tile: usize| half_sides_m[axis] * ((2 * tile + 1) as f64 / tiles[axis] as f64 - 1.0);
        let of_column = |i: usize| (0..tiles[1]).map(move |j| [at(0, i), at(1, j)]);
        Self::Points((0..tiles[0]).flat_map(of_column).collect())
    }
}

/// The shape of a gripper's limits in the space of wrenches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitShape {
    /// Each component has its own limit: `|w_i| <= D_i`.
    Box,
    /// All share one: `(1, D^-1 w)` in SOC(7).
    Ellipsoid,
}

/// Measured limits of what a gripper holds as a whole, in place of a model of its pads. They are those of one grip
/// force: the hand's grip force has no say in them.
#[derive(Clone, Debug, PartialEq)]
pub struct WrenchLimits {
    /// R_OG: the axes in which the limits were measured.
    pub rotation_og: UnitQuaternion<f64>,
    /// D: the largest force along and moment about each axis through the grasp point, N and N m, more than 0.
    pub most: Wrench,
    /// How the components share them.
    pub shape: LimitShape,
}

impl WrenchLimits {
    /// `D^-1 w` of a wrench about the grasp point in O axes.
    pub(super) fn ratios(&self, wrench_o: &Wrench) -> Vector6<f64> {
        let back = self.rotation_og.inverse();
        let wrench_g = Wrench::new(back * wrench_o.force_n, back * wrench_o.moment_nm);
        wrench_g.to_vector().component_div(&self.most.to_vector())
    }
}
