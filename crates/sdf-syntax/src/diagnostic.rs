//! Diagnostics as data: what is wrong, where, and what to do. Terminals, JSON and editors are fed from this.

use crate::code::Code;
use crate::span::Span;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Severity {
    /// Nothing can be made of the scene.
    Error,
    /// The scene works, though likely not as meant.
    Warning,
}

/// A place with what is to be said about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// What stands beside it; may be empty.
    pub text: String,
}

/// One finding. Made by a named function beside the check that finds it; the message says what is wrong and
/// the help what to do, in lower case and without a full stop.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// The code, which also tells the severity.
    pub code: Code,
    /// What is wrong.
    pub message: String,
    /// The place it is about.
    pub span: Span,
    /// What stands beside that place: what was expected, or what was found.
    pub label: String,
    /// Other places that explain it.
    pub related: Vec<Label>,
    /// What to do, where that is known.
    pub help: Option<String>,
}

impl Diagnostic {
    /// A finding at `span`.
    pub fn new(code: Code, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            message: message.into(),
            span,
            label: String::new(),
            related: Vec::new(),
            help: None,
        }
    }

    /// Says what stands beside the place.
    pub fn label(mut self, text: impl Into<String>) -> Diagnostic {
        self.label = text.into();
        self
    }

    /// Adds a place that explains it.
    pub fn related(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.related.push(Label { span, text: text.into() });
        self
    }

    /// Says what to do.
    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help = Some(text.into());
        self
    }

    /// Error or warning.
    pub fn severity(&self) -> Severity {
        self.code.severity()
    }
}

/// The name among `candidates` that `written` was most likely meant to be: at most a third of its letters
/// wrong, or alike but for case and underscores.
pub fn did_you_mean<'a>(written: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let plain = |name: &str| name.replace('_', "").to_lowercase();
    let wanted = plain(written);
    let limit = match written.chars().count() {
        0..3 => 0,
        n => n / 3,
    };
    candidates
        .into_iter()
        .filter(|c| *c != written)
        .map(|c| (strsim::damerau_levenshtein(&wanted, &plain(c)), c))
        .filter(|(distance, _)| *distance <= limit)
        .min()
        .map(|(_, c)| c)
}
