//! The command `sdfc`: scenes to shaders, pages, pictures and distances.
//!
//! Standard output carries the artefact alone; all else goes to standard error.

mod arguments;
mod bug;
mod check;
mod compile;
mod facts;
mod failure;
mod input;
mod listing;
mod output;
mod progress;
mod query;
mod render;
mod terminal;

use arguments::{Arguments, Command, CompileArguments};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;
use terminal::Terminal;

fn main() -> ExitCode {
    // SAFETY: no other thread runs yet. Without it a layer of the Vulkan loader writes to the terminal.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    bug::explain_panics();
    let arguments = Arguments::parse_from(arguments::arguments());
    let terminal = Terminal::new(arguments.color);
    match run(&arguments, &terminal) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            terminal.failure(&failure);
            failure.exit_code()
        }
    }
}

fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let Some(command) = &arguments.command else {
        return compile::run(&arguments.compile, terminal);
    };
    if arguments.compile != CompileArguments::default() {
        return Err(Failure::call("what belongs to a command stands behind it")
            .help("for example `sdfc render scene.sdf -o scene.png`"));
    }
    match command {
        Command::Render(arguments) => render::run(arguments, terminal),
        Command::Check(arguments) => check::run(arguments, terminal),
        Command::Query(arguments) => query::run(arguments, terminal),
    }
}
