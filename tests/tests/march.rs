//! The march beside others: what `tests/march/` has in place of the compiler's own.

use sdf_emit::{Header, Target, emit};
use sdf_render::Frame;
use sdf_tests::march::comparison::{Count, count, time};
use sdf_tests::march::tables::{COUNTS, FACTORS, LEAST, PROVED, counts, scene};
use sdf_tests::march::{Subject, Variant};
use sdf_tests::scenes::{Example, examples};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is timed is the whole process: one test after the other.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn small() -> Frame {
    Frame::new(160, 90)
}

fn of<'c>(counts: &'c [Count], march: &str) -> &'c Count {
    counts.iter().find(|count| count.march == march).unwrap_or_else(|| panic!("no march {march}"))
}

/// The table of what is counted, and that the compiler's march sees what there is.
#[test]
fn the_march_sees_what_there_is() {
    let _alone = alone();
    let (table, scenes) = counts(&small()).unwrap_or_else(|error| panic!("{error}"));
    println!("{}", table.markdown());
    let mut complaints = String::new();
    for (scene, counts) in &scenes {
        let product = of(counts, "product");
        let pixels = product.rays.met.len();
        if product.errors.wrong * 2000 > pixels || product.rays.lost().len() * 1000 > pixels {
            let (wrong, lost) = (product.errors.wrong, product.rays.lost().len());
            complaints += &format!("{scene}: {wrong} rays are wrong, {lost} are lost\n");
        }
    }
    assert!(complaints.is_empty(), "{complaints}");
    if let Some(stale) = table.check(COUNTS) {
        panic!("{stale}");
    }
}

/// Bars that are thinner than the balls round the places from which rays pass them.
const BARS: &str = "
camera { eye: (0, 1, 6), target: (0, 0, 0), fov: 40deg }
scene { for i in 0..15 { box((0.02, 1.5, 0.02)).at(0.3 * (i - 7), 0, 0.4 * sin(5 * i)) }, box((4, 2, 0.1)).at(0, 0, -2) }";

/// Walls of balls, one behind the other, whose fields are four times as steep as distances.
const STEEP: &str = "
camera { eye: (0, 1, 6), target: (0, 0, 0), fov: 40deg }
let ball = field { 4 * (length(p) - 0.2) }
scene { for i in 0..9 { for j in 0..4 { ball.at(0.42 * (i - 4), 0.42 * (j - 2), -0.3 * (i % 3)) } }, box((4, 2, 0.1)).at(0, 0, -2) }";

/// The naive twins: steps of which none is taken back miss what is thin, and steps that know no slope pass what is steep.
#[test]
fn reckless_steps_are_seen_to_be_wrong() {
    let _alone = alone();
    for (name, text, reckless) in [("bars", BARS, "reckless(1.6)"), ("steep balls", STEEP, "global(1)")] {
        let example = Example { name: name.into(), text: text.into() };
        let counts = count(&example, &["product", "relaxation(1.6)", reckless], &small()).unwrap();
        let [product, relaxation, wrong] =
            [0, 1, 2].map(|i: usize| counts[i].errors.wrong + counts[i].rays.lost().len());
        println!("{name}: {product}, {relaxation} and {wrong} rays are wrong or lost");
        assert!(wrong > 20 + 2 * product.max(relaxation), "{name}: {wrong} rays are wrong or lost");
    }
}

/// One steep shape among fifty that are not: a factor on its branch alone, beside one for all.
#[test]
fn a_steep_shape_costs_where_it_is() {
    let _alone = alone();
    let (example, frame) = (scene("column"), small());
    let counts = count(&example, &FACTORS, &frame).unwrap();
    let laps = time(&example, &FACTORS, &frame, 9).unwrap();
    for (march, slope) in [(FACTORS[1], PROVED), (FACTORS[2], LEAST)] {
        let steps = of(&counts, "product").rays.steps() / of(&counts, march).rays.steps();
        let lap = laps.iter().find(|lap| lap.march == march).expect("it was timed");
        let time = 1.0 / lap.whole.ratio;
        println!("{march}: {steps:.3} of its steps, {time:.3} of its time");
        assert!(steps <= 1.0 / slope + 0.2, "{march}: {steps} of its steps");
        // What is beyond the march, such as light, costs both the same: it weighs more beside a factor that is nearer to one.
        assert!(
            time <= 1.0 / slope + if slope == PROVED { 0.3 } else { 0.35 },
            "{march}: {time} of its time"
        );
    }
}

/// Far from a steep shape its box is stepped to: rays that pass a twisted column at a distance, on their way to a wall, take
/// the steps of those that pass a plain box of its size. The naive twin has the same field and slope, and no box.
#[test]
fn a_steep_shape_costs_nothing_to_pass() {
    let _alone = alone();
    let steps = |shape: &str| {
        let text = format!(
            "camera {{ eye: (1.8, 0, 9), target: (1.8, 0, 0), fov: 8deg }}
let twisted = box((0.3, 1.2, 0.3)).twist(13)
{shape}
scene {{ shape, box((8, 8, 0.1)).at(1.8, 0, -9) }}"
        );
        let example = Example { name: shape.into(), text };
        let rays = count(&example, &["product"], &small()).unwrap().remove(0).rays;
        let meets_wall = |depth: f64| (17.8..18.5).contains(&depth);
        assert!(
            rays.met.iter().all(|met| met.depth.is_some_and(meets_wall)),
            "{shape}: all rays meet the wall"
        );
        rays.steps()
    };
    let passing = steps("let shape = twisted");
    let plain = steps("let shape = box((0.3 * sqrt(2), 1.2, 0.3 * sqrt(2)))");
    let sheared = steps("let shape = twisted.shear((0.1, 0))");
    let plain_sheared = steps("let shape = box((0.3 * sqrt(2) + 0.12, 1.2, 0.3 * sqrt(2)))");
    let naive = steps(&format!("@lipschitz({PROVED})\nlet shape = field {{ twisted(p) }}"));
    println!(
        "{passing:.2} steps past the column, {plain:.2} past the box, {naive:.2} by the slope alone; \
              {sheared:.2} in a shear, {plain_sheared:.2} past its box"
    );
    assert!(passing <= 1.1 * plain, "{passing:.2} steps, and {plain:.2} past a plain box");
    assert!(
        sheared <= 1.1 * plain_sheared,
        "{sheared:.2} steps past it in a shear, {plain_sheared:.2} past a plain box"
    );
    assert!(naive >= 3.0 * passing, "{naive:.2} steps by the slope alone, and {passing:.2} with the box");
}

/// Where no field is steep, a program has no trace of what is done about those that are.
#[test]
fn what_is_not_steep_costs_nothing() {
    let _alone = alone();
    let text = |name: &str, march: &str| {
        let subject = Subject::new(&scene(name), &Variant::named(march).unwrap()).unwrap();
        emit(&subject.program, Target::Wgsl, &Header::default()).unwrap()
    };
    let (straight, column) = (text("straight", "product"), text("column", "product"));
    assert!(!straight.contains("_stride(") && column.contains("_stride("));
    // The same text comes of a march that knows no slopes.
    assert_eq!(straight, text("straight", "global(1)"));
    assert_ne!(column, text("column", "global(1)"));
}

/// The march against the textbook's, with the same tolerance, and what is proved of a hit is the same. Whole pictures, by the
/// time of all processors; `march_times.md` has them measured at length.
#[test]
fn no_example_takes_longer_than_with_basic_steps() {
    let _alone = alone();
    let mut complaints = String::new();
    for example in examples() {
        let counts = count(&example, &["product", "basic"], &small()).unwrap();
        let marches: Vec<&str> = counts.iter().map(|count| &*count.march).collect();
        for lap in time(&example, &marches, &Frame::new(320, 180), 9).unwrap().iter().skip(1) {
            let ratio = 1.0 / lap.whole.ratio;
            println!("{}: {ratio:.3} of the time of {}", example.name, lap.march);
            if ratio > 1.05 {
                complaints += &format!("{}: {ratio:.3} of the time of {}\n", example.name, lap.march);
            }
        }
    }
    assert!(complaints.is_empty(), "{complaints}");
}
