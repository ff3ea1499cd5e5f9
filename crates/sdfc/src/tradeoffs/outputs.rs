//! Which files what was measured is written to.

use super::data::Report;
use super::{plot, web};
use crate::arguments::CostArguments;
use crate::failure::Failure;
use crate::input::is_dash;
use crate::output::Output;
use sdfc::Options;
use sdfc::tradeoff::Tradeoffs;
use std::path::Path;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    Json,
    Csv,
    Svg,
    Html,
}

/// All files that are wanted, with what goes into each.
pub struct Outputs(Vec<(Form, Output)>);

impl Outputs {
    /// Looks at all that is wanted before any work is done.
    pub fn prepare(arguments: &CostArguments) -> Result<Outputs, Failure> {
        let CostArguments { json, csv, plot, scene, .. } = arguments;
        if plot.is_some() && arguments.no_time {
            return Err(Failure::call("a plot without times cannot be drawn")
                .help("leave `--no-time` out, or write the figures alone with `--json` or `--csv`"));
        }
        if [json, csv].into_iter().all(|path| path.as_ref().is_some_and(|path| is_dash(path))) {
            return Err(Failure::call("JSON and CSV cannot both go to standard output")
                .help("name a file for one of them, such as `--csv cost.csv`"));
        }
        let mut wanted: Vec<(Form, &Path)> = Vec::new();
        wanted.extend(json.as_deref().map(|path| (Form::Json, path)));
        wanted.extend(csv.as_deref().map(|path| (Form::Csv, path)));
        if let Some(path) = plot {
            wanted.push((of_plot(path)?, path));
        }
        for (i, (_, path)) in wanted.iter().enumerate() {
            if !is_dash(path) && wanted[..i].iter().any(|(_, other)| other == path) {
                return Err(Failure::call(format!("{} is named twice", path.display()))
                    .help("each of `--json`, `--csv` and `--plot` writes a file of its own"));
            }
        }
        let prepared = wanted.into_iter().map(|(form, path)| Ok((form, Output::prepare(path, scene)?)));
        prepared.collect::<Result<_, _>>().map(Outputs)
    }

    /// Whether standard output carries one of them, so that nothing else can be printed.
    pub fn has_standard_output(&self) -> bool {
        self.0.iter().any(|(_, output)| matches!(output, Output::Standard))
    }

    /// Writes all of them.
    pub fn write(
        &self,
        scene: &str,
        arguments: &CostArguments,
        options: &Options,
        measured: &Tradeoffs,
    ) -> Result<(), Failure> {
        let report = Report::of(scene, arguments.time, options, &arguments.bounds.bounds(), measured);
        for (form, output) in &self.0 {
            let text = match form {
                Form::Json => report.json(),
                Form::Csv => report.csv(),
                Form::Svg => plot::plot(scene, measured).svg,
                Form::Html => web::page(scene, measured),
            };
            output.write(text.as_bytes())?;
        }
        Ok(())
    }
}

/// What a plot's extension says.
fn of_plot(path: &Path) -> Result<Form, Failure> {
    let has = |wanted: &str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted));
    match path {
        _ if has("svg") => Ok(Form::Svg),
        _ if has("html") => Ok(Form::Html),
        _ => Err(Failure::call(format!("{} is not the name of a .svg or .html file", path.display())).help(
            "plots are written as SVG, `--plot cost.svg`, or as a page with the pictures, `--plot cost.html`",
        )),
    }
}
