//! The runs of a sweep: how likely a plan holds (`docs/method.md#10-sweeps`).
//!
//! [`SweepOptions`] says which runs there are, [`Study`] does a single one, [`run`] all of them in blocks, and [`info`] describes them
//! for [`crate::sweep::summary::summarise`].

#[cfg(feature = "cache")]
mod info;
mod options;
mod runs;
mod study;

#[cfg(feature = "cache")]
pub use info::{Description, info};
pub use options::{OptionError, SweepOptions};
pub use runs::{Extent, SweepWatch, run};
pub use study::{Study, as_swept, screen};
