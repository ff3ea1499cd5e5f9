//! Whether the steps that rays may take from random points are safe: how many certainly are, how many are not, and how
//! many cannot be told, by the [certifier](sdf_render::certify), which takes no promise of the library's for granted.
//!
//! The ball of a step must hold no zero of the field as it is compiled, or none of another definition of the same shape:
//! either is a proof.
//!
//! The typical way is `Site::of(name, call, kind) → tried(&site, count, &options, &files) → Tally`.

pub mod second;

use crate::attack::measures::{points_round, size, surface};
use crate::attack::points::{Points, Random, at, columns, moved, seed};
use crate::attack::subject::{Kind, Subject};
use crate::scenes::scene;
use rayon::prelude::*;
use sdf_lang::Options;
use sdf_render::certify::{Prover, Step};
use second::{Files, Second, certifier, extruded};

/// How far an area is extruded.
const HEIGHT: f64 = 0.4;
/// How far from the surface the nearest points are at most, as shares of the shape's size.
const NEAR: [f64; 5] = [1e-4, 1e-3, 1e-2, 5e-2, 0.2];
/// How far away the farthest points are, in sizes.
const FAR: f64 = 300.0;

/// How often the field is evaluated before other definitions are tried.
const QUICK: u64 = 40;
/// How often the inequalities are evaluated before the field is asked at length: mostly that is enough, and those of many
/// copies are long.
const SHORT: u64 = 100;
/// How often the field is evaluated, at most, where the inequalities do not decide shortly.
const LONG: u64 = 2_000;
/// How often the inequalities are evaluated, at most, where nothing else decides.
const INEQUALITIES: u64 = 30_000;

/// A shape of space, and where it is.
#[derive(Debug)]
pub struct Site {
    /// The function of the library that is called.
    pub name: String,
    /// The shape, as an expression.
    pub call: String,
    /// The call itself, and what it gives.
    made: (String, Kind),
    subject: Subject,
}

impl Site {
    /// That of a call; what is of the plane is extruded. Nothing for what is no shape, or has no points.
    pub fn of(name: &str, call: &str, kind: Kind) -> Option<Site> {
        let made = (call.to_string(), kind);
        let call = match kind {
            Kind::Solid => call.to_string(),
            Kind::Area => extruded(call),
            Kind::Number | Kind::Vector => return None,
        };
        let subject =
            Subject::new(&call, Kind::Solid).unwrap_or_else(|refusal| panic!("{call}: {refusal:?}"));
        (!subject.is_nothing).then_some(Site { name: name.into(), call, made, subject })
    }

    /// Points near the surface on both sides of it, in and round the shape's box, and far away.
    fn points(&self, count: usize) -> Vec<[f64; 3]> {
        let mut random = Random::new(seed(&self.call) ^ 0x5afe);
        let round = points_round(&self.subject, count.max(100));
        let size = size(self.subject.fact());
        let on_surface = columns(surface(&self.subject, &round));
        let near = NEAR.map(|share| moved(&on_surface, 3, share * size, &mut random));
        let far = moved(&round, 3, FAR * size, &mut random);
        let pick = |from: &Points, random: &mut Random| {
            (!from[0].is_empty()).then(|| at(from, random.below(from[0].len())))
        };
        let mut points = Vec::with_capacity(count);
        for i in 0..count {
            let point = match i % 20 {
                0..10 => pick(&near[i % 5], &mut random),
                10 => pick(&far, &mut random),
                _ => None,
            };
            points.extend(point.or_else(|| pick(&round, &mut random)));
        }
        points
    }
}

/// What came of many points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    /// How many points there were, each in the field of one call.
    pub pairs: usize,
    /// How many steps are proved to be safe by the field, by inequalities and by points.
    pub safe: [usize; 3],
    /// Steps that pass a surface: the call, the point, and the share of the step that is free.
    pub wrong: Vec<(String, [f64; 3], f64)>,
    /// Steps of which it cannot be told, likewise.
    pub undecided: Vec<(String, [f64; 3], f64)>,
}

impl Tally {
    /// Both together.
    pub fn and(mut self, other: Tally) -> Tally {
        self.pairs += other.pairs;
        self.safe = std::array::from_fn(|i| self.safe[i] + other.safe[i]);
        self.wrong.extend(other.wrong);
        self.undecided.extend(other.undecided);
        self
    }

    /// Adds the step from a point in the field of a call.
    fn add(
        &mut self,
        call: &str,
        point: [f64; 3],
        field: &mut Prover,
        solid: &mut Option<Prover>,
        second: &Second,
    ) {
        self.pairs += 1;
        let Some((center, radius)) = field.ball_of_step(point) else {
            self.safe[0] += 1;
            return;
        };
        let list = match proof(field, solid, second, center, radius) {
            Proof::Free(by) => {
                self.safe[by] += 1;
                return;
            }
            Proof::Passed => &mut self.wrong,
            Proof::Unknown => &mut self.undecided,
        };
        list.push((call.to_owned(), point, field.free_share(center, radius)));
    }

    /// The least share of a step that is certainly free.
    pub fn least_free(&self) -> f64 {
        let shares = self.wrong.iter().chain(&self.undecided).map(|(.., share)| *share);
        shares.fold(Step::Safe.free_share(), f64::min)
    }
}

/// What is found out about one ball.
enum Proof {
    /// It holds no surface, by the field, by inequalities or by points.
    Free(usize),
    /// It holds one.
    Passed,
    /// It cannot be told.
    Unknown,
}

/// Whether a ball holds no surface: the field is asked shortly, then the other definitions, then both at length.
fn proof(
    field: &mut Prover,
    solid: &mut Option<Prover>,
    second: &Second,
    center: [f64; 3],
    radius: f64,
) -> Proof {
    let asked = |prover: &mut Prover, budget, by| match prover.contains_zero(center, radius, budget) {
        Some(false) => Some(Proof::Free(by)),
        Some(true) => Some(Proof::Passed),
        None => None,
    };
    if let Some(proof) = asked(field, QUICK, 0) {
        return proof;
    }
    if second.is_free_of_points(solid.as_mut(), center, radius) {
        return Proof::Free(2);
    }
    let mut by_inequalities = |budget| solid.as_mut().and_then(|solid| asked(solid, budget, 1));
    by_inequalities(SHORT)
        .or_else(|| asked(field, LONG, 0))
        .or_else(|| by_inequalities(INEQUALITIES))
        .unwrap_or(Proof::Unknown)
}

/// How many points are tried by one thread before it takes others.
const CHUNK: usize = 64;

/// The steps from so many points, in the shape as it is compiled with these options. What comes of them does not depend on
/// how many threads there are.
pub fn tried(site: &Site, count: usize, options: &Options, files: &Files) -> Tally {
    let options = Options { certificate: true, attack: Some(0), ..options.clone() };
    let field = certifier(&scene(&site.call, &Kind::Solid.scene("", &site.call), &options));
    let second = Second::of(files, &site.name, &site.made.0, site.made.1);
    let tried = |points: &[[f64; 3]]| {
        let (mut prover, mut solid, mut tally) = (field.prover(), second.prover(), Tally::default());
        for point in points {
            tally.add(&site.call, *point, &mut prover, &mut solid, &second);
        }
        tally
    };
    let tallies: Vec<Tally> = site.points(count).par_chunks(CHUNK).map(tried).collect();
    tallies.into_iter().fold(Tally::default(), Tally::and)
}
