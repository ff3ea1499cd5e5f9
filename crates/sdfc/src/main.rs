//! The command `sdfc`: scenes to shaders, pages, pictures and distances.
//!
//! Standard output carries the artefact alone; all else goes to standard error.

mod arguments;
mod bug;
mod certify;
mod check;
mod compile;
mod doc;
mod explain;
mod facts;
mod failure;
mod input;
mod listing;
mod moments;
mod output;
mod progress;
mod query;
mod render;
mod terminal;
mod tradeoffs;

use arguments::{Arguments, Command, CompileArguments};
use clap::{CommandFactory, Parser};
use failure::Failure;
use std::process::ExitCode;
use terminal::Terminal;

fn main() -> ExitCode {
    // SAFETY: no other thread runs yet. Without it a layer of the Vulkan loader writes to the terminal.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    let arguments = Arguments::try_parse_from(arguments::arguments());
    let arguments = arguments.unwrap_or_else(|error| refuse(&error));
    bug::explain_panics(arguments.messages.message_format);
    let terminal = Terminal::new(&arguments.messages);
    let done = run(&arguments, &terminal);
    if let Err(failure) = &done {
        terminal.failure(failure);
    }
    terminal.where_to_read_on();
    done.map_or_else(|failure| failure.exit_code(), |()| ExitCode::SUCCESS)
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
        terminal::refuse_command(&first, meant);
    }
    terminal::refuse_call(error)
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
        Command::Explain(wanted) => explain::run(wanted, &arguments.messages, terminal),
        Command::Cost(arguments) => tradeoffs::run(arguments, terminal),
        Command::Doc(wanted) => doc::run(wanted, &arguments.messages),
    }
}
