//! The text of a small program that has one of everything, for every target.

use sdf_emit::{EmitError, Format, Header, Target, emit, write};
use sdf_ir::{
    Binary, Builder, Constant, FunctionId, Global, Parameter, Program, RegionId, Role, Ternary, Type, Unary,
    Uniform, Value,
};

fn parameter(name: &str, ty: Type) -> Parameter {
    Parameter { name: name.into(), ty, point: false }
}

fn uniform(name: &str, ty: Type, role: Role, default: Constant) -> Uniform {
    Uniform { name: name.into(), ty, role, default }
}

/// `sd_box(p, half)`, on line 3.
fn sd_box() -> sdf_ir::Function {
    let mut b = Builder::new("box", vec![parameter("p", Type::Vec3), parameter("half", Type::Vec3)]);
    b.set_line(Some(3));
    let [p, half] = [0, 1].map(|i| b.argument(RegionId::ROOT, i));
    let zero = b.float(0.0);
    let a = b.unary(Unary::Abs, p);
    let q = b.sub(a, half);
    b.name(q, &"q".into());
    let zeros = b.splat(zero, Type::Vec3);
    let outside = b.max(q, zeros);
    let length = b.unary(Unary::Length, outside);
    let [x, y, z] = [0, 1, 2].map(|i| b.component(q, i));
    let yz = b.max(y, z);
    let xyz = b.max(x, yz);
    let inside = b.min(xyz, zero);
    let d = b.add(length, inside);
    b.finish(vec![(d, "".into())])
}

/// `map(p)`: two boxes and a distance that a param changes.
fn map(sd_box: FunctionId) -> sdf_ir::Function {
    let mut b = Builder::new("map", vec![parameter("p", Type::Vec3)]);
    let p = b.argument(RegionId::ROOT, 0);
    let turn = b.global(0, Type::Vec2);
    let spin = b.uniform(2, Type::Float);
    let half = b.constant(Constant::Vec3([0.5, 0.25, 0.5]));
    let [c, s] = [0, 1].map(|i| b.component(turn, i));
    let [x, y, z] = [0, 1, 2].map(|i| b.component(p, i));
    let (cx, sz, sx, cz) = (b.mul(c, x), b.mul(s, z), b.mul(s, x), b.mul(c, z));
    let (qx, qz) = (b.sub(cx, sz), b.add(sx, cz));
    let q = b.compose(&[qx, y, qz]);
    let first = b.call(sd_box, &[Type::Float], &[q, half])[0];
    let offset = b.constant(Constant::Vec3([1.0, 0.0, -2.0]));
    let moved = b.add(p, offset);
    let flipped = b.neg(spin);
    let other = b.compose(&[spin, spin, spin]);
    let second = b.call(sd_box, &[Type::Float], &[moved, other])[0];
    let second = b.add(second, flipped);
    let d = b.min(first, second);
    let swapped = b.compose(&[x, z, y]);
    let hash = b.unary(Unary::Hash, swapped);
    b.finish(vec![(d, "distance".into()), (hash, "float".into())])
}

/// `march(origin, direction)`: a loop with two states that need each other, a call with several results inside.
fn march(map: FunctionId) -> sdf_ir::Function {
    let mut b =
        Builder::new("march", vec![parameter("origin", Type::Vec3), parameter("direction", Type::Vec3)]);
    let [origin, direction] = [0, 1].map(|i| b.argument(RegionId::ROOT, i));
    let (zero, one, small) = (b.float(0.0), b.float(1.0), b.float(0.001));
    let until = b.open_region(&[Type::Float, Type::Float, Type::Float]);
    let r = b.argument(until, 1);
    let stop = b.binary(Binary::Less, r, small);
    b.close_region(vec![stop]);
    let next = b.open_region(&[Type::Float, Type::Float, Type::Float, Type::Float]);
    let [round, t, r, last] = [0, 1, 2, 3].map(|i| b.argument(next, i));
    for (v, name) in [(t, "t"), (r, "radius"), (last, "last")] {
        b.name(v, &name.into());
    }
    let far = b.mul(direction, t);
    let at = b.add(origin, far);
    let results = b.call(map, &[Type::Float, Type::Float], &[at]);
    let moved = b.add(t, results[0]);
    let sum = b.add(results[1], round);
    let radius = b.add(last, sum);
    b.close_region(vec![moved, radius, r]);
    let state = b.repeat(256, &[zero, one, one], until, next);
    b.finish(vec![(state[0], "t".into()), (state[2], "last".into())])
}

/// `pixel(coordinate)`.
fn pixel(march: FunctionId) -> sdf_ir::Function {
    let mut b = Builder::new("pixel", vec![parameter("coordinate", Type::Vec2)]);
    let coordinate = b.argument(RegionId::ROOT, 0);
    let resolution = b.uniform(0, Type::Vec2);
    let (half, one, minus) = (b.float(0.5), b.float(1.0), b.float(-1.5));
    let centre = b.mul(resolution, half);
    let off = b.sub(coordinate, centre);
    let height = b.component(resolution, 1);
    let uv = b.div(off, height);
    b.name(uv, &"uv".into());
    let (x, y) = (b.component(uv, 0), b.component(uv, 1));
    let direction = b.compose(&[x, y, minus]);
    let eye = b.constant(Constant::Vec3([0.0, 0.0, 4.0]));
    let hit = b.call(march, &[Type::Float, Type::Float], &[eye, direction]);
    b.name(hit[0], &"größe t".into());
    let far = b.float(100.0);
    let met = b.binary(Binary::Less, hit[0], far);
    let then = b.open_region(&[]);
    let bright = b.mul(hit[0], half);
    let grey = b.splat(bright, Type::Vec3);
    b.close_region(vec![grey]);
    let otherwise = b.open_region(&[]);
    let floor = b.unary(Unary::Floor, uv);
    let (fx, fy) = (b.component(floor, 0), b.component(floor, 1));
    let sky = b.compose(&[fx, fy, one]);
    b.close_region(vec![sky]);
    let color = b.branch(met, then, otherwise)[0];
    b.name(color, &"color".into());
    let on = b.uniform(3, Type::Bool);
    let other = b.splat(hit[1], Type::Vec3);
    let color = b.ternary(Ternary::Select, on, color, other);
    b.finish(vec![(color, "color".into())])
}

fn frame() -> sdf_ir::Function {
    let mut b = Builder::new("frame", vec![]);
    let time = b.uniform(1, Type::Float);
    let one = b.float(1.0);
    let rest = b.sub(one, time);
    let turn = b.compose(&[time, rest]);
    b.finish(vec![(turn, "turn".into())])
}

fn program() -> Program {
    let range = Role::Param { range: Some((0.0, 4.0)), color: false };
    let mut program = Program {
        uniforms: vec![
            uniform("resolution", Type::Vec2, Role::Resolution, Constant::Vec2([1.0, 1.0])),
            uniform("time", Type::Float, Role::Time, Constant::Float(0.0)),
            uniform("spin", Type::Float, range, Constant::Float(1.2)),
            uniform("on", Type::Bool, Role::Param { range: None, color: false }, Constant::Bool(true)),
            uniform("mouse", Type::Vec2, Role::Mouse, Constant::Vec2([0.5, 0.5])),
        ],
        globals: vec![Global { name: "turn".into(), ty: Type::Vec2 }],
        ..Program::default()
    };
    program.frame = Some(program.add(frame()));
    let sd_box = program.add(sd_box());
    let map = program.add(map(sd_box));
    let march = program.add(march(map));
    program.entry = Some(program.add(pixel(march)));
    program
}

fn header() -> Header {
    let lines = vec!["sdfc 0.1.0".into(), "one pixel: at most 256 rounds \\".into()];
    Header { lines, title: "a scene".into(), ..Header::default() }
}

#[test]
fn every_target() {
    for target in Target::ALL {
        let text = emit(&program(), target, &header()).unwrap_or_else(|e| panic!("{target:?}: {e}"));
        insta::assert_snapshot!(format!("{target:?}"), text);
    }
}

/// No text leaves its place in a page, whatever it is.
#[test]
fn a_page_is_not_broken_by_names() {
    let page = |program: &Program, header: &Header| {
        write(program, Format::Page, header).map(|bytes| String::from_utf8(bytes).unwrap())
    };
    let nasty = "</script><script>alert(1)</script><!--";
    let mut program = program();
    program.uniforms[2].name = nasty.into();
    let header = Header { title: nasty.into(), ..Header::default() };
    let text = page(&program, &header).unwrap();
    let plain = page(&program, &Header::default()).unwrap();
    assert_eq!(text.matches("</script").count(), 3);
    assert_eq!(text.matches("<script").count(), plain.matches("<script").count());
    assert!(text.contains(r#""name": "\u003c\u002fscript\u003e"#), "{text}");
    let header = Header { lines: vec![nasty.into()], ..Header::default() };
    assert!(matches!(page(&program, &header), Err(EmitError::Invalid(_))));
}

/// The page holds the text of the target for WebGL2 as it is.
#[test]
fn a_page_holds_its_shader() {
    let text = String::from_utf8(write(&program(), Format::Page, &header()).unwrap()).unwrap();
    let shader = emit(&program(), Target::GlslEs, &header()).unwrap();
    assert!(
        text.contains(&format!("<script id=\"fragment\" type=\"x-shader/x-fragment\">{shader}</script>"))
    );
}

/// The functions are the same bytes in the three GLSL targets: from the first to the entry's end.
#[test]
fn one_body_for_glsl() {
    let body = |target| {
        let text = emit(&program(), target, &Header::default()).unwrap();
        let (start, end) =
            (text.find("// Computed once a frame.").unwrap(), text.find("\nvoid main").unwrap());
        text[start..end].to_owned()
    };
    assert!(body(Target::Shadertoy).contains("vec3 pixel(vec2 coordinate)"));
    assert_eq!(body(Target::Shadertoy), body(Target::GlslEs));
    assert_eq!(body(Target::Glsl450), body(Target::GlslEs));
}

#[test]
fn the_same_program_gives_the_same_bytes() {
    for target in Target::ALL {
        assert_eq!(emit(&program(), target, &header()), emit(&program(), target, &header()));
    }
    for format in Format::ALL {
        assert_eq!(write(&program(), format, &header()), write(&program(), format, &header()));
    }
}

/// A program whose entry returns what `f` makes of the coordinate's first component.
fn program_of(f: impl FnOnce(&mut Builder, Value) -> Value) -> Program {
    let mut b = Builder::new("pixel", vec![parameter("coordinate", Type::Vec2)]);
    let coordinate = b.argument(RegionId::ROOT, 0);
    let x = b.component(coordinate, 0);
    let y = f(&mut b, x);
    let color = b.splat(y, Type::Vec3);
    let mut program = Program::default();
    program.entry = Some(program.add(b.finish(vec![(color, "".into())])));
    program
}

#[test]
fn an_operation_that_is_not_basic_is_an_error() {
    for op in [Unary::Sin, Unary::Exp, Unary::Tanh] {
        let error = emit(&program_of(|b, x| b.unary(op, x)), Target::Wgsl, &header()).unwrap_err();
        assert_eq!(error, EmitError::NotBasic { operation: format!("{op:?}"), function: "pixel".into() });
    }
}

#[test]
fn a_number_that_is_not_finite_is_an_error() {
    let program = program_of(|b, x| {
        let huge = b.float(1e39);
        b.add(x, huge)
    });
    assert_eq!(emit(&program, Target::Wgsl, &header()), Err(EmitError::NotFinite));
}

#[test]
fn a_program_without_an_entry_is_an_error() {
    assert_eq!(emit(&Program::default(), Target::Wgsl, &header()), Err(EmitError::NoEntry));
}

#[test]
fn long_chains_and_deep_nests_are_cut() {
    let chain = program_of(|b, x| {
        (1..500).fold(x, |sum, _| {
            let y = b.unary(Unary::Floor, sum);
            b.add(sum, y)
        })
    });
    let nest = program_of(|b, x| {
        (1..500).fold(x, |sum, i| {
            let c = b.float(f64::from(i));
            let y = b.mul(sum, c);
            b.min(c, y)
        })
    });
    for target in Target::ALL {
        for program in [&chain, &nest] {
            let text = emit(program, target, &Header::default()).unwrap();
            assert!(text.lines().all(|line| line.len() < 140), "{text}");
        }
    }
}

/// How many lines the longest function has.
fn longest_function(text: &str) -> usize {
    text.split("\n}").map(|function| function.lines().count()).max().unwrap_or(0)
}

/// A union of many calls, and one inside a loop inside an `if`, which needs values from everywhere.
fn long_program(terms: usize) -> Program {
    let mut program = Program::default();
    let ball = {
        let mut b = Builder::new("ball", vec![parameter("p", Type::Vec2), parameter("r", Type::Float)]);
        let [p, r] = [0, 1].map(|i| b.argument(RegionId::ROOT, i));
        let (length, square) = (b.unary(Unary::Length, p), b.mul(r, r));
        let d = b.sub(length, r);
        program.add(b.finish(vec![(d, "d".into()), (square, "square".into())]))
    };
    let union = |b: &mut Builder, p: Value, first: Value, from: usize| {
        (from..from + terms).fold(first, |least, i| {
            let centre = b.constant(Constant::Vec2([i as f64, -(i as f64) * 0.5]));
            let (at, radius) = (b.sub(p, centre), b.float(0.25 + 0.001 * i as f64));
            let parts = b.call(ball, &[Type::Float, Type::Float], &[at, radius]);
            let d = b.mul(parts[0], parts[1]);
            b.min(least, d)
        })
    };
    let mut b = Builder::new("pixel", vec![parameter("coordinate", Type::Vec2)]);
    let p = b.argument(RegionId::ROOT, 0);
    let far = b.float(1e9);
    let first = union(&mut b, p, far, 0);
    let x = b.component(p, 0);
    let left = b.binary(Binary::Less, x, first);
    let then = b.open_region(&[]);
    let until = b.open_region(&[Type::Float, Type::Vec2]);
    let never = b.bool(false);
    b.close_region(vec![never]);
    let next = b.open_region(&[Type::Float, Type::Float, Type::Vec2]);
    let [round, sum, q] = [0, 1, 2].map(|i| b.argument(next, i));
    let moved = b.add(q, round);
    let inner = union(&mut b, moved, first, 1000);
    let inner = b.add(inner, sum);
    b.close_region(vec![inner, moved]);
    let state = b.repeat(3, &[x, p], until, next);
    let y = b.component(state[1], 1);
    let both = b.add(state[0], y);
    b.close_region(vec![both]);
    let otherwise = b.open_region(&[]);
    let other = union(&mut b, p, x, 2000);
    b.close_region(vec![other]);
    let chosen = b.branch(left, then, otherwise)[0];
    let color = b.compose(&[chosen, first, x]);
    program.entry = Some(program.add(b.finish(vec![(color, "color".into())])));
    program
}

#[test]
fn long_functions_are_cut() {
    for target in Target::ALL {
        let text = emit(&long_program(3000), target, &Header::default()).unwrap_or_else(|e| panic!("{e}"));
        // 512 statements, and the lines of declarations and braces among them.
        let longest = longest_function(&text);
        assert!((100..620).contains(&longest), "{longest} lines in {target:?}");
    }
}
