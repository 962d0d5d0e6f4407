//! First-order response of a contact model to small changes of it, without a new solve.
//!
//! The planner's refinement differentiates the response by some twenty variables. If all pads are below their limits,
//! [`super::elastic`] gives the changed response in closed form; otherwise one Newton step with the factorised system
//! of the equilibrium, exact to first order ([`super::solvers::interior_point`]).

use nalgebra::Matrix6;

use super::{
    contact_model::ContactModel,
    elastic,
    equilibrium::{CompliantResponse, Equilibrium},
    hand::HandModel,
    solvers::{energy::HandEnergy, interior_point::InteriorPoint},
    welded::WeldedStiffness,
    workspace::StabilityWorkspace,
};
use crate::model::scenario::Limits;

/// The equilibria of a contact model with and without its load, ready for evaluation of slightly different models.
#[derive(Clone, Debug)]
pub struct LocalEquilibrium {
    load_factor: f64,
    unloaded: Base,
    loaded: Base,
    /// The hands with their compliances: a model near this one has some of the same hands.
    hands: Vec<(HandModel, Matrix6<f64>)>,
}

/// An equilibrium by the method that found it.
#[derive(Clone, Debug)]
enum Base {
    Welded,
    InteriorPoint(Box<InteriorPoint>),
}

impl LocalEquilibrium {
    /// `None` without an equilibrium under the weight alone or at the load factor, or if a pad has no friction.
    /// Also `None` if pads are at their limits beside a measured gripper: the interior point has pads alone.
    #[must_use]
    pub fn new(workspace: &mut StabilityWorkspace, model: &ContactModel, load_factor: f64) -> Option<Self> {
        let hands: Vec<_> = model.hands.iter().map(|hand| (hand.clone(), hand.compliance())).collect();
        let welded = WeldedStiffness::of(model, hands.iter().map(|(_, compliance)| *compliance));
        let energies: Vec<_> = hands.iter().map(|(_, compliance)| HandEnergy::new(compliance)).collect();
        let mut base = |load_factor: f64| {
            if welded.as_ref().is_some_and(|welded| elastic::equilibrium(model, welded, load_factor).is_some()) {
                return Some(Base::Welded);
            }
            let point = workspace.interior_point(model, &energies, load_factor);
            point.map(|point| Base::InteriorPoint(Box::new(point)))
        };
        Some(Self { load_factor, unloaded: base(0.0)?, loaded: base(load_factor)?, hands })
    }

    /// The compliance of a hand of a slightly different model.
    fn compliance(&self, number: usize, hand: &HandModel) -> Matrix6<f64> {
        match self.hands.get(number) {
            Some((known, compliance)) if known == hand => *compliance,
            _ => hand.compliance(),
        }
    }

    /// The response of a slightly different model, to first order in the difference; `None` if it has another number of
    /// hands, a pad without friction or pads that are not opposite.
    fn response(&self, model: &ContactModel) -> Option<CompliantResponse> {
        let compliances: Vec<_> =
            model.hands.iter().enumerate().map(|(number, hand)| self.compliance(number, hand)).collect();
        let mut energies = None;
        let mut welded = None;
        let mut equilibrium = |base: &Base, load_factor: f64| -> Option<Equilibrium> {
            match base {
                Base::Welded => {
                    let welded = welded
                        .get_or_insert_with(|| WeldedStiffness::of(model, compliances.iter().copied()))
                        .as_ref()?;
                    elastic::first_order(model, welded, load_factor)
                }
                Base::InteriorPoint(point) => {
                    let energies: &Vec<HandEnergy> =
                        energies.get_or_insert_with(|| compliances.iter().map(HandEnergy::new).collect());
                    let found = point.first_order(model, energies, load_factor)?;
                    Some(Equilibrium::of_hands(model, load_factor, found.hand_wrenches, found.board))
                }
            }
        };
        let unloaded = equilibrium(&self.unloaded, 0.0)?;
        let loaded = equilibrium(&self.loaded, self.load_factor)?;
        Some(CompliantResponse::between(model, &unloaded, loaded))
    }

    /// The largest ratio of torque, deflection and slip to their limits in the first-order response of a slightly
    /// different model.
    #[must_use]
    pub fn utilisation(&self, model: &ContactModel, limits: &Limits) -> Option<f64> {
        self.response(model).map(|response| response.utilisation(model, limits))
    }
}
