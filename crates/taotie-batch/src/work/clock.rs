//! The stages of a job: the time of each.

use crate::job::Message;
use crate::record::Stage;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Hears of stages, tells the driver, and measures them.
pub struct Clock<'a> {
    tell: &'a (dyn Fn(Message) + Sync),
    heard: Mutex<Heard>,
}

#[derive(Default)]
struct Heard {
    done: Vec<Stage>,
    running: Option<(&'static str, Instant)>,
}

impl<'a> Clock<'a> {
    /// Makes a clock that has heard of nothing.
    pub fn new(tell: &'a (dyn Fn(Message) + Sync)) -> Self {
        Self { tell, heard: Mutex::default() }
    }

    /// Hears of a stage; lets the work go on.
    pub fn hear(&self, stage: &'static str) -> bool {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        if !stage.is_empty() && heard.running.is_none_or(|(running, _)| running != stage) {
            heard.end();
            heard.running = Some((stage, Instant::now()));
            (self.tell)(Message::Stage { stage: stage.into() });
        }
        true
    }

    /// Ends the stage that runs; returns all of them.
    pub fn done(&self) -> Vec<Stage> {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        heard.end();
        std::mem::take(&mut heard.done)
    }
}

impl Heard {
    fn end(&mut self) {
        if let Some((stage, start)) = self.running.take() {
            let milliseconds = start.elapsed().as_secs_f64() * 1e3;
            self.done.push(Stage { stage: stage.into(), milliseconds });
        }
    }
}
