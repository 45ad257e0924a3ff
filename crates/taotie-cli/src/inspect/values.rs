//! Values as text: names, counts and numbers.

use crate::console;

/// Length above which names are shortened, characters.
const NAME: usize = 40;

/// Length above which other text of a file is shortened, characters.
const TEXT: usize = 400;

/// Returns at most [`TEXT`] characters of a file's text, without control characters, which could control the
/// terminal.
pub fn clean(text: &str) -> String {
    cut(text, TEXT)
}

/// Returns at most [`NAME`] characters.
pub fn short(name: &str) -> String {
    cut(name, NAME)
}

/// Returns at most `most` characters, without those that could control the terminal.
fn cut(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some(_) => console::plain(&text.chars().take(most - 1).chain(['…']).collect::<String>()),
        None => console::plain(text),
    }
}

/// Returns `yes` or `no`.
pub fn yes_or_no(there: bool) -> String {
    if there { "yes".into() } else { "no".into() }
}

/// Formats digits in groups of three.
pub fn thousands(count: impl ToString) -> String {
    let digits = count.to_string();
    let start = digits.len() % 3;
    let (first, rest) = digits.split_at(start);
    let groups = rest.as_bytes().chunks(3).map(|group| String::from_utf8_lossy(group).into_owned());
    let groups = std::iter::once(first.to_owned()).filter(|first| !first.is_empty()).chain(groups);
    groups.collect::<Vec<_>>().join(",")
}

/// Formats a fraction as per cent.
pub fn percent(fraction: f64) -> String {
    format!("{:.1} %", 100.0 * fraction)
}

/// Formats numbers, separated by spaces.
pub fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(" ")
}

/// Formats about six digits, without trailing zeros.
pub fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e9).contains(&value.abs()) {
        return format!("{value:.4e}");
    }
    let decimals = match value.abs() {
        large if large >= 1e5 => 0,
        large if large >= 1e2 => 3,
        _ => 6,
    };
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        let counts = [0, 999, 1000, 1_234_567].map(thousands);
        assert_eq!(counts, ["0", "999", "1,000", "1,234,567"]);
        let values = [0.0, -0.0, 1.0, 0.1_f64 + 0.2, -1234.5678, 1.5e-7, 123_456.7, 1e12].map(number);
        assert_eq!(values, ["0", "0", "1", "0.3", "-1234.568", "1.5000e-7", "123457", "1.0000e12"]);
        assert_eq!(percent(1.0 / 3.0), "33.3 %");
    }

    #[test]
    fn names_cannot_rule_the_terminal() {
        assert_eq!(clean("a\u{1b}[31m\nb"), "a\u{fffd}[31m\u{fffd}b");
        assert_eq!(short(&"x".repeat(50)).chars().count(), NAME);
        assert_eq!(short("Suzanne"), "Suzanne");
        assert_eq!(clean(&"x".repeat(1 << 17)).chars().count(), TEXT);
    }
}
