//! `docs/as-printed.md`: its computed tables, and its pictures.
//!
//! The page is written by hand but for what stands between `<!-- computed: NAME -->` and `<!-- end -->`.

mod pictures;
mod tables;

use crate::generated::{Content, Generated};
use anyhow::{Context, Result, bail};
use std::path::Path;

const PAGE: &str = "docs/as-printed.md";

const START: &str = "<!-- computed: ";
const END: &str = "<!-- end -->";

/// The page with its tables renewed, and its pictures, below the repository's `root`.
///
/// # Errors
/// Where the page cannot be read or names a table that there is not.
pub fn generated(root: &Path) -> Result<Generated> {
    let mut generated = page(root)?;
    for (name, picture) in pictures::all()? {
        let path = root.join("docs/images").join(format!("as-printed-{name}.png"));
        generated.files.insert(path, Content::Picture(picture));
    }
    Ok(generated)
}

/// The page alone.
fn page(root: &Path) -> Result<Generated> {
    let path = root.join(PAGE);
    let text = std::fs::read_to_string(&path).with_context(|| format!("{PAGE}: cannot be read"))?;
    let content = Content::Text(renewed(&text.replace('\r', ""), tables::table)?);
    Ok(Generated { files: [(path, content)].into(), folder: None })
}

/// The text with every computed part renewed by `table`, which knows them by name.
fn renewed(text: &str, table: impl Fn(&str) -> Option<String>) -> Result<String> {
    let mut parts = text.split(START);
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let Some((name, rest)) = part.split_once(" -->\n") else { bail!("{PAGE}: `{START}` is not closed") };
        let Some((_, rest)) = rest.split_once(END) else { bail!("{PAGE}: `{name}` has no `{END}`") };
        let Some(lines) = table(name) else { bail!("{PAGE}: there is no table `{name}`") };
        out += &format!("{START}{name} -->\n{lines}{END}{rest}");
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kept_page_and_its_pictures_are_fresh() {
        let stale =
            generated(&crate::root()).and_then(|generated| generated.stale()).expect("all is readable");
        assert!(stale.is_empty(), "`make docs` renews {stale:?}");
    }

    #[test]
    fn the_page_shows_every_picture_and_every_table() {
        let text = std::fs::read_to_string(crate::root().join(PAGE)).expect("the page is there");
        for (name, _) in pictures::PICTURES {
            assert!(text.contains(&format!("](images/as-printed-{name}.png)")), "{name}");
        }
        for (name, _) in tables::TABLES {
            assert_eq!(text.matches(&format!("{START}{name} -->\n")).count(), 1, "{name}");
        }
    }

    #[test]
    fn what_is_written_by_hand_stays() {
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
