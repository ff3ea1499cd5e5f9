//! No step of a ray passes a surface, in the field of any function of the library: what is proved of the ball of 0.99 of
//! each step, for many random points and many calls of each function.
//!
//! `SAFETY=4000 UPDATE_TABLES=1 cargo test --workspace --test safety` tries that many points, of more calls, and writes
//! `tests/tables/safety.md`.

use rayon::prelude::*;
use sdf_lang::{Options, compiler_files};
use sdf_tests::attack::calls::calls_of;
use sdf_tests::attack::forms::{Form, forms};
use sdf_tests::attack::subject::{Kind, kind_of};
use sdf_tests::safety::{Site, Tally, tried};
use sdf_tests::table::Table;
use std::collections::BTreeMap;

/// How many points are tried where nothing else is said.
const POINTS: usize = 1_000;
/// The share of steps that may be undecided. It is meant to be 0.01: not told yet are the fields of which slopes over
/// regions have no bound, since a root, an angle or the choice of the nearest side is in them; `tables/safety.md` names
/// them.
const UNDECIDED: f64 = 0.18;

/// The calls of a form that make shapes: its examples, and others like them if `varied`.
fn sites(form: &Form, varied: bool) -> Vec<Site> {
    let mut sites = Vec::new();
    for example in &form.examples {
        let kind = kind_of(example).unwrap_or_else(|said| panic!("{said}"));
        if !kind.is_shape() {
            continue;
        }
        if varied {
            let calls = calls_of(form, example).unwrap_or_else(|said| panic!("{said}"));
            sites.extend(calls.subjects.iter().filter_map(|subject| Site::of(&subject.call, kind)));
        } else {
            sites.extend(Site::of(example, kind));
        }
    }
    sites
}

/// The steps of all functions, by their names.
fn tallies(points: usize) -> BTreeMap<String, (usize, Tally)> {
    // `FUNCTION=twist` tries one function alone.
    let only = std::env::var("FUNCTION").ok();
    let forms: Vec<Form> =
        forms().into_iter().filter(|form| only.as_ref().is_none_or(|name| *name == form.name)).collect();
    let varied = points > POINTS;
    let sites: Vec<(String, Site)> = forms
        .par_iter()
        .flat_map_iter(|form| sites(form, varied).into_iter().map(|site| (form.name.clone(), site)))
        .collect();
    let each = points.div_ceil(sites.len());
    let found: Vec<(String, Tally)> =
        sites.par_iter().map(|(name, site)| (name.clone(), tried(site, each, &Options::default()))).collect();
    let mut tallies = BTreeMap::new();
    for (name, tally) in found {
        let entry: &mut (usize, Tally) = tallies.entry(name).or_default();
        *entry = (entry.0 + 1, std::mem::take(&mut entry.1).and(tally));
    }
    tallies
}

#[test]
fn no_step_passes_a_surface() {
    let asked = std::env::var("SAFETY").ok();
    let points = asked.as_ref().map_or(POINTS, |count| count.parse().expect("a number of points"));
    let tallies = tallies(points);
    let mut table = about();
    let mut all = Tally::default();
    for (name, (calls, tally)) in tallies {
        let counts = [calls, tally.pairs, tally.wrong.len(), tally.undecided.len()].map(|n| n.to_string());
        let least = format!("{:.2}", tally.least_free());
        table.rows.push([name].into_iter().chain(counts).chain([least]).collect());
        all = all.and(tally);
    }
    println!("{}", table.markdown());
    let wrong: Vec<String> =
        all.wrong.iter().take(20).map(|(call, at, share)| format!("{call} at {at:?}: {share}")).collect();
    assert!(wrong.is_empty(), "{} of {} steps pass a surface: {wrong:#?}", all.wrong.len(), all.pairs);
    let share = all.undecided.len() as f64 / all.pairs as f64;
    println!("{} of {} steps are undecided", all.undecided.len(), all.pairs);
    assert!(share <= UNDECIDED, "{} of {} steps are undecided", all.undecided.len(), all.pairs);
    if asked.is_some()
        && let Some(stale) = table.check("safety.md")
    {
        panic!("{stale}");
    }
}

/// The table without its rows.
fn about() -> Table {
    let columns = ["function", "calls", "pairs", "unsafe", "undecided", "least free share"];
    Table {
        title: "Safety of steps".into(),
        about: "Steps from random points in the fields of calls of each function of the library; `tests/tests/safety.rs` \
                writes this.\nA step is unsafe if there is a zero of the field within 0.99 of it, and undecided if \
                neither that nor the contrary is proved. The least\nfree share is that of a step within which there \
                certainly is no zero, of all the function's steps."
            .into(),
        versions: vec![format!("sdfc {}", sdfc::VERSION)],
        columns: columns.map(String::from).to_vec(),
        ..Table::default()
    }
}

/// A library that promises too much is caught: a twist that says it is no steeper than what it twists.
#[test]
fn a_promise_that_is_too_good_is_caught() {
    let call = "box((0.5, 0.9, 0.2)).at(0.3, 0.2, -0.1).twist(2)";
    let site = Site::of(call, Kind::Solid).expect("a shape");
    let right = tried(&site, 100, &Options::default());
    assert_eq!(right.wrong, [], "{call}");
    let (name, text) = compiler_files().find(|(name, _)| *name == "bend.sdf").expect("a file of the library");
    let promise =
        "slope(s) * twist_slope(rate, from_axis(p, axis) + abs(d) / twist_slope(rate, from_axis(p, axis)))";
    assert_eq!(text.matches(promise).count(), 1);
    let replaced = vec![(name.to_string(), text.replace(promise, "slope(s)"))];
    let wrong = tried(&site, 100, &Options { replaced, ..Options::default() });
    assert!(wrong.wrong.len() > 5, "{} of {} steps are caught", wrong.wrong.len(), wrong.pairs);
}
