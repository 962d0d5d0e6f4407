//! Damaged input files: whatever a file contains, it is read, or refused with an error that names a file. No panic, no endless
//! computation, no half of a file.
//!
//! `cargo test` runs some hundred cases of each target, always the same ones. `BENCHDOG_FUZZ_SECONDS=120` runs others for two minutes a
//! target, from `BENCHDOG_FUZZ_SEED` on. A failure names its case: `BENCHDOG_FUZZ=scenario:17 cargo test --release --test fuzz` runs it
//! again, and its files stay under `target/tmp/fuzz`. They become a folder of `tests/fuzz/corpus/TARGET`, which every run reads, and
//! mutates.

mod commands;
mod driver;
mod mutate;
mod parts;
#[cfg(feature = "recording")]
mod recordings;
mod targets;
