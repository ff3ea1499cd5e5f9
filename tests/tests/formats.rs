//! What naga's back ends make of every example: SPIR-V and HLSL are compiled by the reference tools and drawn by a
//! Vulkan driver; of Metal's text, for which there is no compiler here, it is known that nothing is missing.

use sdf_emit::UniformLayout;
use sdf_lang::Options;
use sdf_render::gpu::Shader as Source;
use sdf_render::{Frame, Picture, cpu};
use sdf_tests::adapter::adapter;
use sdf_tests::agreement::compare;
use sdf_tests::glslang::{complaint_about_spir_v, spir_v_of_hlsl};
use sdf_tests::scenes::{Buffers, Example, examples, scene};
use sdfc::{Clock, Format, Shader, Target};

const SIZE: [u32; 2] = [192, 108];

/// Names that mean something in Metal's language or in HLSL, or that naga writes in its own way.
const NAMES: &str = "param constant = 0.5 in 0..1
param device = true
param half3 = #ff8040
param a1 = 0.25 in 0..1
fn kernel(vertex) = sphere(vertex)
fn threadgroup(s: shape, metal) = field { s(p) - metal }
fn float4(fragment) = box(fragment, 0.3, 0.2)
let main0 = kernel(constant).threadgroup(a1)
scene { main0.paint(half3), float4(0.6).at(if device { 1 } else { 0.8 }, mouse.y, 0).paint(material { color: 0.5 + 0.5 * n }) }";

fn compiled(example: &Example) -> Shader {
    let compiled = sdfc::compile(&example.name, &example.text, &Options::default(), &mut Clock::default());
    let said: Vec<&String> = compiled.diagnostics.iter().map(|d| &d.message).collect();
    compiled.output.unwrap_or_else(|| panic!("{}: {said:?}", example.name)).1
}

fn file(shader: &Shader, format: Format) -> Vec<u8> {
    shader.file(format).unwrap_or_else(|error| panic!("{format:?}: {}", error.message))
}

fn text(shader: &Shader, format: Format) -> String {
    String::from_utf8(file(shader, format)).expect("a text")
}

/// The examples, and a scene of nasty names.
fn scenes() -> Vec<Example> {
    let names = Example { name: "names".into(), text: NAMES.into() };
    examples().into_iter().chain([names]).collect()
}

/// The names of a WGSL text's functions, its entries apart.
fn functions(wgsl: &str) -> Vec<&str> {
    let names = wgsl.lines().filter_map(|line| line.strip_prefix("fn ")?.split('(').next());
    names.filter(|name| !["vs_main", "fs_main"].contains(name)).collect()
}

/// Fails unless both modules draw what the interpreter draws.
fn draws_alike(example: &Example, shader: &Shader, vertex: &[u8], fragment: &[u8], what: &str) {
    let frame = Frame { time: 0.6, mouse: [0.4, 0.3], ..Frame::new(SIZE[0], SIZE[1]) };
    let uniforms = UniformLayout::of(&shader.program).bytes(SIZE, &frame.uniforms(&shader.program));
    let source = Source::SpirV { vertex, fragment };
    let rgba = adapter().render(source, SIZE, &uniforms, 64, &mut |_, _| {});
    let rgba = rgba.unwrap_or_else(|error| panic!("{}, {what}: {error}", example.name));
    let found = Picture { width: SIZE[0], height: SIZE[1], rgba };
    let probed = scene(&example.name, &example.text, &Options { probe: true, ..Options::default() });
    let agreement = compare(&cpu::render(&shader.program, &frame), &found, &Buffers::of(&probed, &frame));
    assert_eq!(agreement.complaint(), None, "{}, {what}", example.name);
}

#[test]
fn spir_v_is_valid_and_draws_every_example() {
    for example in scenes() {
        let shader = compiled(&example);
        let module = file(&shader, Format::SpirV);
        assert_eq!(complaint_about_spir_v(&module), None, "{}", example.name);
        draws_alike(&example, &shader, &module, &module, "SPIR-V");
    }
}

#[test]
fn hlsl_is_taken_by_another_compiler_and_draws_every_example() {
    for example in scenes() {
        let shader = compiled(&example);
        let text = text(&shader, Format::Hlsl);
        let [vertex, fragment] = [("vert", "vs_main"), ("frag", "fs_main")].map(|(stage, entry)| {
            spir_v_of_hlsl(&text, stage, entry).unwrap_or_else(|said| panic!("{}: {said}", example.name))
        });
        draws_alike(&example, &shader, &vertex, &fragment, "HLSL");
    }
}

#[test]
fn metal_has_every_function_and_both_entries() {
    for example in scenes() {
        let shader = compiled(&example);
        let (wgsl, metal) = (text(&shader, Format::Text(Target::Wgsl)), text(&shader, Format::Metal));
        assert!(metal.contains("vertex vs_mainOutput vs_main("), "{}", example.name);
        assert!(metal.contains("fragment fs_mainOutput fs_main("), "{}", example.name);
        assert!(metal.contains("constant Uniforms& uniforms [[buffer(0)]]"), "{}", example.name);
        let names = functions(&wgsl);
        assert!(names.len() > 5, "{names:?}");
        for name in names {
            // naga ends a name that ends with a digit, or that Metal has a meaning for, with an underscore.
            let defined = metal.lines().any(|line| {
                let mut words = line.split([' ', '(']);
                words.nth(1).is_some_and(|word| word.trim_end_matches('_') == name) && line.ends_with('(')
            });
            assert!(defined, "{}: {name} is missing in\n{metal}", example.name);
        }
    }
}

#[test]
fn every_format_comes_out_the_same_again() {
    for example in scenes() {
        let (one, other) = (compiled(&example), compiled(&example));
        for format in Format::ALL {
            assert!(file(&one, format) == file(&other, format), "{}, {format:?}", example.name);
        }
    }
}

/// The heads say where the uniform block is bound and what it holds.
#[test]
fn heads_describe_the_uniform_block() {
    let shader = compiled(&Example { name: "names".into(), text: NAMES.into() });
    for (format, binding) in [(Format::Metal, "buffer(0) of fs_main"), (Format::Hlsl, "register(b0)")] {
        let text = text(&shader, format);
        let head: Vec<&str> = text.lines().take_while(|line| line.starts_with("//")).collect();
        let begin = head.iter().position(|line| line.contains(&format!("the uniform block, {binding},")));
        let rows = &head[begin.unwrap_or_else(|| panic!("{text}")) + 1..];
        let layout = UniformLayout::of(&shader.program);
        assert_eq!(rows.len(), layout.fields.len(), "{rows:#?}");
        for (row, field) in rows.iter().zip(&layout.fields) {
            assert!(row.starts_with(&format!("//   at {:>3}: ", field.offset)), "{row}");
        }
    }
}
