//! What the tests of this module share.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Arm, ArmAngles, Human, default_tool};
use crate::model::{
    operation::OperationKind,
    scenario::{Hand, Person, Sex},
};

/// The person of docs/method.md#43-body-dimensions.
pub(super) fn average_man() -> Person {
    Person { height_m: 1.75, mass_kg: 75.0, sex: Sex::Male, hand: Hand::Right, percentile: 50.0, lean_deg: 0.0 }
}

/// The average man with the default tool for this kind of operation.
pub(super) fn worker(hand: Hand, kind: OperationKind) -> Human {
    Human::new(&Person { hand, ..average_man() }, &default_tool(kind)).unwrap()
}

/// A fixed sequence of random numbers.
pub(super) fn generator(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

/// Angles drawn uniformly between the joints' limits.
pub(super) fn random_angles(arm: &Arm, generator: &mut Pcg64) -> ArmAngles {
    arm.limits_rad.map(|[low, high]| generator.random_range(low..=high))
}
