//! Helpers of the suites in `tests/`.

pub mod adapter;
pub mod agreement;
pub mod attack;
pub mod canvas;
pub mod chromium;
pub mod drawing;
pub mod effects;
pub mod fields;
pub mod glslang;
pub mod hard;
pub mod library;
pub mod light;
pub mod march;
pub mod numbers;
pub mod pages;
pub mod pictures;
pub mod presets;
pub mod prices;
pub mod reference;
pub mod rewriting;
pub mod run;
pub mod safety;
pub mod scenes;
pub mod shadertoy;
pub mod swiftshader;
pub mod table;
