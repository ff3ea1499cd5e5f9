//! A fixture on all its executions, judged, and its twin.

use super::execution::Execution;
use super::fixture::{Effort, Fixture, Naive, Subject};
use super::score::{Certified, Score};
use super::twin::Twin;
use crate::adapter;
use crate::run::Kernel;
use crate::scenes::legalised;
use sdf_ir::Program;
use sdf_lang::Scene;
use sdf_render::Frame;

/// On drivers, where each frame compiles a shader of its own, a scene is drawn at no more frames than this, the last among
/// them.
const DRIVER_FRAMES: usize = 12;

/// The least share of a case's pixels at which its twin has the fault and the case has not: fewer may be an accident.
const LEAST_SHARE: f64 = 0.005;

/// What becomes of a shader before a driver takes it.
type Change = fn(Kernel) -> Kernel;

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
        // Where one device is chosen, a twin that is another client's is left out as that client is.
        let twin = fixture.twin.as_ref().and_then(|naive| {
            let execution = executions.iter().position(|it| it.name().starts_with(&naive.client));
            let client = &naive.client;
            assert!(execution.is_some() || adapter::is_chosen(), "{}: `{client}` is no client", fixture.name);
            execution.map(|execution| (Twin::named(&naive.twin), execution))
        });
        let mut outcome = Outcome {
            scores: executions.iter().map(|execution| (execution.name(), Score::default())).collect(),
            twin: twin.as_ref().map(|_| Score::default()),
            complaints: String::new(),
        };
        for subject in fixture.subjects() {
            outcome.add(fixture, &subject, effort, executions, twin.as_ref());
        }
        if let (Some(naive), Some(score), Some((_, execution))) = (&fixture.twin, &outcome.twin, twin)
            && let Some(complaint) = complaint_about(naive, score, &outcome.scores[execution].1)
        {
            outcome.complaints += &format!("{}: {complaint}\n", fixture.name);
        }
        outcome
    }

    fn add(
        &mut self,
        fixture: &Fixture,
        subject: &Subject,
        effort: Effort,
        executions: &[Execution],
        twin: Option<&(Twin, usize)>,
    ) {
        let scene = subject.scene(&[]);
        let program = legalised(&scene.program, scene.probe.expect("a scene with a probe"));
        let truth = subject.truth();
        let certified = |frames: &[Frame]| frames.iter().map(|frame| Certified::of(&truth, frame)).collect();
        let effort = if subject.no_larger { Effort::Short } else { effort };
        let mut frames = fixture.frames(effort);
        let mut truths: Vec<Certified> = certified(&frames);
        for (execution, (name, sum)) in executions.iter().zip(&mut self.scores) {
            let score = judged(fixture, execution, &program, &frames, &mut truths, |kernel| kernel);
            let score = score.unwrap_or_else(|said| {
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
        if let (Some((twin, execution)), Some(sum)) = (twin, &mut self.twin) {
            // A twin shows what the case is about in pictures as large as the file says.
            if effort == Effort::Long {
                frames = fixture.frames(Effort::Short);
                truths = certified(&frames);
            }
            let (subject, frames) =
                if twin.frozen { (subject.clone(), frames.clone()) } else { subject.thawed(&frames) };
            let program = twin_program(&subject.scene(&twin.replaced), twin);
            match judged(fixture, &executions[*execution], &program, &frames, &mut truths, twin.shader) {
                Ok(score) => *sum = std::mem::take(sum).joined(score),
                Err(said) => self.complaints += &format!("{}, its twin: {said}\n", subject.name),
            }
        }
    }
}

/// What an execution of a program shows of frames of which this is the truth.
fn judged(
    fixture: &Fixture,
    execution: &Execution,
    program: &Program,
    frames: &[Frame],
    truths: &mut [Certified],
    change: Change,
) -> Result<Score, String> {
    let every = match execution {
        Execution::Interpreter => 1,
        _ => frames.len().div_ceil(DRIVER_FRAMES),
    };
    let some = frames.iter().zip(truths).rev().step_by(every);
    let score = |(frame, truth): (&Frame, &mut Certified)| {
        execution.buffers(program, frame, change).map(|seen| truth.score(fixture, &seen))
    };
    some.map(score).try_fold(Score::default(), |sum, score| Ok(sum.joined(score?)))
}

/// What is wrong with a twin, if anything: it must fail in the same scenes, in pictures as large as the file says, at more
/// pixels than the case does in all.
fn complaint_about(naive: &Naive, twin: &Score, product: &Score) -> Option<String> {
    let Naive { twin: name, fault, .. } = naive;
    let (naive, right) = (twin.count_of(fault), product.count_of(fault));
    let is_clear = naive > right && (naive - right) as f64 >= twin.pixels as f64 * LEAST_SHARE;
    let named = twin.named.join("\n  ");
    (!is_clear).then(|| {
        format!("the twin `{name}` has {naive} {fault} of {}, the case {right}\n  {named}", twin.pixels)
    })
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
