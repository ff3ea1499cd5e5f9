//! Scenes rewritten so that they show the same: moved, scaled, in another order, wrapped in what changes nothing.
//!
//! The text is edited at the places that its tree tells; whatever is not rewritten stays as it is written.

use sdf_syntax::tree::{Expr, ExprKind, File, ItemKind, Record, SettingsKind};
use sdf_syntax::{FileId, Span};

/// The shapes of a scene and its camera moved by `by`, a vector as it is written.
pub fn moved(text: &str, by: &str) -> String {
    let tree = tree(text);
    let mut edits = Edits::new(text);
    for shape in shapes(&tree) {
        edits.wrap(shape, &format!(".at({by})"));
    }
    for place in places(&tree) {
        edits.replace(place.span, |place| format!("{place} + {by}"));
    }
    edits.made()
}

/// A scene whose camera looks from the same place in the same direction, at something far beyond all that there is.
pub fn looking_far(text: &str) -> String {
    let tree = tree(text);
    let mut edits = Edits::new(text);
    for item in &tree.items {
        if let ItemKind::Settings(SettingsKind::Camera, camera) = &item.kind {
            let eye = &text[range(field(camera, "eye").expect("a camera with an eye").span)];
            let target = field(camera, "target").expect("a camera with a target");
            edits.replace(target.span, |target| format!("{eye} + (({target}) - ({eye})) * 1000000"));
        }
    }
    edits.made()
}

/// A scene and its camera `factor` times as large, with all lengths of its settings.
pub fn scaled(text: &str, factor: u32) -> String {
    let tree = tree(text);
    let mut edits = Edits::new(text);
    for shape in shapes(&tree) {
        edits.wrap(shape, &format!(".scale({factor})"));
    }
    for place in places(&tree) {
        edits.replace(place.span, |place| format!("({place}) * {factor}"));
    }
    let mut has_far = false;
    for item in &tree.items {
        match &item.kind {
            ItemKind::Settings(SettingsKind::Ambient, record) => edits.scale(record, "radius", 0.5, factor),
            ItemKind::Settings(SettingsKind::Render, record) => {
                has_far = true;
                edits.scale(record, "far", 100.0, factor);
            }
            ItemKind::Material(_, record) if field(record, "glow").is_some() => {
                edits.scale(record, "glow_radius", 0.25, factor);
            }
            _ => {}
        }
    }
    let far = if has_far { String::new() } else { format!("\nrender {{ far: {} }}\n", 100 * factor) };
    edits.made() + &far
}

/// The shapes of a scene in the opposite order.
pub fn reversed(text: &str) -> String {
    let tree = tree(text);
    let mut edits = Edits::new(text);
    let shapes = shapes(&tree);
    for (shape, other) in shapes.iter().zip(shapes.iter().rev()) {
        let other = &text[range(other.span)];
        edits.replace(shape.span, |_| other.to_owned());
    }
    edits.made()
}

/// Each shape of a scene moved by nothing, turned by nothing and scaled by one.
pub fn wrapped(text: &str) -> String {
    let tree = tree(text);
    let mut edits = Edits::new(text);
    for shape in shapes(&tree) {
        edits.wrap(shape, ".at(0, 0, 0).rotate_y(0).scale(1)");
    }
    edits.made()
}

fn tree(text: &str) -> File {
    let (tree, diagnostics) = sdf_syntax::parse(FileId::default(), text);
    assert_eq!(diagnostics, [], "{text}");
    tree
}

/// The entries of the block `scene`.
fn shapes(tree: &File) -> Vec<&Expr> {
    let scenes = tree.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Scene(scene) => Some(&scene.shapes),
        _ => None,
    });
    scenes.flatten().collect()
}

/// The settings that are places in the world.
fn places(tree: &File) -> Vec<&Expr> {
    let mut places = Vec::new();
    for item in &tree.items {
        match &item.kind {
            ItemKind::Settings(SettingsKind::Camera, camera) => {
                let [eye, target] = ["eye", "target"].map(|name| field(camera, name));
                // Where the target has a default, it cannot be rewritten.
                places.extend([eye.expect("a camera with an eye"), target.expect("a camera with a target")]);
            }
            ItemKind::Light(_, light) => places.extend(field(light, "position")),
            _ => {}
        }
    }
    places
}

fn field<'r>(record: &'r Record, name: &str) -> Option<&'r Expr> {
    record.fields.iter().find(|field| &*field.name.text == name).map(|field| &field.value)
}

fn range(span: Span) -> std::ops::Range<usize> {
    span.start as usize..span.end as usize
}

/// Changes to a text, which do not overlap.
struct Edits<'t> {
    text: &'t str,
    edits: Vec<(Span, String)>,
}

impl<'t> Edits<'t> {
    fn new(text: &'t str) -> Edits<'t> {
        Edits { text, edits: Vec::new() }
    }

    fn replace(&mut self, span: Span, change: impl FnOnce(&str) -> String) {
        self.edits.push((span, change(&self.text[range(span)])));
    }

    /// Calls methods of a shape, or the union of the shapes that a `for` makes.
    fn wrap(&mut self, shape: &Expr, behind: &str) {
        let many = matches!(shape.kind, ExprKind::For { .. } | ExprKind::List(_));
        let whole = if many { "union" } else { "" };
        self.replace(shape.span, |shape| format!("{whole}({shape}){behind}"));
    }

    /// Makes a length `factor` times as large; one that a record does not name has the `default`.
    fn scale(&mut self, record: &Record, name: &str, default: f64, factor: u32) {
        match field(record, name) {
            Some(value) => self.replace(value.span, |value| format!("({value}) * {factor}")),
            None => {
                let open = Span { end: record.span.start + 1, ..record.span };
                let value = default * f64::from(factor);
                self.replace(open, |bracket| format!("{bracket} {name}: {value}, "));
            }
        }
    }

    /// The text with the changes.
    fn made(mut self) -> String {
        self.edits.sort_by_key(|(span, _)| span.start);
        let mut made = String::new();
        let mut end = 0;
        for (span, change) in &self.edits {
            made += &self.text[end..span.start as usize];
            made += change;
            end = span.end as usize;
        }
        made + &self.text[end..]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "camera { eye: (1, 2, 3), target: a }
ambient { occlusion: 1 }
material m { glow: 1 }
scene { sphere(1), for i in 0..3 { box(i) } }";

    #[test]
    fn everything_that_has_a_place_is_moved() {
        let wanted = "camera { eye: (1, 2, 3) + (4, 5, 6), target: a + (4, 5, 6) }
ambient { occlusion: 1 }
material m { glow: 1 }
scene { (sphere(1)).at((4, 5, 6)), union(for i in 0..3 { box(i) }).at((4, 5, 6)) }";
        assert_eq!(moved(TEXT, "(4, 5, 6)"), wanted);
    }

    #[test]
    fn every_length_is_scaled() {
        let wanted = "camera { eye: ((1, 2, 3)) * 8, target: (a) * 8 }
ambient { radius: 4,  occlusion: 1 }
material m { glow_radius: 2,  glow: 1 }
scene { (sphere(1)).scale(8), union(for i in 0..3 { box(i) }).scale(8) }
render { far: 800 }
";
        assert_eq!(scaled(TEXT, 8), wanted);
    }

    #[test]
    fn a_camera_looks_farther() {
        let far = looking_far(TEXT);
        assert!(
            far.starts_with("camera { eye: (1, 2, 3), target: (1, 2, 3) + ((a) - ((1, 2, 3))) * 1000000 }"),
            "{far}"
        );
    }

    #[test]
    fn shapes_change_places() {
        assert!(reversed(TEXT).ends_with("scene { for i in 0..3 { box(i) }, sphere(1) }"));
    }
}
