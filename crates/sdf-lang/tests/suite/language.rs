//! How a file may be written, seen in what its scene is: separators, comments, words that are names elsewhere, names
//! that hide others, materials.

use crate::scene::{Field, findings, scene};

/// Scenes with the radius of the ball that they show round the origin.
const ROWS: &[(&str, f64)] = &[
    // `;` between items and after bindings, and commas behind the last of every list.
    ("let a = 2; fn f(x) = x; material m { color: 1 }; camera { fov: 1 }; scene { sphere(f(a)) };", 2.0),
    ("let a = 2 fn f(x) = x material m { color: 1 } camera { fov: 1 } scene { sphere(f(a)) }", 2.0),
    ("fn f(x, y,) { let z = x let w = y; z + w } scene { sphere(f(1, 2,),), }", 3.0),
    ("let l = [1, 2,] let t = (3, 4,) let r = (a: 5, b: 6,) scene { sphere(l[1] + t.x + r.b,), }", 11.0),
    ("camera { eye: (0, 0, 9), fov: 1, } let f = |a, b,| a + b scene { sphere(f(1, 2)) }", 3.0),
    // Text: marks, line ends, comments in comments.
    ("\u{feff}scene {\r\n  sphere(2)\r\n}\r\n", 2.0),
    ("/* a /* b */ c */ scene { // sphere(9)\n sphere(2) /* , sphere(9) */ }", 2.0),
    ("/// What it is.\n/// And more.\nfn f() = 2\n// apart\nscene { sphere(f()) }", 2.0),
    // Words that begin items are names elsewhere, also in the file where they begin items.
    (
        "let material = 1 let camera = 2 let light = 3 let ambient = 4 let sky = 5 let fog = 6 let rim = 7 let render = 8
        let scene = 9 camera { fov: 1 } material stone { color: 1 } light rim { direction: 1 }
        scene { sphere(material + camera + light + ambient + sky + fog + rim + render + scene) }",
        45.0,
    ),
    ("fn scene(light) = sphere(light) scene { scene(2) }", 2.0),
    ("let s = (scene: 2, light: 3) scene { sphere(s.scene * s.light) }", 6.0),
    // Lights have names of their own.
    ("light size { direction: 1 } let size = 2 fn sun() = 3 light sun { position: 9 } scene { sphere(size + sun()) }", 5.0),
    // Inner bindings hide outer ones, the file's hide the library's, and a parameter may have any name.
    ("let r = 1 fn f(r) { let r = r + 1; { let r = r * 10; r } + r } scene { sphere(f(2)) }", 33.0),
    ("let r = 5 scene { let r = 2; sphere(r) }", 2.0),
    ("fn sphere(r) = box(2 * r) scene { sphere(2).round(0.5) }", 4.5),
    ("fn f(sphere) = box(sphere) scene { f(2) }", 2.0),
    ("let x = 2 scene { sphere(x) }", 2.0),
    ("fn f(time, p) = time + p scene { sphere(f(1, 2)) }", 3.0),
    // Every function is a method, also on numbers, vectors, lists, functions and records.
    (
        "fn twice(v) = v * 2 fn first(l) = l[0] fn call(f, v) = f(v) fn width(s) = s.w
        scene { sphere(1.twice() + (1, 2).twice().y + [3].first() + twice.call(4) + (w: 5).width()) }",
        1.0 * 2.0 + 4.0 + 3.0 + 8.0 + 5.0,
    ),
    ("fn grown(s, by) = s.round(by) scene { sphere(1).grown(2).grown(by: 3) }", 6.0),
    // Defaults use earlier parameters, also those that have defaults.
    ("fn f(a, b = a * 2, c = a + b) = a + b + c scene { sphere(f(1) + f(1, c: 0) + f(1, 5)) }", 6.0 + 3.0 + 12.0),
    // Any number of arguments, lists among them, and names after them.
    ("fn f(v..., by = 1) = sum(v) * by scene { sphere(f(1, [2, 3], 4) + f([], by: 5) + f(1, 1, by: 2)) }", 14.0),
    ("fn u(shapes...) = union(shapes) scene { u(sphere(1), [sphere(2), box(0.1)]) }", 2.0),
    // Blocks are values, and so is what stands in them.
    ("scene { { let a = sphere(1); a.round(1) } }", 2.0),
    ("scene { let a = [for i in 1..4 { sphere(i) }]; a[0] }", 3.0),
    ("scene { sphere(if 1 < 2 { 2 } else if 2 < 3 { 3 } else { 4 }) }", 2.0),
    ("scene { if true { sphere(2) } else { box(1) } }", 2.0),
    ("scene { for i in [1, 2] { for j in 0..2 { sphere(i + j) } } }", 3.0),
    // A lambda reaches as far as it can; an infix bar is a union.
    ("let f = |a| a | a.at(9, 0, 0) scene { f(sphere(2)) }", 2.0),
    ("let f = |a, b = 3| a + b * 2 scene { sphere(f(1)) | sphere(1) }", 7.0),
    ("let f = || 2 scene { sphere(f()) }", 2.0),
    // Shapes are functions, and functions are shapes of a point.
    ("let s = sphere(1) scene { field { s(p) - 1 } }", 2.0),
    ("let s = sphere(1) scene { field { s(p.x, p.y, p.z) - 1 } }", 2.0),
    ("let c = circle(2) scene { field { max(c(p.xy), c(p.z, p.x)) } }", 2.0),
];

#[test]
fn files_are_written_freely() {
    let mut wrong = Vec::new();
    for (text, radius) in ROWS {
        let found = findings(text);
        if !found.is_empty() {
            wrong.push(format!("{text}\n  {found:?}"));
            continue;
        }
        let at_origin = -Field::of(text).at([0.0; 3]);
        if (at_origin - radius).abs() > 1e-12 * radius {
            wrong.push(format!("{text}\n  is {at_origin} and not {radius}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Wherever a material is wanted, a name, an expression and a colour will do.
#[test]
fn materials_are_values() {
    let with = |material: &str| {
        scene(&format!(
            "material red {{ color: #ff0000 }}
            fn glossy(c) = material {{ color: c, specular: 1 }}
            fn coated(s: shape, m: material) = s.paint(m)
            let kinds = [red, glossy(#00ff00)] let kept = (m: red)
            scene {{ {material} }}"
        ))
        .program
        .to_string()
    };
    let plain = with("sphere(1)");
    let painted = with("sphere(1).paint(red)");
    assert_ne!(plain, painted);
    for same in [
        "sphere(1).paint(kinds[0])",
        "sphere(1).paint(kept.m)",
        "sphere(1).paint(m: red)",
        "paint(sphere(1), red)",
    ] {
        assert_eq!(with(same), painted, "{same}");
    }
    assert_ne!(with("sphere(1).paint(kinds[1])"), painted);
    assert_eq!(with("sphere(1).paint(#ff0000)"), painted);
    assert_eq!(with("sphere(1).paint((1, 0, 0))"), painted);
    assert_eq!(with("sphere(1).coated(#ff0000)"), with("sphere(1).coated(red)"));
    // It sees the variables in scope.
    assert_eq!(
        with("for c in [#00ff00] { sphere(1).paint(material { color: c, specular: 1 }) }"),
        with("sphere(1).paint(glossy(#00ff00))")
    );
}
