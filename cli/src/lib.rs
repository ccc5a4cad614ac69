//! The `motif` command as a library, so that its pipeline can be tested: files to words ([`wire`]),
//! words to a library on disk ([`library`]), and the commands over both.
//!
//! Frames count from 0 and are those of the source file; spans are half open; seconds are frame
//! divided by the source's rate.

#![cfg_attr(test, allow(clippy::unwrap_used))]

pub mod align;
pub mod annotation;
pub mod args;
pub mod bundling;
pub mod commands;
pub mod corpus;
pub mod corpus_files;
pub mod eval;
pub mod failure;
pub mod keyframes;
pub mod library;
pub mod output;
pub mod picture;
pub mod recording;
pub mod report;
pub mod scene;
pub mod selection;
pub mod source;
pub mod take;
pub mod targets;
pub mod templates;
pub mod view;
pub mod walking;
pub mod wire;

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
use failure::{Exit, Failure};

/// Runs a command line, the program's name first, and gives its exit code.
///
/// Prints to standard output and standard error.
pub fn run(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are asked for; all else is bad usage. A closed output is no reason to fail.
            let _ = error.print();
            let exit = if error.use_stderr() {
                Exit::Usage
            } else {
                Exit::Ok
            };
            return ExitCode::from(exit as u8);
        }
    };
    let exit = execute(&cli).unwrap_or_else(|failure| {
        if !matches!(failure, Failure::Closed) {
            let _ = writeln!(std::io::stderr(), "motif: {failure}");
        }
        failure.exit()
    });
    ExitCode::from(exit as u8)
}

/// Does what a command line asks for, on as many threads as it says.
///
/// # Errors
/// [`Failure`] if the command as a whole fails.
pub fn execute(cli: &Cli) -> Result<Exit, Failure> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(cli.global.threads)
        .build()
        .map_err(|e| Failure::Usage(format!("--threads {}: {e}", cli.global.threads)))?;
    pool.install(|| match &cli.command {
        Command::Demo(args) => commands::demo::run(args, &cli.global),
        Command::Info(args) => commands::info::run(args, &cli.global),
        Command::Annotate(args) => commands::annotate::run(args, &cli.global),
        Command::Align(args) => commands::align::run(args, &cli.global),
        Command::Bundle(args) => commands::bundle::run(args, &cli.global),
        Command::Convert(args) => commands::convert::run(args, &cli.global),
        Command::Features(args) => commands::features::run(args, &cli.global),
        Command::Index(args) => commands::index::run(args, &cli.global),
        Command::Learn(args) => commands::learn::run(args, &cli.global),
        Command::Library(args) => commands::library::run(args, &cli.global),
        Command::Report(args) => commands::report::run(args, &cli.global),
        Command::Search(args) => commands::search::run(args, &cli.global),
        Command::Template(args) => commands::template::run(args, &cli.global),
        Command::View(args) => commands::view::run(args, &cli.global),
        Command::Walk(args) => commands::walk::run(args, &cli.global),
        Command::Eval(args) => commands::eval::run(args, &cli.global),
    })
}
