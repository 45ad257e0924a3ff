//! Pages written by hand, except for the text between `<!-- computed: NAME -->` and `<!-- end -->`.

use crate::generated::{Content, Generated};
use anyhow::{Context, Result, bail};
use std::path::Path;

const START: &str = "<!-- computed: ";
const END: &str = "<!-- end -->";

/// Returns the line that starts a computed part.
#[cfg(test)]
pub fn start(name: &str) -> String {
    format!("{START}{name} -->\n")
}

/// Returns the page `name` below the repository's `root`, with its parts updated by `table`.
///
/// # Errors
/// If the page cannot be read, or has a part that `table` does not know.
pub fn page(root: &Path, name: &str, table: impl Fn(&str) -> Option<String>) -> Result<Generated> {
    let path = root.join(name);
    let text = std::fs::read_to_string(&path).with_context(|| format!("{name}: cannot be read"))?;
    let text = renewed(&text.replace('\r', ""), table).with_context(|| name.to_owned())?;
    Ok(Generated { files: [(path, Content::Text(text))].into(), folder: None })
}

/// Returns the current text of the part `name` of a page; `None` if there is no such part.
pub fn part(text: &str, name: &str) -> Option<String> {
    let (_, rest) = text.split_once(&format!("{START}{name} -->\n"))?;
    Some(rest.split_once(END)?.0.to_owned())
}

/// Returns a row of a Markdown table.
pub fn row(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

/// Returns the text with every computed part updated by `table`, which maps names to text.
fn renewed(text: &str, table: impl Fn(&str) -> Option<String>) -> Result<String> {
    let mut parts = text.split(START);
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let Some((name, rest)) = part.split_once(" -->\n") else { bail!("`{START}` is not closed") };
        let Some((_, rest)) = rest.split_once(END) else { bail!("`{name}` has no `{END}`") };
        let Some(lines) = table(name) else { bail!("there is no table `{name}`") };
        out += &format!("{START}{name} -->\n{lines}{END}{rest}");
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn handwritten_text_is_kept() {
        let table = |name: &str| (name != "nothing").then(|| format!("| {name} |\n"));
        let text = "a\n<!-- computed: x -->\nold\n<!-- end -->\nb\n<!-- computed: y -->\n<!-- end -->\n";
        let new =
            "a\n<!-- computed: x -->\n| x |\n<!-- end -->\nb\n<!-- computed: y -->\n| y |\n<!-- end -->\n";
        assert_eq!(renewed(text, table).unwrap(), new);
        assert_eq!(renewed(new, table).unwrap(), new);
        assert_eq!(renewed("plain", table).unwrap(), "plain");
        for wrong in
            ["<!-- computed: x", "<!-- computed: x -->\n", "<!-- computed: nothing -->\n<!-- end -->"]
        {
            assert!(renewed(wrong, table).is_err(), "{wrong}");
        }
    }
}
