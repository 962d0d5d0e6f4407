//! The binary: its commands, files, messages and exit codes.

#[path = "../common/mod.rs"]
mod common;
mod natural_results;
mod process;

mod bad_input;
mod bad_plates;
mod bad_tasks;
mod bounds;
mod commands;
mod compare;
mod determinism;
mod explain;
mod figures;
mod habits;
mod import;
mod init;
mod inputs;
mod interrupt;
mod maps;
mod margin_and_export;
mod mcap;
mod messages;
mod odd_files;
mod odd_recordings;
mod odd_robots;
mod pages;
mod partial_plans;
mod release;
mod replan;
mod reports;
mod reproduce;
mod robots;
mod robust;
mod scenarios;
mod schemas;
mod sweep;
mod sweep_sections;
mod task;
