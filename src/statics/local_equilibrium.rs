//! What a small change of a hold does to its response, without solving anew.
//!
//! A search that climbs asks how the response changes along each of some twenty moves. Around a hold whose pads are all
//! below their limits the closed form of [`super::elastic`] says so at once; elsewhere one Newton step with the system that
//! solved the hold's own equilibrium does, exact to first order ([`super::interior_point`]).

use super::{
    compliance::WeldedStiffness,
    contact_model::ContactModel,
    elastic,
    equilibrium::{CompliantResponse, Equilibrium},
    interior_point::InteriorPoint,
    program::HandEnergy,
    workspace::hand_energies,
};
use crate::model::scenario::Limits;

/// A hold's response to a load factor, ready to be asked about holds that differ from it a little.
#[derive(Clone, Debug)]
pub struct LocalEquilibrium {
    load_factor: f64,
    unloaded: Base,
    loaded: Base,
}

/// How the equilibrium was found.
#[derive(Clone, Debug)]
enum Base {
    Welded,
    Yielding(Box<InteriorPoint>),
}

impl LocalEquilibrium {
    /// `None` without a response, or if a pad has no friction.
    pub fn new(model: &ContactModel, load_factor: f64) -> Option<Self> {
        let welded = WeldedStiffness::new(model);
        let energies = hand_energies(model);
        let base = |load_factor: f64| {
            if welded.as_ref().is_some_and(|welded| elastic::equilibrium(model, welded, load_factor).is_some()) {
                return Some(Base::Welded);
            }
            InteriorPoint::solve(model, &energies, load_factor).map(|point| Base::Yielding(Box::new(point)))
        };
        Some(Self { load_factor, unloaded: base(0.0)?, loaded: base(load_factor)? })
    }

    /// The response of a hold that differs a little, to first order in what it differs by; none when it is no such hold.
    pub fn of(&self, model: &ContactModel) -> Option<CompliantResponse> {
        let mut energies = None;
        let mut welded = None;
        let mut equilibrium = |base: &Base, load_factor: f64| -> Option<Equilibrium> {
            match base {
                Base::Welded => {
                    let welded = welded.get_or_insert_with(|| WeldedStiffness::new(model)).as_ref()?;
                    elastic::first_order(model, welded, load_factor)
                }
                Base::Yielding(point) => {
                    let energies: &Vec<HandEnergy> = energies.get_or_insert_with(|| hand_energies(model));
                    point.first_order(model, energies, load_factor)
                }
            }
        };
        let unloaded = equilibrium(&self.unloaded, 0.0)?;
        let loaded = equilibrium(&self.loaded, self.load_factor)?;
        Some(CompliantResponse::between(model, &unloaded, loaded))
    }

    /// The largest ratio of torque, deflection and slip to their limits in that response.
    pub fn utilisation(&self, model: &ContactModel, limits: &Limits) -> Option<f64> {
        self.of(model).map(|response| response.utilisation(model, limits))
    }
}
