//! The codes of all diagnostics, one row each: the one list that fixtures and documentation are checked against.

use crate::diagnostic::Severity;
use std::fmt;

macro_rules! codes {
    ($($name:ident $title:literal)*) => {
        /// The code of a diagnostic: `E0xx` is an error, `W0xx` a warning.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Code {
            $(#[doc = $title] $name,)*
        }

        impl Code {
            /// Every code.
            pub const ALL: &[Code] = &[$(Code::$name,)*];

            /// What the code is about, in a few words.
            pub fn title(self) -> &'static str {
                match self { $(Code::$name => $title,)* }
            }

            /// What the code means, in Markdown: with an example of it, fenced as `sdf wrong`, and the corrected
            /// example, fenced as `sdf right`.
            pub fn explanation(self) -> &'static str {
                match self { $(Code::$name => include_str!(concat!("codes/", stringify!($name), ".md")),)* }
            }

            /// The code as written: `E012`.
            pub fn as_str(self) -> &'static str {
                match self { $(Code::$name => stringify!($name),)* }
            }
        }
    };
}

codes! {
    // The text.
    E001 "a file that is not UTF-8"
    E002 "a character that has no meaning here"
    E003 "a number that is not written as one"
    E004 "a colour that is not written as one"
    E005 "a comment or string that does not end"
    E006 "a bracket without its partner"
    E007 "a token that does not fit"
    E008 "something of another language"
    E009 "a limit of the text: size, nesting"
    // Names.
    E020 "a name that nothing defines"
    E021 "a name defined twice"
    E022 "definitions that need each other"
    E023 "a reserved word as a name"
    E024 "an import that cannot be followed"
    E025 "a name that two imports bring"
    // Types and calls.
    E030 "a value of the wrong type"
    E031 "an operator that does not take these values"
    E032 "a call with the wrong arguments"
    E033 "a call that fits two functions"
    E034 "a member that is not there"
    E035 "an index out of range"
    // Values.
    E040 "a value that must be static"
    E041 "a result that is not finite"
    E042 "a division by zero"
    E043 "a value outside its range"
    E044 "a loop or recursion that is too long"
    E045 "a program that is too large"
    // Fields and contracts.
    E050 "the point where there is none"
    E051 "a field that gives no number"
    E052 "a field whose slope has no bound"
    E053 "a promise that does not hold"
    E054 "a field whose materials cannot be mixed"
    // The scene and its settings.
    E060 "a file without a scene"
    E061 "a block written twice"
    E062 "a setting that does not exist"
    E063 "a setting that does not fit"
    E065 "a param that does not exist or a value that it cannot have"
    // The emitted text.
    E070 "a shader that the validator refuses"
    W001 "a scene that costs more than a shader can spend"
    W002 "a param that can break what is required"
    W003 "an angle that looks like degrees"
    W004 "a field so steep that rays take very small steps"
    W005 "rays that ran out of steps"
    W006 "pixels of which it cannot be proved what they show"
    W007 "a scene farther away than rays go"
}

impl Code {
    /// Error or warning, by its letter.
    pub fn severity(self) -> Severity {
        if self.as_str().starts_with('W') { Severity::Warning } else { Severity::Error }
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
