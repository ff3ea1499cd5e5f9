//! No step of a ray passes a surface, in the field of any function of the library: what is proved of the ball of 0.99 of
//! each step, for many random points and many calls of each function.
//!
//! `SAFETY=1000000 UPDATE_TABLES=1 cargo test --release --workspace --test safety` tries that many points and writes
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
const POINTS: usize = 10_000;
/// How many of the steps may be undecided.
const UNDECIDED: f64 = 0.01;

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
    let only = std::env::var("FUNCTION").ok();
    let forms: Vec<Form> =
        forms().into_iter().filter(|form| only.as_ref().is_none_or(|name| *name == form.name)).collect();
    let varied = points > POINTS;
    let sites: Vec<(String, Site)> = forms
        .par_iter()
        .flat_map_iter(|form| sites(form, varied).into_iter().map(|site| (form.name.clone(), site)))
        .collect();
    let each = points.div_ceil(sites.len());
    let found: Vec<(String, Tally)> = sites
        .par_iter()
        .map(|(name, site)| {
            let t = std::time::Instant::now();
            let r = (name.clone(), tried(site, each, &Options::default()));
            println!(
                "@@ {:.3} {} u{} w{} {}",
                t.elapsed().as_secs_f64(),
                name,
                r.1.undecided.len(),
                r.1.wrong.len(),
                site.call
            );
            r
        })
        .collect();
    let mut tallies = BTreeMap::new();
    for (name, tally) in found {
        let entry: &mut (usize, Tally) = tallies.entry(name).or_default();
        *entry = (entry.0 + 1, std::mem::take(&mut entry.1).and(tally));
    }
    tallies
}

#[test]
fn no_step_passes_a_surface() {
    let points = std::env::var("SAFETY").map_or(POINTS, |count| count.parse().expect("a number of points"));
    let tallies = tallies(points);
    for (name, (calls, tally)) in &tallies {
        let (pairs, wrong, undecided) = (tally.pairs, tally.wrong.len(), tally.undecided.len());
        println!("{name:<20} {calls:>3} {pairs:>8} {wrong:>6} {undecided:>6} {:.2}", tally.least_free());
        for (call, at, share) in tally.wrong.iter().chain(&tally.undecided).take(4) {
            println!("    {call} at {at:?}: {share}");
        }
    }
}
