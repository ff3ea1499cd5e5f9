//! Text to tree: tokens, parser, tree, places and diagnostics of the `.sdf` language.
//!
//! The typical way is `decode(FileId, &[u8]) → String`, `parse(FileId, &str) → (File, Vec<Diagnostic>)`. Parsing
//! never fails: it returns what it could read and says what it could not. Its stages are [`token::lex`],
//! [`outline::outline`] (brackets, nesting, where items begin) and the grammar, item by item.
#![warn(missing_docs)]

pub mod code;
pub mod diagnostic;
pub mod dump;
mod foreign;
mod mistake;
pub mod outline;
mod parse;
mod parser;
pub mod span;
pub mod token;
pub mod tree;

pub use code::Code;
pub use diagnostic::{Diagnostic, Severity, did_you_mean};
pub use foreign::{foreign_name, foreign_setting};
pub use parse::{DIAGNOSTIC_LIMIT, FILE_LIMIT, decode, parse, parse_part};
pub use span::{FileId, Source, Sources, Span};
