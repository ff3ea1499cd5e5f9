//! A scene that is measured once or twice, with a bar that shows how far that is.

use crate::compile::our_mistake;
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;
use crate::terminal::Terminal;
use sdfc::tradeoff::{MeasureError, NEAR, Session, Setting, Stopwatch, Subject, Tradeoffs};
use sdfc::{Clock, Compiled, Device, DrawError, Frame, Options};
use std::time::Duration;

/// What is measured.
pub struct Wanted<'a> {
    pub source: &'a input::Scene,
    pub options: &'a Options,
    /// The scene with its own settings.
    pub compiled: &'a Compiled,
    /// The picture that is timed.
    pub frame: &'a Frame,
    /// The picture that is compared with the truth.
    pub compared: Frame,
    pub device: &'a Device,
    /// For how many seconds pictures are timed in all; nothing where they are not.
    pub budget: Option<f64>,
    /// How near to a surface a hit must be, in pixels, if something is asked for.
    pub near: Option<f64>,
    /// How often the scene is measured.
    pub times: u32,
}

/// A scene that is being measured.
pub struct Measuring<'a> {
    session: Session<'a>,
    stopwatch: Option<Stopwatch<'a>>,
    progress: Progress,
    compiled: &'a Compiled,
    times: u32,
    done: u32,
}

impl<'a> Measuring<'a> {
    /// Nothing is measured yet.
    pub fn new(wanted: Wanted<'a>) -> Measuring<'a> {
        let Wanted { source, options, compiled, frame, compared, device, budget, near, times } = wanted;
        let subject = Subject { name: &source.name, text: &source.text, options };
        let budget = budget.map(|seconds| Duration::from_secs_f64(seconds / f64::from(times)));
        Measuring {
            session: Session::new(subject, compared, near.unwrap_or(NEAR)),
            stopwatch: budget.map(|budget| Stopwatch { device, frame, budget, enough: None }),
            progress: Progress::new("measuring"),
            compiled,
            times,
            done: 0,
        }
    }

    /// Measures these settings. Ratios of times are to the first.
    pub fn measure(
        &mut self,
        settings: &[Setting],
        terminal: &Terminal,
        clock: &mut Clock,
    ) -> Result<Tradeoffs, Failure> {
        let (done, times) = (f64::from(self.done), f64::from(self.times));
        let show = |part: f64| self.progress.show((done + part) / times);
        let measured = self.session.measure(settings, self.stopwatch.as_ref(), &show, clock);
        self.done += 1;
        measured.map_err(|error| match error {
            MeasureError::Draw(DrawError::Device(message)) => Failure::Device(message),
            MeasureError::Draw(DrawError::Shader(bug)) => our_mistake(bug, self.compiled, terminal),
            MeasureError::Scene(diagnostics) => {
                terminal.diagnostics(&self.compiled.sources, &diagnostics);
                Failure::Scene
            }
        })
    }

    /// Takes the bar away.
    pub fn end(self) {
        self.progress.end();
    }
}
