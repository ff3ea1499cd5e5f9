//! The files of `tests/hard/`. Above a file's scene, comments say what is hard about it and then, each on a line of its own:
//!
//! * `// each: NAME = A, B`: the case is one scene for each value, which a param of that name is frozen to;
//! * `// no larger: NAME = A, B`: values more, with which larger pictures would show what numbers cannot tell;
//! * `// frames: NAME = A, B`: each scene is drawn with each value of a param, or of `time`, as a uniform;
//! * `// sweep: NAME = A..B in N`: the same with N values, evenly spaced, both ends included;
//! * `// size: WxH, WxH`: the pictures' sizes, instead of [`SIZE`];
//! * `// ambiguous: N %`, `// out of steps: N %`: how many pixels may be so, where the case cannot have as few as others;
//! * `// normals: rough`: the surface is rough below the tolerance, so that any normal is as good as another;
//! * `// colour: R, G, B`: all that is seen has this colour;
//! * `// shadows: exact`: the colour of all surfaces is the vector to the light, and what is lit is certified, too;
//! * `// also: CLIENT, CLIENT`: where it is run besides the interpreter and lavapipe: `SwiftShader`, `Chromium`;
//! * `// twin: NAME shows FAULT`, `// twin: NAME on CLIENT shows FAULT`: the [twin](super::twin), and what must be wrong with
//!   its pictures, on the interpreter where no client of `also` is named.

use sdf_ir::Constant;
use sdf_lang::{Options, Scene};
use sdf_render::Frame;
use std::path::{Path, PathBuf};

/// The size of a picture where a file says nothing.
pub const SIZE: [u32; 2] = [48, 27];
/// The largest shares of a scene's pixels that may be ambiguous, and that may be out of steps, where a file says nothing.
pub const AMBIGUOUS: f64 = 0.005;
/// See [`AMBIGUOUS`].
pub const OUT_OF_STEPS: f64 = 0.001;

/// How many pixels are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Pictures of the sizes that the files say, and every tenth frame of a sweep.
    Short,
    /// Pictures of as many times more pixels a side as [`LONG_SCALE`] says, but those of sweeps, which are whole, and of values
    /// of which larger pictures would show nothing.
    Long,
}

/// See [`Effort::Long`].
pub const LONG_SCALE: u32 = 3;

/// A file.
#[derive(Debug, Clone, PartialEq)]
pub struct Fixture {
    /// Its name without the ending, which begins with the number of the case.
    pub name: String,
    /// What it holds.
    pub text: String,
    /// The param that is frozen and its values, as written.
    pub each: Option<(String, Vec<String>)>,
    /// How many of the values, the last ones, are for pictures of these sizes alone.
    pub no_larger: usize,
    /// The uniform that differs from frame to frame and its values.
    pub frames: Option<(String, Vec<f64>)>,
    /// Widths and heights.
    pub sizes: Vec<[u32; 2]>,
    /// The largest share of ambiguous pixels.
    pub ambiguous: f64,
    /// The largest share of pixels that are out of steps.
    pub out_of_steps: f64,
    /// Whether the frames are those of a sweep.
    pub is_sweep: bool,
    /// Whether normals are not judged.
    pub is_rough: bool,
    /// What is seen everywhere.
    pub colour: Option<[f32; 3]>,
    /// Whether shadows are certified.
    pub shadows: bool,
    /// Where it is run besides.
    pub also: Vec<String>,
    /// The naive twin, and what it must show.
    pub twin: Option<Naive>,
}

/// What a file says of its twin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Naive {
    /// The twin's [name](super::twin::Twin::named).
    pub twin: String,
    /// How the name of the [execution](super::Execution) on which it is run begins.
    pub client: String,
    /// The fault that it must have at more pixels than the case itself.
    pub fault: String,
}

/// A scene of a fixture.
///
/// Where `tests/hard/truth/` has a file of the fixture's name, the truth is found from that: what the scene stands for,
/// written out, for formulas that jump from cell to cell say too little about regions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Subject {
    /// The name of the fixture, and the value where there are several.
    pub name: String,
    /// What the file holds.
    pub text: String,
    /// What the truth is found from.
    pub truth: String,
    /// The param that is frozen, with its value.
    pub set: Vec<(String, String)>,
    /// Whether larger pictures have no truth.
    pub no_larger: bool,
}

/// The folder of the files.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("hard")
}

/// All files, by name.
pub fn fixtures() -> Vec<Fixture> {
    let files = std::fs::read_dir(folder()).expect("the folder of the hard cases");
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("a file").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "sdf"));
    paths.sort();
    let fixture = |path: &PathBuf| {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        Fixture::of(&name, std::fs::read_to_string(path).expect("a text"))
    };
    paths.iter().map(fixture).collect()
}

impl Fixture {
    /// A file of this name and text.
    pub fn of(name: &str, text: String) -> Fixture {
        let mut fixture = Fixture {
            name: name.to_owned(),
            text: String::new(),
            each: None,
            no_larger: 0,
            frames: None,
            sizes: vec![SIZE],
            ambiguous: AMBIGUOUS,
            out_of_steps: OUT_OF_STEPS,
            is_sweep: false,
            is_rough: false,
            colour: None,
            shadows: false,
            also: Vec::new(),
            twin: None,
        };
        let head = text.lines().map_while(|line| line.strip_prefix("//"));
        for (key, value) in head.filter_map(|line| line.strip_prefix(' ')?.split_once(": ")) {
            fixture.read(key, value).unwrap_or_else(|| panic!("{name}: what is `{key}: {value}`?"));
        }
        Fixture { text, ..fixture }
    }

    /// Takes in what a line of the head says. Prose may hold colons too: only these keys mean something.
    fn read(&mut self, key: &str, value: &str) -> Option<()> {
        let list = |text: &str| text.split(',').map(|item| item.trim().to_owned()).collect::<Vec<_>>();
        let numbers =
            |text: &str| text.split(',').map(|item| item.trim().parse().ok()).collect::<Option<_>>();
        let percent = |text: &str| Some(text.strip_suffix(" %")?.parse::<f64>().ok()? / 100.0);
        match key {
            "each" => {
                let (name, values) = value.split_once(" = ")?;
                self.each = Some((name.to_owned(), list(values)));
            }
            "no larger" => {
                let (name, values) = value.split_once(" = ")?;
                let (_, all) = self.each.as_mut().filter(|(each, _)| each == name)?;
                let values = list(values);
                self.no_larger = values.len();
                all.extend(values);
            }
            "frames" => {
                let (name, values) = value.split_once(" = ")?;
                self.frames = Some((name.to_owned(), numbers(values)?));
            }
            "sweep" => {
                let (name, values) = value.split_once(" = ")?;
                let (range, count) = values.split_once(" in ")?;
                let (first, last) = range.split_once("..")?;
                let [first, last]: [f64; 2] = [first.parse().ok()?, last.parse().ok()?];
                let count: usize = count.parse().ok()?;
                let at = |i| first + (last - first) * i as f64 / (count - 1) as f64;
                self.frames = Some((name.to_owned(), (0..count).map(at).collect()));
                self.is_sweep = true;
            }
            "size" => {
                let size = |text: &String| {
                    let (width, height) = text.split_once('x')?;
                    Some([width.parse().ok()?, height.parse().ok()?])
                };
                self.sizes = list(value).iter().map(size).collect::<Option<_>>()?;
            }
            "ambiguous" => self.ambiguous = percent(value)?,
            "out of steps" => self.out_of_steps = percent(value)?,
            "colour" => {
                let numbers: Vec<f32> = numbers(value)?.into_iter().map(|x: f64| x as f32).collect();
                self.colour = Some(numbers.try_into().ok()?);
            }
            "shadows" => self.shadows = (value == "exact").then_some(true)?,
            "normals" => self.is_rough = (value == "rough").then_some(true)?,
            "also" => self.also = list(value),
            "twin" => {
                let (twin, fault) = value.split_once(" shows ")?;
                let (twin, client) = twin.split_once(" on ").unwrap_or((twin, "interpreter"));
                let [twin, client, fault] = [twin, client, fault].map(str::to_owned);
                self.twin = Some(Naive { twin, client, fault });
            }
            _ => {}
        }
        Some(())
    }

    /// The number of the case.
    pub fn number(&self) -> u32 {
        let digits = self.name.split('_').next().expect("a name");
        digits.parse().unwrap_or_else(|_| panic!("{} does not begin with a number", self.name))
    }

    /// Its scenes.
    pub fn subjects(&self) -> Vec<Subject> {
        let written = folder().join("truth").join(&self.name).with_extension("sdf");
        let truth = std::fs::read_to_string(written).unwrap_or_else(|_| self.text.clone());
        let subject = |name, set, no_larger| Subject {
            name,
            text: self.text.clone(),
            truth: truth.clone(),
            set,
            no_larger,
        };
        let Some((param, values)) = &self.each else {
            return vec![subject(self.name.clone(), Vec::new(), false)];
        };
        let larger = values.len() - self.no_larger;
        let of = |(i, value): (usize, &String)| {
            let name = format!("{}, {param} = {value}", self.name);
            subject(name, vec![(param.clone(), value.clone())], i >= larger)
        };
        values.iter().enumerate().map(of).collect()
    }

    /// The frames that each scene is drawn as.
    pub fn frames(&self, effort: Effort) -> Vec<Frame> {
        let is_larger = effort == Effort::Long && !self.is_sweep;
        let scale = if is_larger { LONG_SCALE } else { 1 };
        let every = if effort == Effort::Short && self.is_sweep { 10 } else { 1 };
        let plain = self.sizes.iter().map(|[width, height]| Frame::new(width * scale, height * scale));
        let Some((name, values)) = &self.frames else { return plain.collect() };
        let with = |frame: Frame| {
            values.iter().step_by(every).map(move |value| match name.as_str() {
                "time" => Frame { time: *value, ..frame.clone() },
                param => {
                    let mut frame = frame.clone();
                    frame.params.insert(param.to_owned(), Constant::Float(*value));
                    frame
                }
            })
        };
        plain.flat_map(with).collect()
    }
}

impl Subject {
    /// The same scene with nothing frozen, and the frames in which its params have these values all the same.
    pub fn thawed(&self, frames: &[Frame]) -> (Subject, Vec<Frame>) {
        let value = |text: &str| Constant::Float(text.parse().expect("a number"));
        let params = self.set.iter().map(|(name, text)| (name.clone(), value(text)));
        let with = |frame: &Frame| {
            let mut frame = frame.clone();
            frame.params.extend(params.clone());
            frame
        };
        (Subject { set: Vec::new(), ..self.clone() }, frames.iter().map(with).collect())
    }

    /// The scene that the truth is found from.
    pub fn truth(&self) -> Scene {
        self.compiled(&self.truth, &[])
    }

    /// The scene, with other texts in the place of some of the compiler's.
    pub fn scene(&self, replaced: &[(String, String)]) -> Scene {
        self.compiled(&self.text, replaced)
    }

    fn compiled(&self, text: &str, replaced: &[(String, String)]) -> Scene {
        let options = Options {
            set: self.set.clone(),
            attack: Some(0),
            probe: true,
            certificate: true,
            replaced: replaced.to_vec(),
            ..Options::default()
        };
        crate::scenes::scene(&self.name, text, &options)
    }
}
