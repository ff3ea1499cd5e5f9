//! A fixture on all its executions, judged, and its twin.

use super::execution::Execution;
use super::fixture::{Effort, Fixture, Subject};
use super::score::{Certified, Score};
use super::twin::Twin;
use crate::scenes::legalised;
use sdf_ir::Program;
use sdf_lang::Scene;
use sdf_render::Frame;

/// On drivers, where each frame compiles a shader of its own, a scene is drawn at no more frames than this, the last among
/// them.
const DRIVER_FRAMES: usize = 12;

/// What came of a fixture.
pub struct Outcome {
    /// What each execution shows, by its name.
    pub scores: Vec<(String, Score)>,
    /// What the twin shows.
    pub twin: Option<Score>,
    /// What is wrong, if anything, scene by scene.
    pub complaints: String,
}

impl Outcome {
    /// Runs a fixture on these executions.
    pub fn of(fixture: &Fixture, effort: Effort, executions: &[Execution]) -> Outcome {
        let twin = fixture.twin.as_ref().map(|(name, _)| Twin::named(name));
        let mut outcome = Outcome {
            scores: executions.iter().map(|execution| (execution.name(), Score::default())).collect(),
            twin: twin.as_ref().map(|_| Score::default()),
            complaints: String::new(),
        };
        for subject in fixture.subjects() {
            outcome.add(fixture, &subject, effort, executions, twin.as_ref());
        }
        if let (Some(score), Some((name, fault))) = (&outcome.twin, &fixture.twin)
            && score.count_of(fault) == 0
        {
            outcome.complaints +=
                &format!("{}: the twin `{name}` shows no {fault}: {score:?}\n", fixture.name);
        }
        outcome
    }

    fn add(
        &mut self,
        fixture: &Fixture,
        subject: &Subject,
        effort: Effort,
        executions: &[Execution],
        twin: Option<&Twin>,
    ) {
        let scene = subject.scene(&[]);
        let program = legalised(&scene.program, scene.probe.expect("a scene with a probe"));
        let frames = fixture.frames(effort);
        let truth = subject.truth();
        let truths: Vec<Certified> = frames.iter().map(|frame| Certified::of(&truth, frame)).collect();
        let judged = |execution: &Execution, program: &Program, frames: &[Frame], every: usize| {
            let some = frames.iter().zip(&truths).rev().step_by(every);
            let score = |(frame, truth): (&Frame, &Certified)| {
                execution.buffers(program, frame).map(|seen| truth.score(fixture, &seen))
            };
            some.map(score).try_fold(Score::default(), |sum, score| Ok::<_, String>(sum.joined(score?)))
        };
        let on_drivers = frames.len().div_ceil(DRIVER_FRAMES);
        for (execution, (name, sum)) in executions.iter().zip(&mut self.scores) {
            let every = if matches!(execution, Execution::Interpreter) { 1 } else { on_drivers };
            let score = judged(execution, &program, &frames, every).unwrap_or_else(|said| {
                self.complaints += &format!("{}, {name}: it does not run: {said}\n", subject.name);
                Score::default()
            });
            if let Some(complaint) = score.complaint(fixture) {
                // Executions mostly fail at the same pixels: they are named once.
                let shown = if matches!(execution, Execution::Interpreter) {
                    complaint.as_str()
                } else {
                    first_line(&complaint)
                };
                self.complaints += &format!("{}, {name}: {shown}\n", subject.name);
            }
            *sum = std::mem::take(sum).joined(score);
        }
        if let (Some(twin), Some(sum)) = (twin, &mut self.twin) {
            let (subject, frames) =
                if twin.frozen { (subject.clone(), frames.clone()) } else { subject.thawed(&frames) };
            let program = twin_program(&subject.scene(&twin.replaced), twin);
            let score = judged(&Execution::Interpreter, &program, &frames, 1);
            *sum = std::mem::take(sum).joined(score.expect("the interpreter runs every program"));
        }
    }
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

/// The probe of a twin.
fn twin_program(scene: &Scene, twin: &Twin) -> Program {
    let probe = scene.probe.expect("a scene with a probe");
    match twin.guarded {
        true => legalised(&scene.program, probe),
        false => Program { entry: Some(probe), ..scene.program.clone() },
    }
}
