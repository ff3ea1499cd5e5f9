//! Bounds of the values of a function that is still being built.

use super::bounds::Bounds;
use super::plan::Plan;
use super::walk::{Frame, Walk};
use crate::build::Builder;
use crate::program::{Node, Program, Value};
use std::rc::Rc;

/// The bounds of the values of a function that is still being built. Each node is evaluated once, however often
/// bounds are asked for between additions.
pub struct Growing {
    walk: Walk<Bounds>,
    frame: Frame<Bounds>,
}

impl Growing {
    /// For a function of which nothing is known but what it computes.
    pub fn new() -> Growing {
        Growing::of(Vec::new(), Vec::new())
    }

    /// For a function whose uniforms and globals are these; those that are missing may be anything.
    pub fn of(uniforms: Vec<Bounds>, globals: Vec<Bounds>) -> Growing {
        Growing {
            walk: Walk::new(uniforms, globals),
            frame: Frame { plan: Rc::new(Plan::growing()), values: Vec::new() },
        }
    }
}

impl Default for Growing {
    fn default() -> Growing {
        Growing::new()
    }
}

impl Growing {
    /// Where a value of the function lies, for any arguments. The builder must be the same one at each call, and the
    /// uniforms may only become more. Nothing is known of a value inside a loop but what holds in every round.
    pub fn bounds_of(
        &mut self,
        program: &Program,
        builder: &Builder,
        value: Value,
        uniforms: &[Bounds],
    ) -> Bounds {
        let function = builder.function();
        let known = self.frame.values.len();
        if self.walk.uniforms.len() < uniforms.len() {
            self.walk.uniforms.extend(&uniforms[self.walk.uniforms.len()..]);
        }
        if known < function.node_count() {
            let mut plan = Plan::growing();
            plan.grow(function);
            self.frame.plan = Rc::new(plan);
            self.frame.values.resize(function.node_count(), Bounds::bool(None));
            self.walk.read_leaves(function, &mut self.frame, known);
            // Operands are made before what uses them, so this order works; what is inside a region is evaluated
            // for any state, and again for the states of its loop when that is reached.
            for index in known..function.node_count() {
                let node = Value(index as u32);
                self.walk.begin();
                self.walk.node(program, function, &mut self.frame, node);
                self.forget_states(program, builder, node);
            }
        }
        self.frame.values[value.0 as usize]
    }

    /// Lets what is inside a loop be again what it may be in any round.
    fn forget_states(&mut self, program: &Program, builder: &Builder, node: Value) {
        let function = builder.function();
        if !matches!(function.node(node), Node::Loop(_)) {
            return;
        }
        for region in function.owned_regions(node) {
            let any: Vec<Bounds> =
                function.region(region).arguments.iter().map(|ty| Bounds::anything(*ty)).collect();
            self.walk.begin();
            self.walk.region(program, function, &mut self.frame, region, &any);
        }
    }
}
