//! How a process ended, as a sentence.

use super::running::Running;
use super::todo::Todo;
use crate::job::Outcome;
use crate::record::State;
use std::process::ExitStatus;
use taotie::asset::Bytes;

/// Waits for the end of a process that has closed its stdout; returns the outcome of its job.
pub fn outcome(ended: &mut Running) -> Outcome {
    let waited = ended.process.wait();
    let peak = ended.peak;
    let outcome = match (waited, ended.outcome.take()) {
        (Ok((status, _)), Some(outcome)) if status.success() => outcome,
        (Ok((status, said)), _) => failed(sentence(ended, status, &said)),
        (Err(error), _) => failed(format!("lost its process: {error}")),
    };
    Outcome { peak_bytes: outcome.peak_bytes.max(peak), ..outcome }
}

/// Returns the outcome of a job whose process could not be started.
pub fn without_process(error: &std::io::Error, todo: &Todo) -> Outcome {
    failed(format!("{}: could not start its process: {error}", todo.scan.id))
}

/// Returns the outcome of a job that did not finish.
pub fn failed(error: String) -> Outcome {
    Outcome {
        state: State::Failed,
        error: Some(error),
        input: Vec::new(),
        stages: Vec::new(),
        figures: None,
        required: Vec::new(),
        warnings: Vec::new(),
        parts: Vec::new(),
        peak_bytes: None,
    }
}

/// Describes how a process ended before its job was done.
fn sentence(ended: &Running, status: ExitStatus, said: &str) -> String {
    let stage = &ended.stage;
    if let Some(limit) = ended.exceeded {
        let seconds = limit.as_secs_f64();
        return format!(
            "took longer than {seconds:.0} s, stopped in stage `{stage}`; raise --time-limit, or ask for less"
        );
    }
    if said.contains("memory allocation of") {
        let estimate = ended.forecast.map_or("not known yet".into(), |bytes| Bytes(bytes).to_string());
        return format!(
            "ran out of memory in stage `{stage}` (estimate: {estimate}); allow more memory, or ask for less"
        );
    }
    let how = match signal(status) {
        Some(9) => "was killed (signal 9), often a sign of low memory".to_owned(),
        Some(number) => format!("was killed by signal {number}"),
        None => match status.code() {
            Some(code) => format!("crashed with code {code}"),
            None => "crashed".to_owned(),
        },
    };
    let words = last_words(said);
    format!("its process {how} in stage `{stage}`{words}")
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<i32> {
    None
}

/// Returns the last line of a process's stderr, without control characters.
fn last_words(said: &str) -> String {
    const MOST: usize = 300;
    let line = said.lines().rev().find(|line| !line.trim().is_empty() && !line.starts_with("note: "));
    let plain = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    line.map_or(String::new(), |line| {
        format!(": {}", line.trim().chars().take(MOST).map(plain).collect::<String>())
    })
}
