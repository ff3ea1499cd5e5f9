//! What each step from a setting to the exact one costs and buys.

use super::page::head;
use sdfc::tradeoff::{Errors, Row, Tradeoffs};

/// An error as it is told: its words, how it is read, and its unit.
type Told = (&'static str, fn(&Errors) -> String, &'static str);

/// What is told of a step where it changes.
const TOLD: [Told; 9] = [
    ("false hits", |e| e.false_hits.to_string(), ""),
    ("false misses", |e| e.false_misses.to_string(), ""),
    ("out of steps", |e| e.out_of_steps.to_string(), ""),
    ("depth error", |e| digits(e.depth[1]), " px"),
    ("largest", |e| digits(e.depth[2]), " px"),
    ("normal error", |e| digits(e.normal[1]), "°"),
    ("flicker", |e| e.flicker.to_string(), ""),
    ("rms", |e| digits(e.rms), ""),
    ("aliasing", |e| digits(e.aliasing), ""),
];

/// The walk: where it begins, a line for each step, and what all of it comes to.
pub fn page(name: &str, measured: &Tradeoffs) -> String {
    let rows = &measured.rows;
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return String::new() };
    let mut out = head(name, measured);
    out += &format!("\nFrom `{}` to `exact`, a setting at a time:\n", first.setting.name);
    out += &format!("  {}\n", first.setting.accuracy);
    let width = rows.iter().map(|row| row.setting.name.chars().count()).max().unwrap_or(0).max(8);
    let line = |name: &str, cost: String, from: &Row, to: &Row| {
        format!("  {name:<width$}  {cost:>20}  {}\n", bought(&from.errors, &to.errors))
    };
    if rows.len() == 1 {
        out += "  it is exact already: there is no step to take\n";
    }
    for pair in rows.windows(2) {
        let cost = cost(&pair[0], &pair[1], pair[1].time.map(|time| time.to_previous));
        out += &line(&pair[1].setting.name, cost, &pair[0], &pair[1]);
    }
    if rows.len() > 2 {
        out += &line("together", cost(first, last, last.time.map(|time| time.ratio)), first, last);
    }
    out + "\nWhat a step costs is its time beside that of the one before, in the median of the rounds, and half of what lies \
        between the\nquartiles. 99.9 % of the hits and 99 % of the normals are as near as that; rms and aliasing are of 255.\n"
}

/// What a setting costs beside another one by the quartiles of the ratios of their times, with half of what lies between the outer
/// ones; by evaluations if either has no time.
pub fn cost(from: &Row, to: &Row, ratio: Option<[f64; 3]>) -> String {
    match ratio.filter(|_| from.time.is_some()) {
        Some([low, middle, high]) => {
            format!("{:+.1} % time (±{:.1})", 100.0 * (middle - 1.0), 50.0 * (high - low))
        }
        None => format!("{:+.1} % evaluations", 100.0 * (to.evaluations / from.evaluations.max(1e-9) - 1.0)),
    }
}

/// What changes by it, as far as three digits show that.
pub fn bought(from: &Errors, to: &Errors) -> String {
    let changes = TOLD.iter().filter_map(|(words, read, unit)| {
        let (a, b) = (read(from), read(to));
        (a != b).then(|| format!("{words} {a} → {b}{unit}"))
    });
    let changes: Vec<String> = changes.collect();
    if changes.is_empty() { "changes nothing that can be seen".into() } else { changes.join(", ") }
}

/// A number of at least 0 to three digits, and three behind the point at most.
pub fn digits(x: f64) -> String {
    let text = match x {
        x if x >= 100.0 => format!("{x:.0}"),
        x if x >= 10.0 => format!("{x:.1}"),
        x if x >= 1.0 => format!("{x:.2}"),
        x => format!("{x:.3}"),
    };
    if text == "0.000" && x > 0.0 { "<0.001".into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoffs::sample::presets;

    #[test]
    fn steps_say_what_they_cost_and_buy() {
        let mut measured = presets();
        measured.rows.drain(..2);
        for (i, row) in measured.rows.iter_mut().enumerate() {
            let time = row.time.as_mut().expect("all have times");
            time.ratio = [0.99, 1.0, 1.01].map(|r| r * f64::from(1 << i));
            time.to_previous = [1.98, 2.0, 2.02];
            row.errors.false_hits = 4 >> i;
        }
        let page = page("a.sdf", &measured);
        let lines: Vec<&str> = page.lines().collect();
        let step = lines.iter().position(|line| line.contains("+100.0 % time (±2.0)")).expect("a step");
        assert!(lines[step].contains("false hits 4 → 2"), "{page}");
        let all = lines[step + 2];
        assert!(all.trim_start().starts_with("together") && all.contains("+300.0 % time"), "{page}");
        assert!(all.contains("rms 1.00 → 0.100"), "{page}");
        measured.rows.truncate(1);
        assert!(super::page("a.sdf", &measured).contains("exact already"));
    }

    #[test]
    fn digits_end_where_they_say_nothing() {
        let texts = [123.4, 12.34, 1.234, 0.1234, 0.0001, 0.0].map(digits);
        assert_eq!(texts, ["123", "12.3", "1.23", "0.123", "<0.001", "0.000"]);
    }
}
