//! The stiffness of a board whose hands are welded to it.

use nalgebra::{Cholesky, Const, Matrix3, Matrix6, Vector3, Vector6};

use super::{contact_model::ContactModel, hand::HandModel, twist::Twist};
use crate::model::wrench::Wrench;

/// The smallest squared ratio of two pivots of a compliance that still counts as invertible. Rounding leaves about
/// 1e-15 where the exact figure is 0; no real arm's directions differ in stiffness by a factor of more than a million.
const SINGULAR_PIVOT_RATIO: f64 = 1e-10;

/// Lever at which rotations are measured when pivots are compared, m: about the half size of a board.
const PIVOT_LEVER_M: f64 = 0.2;

/// The board on the springs of its arms, hands welded to it: exact as long as no pad is at its limit
/// (docs/method.md#67-welded-stiffness).
#[derive(Clone, Debug)]
pub struct WeldedStiffness {
    p_ot: Vector3<f64>,
    /// Of K_O about the tool tip, O axes (N/m, N, N m/rad).
    factor: Cholesky<f64, Const<6>>,
    /// For each hand: its stiffness at the grasp point, and the map of twists from the tool tip to the grasp point.
    hands: Vec<(Matrix6<f64>, Matrix6<f64>)>,
    /// The wrench of each hand about its grasp point if the board does not move, from offsets of its joints.
    offsets: Vec<Vector6<f64>>,
}

impl WeldedStiffness {
    /// `K_O = sum_i Ad_i' C_i^-1 Ad_i` about the tool tip; `Ad_i` maps the board's twist at the tool tip to that at the
    /// grasp point. `None` if an arm is rigid in some direction (fewer than six joints, or a singular posture): its
    /// stiffness there is not finite.
    #[must_use]
    pub fn new(model: &ContactModel) -> Option<Self> {
        Self::of(model, model.hands.iter().map(HandModel::compliance))
    }

    /// The same with the compliances of the hands.
    pub(super) fn of(model: &ContactModel, compliances: impl IntoIterator<Item = Matrix6<f64>>) -> Option<Self> {
        let mut stiffness_t = Matrix6::zeros();
        let mut hands = Vec::with_capacity(model.hands.len());
        let mut offsets = Vec::with_capacity(model.hands.len());
        for (hand, compliance) in model.hands.iter().zip(compliances) {
            let stiffness = inverse(&compliance)?;
            let map = twist_map(&(hand.grasp_point_o - model.p_ot));
            stiffness_t += map.transpose() * stiffness * map;
            offsets.push(stiffness * hand.offset.to_vector());
            hands.push((stiffness, map));
        }
        Some(Self { p_ot: model.p_ot, factor: stiffness_t.cholesky()?, hands, offsets })
    }

    /// Displacement of the board at the tool tip, `delta = K_O^-1 w`, under a wrench w about O's origin.
    #[must_use]
    pub fn twist_at_tip(&self, wrench: &Wrench) -> Twist {
        let about_tip = wrench.about(&-self.p_ot).to_vector();
        Twist::from_vector(&self.factor.solve(&about_tip))
    }

    /// The wrench of each hand on the board, `-C_i^-1 Ad_i delta`, about its grasp point, under a wrench on the board
    /// about O's origin, without offsets of joints.
    #[must_use]
    pub fn hand_wrenches(&self, wrench: &Wrench) -> Vec<Wrench> {
        let delta = self.twist_at_tip(wrench).to_vector();
        self.hands.iter().map(|(stiffness, map)| wrench_from(&-(stiffness * (map * delta)))).collect()
    }

    /// Displacement of the board at the tool tip and the wrench of each hand about its grasp point, under a wrench on the board
    /// about O's origin and the offsets `t_i` of the hands: `delta = K_O^-1 (w + sum_i Ad_i' C_i^-1 t_i)` and `C_i^-1 (t_i - Ad_i delta)`.
    pub(super) fn equilibrium(&self, wrench: &Wrench) -> (Twist, Vec<Wrench>) {
        let pulled = self.hands.iter().zip(&self.offsets).map(|((_, map), offset)| map.tr_mul(offset));
        let about_tip = wrench.about(&-self.p_ot).to_vector() + pulled.sum::<Vector6<f64>>();
        let delta = self.factor.solve(&about_tip);
        let of_hand = |((stiffness, map), offset): (&(Matrix6<f64>, Matrix6<f64>), &Vector6<f64>)| {
            wrench_from(&(offset - stiffness * (map * delta)))
        };
        (Twist::from_vector(&delta), self.hands.iter().zip(&self.offsets).map(of_hand).collect())
    }
}

fn wrench_from(column: &Vector6<f64>) -> Wrench {
    let [fx, fy, fz, mx, my, mz] = (*column).into();
    Wrench::from([fx, fy, fz, mx, my, mz])
}

/// `[1, -[p]x; 0, 1]`: maps a twist at a point to the twist at the point p away from it.
pub(super) fn twist_map(lever: &Vector3<f64>) -> Matrix6<f64> {
    let mut map = Matrix6::identity();
    map.fixed_view_mut::<3, 3>(0, 3).copy_from(&-lever.cross_matrix());
    map
}

/// The inverse of a positive definite compliance; `None` if it is singular up to rounding.
fn inverse(compliance: &Matrix6<f64>) -> Option<Matrix6<f64>> {
    let mut scale = Matrix6::identity();
    scale.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Matrix3::identity() * PIVOT_LEVER_M));
    let factor = (scale * compliance * scale).cholesky()?;
    let pivots = factor.l_dirty().diagonal();
    let ratio = (pivots.min() / pivots.max()).powi(2);
    (ratio > SINGULAR_PIVOT_RATIO).then(|| scale * factor.inverse() * scale)
}
