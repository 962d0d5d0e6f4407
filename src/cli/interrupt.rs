//! Ctrl-C and the termination signal.
//!
//! As long as a command has nothing to keep, the first signal ends it at once. A command that has something ends in order:
//! what takes long is stopped, what was found or finished is checked and written. The second signal always ends it at once.

use std::sync::{
    Arc, Mutex, MutexGuard, OnceLock, PoisonError,
    atomic::{AtomicBool, Ordering},
};

use super::exit::{CliError, Exit};

/// True after the first signal, if the command ends in order.
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Held by a command that writes what it has made: it is not ended in the middle.
static WRITING: Mutex<()> = Mutex::new(());

/// The command that may be interrupted.
static COMMAND: OnceLock<Arc<dyn Interruptible>> = OnceLock::new();

/// What Ctrl-C asks of a command and tells its user.
pub trait Interruptible: Send + Sync {
    /// What the command still does after Ctrl-C; `None` if there is nothing to keep, so that it ends at once.
    fn ending(&self) -> Option<&'static str>;
    /// How it was interrupted, if it writes nothing more.
    fn interrupted(&self) -> String;
    /// Prints a line on standard error.
    fn message(&self, line: &str);
    /// Leaves the terminal as it was.
    fn finish(&self);
}

/// Installs the handler of a command; once in a process.
///
/// # Errors
/// If the handler cannot be installed.
pub fn listen(command: Arc<dyn Interruptible>) -> Result<(), CliError> {
    let command = COMMAND.get_or_init(|| command);
    ctrlc::set_handler(|| {
        if REQUESTED.load(Ordering::SeqCst) {
            end_at_once(&**command, None);
        }
        match command.ending() {
            Some(ending) => {
                REQUESTED.store(true, Ordering::SeqCst);
                command.message(&format!("interrupted: {ending}; press Ctrl-C again to exit immediately"));
            }
            None => {
                let _writing = writing();
                end_at_once(&**command, Some(&command.interrupted()));
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
    if let Some(command) = COMMAND.get() {
        command.finish();
        command.message(&command.interrupted());
    }
}

fn end_at_once(command: &dyn Interruptible, message: Option<&str>) -> ! {
    command.finish();
    if let Some(message) = message {
        command.message(message);
    }
    std::process::exit(Exit::Interrupted.code().into())
}
