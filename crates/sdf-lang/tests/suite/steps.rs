//! How far a ray may step: never past a surface, and no less than it could where nothing is steep.

use crate::scene::{Field, Point, length, points, scene};

const ITEMS: &str = "
    camera { eye: (0, 0, 60) }
    let column = box(0.4, 1.2, 0.5).at(0.2, 0, 0.1).twist(3)
    let ball = sphere(0.5).at(3, 0, 0)
    @lipschitz(2.5 * slope(s))
    fn stretched(s: shape) = field { s(p * 2.5) }";

/// The part of random steps of `step` from outside of `shape` that end in it: any is one too many.
fn passes(shape: &str, step: &str, size: f64) -> f64 {
    let field = Field::of_shape(ITEMS, shape);
    let steps = Field::of_values(ITEMS, step);
    let from = points(4_000, size);
    let (distances, lengths) = (field.distances(&from), steps.distances(&from));
    let directions: Vec<Point> = points(40, 1.0).iter().map(|d| d.map(|x| x / length(*d))).collect();
    let (mut tried, mut passed) = (0, 0);
    for direction in &directions {
        let ends: Vec<Point> = from
            .iter()
            .zip(&lengths)
            .map(|(p, l)| std::array::from_fn(|i| p[i] + direction[i] * l * 0.999))
            .collect();
        for (before, after) in distances.iter().zip(field.distances(&ends)) {
            if *before > 0.0 {
                tried += 1;
                passed += usize::from(after < 0.0);
            }
        }
    }
    assert!(tried > 50_000, "{tried} steps were tried from outside of {shape}");
    passed as f64 / tried as f64
}

#[test]
fn no_step_passes_a_surface() {
    for shape in [
        "column",
        "column.at(0.3, -0.2, 0.1).rotate((1, 2, 0), 40deg)",
        "column | ball",
        "smin(column, ball.at(-2.2, 0, 0), k: 0.3)",
        "column - ball.at(-2.5, 0.5, 0)",
        "column.paint(#f00)",
        "if time < 1 { column } else { ball }",
        "stretched(column)",
    ] {
        assert_eq!(passes(shape, &format!("stride({shape}, p)"), 2.5), 0.0, "{shape}");
    }
}

/// The same with the distance as the step: without the correction, steps do pass the surface.
#[test]
fn steps_of_the_distance_pass_it() {
    for shape in ["column", "smin(column, ball.at(-2.2, 0, 0), k: 0.3)", "stretched(column)"] {
        assert!(passes(shape, &format!("({shape})(p)"), 2.5) > 1e-4, "{shape}");
    }
}

#[test]
fn the_correction_is_on_the_branch_that_needs_it() {
    let whole = Field::of_values(ITEMS, "(column | ball)(p)");
    let step = Field::of_values(ITEMS, "stride(column | ball, p)");
    for at in [[3.0, 0.6, 0.0], [3.7, 0.0, 0.0], [3.0, 0.0, 0.65]] {
        assert_eq!(step.at(at), whole.at(at), "near the ball at {at:?}");
    }
    let near_column = [0.9, 0.1, 0.2];
    assert!(step.at(near_column) < 0.8 * whole.at(near_column), "near the column");
}

#[test]
fn where_nothing_is_steep_there_is_no_second_function() {
    let names = |shape: &str| -> Vec<String> {
        let scene = scene(&format!("{ITEMS}\nscene {{ {shape}, plane(y, 2) }}"));
        scene.program.functions.iter().map(|f| f.name.to_string()).collect()
    };
    let has_step = |names: Vec<String>| names.iter().any(|n| n.contains("stride"));
    assert!(!has_step(names("ball, smin(ball, box(1).rotate_y(1), k: 0.2).round(0.1)")));
    assert!(has_step(names("ball, column")));
}
