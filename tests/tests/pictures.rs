//! Whole shaders, drawn: GLSL and WGSL give the picture that the interpreter gives, the right way up.

use sdf_emit::{Header, Target, UniformLayout, emit};
use sdf_ir::{Builder, Constant, Parameter, Program, Role, Type, Uniform, Value};
use sdf_render::Frame;
use sdf_render::gpu::{DevicePreference, Gpu, GpuError, Shader};
use sdf_tests::adapter::adapter;
use sdf_tests::glslang;
use sdf_tests::run::on_lanes;
use std::time::{Duration, Instant};

/// `color = (coordinate / 256, spin / 4)`: red grows to the right and green upwards, so no symmetry hides a flip.
fn ramps() -> Program {
    let uniform = |name: &str, ty, role, default| Uniform { name: name.into(), ty, role, default };
    let mut b = Builder::new("pixel", Vec::new());
    let coordinate = b.add_parameter(Parameter { name: "coordinate".into(), ty: Type::Vec2, point: false });
    let (scale, quarter) = (b.float(1.0 / 256.0), b.float(0.25));
    let spin = b.uniform(0, Type::Float);
    let ramps = b.mul(coordinate, scale);
    let blue = b.mul(spin, quarter);
    let parts: Vec<Value> = vec![b.component(ramps, 0), b.component(ramps, 1), blue];
    let color = b.compose(&parts);
    let range = Role::Param { range: Some((0.0, 4.0)), color: false };
    let mut program = Program {
        uniforms: vec![uniform("spin", Type::Float, range, Constant::Float(1.0))],
        ..Program::default()
    };
    program.entry = Some(program.add(b.finish(vec![(color, "color".into())])));
    program
}

fn draw(program: &Program, target: Target, width: u32, height: u32, tile: u32) -> Result<Vec<u8>, GpuError> {
    let text = emit(program, target, &Header::default()).unwrap_or_else(|error| panic!("{error}"));
    let shader = if target == Target::Wgsl { Shader::Wgsl(&text) } else { Shader::Glsl450(&text) };
    let frame = Frame::new(width, height);
    let uniforms = UniformLayout::of(program).bytes([width, height], &frame.uniforms(program));
    let mut calls = Vec::new();
    let pixels = adapter()
        .render(shader, [width, height], &uniforms, tile, &mut |done, all| calls.push((done, all)))?;
    let tiles = width.div_ceil(tile) * height.div_ceil(tile);
    assert_eq!(calls, (1..=tiles).map(|i| (i, tiles)).collect::<Vec<_>>());
    Ok(pixels)
}

/// The picture from the lanes: bytes as `Rgba8Unorm` rounds them.
fn expected(program: &Program, width: u32, height: u32) -> Vec<u8> {
    let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let columns = [
        pixels().map(|(x, _)| x as f32 + 0.5).collect::<Vec<f32>>(),
        pixels().map(|(_, y)| (height - y) as f32 - 0.5).collect(),
    ];
    let channels = on_lanes(program, program.entry.unwrap(), &columns);
    let byte = |bits: u32| (f32::from_bits(bits).clamp(0.0, 1.0) * 255.0).round_ties_even() as u8;
    (0..columns[0].len())
        .flat_map(|i| [byte(channels[0][i]), byte(channels[1][i]), byte(channels[2][i]), 255])
        .collect()
}

/// Sizes that no tile divides, a single pixel and a single row, in tiles of several sizes.
#[test]
fn both_languages_draw_what_the_lanes_say() {
    let program = ramps();
    for (width, height, tile) in [(1, 1, 16), (257, 1, 64), (101, 67, 32), (64, 48, 1000)] {
        let expected = expected(&program, width, height);
        for target in [Target::Wgsl, Target::Glsl450] {
            let found = draw(&program, target, width, height, tile).unwrap();
            assert_eq!(found.len(), expected.len());
            let wrong = found.iter().zip(&expected).filter(|(f, e)| f != e).count();
            assert_eq!(wrong, 0, "{target:?} at {width} by {height}");
        }
    }
}

/// The device's clock and the one on the wall agree, and what is timed is drawn.
#[test]
fn a_picture_is_timed_by_the_devices_clock() {
    let program = ramps();
    let text = emit(&program, Target::Wgsl, &Header::default()).unwrap_or_else(|error| panic!("{error}"));
    let [width, height] = [1920, 1080];
    let frame = Frame::new(width, height);
    let uniforms = UniformLayout::of(&program).bytes([width, height], &frame.uniforms(&program));
    let prepared = adapter().prepare(Shader::Wgsl(&text), [width, height], &uniforms).unwrap();
    // The first time a driver compiles.
    prepared.time(1).unwrap();
    assert_eq!(prepared.pixels().unwrap(), expected(&program, width, height));
    for passes in [1, 3, 50] {
        let start = Instant::now();
        let time = prepared.time(passes).unwrap();
        let wall = start.elapsed() / passes;
        assert!(time > Duration::ZERO && time <= wall, "{passes} passes: {time:?} of {wall:?}");
        // What is not drawing is little beside many passes on a device that draws slowly.
        let is_slow = adapter().name().software && passes == 50;
        assert!(!is_slow || time * 4 > wall, "{passes} passes: {time:?} of {wall:?}");
    }
    assert!(matches!(prepared.time(0), Err(GpuError::Failed { doing: "timing", .. })));
}

#[test]
fn a_picture_that_is_too_large_is_an_error() {
    let result = draw(&ramps(), Target::Wgsl, 1 << 20, 1, 256);
    assert!(matches!(result, Err(GpuError::TooLarge { .. })), "{result:?}");
}

#[test]
fn a_shader_that_is_wrong_is_an_error() {
    for shader in [Shader::Wgsl("fn fs_main() {"), Shader::Glsl450("#version 450\nvoid main() { x = 1; }\n")]
    {
        let result = adapter().render(shader, [8, 8], &[0; 16], 8, &mut |_, _| {});
        assert!(matches!(result, Err(GpuError::Failed { .. })), "{result:?}");
    }
}

#[test]
fn a_device_that_is_not_there_is_an_error_that_names_those_that_are() {
    let wanted = DevicePreference::Named("no such device".into());
    match Gpu::new(&wanted) {
        Err(GpuError::NoDevice { found, .. }) => {
            assert!(found.contains(&adapter().name().name), "{found:?}")
        }
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("there is a device of that name"),
    }
}

/// The reference compiler of GLSL takes the `.frag` as it is; naga never reads `#version 300 es` itself.
#[test]
fn glslang_accepts_the_fragment_shader() {
    let text = emit(&ramps(), Target::GlslEs, &Header::default()).unwrap();
    assert_eq!(glslang::complaint(&text), None);
}
