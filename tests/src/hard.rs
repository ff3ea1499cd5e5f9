//! The hard cases: scenes on which ray marchers are known to fail, in `tests/hard/`, judged pixel by pixel by the certified
//! first hit of each ray, on every execution.
//!
//! A [`Fixture`] is a file and what its head says; its [`Subject`](fixture::Subject)s are scenes with values filled in. An
//! [`Execution`] runs a subject's probe for all pixels of a [`Frame`](sdf_render::Frame). What it shows is judged
//! ([`Score`]); the same is done with the naive [`twin`] of a case, which must fail.

pub mod execution;
pub mod fixture;
pub mod run;
pub mod score;
pub mod twin;

pub use execution::Execution;
pub use fixture::{Effort, Fixture, fixtures};
pub use run::Outcome;
pub use score::{Certified, Score};

/// Cases of which values matter, not pictures: the number, the suite in `tests/tests/` and its test.
pub const VALUES: [(u32, &str, &str); 11] = [
    (10, "hard_values", "a_thousand_blends_keep_their_digits"),
    (11, "relaxation", "relaxed_steps_see_what_plain_steps_see"),
    (16, "hard_values", "scales_and_periods_are_above_zero"),
    (17, "repetition", "the_own_cell_is_not_enough"),
    (18, "hard_values", "scales_and_periods_are_above_zero"),
    (19, "hard_values", "the_floor_modulo_stays_in_its_period"),
    (20, "hard_values", "a_thousand_copies_round_an_axis_are_those_written_out"),
    (24, "hard_values", "ten_thousand_rotations_are_one"),
    (26, "operations", "wgsl_computes_what_the_lanes_compute"),
    (26, "fields", "nothing_is_infinite_at_nasty_points"),
    (32, "hard_values", "a_union_of_twenty_thousand_is_taken"),
];
