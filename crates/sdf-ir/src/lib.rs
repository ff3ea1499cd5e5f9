//! The program: a small typed SSA form of signed distance functions and the renderer round them, how it is
//! built, checked, simplified, differentiated and evaluated.
//!
//! The typical way is `Builder → Function → Program → verify → simplify → eval`. Nothing here knows syntax,
//! the names of shapes, files or graphics drivers.
#![warn(missing_docs)]

pub mod adjoint;
pub mod bits;
pub mod build;
pub mod constant;
pub mod copy;
pub mod cost;
mod degree;
mod dump;
pub mod eval;
pub mod gradient;
pub mod hash;
pub mod interval;
mod knowledge;
pub mod number;
mod parity;
pub mod program;

#[cfg(test)]
mod reference;
pub mod region;
mod rules;
pub mod simplify;
pub mod total;
pub mod verify;

pub use adjoint::adjoints;
pub use build::Builder;
pub use constant::Constant;
pub use copy::{rebuild, written_out};
pub use degree::is_affine;
pub use gradient::{Gradients, gradient};
pub use parity::is_even;
pub use program::{
    Binary, Function, FunctionId, Global, Limit, List, Node, Parameter, Program, Region, RegionId, Role,
    Rotation, Ternary, Type, Unary, Uniform, Value,
};
pub use simplify::simplify;
pub use total::legalise;
pub use verify::verify;
