//! The errors of all settings against their times, as SVG. The same figures give the same bytes.

use super::axis::{Axis, LEAST, Stripe};
use super::labels::{Label, Placed, Rect, place};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use sdf_emit::html::visible;
use sdfc::tradeoff::{Knob, Row, Tradeoffs};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

/// The size of the plot, and where its parts begin, in pixels.
pub const SIZE: (u32, u32) = (1040, 600);
const TITLE: (i32, i32) = (100, 24);
const PLOT: Rect = Rect { left: 100, top: 60, right: 790, bottom: 540 };
const ACROSS: (i32, i32) = (PLOT.left, PLOT.right);
const UP: (i32, i32) = (PLOT.bottom, PLOT.top);
const LEGEND: (i32, i32) = (812, 72);
const LINE: i32 = 22;

/// Colours that all readers can tell apart (Masataka Okabe, Kei Ito, "Color Universal Design", 2008), and greys.
const FRONTIER: RGBColor = RGBColor(0, 114, 178);
const PRESET: RGBColor = RGBColor(213, 94, 0);
const OWN: RGBColor = RGBColor(0, 0, 0);
const OTHER: RGBColor = RGBColor(120, 120, 120);
const TEXT: RGBColor = RGBColor(30, 30, 30);
const GRID: RGBColor = RGBColor(205, 205, 205);
const FAINT: RGBColor = RGBColor(238, 238, 238);

/// A plot.
pub struct Plot {
    pub svg: String,
    /// Where the point of each row is, in pixels from the top left; a row without a time has none.
    pub places: Vec<Option<(i32, i32)>>,
}

/// What a setting is to a reader, which its mark tells by its form. Later ones are drawn upon earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// What no scene can ask for.
    Comparison,
    /// A picture of another number of rays a pixel, which is another picture.
    Rays,
    Other,
    Preset,
    Own,
}

/// A row with a time.
struct Point<'a> {
    row: &'a Row,
    kind: Kind,
    at: (i32, i32),
    /// The ends of its time's bar.
    bar: (i32, i32),
}

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// The plot of a scene that was measured.
pub fn plot(scene: &str, measured: &Tradeoffs) -> Plot {
    let timed = || measured.rows.iter().filter(|row| row.time.is_some());
    let times: Vec<f64> = timed().map(milliseconds).collect();
    let errors: Vec<f64> = timed().map(|row| row.errors.rms).collect();
    let (across, up) = (Axis::of_times(&times), Axis::of_errors(&errors));
    let points: Vec<Option<Point>> =
        measured.rows.iter().map(|row| Point::of(row, &measured.rows[0], &across, &up)).collect();
    let places = points.iter().map(|point| point.as_ref().map(|point| point.at)).collect();
    let mut points: Vec<Point> = points.into_iter().flatten().collect();
    points.sort_by_key(|point| point.kind);

    let mut svg = String::new();
    let canvas = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
    let drawn = (|| {
        canvas.fill(&WHITE)?;
        title(&canvas, scene, measured)?;
        grid(&canvas, &across, &up)?;
        let line = frontier(&points);
        canvas.draw(&PathElement::new(line.clone(), FRONTIER.stroke_width(2)))?;
        for point in &points {
            point.draw_bar(&canvas)?;
        }
        for point in &points {
            point.kind.draw(&canvas, point.at, point.row.on_frontier)?;
        }
        names(&canvas, &points, &line)?;
        legend(&canvas, &points, &up, measured)?;
        canvas.present()?;
        Ok(())
    })();
    let drawn: Drawn = drawn;
    drawn.expect("a string takes all that is drawn");
    drop(canvas);
    Plot { svg, places }
}

fn milliseconds(row: &Row) -> f64 {
    row.time.map_or(0.0, |time| time.median.as_secs_f64() * 1e3)
}

impl<'a> Point<'a> {
    fn of(row: &'a Row, own: &Row, across: &Axis, up: &Axis) -> Option<Point<'a>> {
        let time = row.time?;
        let x = |milliseconds: f64| across.pixel(across.place(milliseconds), ACROSS);
        let y = up.pixel(up.place(row.errors.rms), UP);
        let middle = milliseconds(row);
        let half = time.spread.as_secs_f64() * 1e3 / 2.0;
        let bar = (x((middle - half).max(1e-9)), x(middle + half));
        Some(Point { row, kind: Kind::of(row, own), at: (x(middle), y), bar })
    }

    fn draw_bar(&self, canvas: &Canvas) -> Drawn {
        let ((_, y), (from, to)) = (self.at, self.bar);
        draw_bar(canvas, y, from, to, &self.kind.color())
    }
}

/// Places on the axis are its values.
impl Ranged for &Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, place: &f64, ends: (i32, i32)) -> i32 {
        self.pixel(*place, ends)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        match hint.weight().allow_light_points() {
            true => self.minor.clone(),
            false => self.ticks.iter().map(|(place, _)| *place).collect(),
        }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for &Axis {
    fn format_ext(&self, place: &f64) -> String {
        self.label(*place)
    }
}

fn draw_bar(canvas: &Canvas, y: i32, from: i32, to: i32, color: &RGBColor) -> Drawn {
    let lines = [((from, y), (to, y)), ((from, y - 3), (from, y + 3)), ((to, y - 3), (to, y + 3))];
    for (from, to) in lines {
        canvas.draw(&PathElement::new([from, to], color.stroke_width(1)))?;
    }
    Ok(())
}

impl Kind {
    fn of(row: &Row, own: &Row) -> Kind {
        match row.setting.knob {
            _ if row.setting.is_own => Kind::Own,
            _ if row.setting.preset.is_some() => Kind::Preset,
            Knob::Correction | Knob::Coordinates => Kind::Comparison,
            _ if row.setting.accuracy.antialias != own.setting.accuracy.antialias => Kind::Rays,
            _ => Kind::Other,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Kind::Comparison => "no scene can ask for it",
            Kind::Rays => "another number of rays",
            Kind::Other => "another setting",
            Kind::Preset => "preset of quality",
            Kind::Own => "as the scene is",
        }
    }

    fn color(self) -> RGBColor {
        match self {
            Kind::Comparison | Kind::Rays | Kind::Other => OTHER,
            Kind::Preset => PRESET,
            Kind::Own => OWN,
        }
    }

    /// The mark; on the frontier it has the frontier's colour, if it has none of its own.
    fn draw(self, canvas: &Canvas, (x, y): (i32, i32), on_frontier: bool) -> Drawn {
        let color = if on_frontier && self <= Kind::Other { FRONTIER } else { self.color() };
        match self {
            Kind::Comparison => {
                for (dx, dy) in [(4, 4), (4, -4)] {
                    let ends = [(x - dx, y - dy), (x + dx, y + dy)];
                    canvas.draw(&PathElement::new(ends, color.stroke_width(2)))?;
                }
            }
            Kind::Rays => {
                let corners = [(x - 4, y - 4), (x + 4, y + 4)];
                canvas.draw(&Rectangle::new(corners, WHITE.filled()))?;
                canvas.draw(&Rectangle::new(corners, color.stroke_width(2)))?;
            }
            Kind::Other => canvas.draw(&Circle::new((x, y), 3, color.filled()))?,
            Kind::Preset => canvas.draw(&Circle::new((x, y), 7, color.filled()))?,
            Kind::Own => {
                let diamond =
                    |r: i32| Polygon::new([(x, y - r), (x + r, y), (x, y + r), (x - r, y)], color.filled());
                canvas.draw(&diamond(6))?;
            }
        }
        Ok(())
    }
}

/// The steps of the frontier, from the fastest setting on: there is nothing below them.
fn frontier(points: &[Point]) -> Vec<(i32, i32)> {
    let mut corners: Vec<(i32, i32)> =
        points.iter().filter(|point| point.row.on_frontier).map(|point| point.at).collect();
    corners.sort_unstable();
    corners.dedup();
    let mut line: Vec<(i32, i32)> = Vec::new();
    for (x, y) in corners {
        if let Some((_, before)) = line.last().copied() {
            line.push((x, before));
        }
        line.push((x, y));
    }
    line
}

fn grid(canvas: &Canvas, across: &Axis, up: &Axis) -> Drawn {
    let (width, height) = (SIZE.0 as i32, SIZE.1 as i32);
    let mut chart = ChartBuilder::on(canvas)
        .margin_left(16)
        .margin_top(PLOT.top)
        .margin_right(width - PLOT.right)
        .margin_bottom(height - PLOT.bottom - 50)
        .x_label_area_size(50)
        .y_label_area_size(PLOT.left - 16)
        .build_cartesian_2d(across, up)?;
    let log = |axis: &Axis| if axis.is_log() { ", logarithmic" } else { "" };
    chart
        .configure_mesh()
        .bold_line_style(GRID)
        .light_line_style(FAINT)
        .axis_style(TEXT)
        .label_style(font(12, &TEXT))
        .axis_desc_style(font(13, &TEXT))
        .x_desc(format!("time of a picture in ms{}", log(across)))
        .y_desc(format!("error: RMS against the truth in sRGB codes of 255{}", log(up)))
        .draw()?;
    if let Some(Stripe { end, .. }) = up.stripe {
        let y = up.pixel(end, UP);
        let stripe = Rectangle::new([(PLOT.left + 1, y), (PLOT.right, PLOT.bottom - 1)], FAINT.filled());
        canvas.draw(&stripe)?;
    }
    Ok(())
}

/// The names of what a reader looks for, and of the frontier where there is room.
fn names(canvas: &Canvas, points: &[Point], line: &[(i32, i32)]) -> Drawn {
    let marks: Vec<Rect> = points.iter().map(|point| Rect::around(point.at, 6)).collect();
    let between = |a: (i32, i32), b: (i32, i32)| Rect {
        left: a.0.min(b.0),
        top: a.1.min(b.1),
        right: a.0.max(b.0),
        bottom: a.1.max(b.1),
    };
    let mut lines: Vec<Rect> = line.windows(2).map(|ends| between(ends[0], ends[1])).collect();
    lines.extend(points.iter().map(|p| between((p.bar.0, p.at.1), (p.bar.1, p.at.1))));
    let inside =
        Rect { left: PLOT.left + 3, top: PLOT.top + 3, right: PLOT.right - 3, bottom: PLOT.bottom - 3 };
    for placed in place(&labels(points), &inside, &marks, &lines) {
        draw_name(canvas, &placed)?;
    }
    Ok(())
}

/// Presets and what the scene is, those of one place together; then what else is on the frontier.
fn labels(points: &[Point]) -> Vec<Label> {
    let mut labels: Vec<Label> = Vec::new();
    let mut known: Vec<&Point> = points.iter().filter(|point| point.kind >= Kind::Preset).collect();
    known.reverse();
    for point in known {
        let name = visible(&point.row.setting.name);
        match labels.iter_mut().find(|label| label.at == point.at) {
            Some(label) => label.text += &format!(", {name}"),
            None => labels.push(Label { text: name, at: point.at, must: true }),
        }
    }
    let mut others: Vec<&Point> =
        points.iter().filter(|p| p.row.on_frontier && p.kind < Kind::Preset).collect();
    others.sort_by_key(|point| point.at);
    labels.extend(others.into_iter().map(|point| Label {
        text: visible(&point.row.setting.name),
        at: point.at,
        must: false,
    }));
    labels
}

fn draw_name(canvas: &Canvas, placed: &Placed) -> Drawn {
    let Placed { rect, at, .. } = placed;
    if placed.is_led {
        canvas.draw(&PathElement::new(placed.leader(), TEXT.stroke_width(1)))?;
    }
    let corners = [(rect.left, rect.top), (rect.right, rect.bottom)];
    canvas.draw(&Rectangle::new(corners, WHITE.mix(0.75).filled()))?;
    // What is at a side begins at its point, however wide it comes out.
    let (x, side) = match at.0 {
        x if x < rect.left => (rect.left, HPos::Left),
        x if x > rect.right => (rect.right, HPos::Right),
        _ => ((rect.left + rect.right) / 2, HPos::Center),
    };
    write(canvas, &placed.text, (x, (rect.top + rect.bottom) / 2), font(12, &TEXT), side)
}

fn title(canvas: &Canvas, scene: &str, measured: &Tradeoffs) -> Drawn {
    let (x, y) = TITLE;
    let (width, height) = measured.size;
    let file = Path::new(scene).file_name().map_or(scene.into(), |name| name.to_string_lossy());
    let name = shortened(&visible(&file), 90);
    write(canvas, &format!("What accuracy costs: {name}"), TITLE, font(17, &TEXT), HPos::Left)?;
    let text = match &measured.timing {
        None => format!("errors of {width}x{height} pixels; no times were taken"),
        Some(timing) => {
            let (timed_width, timed_height) = timing.size;
            format!(
                "errors of {width}x{height} pixels; times of {timed_width}x{timed_height} on {} by {}, {} rounds",
                shortened(&visible(&timing.device), 60),
                timing.clock,
                timing.rounds
            )
        }
    };
    write(canvas, &text, (x, y + 21), font(12, &TEXT), HPos::Left)
}

fn legend(canvas: &Canvas, points: &[Point], up: &Axis, measured: &Tradeoffs) -> Drawn {
    let (x, mut y) = LEGEND;
    let words =
        |canvas: &Canvas, text: &str, y: i32| write(canvas, text, (x + 32, y), font(12, &TEXT), HPos::Left);
    if points.iter().any(|point| point.row.on_frontier) {
        canvas.draw(&PathElement::new([(x, y), (x + 24, y)], FRONTIER.stroke_width(2)))?;
        words(canvas, "frontier: no other is as fast", y)?;
        y += 16;
        words(canvas, "and as exact, or beats it in one", y)?;
        y += LINE;
    }
    for kind in points.iter().map(|point| point.kind).collect::<BTreeSet<Kind>>().into_iter().rev() {
        kind.draw(canvas, (x + 12, y), false)?;
        words(canvas, kind.words(), y)?;
        y += LINE;
    }
    if !points.is_empty() {
        draw_bar(canvas, y, x, x + 24, &OTHER)?;
        words(canvas, "as long as the quartiles", y)?;
        y += 16;
        words(canvas, "of the times are apart", y)?;
        y += LINE;
    }
    y += LINE / 2;
    for note in notes(up, measured) {
        write(canvas, &note, (x, y), font(12, &TEXT), HPos::Left)?;
        y += 16;
    }
    Ok(())
}

/// What the plot does not show.
fn notes(up: &Axis, measured: &Tradeoffs) -> Vec<String> {
    let mut notes = Vec::new();
    if up.stripe.is_some() {
        notes.push("grey stripe: an error of 0, or less".into());
        notes.push(format!("than {LEAST}, has no place above it"));
    }
    let untimed = measured.rows.iter().filter(|row| row.time.is_none()).count();
    if untimed > 0 {
        notes.push(format!("without a time, so not here: {untimed}"));
    }
    let undecided = measured.truth.undecided();
    if !measured.truth.is_proved {
        notes.push("the truth is computed in 64 bits,".into());
        notes.push("and not proved".into());
    } else if undecided > 0 {
        notes.push(format!("pixels whose truth is not proved: {undecided}"));
        notes.push(format!("of {}; none of them counts", measured.truth.pixels()));
    }
    notes
}

fn font(pixels: i32, color: &RGBColor) -> TextStyle<'static> {
    // What the size of a font is divided by when it is written.
    let size = f64::from(pixels) * 1.24;
    ("sans-serif", size).into_font().color(color)
}

fn write(canvas: &Canvas, text: &str, at: (i32, i32), style: TextStyle, side: HPos) -> Drawn {
    let style = style.pos(Pos::new(side, VPos::Center));
    Ok(canvas.draw(&Text::new(text.to_string(), at, style))?)
}

/// A name of so many characters at most; its end tells more than its beginning.
fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    match count > most {
        true => ['…'].into_iter().chain(text.chars().skip(count - most + 1)).collect(),
        false => text.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::{Kind, plot};
    use crate::tradeoffs::sample::{measured, presets, untimed};
    use roxmltree::Document;

    /// The texts of a plot that is well-formed.
    #[track_caller]
    fn texts(svg: &str) -> Vec<String> {
        let document = Document::parse(svg).unwrap_or_else(|error| panic!("{error}:\n{svg}"));
        assert_eq!(document.root_element().tag_name().name(), "svg");
        let nodes = document.descendants().filter(|node| node.has_tag_name("text"));
        nodes.map(|node| node.text().unwrap().trim().to_string()).collect()
    }

    #[test]
    fn each_preset_has_its_name() {
        let svg = plot("a.sdf", &presets()).svg;
        let texts = texts(&svg);
        for name in ["as it is, balanced", "draft", "fine", "exact"] {
            assert_eq!(texts.iter().filter(|text| *text == name).count(), 1, "{name} in {texts:?}");
        }
        assert!(texts.contains(&"What accuracy costs: a.sdf".into()), "{texts:?}");
        assert!(
            texts.iter().any(|text| text.contains("of 8x4 on a device by a clock, 5 rounds")),
            "{texts:?}"
        );
        assert_eq!(svg, plot("a.sdf", &presets()).svg);
    }

    #[test]
    fn names_of_files_stay_texts() {
        let texts = texts(&plot("<b>\u{1}&\"]]>.sdf", &presets()).svg);
        assert!(texts.contains(&"What accuracy costs: <b> &\"]]>.sdf".into()), "{texts:?}");
    }

    #[test]
    fn what_is_faster_is_left_and_what_is_worse_above() {
        let places = plot("a.sdf", &measured(&[(2.0, 1.0), (1.0, 4.0), (1.5, 0.0)])).places;
        let [Some(own), Some(fast), Some(exact)] = places[..] else { panic!("{places:?}") };
        assert!(fast.0 < exact.0 && exact.0 < own.0 && fast.1 < own.1 && own.1 < exact.1, "{places:?}");
    }

    #[test]
    fn one_setting_equal_errors_and_none() {
        for figures in
            [&[(2.0, 1.0)][..], &[(2.0, 1.0), (3.0, 1.0)], &[(2.0, 0.0)], &[(2.0, 0.0), (2.0, 0.0)]]
        {
            let plot = plot("a.sdf", &measured(figures));
            assert!(texts(&plot.svg).iter().any(|text| text.starts_with("as it is")), "{figures:?}");
            let has_zero = figures.iter().any(|(_, error)| *error == 0.0);
            assert_eq!(plot.svg.contains("grey stripe"), has_zero, "{figures:?}");
            assert!(plot.places.iter().all(Option::is_some), "{figures:?}");
        }
        let plot = plot("a.sdf", &untimed());
        assert!(texts(&plot.svg).iter().any(|text| text == "without a time, so not here: 1"));
        assert_eq!(plot.places, [None]);
    }

    #[test]
    fn the_scene_s_own_is_drawn_last() {
        assert!(Kind::Own > Kind::Preset && Kind::Preset > Kind::Other);
    }
}
