//! What the tests of this module share.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Arm, ArmAngles, Human, default_tool};
use crate::model::{
    operation::OperationKind,
    scenario::{Hand, Person},
};

/// The person of docs/method.md#43-body-dimensions, with a box shoulder and without posture limits.
pub(super) fn average_man() -> Person {
    Person::PAPER
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
    arm.ranges.joints_rad.map(|[low, high]| generator.random_range(low..=high))
}
