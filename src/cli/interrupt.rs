//! Ctrl-C and the termination signal: the first one requests an orderly end, the second one exits immediately.

use std::sync::atomic::{AtomicBool, Ordering};

use super::{
    exit::{CliError, Exit},
    output,
};

/// True after the first signal.
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Installs the handler; `ending` tells the user what still happens after the first signal.
///
/// # Errors
/// If the handler cannot be installed.
pub fn listen(ending: &'static str) -> Result<(), CliError> {
    ctrlc::set_handler(move || {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(Exit::Interrupted.code().into());
        }
        output::message(&format!("interrupted: {ending}; press Ctrl-C again to exit immediately"));
    })?;
    Ok(())
}

/// True after the first signal.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
