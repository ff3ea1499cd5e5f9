//! What repetition stands for: the distance to the same shapes written out one by one, at points of many cells and at
//! the borders of cells; and that fewer copies would not do.

use sdf_tests::fields::{Field, run, wide};
use sdf_tests::numbers::word;
use std::fmt::Write;

/// How many points are tried for each case, and how many more at borders of cells.
const POINTS: usize = 100_000;
const BORDERS: usize = 20_000;
/// How far the points reach from the origin.
const REACH: f64 = 3.0;
/// How far two ways to compute a distance may lie apart: in `f64`, and in `f32` at coordinates of this size.
const ROUNDING: f64 = 1e-9;
const ROUNDING_IN_F32: f64 = 8e-6;

/// A shape that stands off the centre and has no symmetry.
const ODD: &str = "(box((0.23, 0.34, 0.12)).rotate((1, 2, 3), 0.6).at(0.11, 0.22, -0.13) | sphere(0.1).at(0.3, -0.2, 0.15))";
const WIDE: &str = "(box((0.93, 0.34, 0.12)).rotate((1, 2, 3), 0.6).at(0.21, 0.22, -0.13) | sphere(0.2).at(1.1, -0.4, 0.15))";
/// Two balls at the ends of a wide box, at different heights: near one of them no copy but its own will do.
const ENDS: &str = "(sphere(0.05).at(0.9, -1, 0) | sphere(0.05).at(-0.9, 1, 0))";

/// A repetition, and what it stands for.
struct Case {
    repeated: String,
    written: String,
    /// The periods along the axes, where there are any.
    periods: [f64; 3],
    /// Up to which distance both must be equal; beyond it the repetition may say less.
    equal_up_to: f64,
}

fn in_rows(shape: &str, periods: [f64; 3], count: Option<[i32; 3]>) -> Case {
    let names = ["x", "y", "z"];
    let named = (0..3).filter(|i| periods[*i] > 0.0).map(|i| format!("{}: {}", names[i], periods[i]));
    let mut arguments: Vec<String> = named.collect();
    if let Some([a, b, c]) = count {
        arguments.push(format!("count: ({a}, {b}, {c})"));
    }
    Case {
        repeated: format!("{shape}.repeat({})", arguments.join(", ")),
        written: union_of_cells(periods, count, |place, _| format!("{shape}.at({place})")),
        periods,
        equal_up_to: f64::INFINITY,
    }
}

/// A function of a cell, by its text in `c`.
fn in_cells(shape: &str, periods: [f64; 3], count: Option<[i32; 3]>) -> Case {
    let alike = in_rows("", periods, count);
    let arguments = alike.repeated.strip_prefix(".repeat(").expect("it was just made");
    let smallest = periods.iter().copied().filter(|p| *p > 0.0).fold(f64::INFINITY, f64::min);
    Case {
        repeated: format!("repeat_each(|c| {shape}, {arguments}"),
        written: union_of_cells(periods, count, |place, cell| format!("(|c| {shape})({cell}).at({place})")),
        periods,
        equal_up_to: smallest / 2.0,
    }
}

/// The shapes of all cells that can matter for points within the reach.
fn union_of_cells(
    periods: [f64; 3],
    count: Option<[i32; 3]>,
    shape: impl Fn(&str, &str) -> String,
) -> String {
    let last = |i: usize| match (periods[i] > 0.0, count) {
        (false, _) => 0,
        (true, Some(count)) => count[i],
        // The widest shape here reaches 1.5 from its origin, and the nearest copy is no farther than that.
        (true, None) => ((REACH + 3.0) / periods[i]).ceil() as i32,
    };
    let [a, b, c] = [last(0), last(1), last(2)];
    let place = format!("(i * {:?}, j * {:?}, k * {:?})", periods[0], periods[1], periods[2]);
    format!(
        "union(for i in -{a}..{} {{ union(for j in -{b}..{} {{ union(for k in -{c}..{} {{ {} }}) }}) }})",
        a + 1,
        b + 1,
        c + 1,
        shape(&place, "((i, j, k))")
    )
}

fn around(shape: &str, n: u32, axis: Option<&str>) -> Case {
    let (arguments, axis) = match axis {
        Some(axis) => (format!("{n}, {axis}"), axis),
        None => (n.to_string(), "(0, 1, 0)"),
    };
    Case {
        repeated: format!("{shape}.repeat_polar({arguments})"),
        written: format!("union(for i in 0..{n} {{ {shape}.rotate({axis}, i * tau / {n}) }})"),
        periods: [0.0; 3],
        equal_up_to: f64::INFINITY,
    }
}

/// The same in the plane, in which no point has a third coordinate.
fn in_plane(case: Case) -> Case {
    let flat = |text: &str| format!("field {{ ({text})(p.xy) }}");
    Case { repeated: flat(&case.repeated), written: flat(&case.written), ..case }
}

fn cases() -> Vec<Case> {
    let flat = "(rect((0.23, 0.34)).rotate(0.6).at(0.11, 0.22) | circle(0.1).at(0.3, -0.2))";
    let flat_copies = |x: f64, y: f64| {
        let last = |period: f64| ((REACH + 2.0) / period).ceil() as i32;
        let (a, b) = (last(x), last(y));
        Case {
            repeated: format!("{flat}.repeat(x: {x:?}, y: {y:?})"),
            written: format!(
                "union(for i in -{a}..{} {{ union(for j in -{b}..{} {{ {flat}.at(i * {x:?}, j * {y:?}) }}) }})",
                a + 1,
                b + 1
            ),
            periods: [x, y, 0.0],
            equal_up_to: f64::INFINITY,
        }
    };
    vec![
        in_rows(ODD, [1.3, 0.0, 0.9], None),
        in_rows(ODD, [1.7, 1.9, 1.6], None),
        in_rows(WIDE, [0.8, 1.9, 0.0], None),
        in_rows(WIDE, [0.0, 0.0, 0.37], None),
        in_rows(ENDS, [1.0, 0.0, 0.0], None),
        in_rows(ODD, [1.3, 0.0, 0.9], Some([2, 0, 1])),
        in_rows(ODD, [1.3, 0.7, 0.9], Some([1, 3, 0])),
        in_rows(WIDE, [0.8, 1.9, 0.3], Some([3, 2, 4])),
        in_rows(ENDS, [1.0, 0.0, 0.0], Some([1, 0, 0])),
        in_rows(ODD, [1.3, 0.0, 0.0], Some([0, 0, 0])),
        // Shapes that are their own mirror images, of which each point asks one copy along some axes.
        in_rows("sphere(0.3).at(0.2, 0.7, -0.1)", [0.6, 0.0, 1.3], None),
        in_rows("(cylinder(0.2, 0.5).round(0.03) | box((0.1, 0.7, 0.1)))", [1.1, 1.9, 0.46], None),
        in_rows("box((0.3, 0.2, 0.4)).rotate_y(0.3).at(0.1, 0.4, 0)", [1.1, 0.4, 1.3], Some([2, 1, 2])),
        in_plane(flat_copies(1.3, 1.1)),
        in_plane(flat_copies(0.4, 0.9)),
        in_cells(
            "box((0.1 + 0.2 * hash(c), 0.34, 0.12)).at(0.11, 0.3 * hash(c + 0.3), 0)",
            [1.3, 0.0, 0.9],
            None,
        ),
        in_cells("sphere(0.2 + 0.4 * hash(c)).at(0.3, 0.2, 0.1)", [1.1, 1.3, 1.2], None),
        in_cells("sphere(0.3 + 0.05 * c.x).at(0.1 * c.z, 0, 0)", [0.8, 0.0, 1.4], Some([3, 0, 2])),
        in_cells(
            "sphere(0.1).at(0.3 * hash(c), 0, 0).repeat(y: 0.25, count: 1)",
            [1.0, 0.0, 0.0],
            Some([4, 0, 0]),
        ),
        around("box((0.33, 0.24, 0.12)).rotate_z(0.3).at(0.9, 0.2, 0.1)", 7, None),
        around("box((0.33, 0.24, 0.12)).rotate_z(0.3).at(-0.4, 0.2, 0.3)", 5, Some("(0.3, 0.9, 0.2)")),
        around("box((0.33, 0.24, 0.12)).rotate_z(0.3).at(0.1, 0.2, -0.2)", 3, Some("x")),
        around("sphere(0.2).at(0.1, -0.2, 1.9)", 100, None),
        around(WIDE, 2, Some("z")),
        around(ODD, 1, None),
        in_plane(Case {
            repeated: "rect((0.33, 0.24)).at(-0.9, 0.2).repeat_polar(6)".into(),
            written: "union(for i in 0..6 { rect((0.33, 0.24)).at(-0.9, 0.2).rotate(i * tau / 6) })".into(),
            periods: [0.0; 3],
            equal_up_to: f64::INFINITY,
        }),
    ]
}

fn unit(n: usize) -> f64 {
    f64::from(word(n as u64)) / f64::from(u32::MAX)
}

/// Points anywhere, and such that lie at a border of cells along one axis or within an ulp of it: at multiples of half of
/// a period from the middle of any box.
fn points(case: &Case) -> Vec<Vec<f32>> {
    let anywhere = |i: usize, axis: usize| ((unit(i * 3 + axis) * 2.0 - 1.0) * REACH) as f32;
    let mut points: Vec<Vec<f32>> =
        (0..3).map(|axis| (0..POINTS).map(|i| anywhere(i, axis)).collect()).collect();
    let axes: Vec<usize> = (0..3).filter(|axis| case.periods[*axis] > 0.0).collect();
    for i in 0..if axes.is_empty() { 0 } else { BORDERS } {
        let on = axes[i % axes.len()];
        for (axis, column) in points.iter_mut().enumerate() {
            let x = anywhere(POINTS + i, axis);
            let half = case.periods[axis] / 2.0;
            column.push(match axis == on {
                true => beside((f64::from(x) / half).round() * half, i),
                false => x,
            });
        }
    }
    points
}

/// A number, the one before it or the one after it.
fn beside(x: f64, i: usize) -> f32 {
    let x = x as f32;
    [x, x.next_down(), x.next_up()][i / 3 % 3]
}

/// How far the distances of two expressions lie apart at most, up to where they must be equal, and how often the first
/// is more than the second or tells another side.
fn compare(case: &Case, points: &[Vec<f32>]) -> (f64, f64, usize) {
    let (repeated, written) = (Field::of_expression(&case.repeated), Field::of_expression(&case.written));
    let expected = run::<f64>(&written.distance, &wide(points)).remove(0);
    let found = run::<f64>(&repeated.distance, &wide(points)).remove(0);
    let in_f32 = run::<f32>(&repeated.distance, points).remove(0);
    let (mut worst, mut worst_in_f32, mut wrong) = (0.0f64, 0.0f64, 0);
    for i in 0..expected.len() {
        let off = found[i] - expected[i];
        if expected[i] <= case.equal_up_to {
            worst = worst.max(off.abs());
            worst_in_f32 = worst_in_f32.max((f64::from(in_f32[i]) - expected[i]).abs());
        }
        wrong += usize::from(off > ROUNDING || (found[i] < -ROUNDING) != (expected[i] < -ROUNDING));
    }
    (worst, worst_in_f32, wrong)
}

#[test]
fn copies_are_what_is_written_out() {
    let (mut table, mut complaints) = (String::new(), String::new());
    for case in cases() {
        let points = points(&case);
        let (worst, worst_in_f32, wrong) = compare(&case, &points);
        writeln!(table, "{worst:9.1e} {worst_in_f32:9.1e} {wrong:6}  {}", case.repeated)
            .expect("a string grows");
        if worst > ROUNDING || worst_in_f32 > ROUNDING_IN_F32 || wrong > 0 {
            complaints += &format!(
                "{}: {worst:e} apart, {worst_in_f32:e} in f32, {wrong} points too far or on the wrong side\n",
                case.repeated
            );
        }
    }
    println!("      f64       f32  wrong\n{table}");
    assert!(complaints.is_empty(), "{complaints}\n{table}");
}

/// Copies along x, of which each point asks the `n` nearest.
fn asking(shape: &str, period: f64, middle: f64, n: u32) -> String {
    format!(
        "field {{
            let s = {shape};
            let first = floor((p.x - {middle:?}) / {period:?} - {n} / 2 + 1);
            min(for i in 0..{n} {{ s(p - ((first + i) * {period:?}, 0, 0)) }})
        }}"
    )
}

/// The number of copies that the proof asks for is the least: with one fewer the distance is too large somewhere.
#[test]
fn one_copy_fewer_is_not_enough() {
    // The shape is 1.9 wide.
    for (period, needed) in [(2.5, 2), (1.9, 2), (1.7, 3), (1.0, 3), (0.8, 4), (0.5, 5), (0.25, 9)] {
        let case = in_rows(ENDS, [period, 0.0, 0.0], None);
        let points = points(&case);
        for (n, is_enough) in [(needed, true), (needed - 1, false)] {
            let twin =
                Case { repeated: asking(ENDS, period, 0.0, n), ..in_rows(ENDS, [period, 0.0, 0.0], None) };
            let (worst, _, wrong) = compare(&twin, &points);
            assert_eq!(
                worst <= ROUNDING && wrong == 0,
                is_enough,
                "{n} copies with the period {period}: {worst:e}"
            );
        }
        let options = sdf_lang::Options { facts: true, ..Default::default() };
        let scene = sdf_tests::scenes::scene("ends", &format!("scene {{ {} }}", case.repeated), &options);
        let asked: Vec<f64> = scene.facts.iter().flat_map(|f| &f.copies).map(|c| c.asked).collect();
        assert_eq!(asked, [f64::from(needed)], "with the period {period}");
    }
}

/// A shape that is its own mirror image needs one copy, as long as it fits into its cell.
#[test]
fn mirror_images_need_one_copy() {
    let asked = |shape: &str| -> Vec<f64> {
        let options = sdf_lang::Options { facts: true, ..Default::default() };
        let scene = sdf_tests::scenes::scene(shape, &format!("scene {{ {shape} }}"), &options);
        scene.facts.iter().flat_map(|fact| &fact.copies).map(|copies| copies.asked).collect()
    };
    assert_eq!(asked("sphere(0.3).at(0.2, 0.7, -0.1).repeat(x: 0.6, z: 0.59)"), [1.0, 3.0]);
    assert_eq!(
        asked("smin(box(0.4).at(1, 0, 0), sphere(0.5).at(1, 0, 0.1), k: 0.1).repeat(x: 2, z: 2)"),
        [1.0, 2.0]
    );
    assert_eq!(asked("box(0.4).rotate_y(0.1).repeat(x: 3, y: 3)"), [2.0, 1.0]);
    assert_eq!(asked("torus(0.5, 0.1).twist(1).repeat(x: 3)"), [2.0]);
}

/// The copy of the own cell alone, as shaders often have it, is wrong off the centre.
#[test]
fn the_own_cell_is_not_enough() {
    let case = in_rows(ODD, [1.3, 0.0, 0.0], None);
    let points = points(&case);
    let (_, _, wrong) = compare(&Case { repeated: asking(ODD, 1.3, 0.0, 1), ..case }, &points);
    assert!(wrong > POINTS / 20, "{wrong}");
}
