//! What the tests of this module share.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Arm, ArmAngles, Human, default_tool, paper_tool};
use crate::model::{
    operation::OperationKind,
    scenario::{Hand, Person, PostureLimits},
    wrench::Wrench,
};

/// Both hands.
pub(super) const HANDS: [Hand; 2] = [Hand::Right, Hand::Left];

/// The person of docs/method.md#43-body-dimensions, with a box shoulder and without posture limits.
pub(super) fn average_man() -> Person {
    Person::PAPER
}

/// The average man with the tool of the reproduction of the paper for this kind of operation.
pub(super) fn worker(hand: Hand, kind: OperationKind) -> Human {
    Human::new(&Person { hand, ..average_man() }, &paper_tool(kind)).unwrap()
}

/// The average man with a drill, leaning.
pub(super) fn leaning(hand: Hand, lean_deg: f64) -> Human {
    Human::new(&Person { hand, lean_deg, ..average_man() }, &paper_tool(OperationKind::Drill)).unwrap()
}

/// The average man with a drill, with a swing-twist shoulder and within these limits.
pub(super) fn within(posture: PostureLimits) -> Human {
    Human::new(&Person { posture, ..Person::default() }, &default_tool(OperationKind::Drill)).unwrap()
}

/// Forces of up to 52 N and moments of up to 1.8 N m.
pub(super) fn random_wrench(generator: &mut Pcg64) -> Wrench {
    let mut within = |range: f64| generator.random_range(-range..range);
    Wrench::from([within(30.0), within(30.0), within(30.0), within(1.0), within(1.0), within(1.0)])
}

/// Angles drawn at uniform shares of the arm's ranges.
pub(super) fn random_shares(arm: &Arm, generator: &mut Pcg64) -> ArmAngles {
    arm.ranges.at_shares(std::array::from_fn(|_| generator.random_range(0.0..=1.0)))
}

/// A fixed sequence of random numbers.
pub(super) fn generator(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

/// Angles drawn uniformly between the joints' limits.
pub(super) fn random_angles(arm: &Arm, generator: &mut Pcg64) -> ArmAngles {
    arm.ranges.joints_rad.map(|[low, high]| generator.random_range(low..=high))
}
