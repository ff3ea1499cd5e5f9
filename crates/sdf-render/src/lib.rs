//! Programs to pictures.
//!
//! The typical way is `Program → Frame → Picture`: on the CPU by the interpreter, or on a graphics device
//! by the text that the emitter writes. Nothing here knows syntax, the names of shapes or files; only `gpu`
//! knows wgpu, behind the feature of that name.
//! The typical way is `Program → Frame → Picture`: on the CPU by the interpreter, on the GPU by the text
//! that the emitter writes. Nothing here knows syntax or the names of shapes. Only [`gpu`] knows wgpu, behind the
//! feature of that name.
#![warn(missing_docs)]

pub mod frame;
#[cfg(feature = "gpu")]
pub mod gpu;

pub use frame::Frame;
