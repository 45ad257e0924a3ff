//! The output of the command: results on stdout, messages and progress on stderr.

use anyhow::Result;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use taotie::Warnings;

/// Writes a result line to stdout. Control characters in it but for line ends, which come from files and their names,
/// are replaced.
pub fn result(line: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "{}", plain_lines(line))?;
    Ok(stdout.flush()?)
}

/// Writes a text of the program's own to stdout, as it is.
pub fn own_text(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "{text}")?;
    Ok(stdout.flush()?)
}

/// Returns text of a file without characters that could rule the terminal: controls, and marks that turn the direction
/// of writing. Each becomes the replacement character.
pub fn plain(text: &str) -> String {
    text.chars().map(|c| if rules_terminal(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// As [`plain`], but for line ends, which the caller made.
fn plain_lines(text: &str) -> String {
    let kept = |c: char| c == '\n' || !rules_terminal(c);
    text.chars().map(|c| if kept(c) { c } else { char::REPLACEMENT_CHARACTER }).collect()
}

fn rules_terminal(c: char) -> bool {
    c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Set where the user wants neither progress nor messages. All that talks has but one stderr, so it is global as that.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Leaves out progress, messages and warnings from now on, or no more.
pub fn set_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Writes a message to stderr, unless the user wants none. A closed stderr is no error.
pub fn say(line: &str) {
    if !is_quiet() {
        complain(line);
    }
}

/// Writes an error to stderr, without control characters but for line ends. A closed stderr is no error.
pub fn complain(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", plain_lines(line));
}

/// Says each kind of warning with its count.
pub fn say_warnings(warnings: &Warnings) {
    for (what, count) in warnings.iter() {
        let times = if count == 1 { String::new() } else { format!(" ({count} times)") };
        say(&format!("taotie: warning: {}{times}", plain(what)));
    }
}

/// Warnings as JSON.
pub fn json_warnings(warnings: &Warnings) -> serde_json::Value {
    warnings.iter().map(|(what, count)| serde_json::json!({ "what": what, "count": count })).collect()
}

/// The name of a file without its folders, which are private.
pub fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The causes of an error from the outside in.
pub fn causes(error: &anyhow::Error) -> String {
    format!("{error:#}")
}

/// Returns whether the error comes from a closed pipe.
pub fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().filter_map(io_error).any(|cause| cause.kind() == io::ErrorKind::BrokenPipe)
}

fn io_error<'e>(error: &'e (dyn std::error::Error + 'static)) -> Option<&'e io::Error> {
    match error.downcast_ref() {
        Some(taotie::Error::Io { cause, .. }) => Some(cause),
        _ => error.downcast_ref(),
    }
}

/// A bar that appears on a terminal once the work has taken a second.
pub struct Bar {
    title: String,
    start: Instant,
    bar: OnceLock<ProgressBar>,
}

/// The bar's length: progress comes in thousandths.
const STEPS: u64 = 1000;

impl Bar {
    /// A bar that is not yet shown.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), start: Instant::now(), bar: OnceLock::new() }
    }

    /// Shows the fraction done.
    pub fn set(&self, fraction: f64) {
        self.tell(fraction, None);
    }

    /// Shows the fraction done, and the time left of a whole that this is a stage of, where it is known.
    pub fn tell(&self, fraction: f64, whole: Option<Duration>) {
        if is_quiet() || self.start.elapsed() < Duration::from_secs(1) {
            return;
        }
        let bar = self.bar.get_or_init(|| self.new_bar());
        if let Some(left) = whole {
            bar.set_prefix(of_whole(left));
        }
        bar.set_position((fraction * STEPS as f64) as u64);
    }

    /// Shows the fraction of the whole that is done, and the time left as it was estimated by others.
    pub fn tell_all(&self, fraction: f64, left: Option<Duration>) {
        if is_quiet() || self.start.elapsed() < Duration::from_secs(1) {
            return;
        }
        let bar = self.bar.get_or_init(|| {
            let bar = self.new_bar();
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %{prefix}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        bar.set_prefix(left.map_or(String::new(), |left| format!(", {} left", HumanDuration(left))));
        bar.set_position((fraction * STEPS as f64) as u64);
    }

    /// Shows the fraction done and lets the work go on: the listener of a [`taotie::Progress`].
    pub fn hear(&self, fraction: f64) -> bool {
        self.set(fraction);
        true
    }

    fn new_bar(&self) -> ProgressBar {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %, {eta} left{prefix}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(plain(&self.title));
        bar
    }
}

/// The time left of the whole in words, behind that of a stage.
fn of_whole(left: Duration) -> String {
    format!(", {} in all", HumanDuration(left))
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::anyhow;

    #[test]
    fn no_cause_is_told_twice() {
        let refused = io::Error::new(io::ErrorKind::NotFound, "not there");
        let error = anyhow::Error::from(taotie::Error::io("a.obj", refused)).context("reading");
        assert_eq!(causes(&error), "reading: a.obj: not there");
        assert_eq!(causes(&anyhow!("alone")), "alone");
    }

    #[test]
    fn no_text_rules_the_terminal() {
        assert_eq!(plain("a\u{1b}]0;x\u{7}\n\u{202e}b"), "a\u{fffd}]0;x\u{fffd}\u{fffd}\u{fffd}b");
        assert_eq!(plain_lines("é\n\u{9b}31m\r"), "é\n\u{fffd}31m\u{fffd}");
    }

    #[test]
    fn the_time_left_of_the_whole_is_told_in_words() {
        assert_eq!(of_whole(Duration::from_secs(180)), ", 3 minutes in all");
        assert_eq!(of_whole(Duration::from_secs(1)), ", 1 second in all");
    }

    #[test]
    fn a_reader_that_went_away_is_recognised_in_both_kinds_of_error() {
        let refused = |kind| io::Error::new(kind, "refused");
        let plain = |kind| anyhow::Error::from(refused(kind)).context("writing");
        let ours = |kind| anyhow::Error::from(taotie::Error::io("a.png", refused(kind))).context("writing");
        assert!(is_broken_pipe(&plain(io::ErrorKind::BrokenPipe)));
        assert!(is_broken_pipe(&ours(io::ErrorKind::BrokenPipe)));
        assert!(!is_broken_pipe(&plain(io::ErrorKind::NotFound)));
        assert!(!is_broken_pipe(&ours(io::ErrorKind::NotFound)));
        assert!(!is_broken_pipe(&anyhow!("alone")));
    }
}
