//! The evaluation of Chen et al. 2018: its operations, the jobs to plan and simulate, and tables, pictures and conclusions
//! from their results.
//!
//! Everything here is a pure function. [`schedule`] lists the jobs; the command `benchdog reproduce` runs them, keeps their
//! results on disk and writes the files. Every planned hold is reported, whatever its verdict. Durations are used in
//! [`timing`] and `timing.csv` only, because they differ between runs.

pub mod claims;
pub mod csv_files;
pub mod evaluation;
pub mod jobs;
pub mod markdown;
pub mod paper;
pub mod picture;
pub mod printed;
pub mod schedule;
pub mod sensitivity;
pub mod statistics;
pub mod table;
#[cfg(test)]
mod testing;
pub mod timing;
