//! Programs as pixels: on a graphics device ([`gpu`]) or on the CPU.
//!
//! Nothing here knows syntax, the names of shapes or files. Only `gpu` knows wgpu, behind the feature of that name.
#![warn(missing_docs)]

#[cfg(feature = "gpu")]
pub mod gpu;
