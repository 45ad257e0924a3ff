//! `docs/as-printed.md`: its computed tables, and its pictures.
//!
//! The page is written by hand, except for the text between `<!-- computed: NAME -->` and `<!-- end -->`.

mod pictures;
mod tables;

use crate::computed;
use crate::generated::{Content, Generated};
use anyhow::Result;
use std::path::Path;

const PAGE: &str = "docs/as-printed.md";

/// Returns the page with its tables updated, and its pictures, below the repository's `root`.
///
/// # Errors
/// If the page cannot be read or has an unknown table.
pub fn generated(root: &Path) -> Result<Generated> {
    let mut generated = page(root)?;
    for (name, picture) in pictures::all()? {
        let path = root.join("docs/images").join(format!("as-printed-{name}.png"));
        generated.files.insert(path, Content::Picture(picture));
    }
    Ok(generated)
}

/// Returns just the page.
fn page(root: &Path) -> Result<Generated> {
    computed::page(root, PAGE, tables::table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_page_and_its_pictures_are_up_to_date() {
        let stale =
            generated(&crate::root()).and_then(|generated| generated.stale()).expect("all are readable");
        assert!(stale.is_empty(), "run `make docs` to update {stale:?}");
    }

    #[test]
    fn the_page_shows_every_picture_and_every_table() {
        let text = std::fs::read_to_string(crate::root().join(PAGE)).expect("the page exists");
        for (name, _) in pictures::PICTURES {
            assert!(text.contains(&format!("](images/as-printed-{name}.png)")), "{name}");
        }
        for (name, _) in tables::TABLES {
            assert_eq!(text.matches(&computed::start(name)).count(), 1, "{name}");
        }
    }
}
