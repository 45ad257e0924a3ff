//! The stages of a job, with their times.

use crate::job::Message;
use crate::record::Stage;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Receives stages, reports them to the driver, and times them.
pub struct Clock<'a> {
    send: &'a (dyn Fn(Message) + Sync),
    heard: Mutex<Heard>,
}

#[derive(Default)]
struct Heard {
    done: Vec<Stage>,
    running: Option<(&'static str, Instant)>,
}

impl<'a> Clock<'a> {
    /// Creates a clock without any stages.
    pub fn new(send: &'a (dyn Fn(Message) + Sync)) -> Self {
        Self { send, heard: Mutex::default() }
    }

    /// Starts a stage; always returns true, so that the work goes on.
    pub fn hear(&self, stage: &'static str) -> bool {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        if !stage.is_empty() && heard.running.is_none_or(|(running, _)| running != stage) {
            heard.end();
            heard.running = Some((stage, Instant::now()));
            (self.send)(Message::Stage { stage: stage.into() });
        }
        true
    }

    /// Ends the current stage; returns all of them.
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
