//! What the command understands.

mod cost;

pub use cost::{BoundArguments, CostArguments};

use crate::failure::Failure;
use anstream::stream::RawStream;
use anstream::{AutoStream, ColorChoice};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use sdfc::{Device, FileLoader, Format, Language, Options, Quality, Target, View, reason};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The largest side of a picture, in pixels.
const SIDE_LIMIT: u32 = 16_384;
/// The longest time for which pictures are timed, in seconds.
const HOUR: f64 = 3600.0;
/// The most pixels of a picture.
const PIXEL_LIMIT: u64 = 1 << 26;

/// Compiles scenes (.sdf) to shaders and pages, and draws them.
#[derive(Debug, Parser)]
#[command(version, arg_required_else_help = true, subcommand_negates_reqs = true)]
#[command(override_usage = "sdfc [OPTIONS] <SCENE> -o <FILE>\n       sdfc <COMMAND> [OPTIONS] …")]
#[command(
    after_help = "Exit status: 0 done, 1 the scene is wrong, 2 the call is wrong, 3 the device failed, \
                        101 sdfc itself is wrong."
)]
pub struct Arguments {
    /// What to do, if not to compile.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// How to compile.
    #[command(flatten)]
    pub compile: CompileArguments,
    /// How messages are shown.
    #[command(flatten)]
    pub messages: MessageArguments,
}

/// How messages are shown, and which of them are failures.
#[derive(Debug, Args)]
pub struct MessageArguments {
    /// Whether messages are coloured
    #[arg(long, value_name = "WHEN", default_value = "auto", global = true)]
    pub color: Color,
    /// How messages are written to standard error
    #[arg(long, value_name = "FORMAT", default_value = "human", global = true)]
    pub message_format: MessageFormat,
    /// What is a failure besides errors: nothing is written then
    #[arg(long, value_name = "WHAT", global = true)]
    pub deny: Option<Denied>,
}

impl MessageArguments {
    /// Whether a stream gets colours.
    pub fn color_on(&self, stream: &impl RawStream) -> ColorChoice {
        match self.color {
            Color::Auto => AutoStream::choice(stream),
            Color::Always => ColorChoice::Always,
            Color::Never => ColorChoice::Never,
        }
    }
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw a scene to a PNG file
    Render(RenderArguments),
    /// Say what is wrong with scenes, and write nothing
    Check(CheckArguments),
    /// Print the distance, the gradient and the material at points
    Query(QueryArguments),
    /// Say what a scene calls for and what that takes; or what the code of a message means
    Explain(ExplainArguments),
    /// Measure what accuracy costs in time: settings from draft to exact, each against the truth
    Cost(CostArguments),
    /// Say what a function of the library, or another word of the language, does; or list them all
    Doc(DocArguments),
}

/// `sdfc SCENE -o FILE`
#[derive(Debug, Args, Default, PartialEq)]
pub struct CompileArguments {
    /// The scene; `-` reads standard input
    #[arg(required = true, value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Where to write the shader; `-` is standard output. Its extension names the target
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The target, whatever the extension says
    #[arg(long, value_name = "TARGET")]
    pub target: Option<TargetName>,
    /// Print what the compiler has made of the scene, to standard output
    #[arg(long, value_name = "STAGES", value_delimiter = ',')]
    pub emit: Vec<Stage>,
    /// The preset.
    #[command(flatten)]
    pub quality: QualityArguments,
    /// Values of params.
    #[command(flatten)]
    pub set: SetArguments,
    /// What the shader's pictures must satisfy.
    #[command(flatten)]
    pub bounds: BoundArguments,
    /// For about how long pictures are timed to find a setting within bounds, in seconds [default: 10]
    #[arg(long, value_name = "SECONDS", value_parser = budget, allow_negative_numbers = true)]
    pub budget: Option<f64>,
    /// The size of the picture that bounds are about, in pixels [default: 640x360]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    pub size: Option<(u32, u32)>,
    /// What draws the picture that bounds are about: `auto`, `gpu`, `cpu`, or a part of a graphics device's name [default: auto]
    #[arg(long, value_name = "DEVICE", value_parser = device)]
    pub device: Option<Device>,
    /// Print how long each stage took
    #[arg(long)]
    pub timings: bool,
}

/// `sdfc render SCENE -o FILE`
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// The scene; `-` reads standard input
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Where to write the picture (.png); `-` is standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// The size of the picture in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x360", value_parser = size)]
    pub size: (u32, u32),
    /// The time in seconds, at least 0
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = seconds, allow_negative_numbers = true)]
    pub time: f64,
    /// What draws: `auto`, `gpu`, `cpu`, or a part of a graphics device's name
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    pub device: Device,
    /// Draw something else than the picture, to see why it is as it is
    #[arg(long, value_name = "VIEW")]
    pub view: Option<ViewName>,
    /// In which language a graphics device is given the shader
    #[arg(long, value_name = "LANGUAGE", default_value = "wgsl", hide = true)]
    pub shader: ShaderLanguage,
    /// The preset.
    #[command(flatten)]
    pub quality: QualityArguments,
    /// Values of params.
    #[command(flatten)]
    pub set: SetArguments,
    /// What the picture must satisfy.
    #[command(flatten)]
    pub bounds: BoundArguments,
    /// For about how long pictures are timed to find a setting within bounds, in seconds [default: 10]
    #[arg(long, value_name = "SECONDS", value_parser = budget, allow_negative_numbers = true)]
    pub budget: Option<f64>,
    /// Print how long each stage took, and what drew
    #[arg(long)]
    pub timings: bool,
}

/// `sdfc check SCENE…`
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// The scenes; `-` reads standard input
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Prove by interval arithmetic what each ray meets, and judge what the march finds: for all values of params and
    /// several times
    ///
    /// Each row is a picture. `certified` pixels show what certainly is there. `false hits`, `false misses` and `unsafe
    /// steps` are mistakes, of which there must be none. `depth off` is how far a hit is from the surface at most, in
    /// tolerances along the normal: up to 2 is right. `normal off` is the largest error of a normal: up to 0.1°, but at
    /// edges. A step is `undecided` where it cannot be proved that it passes no surface; `least free` is the least share
    /// of a step of which that is proved: 0.99 is all that is asked.
    #[arg(long)]
    pub certify: bool,
    /// The size of the pictures that are judged, in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "64x36", value_parser = size, requires = "certify")]
    pub size: (u32, u32),
    /// The preset.
    #[command(flatten)]
    pub quality: QualityArguments,
    /// Values of params.
    #[command(flatten)]
    pub set: SetArguments,
    /// Print how long each stage took
    #[arg(long)]
    pub timings: bool,
}

/// `sdfc query SCENE POINT…`
#[derive(Debug, Args)]
pub struct QueryArguments {
    /// The scene; `-` reads standard input
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Points as X,Y,Z; `-` reads them from standard input, one a line, where a `#` begins a comment
    #[arg(required = true, value_name = "POINT")]
    pub points: Vec<String>,
    /// The time in seconds, at least 0
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = seconds, allow_negative_numbers = true)]
    pub time: f64,
    /// Print an object of JSON a line, with all properties and all digits
    #[arg(long)]
    pub json: bool,
    /// Values of params.
    #[command(flatten)]
    pub set: SetArguments,
    /// Print how long each stage took
    #[arg(long)]
    pub timings: bool,
}

/// `sdfc explain SCENE`, `sdfc explain CODE…`
#[derive(Debug, Args)]
pub struct ExplainArguments {
    /// A scene, where `-` reads standard input; or codes, as messages show them: E020, W001
    ///
    /// Of a scene: each effect, what calls for it or why nothing does, how many evaluations of the scene's field it takes a
    /// pixel, and its share of the time of a picture; and each shape, with what makes it dear. Of a code: what it means, with an
    /// example and its correction.
    #[arg(required = true, value_name = "SCENE|CODE")]
    pub subjects: Vec<String>,
    /// The size of the picture that is counted and timed, in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "320x180", value_parser = size)]
    pub size: (u32, u32),
    /// The time in seconds, at least 0
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = seconds, allow_negative_numbers = true)]
    pub time: f64,
    /// What is timed: `auto`, `gpu`, `cpu`, or a part of a graphics device's name
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    pub device: Device,
    /// For about how long pictures are timed, in seconds
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = budget, conflicts_with = "no_time", allow_negative_numbers = true)]
    pub budget: f64,
    /// Take no times: what is printed is then the same on every machine
    #[arg(long)]
    pub no_time: bool,
    /// Print an object of JSON, with all shapes and all digits
    #[arg(long)]
    pub json: bool,
    /// The preset.
    #[command(flatten)]
    pub quality: QualityArguments,
    /// Values of params.
    #[command(flatten)]
    pub set: SetArguments,
    /// Print how long each stage took
    #[arg(long)]
    pub timings: bool,
}

/// `sdfc doc NAME…`
#[derive(Debug, Args)]
pub struct DocArguments {
    /// Names of functions and other words: sphere, smin, camera; none lists all
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
}

/// The arguments of this process. A point may begin with a minus sign, which would make an option of it: a space
/// before it says that it is none.
pub fn arguments() -> impl Iterator<Item = OsString> {
    std::env::args_os().map(|argument| match argument.to_str() {
        Some(text) if is_negative_point(text) => format!(" {text}").into(),
        _ => argument,
    })
}

fn is_negative_point(text: &str) -> bool {
    let mut rest = text.chars();
    rest.next() == Some('-')
        && rest.next().is_some_and(|c| c.is_ascii_digit() || c == '.')
        && rest.any(|c| c == ',' || c.is_whitespace())
}

/// Values of params, and where imported files may be.
#[derive(Debug, Args, Default, PartialEq)]
pub struct SetArguments {
    /// Freeze a param at a value; may be given several times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    pub values: Vec<(String, String)>,
    /// Allow imports of files in this folder, beside that of the scene; may be given several times
    #[arg(long, value_name = "FOLDER")]
    pub include: Vec<PathBuf>,
}

impl SetArguments {
    /// The options of the compiler that this means for a scene.
    pub fn options(&self, scene: &Path) -> Result<Options, Failure> {
        let loader = FileLoader::new(scene, &self.include).map_err(|(folder, error)| {
            Failure::call(format!("cannot import from {}: {}", folder.display(), reason(&error)))
        })?;
        Ok(Options { set: self.values.clone(), imports: loader.imports(), ..Options::default() })
    }
}

/// The preset that pictures are made by.
#[derive(Debug, Args, Default, PartialEq)]
pub struct QualityArguments {
    /// How accurate the picture is: stands for the `quality` of the scene, whose other settings win over it
    #[arg(long = "quality", value_name = "PRESET", value_parser = preset())]
    pub preset: Option<Quality>,
}

/// Reads a preset by its word.
fn preset() -> impl TypedValueParser<Value = Quality> {
    let words = PossibleValuesParser::new(Quality::ALL.map(Quality::word));
    let of = |word: String| Quality::ALL.into_iter().find(|quality| quality.word() == word);
    words.map(move |word| of(word).expect("only its words are taken"))
}

/// Whether messages are coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// On a terminal, unless NO_COLOR is set
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

/// How messages are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MessageFormat {
    /// With the lines of the source that they are about
    Human,
    /// One line each, for editors: `file:line:column: error[E020]: message (help: …)`
    Short,
    /// One JSON object a line, for programs
    Json,
}

/// What can be made a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Denied {
    /// Warnings
    Warnings,
}

/// A target by its name, which is also its extension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TargetName {
    /// GLSL for Shadertoy's Image tab
    Glsl,
    /// A whole fragment shader of `#version 300 es`
    Frag,
    /// A WGSL module
    Wgsl,
    /// A page for browsers that runs by itself
    Html,
    /// SPIR-V for Vulkan
    Spv,
    /// The Metal Shading Language
    Metal,
    /// HLSL for Direct3D
    Hlsl,
}

impl TargetName {
    /// The target that an extension names.
    pub fn of_extension(extension: &str) -> Option<TargetName> {
        TargetName::from_str(extension, true).ok()
    }

    /// The extensions that name targets.
    pub fn extensions() -> Vec<String> {
        let names = TargetName::value_variants().iter().filter_map(|name| name.to_possible_value());
        names.map(|name| name.get_name().to_string()).collect()
    }

    /// What is written.
    pub fn format(self) -> Format {
        match self {
            TargetName::Glsl => Format::Text(Target::Shadertoy),
            TargetName::Frag => Format::Text(Target::GlslEs),
            TargetName::Wgsl => Format::Text(Target::Wgsl),
            TargetName::Html => Format::Page,
            TargetName::Spv => Format::SpirV,
            TargetName::Metal => Format::Metal,
            TargetName::Hlsl => Format::Hlsl,
        }
    }
}

/// What of a compilation can be printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Stage {
    /// The tokens of the source
    Tokens,
    /// The tree of the source
    Ast,
    /// What is proved of each shape: slope, box, dependence, cost
    Facts,
    /// The program, in the operations of the language
    Ir,
    /// The program, in operations that mean the same on every target
    Total,
    /// What the scene costs
    Cost,
}

/// In which language a graphics device is given the shader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ShaderLanguage {
    /// WGSL
    Wgsl,
    /// GLSL
    Glsl,
    /// SPIR-V
    Spirv,
}

impl From<ShaderLanguage> for Language {
    fn from(language: ShaderLanguage) -> Language {
        match language {
            ShaderLanguage::Wgsl => Language::Wgsl,
            ShaderLanguage::Glsl => Language::Glsl,
            ShaderLanguage::Spirv => Language::SpirV,
        }
    }
}

/// What can be drawn instead of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ViewName {
    /// Grey by the distance from the eye
    Depth,
    /// The direction of the surface, as a colour
    Normal,
    /// How many steps each ray takes
    Steps,
    /// How far from the surface rays end
    Error,
    /// The colours of the surfaces, without light
    Material,
}

impl From<ViewName> for View {
    fn from(name: ViewName) -> View {
        match name {
            ViewName::Depth => View::Depth,
            ViewName::Normal => View::Normal,
            ViewName::Steps => View::Steps,
            ViewName::Error => View::Error,
            ViewName::Material => View::Material,
        }
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let wanted = || "expected two whole numbers such as 1280x720".to_string();
    let (width, height) = text.split_once('x').ok_or_else(wanted)?;
    let side = |text: &str| -> Result<u32, String> {
        let digits = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        match text.parse::<u32>() {
            Ok(n) if digits && (1..=SIDE_LIMIT).contains(&n) => Ok(n),
            _ if digits => Err(format!("a side has 1 to {SIDE_LIMIT} pixels")),
            _ => Err(wanted()),
        }
    };
    let (width, height) = (side(width)?, side(height)?);
    match u64::from(width) * u64::from(height) <= PIXEL_LIMIT {
        true => Ok((width, height)),
        false => Err(format!("a picture has at most {PIXEL_LIMIT} pixels")),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(t) if t >= 0.0 && (t as f32).is_finite() => Ok(t + 0.0),
        Ok(_) => Err("the time is a finite number of seconds, at least 0".into()),
        Err(_) => Err("expected a number of seconds such as 2.5".into()),
    }
}

fn budget(text: &str) -> Result<f64, String> {
    seconds(text)
        .and_then(|t| if t <= HOUR { Ok(t) } else { Err(format!("at most an hour, {HOUR} seconds")) })
}

fn device(text: &str) -> Result<Device, String> {
    match text {
        "auto" => Ok(Device::Auto),
        "gpu" => Ok(Device::Gpu),
        "cpu" => Ok(Device::Cpu),
        "" => Err("expected `auto`, `gpu`, `cpu` or a part of a device's name".into()),
        name => Ok(Device::Named(name.to_string())),
    }
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_string(), value.trim().to_string()))
        }
        _ => Err("expected a param and its value, such as spin=3".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sizes() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        assert_eq!(size("1x16384"), Ok((1, 16_384)));
        for wrong in [
            "",
            "x",
            "1280",
            "1280x",
            "0x1",
            "-1x5",
            "+1x5",
            "16385x1",
            "99999999999x1",
            "16384x16384",
            "1x1x1",
        ] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn times() {
        assert_eq!(seconds("2.5"), Ok(2.5));
        assert_eq!(seconds("-0").map(f64::to_bits), Ok(0));
        for wrong in ["", "-1", "nan", "inf", "1e39", "two"] {
            assert!(seconds(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn budgets() {
        assert_eq!((budget("0"), budget("3600")), (Ok(0.0), Ok(3600.0)));
        for wrong in ["-1", "3601", "1e30", "inf", "ten"] {
            assert!(budget(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn assignments() {
        assert_eq!(assignment("a=1"), Ok(("a".into(), "1".into())));
        assert_eq!(assignment("a = #fff"), Ok(("a".into(), "#fff".into())));
        assert!(assignment("a").is_err() && assignment("=1").is_err());
    }
}
