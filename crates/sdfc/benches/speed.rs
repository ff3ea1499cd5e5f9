//! How fast the compiler is and how much memory it takes: `cargo bench -p sdfc`.
//!
//! A line `target …` before each group says what is asked for. Whole processes are what a user waits for: reading,
//! compiling, validating and writing. The largest memory of each is read from `/proc` and printed behind them.

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use sdfc::{Clock, Device, Frame, Language, Options, Shader, Target, compile};
use std::fmt::Write;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// Ten shapes, with a blend, a shadow and occlusion.
const SMALL: &str = "
camera    { eye: (0, 2, 6), target: (0, 0.5, 0) }
light key { direction: (3, 5, 4), shadow: soft(16) }
ambient   { occlusion: 0.5 }
scene {
  plane(),
  smin(sphere(0.6).at(0, 0.8, 0), box(0.4).at(0.5, 0.5, 0), k: 0.2).paint(#ff8855),
  torus(1.2, 0.1).at(0, 1, 0) | sphere(0.2).at(1.2, 1, 0) | sphere(0.2).at(-1.2, 1, 0),
  box(0.4).at(2, 0.4, 0) - sphere(0.45).at(2, 0.6, 0),
  capsule((-2, 0.3, 0), (-2, 1, 0), 0.2),
  sphere(0.3).at(-3, 0.3, 1),
}
";

/// This many spheres as entries of the scene.
fn entries(count: usize) -> String {
    format!("scene {{\n{}}}\n", spheres(count).map(|sphere| format!("  {sphere},\n")).collect::<String>())
}

/// This many spheres as one chain of `|`.
fn chain(count: usize) -> String {
    format!("scene {{\n  {}\n}}\n", spheres(count).collect::<Vec<_>>().join("\n  | "))
}

/// This many spheres as a list.
fn list(count: usize) -> String {
    format!(
        "scene {{ for i in 0..{count} {{ sphere(0.3).at(20 * sin(1.7 * i), 20 * cos(0.7 * i), 0.02 * i) }} }}\n"
    )
}

fn spheres(count: usize) -> impl Iterator<Item = String> {
    (0..count).map(|i| {
        let i = i as f64;
        let (x, y, z) = (20.0 * (1.7 * i).sin(), 20.0 * (0.7 * i).cos(), 20.0 * (0.618 * i).fract());
        format!("sphere(0.3).at({x:.3}, {y:.3}, {z:.3})")
    })
}

/// The scenes of `examples/`, in the order of their names.
fn examples() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let files = std::fs::read_dir(folder).expect("the examples").map(|entry| entry.expect("a file").path());
    let mut scenes: Vec<(String, String)> = files
        .filter(|path| path.extension().is_some_and(|extension| extension == "sdf"))
        .map(|path| (name_of(&path), std::fs::read_to_string(&path).expect("an example")))
        .collect();
    scenes.sort();
    scenes
}

fn name_of(path: &Path) -> String {
    path.file_stem().expect("a name").to_string_lossy().into_owned()
}

fn shader(text: &str) -> Shader {
    let compiled = compile("scene.sdf", text, &Options::default(), &mut Clock::default());
    assert!(!compiled.has_errors(), "{:?}", compiled.diagnostics);
    compiled.output.expect("a scene without errors").1
}

/// From text to validated text, without a process round it.
fn library(c: &mut Criterion) {
    let mut group = c.benchmark_group("library");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    let mut scenes = vec![("small".to_owned(), SMALL.to_owned())];
    scenes.extend(examples());
    scenes.push(("1000 spheres".to_owned(), entries(1000)));
    for (name, text) in scenes {
        group.bench_function(BenchmarkId::from_parameter(name), |b| {
            b.iter(|| shader(black_box(&text)).text(Target::Wgsl).expect("a valid shader"));
        });
    }
    group.finish();
}

/// `sdfc scene.sdf -o scene.wgsl`.
fn process(c: &mut Criterion) {
    println!("target of a small scene: 20 ms; of 10000 spheres: 2 s; of either: 300 MiB");
    let folder = tempfile::tempdir().expect("a folder");
    let mut group = c.benchmark_group("process");
    group.sampling_mode(SamplingMode::Flat).sample_size(10).warm_up_time(Duration::from_millis(300));
    let scenes = [
        ("small", SMALL.to_owned()),
        ("1000 spheres", entries(1000)),
        ("10000 spheres", entries(10_000)),
        ("10000 spheres in a list", list(10_000)),
        ("10000 spheres in a chain", chain(10_000)),
    ];
    let mut memory = String::new();
    for (name, text) in scenes {
        let path = folder.path().join("scene.sdf");
        std::fs::write(&path, text).expect("a scene");
        group.measurement_time(Duration::from_secs(if name == "small" { 2 } else { 5 }));
        group.bench_function(BenchmarkId::from_parameter(name), |b| {
            b.iter(|| assert!(start(&path).wait().expect("its end").success()));
        });
        if let Some(mebibytes) = largest_memory(start(&path)) {
            writeln!(memory, "process/{name}: {mebibytes} MiB at most").expect("a string takes all");
        }
    }
    group.finish();
    print!("{memory}");
}

fn start(scene: &Path) -> Child {
    let output: PathBuf = scene.with_extension("wgsl");
    let mut command = Command::new(env!("CARGO_BIN_EXE_sdfc"));
    command.arg(scene).arg("-o").arg(output).spawn().expect("a process")
}

/// The most memory that a process held, in MiB, as its last look into `/proc` says; `None` where there is no such
/// folder or the process is too quick to be seen.
fn largest_memory(mut child: Child) -> Option<u64> {
    let status = format!("/proc/{}/status", child.id());
    let mut most = None;
    while child.try_wait().expect("its state").is_none() {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kibibytes = line.and_then(|rest| rest.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        most = most.max(kibibytes.map(|n| n.div_ceil(1024)));
        std::thread::sleep(Duration::from_micros(500));
    }
    most
}

/// The usual ways of writing this many shapes.
fn ways(count: usize) -> Vec<(&'static str, String)> {
    let all = || spheres(count).enumerate();
    let lines = |line: &dyn Fn(usize, String) -> String| all().map(|(i, s)| line(i, s)).collect::<String>();
    let scene = |entries: String| format!("scene {{\n{entries}}}\n");
    let names = || scene((0..count).map(|i| format!("  s{i},\n")).collect());
    let ball = "sphere(0.3).at(20 * sin(1.7 * i), 20 * cos(0.7 * i), 0.02 * i)";
    vec![
        ("entries of the scene", entries(count)),
        ("a `for`", list(count)),
        ("`a | b | …`", chain(count)),
        (
            "nested unions by recursion",
            "fn tree(a, b) = if b - a < 1.5 { sphere(0.3).at(20 * sin(1.7 * a), 20 * cos(0.7 * a), 0.02 * a) } else {
               let m = floor((a + b) / 2); tree(a, m) | tree(m, b) }\n"
                .to_string()
                + &scene(format!("tree(0, {count})")),
        ),
        (
            "`.at().rotate().paint()`",
            scene(lines(&|i, s| {
                format!("  {s}.rotate((1, {}, 2), {}deg).paint(#{:06x}),\n", i % 10, i % 90, i * 977 % 0xffffff)
            })),
        ),
        ("`let`s", lines(&|i, s| format!("let s{i} = {s}\n")) + &names()),
        (
            "materials",
            lines(&|i, _| format!("material m{i} {{ color: {:.4}, specular: 0.5 }}\n", (i % 97) as f64 / 97.0))
                + &scene(lines(&|i, s| format!("  {s}.paint(m{i}),\n"))),
        ),
        ("`smin` of all", scene(format!("smin({}, k: 0.1)", spheres(count).collect::<Vec<_>>().join(", ")))),
        ("a `fold`", scene(format!("fold(0..{count}, nothing(), |all, i| all | {ball})"))),
    ]
}

/// How the time grows with the number of shapes: the exponent of the power that fits the middle times of five sizes.
fn growth(_: &mut Criterion) {
    /// From a thousand to thirty thousand, each 2.34 times the one before.
    const SIZES: [usize; 5] = [1000, 2340, 5477, 12_818, 30_000];
    const ROUNDS: usize = 3;
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    println!("target of the growth of whole processes from 1000 to 30000 shapes: n^1.1");
    let folder = tempfile::tempdir().expect("a folder");
    for way in 0..ways(1).len() {
        let scenes = SIZES.map(|size| {
            let path = folder.path().join(format!("{size}.sdf"));
            std::fs::write(&path, ways(size).swap_remove(way).1).expect("a scene");
            path
        });
        // The sizes take turns, so that a busy machine slows all of them.
        let mut times = vec![Vec::new(); SIZES.len()];
        for _ in 0..ROUNDS {
            for (scene, times) in scenes.iter().zip(&mut times) {
                let begin = Instant::now();
                assert!(start(scene).wait().expect("its end").success());
                times.push(begin.elapsed().as_secs_f64());
            }
        }
        let points: Vec<(f64, f64)> = SIZES
            .iter()
            .zip(&mut times)
            .map(|(size, times)| {
                times.sort_by(f64::total_cmp);
                ((*size as f64).ln(), times[ROUNDS / 2].ln())
            })
            .collect();
        let seconds: Vec<String> = points.iter().map(|(_, t)| format!("{:.2} s", t.exp())).collect();
        println!("growth/{:<28} n^{:.2}  ({})", ways(1)[way].0, slope(&points), seconds.join(", "));
    }
}

/// The slope of the line that fits points best.
fn slope(points: &[(f64, f64)]) -> f64 {
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2))
}

/// The interpreter, on all cores.
fn draw(c: &mut Criterion) {
    println!("target of the colonnade at 640×360: 3 s on two cores");
    let mut group = c.benchmark_group("draw on the CPU");
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(5));
    let (_, text) = examples().into_iter().find(|(name, _)| name == "colonnade").expect("the example");
    let shader = shader(&text);
    let frame = Frame::new(640, 360);
    group.bench_function("colonnade at 640×360", |b| {
        b.iter(|| {
            shader
                .draw(&frame, &Device::Cpu, Language::Wgsl, &|_| {}, &mut Clock::default())
                .expect("a picture")
        });
    });
    group.finish();
}

criterion_group!(benches, library, process, growth, draw);
criterion_main!(benches);
