//! What each step from a setting to the exact one costs and buys.

use sdfc::tradeoff::{Errors, Row, Tradeoffs};

/// An error as it is told: its words, how it is read, and its unit.
type Told = (&'static str, fn(&Errors) -> f64, &'static str);

/// What is told of a step where it changes.
const TOLD: [Told; 9] = [
    ("false hits", |e| e.false_hits as f64, ""),
    ("false misses", |e| e.false_misses as f64, ""),
    ("out of steps", |e| e.out_of_steps as f64, ""),
    ("depth error", |e| e.depth[1], " px"),
    ("largest", |e| e.depth[2], " px"),
    ("normal error", |e| e.normal[1], "°"),
    ("flicker", |e| e.flicker as f64, ""),
    ("rms", |e| e.rms, ""),
    ("aliasing", |e| e.aliasing, ""),
];

/// The walk: where it begins, a line for each step, and what all of it comes to.
pub fn page(name: &str, measured: &Tradeoffs) -> String {
    let rows = &measured.rows;
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return String::new() };
    let mut lines = vec![format!("{name}: from `{}` to `exact`, a setting at a time", first.setting.name)];
    lines.push(format!("  {}", first.setting.accuracy));
    let width = rows.iter().map(|row| row.setting.name.chars().count()).max().unwrap_or(0).max(8);
    let line = |name: &str, from: &Row, to: &Row| {
        format!("  {name:<width$}  {:>18}  {}", cost(from, to), bought(&from.errors, &to.errors))
    };
    if rows.len() == 1 {
        lines.push("  it is exact already: there is no step to take".into());
    }
    for pair in rows.windows(2) {
        lines.push(line(&pair[1].setting.name, &pair[0], &pair[1]));
    }
    if rows.len() > 2 {
        lines.push(line("together", first, last));
    }
    lines.join("\n") + "\n"
}

/// What a step costs: the change of the time, with how far the quartiles are off, else of the evaluations.
pub fn cost(from: &Row, to: &Row) -> String {
    match (from.time, to.time) {
        (Some(a), Some(b)) => {
            let ratio = |quartile: usize| b.ratio[quartile] / a.ratio[1] - 1.0;
            let off = (ratio(2) - ratio(0)).abs() / 2.0;
            format!("{:+.1} % time (±{:.1})", 100.0 * ratio(1), 100.0 * off)
        }
        _ => format!("{:+.1} % evaluations", 100.0 * (to.evaluations / from.evaluations.max(1e-9) - 1.0)),
    }
}

/// What changes by it, as far as three digits show that.
pub fn bought(from: &Errors, to: &Errors) -> String {
    let changes = TOLD.iter().filter_map(|(words, read, unit)| {
        let (a, b) = (digits(read(from)), digits(read(to)));
        (a != b).then(|| format!("{words} {a} → {b}{unit}"))
    });
    let changes: Vec<String> = changes.collect();
    if changes.is_empty() { "changes nothing that can be seen".into() } else { changes.join(", ") }
}

/// A number of at least 0 to two digits, and three behind the point at most.
pub fn digits(x: f64) -> String {
    let text = match x {
        x if x >= 100.0 || x.fract() == 0.0 => format!("{x:.0}"),
        x if x >= 10.0 => format!("{x:.1}"),
        x if x >= 1.0 => format!("{x:.2}"),
        x => format!("{x:.3}"),
    };
    if text == "0.000" { "<0.001".into() } else { text }
}
