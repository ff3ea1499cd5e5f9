//! How far away a solid is by its definition alone: boxes are searched, the nearest first, and those dropped in which
//! intervals prove that there is nothing.

use super::points::{along, length};
use sdf_ir::interval::{Bounds, Domain, Interval, Sloped, Walker, bounds_of_globals, bounds_of_uniform};
use sdf_ir::region::Extent;
use sdf_ir::{Constant, Function, Program};
use sdf_render::certify::{conditions, weights};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// How often a search may ask before it gives up.
const BUDGET: usize = 10_000;

/// What a search found: the least distance lies between these, unless it gave up before they met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// It is at least this.
    pub at_least: f64,
    /// It is at most this.
    pub at_most: f64,
    /// How many boxes were looked at.
    pub asked: usize,
}

/// A box, what everything in it amounts to at least, and the axis along which it is to be split.
struct Cell {
    at_least: f64,
    extent: Extent,
    axis: usize,
}

impl Ord for Cell {
    fn cmp(&self, other: &Cell) -> Ordering {
        other.at_least.total_cmp(&self.at_least)
    }
}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Cell) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Cell {
    fn eq(&self, other: &Cell) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cell {}

/// What is known of a box: nothing if it can be dropped.
struct Known {
    /// What is looked for is at least this in it.
    at_least: f64,
    /// It is at most this somewhere.
    at_most: f64,
    /// How much it changes along each axis, as far as that is known.
    effect: [f64; 3],
}

/// The least number that is to be found in a box, to within a tolerance. `ask` is also told the least so far.
fn least(
    start: Extent,
    axes: &[usize],
    so_far: f64,
    tolerance: f64,
    mut ask: impl FnMut(&Extent, f64) -> Option<Known>,
) -> Found {
    let most = |effect: [f64; 3]| {
        axes.iter().copied().max_by(|a, b| effect[*a].total_cmp(&effect[*b])).expect("an axis")
    };
    let mut at_most = so_far;
    let mut cells =
        BinaryHeap::from([Cell { at_least: f64::NEG_INFINITY, extent: start, axis: most(start.size()) }]);
    let mut asked = 0;
    while let Some(Cell { at_least, extent, axis }) = cells.pop() {
        if at_least > at_most - tolerance || asked >= BUDGET {
            return Found { at_least: at_least.min(at_most), at_most, asked };
        }
        for side in [0, 1] {
            let mut part = extent;
            let middle = extent.lo[axis] + extent.size()[axis] / 2.0;
            if side == 0 {
                part.hi[axis] = middle
            } else {
                part.lo[axis] = middle
            }
            asked += 1;
            if let Some(known) = ask(&part, at_most) {
                at_most = at_most.min(known.at_most);
                let at_least = at_least.max(known.at_least);
                if at_least <= at_most - tolerance {
                    cells.push(Cell { at_least, extent: part, axis: most(known.effect) });
                }
            }
        }
    }
    // Nothing is left that could be nearer.
    Found { at_least: at_most - tolerance, at_most, asked }
}

fn function(program: &Program) -> &Function {
    program.function(program.entry.expect("an entry"))
}

fn region(extent: &Extent) -> Bounds {
    Bounds::between(extent.lo, extent.hi)
}

fn middle(extent: &Extent) -> [f64; 3] {
    std::array::from_fn(|i| extent.lo[i] + (extent.hi[i] - extent.lo[i]) / 2.0)
}

/// The number that a walk over a point finds.
fn at_point(walker: &mut Walker<Bounds>, p: [f64; 3]) -> Interval {
    walker.run(&[Bounds::between(p, p)])[0].number()
}

/// A solid by inequalities: what makes all of several numbers not positive.
#[derive(Debug, Clone)]
pub struct Solid {
    program: Program,
    axes: usize,
    /// The numbers of whose maximum the field consists.
    conditions: Function,
}

impl Solid {
    /// Where the field of a program is not positive, in the plane or in space.
    pub fn new(program: &Program, axes: usize) -> Solid {
        let conditions = conditions(program, function(program), true);
        Solid { program: program.clone(), axes, conditions }
    }

    /// How far a point outside is from the solid, if it is within `reach`. `guesses` are points that may well lie in
    /// the solid, the nearest first; it is found without them as well, but later. Where the solid has no inside, a
    /// point counts that is as good as in it: at which no number is larger than it gets within the tolerance.
    pub fn distance(&self, p: [f64; 3], reach: f64, guesses: &[[f64; 3]], tolerance: f64) -> Found {
        let mut bounds = Walker::<Bounds>::new(&self.program, &self.conditions, &[], &[]);
        let mut slopes = Walker::<Sloped>::new(&self.program, &self.conditions, &[], &[]);
        let away = |x: [f64; 3]| length(along(x, p, -1.0));
        let is_inside = |walker: &mut Walker<Bounds>, x: [f64; 3]| {
            walker.run(&[Bounds::between(x, x)]).iter().all(|value| value.number().hi <= 0.0)
        };
        let mut so_far = f64::INFINITY;
        if let Some(guess) = guesses.iter().find(|guess| is_inside(&mut bounds, **guess)) {
            so_far = away(*guess);
        } else if let Some(guess) = guesses.iter().find(|guess| {
            let around = region(&Extent { lo: **guess, hi: **guess }.grown(tolerance));
            let values = slopes.run(&[Sloped::point(around)]);
            let most: Vec<f64> = values.iter().map(|value| value.norm() * tolerance).collect();
            let here = bounds.run(&[Bounds::between(**guess, **guess)]);
            here.iter().zip(most).all(|(value, most)| most.is_finite() && value.number().hi <= most)
        }) {
            so_far = away(*guess);
        }
        let mut start = Extent { lo: p, hi: p }.grown(reach.min(so_far));
        if self.axes == 2 {
            (start.lo[2], start.hi[2]) = (0.0, 0.0);
        }
        let all: Vec<usize> = (0..self.axes).collect();
        least(start, &all, so_far, tolerance, |part, so_far| {
            let nearest: [f64; 3] = std::array::from_fn(|i| p[i].clamp(part.lo[i], part.hi[i]));
            let at_least = away(nearest);
            if at_least > so_far - tolerance {
                return None;
            }
            let values = slopes.run(&[Sloped::point(region(part))]);
            if values.iter().any(|value| value.bounds.number().lo > 0.0) {
                return None;
            }
            let center = middle(part);
            let here: Vec<Interval> =
                bounds.run(&[Bounds::between(center, center)]).iter().map(|value| value.number()).collect();
            let conditions: Vec<Condition> = values
                .iter()
                .zip(&here)
                .filter(|(value, _)| value.norm().is_finite() && value.bounds.number().hi > 0.0)
                .map(|(value, here)| Condition::new(here.lo, value.slopes.gradient(0)))
                .collect();
            let mut at_most = f64::INFINITY;
            if here.iter().all(|value| value.hi <= 0.0) {
                at_most = away(center);
            } else if let [condition] = &conditions[..] {
                // Along the gradient one comes to the surface, and a little farther, so as to be inside.
                let g = condition.middle;
                let step = (condition.here + 0.1 * tolerance * length(g)) / length(g).powi(2).max(1e-300);
                let guess = along(center, g, -step);
                if away(guess) < so_far && is_inside(&mut bounds, guess) {
                    at_most = away(guess);
                }
            }
            let limit = so_far.min(at_most) - tolerance;
            let half: [f64; 3] = std::array::from_fn(|i| (part.hi[i] - part.lo[i]) / 2.0);
            let is_dropped =
                limit.is_finite() && is_farther(&conditions, along(center, p, -1.0), half, limit.max(0.0));
            (!is_dropped).then_some(Known { at_least, at_most, effect: part.size() })
        })
    }
}

/// A number that must not be positive in a solid, in a box.
struct Condition {
    /// It is at least this in the middle.
    here: f64,
    /// How it moves.
    gradient: [Interval; 3],
    middle: [f64; 3],
}

impl Condition {
    fn new(here: f64, gradient: [Interval; 3]) -> Condition {
        Condition { here, gradient, middle: gradient.map(Interval::middle) }
    }
}

/// Whether no point of a box meets all conditions and is nearer than `limit`. `to` leads from where one measures to the
/// middle of the box. What meets them makes every condition and |x - p|² - limit² not positive, and so their sum with
/// any weights. The weights are those that let the slopes of up to three conditions cancel that of the square, so that
/// the sum hardly changes in the box.
fn is_farther(conditions: &[Condition], to: [f64; 3], half: [f64; 3], limit: f64) -> bool {
    let beyond = |chosen: &[&Condition], weights: &[f64]| {
        let mut least = (length(to).powi(2) - limit * limit) / 2.0;
        let mut slope = to.map(Interval::point);
        for (condition, weight) in chosen.iter().zip(weights) {
            least += weight * condition.here;
            slope = std::array::from_fn(|i| slope[i].plus(condition.gradient[i].scaled(*weight)));
        }
        least - (0..3).map(|i| slope[i].most() * half[i]).sum::<f64>() > 0.0
    };
    let n = conditions.len();
    let mut chosen: Vec<&Condition> = Vec::new();
    for a in 0..n {
        for b in a..n {
            for c in b..n {
                // One, two or three different ones; (a, b, b) is two and (a, a, c) the same two.
                if a == b && b != c {
                    continue;
                }
                chosen.clear();
                chosen.push(&conditions[a]);
                chosen.extend((b > a).then(|| &conditions[b]));
                chosen.extend((c > b).then(|| &conditions[c]));
                // The weights with which the gradients add up to `-to`, as nearly as they can.
                let gradients: Vec<[f64; 3]> = chosen.iter().map(|condition| condition.middle).collect();
                let values: Vec<f64> =
                    gradients.iter().map(|g| -(0..3).map(|i| g[i] * to[i]).sum::<f64>()).collect();
                let weights = weights(&gradients, &values);
                if weights.is_some_and(|weights| beyond(&chosen, &weights[..chosen.len()])) {
                    return true;
                }
            }
        }
    }
    false
}

/// The least of a curve's field over its parameters, each from 0 to 1, for a point in space.
pub fn distance_to_curve(program: &Program, p: [f64; 3], tolerance: f64) -> Found {
    let value = |uniform: &sdf_ir::Uniform| match &*uniform.name {
        "from_x" => Bounds::constant(Constant::Float(p[0])),
        "from_y" => Bounds::constant(Constant::Float(p[1])),
        "from_z" => Bounds::constant(Constant::Float(p[2])),
        _ => bounds_of_uniform(uniform),
    };
    let uniforms: Vec<Bounds> = program.uniforms.iter().map(value).collect();
    let globals = bounds_of_globals(program, &uniforms);
    let function = function(program);
    let mut bounds = Walker::<Bounds>::new(program, function, &uniforms, &globals);
    let mut slopes = Walker::<Sloped>::new(program, function, &uniforms, &globals);
    let start = Extent { lo: [0.0; 3], hi: [1.0; 3] };
    let whole = slopes.run(&[Sloped::point(region(&start))])[0].slopes.gradient(0);
    let used: Vec<usize> = (0..3).filter(|i| !whole[*i].is_zero()).collect();
    if used.is_empty() {
        let found = at_point(&mut bounds, [0.5; 3]);
        return Found { at_least: found.lo, at_most: found.hi, asked: 1 };
    }
    let so_far = at_point(&mut bounds, middle(&start)).hi;
    least(start, &used, so_far, tolerance, |part, _| {
        let value = slopes.run(&[Sloped::point(region(part))])[0];
        let here = at_point(&mut bounds, middle(part));
        let gradient = value.slopes.gradient(0);
        let size = part.size();
        let effect: [f64; 3] = std::array::from_fn(|i| gradient[i].most() * size[i]);
        let change = used.iter().map(|i| effect[*i]).sum::<f64>() / 2.0;
        let (by_slope, effect) =
            if change.is_finite() { (here.lo - change, effect) } else { (f64::NEG_INFINITY, size) };
        Some(Known { at_least: value.bounds().number().lo.max(by_slope), at_most: here.hi, effect })
    })
}

#[cfg(test)]
mod tests {
    use super::super::forms::forms;
    use super::super::{definitions::Definitions, subject::Kind};
    use super::*;

    #[test]
    fn the_search_finds_known_distances() {
        let forms = forms();
        let solids = Definitions::solids(&forms);
        let solid = |name: &str, call: &str| {
            Solid::new(&solids.program(name, call, Kind::Solid).expect("a definition"), 3)
        };
        let ball = solid("sphere", "sphere(0.5)");
        let found = ball.distance([1.0, 2.0, -2.0], 4.0, &[], 1e-5);
        assert!(found.at_least <= 2.5 && found.at_most >= 2.5, "{found:?}");
        assert!(found.at_most - found.at_least < 1.1e-5 && found.asked < 20_000, "{found:?}");
        let guesses = [[0.16, 0.33, -0.33]];
        let found = ball.distance([1.0, 2.0, -2.0], 4.0, &guesses, 1e-5);
        assert!(found.at_least <= 2.5 && found.at_most >= 2.5 && found.asked < 5_000, "{found:?}");
        let cylinder = solid("cylinder", "cylinder(0.6, 1.2)");
        let found = cylinder.distance(
            [0.8, 2.2, -1.0],
            4.0,
            &[[0.8 / 1.64f64.sqrt() * 0.6, 1.2, -0.6 / 1.64f64.sqrt()]],
            1e-5,
        );
        let expected = 1.0f64.hypot(1.64f64.sqrt() - 0.6);
        assert!(
            found.at_least <= expected && found.at_most >= expected - 1e-9 && found.asked < 2_000,
            "{found:?}"
        );
        let curves = Definitions::curves(&forms);
        let line = "capsule((-1, 0, 0), (1, 0, 0), 0.5)";
        let line = curves.program("capsule", line, Kind::Solid).expect("a definition");
        for (p, expected) in [([0.3, 0.0, 2.0], 1.5), ([4.0, 0.0, 4.0], 4.5)] {
            let found = distance_to_curve(&line, p, 1e-6);
            assert!((found.at_most - expected).abs() < 2e-6 && found.asked < 2_000, "{found:?}");
        }
    }
}
