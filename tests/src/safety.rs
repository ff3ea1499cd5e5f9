//! Whether the steps that rays may take from random points are safe: how many certainly are, how many are not, and how
//! many cannot be told, by the [certifier](sdf_render::certify), which takes no promise of the library's for granted.
//!
//! The typical way is `Site::of(call, kind) → tried(&site, count, &options) → Tally`.

use crate::attack::measures::{points_round, size, surface};
use crate::attack::points::{Points, Random, at, columns, moved, seed};
use crate::attack::subject::{Kind, Subject};
use crate::scenes::scene;
use sdf_lang::Options;
use sdf_render::Frame;
use sdf_render::certify::{Certifier, Functions, Step};

/// How far an area is extruded.
const HEIGHT: f64 = 0.4;
/// How far from the surface the nearest points are at most, as shares of the shape's size.
const NEAR: [f64; 5] = [1e-4, 1e-3, 1e-2, 5e-2, 0.2];
/// How far away the farthest points are, in sizes.
const FAR: f64 = 300.0;

/// A shape of space, and where it is.
#[derive(Debug)]
pub struct Site {
    /// The shape, as an expression.
    pub call: String,
    subject: Subject,
}

impl Site {
    /// That of a call; what is of the plane is extruded. Nothing for what is no shape, or has no points.
    pub fn of(call: &str, kind: Kind) -> Option<Site> {
        let call = match kind {
            Kind::Solid => call.to_string(),
            Kind::Area => format!("({call}).extrude({HEIGHT})"),
            Kind::Number | Kind::Vector => return None,
        };
        let subject =
            Subject::new(&call, Kind::Solid).unwrap_or_else(|refusal| panic!("{call}: {refusal:?}"));
        (!subject.is_nothing).then_some(Site { call, subject })
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
    /// Steps that pass a surface: the call, the point, and the share of the step that is free.
    pub wrong: Vec<(String, [f64; 3], f64)>,
    /// Steps of which it cannot be told, likewise.
    pub undecided: Vec<(String, [f64; 3], f64)>,
}

impl Tally {
    /// Both together.
    pub fn and(mut self, other: Tally) -> Tally {
        self.pairs += other.pairs;
        self.wrong.extend(other.wrong);
        self.undecided.extend(other.undecided);
        self
    }

    /// The least share of a step that is certainly free.
    pub fn least_free(&self) -> f64 {
        let shares = self.wrong.iter().chain(&self.undecided).map(|(.., share)| *share);
        shares.fold(Step::Safe.free_share(), f64::min)
    }
}

/// The steps from so many points, in the shape as it is compiled with these options.
pub fn tried(site: &Site, count: usize, options: &Options) -> Tally {
    let options = Options { certificate: true, attack: Some(0), ..options.clone() };
    let scene = scene(&site.call, &Kind::Solid.scene("", &site.call), &options);
    let certificate = scene.certificate.expect("asked for");
    let functions = Functions { map: scene.map, ray: certificate.ray, step: certificate.step };
    let certifier = Certifier::new(&scene.program, functions, &Frame::new(1, 1));
    let mut prover = certifier.prover();
    let mut tally = Tally::default();
    for point in site.points(count) {
        tally.pairs += 1;
        match prover.step_from(point) {
            Step::Safe => {}
            Step::Unsafe(share) => tally.wrong.push((site.call.clone(), point, share)),
            Step::Undecided(share) => tally.undecided.push((site.call.clone(), point, share)),
        }
    }
    tally
}
