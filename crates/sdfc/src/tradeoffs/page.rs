//! What was measured, for people.

use super::why::digits;
use crate::output::aligned;
use crate::terminal::Terminal;
use sdfc::tradeoff::{Bounds, NEAR, Row, Tradeoffs, Truth};

/// The name of a column, and what stands in it.
pub type Column = (&'static str, fn(&Row) -> String);

pub const COLUMNS: [Column; 14] = [
    ("ms", |r| r.time.map_or("-".into(), |t| digits(t.median.as_secs_f64() * 1e3))),
    ("±", |r| r.time.map_or("-".into(), |t| digits(t.spread.as_secs_f64() * 1e3))),
    ("evaluations", |r| format!("{:.1}", r.evaluations)),
    ("steps", |r| format!("{:.1}", r.steps)),
    ("lost", |r| r.errors.out_of_steps.to_string()),
    ("false", |r| format!("{}+{}", r.errors.false_hits, r.errors.false_misses)),
    ("depth px", |r| digits(r.errors.depth[0])),
    ("99.9 %", |r| digits(r.errors.depth[1])),
    ("most", |r| digits(r.errors.depth[2])),
    ("normal", |r| format!("{}°", digits(r.errors.normal[1]))),
    ("flicker", |r| r.errors.flicker.to_string()),
    ("rms", |r| digits(r.errors.rms)),
    ("seen", |r| format!("{:.2} %", 100.0 * r.errors.visible)),
    ("aliasing", |r| digits(r.errors.aliasing)),
];

/// The table of all settings, in groups by what they change.
pub fn page(name: &str, measured: &Tradeoffs, bounds: Bounds) -> String {
    let heads = ["".to_string()].into_iter().chain(COLUMNS.map(|(head, _)| head.to_string()));
    let mut lines: Vec<Vec<String>> = vec![heads.collect()];
    for row in &measured.rows {
        let mark = if row.on_frontier { "*" } else { " " };
        let first = format!("{mark} {}", row.setting.name);
        lines.push([first].into_iter().chain(COLUMNS.map(|(_, show)| show(row))).collect());
    }
    let lines = aligned(&lines);
    let mut out = head(name, measured);
    out.push('\n');
    out.push_str(&lines[0]);
    let mut before = measured.rows.first().map(|row| row.setting.knob);
    for (row, line) in measured.rows.iter().zip(&lines[1..]) {
        if before != Some(row.setting.knob) {
            out.push('\n');
            before = Some(row.setting.knob);
        }
        out.push_str(line);
    }
    out.push('\n');
    out.push_str(&legend(bounds.error.unwrap_or(NEAR)));
    if bounds != Bounds::default() {
        out.push_str(&match bounds.choose(measured) {
            Some(place) => {
                let setting = &measured.rows[place].setting;
                format!("\nWithin the bounds: {}\n  {}\n", setting.name, setting.accuracy)
            }
            None => "\nNo setting is within the bounds.\n".to_string(),
        });
    }
    out
}

/// What was measured, and how.
pub fn head(name: &str, measured: &Tradeoffs) -> String {
    let (width, height) = measured.size;
    let timed = match &measured.timing {
        Some(t) => format!(
            "Times are of {}x{} pixels on {}, by {}, in the median of {} rounds, with how far the quartiles are apart.",
            t.size.0, t.size.1, t.device, t.clock, t.rounds
        ),
        None => "No times were taken.".to_string(),
    };
    let proof = proof(&measured.truth);
    let smaller = match &measured.timing {
        Some(timing) if timing.size != measured.size => {
            ", other than are timed, so that comparing ends soon (`--compare`)"
        }
        _ => "",
    };
    format!("{name}: errors are of {width}x{height} pixels{smaller}; {proof}.\n{timed}\n")
}

/// Of how many pixels the truth is proved, as a clause.
pub fn proof(truth: &Truth) -> String {
    let pixels = truth.pixels();
    match truth.undecided() {
        _ if !truth.is_proved => {
            "the truth is computed in 64 bits and not proved, since intervals would take too long or tell nothing here".into()
        }
        0 => "the truth of all pixels is proved".into(),
        1 => format!("the truth of 1 of {pixels} pixels is not proved; it counts nowhere"),
        n => format!("the truth of {n} of {pixels} pixels is not proved; they count nowhere"),
    }
}

/// What the columns and some of the rows are; hits are false beyond `near` pixels.
fn legend(near: f64) -> String {
    format!(
        "\
* no other setting is as fast and as exact, of those that a scene can ask for with as many rays a pixel.
Evaluations of the field are of all of a pixel's rays, steps of that from the eye. lost: out of steps. false: hits of what the ray
does not meet, with no surface within {near} px, and misses of what it meets. depth: how far hits are from the surface, in px along
the normal. normal: what 99 % of the normals are off at most. flicker: pixels that change as the true ones do not when the camera
moves by 0.01 px. rms: to the true colours of the same rays, in codes of 255. seen: pixels that are off by more than 4 codes.
aliasing: rms to the mean of each pixel's area. Estimates from one pixel in sixteen: aliasing; and of settings with several rays a
pixel flicker, rms and seen.
For comparison alone: factors make each step that share of the distance, in place of the correction that is derived from the slopes,
of which the safe one is proved; coordinates are relative to the world or the camera, of which one is chosen else.
"
    )
}

/// Says that the device is not what was preferred, where that is so.
pub fn note_fallback(measured: &Tradeoffs, terminal: &Terminal) {
    if let Some(why) = measured.timing.as_ref().and_then(|timing| timing.fallback.as_ref()) {
        terminal.note(&format!("timed on the CPU: {}", why.lines().next().unwrap_or_default()));
    }
}
