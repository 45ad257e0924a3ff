//! The stages of a bake: progress, time, and Ctrl-C between them.

use super::stop;
use crate::console::Progress;
use anyhow::Result;
use serde::Serialize;
use std::time::Instant;

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
    /// Does a stage, whose work is handed a function to call with the fraction done; it says whether to go on.
    ///
    /// # Errors
    /// Those of the work, and [`stop::Interrupted`] where the user asked to stop meanwhile.
    pub fn run<T>(
        &mut self,
        stage: &'static str,
        work: impl FnOnce(&(dyn Fn(f64) -> bool + Sync)) -> Result<T>,
    ) -> Result<T> {
        let start = Instant::now();
        let progress = Progress::new(stage);
        let told = |fraction: f64| {
            progress.set(fraction);
            stop::go_on()
        };
        let result = work(&told);
        stop::check()?;
        self.done.push(Stage { stage, milliseconds: start.elapsed().as_secs_f64() * 1e3 });
        result
    }

    /// The stages done, in order.
    pub fn done(&self) -> &[Stage] {
        &self.done
    }
}
