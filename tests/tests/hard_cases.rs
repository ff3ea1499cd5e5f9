//! The hard cases of `tests/hard/`, each on every execution and beside its naive twin, which must fail. What came of it
//! stands in `tests/tables/hard_cases.md`. With `HARD=long` the pictures are larger and sweeps are whole, so that a million
//! pixels are certified; that stands in `tests/tables/hard_cases_long.md`.
//!
//! Where the environment's `ADAPTER` names a device, the executions are the interpreter and that device alone; the tables
//! then have its name in theirs.

use rayon::prelude::*;
use sdf_emit::KernelLanguage;
use sdf_tests::adapter;
use sdf_tests::canvas::Canvas;
use sdf_tests::chromium::Browser;
use sdf_tests::hard::{Effort, Execution, Fixture, Outcome, Score, VALUES, fixtures};
use sdf_tests::swiftshader;
use sdf_tests::table::Table;

/// The program that computes in a process of its own.
const COMPUTE: &str = env!("CARGO_BIN_EXE_compute");

/// How many pixels must be certified in all.
const SHORT: usize = 100_000;
const LONG: usize = 1_000_000;

const WGSL: KernelLanguage = KernelLanguage::Wgsl;
const GLSL: KernelLanguage = KernelLanguage::Glsl450;

/// The executions that a fixture asks for; without a canvas no other clients than the device.
fn executions<'a>(fixture: &Fixture, canvas: Option<&'a Canvas>) -> Vec<Execution<'a>> {
    let mut all = vec![Execution::Interpreter, Execution::Adapter(WGSL), Execution::Adapter(GLSL)];
    let Some(canvas) = canvas else { return all };
    for client in &fixture.also {
        match client.as_str() {
            "SwiftShader" => all.extend([WGSL, GLSL].map(|it| Execution::SwiftShader(COMPUTE, it))),
            "Chromium" => all.push(Execution::Chromium(canvas)),
            other => panic!("{}: `{other}` is no client", fixture.name),
        }
    }
    all
}

/// Runs the cases whose names begin with what the environment's `CASE` says, if anything.
fn run(effort: Effort, table_name: &str, least: usize) {
    let browser = (!adapter::is_chosen()).then(Browser::start);
    let canvas = browser.as_ref().map(Canvas::new);
    let mut table = about(browser.as_ref());
    let only = std::env::var("CASE").unwrap_or_default();
    let (mut complaints, mut certified) = (String::new(), 0);
    let mut fixtures = fixtures();
    fixtures.retain(|fixture| fixture.name.starts_with(&only));
    // A browser takes one after the other.
    let outcomes: Vec<Outcome> = match &canvas {
        Some(canvas) => {
            let outcome = |it| Outcome::of(it, effort, &executions(it, Some(canvas)));
            fixtures.iter().map(outcome).collect()
        }
        None => fixtures.par_iter().map(|it| Outcome::of(it, effort, &executions(it, None))).collect(),
    };
    for (fixture, outcome) in fixtures.iter().zip(outcomes) {
        complaints += &outcome.complaints;
        for (name, score) in &outcome.scores {
            certified += score.certified;
            table.rows.push(row(&fixture.name, name, score));
        }
        if let (Some(naive), Some(score)) = (&fixture.twin, &outcome.twin) {
            table.rows.push(row(
                &fixture.name,
                &format!("*twin: {}, on {}*", naive.twin, naive.client),
                score,
            ));
        }
    }
    println!("{}{certified} certified", table.markdown());
    let stale = if only.is_empty() { table.check(&adapter::table(table_name)) } else { None };
    assert!(complaints.is_empty(), "{complaints}");
    assert_eq!(stale, None);
    assert!(certified >= least || !only.is_empty(), "{certified} pixels were certified");
}

fn row(case: &str, execution: &str, score: &Score) -> Vec<String> {
    let counts = [score.certified, score.false_hits, score.false_misses, score.ambiguous, score.out_of_steps];
    let mut cells = vec![case.to_owned(), execution.to_owned()];
    cells.extend(counts.map(|count| count.to_string()));
    cells.extend([format!("{:.2}", score.late), format!("{:.3}", score.turn)]);
    cells.extend([score.not_finite, score.colours + score.lights].map(|count| count.to_string()));
    cells
}

/// The tests of cases of which values matter, as a table.
fn values() -> String {
    let row = |(number, suite, test): &(u32, &str, &str)| format!("| {number} | `{suite}::{test}` |\n");
    format!("| case | test of its values |\n| --- | --- |\n{}", VALUES.iter().map(row).collect::<String>())
}

/// The table without its rows; without a browser no other clients than the device are run.
fn about(browser: Option<&Browser>) -> Table {
    let others = browser.map(|browser| [swiftshader::version(COMPUTE), browser.version()]);
    let left_out = match browser {
        Some(_) => String::new(),
        None => format!(
            "Here the shaders ran on {} alone, chosen by `ADAPTER`;\nother drivers and browsers are left out. ",
            adapter::title()
        ),
    };
    let columns = [
        "case",
        "execution",
        "certified",
        "false hits",
        "false misses",
        "ambiguous",
        "out of steps",
        "depth",
        "normal",
        "not finite",
        "colour or light",
    ];
    Table {
        title: "Hard cases".into(),
        about: left_out
            + &"The scenes in `tests/hard/`; `tests/tests/hard_cases.rs` writes this. Each pixel's ray has a certified first \
                hit, by interval\\narithmetic, against which what was seen is judged. *depth* is the largest distance \
                between a hit and the surface, in tolerances\\nalong the normal; *normal* the largest error of a \
                normal in degrees, on creases to the nearest of its sides. A twin is the case\\nwithout a guard, on the \
                interpreter: it must fail.\\n\\n"
            .replace("\\n", "\n")
            + values().trim_end(),
        versions: [adapter::version()].into_iter().chain(others.into_iter().flatten()).collect(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: Vec::new(),
    }
}

#[test]
fn every_case_is_right_and_its_twin_is_not() {
    match std::env::var("HARD").as_deref() {
        Err(_) => run(Effort::Short, "hard_cases", SHORT),
        Ok("long") => run(Effort::Long, "hard_cases_long", LONG),
        Ok(other) => panic!("`HARD` is `long` or is not there, and not `{other}`"),
    }
}

/// Each of the 38 cases has pictures or a test of its values, and those tests are there.
#[test]
fn no_case_is_missing() {
    let pictured: Vec<u32> = fixtures().iter().map(Fixture::number).collect();
    let missing = |number: &u32| !pictured.contains(number) && VALUES.iter().all(|(n, ..)| n != number);
    let missing: Vec<u32> = (1..=38).filter(missing).collect();
    assert!(missing.is_empty(), "{missing:?}");
    for (_, suite, test) in VALUES {
        let path = format!("{}/tests/{suite}.rs", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert!(text.contains(&format!("#[test]\nfn {test}()")), "{path} has no {test}");
    }
}
