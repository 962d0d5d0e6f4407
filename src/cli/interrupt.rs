//! Ctrl-C and the termination signal.
//!
//! As long as a command has nothing to keep, the first signal ends it at once. A command that has something ends in order:
//! what takes long is stopped, what was found or finished is checked and written. The second signal always ends it at once.

use std::sync::{
    Arc, Mutex, MutexGuard, OnceLock, PoisonError,
    atomic::{AtomicBool, Ordering},
};

use super::{
    exit::{CliError, Exit},
    progress::Progress,
};

/// True after the first signal, if the command ends in order.
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Held by a command that writes what it has made: it is not ended in the middle.
static WRITING: Mutex<()> = Mutex::new(());

/// The progress of the command.
static PROGRESS: OnceLock<Arc<Progress>> = OnceLock::new();

/// Installs the handler of a command; once in a process.
///
/// # Errors
/// If the handler cannot be installed.
pub fn listen(progress: &Arc<Progress>) -> Result<(), CliError> {
    let progress = PROGRESS.get_or_init(|| progress.clone());
    ctrlc::set_handler(|| {
        if REQUESTED.load(Ordering::SeqCst) {
            end_at_once(progress, None);
        }
        match progress.ending() {
            Some(ending) => {
                REQUESTED.store(true, Ordering::SeqCst);
                progress.message(&format!("interrupted: {ending}; press Ctrl-C again to exit immediately"));
            }
            None => {
                let _writing = writing();
                end_at_once(progress, Some(&progress.interrupted()));
            }
        }
    })?;
    Ok(())
}

/// True after the first signal, if the command ends in order.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// While this is held the command is not ended: everything is found, and is written now.
pub fn writing() -> MutexGuard<'static, ()> {
    WRITING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Says how a command was interrupted that was stopped and has nothing to write.
pub fn explain() {
    if let Some(progress) = PROGRESS.get() {
        progress.finish();
        progress.message(&progress.interrupted());
    }
}

fn end_at_once(progress: &Progress, message: Option<&str>) -> ! {
    progress.finish();
    if let Some(message) = message {
        progress.message(message);
    }
    std::process::exit(Exit::Interrupted.code().into())
}
