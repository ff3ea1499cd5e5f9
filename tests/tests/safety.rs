//! No step of a ray passes a surface, in the field of any function of the library: what is proved of the ball of 0.99 of
//! each step, for many random points and many calls of each function.
//!
//! `SAFETY=1000000 UPDATE_TABLES=1 cargo test --release --workspace --test safety` tries that many points, of more calls,
//! and writes `tests/tables/safety.md`; `FUNCTION=twist` tries one function alone.

use rayon::prelude::*;
use sdf_lang::{Options, compiler_files};
use sdf_tests::attack::calls::calls_of;
use sdf_tests::attack::definitions::Definitions;
use sdf_tests::attack::forms::{Form, forms};
use sdf_tests::attack::subject::{Kind, kind_of};
use sdf_tests::safety::second::Files;
use sdf_tests::safety::{Site, Tally, tried};
use sdf_tests::table::Table;
use std::collections::BTreeMap;

/// How many points are tried where nothing else is said.
const POINTS: usize = 10_000;
/// The share of steps that may be undecided.
const UNDECIDED: f64 = 0.01;

fn files() -> Files {
    let forms = forms();
    Files { solids: Definitions::solids(&forms), curves: Definitions::curves(&forms) }
}

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
            let others = calls.subjects.iter();
            sites.extend(others.filter_map(|subject| Site::of(&form.name, &subject.call, kind)));
        } else {
            sites.extend(Site::of(&form.name, example, kind));
        }
    }
    sites
}

/// The steps of all functions, or of one alone, by their names, and of how many calls.
fn tallies(points: usize, only: Option<&str>) -> BTreeMap<String, (usize, Tally)> {
    let forms: Vec<Form> =
        forms().into_iter().filter(|form| only.is_none_or(|name| name == form.name)).collect();
    let varied = points > POINTS;
    let sites: Vec<Site> = forms.par_iter().flat_map_iter(|form| sites(form, varied)).collect();
    let (each, files) = (points.div_ceil(sites.len()), files());
    let found: Vec<(String, Tally)> = sites
        .par_iter()
        .with_max_len(1)
        .map(|site| (site.name.clone(), tried(site, each, &Options::default(), &files)))
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
    let asked = std::env::var("SAFETY").ok();
    let points = asked.as_ref().map_or(POINTS, |count| count.parse().expect("a number of points"));
    let only = std::env::var("FUNCTION").ok();
    let tallies = tallies(points, only.as_deref());
    let mut table = about(points);
    let (mut calls, mut all) = (0, Tally::default());
    for (name, (own, tally)) in tallies {
        table.rows.push(row(name, own, &tally));
        (calls, all) = (calls + own, all.and(tally));
    }
    table.rows.push(row("all".into(), calls, &all));
    println!("{}", table.markdown());
    let some = |list: &[(String, [f64; 3], f64)]| -> Vec<String> {
        list.iter().take(20).map(|(call, at, share)| format!("{call} at {at:?}: {share}")).collect()
    };
    let wrong = some(&all.wrong);
    assert!(wrong.is_empty(), "{} of {} steps pass a surface: {wrong:#?}", all.wrong.len(), all.pairs);
    let share = all.undecided.len() as f64 / all.pairs as f64;
    let undecided = some(&all.undecided);
    println!("{} of {} steps are undecided: {undecided:#?}", all.undecided.len(), all.pairs);
    assert!(
        share <= UNDECIDED,
        "{} of {} steps are undecided: {undecided:#?}",
        all.undecided.len(),
        all.pairs
    );
    if asked.is_some()
        && only.is_none()
        && let Some(stale) = table.check("safety.md")
    {
        panic!("{stale}");
    }
}

/// The row of so many calls.
fn row(name: String, calls: usize, tally: &Tally) -> Vec<String> {
    let [field, inequalities, points] = tally.safe;
    let counts = [calls, tally.pairs, field, inequalities, points, tally.wrong.len(), tally.undecided.len()];
    let least = format!("{:.2}", tally.least_free());
    [name].into_iter().chain(counts.map(|n| n.to_string())).chain([least]).collect()
}

/// The table of a run of so many points, without its rows.
fn about(points: usize) -> Table {
    let columns = [
        "function",
        "calls",
        "pairs",
        "by field",
        "by inequalities",
        "by points",
        "unsafe",
        "undecided",
        "least free share",
    ];
    Table {
        title: "Safety of steps".into(),
        about: "Steps from random points in the fields of calls of each function of the library; `tests/tests/safety.rs` \
                writes this.\nA step is safe if there is certainly no surface within 0.99 of it: no zero of the field as it \
                is compiled, or no zero\nof the inequalities in `tests/solids.sdf`, or none of the points in \
                `tests/curves.sdf`, which say a second time what the\nshapes are. It is unsafe if there is a surface, and \
                undecided if neither is proved. The least free share is that of a\nstep within which there certainly is \
                no zero of the field, of all steps that are not safe."
            .into(),
        versions: vec![format!("sdfc {}", sdfc::VERSION), format!("SAFETY={points}")],
        columns: columns.map(String::from).to_vec(),
        ..Table::default()
    }
}

/// A library that promises too much is caught: a twist that says it is no steeper than what it twists.
#[test]
fn a_promise_that_is_too_good_is_caught() {
    let call = "box((0.5, 0.9, 0.2)).at(0.3, 0.2, -0.1).twist(2)";
    let files = files();
    let site = Site::of("twist", call, Kind::Solid).expect("a shape");
    let right = tried(&site, 100, &Options::default(), &files);
    assert_eq!(right.wrong, [], "{call}");
    let (name, text) = compiler_files().find(|(name, _)| *name == "bend.sdf").expect("a file of the library");
    let promise =
        "slope(s) * twist_slope(rate, from_axis(p, axis) + abs(d) / twist_slope(rate, from_axis(p, axis)))";
    assert_eq!(text.matches(promise).count(), 1);
    let replaced = vec![(name.to_string(), text.replace(promise, "slope(s)"))];
    let wrong = tried(&site, 100, &Options { replaced, ..Options::default() }, &files);
    assert!(wrong.wrong.len() > 5, "{} of {} steps are caught", wrong.wrong.len(), wrong.pairs);
}
