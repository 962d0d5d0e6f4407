//! Why a plan cannot be simulated.

use crate::human::HumanError;

/// Why a plan cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// An invalid setting.
    #[error("found {key} = {found}, expected {expected}")]
    Settings {
        /// The setting.
        key: &'static str,
        /// Its value.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// The board's size or mass is not positive.
    #[error("found {key} = {found}, expected a positive number")]
    Board {
        /// The plan's key.
        key: &'static str,
        /// Its value.
        found: f64,
    },
    /// The operation's wrench is not finite.
    #[error("found a wrench that is not finite, expected N and N m")]
    Wrench,
    /// An invalid load profile.
    #[error("found {found}, expected {expected}")]
    Profile {
        /// The load.
        found: String,
        /// What it should be.
        expected: &'static str,
    },
    /// An invalid person or tool.
    #[error("failed to place the person: {0}")]
    Person(HumanError),
    /// A pose or angle of the person is not finite.
    #[error("found a posture of the person that is not finite, expected m and rad")]
    Posture,
    /// No arm holds the board.
    #[error("found no arm that holds the board, expected at least one")]
    NoArm,
    /// An arm that the robot does not have.
    #[error("found arm \"{found}\", expected one of {expected}")]
    UnknownArm {
        /// The plan's name.
        found: String,
        /// The robot's names.
        expected: String,
    },
    /// An arm occurs twice.
    #[error("found arm \"{arm}\" twice, expected every arm at most once")]
    ArmTwice {
        /// The arm.
        arm: String,
    },
    /// The joints are not the arm's.
    #[error("arm \"{arm}\": found the joints [{found}], expected [{expected}]")]
    Joints {
        /// The arm.
        arm: String,
        /// The plan's joints.
        found: String,
        /// The robot's joints.
        expected: String,
    },
    /// The number of angles is wrong, or an angle is not finite.
    #[error("arm \"{arm}\": found {found} angles, expected {expected} that are finite")]
    Angles {
        /// The arm.
        arm: String,
        /// How many the plan has.
        found: usize,
        /// How many joints the arm has.
        expected: usize,
    },
    /// A grip force out of the gripper's range.
    #[error("arm \"{arm}\": found a grip force of {found_n} N, expected more than 0 and at most {max_n} N")]
    GripForce {
        /// The arm.
        arm: String,
        /// The plan's force, N.
        found_n: f64,
        /// The gripper's largest force, N.
        max_n: f64,
    },
    /// The board does not fit between the pads.
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
    /// The fingers do not close on the board's faces.
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
    /// The arm's angles do not put the gripper at the planned grasp pose.
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
    /// A moving body without mass.
    #[error("found no mass on link \"{link}\" and what is fixed to it, expected a mass: it moves")]
    Massless {
        /// The link.
        link: String,
    },
    /// The engine refused a part of the scene.
    #[error("failed to build the scene: the robot's joints do not form a tree")]
    Engine,
}
