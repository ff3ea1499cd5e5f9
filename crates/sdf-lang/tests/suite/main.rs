//! What scenes mean: each suite compiles scenes and runs the programs in `f64`.

mod accuracy;
mod attributes;
mod complete;
mod effects;
mod facts;
mod imports;
mod language;
mod limits;
mod materials;
mod operators;
mod scene;
mod shapes;
mod slopes;
mod steps;
mod structure;
mod suggestions;
mod values;
