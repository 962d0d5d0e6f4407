//! Standard output and standard error. A closed pipe is not an error.

use std::{
    ffi::OsString,
    io::{ErrorKind, Write},
};

use anstream::{
    AutoStream, ColorChoice,
    stream::{AsLockedWrite, RawStream},
};
use clap::ValueEnum;

use super::{exit::CliError, paint::painted};
use crate::input::{self, printable};

/// When messages and tables have colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ColorWhen {
    /// On a terminal, unless NO_COLOR is set or TERM is `dumb`; elsewhere if CLICOLOR_FORCE is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

impl ColorWhen {
    /// What the arguments say, before they are parsed: the messages of their parser have colours, too.
    pub fn of(arguments: &[OsString]) -> Self {
        let mut given = arguments.iter().take_while(|argument| *argument != "--").peekable();
        let mut when = Self::default();
        while let Some(argument) = given.next() {
            let value = match argument.to_str() {
                Some("--color") => given.peek().and_then(|next| next.to_str()),
                Some(text) => text.strip_prefix("--color="),
                None => None,
            };
            when = value.and_then(|value| Self::from_str(value, false).ok()).unwrap_or(when);
        }
        when
    }

    /// Makes it the choice of this process.
    pub fn apply(self) {
        self.choice().write_global();
    }

    fn choice(self) -> ColorChoice {
        match self {
            Self::Auto => ColorChoice::Auto,
            Self::Always => ColorChoice::Always,
            Self::Never => ColorChoice::Never,
        }
    }

    /// The choice for the parser of the arguments.
    pub fn of_parser(self) -> clap::ColorChoice {
        match self {
            Self::Auto => clap::ColorChoice::Auto,
            Self::Always => clap::ColorChoice::Always,
            Self::Never => clap::ColorChoice::Never,
        }
    }
}

/// Writes text for people to a stream: with colours if it is to have them, and else byte for byte.
fn write(mut stream: impl RawStream + AsLockedWrite, text: &str) -> std::io::Result<()> {
    match AutoStream::choice(&stream) {
        ColorChoice::Never => stream.write_all(text.as_bytes()),
        choice => AutoStream::new(stream, choice).write_all(painted(text).as_bytes()),
    }
}

/// Writes a report for people to standard output, with control characters in it escaped and with colours if it is to have them.
///
/// # Errors
/// As [`print`].
pub fn report(text: &str) -> Result<(), CliError> {
    written(write(std::io::stdout().lock(), &printable(text)))
}

fn written(result: std::io::Result<()>) -> Result<(), CliError> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(CliError::Stdout(error)),
        _ => Ok(()),
    }
}

/// Writes text to standard output, with control characters in it escaped.
///
/// # Errors
/// If it cannot be written for a reason other than a closed pipe.
pub fn print(text: &str) -> Result<(), CliError> {
    written(std::io::stdout().lock().write_all(printable(text).as_bytes()))
}

/// Writes a message to standard error, with control characters in it escaped and long lines cut. A failure to do so is ignored.
pub fn message(message: &str) {
    let _ = write(std::io::stderr().lock(), &format!("{}\n", input::message(message)));
}

/// A name as that of a file: letters, digits, `-`, `_` and `.`, and others as `-`.
pub fn file_stem(name: &str) -> String {
    let keep = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '-' };
    name.chars().map(keep).collect::<String>().trim_start_matches('.').to_owned()
}

/// A note as it is written to standard error.
pub fn note(note: &str) -> String {
    format!("note: {note}")
}

/// Writes notes to standard error.
pub fn notes(notes: &[String]) {
    notes.iter().for_each(|text| message(&note(text)));
}
