//! Simplification of a whole program: what is left is called for by somebody.
//!
//! Each function that is reached is made anew, so that the rules see what they could not when it was built. Then
//! parameters, results, functions, uniforms and globals that nobody uses go, functions that are the same become one, and
//! results that are not computed, but numbers or the caller's own arguments, are no longer asked for. All of that is
//! repeated until it changes nothing, so simplifying twice is simplifying once.

use crate::build::Builder;
use crate::copy::{Links, inline_whole, live, mark_live};
use crate::hash::MixMap;
use crate::program::{Function, FunctionId, Loop, Node, Parameter, Program, RegionId, Type, Value};

/// The program without what its entry, and the functions in `roots`, do not need, and what the roots have become.
/// The entry and the roots keep their parameters and results.
pub fn simplify(program: &Program, roots: &[FunctionId]) -> (Program, Vec<FunctionId>) {
    let (mut program, mut roots) = (program.clone(), roots.to_vec());
    loop {
        let (smaller, moved) = without_unused_inputs(once(&program, &roots));
        if smaller == program {
            return (smaller, moved);
        }
        roots = moved;
        program = smaller;
    }
}

/// A program, and where the roots are in it.
type Rooted = (Program, Vec<FunctionId>);

/// Makes every function that is reached anew.
fn once(program: &Program, roots: &[FunctionId]) -> Rooted {
    let fixed: Vec<FunctionId> = program.entry.iter().chain(&program.frame).chain(roots).copied().collect();
    let wanted = wanted(program, &fixed);
    let mut made = Rebuild {
        program: Program {
            uniforms: program.uniforms.clone(),
            globals: program.globals.clone(),
            is_tiny: program.is_tiny,
            ..Program::default()
        },
        callees: program.functions.iter().map(|_| None).collect(),
        known: MixMap::default(),
    };
    for (index, (function, wanted)) in program.functions.iter().zip(wanted).enumerate() {
        let id = FunctionId(index as u32);
        if let Some(wanted) = wanted {
            made.function(id, function, wanted, fixed.contains(&id));
        }
    }
    let moved = |id: FunctionId| made.callee(id).id;
    let roots = roots.iter().copied().map(moved).collect();
    let (entry, frame) = (program.entry.map(moved), program.frame.map(moved));
    (Program { entry, frame, ..made.program }, roots)
}

/// Which results of each function these functions need, directly or not; of those that they do not call, nothing. Callers
/// stand behind their callees.
fn wanted(program: &Program, from: &[FunctionId]) -> Vec<Option<Vec<bool>>> {
    let count = |id: FunctionId| program.function(id).root().results.len();
    let mut wanted: Vec<Option<Vec<bool>>> = vec![None; program.functions.len()];
    for id in from {
        wanted[id.0 as usize] = Some(vec![true; count(*id)]);
    }
    for index in (0..wanted.len()).rev() {
        let Some(results) = wanted[index].clone() else { continue };
        let function = &program.functions[index];
        let mut live = vec![false; function.node_count()];
        mark_live(function, &mut live, kept(&function.root().results, &results));
        for value in (0..function.node_count() as u32).map(Value).filter(|value| live[value.0 as usize]) {
            // The call of a function with one result is that result.
            let (call, result) = match function.node(value) {
                Node::Result(tuple, result) => (tuple, Some(result)),
                _ => (value, function.type_of(value).map(|_| 0)),
            };
            let Node::Call(callee, _) = function.node(call) else { continue };
            let of_callee = wanted[callee.0 as usize].get_or_insert_with(|| vec![false; count(callee)]);
            if let Some(result) = result {
                of_callee[result as usize] = true;
            }
        }
    }
    wanted
}

fn live_nodes(function: &Function) -> impl Iterator<Item = Node> {
    let live = live(function).into_iter();
    function.nodes.iter().zip(live).filter(|(_, live)| *live).map(|(node, _)| *node)
}

/// What has become of a function.
struct Callee {
    id: FunctionId,
    /// Which parameters it still takes.
    takes: Vec<bool>,
    /// What has become of each of its results.
    results: Vec<Outcome>,
}

/// What has become of a result.
#[derive(Clone, Copy)]
enum Outcome {
    /// The function yields it.
    Yielded,
    /// It needs no call.
    Trivial(Trivial),
    /// Nobody wants it.
    Unwanted,
}

/// A result that needs no call.
#[derive(Clone, Copy)]
enum Trivial {
    /// A parameter, by its place before any was dropped.
    Parameter(u16),
    /// A number.
    Float(f64),
    /// A truth value.
    Bool(bool),
}

/// The program that is being made.
struct Rebuild {
    program: Program,
    callees: Vec<Option<Callee>>,
    /// The functions so far, without the names that do not matter.
    known: MixMap<Function, FunctionId>,
}

impl Links for Rebuild {
    fn call(
        &self,
        builder: &mut Builder,
        callee: FunctionId,
        results: &[Type],
        arguments: &[Value],
    ) -> Vec<Value> {
        let callee = self.callee(callee);
        let is_yielded: Vec<bool> =
            callee.results.iter().map(|outcome| matches!(outcome, Outcome::Yielded)).collect();
        let yielded = match kept(results, &is_yielded) {
            none if none.is_empty() => Vec::new(),
            types => builder.call(callee.id, &types, &kept(arguments, &callee.takes)),
        };
        let mut yielded = yielded.into_iter();
        let result = |outcome: &Outcome| match *outcome {
            Outcome::Yielded => yielded.next().expect("as many as the call has"),
            Outcome::Trivial(Trivial::Parameter(index)) => arguments[index as usize],
            Outcome::Trivial(Trivial::Float(x)) => builder.float(x),
            Outcome::Trivial(Trivial::Bool(it)) => builder.bool(it),
            Outcome::Unwanted => builder.bool(false),
        };
        callee.results.iter().map(result).collect()
    }
}

impl Rebuild {
    fn callee(&self, id: FunctionId) -> &Callee {
        self.callees[id.0 as usize].as_ref().expect("callees stand before their callers")
    }

    /// Makes a function anew, with the results that are wanted; one that is fixed keeps its parameters and results.
    fn function(&mut self, id: FunctionId, source: &Function, wanted: Vec<bool>, is_fixed: bool) {
        let all = vec![true; source.parameters.len()];
        let source = &with_results(source, &wanted);
        let copied = with_parameters(source, &all, self);
        let trivial: Vec<Option<Trivial>> =
            copied.root().results.iter().map(|v| trivial(&copied, *v)).collect();
        // One that is fixed yields all, or nothing is asked of it.
        let is_asked = is_fixed && trivial.iter().any(Option::is_none);
        let trivial = if is_asked { vec![None; trivial.len()] } else { trivial };
        let yields: Vec<bool> = trivial.iter().map(|it| is_fixed || it.is_none()).collect();
        let copied = with_results(&copied, &yields);
        let takes = if is_fixed { all } else { used_parameters(&copied) };
        let mut trivial = trivial.into_iter();
        let outcome = |is_wanted: &bool| match is_wanted.then(|| trivial.next().expect("one for each result"))
        {
            None => Outcome::Unwanted,
            Some(None) => Outcome::Yielded,
            Some(Some(it)) => Outcome::Trivial(it),
        };
        let results = wanted.iter().map(outcome).collect();
        let made = if takes.contains(&false) {
            with_parameters(&copied, &takes, &crate::copy::SameProgram)
        } else {
            copied
        };
        let key = without_names(&made);
        let id_now = match self.known.get(&key) {
            Some(same) if !is_fixed => {
                if made.is_evaluation() {
                    self.program.functions[same.0 as usize].mark_evaluation();
                }
                *same
            }
            _ => {
                let new = self.program.add(made);
                self.known.entry(key).or_insert(new);
                new
            }
        };
        self.callees[id.0 as usize] = Some(Callee { id: id_now, takes, results });
    }
}

/// The function with only these of its results.
fn with_results(function: &Function, wanted: &[bool]) -> Function {
    let mut function = function.clone();
    function.regions[0].results = kept(&function.regions[0].results, wanted);
    function.result_names = kept(&function.result_names, wanted);
    function
}

/// The function with only these of its parameters; nothing may depend on the others.
fn with_parameters(source: &Function, takes: &[bool], links: &dyn Links) -> Function {
    let parameters = source.parameters.iter().zip(takes).filter(|(_, takes)| **takes);
    let parameters: Vec<Parameter> = parameters.map(|(parameter, _)| parameter.clone()).collect();
    let mut builder = Builder::new(source.name.clone(), parameters);
    builder.set_line(source.line);
    builder.set_doc(source.doc.clone());
    builder.set_lipschitz(source.lipschitz());
    builder.set_evaluation(source.is_evaluation());
    let mut kept = 0..;
    let arguments: Vec<Value> = takes
        .iter()
        .map(|takes| {
            if *takes {
                builder.argument(RegionId::ROOT, kept.next().expect("no end"))
            } else {
                builder.bool(false)
            }
        })
        .collect();
    let results = inline_whole(&mut builder, source, &arguments, links);
    builder.finish(results.into_iter().zip(source.result_names.iter().cloned()).collect())
}

fn used_parameters(function: &Function) -> Vec<bool> {
    let mut used = vec![false; function.parameters.len()];
    for node in live_nodes(function) {
        if let Node::Argument(RegionId::ROOT, index) = node {
            used[index as usize] = true;
        }
    }
    used
}

/// What a value of a function is, where it is a parameter or a number.
fn trivial(function: &Function, value: Value) -> Option<Trivial> {
    match function.node(value) {
        Node::Argument(RegionId::ROOT, index) => Some(Trivial::Parameter(index)),
        Node::Float(bits) => Some(Trivial::Float(f64::from_bits(bits))),
        Node::Bool(it) => Some(Trivial::Bool(it)),
        _ => None,
    }
}

/// The function as it is compared with others.
fn without_names(function: &Function) -> Function {
    let mut it = function.clone();
    it.name = "".into();
    it.line = None;
    it.doc = None;
    it.names.fill(None);
    it.result_names.fill("".into());
    it.parameters.iter_mut().for_each(|parameter| parameter.name = "".into());
    it
}

// ---- uniforms and globals

/// New indices for what is kept.
struct Renumbered {
    uniforms: Vec<Option<u16>>,
    globals: Vec<Option<u16>>,
}

impl Links for Renumbered {
    fn uniform(&self, index: u16) -> u16 {
        self.uniforms[index as usize].expect("a uniform that is read is kept")
    }

    fn global(&self, index: u16) -> u16 {
        self.globals[index as usize].expect("a global that is read is kept")
    }
}

/// The program without the globals that no function reads, and then without the uniforms.
fn without_unused_inputs((program, roots): Rooted) -> Rooted {
    let mut uniforms = vec![false; program.uniforms.len()];
    let mut globals = vec![false; program.globals.len()];
    for node in program.functions.iter().flat_map(live_nodes) {
        match node {
            Node::Uniform(index) => uniforms[index as usize] = true,
            Node::Global(index) => globals[index as usize] = true,
            Node::Loop(Loop { limit: Some(limit), .. }) => uniforms[limit.uniform as usize] = true,
            _ => {}
        }
    }
    if !uniforms.contains(&false) && !globals.contains(&false) {
        return (program, roots);
    }
    let links = Renumbered { uniforms: renumbered(&uniforms), globals: renumbered(&globals) };
    let mut smaller = Program {
        uniforms: kept(&program.uniforms, &uniforms),
        globals: kept(&program.globals, &globals),
        entry: program.entry,
        frame: program.frame.filter(|_| globals.contains(&true)),
        functions: Vec::new(),
        is_tiny: program.is_tiny,
    };
    for (index, function) in program.functions.iter().enumerate() {
        let is_frame = program.frame == Some(FunctionId(index as u32));
        let function = if is_frame { with_results(function, &globals) } else { function.clone() };
        smaller.add(with_parameters(&function, &vec![true; function.parameters.len()], &links));
    }
    (smaller, roots)
}

fn kept<T: Clone>(all: &[T], used: &[bool]) -> Vec<T> {
    all.iter().zip(used).filter(|(_, used)| **used).map(|(it, _)| it.clone()).collect()
}

fn renumbered(used: &[bool]) -> Vec<Option<u16>> {
    let mut next = 0..;
    used.iter().map(|used| used.then(|| next.next().expect("no end"))).collect()
}

#[cfg(test)]
mod tests {
    use super::simplify;
    use crate::build::Builder;
    use crate::constant::Constant;
    use crate::program::{
        Binary, FunctionId, Global, Limit, Node, Parameter, Program, RegionId, Role, Type, Unary, Uniform,
        Value,
    };

    fn float(name: &str) -> Parameter {
        Parameter { name: name.into(), ty: Type::Float, point: false }
    }

    fn uniform(name: &str) -> Uniform {
        Uniform { name: name.into(), ty: Type::Float, role: Role::Time, default: Constant::Float(0.0) }
    }

    fn function(
        program: &mut Program,
        name: &str,
        parameters: &[&str],
        make: impl FnOnce(&mut Builder, &[Value]) -> Value,
    ) -> FunctionId {
        let mut b = Builder::new(name, parameters.iter().map(|name| float(name)).collect());
        let arguments: Vec<Value> =
            (0..parameters.len()).map(|i| b.argument(RegionId::ROOT, i as u16)).collect();
        let result = make(&mut b, &arguments);
        program.add(b.finish(vec![(result, "".into())]))
    }

    fn call(b: &mut Builder, callee: FunctionId, arguments: &[Value]) -> Value {
        b.call(callee, &[Type::Float], arguments)[0]
    }

    /// Simplified, well formed, and so that it stays when simplified again.
    fn simplified(program: &Program) -> Program {
        assert_eq!(crate::verify(program), Ok(()));
        let (once, _) = simplify(program, &[]);
        assert_eq!(crate::verify(&once), Ok(()));
        let (twice, _) = simplify(&once, &[]);
        assert_eq!(twice, once);
        once
    }

    #[test]
    fn what_nobody_uses_goes() {
        let mut program = Program {
            uniforms: vec![uniform("unused"), uniform("for_unused_global"), uniform("used")],
            globals: ["unused", "used"].map(|name| Global { name: name.into(), ty: Type::Float }).to_vec(),
            ..Program::default()
        };
        let mut b = Builder::new("frame", vec![]);
        let [first, second] = [1, 2].map(|i| b.uniform(i, Type::Float));
        let results = [first, second].map(|v| (b.unary(Unary::Sin, v), "".into())).to_vec();
        program.frame = Some(program.add(b.finish(results)));
        function(&mut program, "unreached", &["x"], |b, x| b.unary(Unary::Tan, x[0]));
        let callee = function(&mut program, "callee", &["a", "b", "c"], |b, x| {
            b.unary(Unary::Tanh, x[0]);
            let global = b.global(1, Type::Float);
            b.mul(x[1], global)
        });
        let entry = function(&mut program, "entry", &["x", "unused"], |b, x| {
            let dear = b.unary(Unary::Exp, x[0]);
            call(b, callee, &[dear, x[0], dear])
        });
        program.entry = Some(entry);
        insta::assert_snapshot!(simplified(&program));
    }

    /// The setting is kept that a number of rounds is made of, and nothing else reads.
    #[test]
    fn the_setting_of_a_loop_stays_and_is_renumbered() {
        let steps = Uniform { role: Role::Setting, default: Constant::Float(2.0), ..uniform("steps") };
        let mut program = Program { uniforms: vec![uniform("unused"), steps], ..Program::default() };
        program.entry = Some(function(&mut program, "entry", &["x"], |b, x| {
            let until = b.open_region(&[Type::Float]);
            let no = b.bool(false);
            b.close_region(vec![no]);
            let next = b.open_region(&[Type::Float, Type::Float]);
            let state = b.argument(next, 1);
            let root = b.unary(Unary::Sqrt, state);
            b.close_region(vec![root]);
            b.repeat_to((4, Some(Limit { uniform: 1, times: 2 })), x, until, next)[0]
        }));
        let simple = simplified(&program);
        assert_eq!(simple.uniforms.len(), 1);
        assert!(simple.to_string().contains("at most 4 (2 u0) rounds"), "{simple}");
    }

    #[test]
    fn results_that_nobody_needs_from_a_call_go() {
        let mut program = Program::default();
        let mut b = Builder::new("inner", vec![float("x")]);
        let x = b.argument(RegionId::ROOT, 0);
        let (sine, cosine, tangent) =
            (b.unary(Unary::Sin, x), b.unary(Unary::Cos, x), b.unary(Unary::Tan, x));
        let results = [sine, cosine, tangent].map(|v| (v, "".into())).to_vec();
        let inner = program.add(b.finish(results));
        // Only the entry's own use of the third result, which is none, would keep the tangent.
        let mut b = Builder::new("outer", vec![float("x"), float("y")]);
        let [x, y] = [0, 1].map(|i| b.argument(RegionId::ROOT, i));
        let parts = b.call(inner, &[Type::Float; 3], &[x]);
        let (one, sum) = (b.float(1.0), b.add(parts[0], y));
        let results = [sum, parts[2], y, one].map(|v| (v, "".into())).to_vec();
        let outer = program.add(b.finish(results));
        program.entry = Some(function(&mut program, "entry", &["x", "y"], |b, x| {
            let parts = b.call(outer, &[Type::Float; 4], x);
            let scaled = b.mul(parts[0], parts[2]);
            b.add(scaled, parts[3])
        }));
        let simple = simplified(&program);
        let counts: Vec<usize> = simple.functions.iter().map(|f| f.root().results.len()).collect();
        assert_eq!(counts, [1, 1, 1]);
        let has = |op| {
            simple
                .functions
                .iter()
                .any(|f| f.nodes.iter().any(|n| matches!(n, Node::Unary(it, _) if *it == op)))
        };
        assert!(has(Unary::Sin) && !has(Unary::Cos) && !has(Unary::Tan));
    }

    #[test]
    fn functions_that_are_the_same_become_one() {
        let mut program = Program::default();
        let [first, second] = ["first", "second"].map(|name| {
            let inner =
                function(&mut program, &format!("{name}_inner"), &[name], |b, x| b.unary(Unary::Cos, x[0]));
            function(&mut program, name, &["x"], |b, x| {
                let y = call(b, inner, x);
                b.unary(Unary::Sin, y)
            })
        });
        program.entry = Some(function(&mut program, "entry", &["x"], |b, x| {
            let (a, c) = (call(b, first, x), call(b, second, x));
            b.mul(a, c)
        }));
        let simple = simplified(&program);
        assert_eq!(simple.functions.len(), 3);
        assert_eq!(simple.functions[2].nodes.iter().filter(|n| matches!(n, Node::Call(..))).count(), 1);
    }

    #[test]
    fn a_call_of_what_computes_nothing_is_its_result() {
        let mut program = Program::default();
        let second = function(&mut program, "second", &["a", "b"], |_, x| x[1]);
        let zero = function(&mut program, "zero", &["a"], |b, x| b.sub(x[0], x[0]));
        program.entry = Some(function(&mut program, "entry", &["x", "y"], |b, x| {
            let a = call(b, second, x);
            let z = call(b, zero, &[a]);
            b.add(a, z)
        }));
        let simple = simplified(&program);
        assert_eq!(simple.functions.len(), 1);
        assert_eq!(simple.functions[0].root().results, [Value(1)]);
        assert!(simple.functions[0].root().body.is_empty());
    }

    #[test]
    fn a_bound_that_is_in_the_chain_already_goes() {
        let mut program = Program::default();
        let entry = function(&mut program, "entry", &["x", "y", "z"], |b, x| {
            let first = b.min(x[0], x[1]);
            let second = b.min(first, x[2]);
            let third = b.min(second, x[1]);
            b.min(x[0], third)
        });
        program.entry = Some(entry);
        assert_eq!(simplified(&program).functions[0].root().body.len(), 2);
    }

    #[test]
    fn roots_stay_as_they_are_called() {
        let mut program = Program::default();
        function(&mut program, "unreached", &["x"], |b, x| b.unary(Unary::Tan, x[0]));
        let root = function(&mut program, "root", &["x", "unused"], |b, x| b.unary(Unary::Sin, x[0]));
        let same = function(&mut program, "same", &["x", "unused"], |b, x| b.unary(Unary::Sin, x[0]));
        let (simple, roots) = simplify(&program, &[root, same]);
        assert_eq!(roots, [FunctionId(0), FunctionId(1)]);
        assert_eq!(simple.function(roots[0]).parameters.len(), 2);
        assert_eq!(&*simple.function(roots[1]).name, "same");
    }

    #[test]
    fn a_condition_that_folds_on_the_way_takes_its_branch() {
        let mut program = Program::default();
        let one = function(&mut program, "one", &["a"], |b, _| b.float(1.0));
        program.entry = Some(function(&mut program, "entry", &["x"], |b, x| {
            let (one, zero) = (call(b, one, x), b.float(0.0));
            let condition = b.binary(Binary::Less, zero, one);
            let then = b.open_region(&[]);
            let sine = b.unary(Unary::Sin, x[0]);
            b.close_region(vec![sine]);
            let otherwise = b.open_region(&[]);
            let cosine = b.unary(Unary::Cos, x[0]);
            b.close_region(vec![cosine]);
            b.branch(condition, then, otherwise)[0]
        }));
        let simple = simplified(&program);
        assert_eq!(simple.functions[0].root().body.len(), 1);
    }
}
