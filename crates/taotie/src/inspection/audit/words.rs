//! Numbers and lists in messages.

/// Formats a number with at most six decimals, grouping digits in threes.
pub(super) fn number(value: f64) -> String {
    let text = format!("{value:.6}");
    let (whole, decimals) = text.split_once('.').unwrap_or((&text, ""));
    let (sign, digits) = whole.strip_prefix('-').map_or(("", whole), |digits| ("-", digits));
    let (first, rest) = digits.split_at((digits.len() - 1) % 3 + 1);
    let groups: String =
        rest.as_bytes().chunks(3).map(|group| format!(",{}", String::from_utf8_lossy(group))).collect();
    match decimals.trim_end_matches('0') {
        "" => format!("{sign}{first}{groups}"),
        decimals => format!("{sign}{first}{groups}.{decimals}"),
    }
}

/// Formats a count with the word for what it counts, adding an `s` unless the count is one.
pub(super) fn counted(count: usize, what: &str) -> String {
    format!("{} {what}{}", number(count as f64), if count == 1 { "" } else { "s" })
}

/// Returns the first names of a list, and how many more there are.
pub(super) fn listed(names: &[String]) -> String {
    /// The maximum number of names in a message.
    const MOST: usize = 4;
    let shown = names.iter().take(MOST).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// Returns a value rounded to a multiple of 1 / `steps`.
pub(super) fn rounded(value: f64, steps: f64) -> f64 {
    (value * steps).round() / steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_and_short() {
        let texts = [0.0, 7.0, 1234.0, 999_999.5, -1_234_567.25, 0.1 + 0.2].map(number);
        assert_eq!(texts, ["0", "7", "1,234", "999,999.5", "-1,234,567.25", "0.3"]);
        assert_eq!((counted(1, "edge"), counted(0, "edge")), ("1 edge".into(), "0 edges".into()));
    }

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = ('a'..='f').map(String::from).collect();
        assert_eq!(listed(&names[..2]), "a, b");
        assert_eq!(listed(&names), "a, b, c, d and 2 more");
    }
}
