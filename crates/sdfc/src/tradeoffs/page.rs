//! What was measured, for people.

use sdfc::tradeoff::{Row, Tradeoffs};

/// The name of a column, and what stands in it.
pub type Column = (&'static str, fn(&Row) -> String);

pub const COLUMNS: [Column; 14] = [
    ("ms", |r| r.time.map_or("-".into(), |t| format!("{:.1}", t.median.as_secs_f64() * 1e3))),
    ("±", |r| r.time.map_or("-".into(), |t| format!("{:.1}", t.spread.as_secs_f64() * 1e3))),
    ("evaluations", |r| format!("{:.1}", r.evaluations)),
    ("steps", |r| format!("{:.1}", r.steps)),
    ("lost", |r| r.errors.out_of_steps.to_string()),
    ("false hits", |r| r.errors.false_hits.to_string()),
    ("misses", |r| r.errors.false_misses.to_string()),
    ("depth px", |r| format!("{:.1e}", r.errors.depth[0])),
    ("99.9 %", |r| format!("{:.1e}", r.errors.depth[1])),
    ("most", |r| format!("{:.1e}", r.errors.depth[2])),
    ("normal", |r| format!("{:.3}°", r.errors.normal[1])),
    ("flicker", |r| r.errors.flicker.to_string()),
    ("rms", |r| format!("{:.3}", r.errors.rms)),
    ("aliasing", |r| format!("{:.3}", r.errors.aliasing)),
];

/// The table of all settings.
pub fn page(name: &str, measured: &Tradeoffs) -> String {
    let mut lines: Vec<Vec<String>> =
        vec![[name.to_string()].into_iter().chain(COLUMNS.map(|(head, _)| head.to_string())).collect()];
    for row in &measured.rows {
        let mark = if row.on_frontier { "* " } else { "  " };
        let first = format!("{mark}{}", row.setting.name);
        lines.push([first].into_iter().chain(COLUMNS.map(|(_, show)| show(row))).collect());
    }
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..=COLUMNS.len()).map(width).collect();
    let mut out = String::new();
    for line in &lines {
        out.push_str(&format!("{:<width$}", line[0], width = widths[0]));
        for (cell, width) in line.iter().zip(&widths).skip(1) {
            out.push_str(&format!("  {cell:>width$}"));
        }
        out.push('\n');
    }
    out
}
