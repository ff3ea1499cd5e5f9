//! What a program is made of: which functions, which uniforms, and nothing that nobody asked for.

use crate::scene::{scene, scene_set};
use sdf_ir::program::{Limit, Loop};
use sdf_ir::{Function, FunctionId, Node, Program, Role, Value};
use sdf_lang::Scene;
use std::collections::BTreeSet;

/// What can be reached from the entry.
struct Reached<'p> {
    program: &'p Program,
    functions: BTreeSet<FunctionId>,
    uniforms: BTreeSet<String>,
}

impl<'p> Reached<'p> {
    fn of(scene: &'p Scene) -> Reached<'p> {
        let program = &scene.program;
        let mut reached = Reached { program, functions: BTreeSet::new(), uniforms: BTreeSet::new() };
        let roots = program.entry.into_iter().chain(program.frame);
        roots.for_each(|id| reached.visit(id));
        reached
    }

    fn visit(&mut self, id: FunctionId) {
        if !self.functions.insert(id) {
            return;
        }
        for node in nodes(self.program.function(id)) {
            match node {
                Node::Call(callee, _) => self.visit(callee),
                Node::Uniform(index) | Node::Loop(Loop { limit: Some(Limit { uniform: index, .. }), .. }) => {
                    self.uniforms.insert(self.program.uniforms[index as usize].name.to_string());
                }
                _ => {}
            }
        }
    }

    fn names(&self) -> Vec<&str> {
        self.functions.iter().map(|id| &*self.program.function(*id).name).collect()
    }

    fn count(&self, name: &str) -> usize {
        self.names().iter().filter(|n| **n == name).count()
    }
}

/// All nodes of a function, each once, and the leaves that they use.
fn nodes(function: &Function) -> Vec<Node> {
    let mut out = Vec::new();
    for region in (0..function.region_count()).map(|i| function.region(sdf_ir::RegionId(i as u32))) {
        for value in &region.body {
            out.push(function.node(*value));
            let mut used = Vec::new();
            function.operands(*value, |v: Value| used.push(v));
            out.extend(used.into_iter().map(|v| function.node(v)).filter(is_leaf));
        }
        out.extend(region.results.iter().map(|v| function.node(*v)).filter(is_leaf));
    }
    out
}

fn is_leaf(node: &Node) -> bool {
    matches!(node, Node::Float(_) | Node::Bool(_) | Node::Argument(..) | Node::Uniform(_) | Node::Global(_))
}

fn nodes_of(scene: &Scene, name: &str) -> Vec<Node> {
    let id = scene.program.function_named(name).unwrap_or_else(|| panic!("no function `{name}`"));
    nodes(scene.program.function(id))
}

#[test]
fn what_a_file_names_stays_a_function_of_its_name() {
    let text = "
        fn pillar(r, h) = cylinder(r, h).round(0.03)
        fn hollow(s: shape, t) = field { abs(s(p)) - t }
        let core = smin(sphere(0.5).at(0, 0.5, 0), box(0.4), k: 0.15) - cylinder(0.2, 1)
        let ring = torus(1, 0.1).at(0, 2, 0)
        scene { core.twist(1), pillar(0.2, 2).at(3, 0, 0), pillar(0.1, 1).at(-3, 0, 0), ring.hollow(0.02) }";
    let scene = scene(text);
    let reached = Reached::of(&scene);
    for name in
        ["map_stride", "core", "pillar", "ring", "hollow", "sd_cylinder", "sd_torus", "sd_box", "sd_sphere"]
    {
        assert_eq!(reached.count(name), 1, "`{name}` among {:?}", reached.names());
    }
    let pillar = scene.program.function(scene.program.function_named("pillar").unwrap());
    let parameters: Vec<&str> = pillar.parameters.iter().map(|p| &*p.name).collect();
    assert_eq!(parameters, ["p", "r", "h"]);
    assert_eq!(pillar.line, Some(2));
    let calls = nodes_of(&scene, "map_stride").iter().filter(|n| matches!(n, Node::Call(..))).count();
    assert!(calls >= 4, "the map calls what the file names: {calls}");
}

#[test]
fn a_thousand_spheres_share_one_function() {
    let spheres = |count: usize| {
        scene(&format!(
            "scene {{ for i in 0..{count} {{ sphere(0.1 + i / 5000).at(i % 10, floor(i / 10) % 10, floor(i / 100)) }} }}"
        ))
    };
    let scene = spheres(1000);
    let reached = Reached::of(&scene);
    assert_eq!(reached.count("sd_sphere"), 1);
    let calls = nodes_of(&scene, "map").into_iter().filter(|n| matches!(n, Node::Call(..))).count();
    assert_eq!(calls, 1000);
    assert_eq!(reached.names(), Reached::of(&spheres(2)).names());
}

#[test]
fn what_changes_once_a_frame_is_computed_once_a_frame() {
    let text = "
        param k = 1 in 0..4
        let angle = sin(time * 2) * k
        let r = sqrt(k) + cos(time)
        scene { sphere(r).at(cos(angle), 0, 0), box(0.5).rotate_y(angle), torus(1, exp(-k)) }";
    let scene = scene(text);
    assert!(scene.program.frame.is_some());
    let map = nodes_of(&scene, "map");
    use sdf_ir::Unary::{Cos, Exp, Sin, Sqrt};
    let slow = map.iter().filter(|n| matches!(n, Node::Unary(Sin | Cos | Exp | Sqrt, _))).count();
    assert_eq!(slow, 0, "{map:?}");
    assert!(map.iter().any(|n| matches!(n, Node::Global(_))));
    // No node works on uniforms and globals alone.
    for function in &scene.program.functions {
        if Some(scene.program.function_named(&function.name).unwrap()) == scene.program.frame {
            continue;
        }
        for region in (0..function.region_count()).map(|i| function.region(sdf_ir::RegionId(i as u32))) {
            for value in &region.body {
                let mut operands = Vec::new();
                function.operands(*value, |v| operands.push(function.node(v)));
                let of_frame = |n: &Node| matches!(n, Node::Uniform(_) | Node::Global(_) | Node::Float(_));
                let only = !operands.is_empty() && operands.iter().all(of_frame);
                let calculates =
                    matches!(function.node(*value), Node::Unary(..) | Node::Binary(..) | Node::Ternary(..));
                let constant = operands.iter().all(|n| matches!(n, Node::Float(_)));
                assert!(
                    !(only && calculates && !constant),
                    "{:?} in `{}`",
                    function.node(*value),
                    function.name
                );
            }
        }
    }
}

/// Pairs of scenes that differ in one field: what it calls for is in one and absent in the other.
#[test]
fn effects_are_in_the_program_only_where_they_are_called_for() {
    let light = "light sun { direction: (1, 2, 3), SHADOW }";
    let rows = [
        (
            light.replace("SHADOW", "shadow: hard"),
            light.replace(", SHADOW", ""),
            "hard_shadow",
            "hard shadow",
        ),
        (
            light.replace("SHADOW", "shadow: soft(8)"),
            light.replace(", SHADOW", ""),
            "soft_shadow",
            "soft shadow",
        ),
        (
            light.replace("SHADOW", "shadow: soft(8)"),
            light.replace("SHADOW", "shadow: hard"),
            "soft_shadow",
            "soft shadow",
        ),
        ("ambient { occlusion: 1 }".into(), "ambient { occlusion: 0 }".into(), "occlusion", "occlusion"),
        ("material m { glow: (1, 0, 0) }".into(), "material m { glow: 0 }".into(), "glow", "glow"),
        ("fog { density: 0.1 }".into(), "fog { density: 0, color: #ff0000 }".into(), "fogged", "fog"),
        ("rim { color: 0.5 }".into(), "rim { color: 0, power: 2 }".into(), "rim_light", "rim light"),
        ("render { tonemap: aces }".into(), "render { tonemap: none }".into(), "aces", "tone mapping"),
        ("render { antialias: 2 }".into(), "render { antialias: 1 }".into(), "smoothed", "antialiasing"),
        ("material m { reflect: 0.5 }".into(), "material m { reflect: 0 }".into(), "mirror", "reflection"),
        (
            "material m { reflect: 0.5 }".into(),
            "material m { reflect: 0.5 } render { bounces: 0 }".into(),
            "mirror",
            "reflection",
        ),
        (
            "material m { transmit: 1 }".into(),
            "material m { transmit: 0, ior: 2 }".into(),
            "refracted",
            "transmission",
        ),
        (
            "fn shade(s) = reflection() + occlusion() render { bounces: 1 }".into(),
            "fn shade(s) = occlusion()".into(),
            "mirrored_light",
            "reflection",
        ),
        (
            "fn shade(s) = reflection() + occlusion()".into(),
            "fn shade(s) = s.color".into(),
            "occlusion",
            "occlusion",
        ),
        (
            format!("{} fn shade(s) = shadow(sun)", light.replace("SHADOW", "shadow: hard")),
            format!("{} fn shade(s) = sun.color", light.replace("SHADOW", "shadow: hard")),
            "hard_shadow",
            "hard shadow",
        ),
        ("render { normals: central }".into(), String::new(), "central_gradient", ""),
        ("render { normals: tetrahedron }".into(), String::new(), "tetrahedron_gradient", ""),
        (String::new(), "render { relax: none }".into(), "relaxed_step", "relaxation"),
        ("render { relax: none }".into(), String::new(), "plain_step", ""),
    ];
    for (with, without, function, effect) in rows {
        let shape = if with.contains("material m") { "torus(1, 0.3).paint(m)" } else { "torus(1, 0.3)" };
        let [with, without] = [with, without].map(|items| scene(&format!("{items}\nscene {{ {shape} }}")));
        assert_eq!(Reached::of(&with).count(function), 1, "`{function}` in {:?}", Reached::of(&with).names());
        assert_eq!(Reached::of(&without).count(function), 0, "`{function}` is not called for");
        if !effect.is_empty() {
            assert!(with.summary.effects.contains(&effect), "{effect} in {:?}", with.summary.effects);
            assert!(!without.summary.effects.contains(&effect), "{effect} is not called for");
        }
    }
}

#[test]
fn uniforms_are_there_only_where_something_needs_them() {
    let uniforms = |text: &str, set: &[(&str, &str)]| -> Vec<String> {
        let scene = scene_set(text, set);
        let declared: Vec<String> = scene.program.uniforms.iter().map(|u| u.name.to_string()).collect();
        let is_setting =
            |n: &String| scene.program.uniforms.iter().any(|u| *u.name == **n && u.role == Role::Setting);
        let needed = Reached::of(&scene).uniforms;
        let mut sorted = declared.clone();
        sorted.sort();
        assert_eq!(sorted, needed.into_iter().collect::<Vec<_>>(), "declared and needed in {text}");
        declared.iter().filter(|n| *n != "resolution" && !is_setting(n)).cloned().collect()
    };
    assert_eq!(uniforms("scene { sphere(1) }", &[]), [""; 0]);
    assert_eq!(uniforms("scene { sphere(1 + time) }", &[]), ["time"]);
    assert_eq!(uniforms("scene { sphere(1).at(mouse.x, 0, 0) }", &[]), ["mouse"]);
    assert_eq!(uniforms("let unused = time scene { sphere(1) }", &[]), [""; 0]);
    let param = "param k = 1 in 0..2 ambient { occlusion: k } scene { sphere(1) }";
    assert_eq!(uniforms(param, &[]), ["k"]);
    assert_eq!(uniforms(param, &[("k", "2")]), [""; 0]);
    assert_eq!(Reached::of(&scene_set(param, &[])).count("occlusion"), 1);
    assert_eq!(Reached::of(&scene_set(param, &[("k", "2")])).count("occlusion"), 1);
    assert_eq!(Reached::of(&scene_set(param, &[("k", "0")])).count("occlusion"), 0);
    let roles: Vec<Role> = scene(
        "param c = #ff0000 param on = true param k = 1 in -1..2
        scene { sphere(if on { k } else { time }).paint(c) }",
    )
    .program
    .uniforms
    .iter()
    .map(|u| u.role)
    .collect();
    for role in [
        Role::Param { range: None, color: true },
        Role::Param { range: None, color: false },
        Role::Param { range: Some((-1.0, 2.0)), color: false },
        Role::Time,
        Role::Resolution,
    ] {
        assert!(roles.contains(&role), "{role:?} among {roles:?}");
    }
}

/// A scene that calls for nothing is the march, a normal and a light.
#[test]
fn the_plainest_scene_has_no_more_than_it_needs() {
    let text = "light sun { direction: (1, 2, 3) } render { relax: none } scene { sphere(1) }";
    let scene = scene(text);
    let names = Reached::of(&scene).names().into_iter().map(String::from).collect::<Vec<_>>();
    for absent in
        ["hard_shadow", "soft_shadow", "shadow", "occlusion", "glow", "glow_sample", "relaxed_step", "sky"]
    {
        assert!(!names.iter().any(|n| n == absent), "`{absent}` among {names:?}");
    }
}
