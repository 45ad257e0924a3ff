//! Bookmarked views of a page.

use serde::{Deserialize, Serialize};

/// A view of a page, with a title and a text.
///
/// ```
/// use taotie_report::viewer::Bookmark;
///
/// let mask = Bookmark { title: "The mask".into(), link: "light=raking&from=-75,10".into(), ..Bookmark::default() };
/// assert_eq!(mask.text, "");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bookmark {
    /// The title.
    pub title: String,
    /// A description of the view; may be empty.
    #[serde(default)]
    pub text: String,
    /// The fragment of a link to the view, without `#`.
    pub link: String,
}
