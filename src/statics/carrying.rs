//! The torques with which the arms carry the board.

use nalgebra::DVector;

use super::{
    contact_model::{ContactModel, ContactModelError},
    elastic,
    equilibrium::EquilibriumOutcome,
    solvers::energy::HandEnergy,
    welded::WeldedStiffness,
    workspace::StabilityWorkspace,
};

impl StabilityWorkspace {
    /// For each hand the joint torques `J' w` with which it carries its share w of the board's weight in the compliant
    /// equilibrium under the weight alone, N m: what a controller that knows the board feeds forward. `None` if there is
    /// no such equilibrium.
    ///
    /// # Errors
    /// If the contact model is invalid.
    pub fn carrying_torque_nm(&mut self, model: &ContactModel) -> Result<Option<Vec<DVector<f64>>>, ContactModelError> {
        model.check()?;
        let welded = WeldedStiffness::new(model).and_then(|welded| elastic::equilibrium(model, &welded, 0.0));
        let unloaded = match welded {
            Some(unloaded) => unloaded,
            None => match self.solve_equilibrium(model, &HandEnergy::of_hands(model), 0.0) {
                EquilibriumOutcome::Found(unloaded) => unloaded,
                EquilibriumOutcome::NoEquilibrium | EquilibriumOutcome::Unknown { .. } => return Ok(None),
            },
        };
        let hands = model.hands.iter().zip(&unloaded.hand_wrenches);
        Ok(Some(hands.map(|(hand, wrench)| hand.joint_torque_nm(wrench) - &hand.gravity_torque_nm).collect()))
    }
}
