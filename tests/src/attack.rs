//! Attacks on what the library promises: each of its public functions is called in many valid ways, and what is said
//! of the shapes that come of it is tried.
//!
//! The typical way is `forms() → calls_of(&form) → Subject → the measures`. What a shape is is not taken from its
//! formula: `tests/solids.sdf` and `tests/curves.sdf` describe it again, and a [`search`] finds how far away that is.

pub mod calls;
pub mod definitions;
pub mod forms;
pub mod measures;
pub mod points;
pub mod search;
pub mod subject;
