//! Messages, texts and pictures as lines of JSON on stderr, for a program that runs this command as a child.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use taotie_engine::Result;
use taotie_report::sheet::Sheet;
use taotie_report::{Picture, View};

/// A line on stderr.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Line {
    /// A message, a warning or an error.
    Message(String),
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

/// Set if another program reads stderr. Global, because stderr is.
static WANTED: AtomicBool = AtomicBool::new(false);

/// Writes lines from now on.
pub fn want() {
    WANTED.store(true, Ordering::Relaxed);
}

/// Returns true if lines are written.
pub fn are_wanted() -> bool {
    WANTED.load(Ordering::Relaxed)
}

/// Writes a line. A closed stderr is not an error.
pub fn send(line: &Line) {
    let text = serde_json::to_string(line).unwrap_or_default();
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Sends the pictures of a report page, if lines are wanted.
pub fn show(views: &[View]) {
    if !are_wanted() {
        return;
    }
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

/// Sends a PNG file, if lines are wanted; if it is too large, a smaller JPEG.
pub fn show_file(path: &Path) -> Result<()> {
    if !are_wanted() {
        return Ok(());
    }
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
