//! Truths against what is known of simple shapes, and wrong findings, which must be caught.

mod ball;

use super::*;
use sdf_ir::{Builder, Parameter, RegionId, Type, Unary, Value};
use std::f64::consts::FRAC_1_SQRT_2;

type Shape = fn(&mut Builder, Value) -> Value;

/// A scene of one shape, whose steps are `stretch` times the distance; the ray through `(x, y)` goes from
/// `(x, y, -5)` along z, as far as 20, and may be off by 1e-3 of its length.
fn scene(shape: Shape, stretch: f64) -> Certifier {
    let mut program = Program::default();
    let parameter = |name: &str, ty, point| vec![Parameter { name: name.into(), ty, point }];

    let mut b = Builder::new("map", parameter("p", Type::Vec3, true));
    let p = b.argument(RegionId::ROOT, 0);
    let distance = shape(&mut b, p);
    let map = program.add(b.finish(vec![(distance, "distance".into())]));

    let mut b = Builder::new("step", parameter("p", Type::Vec3, true));
    let p = b.argument(RegionId::ROOT, 0);
    let distance = shape(&mut b, p);
    let stretch = b.float(stretch);
    let stride = b.mul(distance, stretch);
    let step = program.add(b.finish(vec![(distance, "distance".into()), (stride, "stride".into())]));

    let mut b = Builder::new("ray", parameter("coordinate", Type::Vec2, false));
    let at = b.argument(RegionId::ROOT, 0);
    let (x, y, z) = (b.component(at, 0), b.component(at, 1), b.float(-5.0));
    let origin = b.compose(&[x, y, z]);
    let direction = b.constant(Constant::Vec3([0.0, 0.0, 1.0]));
    let (far, width, tolerance) = (b.float(20.0), b.float(0.0), b.float(1e-3));
    let results = [
        (origin, "origin"),
        (direction, "direction"),
        (far, "far"),
        (width, "width"),
        (tolerance, "tolerance"),
    ];
    let ray = program.add(b.finish(results.map(|(value, name)| (value, name.into())).to_vec()));
    Certifier::new(&program, Functions { map: Some(map), ray, step }, &Frame::new(1, 1))
}

fn length_minus(b: &mut Builder, v: Value, r: f64) -> Value {
    let (length, r) = (b.unary(Unary::Length, v), b.float(r));
    b.sub(length, r)
}

/// A ball of radius 1.
fn sphere(b: &mut Builder, p: Value) -> Value {
    length_minus(b, p, 1.0)
}

/// The half space below y = 0.
fn plane(b: &mut Builder, p: Value) -> Value {
    b.component(p, 1)
}

/// The plane z = 0, without thickness.
fn sheet(b: &mut Builder, p: Value) -> Value {
    let z = b.component(p, 2);
    b.unary(Unary::Abs, z)
}

/// The part of that plane where x is from -1 to 1.
fn strip(b: &mut Builder, p: Value) -> Value {
    let (x, z, half, zero) = (b.component(p, 0), b.component(p, 2), b.float(1.0), b.float(0.0));
    let x = b.unary(Unary::Abs, x);
    let beside = b.sub(x, half);
    let beside = b.max(beside, zero);
    let at = b.compose(&[beside, z]);
    b.unary(Unary::Length, at)
}

/// A ring about the z axis, of radius 1, and as thick as 0.25.
fn torus(b: &mut Builder, p: Value) -> Value {
    let (x, y, z) = (b.component(p, 0), b.component(p, 1), b.component(p, 2));
    let across = b.compose(&[x, y]);
    let ring = length_minus(b, across, 1.0);
    let at = b.compose(&[ring, z]);
    length_minus(b, at, 0.25)
}

/// A box with half sizes 1, 0.5 and 0.75.
fn cuboid(b: &mut Builder, p: Value) -> Value {
    let (p, half) = (b.unary(Unary::Abs, p), b.constant(Constant::Vec3([1.0, 0.5, 0.75])));
    let q = b.sub(p, half);
    let (zero, none) = (b.float(0.0), b.constant(Constant::Vec3([0.0; 3])));
    let outer = b.max(q, none);
    let outside = b.unary(Unary::Length, outer);
    let (x, y, z) = (b.component(q, 0), b.component(q, 1), b.component(q, 2));
    let largest = b.max(x, y);
    let largest = b.max(largest, z);
    let inside = b.min(largest, zero);
    b.add(outside, inside)
}

/// The box, turned about the y axis by two radians for each unit of height: steeper than a distance.
fn twisted(b: &mut Builder, p: Value) -> Value {
    let (x, y, z) = (b.component(p, 0), b.component(p, 1), b.component(p, 2));
    let two = b.float(2.0);
    let angle = b.mul(y, two);
    let (cos, sin) = (b.unary(Unary::Cos, angle), b.unary(Unary::Sin, angle));
    let (a, c) = (b.mul(cos, x), b.mul(sin, z));
    let (d, e) = (b.mul(cos, z), b.mul(sin, x));
    let (x, z) = (b.sub(a, c), b.add(d, e));
    let turned = b.compose(&[x, y, z]);
    cuboid(b, turned)
}

fn ray(origin: Vector, direction: Vector) -> Ray {
    let norm = length(direction);
    Ray { origin, direction: direction.map(|x| x / norm), far: 20.0, width: 0.0, tolerance: 1e-3 }
}

/// Asserts that a hit is enclosed closely, and where it should be.
fn assert_hit(truth: Truth, wanted: f64, what: &str) {
    let Truth::Hit { near, far } = truth else { panic!("{what}: {truth:?}, not {wanted}") };
    let room = 1e-13 * (1.0 + wanted);
    assert!(near - room <= wanted && wanted <= far + room, "{what}: {truth:?} does not hold {wanted}");
    assert!(far - near < 1e-8, "{what}: {truth:?} is wide");
}

#[test]
fn a_sphere_is_met_where_it_is() {
    let certifier = scene(sphere, 1.0);
    let mut prover = certifier.prover();
    for impact in [0.0, 0.3, 0.9, 1.0 - 1e-3, 1.0 - 1e-6] {
        for angle in [0.0f64, 0.7, 2.0] {
            let origin = [impact * angle.cos(), impact * angle.sin(), -5.0];
            let wanted = 5.0 - (1.0 - origin[0] * origin[0] - origin[1] * origin[1]).sqrt();
            assert_hit(prover.first_hit(&ray(origin, [0.0, 0.0, 1.0])), wanted, &format!("{impact} {angle}"));
        }
    }
    for impact in [1.0 + 1e-6, 1.0 + 1e-3, 2.0] {
        assert_eq!(prover.first_hit(&ray([impact, 0.0, -5.0], [0.0, 0.0, 1.0])), Truth::Miss, "{impact}");
    }
    assert_eq!(prover.first_hit(&ray([0.0, 0.0, -5.0], [0.0, 0.0, -1.0])), Truth::Miss);
}

#[test]
fn a_ray_that_touches_is_ambiguous() {
    let certifier = scene(sphere, 1.0);
    match certifier.prover().first_hit(&ray([1.0, 0.0, -5.0], [0.0, 0.0, 1.0])) {
        Truth::Ambiguous { near } => assert!((near - 5.0).abs() < 1e-3, "{near}"),
        truth => panic!("{truth:?}"),
    }
}

#[test]
fn from_inside_the_far_side_is_met() {
    let certifier = scene(sphere, 1.0);
    assert_hit(certifier.prover().first_hit(&ray([0.0, 0.0, 0.25], [0.0, 0.0, 1.0])), 0.75, "inside");
}

#[test]
fn nothing_is_met_beyond_the_end() {
    let certifier = scene(plane, 1.0);
    let mut prover = certifier.prover();
    assert_hit(prover.first_hit(&ray([3.0, 1.0, 0.0], [0.0, -1.0, 1.0])), 1.0 / FRAC_1_SQRT_2, "near");
    let flat = ray([0.0, 1.0, 0.0], [1.0, -0.02, 0.0]);
    assert_eq!(prover.first_hit(&flat), Truth::Miss);
    let farther = Ray { far: 100.0, ..flat };
    assert_hit(prover.first_hit(&farther), 1.0 / -flat.direction[1], "farther");
}

#[test]
fn a_sheet_without_thickness_is_met() {
    let certifier = scene(sheet, 1.0);
    let mut prover = certifier.prover();
    let slanted = ray([0.0, 0.1, -2.0], [0.3, 0.2, 1.0]);
    assert_hit(prover.first_hit(&slanted), 2.0 / slanted.direction[2], "slanted");
    assert_eq!(prover.first_hit(&ray([0.0, 0.0, -2.0], [1.0, 0.0, 0.0])), Truth::Miss);
}

/// What is met by tiny steps in `f64`, where the field's sign first changes.
fn by_tiny_steps(prover: &mut Prover, ray: &Ray) -> Option<f64> {
    let count = 10_000;
    let t = |i: usize| ray.far * i as f64 / count as f64;
    let places: Vec<Vector> = (0..=count).map(|i| ray.at(t(i))).collect();
    let inputs: [Vec<f64>; 3] = std::array::from_fn(|axis| places.iter().map(|place| place[axis]).collect());
    let mut outputs = [vec![0.0; places.len()], vec![0.0; places.len()]];
    let columns = inputs.each_ref().map(Vec::as_slice);
    prover.step.run(&columns, &mut outputs.each_mut().map(Vec::as_mut_slice));
    let sign = outputs[0][0] > 0.0;
    let passed = outputs[0].iter().position(|distance| (*distance > 0.0) != sign)?;
    let mut value = |t: f64| {
        let [distance, _] = run(&mut prover.step, &ray.at(t));
        distance
    };
    let (mut low, mut high) = (t(passed - 1), t(passed));
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if (value(middle) > 0.0) == sign { low = middle } else { high = middle }
    }
    Some(high)
}

#[test]
fn other_shapes_are_met_where_their_sign_changes() {
    for (name, shape) in [("torus", torus as Shape), ("box", cuboid), ("twisted", twisted)] {
        let certifier = scene(shape, 1.0);
        let mut prover = certifier.prover();
        let (mut hits, mut misses) = (0, 0);
        for i in 0..60 {
            let (x, y) = ((i % 10) as f64 / 3.4 - 1.37, (i / 10) as f64 / 2.4 - 1.11);
            let ray = ray([2.0, 1.5, -5.0], [x - 2.0, y - 1.5, 5.0]);
            match by_tiny_steps(&mut prover, &ray) {
                Some(wanted) => {
                    let truth = prover.first_hit(&ray);
                    let Truth::Hit { near, far } = truth else { panic!("{name} {i}: {truth:?}") };
                    assert!(near - 1e-9 < wanted && wanted < far + 1e-9, "{name} {i}: {truth:?}, {wanted}");
                    hits += 1;
                }
                None => {
                    assert_eq!(prover.first_hit(&ray), Truth::Miss, "{name} {i}");
                    misses += 1;
                }
            }
        }
        assert!(hits > 10 && misses > 10, "{name}: {hits} hits, {misses} misses");
    }
}

fn found(depth: f64, normal: Vector) -> Found {
    Found { depth: depth as f32, normal: normal.map(|x| x as f32), lost: false }
}

const NOTHING: Found = Found { depth: -1.0, normal: [0.0; 3], lost: false };

/// What is said of a finding at the pixel whose ray begins at these coordinates.
fn judged(shape: Shape, at: [f64; 2], found: Found) -> Verdict {
    let certifier = scene(shape, 1.0);
    let mut prover = certifier.prover();
    let ray = prover.ray(at);
    let truth = prover.first_hit(&ray);
    prover.judge(&ray, &truth, &found)
}

#[test]
fn wrong_depths_are_caught() {
    let (normal, depth) = ([0.6, 0.0, -0.8], 4.2);
    let judged = |depth: f64| judged(sphere, [0.6, 0.0], found(depth, normal));
    for (depth, wanted) in [(depth, 0.0), (depth + 0.004, 0.76), (depth - 0.004, 0.76), (depth - 0.005, 0.95)]
    {
        match judged(depth) {
            Verdict::RightHit { late: Some(late), normal, is_smooth: _ } => {
                assert!((late - wanted).abs() < 0.02, "{late} at {depth}");
                assert!(normal < 0.2, "{normal} at {depth}");
            }
            verdict => panic!("{verdict:?} at {depth}"),
        }
    }
    // Beyond the tolerance, but not by so much that it has passed through; then by so much.
    assert_eq!(judged(depth + 0.008), Verdict::FalseHit);
    assert_eq!(judged(depth + 0.02), Verdict::FalseMiss);
    assert_eq!(judged(5.8), Verdict::FalseMiss);
    assert_eq!(judged(depth - 0.02), Verdict::FalseHit);
    assert_eq!(judged(f64::NAN), Verdict::NotFinite);
    assert_eq!(judged(f64::INFINITY), Verdict::NotFinite);
}

#[test]
fn wrong_misses_are_caught() {
    assert_eq!(judged(sphere, [0.6, 0.0], NOTHING), Verdict::FalseMiss);
    assert_eq!(judged(sphere, [1.0 - 1e-6, 0.0], NOTHING), Verdict::FalseMiss);
    assert_eq!(judged(sphere, [1.0 + 1e-6, 0.0], NOTHING), Verdict::RightMiss);
    assert_eq!(judged(sphere, [0.6, 0.0], Found { lost: true, ..NOTHING }), Verdict::OutOfSteps);
    assert_eq!(judged(sphere, [1.0, 0.0], NOTHING), Verdict::Ambiguous);
}

#[test]
fn a_hit_that_passes_within_the_tolerance_is_right() {
    let at = |impact: f64| judged(sphere, [impact, 0.0], found(5.0, [1.0, 0.0, 0.0]));
    assert!(matches!(at(1.004), Verdict::RightHit { late: None, .. }));
    assert_eq!(at(1.006), Verdict::FalseHit);
}

#[test]
fn a_hit_beside_the_rim_of_a_sheet_is_right_within_the_tolerance() {
    let at = |x: f64, depth: f64| judged(strip, [x, 0.2], found(depth, [1.0, 0.0, 0.0]));
    for (x, depth) in [(1.004, 5.0), (1.003, 4.997), (1.003, 5.003), (1.0 - 1e-6, 4.997)] {
        assert!(matches!(at(x, depth), Verdict::RightHit { .. }), "{x} {depth}: {:?}", at(x, depth));
    }
    for (x, depth) in [(1.006, 5.0), (1.004, 4.996), (1.004, 5.004), (0.9, 4.99)] {
        assert_eq!(at(x, depth), Verdict::FalseHit, "{x} {depth}");
    }
}

#[test]
fn wrong_normals_are_caught() {
    let turn = |shape, at, depth, normal| match judged(shape, at, found(depth, normal)) {
        Verdict::RightHit { normal, .. } => normal,
        verdict => panic!("{verdict:?}"),
    };
    assert!(turn(cuboid, [0.2, 0.1], 4.25, [0.0, 0.0, -1.0]) < 1e-4);
    let tilted = 0.5f64.to_radians();
    let off = turn(cuboid, [0.2, 0.1], 4.25, [tilted.sin(), 0.0, -tilted.cos()]);
    assert!((off - 0.5).abs() < 1e-3, "{off}");
    // On the edge either side is right, and what lies between them within the tolerance; what is neither is wrong.
    assert!(turn(cuboid, [1.0 - 1e-6, 0.1], 4.25, [1.0, 0.0, 0.0]) < 0.1);
    assert!(turn(cuboid, [1.0 - 1e-6, 0.1], 4.25, [0.0, 0.0, -1.0]) < 0.1);
    assert!(turn(cuboid, [1.0 - 1e-6, 0.1], 4.25, [0.0, 1.0, 0.0]) > 45.0);
}

#[test]
fn pictures_are_summed_up() {
    let certifier = scene(sphere, 1.0);
    // The rays of four pixels in a row begin at x = 0.5, 1.5, 2.5, 3.5 and y = 0.5; the first meets the ball.
    let depth = 5.0 - 0.5f64.sqrt();
    let hit = found(depth, [0.5, 0.5, -(0.5f64.sqrt())]);
    let picture = |found: &[Found]| {
        certifier.judge_picture(&super::Picture { width: 4, found, steps: 3 }, |part| assert!(part <= 1.0))
    };
    let right = picture(&[hit, NOTHING, NOTHING, NOTHING]);
    assert!(right.is_right() && right.largest_late < 1e-3 && right.largest_turn < 1e-4);
    assert_eq!((right.pixels, right.certified, right.steps), (4, 4, 12));
    assert_eq!(right.least_free_share, 0.99);
    let wrong = picture(&[NOTHING, hit, Found { lost: true, ..NOTHING }, found(f64::NAN, [0.0; 3])]);
    assert!(!wrong.is_right());
    assert_eq!((wrong.pixels, wrong.certified), (4, 0));
    assert_eq!(wrong.false_misses, Places { count: 1, first: vec![(0, 0)] });
    assert_eq!(wrong.false_hits, Places { count: 1, first: vec![(1, 0)] });
    assert_eq!(wrong.out_of_steps.first, [(2, 0)]);
    assert_eq!(wrong.not_finite.first, [(3, 0)]);
}
