//! Ctrl-C, and the signal by which a CI job is cancelled: the first asks for a clean end, the second ends at once.

use std::sync::atomic::{AtomicBool, Ordering};

use super::{
    exit::{CliError, Exit},
    output,
};

/// True once the user has asked for an end.
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Listens from now on; `ending` says what is still done after the first signal.
///
/// # Errors
/// When the system does not let signals be caught.
pub fn listen(ending: &'static str) -> Result<(), CliError> {
    ctrlc::set_handler(move || {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(Exit::Interrupted.code().into());
        }
        output::message(&format!("interrupted: {ending}; once more to end at once"));
    })?;
    Ok(())
}

/// True once the user has asked for an end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
