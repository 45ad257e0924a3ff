//! The output of the command: results on stdout, messages and progress on stderr.

#[cfg(feature = "mcp")]
use crate::lines::{self, Line};
use anyhow::Result;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use taotie_engine::Warnings;
use taotie_report::View;

/// Writes a result line to stdout, replacing control characters, which may come from files and their names, except
/// line ends.
pub fn result(line: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "{}", plain_lines(line))?;
    Ok(stdout.flush()?)
}

/// Writes the program's own text to stdout, unchanged.
pub fn own_text(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "{text}")?;
    Ok(stdout.flush()?)
}

/// Returns text of a file without characters that could control the terminal: control characters, and marks that
/// change the writing direction. Each becomes the replacement character.
pub fn plain(text: &str) -> String {
    text.chars().map(|c| if rules_terminal(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// Like [`plain`], but keeps line ends, which the caller added.
fn plain_lines(text: &str) -> Cow<'_, str> {
    // Reports may have hundreds of megabytes, most of them ASCII.
    if text.bytes().all(|byte| byte == b'\n' || (b' '..=b'~').contains(&byte)) {
        return text.into();
    }
    let kept = |c: char| c == '\n' || !rules_terminal(c);
    text.chars().map(|c| if kept(c) { c } else { char::REPLACEMENT_CHARACTER }).collect()
}

fn rules_terminal(c: char) -> bool {
    c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Set if the user wants neither progress nor messages. Global, because stderr is.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Turns progress, messages and warnings off or on.
pub fn set_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Returns true if the user wants neither progress nor messages.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Set if progress is written for programs. Global, because stderr is.
static PROGRESS_LINES: AtomicBool = AtomicBool::new(false);

/// Writes progress as JSON lines, or shows it as bars.
pub fn set_progress_lines(lines: bool) {
    PROGRESS_LINES.store(lines, Ordering::Relaxed);
}

/// Writes a message to stderr, unless the user wants none. A closed stderr is not an error.
pub fn say(line: &str) {
    if !is_quiet() {
        complain(line);
    }
}

/// Writes an error to stderr, replacing control characters except line ends. A closed stderr is not an error.
pub fn complain(line: &str) {
    #[cfg(feature = "mcp")]
    if lines::are_wanted() {
        return lines::send(&Line::Message(plain_lines(line).into_owned()));
    }
    let _ = writeln!(io::stderr().lock(), "{}", plain_lines(line));
}

/// Runs `work`, which searches for graphics drivers, with stderr discarded: drivers and the layers loaded with them
/// write there even if nothing is wrong (Mesa's choice of a device reports a missing Wayland display as an error), and no
/// option of their interfaces silences them.
#[cfg(all(unix, feature = "gpu"))]
pub fn with_quiet_drivers<T>(work: impl FnOnce() -> T) -> T {
    let _silenced = SilencedStderr::new().ok();
    work()
}

/// Runs `work`, which searches for graphics drivers.
#[cfg(all(not(unix), feature = "gpu"))]
pub fn with_quiet_drivers<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// Discards everything written to stderr until it is dropped.
#[cfg(all(unix, feature = "gpu"))]
struct SilencedStderr {
    kept: std::os::fd::OwnedFd,
}

#[cfg(all(unix, feature = "gpu"))]
impl SilencedStderr {
    fn new() -> io::Result<Self> {
        use std::os::fd::AsFd;
        let kept = io::stderr().as_fd().try_clone_to_owned()?;
        let nowhere = std::fs::File::options().write(true).open("/dev/null")?;
        rustix::stdio::dup2_stderr(nowhere)?;
        Ok(Self { kept })
    }
}

#[cfg(all(unix, feature = "gpu"))]
impl Drop for SilencedStderr {
    fn drop(&mut self) {
        let _ = rustix::stdio::dup2_stderr(&self.kept);
    }
}

/// Writes a report to stdout, as JSON or as text.
pub fn report<T: Serialize>(is_json: bool, report: &T, text: impl FnOnce(&T) -> String) -> Result<()> {
    #[cfg(feature = "mcp")]
    if lines::are_wanted() {
        lines::send(&Line::Text(plain_lines(&text(report)).into_owned()));
        return result(&serde_json::to_string(report)?);
    }
    match is_json {
        true => result(&serde_json::to_string_pretty(report)?),
        false => result(&text(report)),
    }
}

/// Returns true if the program that runs this command shows pictures of the result.
pub fn shows_pictures() -> bool {
    #[cfg(feature = "mcp")]
    return lines::are_wanted();
    #[cfg(not(feature = "mcp"))]
    false
}

/// Sends pictures of a report page to the program that runs this command.
#[cfg_attr(not(feature = "mcp"), expect(unused_variables, reason = "nothing shows them"))]
pub fn show(views: &[View]) {
    #[cfg(feature = "mcp")]
    lines::show(views);
}

/// Sends a PNG file to the program that runs this command.
#[cfg_attr(not(feature = "mcp"), expect(unused_variables, reason = "nothing shows it"))]
pub fn show_file(path: &Path) -> Result<()> {
    #[cfg(feature = "mcp")]
    lines::show_file(path)?;
    Ok(())
}

/// Writes each kind of warning with its count to stderr.
pub fn say_warnings(warnings: &Warnings) {
    for (what, count) in warnings.iter() {
        let times = if count == 1 { String::new() } else { format!(" ({count} times)") };
        say(&format!("taotie: warning: {}{times}", plain(what)));
    }
}

/// Returns the name of a file without its folders, which are private.
pub fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Returns the causes of an error, outermost first.
pub fn causes(error: &anyhow::Error) -> String {
    format!("{error:#}")
}

/// Returns true if the error comes from a closed pipe.
pub fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().filter_map(io_error).any(|cause| cause.kind() == io::ErrorKind::BrokenPipe)
}

fn io_error<'e>(error: &'e (dyn std::error::Error + 'static)) -> Option<&'e io::Error> {
    match error.downcast_ref() {
        Some(taotie_engine::Error::Io { cause, .. }) => Some(cause),
        _ => error.downcast_ref(),
    }
}

/// A progress bar that appears on a terminal once the work has taken a second; lines of JSON if programs read them.
pub struct Bar {
    title: String,
    start: Instant,
    bar: OnceLock<ProgressBar>,
    /// The time of the latest line, in milliseconds since the start, plus 1; 0 if there was none.
    line: AtomicU64,
}

/// A line of progress for programs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProgressLine {
    /// The running stage.
    pub stage: String,
    /// Completed fraction of the stage, in [0, 1].
    pub done: f64,
    /// Estimated seconds left of the whole work, if known.
    pub left_s: Option<f64>,
}

/// Milliseconds between lines of progress.
const LINE_MS: u64 = 100;

/// The bar's length: progress is in thousandths.
const STEPS: u64 = 1000;

impl Bar {
    /// Creates a bar that is not shown yet.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), start: Instant::now(), bar: OnceLock::new(), line: AtomicU64::new(0) }
    }

    /// Shows the fraction done.
    pub fn set(&self, fraction: f64) {
        self.show(fraction, None);
    }

    /// Shows the fraction done of this stage, and the time left for the whole work, if known.
    pub fn show(&self, fraction: f64, whole: Option<Duration>) {
        if !self.is_drawn(fraction, whole) {
            return;
        }
        let bar = self.bar.get_or_init(|| self.new_bar());
        if let Some(left) = whole {
            bar.set_prefix(of_whole(left));
        }
        bar.set_position((fraction * STEPS as f64) as u64);
    }

    /// Shows the fraction of the whole work that is done, and the time left as estimated by the caller.
    pub fn show_all(&self, fraction: f64, left: Option<Duration>) {
        if !self.is_drawn(fraction, left) {
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

    /// Shows the fraction done and lets the work continue: the listener of a [`taotie_engine::Progress`].
    pub fn hear(&self, fraction: f64) -> bool {
        self.set(fraction);
        true
    }

    /// Returns true if a bar is to be drawn; otherwise programs get a line, or nobody wants progress.
    fn is_drawn(&self, fraction: f64, left: Option<Duration>) -> bool {
        let has_lines = PROGRESS_LINES.load(Ordering::Relaxed);
        if has_lines {
            self.write_line(fraction, left);
        }
        !has_lines && !is_quiet() && self.start.elapsed() >= Duration::from_secs(1)
    }

    /// Writes a line of progress, unless the latest is recent.
    fn write_line(&self, done: f64, left: Option<Duration>) {
        let now = self.start.elapsed().as_millis() as u64 + 1;
        let last = self.line.load(Ordering::Relaxed);
        if last == 0 || now >= last + LINE_MS {
            self.line.store(now, Ordering::Relaxed);
            let left_s = left.map(|left| (left.as_secs_f64() * 10.0).round() / 10.0);
            let line = ProgressLine { stage: self.title.clone(), done: (done * 1e3).round() / 1e3, left_s };
            let text = serde_json::to_string(&line).unwrap_or_default();
            let _ = writeln!(io::stderr().lock(), "{text}");
        }
    }

    fn new_bar(&self) -> ProgressBar {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %, {eta} left{prefix}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(plain(&self.title));
        bar
    }
}

/// Formats the time left for the whole work, to follow that of a stage.
fn of_whole(left: Duration) -> String {
    format!(", {} in total", HumanDuration(left))
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
        let error = anyhow::Error::from(taotie_engine::Error::io("a.obj", refused)).context("reading");
        assert_eq!(causes(&error), "reading: a.obj: not there");
        assert_eq!(causes(&anyhow!("single")), "single");
    }

    #[test]
    fn no_text_rules_the_terminal() {
        assert_eq!(plain("a\u{1b}]0;x\u{7}\n\u{202e}b"), "a\u{fffd}]0;x\u{fffd}\u{fffd}\u{fffd}b");
        assert_eq!(plain_lines("é\n\u{9b}31m\r"), "é\n\u{fffd}31m\u{fffd}");
    }

    #[test]
    fn the_time_left_of_the_whole_is_told_in_words() {
        assert_eq!(of_whole(Duration::from_secs(180)), ", 3 minutes in total");
        assert_eq!(of_whole(Duration::from_secs(1)), ", 1 second in total");
    }

    #[test]
    fn a_reader_that_went_away_is_recognised_in_both_kinds_of_error() {
        let refused = |kind| io::Error::new(kind, "refused");
        let plain = |kind| anyhow::Error::from(refused(kind)).context("writing");
        let ours =
            |kind| anyhow::Error::from(taotie_engine::Error::io("a.png", refused(kind))).context("writing");
        assert!(is_broken_pipe(&plain(io::ErrorKind::BrokenPipe)));
        assert!(is_broken_pipe(&ours(io::ErrorKind::BrokenPipe)));
        assert!(!is_broken_pipe(&plain(io::ErrorKind::NotFound)));
        assert!(!is_broken_pipe(&ours(io::ErrorKind::NotFound)));
        assert!(!is_broken_pipe(&anyhow!("single")));
    }
}
