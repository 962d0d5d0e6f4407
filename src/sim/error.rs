//! Why a plan cannot be simulated.

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
    /// An invalid load over time.
    #[error("found {found}, expected {expected}")]
    Profile {
        /// The load.
        found: String,
        /// What it should be.
        expected: &'static str,
    },
    /// A moving part without mass.
    #[error("found no mass on link \"{link}\" and what is fixed to it, expected a mass: it moves")]
    Massless {
        /// The link.
        link: String,
    },
    /// A gripper whose hold on the board the MJCF export does not have.
    #[error(
        "found measured wrench limits of the {arm} gripper, expected grippers with pads: the MJCF export has no other"
    )]
    ExportMeasured {
        /// The arm.
        arm: String,
    },
    /// A gripper that cannot let go of a board and grip it again.
    #[error(
        "found a gripper without rigid pads, expected grippers with pads without stiffness_n_m: staged plans regrasp"
    )]
    Staged,
    /// The engine refused a part of the scene.
    #[error("failed to build the scene: the robot's joints do not form a tree")]
    Engine,
    /// The caller stopped the simulation.
    #[error("stopped before the end of the simulation")]
    Stopped,
}
