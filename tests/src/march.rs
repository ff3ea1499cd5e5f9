//! The march measured: how many steps it takes, how far off its hits are, and how long a picture lasts, beside other
//! marches.
//!
//! The typical way is `Variant::named → Subject::new → Rays::of` for what is counted, and `clock::race` for what is timed;
//! [`comparison`] has both for one scene and several marches.
//! A [`Variant`] is the compiler with some functions of its renderer replaced by those of `tests/march/`.

pub mod clock;
pub mod comparison;
pub mod rays;
pub mod subject;
pub mod tables;
pub mod variant;

pub use rays::{Errors, Rays, Truth};
pub use subject::Subject;
pub use variant::Variant;
