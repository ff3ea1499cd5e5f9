//! The command `sdfc`: scenes to shaders and pictures.
//!
//! Standard output carries the artefact alone; all else goes to standard error.

mod arguments;
mod bug;
mod check;
mod compile;
mod failure;
mod input;
mod listing;
mod output;
mod progress;
mod render;
mod terminal;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;
use terminal::Terminal;

fn main() -> ExitCode {
    // SAFETY: no other thread runs yet. Without it a layer of the Vulkan loader writes to the terminal.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    bug::explain_panics();
    let arguments = Arguments::parse();
    let terminal = Terminal::new(arguments.color);
    let done = match &arguments.command {
        None => compile::run(&arguments.compile, &terminal),
        Some(Command::Render(arguments)) => render::run(arguments, &terminal),
        Some(Command::Check(arguments)) => check::run(arguments, &terminal),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            terminal.failure(&failure);
            failure.exit_code()
        }
    }
}
