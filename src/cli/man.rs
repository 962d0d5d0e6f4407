//! `benchdog man`: manual pages, one for each command, from the definition of the command line.

use std::io::{self, Write as _};

use clap::{Command, CommandFactory};
use clap_mangen::{
    Man,
    roff::{Roff, roman},
};

use super::{
    args::{Cli, ManArgs},
    exit::{CliError, Exit},
    interrupt, output,
};
use crate::report::file;

/// The program, at the foot of each page.
const VERSION: &str = concat!("benchdog ", env!("CARGO_PKG_VERSION"));

/// Prints the main page, or writes all pages.
pub fn man(args: &ManArgs) -> Result<Exit, CliError> {
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    let cannot = |error: io::Error| CliError::Machine(format!("failed to make a manual page: {error}"));
    let Some(folder) = &args.out else {
        output::print(&String::from_utf8_lossy(&page(&command).map_err(cannot)?))?;
        return Ok(Exit::Met);
    };
    let mut pages = Vec::new();
    add_pages(&command, &mut pages).map_err(cannot)?;
    let _writing = interrupt::writing();
    file::check_folder(folder)?;
    for (name, bytes) in &pages {
        file::write_whole(&folder.join(name), bytes)?;
    }
    output::print(&format!("wrote {} pages into {}\n", pages.len(), folder.display()))?;
    Ok(Exit::Met)
}

/// Adds the pages of a command and its subcommands, with their names.
fn add_pages(command: &Command, pages: &mut Vec<(String, Vec<u8>)>) -> io::Result<()> {
    pages.push((format!("{}.1", name(command)), page(command)?));
    command.get_subcommands().filter(|sub| !sub.is_hide_set()).try_for_each(|sub| add_pages(sub, pages))
}

/// The name of a command as that of its page, such as `benchdog-robot-new`.
fn name(command: &Command) -> &str {
    command.get_display_name().unwrap_or_else(|| command.get_name())
}

/// The page of a command. The version at its foot is the program's; there is no date, so equal programs write equal pages.
fn page(command: &Command) -> io::Result<Vec<u8>> {
    let man = Man::new(command.clone());
    let mut bytes = Vec::new();
    // Its own title leaves an empty date out, so that the version would stand where the date belongs.
    writeln!(bytes, ".TH \"{}\" \"1\" \"\" \"{VERSION}\" \"Benchdog manual\"", name(command))?;
    man.render_name_section(&mut bytes)?;
    man.render_synopsis_section(&mut bytes)?;
    man.render_description_section(&mut bytes)?;
    man.render_options_section(&mut bytes)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut bytes)?;
    }
    if let Some(notes) = command.get_after_help() {
        let mut roff = Roff::new();
        // As it is printed: the columns of examples are aligned.
        roff.control("SH", ["NOTES"]).control("nf", []);
        notes.to_string().lines().for_each(|line| {
            roff.text([roman(line)]);
        });
        roff.control("fi", []);
        roff.to_writer(&mut bytes)?;
    }
    Ok(bytes)
}
