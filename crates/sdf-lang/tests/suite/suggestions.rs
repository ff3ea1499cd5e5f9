//! What was meant: every kind of name has a suggestion where one is near, and none where none is.

use crate::scene::{compile, described};

/// A mistake, and what is suggested.
const ROWS: &[(&str, &str)] = &[
    // Variables, constants, values and params.
    ("let radius = 1 scene { sphere(raduis) }", "did you mean `radius`?"),
    ("fn f(width) = box(widht) scene { f(1) }", "did you mean `width`?"),
    ("scene { let height = 1; sphere(hieght) }", "did you mean `height`?"),
    ("scene { for index in 0..3 { sphere(indx) } }", "did you mean `index`?"),
    ("scene { field { let along = p.x; aling } }", "did you mean `along`?"),
    ("let f = |amount| ammount scene { sphere(f(1)) }", "did you mean `amount`?"),
    ("scene { sphere(tiem) }", "did you mean `time`?"),
    ("param thickness = 1 in 0..2 scene { sphere(thicknes) }", "did you mean `thickness`?"),
    ("material stone { color: 1 } scene { sphere(1).paint(stnoe) }", "did you mean `stone`?"),
    // Functions and methods, the file's, the library's, built-in ones, and those of other languages.
    ("fn pillar(r) = sphere(r) scene { piller(1) }", "did you mean `pillar`?"),
    ("scene { shpere(1) }", "did you mean `sphere`?"),
    ("scene { sphere(1).rotat(y, 1) }", "did you mean `rotate`?"),
    ("scene { sphere(clmap(1, 0, 2)) }", "did you mean `clamp`?"),
    ("scene { sphere(1).onion(0.1) }", "write `s.shell(thickness)`"),
    ("scene { sphere(mod(1, 2)) }", "write the floor modulo as `a % b`"),
    // Named arguments.
    ("scene { torus(major: 1, mnior: 0.2) }", "did you mean `minor`?"),
    ("fn pillar(radius) = sphere(radius) scene { pillar(raduis: 1) }", "did you mean `radius`?"),
    ("let f = |radius| sphere(radius) scene { f(raduis: 1) }", "did you mean `radius`?"),
    ("scene { box(1).rotate(y, angel: 1) }", "did you mean `angle`?"),
    ("scene { sphere(iterate(3, 0, |i, s| s, untli: |s| true)) }", "did you mean `until`?"),
    // Fields of blocks, materials and records.
    ("camera { taget: 0 } scene { sphere(1) }", "did you mean `target`?"),
    ("light a { direction: 1, inensity: 1 } scene { sphere(1) }", "did you mean `intensity`?"),
    ("ambient { oclusion: 1 } scene { sphere(1) }", "did you mean `occlusion`?"),
    ("sky { horizont: 1, zenith: 1 } scene { sphere(1) }", "did you mean `horizon`?"),
    ("fog { densty: 1 } scene { sphere(1) }", "did you mean `density`?"),
    ("rim { pwoer: 1 } scene { sphere(1) }", "did you mean `power`?"),
    ("render { tolerence: 1 } scene { sphere(1) }", "did you mean `tolerance`?"),
    ("material m { shinyness: 1 } scene { sphere(1).paint(m) }", "did you mean `shininess`?"),
    ("scene { sphere(1).paint(material { specualr: 1 }) }", "did you mean `specular`?"),
    ("let s = (width: 1, height: 2) scene { sphere(s.widht) }", "did you mean `width`?"),
    ("let s = (width: 1, height: 2) scene { sphere(s.widht(1)) }", "did you mean `width`?"),
    // Fields by the names of other tools.
    ("camera { position: 1 } scene { sphere(1) }", "the camera's place is `eye`"),
    ("camera { look_at: 1 } scene { sphere(1) }", "what it looks at is `target`"),
    ("light a { direction: 1, brightness: 2 } scene { sphere(1) }", "its strength is `intensity`"),
    ("material m { albedo: 1 } scene { sphere(1) }", "the colour is `color`"),
    ("render { maxSteps: 100 } scene { sphere(1) }", "write `steps`"),
    // What stands in other languages.
    (
        "fn f(p: vec3) -> float { length(p) } scene { sphere(f(x)) }",
        "leave out the `->` and the type: `fn f(a: vec3) { … }`",
    ),
    ("scene { field(p) { length(p) - 1 } }", "write `field { … }`; the point is called `p`"),
    ("scene { |p| length(p) - 1 }", "call it, or write a shape by its distance: `field { … p … }`"),
    ("param a in 0..1 = 0.5 scene { sphere(a + 1) }", "write for example `param a = 0.5 in 0..1`"),
    (
        "let l = [sphere(1), box(1)] scene { l.paint(#f00) }",
        "`s` must be a shape, not a list of 2; `union(list)` makes one shape of several",
    ),
    // Words.
    ("camera { projection: perspectiv } scene { sphere(1) }", "did you mean `perspective`?"),
    ("render { normals: tetrahedral } scene { sphere(1) }", "did you mean `tetrahedron`?"),
    ("render { relax: atuo } scene { sphere(1) }", "did you mean `auto`?"),
    ("render { tonemap: acse } scene { sphere(1) }", "did you mean `aces`?"),
    ("render { quality: balnced } scene { sphere(1) }", "did you mean `balanced`?"),
    ("light a { direction: 1, shadow: sfot(8) } scene { sphere(1) }", "did you mean `soft(8)`?"),
    // Attributes, types, units, items.
    ("@exat fn f() = sphere(1) scene { f() }", "did you mean `@exact`?"),
    ("@requries(1 > 0, \"a\") fn f() = sphere(1) scene { f() }", "did you mean `@requires`?"),
    ("fn f(s: shap) = s scene { f(sphere(1)) }", "did you mean `shape`?"),
    ("fn f(s: Vec3) = s scene { sphere(f((1, 2, 3)).x) }", "did you mean `vec3`?"),
    ("scene { sphere(1).rotate_y(45dge) }", "did you mean `45deg`?"),
    ("scene { sphere(1).rotate_y(1turns) }", "did you mean `1turn`?"),
    ("sceen { sphere(1) }", "did you mean `scene`?"),
    ("ligth sun { direction: 1 }\nscene { sphere(1) }", "did you mean `light`?"),
    ("metarial a { color: 1 }\nscene { sphere(1) }", "did you mean `material`?"),
    ("camrea { fov: 1 }\nscene { sphere(1) }", "did you mean `camera`?"),
    ("improt \"a.sdf\"\nscene { sphere(1) }", "did you mean `import`?"),
    ("parm a = 1 in 0..2\nscene { sphere(1) }", "did you mean `param`?"),
    ("lte a = 1\nscene { sphere(1) }", "did you mean `let`?"),
    ("fun f(a) = a\nscene { sphere(1) }", "write `fn`"),
    // Components.
    ("let v = (1, 2, 3) scene { sphere(v.X) }", "did you mean `.x`?"),
    ("let v = (1, 2, 3) scene { sphere(v.XYZ.x) }", "did you mean `.xyz`?"),
    (
        "let v = (1, 2) scene { sphere(v.xyz.x) }",
        "its components are `.x` and `.y`, in any order and number up to 3",
    ),
    ("let v = (1, 2, 3) scene { sphere(v.xg) }", "`.x .y .z` and `.r .g .b` do not mix"),
];

#[test]
fn every_kind_of_name_has_suggestions() {
    let mut wrong = Vec::new();
    for (text, expected) in ROWS {
        let found = compile(text, &[]).diagnostics;
        let says =
            |d: &sdf_syntax::Diagnostic| d.help.as_deref() == Some(*expected) || d.label.ends_with(expected);
        // One mistake is one message.
        if found.len() != 1 || !says(&found[0]) {
            wrong.push(format!("{text}\n  {expected}\n  {found:#?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn params_to_set_have_suggestions() {
    let compilation = compile("param spin = 1 in 0..2 scene { sphere(spin) }", &[("sipn", "1")]);
    assert_eq!(described(&compilation), ["E065: there is no param `sipn` to set; did you mean `spin`?"]);
}

#[test]
fn what_is_like_nothing_has_no_suggestion() {
    for text in ["scene { sphere(quux) }", "scene { blargh(1) }", "camera { zzz: 1 } scene { sphere(1) }"] {
        let found = described(&compile(text, &[]));
        assert!(found.len() == 1 && !found[0].contains("did you mean"), "{found:#?}");
    }
}
