//! Why the command stops, and what it tells its caller.

use std::process::ExitCode;

/// Why the command stops.
#[derive(Debug)]
pub enum Failure {
    /// The scene is wrong, as its diagnostics have said.
    Scene,
    /// There are warnings, as the diagnostics have said, and they are denied.
    Denied,
    /// The call is wrong, as has been said.
    CallTold,
    /// The call is wrong: its arguments, or the files that it names.
    Call {
        /// What is wrong.
        message: String,
        /// What to do, where that is known.
        help: Option<String>,
    },
    /// The device failed, or there is none.
    Device(String),
    /// The compiler is wrong, as the diagnostics have said.
    Bug,
}

impl Failure {
    /// The call is wrong.
    pub fn call(message: impl Into<String>) -> Failure {
        Failure::Call { message: message.into(), help: None }
    }

    /// What to do about it.
    pub fn help(self, text: impl Into<String>) -> Failure {
        match self {
            Failure::Call { message, .. } => Failure::Call { message, help: Some(text.into()) },
            other => other,
        }
    }

    /// What the process returns.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Failure::Scene | Failure::Denied => 1,
            Failure::CallTold | Failure::Call { .. } => 2,
            Failure::Device(_) => 3,
            Failure::Bug => 101,
        })
    }
}
