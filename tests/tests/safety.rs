//! No step of a ray passes a surface, in the field of any function of the library: what is proved of the ball of 0.99 of
//! each step, for many random points and many calls of each function.
//!
//! `SAFETY=long UPDATE_TABLES=1 cargo test --release --workspace --test safety` tries a million points, of more calls, on all
//! processors, and writes `tests/tables/safety_long.md`; else that is `safety.md`. `FUNCTION=twist` tries one function alone,
//! and `POINTS=30000` another number of points; then there is no table.

use rayon::prelude::*;
use sdf_lang::{Options, compiler_files};
use sdf_tests::attack::calls::calls_of;
use sdf_tests::attack::definitions::Definitions;
use sdf_tests::attack::forms::{Form, forms};
use sdf_tests::attack::subject::{Kind, kind_of};
use sdf_tests::march::clock::spent;
use sdf_tests::safety::second::Files;
use sdf_tests::safety::{Site, Tally, tried};
use sdf_tests::table::Table;
use std::collections::BTreeMap;

/// How many points are tried.
const SHORT: usize = 10_000;
const LONG: usize = 1_000_000;
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

/// The steps of all functions, or of one alone, by their names, and of how many calls: the examples alone, or others as
/// well.
fn tallies(points: usize, varied: bool, only: Option<&str>) -> BTreeMap<String, (usize, Tally)> {
    let forms: Vec<Form> =
        forms().into_iter().filter(|form| only.is_none_or(|name| name == form.name)).collect();
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
    let (long, file) = match std::env::var("SAFETY").as_deref() {
        Err(_) => (false, "safety.md"),
        Ok("long") => (true, "safety_long.md"),
        Ok(other) => panic!("`SAFETY` is `long` or is not there, and not `{other}`"),
    };
    let asked = std::env::var("POINTS").ok().map(|count| count.parse().expect("a number of points"));
    let points = asked.unwrap_or(if long { LONG } else { SHORT });
    let only = std::env::var("FUNCTION").ok();
    let before = spent();
    let tallies = tallies(points, long, only.as_deref());
    let seconds = spent() - before;
    let mut table = about(points, long);
    let (mut calls, mut all) = (0, Tally::default());
    for (name, (own, tally)) in tallies {
        table.rows.push(row(name, own, &tally));
        (calls, all) = (calls + own, all.and(tally));
    }
    table.rows.push(row("all".into(), calls, &all));
    println!("{}", table.markdown());
    println!("{:.3} ms of all processors for a pair", seconds * 1e3 / all.pairs as f64);
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
    if asked.is_none()
        && only.is_none()
        && let Some(stale) = table.check(file)
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

/// The table of a run of about so many points, in examples alone or in other calls as well, without its rows.
fn about(points: usize, varied: bool) -> Table {
    let (calls, asked) = match varied {
        true => ("its examples and calls like them", "; SAFETY=long"),
        false => ("its examples", ""),
    };
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
        about: format!(
            "Steps from {points} random points in the fields of each function of the library, in {calls};\n\
             `tests/tests/safety.rs` writes this. A step is safe if there is certainly no surface within 0.99 of it: no \
             zero of the\nfield as it is compiled, or no zero of the inequalities in `tests/solids.sdf`, or none of the \
             points in\n`tests/curves.sdf`, which say a second time what the shapes are. It is unsafe if there is a \
             surface, and undecided if\nneither is proved. The least free share is that of a step within which there \
             certainly is no zero of the field, of all steps\nthat are not safe."
        ),
        versions: vec![format!("sdfc {}{asked}", sdfc::VERSION)],
        columns: columns.map(String::from).to_vec(),
        ..Table::default()
    }
}

/// One thread finds what several find.
#[test]
fn threads_change_nothing() {
    let files = files();
    let site = Site::of("bend", "box((0.5, 0.9, 0.2)).bend(1.1)", Kind::Solid).expect("a shape");
    let found = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| tried(&site, 300, &Options::default(), &files))
    });
    assert_eq!(found[0].pairs, 300);
    assert_eq!(found[0], found[1]);
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
