//! `docs/as-printed.md`: its computed tables, and its pictures.
//!
//! The page is written by hand but for what stands between `<!-- computed: NAME -->` and `<!-- end -->`.

mod pictures;
mod tables;

use crate::computed;
use crate::generated::{Content, Generated};
use anyhow::Result;
use std::path::Path;

const PAGE: &str = "docs/as-printed.md";

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
    computed::page(root, PAGE, tables::table)
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
            assert_eq!(text.matches(&computed::start(name)).count(), 1, "{name}");
        }
    }
}
