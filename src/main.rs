//! The program `benchdog`.

use std::process::ExitCode;

fn main() -> ExitCode {
    benchdog::cli::main()
}
