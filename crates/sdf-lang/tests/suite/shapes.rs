//! The shapes of the library against the solids that they are said to be: `inside` is an inequality of its own.
//!
//! A field whose slope is at most 1, whose sign is right, and from which a step of its own length along its
//! gradient ends on the surface, is the distance: nothing nearer is on the surface, and something so near is.

use crate::scene::{Field, Point, compile, length, points};
use sdf_syntax::{Code, Severity};

/// A solid: how it is written, and whether a point is in it.
type Solid = (&'static str, fn(Point) -> bool);

fn norm2(x: f64, y: f64) -> f64 {
    x.hypot(y)
}

/// The solids whose fields are the distance outside.
const EXACT: &[Solid] = &[
    ("sphere(0.7)", |p| length(p) < 0.7),
    ("sphere(0.7).at(0.3, -0.2, 0.5)", |[x, y, z]| length([x - 0.3, y + 0.2, z - 0.5]) < 0.7),
    ("box(0.3, 0.5, 0.8)", |[x, y, z]| x.abs() < 0.3 && y.abs() < 0.5 && z.abs() < 0.8),
    ("box(0.5)", |p| p.iter().all(|x| x.abs() < 0.5)),
    ("round_box((0.4, 0.5, 0.8), 0.15)", |p| {
        let inner = [0.25, 0.35, 0.65];
        length(std::array::from_fn(|i| (p[i].abs() - inner[i]).max(0.0))) < 0.15
    }),
    ("torus(0.8, 0.25)", |[x, y, z]| norm2(norm2(x, z) - 0.8, y) < 0.25),
    ("torus(0.3, 0.5)", |[x, y, z]| norm2(norm2(x, z) - 0.3, y) < 0.5),
    ("plane()", |[_, y, _]| y < 0.0),
    ("plane((3, 0, -4), 0.25)", |[x, _, z]| 0.6 * x - 0.8 * z + 0.25 < 0.0),
    ("cylinder(0.4, 0.7)", |[x, y, z]| norm2(x, z) < 0.4 && y.abs() < 0.7),
    ("capsule(-0.3, 0.1, 0.2, 0.5, 0.6, -0.4, 0.2)", |p| {
        // The nearest of many points of the line.
        (0..=2000).any(|i| {
            let t = f64::from(i) / 2000.0;
            length([p[0] + 0.3 - 0.8 * t, p[1] - 0.1 - 0.5 * t, p[2] - 0.2 + 0.6 * t]) < 0.2
        })
    }),
    ("capsule((0, 0, 0), (0, 0, 0), 0.5)", |p| length(p) < 0.5),
    ("cone(0.5, 0.8)", |[x, y, z]| y > -0.8 && norm2(x, z) < 0.5 * (0.8 - y) / 1.6),
    ("cone(0.9, 0.2)", |[x, y, z]| y > -0.2 && norm2(x, z) < 0.9 * (0.2 - y) / 0.4),
    ("octahedron(0.8)", |p| p.iter().map(|x| x.abs()).sum::<f64>() < 0.8),
    ("circle(0.5).extrude(0.3)", |[x, y, z]| norm2(x, y) < 0.5 && z.abs() < 0.3),
    ("rect(0.3, 0.6).extrude(0.4)", |[x, y, z]| x.abs() < 0.3 && y.abs() < 0.6 && z.abs() < 0.4),
    ("circle(0.2).revolve(0.6)", |[x, y, z]| norm2(norm2(x, z) - 0.6, y) < 0.2),
    ("rect(0.2, 0.5).at(0.5, 0.1).revolve()", |[x, y, z]| {
        (norm2(x, z) - 0.5).abs() < 0.2 && (y - 0.1).abs() < 0.5
    }),
    ("polygon([(-0.6, -0.4), (0.7, -0.5), (0.1, 0.0), (0.3, 0.8)]).extrude(0.4)", |[x, y, z]| {
        z.abs() < 0.4 && in_polygon(&[(-0.6, -0.4), (0.7, -0.5), (0.1, 0.0), (0.3, 0.8)], x, y)
    }),
    // The other way round.
    ("polygon([(0.3, 0.8), (0.1, 0.0), (0.7, -0.5), (-0.6, -0.4)]).extrude(0.4)", |[x, y, z]| {
        z.abs() < 0.4 && in_polygon(&[(-0.6, -0.4), (0.7, -0.5), (0.1, 0.0), (0.3, 0.8)], x, y)
    }),
    ("sphere(0.4).round(0.2)", |p| length(p) < 0.6),
    ("box(0.3).round(0.2)", |p| length(p.map(|x| (x.abs() - 0.3).max(0.0))) < 0.2),
    ("box(0.3, 0.2, 0.5).scale(1.5)", |[x, y, z]| x.abs() < 0.45 && y.abs() < 0.3 && z.abs() < 0.75),
    ("sphere(0.5).at(0.6, 0, 0) | box(0.2, 0.5, 0.3)", |[x, y, z]| {
        length([x - 0.6, y, z]) < 0.5 || (x.abs() < 0.2 && y.abs() < 0.5 && z.abs() < 0.3)
    }),
];

/// Whether a ray to the right crosses an odd number of edges.
fn in_polygon(corners: &[(f64, f64)], x: f64, y: f64) -> bool {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossed = |((ax, ay), (bx, by)): &(&(f64, f64), &(f64, f64))| {
        (ay > &y) != (by > &y) && x < ax + (y - ay) / (by - ay) * (bx - ax)
    };
    edges.filter(crossed).count() % 2 == 1
}

fn moved(p: Point, direction: Point, by: f64) -> Point {
    std::array::from_fn(|i| p[i] + direction[i] * by)
}

/// The sign of the field is that of the solid, except on its surface.
fn check_sign((shape, inside): Solid) -> (Field, Vec<Point>, Vec<f64>) {
    let field = Field::of_shape("", shape);
    let points = points(3000, 1.4);
    let distances = field.distances(&points);
    let within = points.iter().filter(|p| inside(**p)).count();
    assert!(within > 10, "only {within} points are inside of {shape}");
    for (p, d) in points.iter().zip(&distances) {
        assert_eq!(*d < 0.0, inside(*p), "{shape} at {p:?} is {d}");
    }
    (field, points, distances)
}

#[test]
fn exact_fields_are_the_distance() {
    for (shape, inside) in EXACT.iter().copied() {
        let (field, points, distances) = check_sign((shape, inside));
        let outside: Vec<(Point, f64)> =
            points.iter().copied().zip(distances.iter().copied()).filter(|(_, d)| *d > 1e-3).collect();
        let gradients = field.gradients(&outside.iter().map(|(p, _)| *p).collect::<Vec<_>>());
        let mut feet = 0;
        for ((p, d), g) in outside.iter().zip(&gradients) {
            let slope = length(*g);
            assert!(slope < 1.0 + 1e-5, "{shape} has slope {slope} at {p:?}");
            if slope < 1.0 - 1e-5 {
                // A ridge, as near to two parts of the surface.
                continue;
            }
            feet += 1;
            let foot = field.at(moved(*p, *g, -d));
            assert!(foot.abs() < 1e-4, "{shape} at {p:?} is {d}, and {foot} at the foot");
            let beyond = [-2e-3, 2e-3].map(|more| inside(moved(*p, *g, -d + more)));
            assert!(!beyond[1], "{shape} at {p:?}: {d} is too far");
        }
        assert!(
            feet * 10 > outside.len() * 9,
            "{shape} has ridges at {} of {} points",
            outside.len() - feet,
            outside.len()
        );
        // Between any two points the field changes by no more than their distance.
        for (p, q) in points.iter().zip(points.iter().rev()) {
            let apart = length(std::array::from_fn(|i| p[i] - q[i]));
            let change = (field.at(*p) - field.at(*q)).abs();
            assert!(change <= apart * (1.0 + 1e-9), "{shape} changes by {change} from {p:?} to {q:?}");
            if apart > 2.0 {
                break;
            }
        }
    }
}

/// The distance itself, by the nearest of many points of the surface.
#[test]
fn distances_are_those_to_the_nearest_point_of_the_surface() {
    let circle =
        |n: i32| (0..n).map(move |i| (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin_cos());
    let torus: Vec<Point> = circle(400)
        .flat_map(|(s, c)| {
            circle(200).map(move |(u, v)| [(0.8 + 0.25 * v) * c, 0.25 * u, (0.8 + 0.25 * v) * s])
        })
        .collect();
    let share = |i: i32| f64::from(i) / 200.0;
    let cone: Vec<Point> = circle(400)
        .flat_map(|(s, c)| {
            (0..=200).flat_map(move |i| {
                let (t, r) = (share(i), 0.5 * share(i));
                [[r * c, 0.8 - 1.6 * t, r * s], [r * c, -0.8, r * s]]
            })
        })
        .collect();
    for (shape, surface) in [("torus(0.8, 0.25)", torus), ("cone(0.5, 0.8)", cone)] {
        let field = Field::of_shape("", shape);
        for p in points(60, 1.4) {
            let nearest =
                surface.iter().map(|q| length(std::array::from_fn(|i| p[i] - q[i]))).fold(9.0, f64::min);
            let d = field.at(p).abs();
            assert!((d - nearest).abs() < 0.005, "{shape} at {p:?} is {d} and not {nearest}");
        }
    }
}

/// Bounds have the sign of the solid and are never more than the distance.
#[test]
fn bounds_are_never_too_far() {
    let solids: &[Solid] = &[
        ("box(0.3, 0.5, 0.4).scale((2, 1, 0.5))", |[x, y, z]| {
            x.abs() < 0.6 && y.abs() < 0.5 && z.abs() < 0.2
        }),
        ("box(0.6) - sphere(0.5).at(0.5, 0.4, 0.3)", |[x, y, z]| {
            [x, y, z].iter().all(|c| c.abs() < 0.6) && length([x - 0.5, y - 0.4, z - 0.3]) > 0.5
        }),
        ("sphere(0.7) & box(0.5).at(0.3, 0, 0)", |[x, y, z]| {
            length([x, y, z]) < 0.7 && [x - 0.3, y, z].iter().all(|c| c.abs() < 0.5)
        }),
        ("!sphere(0.7)", |p| length(p) > 0.7),
        ("box(0.5).shell(0.2)", |p| {
            let outside = length(p.map(|x| (x.abs() - 0.5).max(0.0)));
            outside < 0.1 && !p.iter().all(|x| x.abs() < 0.4)
        }),
    ];
    for (shape, inside) in solids.iter().copied() {
        let (field, points, distances) = check_sign((shape, inside));
        for ((p, d), direction) in points.iter().zip(&distances).zip(crate::scene::points(3000, 1.0)) {
            let unit = direction.map(|x| x / length(direction));
            let short = moved(*p, unit, d.abs() * 0.999);
            assert_eq!(inside(short), inside(*p), "{shape} at {p:?} is {d}, and {short:?} is nearer");
            let apart = moved(*p, unit, 1e-3);
            assert!((field.at(apart) - d).abs() <= 1.0001e-3, "{shape} is too steep at {p:?}");
        }
    }
}

#[test]
fn an_ellipsoid_has_the_right_sign_and_is_near_the_distance() {
    let (a, b, c) = (0.9, 0.4, 0.6);
    let (field, points, distances) =
        check_sign(("ellipsoid(0.9, 0.4, 0.6)", |[x, y, z]| length([x / 0.9, y / 0.4, z / 0.6]) < 1.0));
    let surface: Vec<Point> = crate::scene::points(40_000, 1.0)
        .into_iter()
        .map(|v| v.map(|x| x / length(v)))
        .map(|[x, y, z]| [a * x, b * y, c * z])
        .collect();
    for (p, d) in points.iter().zip(&distances).filter(|(_, d)| **d > 0.0).take(100) {
        let nearest =
            surface.iter().map(|q| length(std::array::from_fn(|i| p[i] - q[i]))).fold(9.0, f64::min);
        assert!(*d <= nearest * 1.2 + 0.01 && *d >= nearest * 0.4, "at {p:?} it is {d} and not {nearest}");
    }
    assert!((field.at([0.0; 3]) + 0.4).abs() < 1e-9);
}

/// Sizes that leave nothing of a shape still give numbers.
#[test]
fn degenerate_sizes_are_finite() {
    let shapes = [
        "sphere(SIZE)",
        "box(SIZE)",
        "box(1, SIZE, 1)",
        "round_box(1, SIZE)",
        "round_box(SIZE, 0.5)",
        "torus(SIZE, SIZE)",
        "cylinder(SIZE, 1)",
        "cylinder(1, SIZE)",
        "capsule((0, 0, 0), (SIZE, 0, 0), 0.1)",
        "capsule(0, 1, SIZE)",
        "cone(SIZE, 1)",
        "cone(1, SIZE)",
        "cone(SIZE, SIZE)",
        "ellipsoid(SIZE)",
        "ellipsoid(1, SIZE, 1)",
        "octahedron(SIZE)",
        "cut_sphere(SIZE, SIZE)",
        "hollow_sphere(SIZE, SIZE, SIZE)",
        "solid_angle(SIZE, SIZE)",
        "box_frame(SIZE, SIZE)",
        "hex_prism(SIZE, 1)",
        "rhombus_prism(SIZE, 1, 1, SIZE)",
        "pyramid(SIZE, SIZE)",
        "tetrahedron(SIZE)",
        "dodecahedron(SIZE)",
        "icosahedron(SIZE)",
        "triangle3((0, 0, 0), (SIZE, 0, 0), (0, SIZE, 0))",
        "quad((0, 0, 0), (SIZE, 0, 0), (0, SIZE, 0), (0, 0, SIZE))",
        "segment_cylinder((0, 0, 0), (SIZE, 0, 0), SIZE)",
        "capped_cone(SIZE, SIZE, 1)",
        "infinite_cone(SIZE)",
        "round_cone(SIZE, 1, SIZE)",
        "capped_torus(SIZE, SIZE, 1)",
        "link(SIZE, SIZE, SIZE)",
        "tube((0, 0, 0), (SIZE, 0, 0), (0, SIZE, 0), SIZE)",
        "helix(SIZE, SIZE, SIZE)",
        "gyroid(SIZE, SIZE)",
        "heightfield(|v| sin(v.x), SIZE)",
        "menger(SIZE, 2)",
        "mandelbulb(SIZE, 3)",
        "plane((0, SIZE, 0))",
        "circle(SIZE).extrude(SIZE)",
        "rect(SIZE, 1).extrude(1)",
        "triangle((SIZE, 0), (0, 0), (0, SIZE)).extrude(1)",
        "segment((0, 0), (SIZE, 0), SIZE).extrude(1)",
        "ellipse(SIZE).extrude(1)",
        "ellipse((1, SIZE)).extrude(1)",
        "star(5, SIZE, 0).extrude(1)",
        "rhombus((SIZE, 1)).extrude(1)",
        "trapezoid(SIZE, 1, SIZE).extrude(1)",
        "parallelogram(SIZE, SIZE, 1).extrude(1)",
        "pie(SIZE, SIZE).extrude(1)",
        "arc(SIZE, 1, SIZE).extrude(1)",
        "vesica(SIZE, SIZE).extrude(1)",
        "moon(SIZE, 1, SIZE).extrude(1)",
        "moon(SIZE, SIZE, 0).extrude(1)",
        "egg(SIZE, 0).extrude(1)",
        "cross2(SIZE, SIZE).extrude(1)",
        "bezier((0, 0), (SIZE, 0), (0, SIZE), 0).extrude(1)",
        "bezier((SIZE, 0), (SIZE, 0), (SIZE, 0), 0).extrude(1)",
        "half_plane((0, SIZE)).extrude(1)",
        "circle(1).revolve(SIZE)",
        "sphere(1).scale(SIZE)",
        "sphere(1).scale((1, SIZE, 1))",
        "sphere(1).round(SIZE)",
        "sphere(1).shell(SIZE)",
        "sphere(1).elongate(SIZE)",
        "sphere(1).rotate((0, SIZE, 0), 1)",
        "sphere(1).mirror((SIZE, 0, 0))",
        "sphere(1).twist(SIZE)",
        "sphere(1).repeat(x: SIZE)",
        "smin(sphere(1), box(1), k: SIZE)",
        "polygon([(SIZE, 0), (0, 0), (0, SIZE)]).extrude(1)",
    ];
    for shape in shapes {
        for size in ["0", "-1", "1e-30", "1e18"] {
            for how in ["let size = SIZE", "param size = SIZE in -1..1e18"] {
                let text = format!(
                    "{}\nscene {{ {}, sphere(1).at(0, 99, 0) }}\n",
                    how.replace("SIZE", size),
                    shape.replace("SIZE", "size")
                );
                let compilation = compile(&text, &[]);
                // A size that is known to be none is refused; a param that may be none is not, but for a period: then
                // the number of copies has no bound.
                if (how.starts_with("let") || shape.contains("repeat")) && compilation.has_errors() {
                    let mut errors =
                        compilation.diagnostics.iter().filter(|d| d.severity() == Severity::Error);
                    assert!(errors.all(|d| d.code == Code::E043), "{text}");
                    continue;
                }
                let field = Field::of(&text);
                for p in points(20, 3.0).into_iter().chain([[0.0; 3], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) {
                    let d = field.at(p);
                    assert!(d.is_finite(), "{shape} with {how} of {size} is {d} at {p:?}");
                }
            }
        }
    }
}

#[test]
fn nothing_is_far_away() {
    for empty in ["nothing()", "union()", "union([])", "sphere(1) & nothing()"] {
        let d = Field::of_shape("", &format!("{empty}, sphere(1).at(50, 0, 0)")).at([0.0; 3]);
        assert_eq!(d, 49.0, "with {empty}");
    }
}
