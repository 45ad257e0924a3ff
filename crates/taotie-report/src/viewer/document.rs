//! Combines the viewer page's style and script into one document.

use super::blob::Blob;
use crate::Page;
use crate::document::{Document, WITHOUT_SCRIPT, html_with, sha256};
use rayon::prelude::*;

const STYLE: &str = include_str!("page.css");

/// The script that defines the element `<taotie-viewer>`, built from `viewer/`.
pub const SCRIPT: &str = include_str!("bundle/viewer.js");

/// The element that shows the content of the page, and the one that shows the files next to it.
const ALONE: &str = "<taotie-viewer></taotie-viewer>";
const BESIDE: &str = "<taotie-viewer src=\"./\" linked></taotie-viewer>";

/// The self-contained page.
pub(super) fn single_file(title: &str, blobs: &[Blob]) -> String {
    page(title, ["'none'", ALONE], &elements(blobs))
}

/// The page for a folder, which fetches the files next to it.
pub(super) fn linked(title: &str) -> String {
    page(title, ["'self'", BESIDE], "")
}

/// A report with the element as its first view.
pub(super) fn within(page: &Page, blobs: &[Blob]) -> String {
    html_with(page, SCRIPT, &elements(blobs))
}

fn elements(blobs: &[Blob]) -> String {
    blobs.par_iter().map(Blob::element).collect()
}

/// The page for an element, which may connect to `sources`.
fn page(title: &str, [sources, element]: [&str; 2], data: &str) -> String {
    let main = format!("<main>{element}{WITHOUT_SCRIPT}</main>");
    Document { title, policy: policy(sources), style: STYLE, main: &main, data, scripts: &[SCRIPT] }.html()
}

/// Allows only this style sheet and this script. The mesh decoder is compiled from bytes in the script.
fn policy(sources: &str) -> String {
    let [style, script] = [STYLE, SCRIPT].map(sha256);
    format!(
        "default-src 'none'; img-src data: blob:; connect-src {sources}; style-src 'sha256-{style}'; \
         script-src 'sha256-{script}' 'wasm-unsafe-eval'; base-uri 'none'; form-action 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_breaks_out_of_its_place() {
        let nasty = "</title><script>alert(1)</script>{policy}";
        let document = single_file(nasty, &[Blob::new("data", b"</script>".to_vec())]);
        // The script contains drawings with their own titles.
        let (head, _) = document.split_once("<main>").unwrap();
        assert_eq!(head.matches("<title>").count(), 1);
        assert!(document.contains("&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt;{policy}</title>"));
        assert!(!document.contains("alert(1)</script>"));
    }

    #[test]
    fn script_and_style_stay_in_their_elements() {
        for end in ["</script", "<!--", "\r"] {
            assert!(!SCRIPT.contains(end), "{end}");
        }
        assert!(!STYLE.contains('<') && !STYLE.contains('\r') && !STYLE.contains("url("));
    }

    #[test]
    fn the_script_fits_a_page() {
        let element = Blob::new("script", SCRIPT.as_bytes().to_vec()).file();
        assert!(element.bytes.len() <= 250_000, "{} bytes by gzip", element.bytes.len());
    }
}
