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

use arguments::{Arguments, Command, CompileArguments};
use clap::{CommandFactory, Parser};
use failure::Failure;
use std::process::ExitCode;
use terminal::Terminal;

fn main() -> ExitCode {
    // SAFETY: no other thread runs yet. Without it a layer of the Vulkan loader writes to the terminal.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    bug::explain_panics();
    let arguments = Arguments::try_parse().unwrap_or_else(|error| refuse(&error));
    let terminal = Terminal::new(arguments.color);
    match run(&arguments, &terminal) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            terminal.failure(&failure);
            failure.exit_code()
        }
    }
}

/// Says what is wrong with a call, and ends the process. A word that is like a command was meant to be one.
fn refuse(error: &clap::Error) -> ! {
    let first = std::env::args().nth(1).unwrap_or_default();
    let commands = Arguments::command();
    let names: Vec<&str> = commands.get_subcommands().map(clap::Command::get_name).collect();
    if error.use_stderr()
        && !std::path::Path::new(&first).exists()
        && let Some(meant) = sdf_syntax::did_you_mean(&first, names.iter().copied())
    {
        let failure =
            Failure::call(format!("there is no command `{first}`")).help(format!("did you mean `{meant}`?"));
        Terminal::new(arguments::Color::Auto).failure(&failure);
        std::process::exit(2);
    }
    error.exit()
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
    }
}
