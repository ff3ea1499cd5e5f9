//! Evaluating over regions: where the values of a function lie, and how far they move with the point.
//!
//! The typical way is `Function → Walker → run` for many regions, or [`bounds`] and [`slopes`] for one. An
//! [`Interval`] holds every number that may come out, in exact arithmetic and as `f64` computes it; [`Bounds`] also
//! know how long a vector is, which a rotation keeps; [`Slopes`] bound the Jacobian, so that its norm is a Lipschitz
//! constant over the region. They want a program as it was built: operations as the language means them, before
//! [`legalise`](crate::total::legalise).

mod bounds;
mod cases;
mod chain;
mod domain;
mod functions;
mod growing;
mod idiom;
mod matrix;
mod number;
mod operations;
mod plan;
mod rotation;
mod seam;
mod shortened;
mod slopes;
mod walk;

pub use bounds::Bounds;
pub use domain::Domain;
pub use growing::Growing;
pub use number::Interval;
pub use rotation::{Angle, Axis};
pub use shortened::Shortened;
pub use slopes::{Sloped, Slopes};

use crate::number::LARGEST;
use crate::program::{Function, Program, RegionId, Role, Type, Unary, Uniform};
use cases::Cases;
use plan::Plan;
use shortened::Reads;
use std::rc::Rc;
use walk::{Frame, Walk};

/// Evaluates one function over many regions.
pub struct Walker<'p, D> {
    program: &'p Program,
    function: &'p Function,
    walk: Walk<D>,
    frame: Frame<D>,
    results: Vec<D>,
    /// What counts of the function where it is asked for, if less than all.
    shortened: Option<Rc<Shortened>>,
    /// Made when it is first asked for.
    reads: Option<Reads>,
}

impl<'p, D: Domain> Walker<'p, D> {
    /// For a function that may call those of the program; it need not be one of them. There is a value for each
    /// uniform and each global of the program.
    pub fn new(
        program: &'p Program,
        function: &'p Function,
        uniforms: &[Bounds],
        globals: &[Bounds],
    ) -> Walker<'p, D> {
        let steady = |values: &[Bounds]| values.iter().map(D::steady).collect();
        let walk = Walk::new(steady(uniforms), steady(globals));
        let frame = walk.frame(function, Plan::new(function));
        Walker { program, function, walk, frame, results: Vec::new(), shortened: None, reads: None }
    }

    /// The results for these arguments, one for each parameter.
    pub fn run(&mut self, arguments: &[D]) -> &[D] {
        assert_eq!(
            arguments.len(),
            self.function.parameters.len(),
            "the arguments of {}",
            self.function.name
        );
        self.walk.begin();
        let (program, function, frame) = (self.program, self.function, &mut self.frame);
        match &self.shortened {
            None => self.walk.region(program, function, frame, RegionId::ROOT, arguments),
            Some(shortened) => self.walk.shortened(program, function, frame, shortened, arguments),
        }
        self.results.clear();
        let results = &self.function.root().results;
        self.results.extend(results.iter().map(|v| self.frame.values[v.0 as usize]));
        &self.results
    }

    /// Asks from now on for a part of the region that a function was shortened for, by this walker or another one of the
    /// same function; or anywhere.
    pub fn stay_within(&mut self, shortened: Option<Rc<Shortened>>) {
        self.shortened = shortened;
    }

    /// What counts of the function in the region of the last run, if that is much less than in the region in which the
    /// walker stays. Then the results have the same signs there as those of the whole function.
    pub fn shorten(&mut self) -> Option<Shortened> {
        let reads = self.reads.get_or_insert_with(|| Reads::new(self.function, &self.frame.plan));
        reads.shorten(self.function, &self.frame, self.shortened.as_deref())
    }
}

impl Walker<'_, Bounds> {
    /// Where the results lie for these arguments. Where the region holds the border between two answers of a step or a
    /// comparison, which the plain [`run`](Walker::run) mixes, each is taken by itself, up to `most` borders.
    pub fn run_by_cases(&mut self, arguments: &[Bounds], most: usize) -> Vec<Bounds> {
        self.walk.cases = Some(Cases::new(most));
        let mut all = self.run(arguments).to_vec();
        while self.walk.cases.as_mut().is_some_and(Cases::advance) {
            for (all, result) in all.iter_mut().zip(self.run(arguments)) {
                *all = all.hull(result);
            }
        }
        self.walk.cases = None;
        all
    }
}

/// Where the results of a function lie for these arguments, uniforms and globals.
pub fn bounds(
    program: &Program,
    function: &Function,
    arguments: &[Bounds],
    uniforms: &[Bounds],
    globals: &[Bounds],
) -> Vec<Bounds> {
    Walker::new(program, function, uniforms, globals).run(arguments).to_vec()
}

/// Where the results of a function lie, and how they move, for arguments that move as these say; uniforms and
/// globals stand still.
pub fn slopes(
    program: &Program,
    function: &Function,
    arguments: &[Sloped],
    uniforms: &[Bounds],
    globals: &[Bounds],
) -> Vec<Sloped> {
    Walker::new(program, function, uniforms, globals).run(arguments).to_vec()
}

/// All values that a uniform may have, by its role.
pub fn bounds_of_uniform(uniform: &Uniform) -> Bounds {
    match &uniform.role {
        Role::Time => Bounds::float(Interval::new(0.0, LARGEST)),
        Role::Mouse => Bounds::vector(&[Interval::UNIT; 2]),
        Role::Resolution => Bounds::vector(&[Interval::new(1.0, LARGEST); 2]),
        Role::Setting => Bounds::constant(uniform.default),
        Role::Orbit { .. } => Bounds::vector(&[Interval::new(-LARGEST, LARGEST); 3]),
        Role::Param { range: Some((lo, hi)), .. } => Bounds::float(Interval::new(*lo, *hi)),
        // Pages offer colours of a screen, and the file has written any.
        Role::Param { color: true, .. } => {
            Bounds::vector(&[Interval::UNIT; 3]).hull(&Bounds::constant(uniform.default))
        }
        Role::Param { .. } => match uniform.ty {
            Type::Bool => Bounds::bool(None),
            ty => Bounds::vector(&[Interval::new(-LARGEST, LARGEST); 3][..ty.size()]),
        },
    }
}

/// Where the globals of a program lie for these uniforms.
pub fn bounds_of_globals(program: &Program, uniforms: &[Bounds]) -> Vec<Bounds> {
    match program.frame {
        Some(frame) => bounds(program, program.function(frame), &[], uniforms, &[]),
        None => Vec::new(),
    }
}

impl Interval {
    /// The sines of all its numbers, in radians.
    pub fn sin(self) -> Interval {
        functions::unary(Unary::Sin, self)
    }

    /// The cosines of all its numbers, in radians.
    pub fn cos(self) -> Interval {
        functions::unary(Unary::Cos, self)
    }
}
