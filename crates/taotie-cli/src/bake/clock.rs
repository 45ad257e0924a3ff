//! The stages of a bake: the time of each, and its progress.

use super::schedule::Schedule;
use crate::console::Bar;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use taotie::asset::StageTime;

/// Shows the progress of stages and the time left of all of them, and measures their times.
#[derive(Default)]
pub struct Clock {
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    done: Vec<StageTime>,
    running: Option<Running>,
    expected: Option<Expected>,
}

/// The stages to come.
struct Expected {
    schedule: Schedule,
    start: Instant,
}

/// The running stage.
struct Running {
    stage: &'static str,
    start: Instant,
    bar: Bar,
}

impl Clock {
    /// Sets the schedule of the stages to come.
    pub fn expect(&self, schedule: Schedule) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.expected = Some(Expected { schedule, start: Instant::now() });
    }

    /// Updates the fraction of a stage that is done.
    pub fn hear(&self, stage: &'static str, fraction: f64) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if !stage.is_empty() && state.running.as_ref().is_none_or(|running| running.stage != stage) {
            state.end();
            state.running = Some(Running { stage, start: Instant::now(), bar: Bar::new(stage) });
        }
        if let Some(running) = &state.running {
            running.bar.show(fraction, state.left(running.stage, fraction));
        }
    }

    /// Ends the running stage; returns all completed stages, in order.
    pub fn done(&self) -> Vec<StageTime> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.end();
        state.done.clone()
    }
}

impl State {
    /// Returns the time left of all stages.
    fn left(&self, stage: &str, fraction: f64) -> Option<Duration> {
        let Expected { schedule, start } = self.expected.as_ref()?;
        schedule.left(start.elapsed(), stage, fraction)
    }

    fn end(&mut self) {
        self.done.extend(self.running.take().map(|running| StageTime {
            stage: running.stage,
            milliseconds: running.start.elapsed().as_secs_f64() * 1e3,
        }));
    }
}
