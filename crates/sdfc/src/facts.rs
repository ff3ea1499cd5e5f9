//! What is proved of a scene's shapes, as a table; and below it how many copies of what is repeated each point asks, and why.

use sdf_ir::region::Extent;
use sdfc::{Basis, Class, Copies, Fact};

/// The table: a row a shape, what it is made from below it.
pub fn table(facts: &[Fact]) -> String {
    let head = ["shape", "line", "class", "slope", "from", "box", "depends on", "operations"];
    let mut rows = vec![head.map(String::from).to_vec()];
    rows.extend(facts.iter().map(row));
    let columns = head.len();
    let widths: Vec<usize> =
        (0..columns).map(|i| rows.iter().map(|row| row[i].chars().count()).max().unwrap_or(0)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_string() + "\n"
    };
    let table: String = rows.iter().map(line).collect();
    table + &repetitions(facts)
}

/// The copies of each repetition that each point asks, and why so many; nothing if there are no repetitions.
fn repetitions(facts: &[Fact]) -> String {
    let lines = facts.iter().flat_map(|fact| {
        fact.copies.iter().map(|copies| {
            let place = fact.line.map_or(String::new(), |line| format!(" (line {line})"));
            format!("  {}{place}: {}\n", fact.name, reason(copies))
        })
    });
    let lines: String = lines.collect();
    match lines.is_empty() {
        true => lines,
        false => format!("copies that each point asks, since they may be the nearest to it:\n{lines}"),
    }
}

/// Copies of width w with the period P can be nearest only among the ceil(w/P) + 1 nearest ones.
fn reason(copies: &Copies) -> String {
    let Copies { direction, asked, of, width, period, mirrored } = copies;
    let (size, step) = match direction.starts_with("around") {
        true => (format!("{}°", short(width.to_degrees())), format!("{}°", short(period.to_degrees()))),
        false => (short(*width), short(*period)),
    };
    let of = if of.is_finite() { format!(" of {}", short(*of)) } else { String::new() };
    let proof = match (mirrored, asked < &copies.of) {
        (true, _) => "its own mirror image".to_string(),
        (false, true) => format!("ceil({size} / {step}) + 1"),
        (false, false) => "all".to_string(),
    };
    format!("{asked}{of} {direction}, {proof}: the shape is {size} wide and the period {step}")
}

fn row(fact: &Fact) -> Vec<String> {
    let class = match fact.class {
        Class::Exact => "exact",
        Class::Bound => "bound",
        Class::Steep => "steep",
    };
    let from = match fact.basis {
        Basis::Library => "library".to_string(),
        Basis::Stated(line) => format!("line {line}"),
        Basis::Derived => "derived".to_string(),
        Basis::Parts => "parts".to_string(),
    };
    vec![
        format!("{}{}", "  ".repeat(fact.depth), fact.name),
        fact.line.map_or("-".into(), |line| line.to_string()),
        format!("{class}{}", if fact.is_convex { " convex" } else { "" }),
        slope(fact),
        from,
        extent(&fact.extent, fact.is_flat),
        if fact.depends_on.is_empty() { "-".into() } else { fact.depends_on.join(" ") },
        fact.operations.to_string(),
    ]
}

/// The slope over the box; and in parentheses that over all of space, where it is another.
fn slope(fact: &Fact) -> String {
    let number = |x: f64| if x.is_infinite() { "unbounded".to_string() } else { short(x) };
    let (here, everywhere) = (number(fact.slope), number(fact.slope_everywhere));
    if here == everywhere { here } else { format!("{here} ({everywhere} everywhere)") }
}

fn extent(extent: &Extent, is_flat: bool) -> String {
    if extent.is_empty() {
        return "nothing".into();
    }
    let side = |i: usize| {
        let end = |x: f64| if x.is_infinite() { "∞".to_string() } else { short(x.abs()) };
        let sign = |x: f64| if x < 0.0 && end(x) != "0" { "-" } else { "" };
        let (lo, hi) = (extent.lo[i], extent.hi[i]);
        format!("{}{}..{}{}", sign(lo), end(lo), sign(hi), end(hi))
    };
    (0..if is_flat { 2 } else { 3 }).map(side).collect::<Vec<_>>().join(" ")
}

/// A number with as many digits as a reader wants.
pub fn short(x: f64) -> String {
    let digits = (3 - x.abs().max(1e-3).log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{x:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [(0.0, "0"), (1.0, "1"), (0.25, "0.25"), (12.3456, "12.35"), (123456.7, "123457")] {
            assert_eq!(short(x), text);
        }
    }

    #[test]
    fn copies_are_counted_with_the_reason() {
        let copies = |direction: &str, asked, of, width, period| Copies {
            direction: direction.into(),
            asked,
            of,
            width,
            period,
            mirrored: false,
        };
        assert_eq!(
            reason(&copies("along x", 2.0, f64::INFINITY, 0.46, 1.3)),
            "2 along x, ceil(0.46 / 1.3) + 1: the shape is 0.46 wide and the period 1.3"
        );
        assert_eq!(
            reason(&copies("around axis", 5.0, 5.0, std::f64::consts::TAU, std::f64::consts::TAU / 5.0)),
            "5 of 5 around axis, all: the shape is 360° wide and the period 72°"
        );
    }

    #[test]
    fn boxes_tell_where_they_end() {
        let inf = f64::INFINITY;
        let plane = Extent { lo: [-inf; 3], hi: [inf, 0.0, inf] };
        assert_eq!(extent(&plane, false), "-∞..∞ -∞..0 -∞..∞");
        assert_eq!(extent(&Extent { lo: [-1.5, 2.0, 0.0], hi: [1.5, 3.0, 0.0] }, true), "-1.5..1.5 2..3");
        assert_eq!(extent(&Extent::NONE, false), "nothing");
    }
}
