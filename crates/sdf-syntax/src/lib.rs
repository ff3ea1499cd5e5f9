//! Text to tree: tokens, parser, tree, places and diagnostics of the `.sdf` language.
//!
//! The typical way is `parse(FileId, &str) → (File, Vec<Diagnostic>)`. Parsing never fails: it returns what it
//! could read and says what it could not.
#![warn(missing_docs)]

pub mod code;
pub mod diagnostic;
pub mod span;
pub mod tree;

pub use code::Code;
pub use diagnostic::{Diagnostic, Severity, did_you_mean};
pub use span::{FileId, Source, Sources, Span};
