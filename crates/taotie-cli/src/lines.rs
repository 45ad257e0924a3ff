//! Messages, progress and pictures as lines of JSON on stderr, for a program that runs this command as a child.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use taotie_engine::Result;
use taotie_report::sheet::Sheet;
use taotie_report::{Picture, View};

/// A line on stderr.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Line {
    /// A message, a warning or an error.
    Message(String),
    /// The running stage, and the fraction of it that is done.
    Progress {
        /// Its name.
        stage: String,
        /// From 0 to 1.
        fraction: f64,
    },
    /// The report as text; JSON is on stdout.
    Text(String),
    /// A picture of the result.
    Picture {
        /// Its subject.
        caption: String,
        /// Its media type.
        mime: String,
        /// The file in Base64.
        data: String,
    },
}

/// Largest file of a picture: 1 MB in Base64.
const MOST_BYTES: usize = 750_000;

/// Sides of pictures that replace a larger file, pixels: the first that is small enough is sent.
const SIDES: [usize; 2] = [1024, 512];

/// Minimum time between two reports of progress in a stage.
const PAUSE: Duration = Duration::from_millis(100);

/// Set if another program reads stderr. Global, because stderr is.
static WANTED: AtomicBool = AtomicBool::new(false);

/// The stage of the last reported progress, and its time.
static LAST: Mutex<Option<(String, Instant)>> = Mutex::new(None);

/// Writes lines from now on.
pub fn want() {
    WANTED.store(true, Ordering::Relaxed);
}

/// Returns true if lines are written.
pub fn are_wanted() -> bool {
    WANTED.load(Ordering::Relaxed)
}

/// Writes a line, if lines are wanted. A closed stderr is not an error.
pub fn send(line: &Line) {
    if are_wanted() {
        let text = serde_json::to_string(line).unwrap_or_default();
        let _ = writeln!(io::stderr().lock(), "{text}");
    }
}

/// Reports progress, at most ten times per second.
pub fn progress(stage: &str, fraction: f64) {
    if are_wanted() && is_due(stage) {
        send(&Line::Progress { stage: stage.to_owned(), fraction });
    }
}

fn is_due(stage: &str) -> bool {
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    let is_due = last.as_ref().is_none_or(|(known, time)| known != stage || time.elapsed() >= PAUSE);
    if is_due {
        *last = Some((stage.to_owned(), Instant::now()));
    }
    is_due
}

/// Sends the pictures of a report page.
pub fn show(views: &[View]) {
    for view in views {
        for (index, picture) in view.pictures.iter().enumerate() {
            let label = &picture.label;
            let caption = match index {
                0 => format!("{}. {}\n{label}:", view.name, view.note),
                _ => format!("{label}:"),
            };
            send_file(caption, &picture.file);
        }
    }
}

/// Sends a PNG file; if it is too large, a smaller JPEG.
pub fn show_file(path: &Path) -> Result<()> {
    let file = taotie_io::read_bytes(path)?;
    let caption = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    if file.len() <= MOST_BYTES {
        send_file(caption, &file);
        return Ok(());
    }
    let sheet = Sheet::preview(&taotie_io::read_bitmap(path)?, usize::MAX);
    for side in SIDES {
        let small = sheet.shrunk(side);
        let file = Picture::to_look_at("", "", &small)?.file;
        if file.len() <= MOST_BYTES {
            send_file(format!("{caption}, reduced to {}×{} pixels:", small.width, small.height), &file);
            return Ok(());
        }
    }
    Ok(())
}

fn send_file(caption: String, file: &[u8]) {
    let mime = if file.starts_with(b"\x89PNG") { "image/png" } else { "image/jpeg" };
    send(&Line::Picture { caption, mime: mime.into(), data: STANDARD.encode(file) });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_of_a_new_stage_is_reported_immediately() {
        assert!(is_due("a") && !is_due("a") && is_due("b") && is_due("a"));
    }
}
