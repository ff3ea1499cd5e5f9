//! The presets of `quality` are those that were derived, and the study that derives them chooses as its table says.

use sdf_lang::{Accuracy, Quality};
use sdf_tests::presets::{Candidate, Point, Study, kept, named};

#[test]
fn the_presets_are_those_that_were_derived() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tables/presets.md");
    let text = std::fs::read_to_string(path).expect("the table of the presets");
    let kept = kept(&text);
    let presets: Vec<(String, Vec<String>)> =
        Quality::ALL.map(|quality| (quality.word().to_owned(), named(quality))).to_vec();
    assert_eq!(kept, presets, "`cargo run --release -p sdf-tests --bin presets` derives them");
}

/// A setting with these times and errors on two examples; some hits are wrong.
fn candidate(tolerance: f64, times: [f64; 2], rms: [f64; 2], wrong: usize) -> Candidate {
    let point = |i: usize| Point { time: times[i], rms: rms[i], wrong, lost: 0, depth: tolerance };
    Candidate { accuracy: Accuracy { tolerance, ..Accuracy::default() }, measured: vec![point(0), point(1)] }
}

fn study(candidates: Vec<Candidate>) -> Study {
    Study { examples: vec!["a".into(), "b".into()], compared: vec![(1, 1, 0); 2], candidates }
}

#[test]
fn what_is_slow_for_its_error_is_no_preset() {
    let study = study(vec![
        candidate(1.0, [1.0, 1.0], [4.0, 4.0], 3),
        candidate(0.3, [1.05, 1.05], [0.4, 0.4], 0),
        candidate(0.1, [1.2, 1.2], [0.1, 0.1], 0),
        // As exact as the one before, and a third slower on one example.
        candidate(0.05, [1.2, 1.6], [0.1, 0.1], 0),
        candidate(0.01, [1.3, 1.3], [0.05, 0.05], 0),
    ]);
    let derived = study.derived().expect("all four");
    let tolerances = derived.map(|(_, place)| study.candidates[place].accuracy.tolerance);
    assert_eq!(tolerances, [1.0, 0.3, 0.1, 0.01]);
    let slow = study.standing(&study.candidates[3]);
    assert!((slow.worst - 1.6 / 1.2).abs() < 1e-12 && slow.over_frontier > 1.1, "{slow:?}");
}

#[test]
fn what_is_wrong_is_none_of_the_last_three() {
    let study = study(vec![candidate(1.0, [1.0; 2], [4.0; 2], 1), candidate(0.1, [1.05; 2], [0.3; 2], 2)]);
    assert!(study.derived().is_err_and(|error| error.contains("balanced")));
}
