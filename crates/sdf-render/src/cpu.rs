//! Pictures by the interpreter, on all cores.
//!
//! It computes in `f32` what the shaders compute, so its program must have been gone over by
//! [`legalise`](sdf_ir::legalise).

use crate::frame::Frame;
use crate::image::{Drawn, Picture, quantise};
use rayon::prelude::*;
use sdf_ir::eval::{Counts, Machine, Tape};
use sdf_ir::{Constant, Program, Type};
use std::sync::atomic::{AtomicU32, Ordering};

/// How many rows a task has.
const TILE: u32 = 8;

/// The picture of a program whose entry is `pixel(coordinate: vec2) -> vec3`: from the centre of a pixel, in pixels
/// from the bottom left, to its colour, encoded as sRGB.
pub fn render(program: &Program, frame: &Frame) -> Picture {
    render_with(program, frame, false, |_| {}).0.picture
}

/// [`render`], which calls `progress` with the part that is done, 0 to 1, after each tile of rows, from any thread,
/// and counts what was evaluated if `counting` is set. The entry may yield a bool or a float beside the colour.
pub fn render_with(
    program: &Program,
    frame: &Frame,
    counting: bool,
    progress: impl Fn(f64) + Sync,
) -> (Drawn, Counts) {
    let entry = program.entry.expect("a program to render has an entry");
    let pixel = program.function(entry);
    let parameters: Vec<Type> = pixel.parameters.iter().map(|p| p.ty).collect();
    assert_eq!(parameters, [Type::Vec2], "the entry takes a coordinate");
    assert_eq!(pixel.result_types()[0], Type::Vec3, "the entry yields a colour");
    let tape = if counting { Tape::compile_counting(program, entry) } else { Tape::compile(program, entry) };
    let uniforms = frame.uniforms(program);

    let mut picture = Picture::black(frame.width, frame.height);
    let row_bytes = frame.width as usize * 4;
    let tiles = frame.height.div_ceil(TILE);
    let done = AtomicU32::new(0);
    let paint = |(i, rows): (usize, &mut [u8])| {
        let painted = tile(&tape, &uniforms, frame, i as u32 * TILE, rows);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(f64::from(done) / f64::from(tiles));
        painted
    };
    let rows = picture.rgba.par_chunks_mut((row_bytes * TILE as usize).max(1));
    let painted: Vec<(Vec<f32>, Counts)> = rows.enumerate().map(paint).collect();
    let (mut beside, mut counts) = (Vec::new(), Counts::default());
    for (of_tile, counts_of_tile) in painted {
        beside.extend(of_tile);
        counts.add(&counts_of_tile);
    }
    (Drawn { picture, beside }, counts)
}

/// Paints the rows from `top` on, counted from the top; what stands beside the colours, and what was evaluated.
fn tile(tape: &Tape, uniforms: &[Constant], frame: &Frame, top: u32, rgba: &mut [u8]) -> (Vec<f32>, Counts) {
    let (x, y): (Vec<f32>, Vec<f32>) = (0..rgba.len() as u32 / 4)
        .map(|i| (i % frame.width, top + i / frame.width))
        .map(|(column, row)| (column as f32 + 0.5, (frame.height - 1 - row) as f32 + 0.5))
        .unzip();
    let mut channels = vec![vec![0.0f32; x.len()]; tape.output_count()];
    let mut machine = Machine::<f32>::new(tape);
    machine.set_uniforms(uniforms);
    machine.run(&[&x, &y], &mut channels.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>());
    for (i, pixel) in rgba.chunks_exact_mut(4).enumerate() {
        for (byte, channel) in pixel.iter_mut().zip(&channels[..3]) {
            *byte = quantise(channel[i]);
        }
    }
    (channels.split_off(3).pop().unwrap_or_default(), machine.counts().clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sdf_ir::{Builder, Parameter, RegionId, Role, Uniform};
    use std::sync::Mutex;

    /// `(x / width, y / height, k)`
    fn ramp() -> Program {
        let uniform = |name: &str, role, default: Constant| Uniform {
            name: name.into(),
            ty: default.ty(),
            role,
            default,
        };
        let mut program = Program {
            uniforms: vec![
                uniform("size", Role::Resolution, Constant::Vec2([1.0; 2])),
                uniform("k", Role::Param { range: None, color: false }, Constant::Float(0.25)),
            ],
            ..Program::default()
        };
        let parameter = Parameter { name: "coordinate".into(), ty: Type::Vec2, point: false };
        let mut b = Builder::new("pixel", vec![parameter]);
        let at = b.argument(RegionId::ROOT, 0);
        let size = b.uniform(0, Type::Vec2);
        let k = b.uniform(1, Type::Float);
        let part = b.div(at, size);
        let (x, y) = (b.component(part, 0), b.component(part, 1));
        let colour = b.compose(&[x, y, k]);
        program.entry = Some(program.add(b.finish(vec![(colour, "".into())])));
        program
    }

    #[test]
    fn coordinates_begin_at_the_bottom_left() {
        for (width, height) in [(1, 1), (1, 37), (37, 1), (300, 19)] {
            let mut frame = Frame::new(width, height);
            frame.params.insert("k".into(), Constant::Float(1.0));
            let picture = render(&sdf_ir::legalise(&ramp()), &frame);
            for row in 0..height {
                for column in 0..width {
                    let x = (column as f32 + 0.5) / width as f32;
                    let y = ((height - 1 - row) as f32 + 0.5) / height as f32;
                    assert_eq!(picture.pixel(column, row), [quantise(x), quantise(y), 255, 255]);
                }
            }
        }
    }

    #[test]
    fn progress_ends_at_one() {
        let seen = Mutex::new(Vec::new());
        let (_, counts) =
            render_with(&ramp(), &Frame::new(5, 20), true, |part| seen.lock().unwrap().push(part));
        let mut seen = seen.into_inner().unwrap();
        seen.sort_by(f64::total_cmp);
        assert_eq!(seen, [1.0 / 3.0, 2.0 / 3.0, 1.0]);
        assert_eq!(counts.rounds, 0);
    }

    #[test]
    fn an_empty_picture_has_no_pixels() {
        assert_eq!(render(&ramp(), &Frame::new(0, 5)).rgba, []);
    }
}
