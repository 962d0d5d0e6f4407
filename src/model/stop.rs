//! How a long computation is stopped from outside.

use std::sync::atomic::{AtomicBool, Ordering};

/// Asked again and again by a long computation, from any of its threads: it ends soon after the first true answer.
///
/// Once an answer was true, all later ones must be. A computation that is never stopped does not depend on being asked.
pub trait Stop: Sync {
    /// True if the computation must end.
    fn is_stopped(&self) -> bool;
}

/// A computation that nobody stops.
#[derive(Clone, Copy, Debug, Default)]
pub struct Never;

impl Stop for Never {
    fn is_stopped(&self) -> bool {
        false
    }
}

/// Stopped by setting the flag, which is not cleared while the computation runs.
impl Stop for AtomicBool {
    fn is_stopped(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}
