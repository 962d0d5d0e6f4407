//! `-v`: what the program does, on standard error. The library states it as events of `tracing`; a program that uses the library
//! gets them by a subscriber of its own.

use std::{
    io::{self, Write},
    sync::atomic::{AtomicBool, Ordering},
};

use tracing::level_filters::LevelFilter;
use tracing_subscriber::{Layer as _, Registry, filter::Targets, fmt, layer::SubscriberExt as _};

use crate::input::printable;

/// The variable with a filter in place of `-v`: `debug`, or `benchdog::planner=debug,info`.
const FILTER: &str = "BENCHDOG_LOG";

static IS_ON: AtomicBool = AtomicBool::new(false);

/// True if events are written: a line of progress would be written over.
pub fn is_on() -> bool {
    IS_ON.load(Ordering::SeqCst)
}

/// Writes events from now on: with `verbose` 1 what is done, with 2 its parts, with 3 everything. Nothing with 0, unless the variable
/// has a filter.
pub fn begin(verbose: u8) {
    let level = match verbose {
        0 => LevelFilter::OFF,
        1 => LevelFilter::INFO,
        2 => LevelFilter::DEBUG,
        _ => LevelFilter::TRACE,
    };
    let given = std::env::var(FILTER).ok().filter(|given| !given.is_empty());
    let filter = match given.map(|given| given.parse::<Targets>()) {
        Some(Ok(filter)) if verbose == 0 => filter,
        Some(Err(error)) => {
            super::output::message(&format!("warning: {FILTER}: {error}"));
            Targets::new().with_target("benchdog", level)
        }
        // The option is nearer to the user than the variable.
        _ => Targets::new().with_target("benchdog", level),
    };
    if filter == Targets::new().with_target("benchdog", LevelFilter::OFF) {
        return;
    }
    let lines = fmt::layer().with_ansi(false).without_time().with_writer(|| Lines).with_filter(filter);
    IS_ON.store(tracing::subscriber::set_global_default(Registry::default().with(lines)).is_ok(), Ordering::SeqCst);
}

/// Standard error, with control characters of events escaped. Each event is written at once.
struct Lines;

impl Write for Lines {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        io::stderr().lock().write_all(printable(&String::from_utf8_lossy(bytes)).as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
