//! The stages of a bake: progress, time, and Ctrl-C between them.

use super::stop;
use crate::console::Bar;
use anyhow::Result;
use serde::Serialize;
use std::time::Instant;
use taotie::Progress;

/// A stage that is done.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// Its name.
    pub stage: &'static str,
    /// How long it took.
    pub milliseconds: f64,
}

/// The stages done so far.
#[derive(Default)]
pub struct Stages {
    done: Vec<Stage>,
}

impl Stages {
    /// Does a stage, and shows how far it is.
    ///
    /// # Errors
    /// Those of the work, and [`taotie::Error::Cancelled`] where the user asked to stop meanwhile.
    pub fn run<T>(&mut self, stage: &'static str, work: impl FnOnce(Progress<'_>) -> Result<T>) -> Result<T> {
        let start = Instant::now();
        let bar = Bar::new(stage);
        let told = |_: &str, fraction: f64| {
            bar.set(fraction);
            stop::go_on()
        };
        let result = work(Progress::new(&told));
        stop::check()?;
        self.done.push(Stage { stage, milliseconds: start.elapsed().as_secs_f64() * 1e3 });
        result
    }

    /// The stages done, in order.
    pub fn done(&self) -> &[Stage] {
        &self.done
    }
}
