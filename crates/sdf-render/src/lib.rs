//! Programs to pictures.
//!
//! The typical way is `Program → Frame → Picture`: on the CPU by the interpreter ([`cpu`]), on the GPU by the text
//! that the emitter writes. [`certify`] proves what a picture must show. Nothing here knows syntax or the names of shapes. Only `gpu` knows wgpu, behind the
//! feature of that name.
#![warn(missing_docs)]

pub mod certify;
pub mod columns;
pub mod cpu;
pub mod frame;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod image;

pub use frame::Frame;
pub use image::{Drawn, Picture};
