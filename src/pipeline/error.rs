//! Why a plan has no verdict or no recording.

use crate::{check::Flaws, sim::SimError};

/// Why a plan has no verdict or no recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The plan does not fit its robot or person.
    #[error("failed to check the plan: {0}")]
    Flaws(#[from] Flaws),
    /// The simulation cannot be set up from the plan, or was stopped.
    #[error("failed to simulate the plan: {0}")]
    Simulation(#[from] SimError),
    /// The recording cannot be made.
    #[cfg(feature = "recording")]
    #[error(transparent)]
    Record(#[from] crate::record::RecordError),
    /// The MCAP file cannot be made.
    #[cfg(feature = "mcap")]
    #[error(transparent)]
    Mcap(#[from] crate::ros::EncodeError),
}

impl RunError {
    /// True if the caller stopped the work.
    #[must_use]
    pub fn is_stop(&self) -> bool {
        matches!(self, Self::Simulation(SimError::Stopped))
    }
}
