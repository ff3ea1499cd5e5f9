//! Everything that people read, and what programs read of it: diagnostics, notes and the table of times, on standard
//! error.
//!
//! Text is made with colours, and the stream takes them out where they are not wanted.

mod human;
pub mod json;
mod place;
mod short;

use crate::arguments::{Color, Denied, MessageArguments, MessageFormat};
use crate::failure::Failure;
use anstream::AutoStream;
pub use human::{GREEN, RESET};
use human::{RED, message};
use json::Message;
use sdf_syntax::{Code, Diagnostic, Sources};
use sdfc::Clock;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::{self, Stderr, Write};
use std::time::Duration;

/// At most this many codes are named where more can be read about them.
const CODES: usize = 3;

/// Standard error.
pub struct Terminal {
    stream: RefCell<AutoStream<Stderr>>,
    format: MessageFormat,
    denies_warnings: bool,
    /// The codes that were shown.
    codes: RefCell<BTreeSet<Code>>,
}

impl Terminal {
    /// Standard error, with colours and in a format as wanted.
    pub fn new(arguments: &MessageArguments) -> Terminal {
        Terminal {
            stream: RefCell::new(AutoStream::new(io::stderr(), arguments.color_on(&io::stderr()))),
            format: arguments.message_format,
            denies_warnings: arguments.deny == Some(Denied::Warnings),
            codes: RefCell::default(),
        }
    }

    /// Whether a warning is a failure.
    pub fn denies_warnings(&self) -> bool {
        self.denies_warnings
    }

    /// Writes bytes; nobody is left to tell if that fails.
    fn write(&self, bytes: &[u8]) {
        let mut stream = self.stream.borrow_mut();
        let _ = stream.write_all(bytes).and_then(|()| stream.flush());
    }

    /// Writes what has no colours: nothing in it is to be taken out.
    fn write_plain(&self, text: &str) {
        let mut stderr = io::stderr().lock();
        let _ = stderr.write_all(text.as_bytes()).and_then(|()| stderr.flush());
    }

    /// Shows diagnostics, each with its place in the source.
    pub fn diagnostics(&self, sources: &Sources, diagnostics: &[Diagnostic]) {
        self.codes.borrow_mut().extend(diagnostics.iter().map(|d| d.code));
        let each = diagnostics.iter();
        match self.format {
            MessageFormat::Human => self.write(&human::diagnostics(sources, diagnostics)),
            MessageFormat::Short => {
                self.write_plain(&each.map(|d| short::diagnostic(d, sources)).collect::<String>());
            }
            MessageFormat::Json => {
                self.write_plain(&each.map(|d| Message::of(d, sources).line()).collect::<String>());
            }
        }
    }

    /// Says why the command stops, unless its diagnostics have said so.
    pub fn failure(&self, failure: &Failure) {
        match failure {
            Failure::Scene | Failure::CallTold | Failure::Bug => {}
            Failure::Denied => {
                self.say("error", "there are warnings", Some("`--deny warnings` refuses them"))
            }
            Failure::Device(text) => self.say("error", text, Some("`--device cpu` always works")),
            Failure::Call { message: text, help } => self.say("error", text, help.as_deref()),
        }
    }

    /// Whether messages are for programs, as JSON.
    pub fn is_for_programs(&self) -> bool {
        self.format == MessageFormat::Json
    }

    /// Says that something is wrong that is at no place of a file, and what to do.
    pub fn wrong(&self, text: &str, help: &str) {
        self.say("error", text, Some(help));
    }

    /// Says something that is worth knowing.
    pub fn note(&self, text: &str) {
        self.say("note", text, None);
    }

    fn say(&self, kind: &'static str, text: &str, help: Option<&str>) {
        match self.format {
            MessageFormat::Human => {
                let color = if kind == "error" { RED } else { GREEN };
                let help = help
                    .map_or_else(String::new, |help| format!("  {GREEN}help{RESET}: {}\n", message(help)));
                self.write(format!("{color}{kind}{RESET}: {}\n{help}", message(text)).as_bytes());
            }
            MessageFormat::Short => self.write_plain(&short::entry("sdfc", kind, text, help)),
            MessageFormat::Json => self.write_plain(&Message::without_place(kind, text, help).line()),
        }
    }

    /// Says how something ended, to people.
    pub fn summary(&self, text: &str) {
        if self.format == MessageFormat::Human {
            self.write(format!("{}\n", message(text)).as_bytes());
        }
    }

    /// Says once, behind all else, where more can be read about the diagnostics.
    pub fn where_to_read_on(&self) {
        let codes = self.codes.borrow();
        if !codes.is_empty() && self.format == MessageFormat::Human {
            let codes: Vec<&str> = codes.iter().take(CODES).map(|code| code.as_str()).collect();
            self.write(format!("for more, try: sdfc explain {}\n", codes.join(" ")).as_bytes());
        }
    }

    /// Shows how long each stage took.
    pub fn timings(&self, clock: &Clock) {
        if self.format == MessageFormat::Json {
            return self.write_plain(&json::timings(clock));
        }
        let total = ("total", clock.stages().iter().map(|(_, time)| *time).sum());
        let rows = clock.stages().iter().chain([&total]);
        let row =
            |(stage, time): &(&str, Duration)| format!("{stage:<24}{:>12.3} ms\n", time.as_secs_f64() * 1e3);
        let table: String = rows.map(row).collect();
        self.write(table.as_bytes());
    }
}

/// Says that the arguments make no sense, or gives the help that was asked for, and ends the process.
pub fn refuse_call(error: &clap::Error) -> ! {
    if !error.use_stderr() || wanted_format() == MessageFormat::Human {
        error.exit();
    }
    let text = error.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let said: Vec<&str> = lines.take_while(|line| !line.starts_with("Usage")).collect();
    refuse(&said.join(" "), "`sdfc --help` shows how it is called", error.exit_code())
}

/// Says that a word is no command, and which one was meant, and ends the process.
pub fn refuse_command(word: &str, meant: &str) -> ! {
    refuse(&format!("there is no command `{word}`"), &format!("did you mean `{meant}`?"), 2)
}

fn refuse(said: &str, help: &str, exit_code: i32) -> ! {
    let messages = MessageArguments { color: Color::Auto, message_format: wanted_format(), deny: None };
    Terminal::new(&messages).say("error", said, Some(help));
    std::process::exit(exit_code)
}

/// The format that is wanted by arguments that could not be read as a whole.
fn wanted_format() -> MessageFormat {
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let wants = |format: &str| {
        words.iter().any(|word| *word == format!("--message-format={format}"))
            || words.windows(2).any(|pair| pair[0] == "--message-format" && pair[1] == format)
    };
    match (wants("json"), wants("short")) {
        (true, _) => MessageFormat::Json,
        (false, true) => MessageFormat::Short,
        (false, false) => MessageFormat::Human,
    }
}
