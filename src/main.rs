//! The `benchdog` command.

fn main() {}
