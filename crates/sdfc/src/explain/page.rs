//! What there is to say of a scene, for people at a terminal.

use crate::doc::hanging;
use crate::explain::explanation::{Box, Explained, Explanation, Place, Price, Repeated, Shape, Share};
use crate::terminal::{GREEN, RESET};

/// How many characters a name has room for before its numbers.
const NAME: usize = 40;
/// From which on a slope is told as unbounded: it is that of the farthest place that has coordinates.
const ENDLESS: f64 = 1e6;
/// How many shapes are shown, the dearest ones.
const SHAPES: usize = 40;

/// The page of a scene.
pub fn page(explanation: &Explanation) -> String {
    let mut out = head(explanation);
    out += &effects_in(explanation);
    out += &effects_out(explanation);
    out += &shapes(explanation);
    out
}

fn head(explanation: &Explanation) -> String {
    let Explanation { scene, size: (width, height), time, set, evaluations, operations, .. } = explanation;
    let quality = explanation.quality.map_or_else(String::new, |quality| format!(", quality {quality}"));
    let set: String = set.iter().map(|set| format!(", {} = {}", set.name, set.value)).collect();
    let mut out = format!("{GREEN}{scene}{RESET}: {width}x{height} pixels at {time} s{quality}{set}\n\n");
    let text = format!(
        "A pixel evaluates the scene's field {} times in the mean, and {} times at most. One evaluation of the distance \
         takes up to {operations} operations.",
        decimal(evaluations.mean),
        evaluations.most
    );
    out += &hanging("", 0, &text);
    if let Some(timing) = &explanation.timing {
        let (width, height) = timing.size;
        let text = format!(
            "A picture of {width}x{height} takes {} ms on {}, by {}, in the median of {} rounds.",
            decimal(timing.milliseconds),
            timing.device,
            timing.clock,
            timing.rounds
        );
        out += &hanging("", 0, &text);
    }
    out
}

fn effects_in(explanation: &Explanation) -> String {
    let has_times = explanation.timing.is_some();
    let time = if has_times { "time" } else { "" };
    let mut out = format!("\n{:<NAME$}{:>14}{:>10}{time:>24}", "In the program", "evaluations", "at most");
    end(&mut out);
    for effect in explanation.effects.iter().filter(|effect| effect.is_in) {
        out += &row(
            &title(effect),
            &effect.price.as_ref().map_or_else(cells_of_nothing, |p| cells(p, has_times)),
        );
        out += &reason(effect);
    }
    let rest = &explanation.rest;
    let cells = [
        decimal(rest.evaluations.mean),
        rest.evaluations.most.to_string(),
        rest.time.map_or_else(|| missing(has_times), |share| percent(&share)),
    ];
    out += &row("everything else", &cells);
    let text =
        "the scene without all of these but what is of the march: rays, normals, materials, plain light";
    out += &hanging("    ", 4, text);
    out + &hanging(
        "",
        0,
        "What an effect takes is the difference to the scene without it; what several share is part of none, or of each.",
    )
}

/// What an effect is called, and whose it is.
fn title(effect: &Explained) -> String {
    match (&effect.subject, effect.count) {
        (None, _) => effect.name.to_string(),
        (Some(subject), 0 | 1) => format!("{} of `{subject}`", effect.name),
        (Some(subject), count) => format!("{} of {count} `{subject}`", effect.name),
    }
}

/// A name and three columns of numbers.
fn row(name: &str, [mean, most, time]: &[String; 3]) -> String {
    let shown: String = format!("  {name}");
    let mut out = format!("{GREEN}{shown:<NAME$}{RESET}");
    // A long name has the line for itself.
    if shown.chars().count() > NAME {
        out += &format!("\n{:<NAME$}", "");
    }
    out += &format!("{mean:>14}{most:>10}{time:>24}");
    end(&mut out);
    out
}

fn cells(price: &Price, has_times: bool) -> [String; 3] {
    let saved = |is_saved: bool, text: String| if is_saved { format!("saves {text}") } else { text };
    let mean = decimal(price.evaluations.mean.abs());
    [
        saved(price.evaluations.mean < 0.0 && mean != "0.0", mean),
        saved(price.evaluations.most < 0, price.evaluations.most.abs().to_string()),
        price.time.map_or_else(|| missing(has_times), |share| percent(&share)),
    ]
}

/// Inputs take nothing.
fn cells_of_nothing() -> [String; 3] {
    ["-".into(), "-".into(), String::new()]
}

/// There was no time for it, or none was taken.
fn missing(has_times: bool) -> String {
    if has_times { "not measured".into() } else { String::new() }
}

/// A share of the time with its quartiles; one below 0 is saved.
fn percent(share: &Share) -> String {
    let number = |x: f64| {
        let text = format!("{:.0}", x * 100.0);
        if text == "-0" { "0".to_string() } else { text }
    };
    match number(share.share).starts_with('-') {
        true => {
            let [middle, from, to] = [-share.share, -share.to, -share.from].map(number);
            format!("saves {middle} % ({from} to {to})")
        }
        false => {
            let [middle, from, to] = [share.share, share.from, share.to].map(number);
            format!("{middle} % ({from} to {to})")
        }
    }
}

/// The line that calls for an effect, and what would take it out.
fn reason(effect: &Explained) -> String {
    let mut text = effect.reason.clone();
    if let Some(set) = &effect.removed_by {
        text += &format!("; `--set {}={}` removes it", set.name, set.value);
    }
    hanging("    ", 4, &placed(effect.place.as_ref(), &text))
}

fn placed(place: Option<&Place>, text: &str) -> String {
    match place {
        Some(Place { file, line, .. }) => format!("{file}:{line}: {text}"),
        None => text.to_string(),
    }
}

fn effects_out(explanation: &Explanation) -> String {
    let out: Vec<&Explained> = explanation.effects.iter().filter(|effect| !effect.is_in).collect();
    if out.is_empty() {
        return String::new();
    }
    let width = out.iter().map(|effect| title(effect).chars().count()).max().unwrap_or(0).min(NAME);
    let lines = out.into_iter().map(|effect| {
        let heading = format!("  {GREEN}{:<width$}{RESET}  ", title(effect));
        hanging(&heading, width + 4, &placed(effect.place.as_ref(), &effect.reason))
    });
    format!("\nNot in it\n{}", lines.collect::<String>())
}

fn shapes(explanation: &Explanation) -> String {
    let shapes = &explanation.shapes;
    let mut dearest: Vec<usize> = (0..shapes.len()).collect();
    dearest.sort_by(|a, b| shapes[*b].share.total_cmp(&shapes[*a].share).then(a.cmp(b)));
    let left = dearest.split_off(dearest.len().min(SHAPES));
    dearest.sort_unstable();
    let mut out =
        format!("\n{:<NAME$}{:>7}{:>10}{:>12}{:>7}", "Shapes", "class", "slope", "operations", "share");
    end(&mut out);
    for shape in dearest.into_iter().map(|i| &shapes[i]) {
        let name = format!("{}{}", "  ".repeat(shape.depth + 1), shape.name);
        let name = shortened(&name, NAME);
        let share = format!("{:.0} %", shape.share * 100.0);
        let slope = slope(shape.slope);
        let place = shape.line.map_or(String::new(), |line| format!("{}:{line}", explanation.scene));
        out += &format!("{GREEN}{name:<NAME$}{RESET}");
        out += &format!("{:>7}{slope:>10}{:>12}{share:>7}  {place}", shape.class, shape.operations);
        end(&mut out);
        let indent = 2 * shape.depth.min(15) + 4;
        out += &hanging(&" ".repeat(indent), indent, &why(shape));
    }
    if let Some(most) = left.iter().map(|i| shapes[*i].operations).max() {
        let text =
            format!("and {} more, each of at most {most} operations; `--json` has them all", left.len());
        out += &hanging("  ", 2, &text);
    }
    out
}

/// The box of a shape, and what makes it dear.
fn why(shape: &Shape) -> String {
    let mut parts = vec![match &shape.extent {
        Some(extent) => format!("box {}", sides(extent)),
        None => "nothing".to_string(),
    }];
    match (shape.slope, shape.slope_everywhere) {
        _ if shape.class != "steep" => {}
        (Some(here), Some(everywhere)) if here == everywhere => {
            parts.push(format!("steps are divided by up to {}", short(here)));
        }
        (here, everywhere) => {
            let (here, everywhere) = (slope(here), slope(everywhere));
            parts.push(format!(
                "steps are divided by up to {here} in its box; elsewhere its slope is {everywhere}"
            ));
        }
    }
    let asked = |copies: &Repeated| {
        let of = copies.of.map_or(String::new(), |of| format!(" of {}", short(of)));
        let word = if copies.asked == 1.0 && copies.of.is_none() { "copy" } else { "copies" };
        format!("{}{of} {word} {}", short(copies.asked), copies.direction)
    };
    if !shape.copies.is_empty() {
        let each: Vec<String> = shape.copies.iter().map(asked).collect();
        parts.push(format!("each point asks {}", each.join(" and ")));
    }
    if !shape.depends_on.is_empty() {
        parts.push(format!("changes with {}", shape.depends_on.join(", ")));
    }
    parts.join("; ")
}

fn sides(extent: &Box) -> String {
    let end = |x: Option<f64>, endless: &str| x.map_or(endless.to_string(), short);
    let sides = extent.lo.iter().zip(&extent.hi);
    sides.map(|(lo, hi)| format!("{}..{}", end(*lo, "-∞"), end(*hi, "∞"))).collect::<Vec<_>>().join(" ")
}

/// A slope; one that no step can be divided by counts as unbounded.
fn slope(x: Option<f64>) -> String {
    x.filter(|x| *x < ENDLESS).map_or("unbounded".into(), short)
}

/// A number with as many digits as a reader wants.
fn short(x: f64) -> String {
    // There is no zero below zero for readers.
    crate::facts::short(x + 0.0)
}

/// A number of things in the mean.
fn decimal(x: f64) -> String {
    format!("{x:.1}")
}

fn shortened(text: &str, width: usize) -> String {
    match text.chars().count() > width {
        true => text.chars().take(width - 2).chain(['…', ' ']).collect(),
        false => text.to_string(),
    }
}

/// Ends a line.
fn end(line: &mut String) {
    line.truncate(line.trim_end().len());
    line.push('\n');
}
