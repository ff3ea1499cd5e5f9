//! The names of what a whole shader shares: functions, their results' structures, uniforms and globals.

use crate::expression::{Expression, Level};
use crate::names::Names;
use crate::{Target, bits};
use sdf_ir::{FunctionId, Node, Program, RegionId, Role, Type, Uniform};

/// The structure that a function with several results returns.
pub(crate) struct Structure {
    /// Its name.
    pub name: String,
    /// The names of its members.
    pub fields: Vec<String>,
}

/// The names that all functions see.
pub(crate) struct Symbols {
    /// The functions' names, those of unreachable ones included.
    pub functions: Vec<String>,
    /// The functions' results, for those that have several.
    pub structures: Vec<Option<Structure>>,
    /// How each uniform is written where it is used.
    pub uniforms: Vec<Expression>,
    /// The uniforms' names without a prefix.
    pub uniform_fields: Vec<String>,
    /// The values of the frame.
    pub globals: Vec<String>,
    /// All of these; functions take their own names beside them.
    pub taken: Names<'static>,
}

impl Symbols {
    /// The names of a program for a target.
    pub fn of(program: &Program, target: Target) -> Symbols {
        let mut taken = Names::default();
        for name in bits::NAMES {
            for suffix in ["", "_vec2", "_vec3"] {
                taken.give(&format!("{name}{suffix}"), "bits");
            }
        }
        let uniform_fields = uniform_names(program);
        let write = |(name, uniform): (&String, &Uniform)| match (target, uniform.ty) {
            _ if uniform.role == Role::Setting => Expression::atom(name.clone()),
            // No bool may lie in a block.
            (Target::Wgsl, Type::Bool) => {
                Expression { text: format!("uniforms.{name} != 0u"), level: Level::Comparison }
            }
            (Target::Wgsl, _) => Expression::atom(format!("uniforms.{name}")),
            _ => Expression::atom(format!("u_{name}")),
        };
        let uniforms = uniform_fields.iter().zip(&program.uniforms).map(write).collect();
        // Both languages give functions and values the same names, so both keep the uniforms' free.
        for (name, uniform) in uniform_fields.iter().zip(&program.uniforms) {
            match uniform.role {
                Role::Setting => taken.give(name, "SETTING"),
                _ => taken.give(&format!("u_{name}"), "u"),
            };
        }
        for name in ["u_resolution", "u_time", "u_mouse"] {
            taken.give(name, "u");
        }
        let functions: Vec<String> = program.functions.iter().map(|f| taken.give(&f.name, "part")).collect();
        let globals = program.globals.iter().map(|g| taken.give(&g.name, "frame_value")).collect();
        let structures = program
            .functions
            .iter()
            .zip(&functions)
            .enumerate()
            .map(|(i, (function, name))| {
                let is_frame = program.frame == Some(FunctionId(i as u32));
                (function.result_names.len() > 1 && !is_frame).then(|| {
                    let name = taken.give(&camel_case(name), "Results");
                    let mut members = Names::default();
                    let fields = function.result_names.iter().map(|n| members.give(n, "part")).collect();
                    Structure { name, fields }
                })
            })
            .collect();
        Symbols { functions, structures, uniforms, uniform_fields, globals, taken }
    }
}

/// The uniforms' names: those of the wrapper have fixed ones.
fn uniform_names(program: &Program) -> Vec<String> {
    let mut names = Names::default();
    for fixed in ["resolution", "time", "mouse"] {
        names.give(fixed, fixed);
    }
    if program.uniforms.iter().any(|u| matches!(u.role, Role::Orbit { .. })) {
        names.give("orbit", "orbit");
    }
    let name = |u: &Uniform| match u.role {
        Role::Resolution => "resolution".to_owned(),
        Role::Time => "time".to_owned(),
        Role::Mouse => "mouse".to_owned(),
        Role::Orbit { .. } => "orbit".to_owned(),
        Role::Setting => names.give(&u.name.to_uppercase(), "SETTING"),
        Role::Param { .. } => names.give(&u.name, "param"),
    };
    program.uniforms.iter().map(name).collect()
}

/// `sd_box` becomes `SdBox`.
fn camel_case(name: &str) -> String {
    name.split('_').map(|word| word[..1].to_uppercase() + &word[1..]).collect()
}

/// The functions that the entry and the frame need, callees first, and which operations on bits they use.
pub(crate) struct Reachable {
    /// The functions, in the program's order.
    pub functions: Vec<FunctionId>,
    /// The operations on bits and the types of their arguments, each once, sorted.
    pub bits: Vec<(sdf_ir::Unary, Type)>,
    /// Whether there is a loop.
    pub loops: bool,
}

impl Reachable {
    /// What the roots need. `plans` tells which nodes are written.
    pub fn of(program: &Program, plans: &[crate::plan::Plan], roots: &[FunctionId]) -> Reachable {
        let mut needed = vec![false; program.functions.len()];
        for root in roots {
            needed[root.0 as usize] = true;
        }
        let mut bits = Vec::new();
        let mut loops = false;
        for (i, function) in program.functions.iter().enumerate().rev() {
            if !needed[i] {
                continue;
            }
            let regions = (0..function.region_count()).map(|r| RegionId(r as u32));
            for v in regions.flat_map(|r| plans[i].order(r)) {
                match function.node(*v) {
                    Node::Call(callee, _) => needed[callee.0 as usize] = true,
                    Node::Loop(_) => loops = true,
                    Node::Unary(op, a) => {
                        let ty = function.type_of(a).expect("an operand is no tuple");
                        if bits::name(op, ty).is_some() {
                            bits.push((op, ty));
                        }
                    }
                    _ => {}
                }
            }
        }
        bits.sort();
        bits.dedup();
        let functions = (0..needed.len()).filter(|i| needed[*i]).map(|i| FunctionId(i as u32)).collect();
        Reachable { functions, bits, loops }
    }
}
