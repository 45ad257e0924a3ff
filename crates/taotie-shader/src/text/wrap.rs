//! Wraps calls with many arguments over several lines.

/// The maximum length of a line in characters.
const WIDTH: usize = 120;

/// Returns the text with long calls wrapped between their arguments.
pub(crate) fn wrapped(text: &str) -> String {
    text.lines().map(|line| wrapped_line(line) + "\n").collect()
}

fn wrapped_line(line: &str) -> String {
    let is_long = line.chars().count() > WIDTH && !line.trim_start().starts_with("//");
    let call = line.strip_suffix(");").filter(|_| is_long).and_then(opening);
    let Some((head, arguments)) = call else { return line.into() };
    let indent = " ".repeat(line.len() - line.trim_start().len());
    let mut text = format!("{head}(");
    let mut width = usize::MAX;
    for argument in split(arguments) {
        let length = argument.chars().count() + 2;
        if width.saturating_add(length) > WIDTH {
            text = format!("{}\n{indent}   ", text.trim_end());
            width = indent.len() + 4;
        }
        width += length;
        text += &format!(" {argument},");
    }
    format!("{}\n{indent});", text.trim_end_matches(','))
}

/// The statement up to the parenthesis that the last one closes, and the text between them.
fn opening(statement: &str) -> Option<(&str, &str)> {
    let mut depth = 1;
    for (at, letter) in statement.char_indices().rev() {
        depth += match letter {
            ')' => 1,
            '(' => -1,
            _ => 0,
        };
        if depth == 0 {
            return Some((&statement[..at], &statement[at + 1..]));
        }
    }
    None
}

/// The arguments of a call.
fn split(arguments: &str) -> Vec<&str> {
    let (mut depth, mut from, mut parts) = (0, 0, Vec::new());
    for (at, letter) in arguments.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(arguments[from..at].trim());
                from = at + 1;
            }
            _ => {}
        }
    }
    parts.push(arguments[from..].trim());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_calls_are_wrapped_between_their_arguments() {
        let argument = "some_function(with, arguments)";
        let line = format!("    return Structure({});", [argument; 6].join(", "));
        let text = wrapped(&line);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(
            text.starts_with("    return Structure(\n        some_function(with, arguments), some"),
            "{text}"
        );
        assert!(text.ends_with("arguments)\n    );\n"), "{text}");
        assert_eq!(text.split_whitespace().collect::<String>(), line.split_whitespace().collect::<String>());
        assert_eq!(wrapped("    return short(a, b);"), "    return short(a, b);\n");
    }
}
