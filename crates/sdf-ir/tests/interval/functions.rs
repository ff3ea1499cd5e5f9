//! What is known of whole functions: promises, rotations that are carried along, functions in the making.

use sdf_ir::interval::{Angle, Axis, Bounds, Growing, Interval, Sloped, slopes};
use sdf_ir::{Binary, Builder, Constant, Parameter, Program, Rotation, Type, Unary, Value, rebuild};

fn parameter(name: &str, ty: Type, point: bool) -> Parameter {
    Parameter { name: name.into(), ty, point }
}

/// `floor(p.x)·k`, which promises a slope, called at `2p` with k as it is given.
fn promising(promise: Option<f64>, argument: impl Fn(&mut Builder, Value) -> Value) -> f64 {
    let mut program = Program::default();
    let mut b = Builder::new("steps", Vec::new());
    let p = b.add_parameter(parameter("p", Type::Vec3, true));
    let k = b.add_parameter(parameter("k", Type::Float, false));
    let x = b.component(p, 0);
    let floor = b.unary(Unary::Floor, x);
    let result = b.mul(floor, k);
    b.set_lipschitz(promise);
    let steps = program.add(b.finish(vec![(result, "".into())]));
    let mut b = Builder::new("f", Vec::new());
    let p = b.add_parameter(parameter("p", Type::Vec3, true));
    let two = b.float(2.0);
    let (q, k) = (b.mul(p, two), argument(&mut b, p));
    let result = b.call(steps, &[Type::Float], &[q, k])[0];
    let function = b.finish(vec![(result, "".into())]);
    let region = Bounds::between([0.1; 3], [0.9; 3]);
    slopes(&program, &function, &[Sloped::point(region)], &[], &[])[0].norm()
}

#[test]
fn a_promise_is_about_the_points() {
    let still = |b: &mut Builder, _| b.float(3.0);
    assert_eq!(promising(None, still), f64::INFINITY);
    let found = promising(Some(1.5), still);
    assert!((found - 3.0).abs() < 1e-12, "{found}");
}

/// Where another argument moves too, its part is computed from the inside: `floor(2x)` is at most 1, and k moves by 4.
#[test]
fn what_a_promise_is_not_about_is_computed() {
    let moving = |b: &mut Builder, p: Value| {
        let (y, four) = (b.component(p, 1), b.float(4.0));
        b.mul(y, four)
    };
    let found = promising(Some(1.5), moving);
    assert!((found - 7.0).abs() < 1e-9, "{found}");
}

/// A promise makes a function another one; a rotation does not.
#[test]
fn promises_count_and_rotations_do_not() {
    let make = |lipschitz: Option<f64>, is_marked: bool| {
        let mut b = Builder::new("f", Vec::new());
        let v = b.add_parameter(parameter("v", Type::Vec2, true));
        let (x, y) = (b.component(v, 0), b.component(v, 1));
        let minus = b.neg(y);
        let image = b.compose(&[minus, x]);
        if is_marked {
            b.mark_rotation(Rotation { image, vector: v, axis: None, angle: Angle::Steady });
        }
        b.set_lipschitz(lipschitz);
        b.finish(vec![(image, "".into())])
    };
    assert_eq!(make(None, false), make(None, true));
    assert_ne!(make(None, true), make(Some(1.0), true));
    assert_eq!(make(None, false).to_string(), make(Some(1.0), true).to_string());
    assert_eq!(rebuild(&make(Some(1.0), true)).lipschitz(), Some(1.0));
}

/// The image of a rotation by an angle that is passed, about y.
fn turned(b: &mut Builder, v: Value, angle: Value) -> Value {
    let [x, y, z] = [0, 1, 2].map(|i| b.component(v, i));
    let (c, s) = (b.unary(Unary::Cos, angle), b.unary(Unary::Sin, angle));
    let [cx, sz, sx, cz] = [(c, x), (s, z), (s, x), (c, z)].map(|(a, b2)| b.mul(a, b2));
    let (x, z) = (b.add(cx, sz), b.sub(cz, sx));
    let image = b.compose(&[x, y, z]);
    let axis = b.constant(Constant::Vec3([0.0, 2.0, 0.0]));
    b.mark_rotation(Rotation { image, vector: v, axis: Some(Axis::Of(axis)), angle: Angle::Of(angle) });
    image
}

#[test]
fn rotations_go_where_the_nodes_go() {
    let mut b = Builder::new("inner", Vec::new());
    let v = b.add_parameter(parameter("v", Type::Vec3, true));
    let angle = b.add_parameter(parameter("angle", Type::Float, false));
    let image = turned(&mut b, v, angle);
    let inner = b.finish(vec![(image, "".into())]);
    let mut b = Builder::new("outer", Vec::new());
    let p = b.add_parameter(parameter("p", Type::Vec3, true));
    let (y, rate) = (b.component(p, 1), b.float(3.0));
    let angle = b.mul(y, rate);
    let image = b.inline(&inner, &[p, angle])[0];
    let mut written_out = b.clone();
    let one = written_out.constant(Constant::Vec3([1.0, 0.0, 0.0]));
    // This leaves nothing of the image but its components.
    let moved = written_out.sub(image, one);
    let written_out = written_out.finish(vec![(moved, "".into())]);
    let outer = b.finish(vec![(image, "".into())]);
    let rebuilt = rebuild(&outer);
    for function in [&outer, &rebuilt, &written_out] {
        assert_eq!(function.rotations().len(), 1);
        let region = Bounds::between([0.0, 0.0, 0.999], [0.001, 1.0, 1.0]);
        let found = slopes(&Program::default(), function, &[Sloped::point(region)], &[], &[])[0];
        let expected = (3.0 + 13f64.sqrt()) / 2.0;
        assert!((found.norm() - expected).abs() < 1e-2, "{} is not {expected}", found.norm());
        assert!(found.bounds.part(0).lo > -2.01 && found.bounds.part(1).hi < 1.001);
    }
}

/// Bounds are there while a function is still being made, for branches and loops too, and stay as they were.
#[test]
fn values_of_a_function_in_the_making() {
    let program = Program::default();
    let mut b = Builder::new("frame", Vec::new());
    let mut growing = Growing::new();
    let time = b.uniform(0, Type::Float);
    let uniforms = [Bounds::float(Interval::new(0.0, 10.0))];
    let wave = b.unary(Unary::Sin, time);
    let mut ask = |b: &Builder, v: Value| growing.bounds_of(&program, b, v, &uniforms).number();
    assert_eq!(ask(&b, wave), Interval::new(-1.0, 1.0));
    let two = b.float(2.0);
    let sum = b.add(wave, two);
    let root = b.unary(Unary::Sqrt, sum);
    assert!(ask(&b, root).hi < 1.7321 && ask(&b, root).lo > 0.9999);
    // A branch that is decided, and one that is not.
    let below = b.binary(Binary::Less, root, two);
    let less = b.binary(Binary::Less, time, two);
    let branch = |b: &mut Builder, condition| {
        let then = b.open_region(&[]);
        let double = b.mul(root, two);
        b.close_region(vec![double]);
        let otherwise = b.open_region(&[]);
        let square = b.mul(time, time);
        b.close_region(vec![square]);
        b.branch(condition, then, otherwise)[0]
    };
    let (decided, open) = (branch(&mut b, below), branch(&mut b, less));
    assert!(ask(&b, decided).hi < 3.47);
    assert!((ask(&b, open).hi - 100.0).abs() < 1e-9);
    // Three rounds that double, and the values inside in any round.
    let until = b.open_region(&[Type::Float]);
    let never = b.bool(false);
    b.close_region(vec![never]);
    let next = b.open_region(&[Type::Float, Type::Float]);
    let state = b.argument(next, 1);
    let more = b.mul(state, two);
    b.close_region(vec![more]);
    let last = b.repeat(3, &[root], until, next)[0];
    assert!(ask(&b, last).hi < 13.857 && ask(&b, last).lo > 7.99);
    assert_eq!(ask(&b, more), Interval::ALL);
    assert_eq!(ask(&b, wave), Interval::new(-1.0, 1.0));
    let after = b.add(last, wave);
    assert!(ask(&b, after).hi < 14.857);
}

/// A vector inside a branch that has come apart is left behind: it could not be put together outside.
#[test]
fn rotations_inside_of_branches_stay_well_formed() {
    let mut b = Builder::new("f", Vec::new());
    let p = b.add_parameter(parameter("p", Type::Vec3, true));
    let [x, y, z] = [0, 1, 2].map(|i| b.component(p, i));
    let less = b.binary(Binary::Less, x, y);
    let then = b.open_region(&[]);
    let square = b.mul(z, z);
    let v = b.compose(&[square, x, z]);
    let image = turned(&mut b, v, y);
    let parts = b.components(image);
    let sum = b.add(parts[0], parts[2]);
    b.close_region(vec![sum]);
    let otherwise = b.open_region(&[]);
    b.close_region(vec![x]);
    let result = b.branch(less, then, otherwise)[0];
    let function = b.finish(vec![(result, "".into())]);
    assert_eq!(function.rotations().len(), 1);
    let mut program = Program::default();
    let rebuilt = rebuild(&function);
    assert_eq!(rebuild(&rebuilt), rebuilt);
    program.add(rebuilt);
    assert_eq!(sdf_ir::verify(&program), Ok(()));
    let region = Sloped::point(Bounds::between([0.0; 3], [1.0; 3]));
    slopes(&program, &program.functions[0], &[region], &[], &[]);
}
