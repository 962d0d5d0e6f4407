//! The `benchdog` command: parse, dispatch, exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    benchdog::cli::main()
}
