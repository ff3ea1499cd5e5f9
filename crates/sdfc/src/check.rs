//! `sdfc check scene.sdf…`

use crate::arguments::CheckArguments;
use crate::certify::{self, Judgement};
use crate::compile::shader;
use crate::failure::Failure;
use crate::input;
use crate::terminal::Terminal;
use sdf_syntax::tree::{Item, ItemKind};
use sdf_syntax::{Code, Diagnostic, Severity};
use sdfc::{Clock, Compiled, Options};
use std::path::Path;

/// At how many points each promise of a file is tried.
const ATTACK: usize = 100_000;

/// Says what is wrong with scenes, and how many mistakes there are in all.
pub fn run(arguments: &CheckArguments, terminal: &Terminal) -> Result<(), Failure> {
    let mut clock = Clock::default();
    let mut found = Found::default();
    let mut done = Ok(());
    for path in &arguments.scenes {
        // A wrong call outweighs a wrong scene.
        done = match (check(path, arguments, &mut clock, &mut found, terminal), done) {
            (Err(Failure::Scene), Ok(()) | Err(Failure::Denied)) => Err(Failure::Scene),
            (Err(Failure::Denied), Ok(())) => Err(Failure::Denied),
            (Ok(()) | Err(Failure::Scene | Failure::Denied), done) => done,
            (Err(failure), _) => {
                terminal.failure(&failure);
                Err(Failure::CallTold)
            }
        };
    }
    terminal.summary(&found.summary(arguments.scenes.len()));
    if arguments.timings {
        terminal.timings(&clock);
    }
    done
}

fn check(
    path: &Path,
    arguments: &CheckArguments,
    clock: &mut Clock,
    found: &mut Found,
    terminal: &Terminal,
) -> Result<(), Failure> {
    let source = match clock.time("read", || input::read(path, terminal)) {
        Ok(source) => source,
        Err(Failure::Scene) => {
            found.errors += 1;
            return Err(Failure::Scene);
        }
        Err(failure) => {
            found.unread += 1;
            return Err(failure);
        }
    };
    let (probe, certificate) = (arguments.certify, arguments.certify);
    let quality = arguments.quality.preset;
    let options =
        Options { attack: Some(ATTACK), probe, certificate, quality, ..arguments.set.options(path)? };
    let mut compiled = sdfc::compile(&source.name, &source.text, &options, clock);
    if is_for_import(&compiled) {
        // Nothing is missing in a file that others import; what else is wrong in it has been found.
        compiled.diagnostics.retain(|d| d.code != Code::E060);
        terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
        terminal.note(&format!("{} has no scene: it was checked as a file for import", source.name));
        found.count(&compiled.diagnostics);
        return if compiled.has_errors() { Err(Failure::Scene) } else { Ok(()) };
    }
    terminal.diagnostics(&compiled.sources, &compiled.diagnostics);
    found.count(&compiled.diagnostics);
    shader(&compiled, terminal)?;
    match &compiled.output {
        Some((scene, _)) if arguments.certify => {
            let judged = clock
                .time("certify", || certify::run(&source.name, &compiled, scene, arguments.size, terminal))?;
            terminal.diagnostics(&compiled.sources, &judged.warnings);
            found.count(&judged.warnings);
            found.errors += usize::from(!judged.is_right);
            match judged {
                Judgement { is_right: false, .. } => Err(Failure::Scene),
                Judgement { warnings, .. } if terminal.denies_warnings() && !warnings.is_empty() => {
                    Err(Failure::Denied)
                }
                _ => Ok(()),
            }
        }
        _ => Ok(()),
    }
}

/// Whether a file without a scene has what an import brings, and nothing that only a scene's file needs.
fn is_for_import(compiled: &Compiled) -> bool {
    let brings = |item: &Item| {
        matches!(
            item.kind,
            ItemKind::Import { .. }
                | ItemKind::Fn(_)
                | ItemKind::Let(_)
                | ItemKind::Param { .. }
                | ItemKind::Material(..)
        )
    };
    let items = &compiled.tree.items;
    let has_no_scene = compiled.diagnostics.iter().any(|d| d.code == Code::E060);
    has_no_scene && !items.is_empty() && items.iter().all(brings)
}

/// How much was found.
#[derive(Default)]
struct Found {
    errors: usize,
    warnings: usize,
    unread: usize,
}

impl Found {
    fn count(&mut self, diagnostics: &[Diagnostic]) {
        let errors = diagnostics.iter().filter(|d| d.severity() == Severity::Error).count();
        self.errors += errors;
        self.warnings += diagnostics.len() - errors;
    }

    fn summary(&self, scenes: usize) -> String {
        let count = |n: usize, one: &str| match n {
            0 => None,
            1 => Some(format!("1 {one}")),
            n => Some(format!("{n} {one}s")),
        };
        let mut parts: Vec<String> =
            count(self.errors, "error").into_iter().chain(count(self.warnings, "warning")).collect();
        parts.extend(count(self.unread, "file").map(|files| format!("{files} not read")));
        let found = if parts.is_empty() { "nothing is wrong".to_string() } else { parts.join(", ") };
        format!("{} checked: {found}", count(scenes, "scene").unwrap_or_default())
    }
}
