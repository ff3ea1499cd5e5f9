//! What there is to say of a scene, as data: the page shows it to people, and `--json` writes it as it is. The README has the
//! form.

use sdf_ir::region::Extent;
use sdf_syntax::{Sources, Span};
use sdfc::{Basis, Class, Copies, Effect, Fact, Lap, Race};
use serde::Serialize;

/// All that is said of a scene.
#[derive(Debug, Serialize)]
pub struct Explanation {
    /// The scene's file, as it was given.
    pub scene: String,
    /// The size of the picture that was counted, in pixels.
    pub size: (u32, u32),
    /// Its time, in seconds.
    pub time: f64,
    /// The preset that stands for the scene's own, if one was given.
    pub quality: Option<&'static str>,
    /// The params that are frozen.
    pub set: Vec<Set>,
    /// How often a pixel evaluates the scene's field.
    pub evaluations: Evaluations,
    /// Scalar operations of one evaluation of the distance, at most.
    pub operations: u64,
    /// All effects, in an order that does not change.
    pub effects: Vec<Explained>,
    /// What is left without those of the effects that are not of the march: rays, normals, materials and plain light.
    pub rest: Remains,
    /// How times were taken, if they were.
    pub timing: Option<Timing>,
    /// All shapes, each before those that it is made from.
    pub shapes: Vec<Shape>,
}

/// A param and its value, as `--set` takes them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Set {
    pub name: String,
    pub value: String,
}

/// How often a pixel evaluates the scene's field.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Evaluations {
    /// In the mean of the pixels of the picture.
    pub mean: f64,
    /// At most, whatever a pixel shows.
    pub most: u64,
}

/// An effect: whether it is in, why, and what it takes.
#[derive(Debug, Serialize)]
pub struct Explained {
    pub name: &'static str,
    /// The light or the shape whose it is, where there may be several.
    pub subject: Option<String>,
    /// How many lights or shapes it is of.
    pub count: usize,
    #[serde(rename = "in")]
    pub is_in: bool,
    /// What calls for it, or why nothing does.
    pub reason: String,
    /// Where that is written.
    pub place: Option<Place>,
    /// The params and inputs that the value depends on which calls for it.
    pub depends_on: Vec<String>,
    /// From where to where the components of that value may lie.
    pub range: Option<[f64; 2]>,
    /// With this `--set` it is out.
    pub removed_by: Option<Set>,
    /// What it takes; null for what is out, and for inputs, which take nothing.
    pub price: Option<Price>,
}

/// A place in a file. Lines and columns count from 1.
#[derive(Debug, Clone, Serialize)]
pub struct Place {
    pub file: String,
    pub line: usize,
    pub column: usize,
}

/// What an effect takes: the difference to the scene without it. What is below 0 it saves.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Price {
    pub evaluations: Difference,
    /// Its share of the time of a picture, if that was measured.
    pub time: Option<Share>,
}

/// More evaluations of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    pub mean: f64,
    pub most: i64,
}

/// A share of the time of a picture, 1 being all of it: the median, and the quartiles.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Share {
    pub share: f64,
    pub from: f64,
    pub to: f64,
}

/// What is left of a scene without its effects.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Remains {
    pub evaluations: Evaluations,
    pub time: Option<Share>,
}

/// How times were taken.
#[derive(Debug, Clone, Serialize)]
pub struct Timing {
    /// What drew.
    pub device: String,
    /// By which clock.
    pub clock: &'static str,
    /// The size of the pictures that were timed, in pixels.
    pub size: (u32, u32),
    /// How often each was drawn.
    pub rounds: usize,
    /// How long a picture of the whole scene takes.
    pub milliseconds: f64,
}

/// A shape, with what is proved of it and what it takes.
#[derive(Debug, Serialize)]
pub struct Shape {
    /// How many shapes it is a part of.
    pub depth: usize,
    pub name: String,
    /// The line of the scene's file that it comes from.
    pub line: Option<u32>,
    /// `exact`, `bound` or `steep`.
    pub class: &'static str,
    /// Where the slope comes from: `library`, `stated`, `derived` or `parts`.
    pub basis: &'static str,
    /// The slope in its box; null where none is known.
    pub slope: Option<f64>,
    /// The slope everywhere.
    pub slope_everywhere: Option<f64>,
    /// The box; null for what is nothing.
    #[serde(rename = "box")]
    pub extent: Option<Box>,
    /// What changes it from frame to frame.
    pub depends_on: Vec<String>,
    /// Scalar operations of one evaluation, at most.
    pub operations: u64,
    /// Its share of an evaluation of the scene: its operations, as often as it is asked for its copies.
    pub share: f64,
    /// The copies that each point asks.
    pub copies: Vec<Repeated>,
}

/// A box. A coordinate without an end is null.
#[derive(Debug, Serialize)]
pub struct Box {
    pub lo: Vec<Option<f64>>,
    pub hi: Vec<Option<f64>>,
}

/// How many copies of a repeated shape each point asks, of how many; null where they never end.
#[derive(Debug, Serialize)]
pub struct Repeated {
    pub direction: String,
    pub asked: f64,
    pub of: Option<f64>,
}

impl From<sdfc::Evaluations> for Evaluations {
    fn from(sdfc::Evaluations { mean, most }: sdfc::Evaluations) -> Evaluations {
        Evaluations { mean, most }
    }
}

impl Evaluations {
    /// How much more this is than without something.
    pub fn more_than(self, without: Evaluations) -> Difference {
        Difference { mean: self.mean - without.mean, most: self.most as i64 - without.most as i64 }
    }
}

impl Place {
    /// The place of a span in a file of the user's.
    fn of(sources: &Sources, span: Span) -> Place {
        let (line, column) = sources.line_column(span.file, span.start);
        let file = sources.get(span.file).map_or(String::new(), |source| source.name.clone());
        Place { file, line, column }
    }
}

impl Explained {
    /// An effect, without its price.
    pub fn of(effect: &Effect, sources: &Sources) -> Explained {
        Explained {
            name: effect.name,
            subject: effect.subject.clone(),
            count: effect.count,
            is_in: effect.is_in,
            reason: effect.reason.clone(),
            place: effect.span.map(|span| Place::of(sources, span)),
            depends_on: effect.depends_on.clone(),
            range: effect.range,
            removed_by: effect.removed_by.clone().map(|(name, value)| Set { name, value }),
            price: None,
        }
    }
}

impl Share {
    /// What a picture takes of the whole one's time.
    pub fn of(lap: &Lap) -> Share {
        let [from, share, to] = lap.ratio;
        Share { share, from, to }
    }

    /// What the others leave of it.
    pub fn left(self) -> Share {
        Share { share: 1.0 - self.share, from: 1.0 - self.to, to: 1.0 - self.from }
    }
}

impl Timing {
    pub fn of(race: &Race) -> Timing {
        let whole = race.laps[0].expect("the first contestant always runs");
        Timing {
            device: race.device.clone(),
            clock: race.clock,
            size: race.size,
            rounds: race.rounds,
            milliseconds: whole.time.as_secs_f64() * 1e3,
        }
    }
}

/// The shapes of a scene, with their shares of an evaluation of the whole.
pub fn shapes(facts: &[Fact]) -> Vec<Shape> {
    let whole = facts.first().map_or(1, |fact| fact.operations).max(1) as f64;
    // How often the parts of the shapes above are asked for one point.
    let mut asked: Vec<f64> = Vec::new();
    let mut out = Vec::new();
    for fact in facts {
        asked.truncate(fact.depth);
        let times = asked.last().copied().unwrap_or(1.0);
        let share = (fact.operations as f64 * times / whole).min(1.0);
        asked.push(times * fact.copies.iter().map(|copies| copies.asked).product::<f64>());
        out.push(shape(fact, share));
    }
    out
}

fn shape(fact: &Fact, share: f64) -> Shape {
    let finite = |x: f64| x.is_finite().then_some(x);
    let class = match fact.class {
        Class::Exact => "exact",
        Class::Bound => "bound",
        Class::Steep => "steep",
    };
    let basis = match fact.basis {
        Basis::Library => "library",
        Basis::Stated(_) => "stated",
        Basis::Derived => "derived",
        Basis::Parts => "parts",
    };
    let copies = |c: &Copies| Repeated { direction: c.direction.clone(), asked: c.asked, of: finite(c.of) };
    Shape {
        depth: fact.depth,
        name: fact.name.clone(),
        line: fact.line,
        class,
        basis,
        slope: finite(fact.slope),
        slope_everywhere: finite(fact.slope_everywhere),
        extent: extent(&fact.extent, if fact.is_flat { 2 } else { 3 }),
        depends_on: fact.depends_on.clone(),
        operations: fact.operations,
        share,
        copies: fact.copies.iter().map(copies).collect(),
    }
}

fn extent(extent: &Extent, axes: usize) -> Option<Box> {
    let corner = |x: &[f64; 3]| x[..axes].iter().map(|x| x.is_finite().then_some(*x)).collect();
    (!extent.is_empty()).then(|| Box { lo: corner(&extent.lo), hi: corner(&extent.hi) })
}
