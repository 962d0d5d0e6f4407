//! Why a plan cannot be simulated.

use crate::human::HumanError;

/// Why a plan cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// A setting that makes no sense.
    #[error("found {key} = {found}, expected {expected}")]
    Settings {
        /// The setting.
        key: &'static str,
        /// Its value.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// A board without size or mass.
    #[error("found {key} = {found}, expected a positive number")]
    Board {
        /// The figure.
        key: &'static str,
        /// Its value.
        found: f64,
    },
    /// An operation that is not finite.
    #[error("found a wrench that is not finite, expected N and N m")]
    Wrench,
    /// A load over time that makes no sense.
    #[error("found {found}, expected {expected}")]
    Profile {
        /// What the load is.
        found: String,
        /// What it should be.
        expected: &'static str,
    },
    /// A person or a tool that is none.
    #[error("failed to place the person: {0}")]
    Person(HumanError),
    /// A person who stands nowhere.
    #[error("found a posture of the person that is not finite, expected m and rad")]
    Posture,
    /// Nothing holds the board.
    #[error("found no arm that holds the board, expected at least one")]
    NoArm,
    /// An arm that the robot has not.
    #[error("found arm \"{found}\", expected one of {expected}")]
    UnknownArm {
        /// The plan's name.
        found: String,
        /// The robot's names.
        expected: String,
    },
    /// An arm that holds twice.
    #[error("found arm \"{arm}\" twice, expected every arm at most once")]
    ArmTwice {
        /// The arm.
        arm: String,
    },
    /// Joints that are not those of the arm.
    #[error("arm \"{arm}\": found the joints [{found}], expected [{expected}]")]
    Joints {
        /// The arm.
        arm: String,
        /// The plan's joints.
        found: String,
        /// The robot's joints.
        expected: String,
    },
    /// The wrong number of angles, or angles that are not finite.
    #[error("arm \"{arm}\": found {found} angles, expected {expected} that are finite")]
    Angles {
        /// The arm.
        arm: String,
        /// How many the plan has.
        found: usize,
        /// How many joints the arm has.
        expected: usize,
    },
    /// A force that the gripper has not.
    #[error("arm \"{arm}\": found a grip force of {found_n} N, expected more than 0 and at most {max_n} N")]
    GripForce {
        /// The arm.
        arm: String,
        /// The plan's force, N.
        found_n: f64,
        /// The gripper's largest force, N.
        max_n: f64,
    },
    /// A board that does not fit between the pads.
    #[error(
        "arm \"{arm}\": found a board {:.1} mm thick, expected {:.1} to {:.1} mm, what the gripper closes on",
        thickness_m * 1e3, closed_m * 1e3, open_m * 1e3
    )]
    Opening {
        /// The arm.
        arm: String,
        /// Thickness of the board, m.
        thickness_m: f64,
        /// Gap between the pads when closed, m.
        closed_m: f64,
        /// Gap between the pads when open, m.
        open_m: f64,
    },
    /// Fingers that do not close on the board's faces.
    #[error(
        "arm \"{arm}\": found its fingers {off_mm:.3} mm and {off_deg:.3} degrees off the board's middle plane, \
         expected at most 1 mm and 0.1 degrees"
    )]
    Astride {
        /// The arm.
        arm: String,
        /// Distance of G from the middle plane of the board, mm.
        off_mm: f64,
        /// Angle between the finger axis and the board's normal, degrees.
        off_deg: f64,
    },
    /// Angles that put the gripper elsewhere than the plan says.
    #[error(
        "arm \"{arm}\": found its gripper {off_mm:.3} mm and {off_deg:.3} degrees from where it should hold the board, \
         expected at most 1 mm and 0.1 degrees"
    )]
    HandOff {
        /// The arm.
        arm: String,
        /// Distance, mm.
        off_mm: f64,
        /// Angle, degrees.
        off_deg: f64,
    },
    /// A part that moves without mass.
    #[error("found no mass on link \"{link}\" and what is fixed to it, expected a mass: it moves")]
    Massless {
        /// The link.
        link: String,
    },
    /// The engine refused a part of the scene.
    #[error("failed to build the scene: the robot's joints do not form a tree")]
    Engine,
}
