//! What a function of a pixel's coordinate gives at many coordinates, a column for each number.

use crate::Frame;
use sdf_ir::eval::{Counts, Tape, run_parallel};
use sdf_ir::number::Number;
use sdf_ir::{Constant, FunctionId, Program};

/// How many coordinates are taken at once before progress is told.
const BAND: usize = 1 << 13;

/// A function of a program, of a `coordinate: vec2` in pixels from the bottom left, ready to be asked.
#[derive(Debug)]
pub struct Columns {
    program: Program,
    function: FunctionId,
    tape: Tape,
}

impl Columns {
    /// By the language's meaning, for numbers of any size.
    pub fn new(program: &Program, function: FunctionId) -> Columns {
        Columns::of(sdf_ir::simplify(&alone(program, function), &[]).0)
    }

    /// In the operations of shaders, which mean the same in `f32`.
    pub fn of_shader(program: &Program, function: FunctionId) -> Columns {
        Columns::of(sdf_ir::legalise(&sdf_ir::simplify(&alone(program, function), &[]).0))
    }

    /// Of a program that is gone over by [`legalise`](sdf_ir::legalise) already.
    pub fn as_it_is(program: &Program, function: FunctionId) -> Columns {
        Columns::of(alone(program, function))
    }

    fn of(program: Program) -> Columns {
        let function = program.entry.expect("the entry is kept");
        Columns { tape: Tape::compile_counting(&program, function), function, program }
    }

    /// The first column of a result, by its name.
    pub fn place(&self, name: &str) -> usize {
        let function = self.program.function(self.function);
        let index = function.result_names.iter().position(|result| &**result == name);
        let index = index.unwrap_or_else(|| panic!("`{}` has a result `{name}`", function.name));
        function.result_types()[..index].iter().map(|ty| ty.size()).sum()
    }

    /// The numbers at these coordinates, and what was evaluated for them. `progress` is told the part that is done.
    pub fn at<N: Number>(
        &self,
        frame: &Frame,
        [x, y]: &[Vec<N>; 2],
        progress: &dyn Fn(f64),
    ) -> (Vec<Vec<N>>, Counts) {
        let uniforms: Vec<Constant> = frame.uniforms(&self.program);
        let mut columns = vec![vec![N::from_f64(0.0); x.len()]; self.tape.output_count()];
        let mut counts = Counts::default();
        for from in (0..x.len()).step_by(BAND) {
            let to = (from + BAND).min(x.len());
            let mut slices: Vec<&mut [N]> = columns.iter_mut().map(|column| &mut column[from..to]).collect();
            counts.add(&run_parallel(&self.tape, &uniforms, &[&x[from..to], &y[from..to]], &mut slices));
            progress(to as f64 / x.len() as f64);
        }
        (columns, counts)
    }
}

fn alone(program: &Program, function: FunctionId) -> Program {
    Program { entry: Some(function), ..program.clone() }
}

/// The coordinates of all pixels of a picture, row by row from the top; of their centres, moved by so many pixels.
pub fn coordinates<N: Number>(frame: &Frame, [right, up]: [f64; 2]) -> [Vec<N>; 2] {
    let (width, height) = (frame.width as usize, frame.height as usize);
    let place = |i: usize| [(i % width) as f64 + 0.5 + right, (height - 1 - i / width) as f64 + 0.5 + up];
    [0, 1].map(|axis| (0..width * height).map(|i| N::from_f64(place(i)[axis])).collect())
}
