//! How well a shape keeps what is said of it.

use super::points::{Points, Random, along, at, columns, exceeds, holds, length, moved, scattered, seed};
use super::subject::{Sampled, Subject};
use crate::fields::{in_f32, nasty_points, on_hardware, run, wide};
use sdf_ir::number::Dual;
use sdf_ir::region::Extent;
use sdf_lang::{Class, Fact};

/// The distances of the pairs of points between which a field changes.
const DISTANCES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// How large the shape is: the longest side of its box, among those with an end.
pub fn size(fact: &Fact) -> f64 {
    let size = fact.extent.size().into_iter().filter(|x| x.is_finite()).fold(0.0, f64::max);
    if size > 1e-6 { size } else { 1.0 }
}

/// The box with its infinite ends four sizes away, grown by so many sizes; in the plane a flat one.
pub fn room(fact: &Fact, by: f64) -> Extent {
    let (size, around) = (size(fact), if fact.extent.is_empty() { Extent::NONE } else { fact.extent });
    let [lo, hi] = [|x: f64| x.max(-1e9), |x: f64| x.min(1e9)];
    let end = |x: f64, infinite: f64| if x.is_finite() { x } else { infinite };
    let mut extent = Extent {
        lo: std::array::from_fn(|i| lo(end(around.lo[i], end(around.hi[i], 0.0) - 4.0 * size) - by * size)),
        hi: std::array::from_fn(|i| hi(end(around.hi[i], end(around.lo[i], 0.0) + 4.0 * size) + by * size)),
    };
    if around.is_empty() {
        extent = Extent { lo: [-2.0; 3], hi: [2.0; 3] };
    }
    if fact.is_flat {
        (extent.lo[2], extent.hi[2]) = (0.0, 0.0);
    }
    extent
}

/// Points round a shape and far from it, and on its surface as far as the gradient leads there.
pub fn points_round(subject: &Subject, count: usize) -> Points {
    let fact = subject.fact();
    let mut random = Random::new(seed(&subject.call));
    let mut points = scattered(&room(fact, 1.0), count * 6 / 10, &mut random);
    let mut add = |more: Points| (0..3).for_each(|axis| points[axis].extend_from_slice(&more[axis]));
    add(scattered(&room(fact, 0.1), count * 2 / 10, &mut random));
    add(scattered(&room(fact, 10.0), count * 2 / 10, &mut random));
    points
}

/// Points of the surface: those at which one arrives along the gradient.
pub fn surface(subject: &Subject, points: &Points) -> Vec<[f64; 3]> {
    let tolerance = 1e-7 * size(subject.fact());
    let mut here = points.clone();
    for _ in 0..4 {
        let Sampled { distance, gradient } = subject.sample(&here);
        here = columns((0..distance.len()).map(|i| {
            let g = at(&gradient, i);
            along(at(&here, i), g, -distance[i] / length(g).powi(2).max(1e-3))
        }));
    }
    let left = subject.distances(&here);
    (0..left.len()).filter(|i| left[*i].abs() < tolerance).map(|i| at(&here, i)).collect()
}

/// How a field that claims to be the distance does.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Projection {
    /// How many points outside were tried.
    pub tried: usize,
    /// How many of them were left out: the gradient changes right beside them.
    pub left_out: usize,
    /// The largest distance left where one should be on the surface, as a share of the size; and where one started.
    pub worst: (f64, [f64; 3]),
}

/// From each point outside one goes the distance against the gradient: there must be the surface.
pub fn projection(subject: &Subject, points: &Points, sampled: &Sampled) -> Projection {
    let size = size(subject.fact());
    let ends = columns(
        (0..points[0].len()).map(|i| along(at(points, i), at(&sampled.gradient, i), -sampled.distance[i])),
    );
    let left = subject.distances(&ends);
    let mut out = Projection::default();
    for (i, left) in left.into_iter().enumerate() {
        if sampled.distance[i] <= 1e-9 * size {
            continue;
        }
        out.tried += 1;
        let share = left.abs() / size;
        if !exceeds(share, out.worst.0) {
            continue;
        }
        if exceeds(share, 1e-4) && is_at_jump(subject, at(points, i), at(&sampled.gradient, i), size) {
            out.left_out += 1;
        } else {
            out.worst = (if share.is_nan() { f64::INFINITY } else { share }, at(points, i));
        }
    }
    out
}

/// Whether the gradient changes within a millionth of the size.
fn is_at_jump(subject: &Subject, p: [f64; 3], gradient: [f64; 3], size: f64) -> bool {
    let step = 1e-6 * (size + length(p));
    let mut random = Random::new(1);
    let beside = columns((0..16).map(|_| along(p, random.direction(subject.kind.axes()), step)));
    let sampled = subject.sample(&beside);
    (0..16).any(|i| length(along(at(&sampled.gradient, i), gradient, -1.0)) > 0.01)
}

/// The largest gradient.
pub fn steepest(sampled: &Sampled) -> f64 {
    let steep = |i| length(at(&sampled.gradient, i));
    (0..sampled.distance.len()).map(steep).fold(0.0, |m, x| if x.is_nan() { f64::INFINITY } else { m.max(x) })
}

/// The steepest pair of points of the field, both where its constant holds, and how many were steeper than it.
pub fn steepest_pair(subject: &Subject, points: &Points, distances: &[f64]) -> (f64, usize) {
    let fact = subject.fact();
    let is_everywhere = fact.slope_everywhere <= fact.slope;
    // The room round a box in which a slope holds as well, or less.
    let extent = fact.extent.grown((size(fact) * 0.04).max(5e-4));
    let mut random = Random::new(seed(&subject.call) ^ 0x9a1);
    let (mut steepest, mut violations) = (0.0f64, 0);
    for distance in DISTANCES {
        let ends = moved(points, subject.kind.axes(), distance, &mut random);
        let there = subject.distances(&ends);
        for i in 0..there.len() {
            let (a, b) = (at(points, i), at(&ends, i));
            if !(is_everywhere || holds(&extent, a) && holds(&extent, b)) {
                continue;
            }
            let change = (distances[i] - there[i]).abs();
            // What is lost when numbers of this size are subtracted.
            let lost = 4.0 * f64::EPSILON * (distances[i].abs() + length(a) * 4.0);
            let slope = (change - lost).max(0.0) / length(along(a, b, -1.0));
            steepest = steepest.max(slope);
            violations += usize::from(exceeds(slope, fact.slope * (1.0 + 1e-9) + 1e-10));
        }
    }
    (steepest, violations)
}

/// The box round the points of the shape that were found, and how many lie outside of the one that is proved.
#[derive(Debug, Clone, PartialEq)]
pub struct Filled {
    /// The box of what was found.
    pub found: Extent,
    /// How many points lie outside of the proved one, and one of them.
    pub outside: (usize, [f64; 3]),
}

/// Looks for points of the shape: inside, and on the surface.
pub fn filled(subject: &Subject, points: &Points, distances: &[f64]) -> Filled {
    let fact = subject.fact();
    let mut random = Random::new(seed(&subject.call) ^ 0xb0c);
    // From far away along an axis one arrives at the ends of the shape.
    let size = size(fact);
    let center = fact.extent.center();
    let axes = subject.kind.axes();
    let from_far = columns((0..axes * 600).map(|i| {
        let mut p = along(center, random.direction(axes), size * random.within(0.0, 0.6));
        p[i % axes] = center[i % axes] + size * if (i / axes).is_multiple_of(2) { 9.0 } else { -9.0 };
        p
    }));
    let inside = (0..distances.len()).filter(|i| distances[*i] <= 0.0).map(|i| at(points, i));
    let few = points.each_ref().map(|column| column.iter().copied().step_by(8).collect::<Vec<f64>>());
    let all = inside.chain(surface(subject, &from_far)).chain(surface(subject, &few));
    let mut filled = Filled { found: Extent::NONE, outside: (0, [0.0; 3]) };
    let room = fact.extent.grown(1e-6 * size);
    for p in all {
        filled.found = filled.found.union(&Extent { lo: p, hi: p });
        if !holds(&room, p) {
            filled.outside = (filled.outside.0 + 1, p);
        }
    }
    filled
}

/// Where the field of a shape that is said to be convex is none outside of it, as a function: above the straight line
/// between what it is at two points. How often it is of so many pairs, and where it is the most.
pub fn dents(subject: &Subject, points: &Points, distances: &[f64]) -> Option<String> {
    let size = size(subject.fact());
    let count = distances.len();
    let mut random = Random::new(seed(&subject.call) ^ 0xc0c);
    let partners: Vec<(usize, f64)> =
        (0..count).map(|_| (random.below(count), random.within(0.0, 1.0))).collect();
    let mixed = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let between = columns(partners.iter().enumerate().map(|(i, (j, t))| {
        let (a, b) = (at(points, i), at(points, *j));
        std::array::from_fn(|axis| mixed(a[axis], b[axis], *t))
    }));
    let there = subject.distances(&between);
    let excess = |i: usize| {
        let (j, t) = partners[i];
        let line = mixed(distances[i].max(0.0), distances[j].max(0.0), t);
        let lost = 1e-6 * size + 1e-12 * (length(at(points, i)) + length(at(points, j)));
        there[i].max(0.0) - line - lost
    };
    let dents: Vec<usize> = (0..count).filter(|i| exceeds(excess(*i), 0.0)).collect();
    let worst = dents.iter().copied().max_by(|a, b| excess(*a).total_cmp(&excess(*b)))?;
    let (a, b) = (at(points, worst), at(points, partners[worst].0));
    Some(format!(
        "it is not convex for {} of {count} pairs: at {:?} the field is {}, between {a:?} with {} and {b:?} with {}",
        dents.len(),
        at(&between, worst),
        there[worst],
        distances[worst],
        distances[partners[worst].0]
    ))
}

/// How much longer a box is than what was found in it, along the axis where that is most.
pub fn excess(fact: &Fact, found: &Extent, axes: usize) -> f64 {
    let extent = &fact.extent;
    if extent.is_empty() && found.is_empty() {
        return 1.0;
    }
    let thin = 1e-4 * size(fact);
    let ratio = |i: usize| (extent.size()[i] + thin) / (found.size()[i] + thin);
    (0..axes).filter(|i| extent.size()[*i].is_finite()).map(ratio).fold(0.0, f64::max)
}

/// The points of a shape where its numbers are the most delicate, in `f32`.
pub fn delicate_points(subject: &Subject) -> Vec<Vec<f32>> {
    let mut points = nasty_points();
    let mut add = |p: [f64; 3]| (0..3).for_each(|axis| points[axis].push(p[axis] as f32));
    let mut ends: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0, -0.0, 1e-40, -1e-40, 1e-38]);
    if let Some(fact) = &subject.fact {
        let center = fact.extent.center();
        for axis in 0..3 {
            let own = [fact.extent.lo[axis], center[axis], fact.extent.hi[axis]];
            ends[axis].extend(own.into_iter().filter(|x| x.is_finite()));
        }
    }
    for x in &ends[0] {
        for y in &ends[1] {
            ends[2].iter().for_each(|z| add([*x, *y, *z]));
        }
    }
    if subject.kind.axes() == 2 {
        points[2].iter_mut().for_each(|z| *z = 0.0);
    }
    points
}

/// Where the distance or the gradient is no number, in `f32`, in `f64` or of duals.
pub fn not_finite(subject: &Subject) -> Option<String> {
    let points = delicate_points(subject);
    let field = &subject.field;
    let find = |what: &str, finite: &dyn Fn(usize) -> bool| {
        let i = (0..points[0].len()).find(|i| !finite(*i))?;
        let p: Vec<f32> = points.iter().map(|c| c[i]).collect();
        Some(format!("{what} at {p:?} is not finite"))
    };
    let double = run::<f64>(&field.gradient, &wide(&points));
    let narrow = run::<f32>(&on_hardware(&field.gradient), &points);
    let distance = run::<f32>(&on_hardware(&field.distance), &points);
    let variables: Vec<Vec<Dual<f64>>> = points
        .iter()
        .enumerate()
        .map(|(axis, column)| column.iter().map(|x| Dual::variable(f64::from(*x), axis)).collect())
        .collect();
    let duals = run(&field.distance, &variables);
    // The squares of smaller coordinates are lost in f32, so that a length beside the origin is 0 and its derivative, by
    // which others are multiplied, as large as a number can be.
    let is_lost = |i: usize| points.iter().any(|c| c[i] != 0.0 && c[i].abs() < 1e-21);
    find("the gradient in f64", &|i| double.iter().all(|c| c[i].is_finite()))
        .or_else(|| find("the gradient in f32", &|i| is_lost(i) || narrow.iter().all(|c| c[i].is_finite())))
        .or_else(|| find("the distance in f32", &|i| distance.iter().all(|c| c[i].is_finite())))
        .or_else(|| {
            let finite = |d: &Dual<f64>| d.value.is_finite() && d.slope.iter().all(|x| x.is_finite());
            find("the gradient of duals", &|i| finite(&duals[0][i]))
        })
}

/// Where the distance in `f32` is far from that in `f64`.
pub fn rounded(subject: &Subject) -> Option<String> {
    let center = subject.fact.as_ref().map_or([0.0; 3], |fact| fact.extent.center());
    let mut random = Random::new(seed(&subject.call) ^ 0xf32);
    let reach = subject.fact.as_ref().map_or(4.0, |fact| 3.0 * size(fact));
    let around = Extent { lo: center.map(|x| x - reach), hi: center.map(|x| x + reach) };
    let points = scattered(&around, 2000, &mut random);
    let points: Vec<Vec<f32>> = points.iter().map(|c| c.iter().map(|x| *x as f32).collect()).collect();
    let spread = in_f32(&subject.field.distance, &points);
    let first = spread.wrong.first()?;
    Some(format!("in f32 and in f64 {} of 2000 points differ: {first}", spread.wrong.len()))
}

/// What is said of a slope.
pub fn class_name(fact: &Fact) -> &'static str {
    match fact.class {
        Class::Exact => "exact",
        Class::Bound => "bound",
        Class::Steep => "steep",
    }
}
