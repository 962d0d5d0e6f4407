//! Names that all parts of a recording share.

use rerun::EntityPath;

/// The name under which the viewer groups recordings.
pub(super) const APPLICATION: &str = "benchdog";

/// The timeline: time since the start of the simulation.
pub(super) const TIMELINE: &str = "time";

/// An entity's path from its parts, which may contain any characters.
pub(super) fn entity(parts: &[&str]) -> EntityPath {
    EntityPath::new(parts.iter().map(|&part| part.into()).collect())
}
