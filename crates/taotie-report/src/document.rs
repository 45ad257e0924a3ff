//! Combines a page's data, style and script into one document.

use crate::Page;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

const STYLE: &str = include_str!("page.css");

/// The parts of the script; the last one starts it.
const SCRIPT: [&str; 15] = [
    "\"use strict\";\n",
    include_str!("page/dom.js"),
    include_str!("page/numbers.js"),
    include_str!("page/lens.js"),
    include_str!("page/gestures.js"),
    include_str!("page/wipe.js"),
    include_str!("page/legend.js"),
    include_str!("page/model.js"),
    include_str!("page/view.js"),
    include_str!("page/viewer.js"),
    include_str!("page/table.js"),
    include_str!("page/statement.js"),
    include_str!("page/histogram.js"),
    include_str!("page/plot.js"),
    include_str!("page/main.js"),
];

/// The message that a page shows if scripts are disabled.
pub(crate) const WITHOUT_SCRIPT: &str =
    "<noscript>This page needs JavaScript. The script is part of the page; nothing is fetched.</noscript>";

/// The element that a report's scripts fill.
pub(crate) fn report() -> String {
    format!("<main id=\"report\">{WITHOUT_SCRIPT}</main>")
}

/// The parts of a document.
pub(crate) struct Document<'a> {
    pub title: &'a str,
    /// The content security policy.
    pub policy: String,
    pub style: &'a str,
    /// The element that the script fills.
    pub main: &'a str,
    /// The elements that contain data.
    pub data: &'a str,
    /// The scripts in order.
    pub scripts: &'a [&'a str],
}

impl Document<'_> {
    /// Writes the document.
    pub fn html(&self) -> String {
        format!(
            include_str!("page.html"),
            policy = self.policy,
            version = env!("CARGO_PKG_VERSION"),
            title = escaped(self.title),
            style = self.style,
            main = self.main,
            data = self.data,
            scripts =
                self.scripts.iter().map(|script| format!("<script>{script}</script>\n")).collect::<String>(),
        )
    }
}

/// Writes the page as one HTML document that fetches nothing else.
pub fn html(page: &Page) -> String {
    written(page, &[], "")
}

/// Writes the page with a custom element as its first view, given the element's script and content.
pub(crate) fn html_with(page: &Page, script: &str, content: &str) -> String {
    written(page, &[script], content)
}

/// Writes the page; the scripts in `others` run before its own.
fn written(page: &Page, others: &[&str], content: &str) -> String {
    let style = plain_line_ends(STYLE);
    let script = plain_line_ends(&SCRIPT.concat());
    let scripts = [others, &[script.as_str()]].concat();
    let json = serde_json::to_string(page).expect("the page has only text keys");
    let document = Document {
        title: &page.title,
        policy: policy(&style, &scripts),
        style: &style,
        main: &report(),
        data: &[json_element(&json).as_str(), content].concat(),
        scripts: &scripts,
    };
    document.html()
}

/// Browsers drop carriage returns before hashing, so the hash must not include any.
fn plain_line_ends(text: &str) -> String {
    text.replace('\r', "")
}

/// Allows only this style sheet, these scripts and pictures within the page; no connections. A page with a custom
/// element that shows a model may also compile the mesh decoder included in its script.
fn policy(style: &str, scripts: &[&str]) -> String {
    let sources: Vec<String> = scripts.iter().map(|script| format!("'sha256-{}'", sha256(script))).collect();
    let (pictures, compiled) = if scripts.len() > 1 { (" blob:", " 'wasm-unsafe-eval'") } else { ("", "") };
    format!(
        "default-src 'none'; img-src data:{pictures}; style-src 'sha256-{}'; script-src {}{compiled}; base-uri 'none'; \
         form-action 'none'",
        sha256(style),
        sources.join(" ")
    )
}

/// The hash of a style sheet or a script, in the form that a policy uses.
pub(crate) fn sha256(text: &str) -> String {
    STANDARD.encode(Sha256::digest(text))
}

/// Escapes text for use in markup.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The element with a page's data: JSON without any `<`, so that nothing in it can end the element or open a comment.
pub(crate) fn json_element(json: &str) -> String {
    let json = json.replace('<', "\\u003c");
    format!("<script type=\"application/json\" id=\"data\">{json}</script>\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fact, View};

    const NASTY: &str = "</script><img src=x onerror=alert(1)><!--<script>{policy}&amp;";

    fn nasty() -> Page {
        let fact = Fact::new(NASTY, NASTY);
        let view = View { name: NASTY.into(), ..View::default() };
        Page { title: NASTY.into(), facts: vec![fact], views: vec![view], ..Page::default() }
    }

    /// All parts share one scope, in which a second function of the same name would replace the first.
    #[test]
    fn names_of_functions_are_unique() {
        let mut names: Vec<&str> = SCRIPT
            .iter()
            .flat_map(|part| part.lines())
            .filter_map(|line| line.strip_prefix("function ")?.split('(').next())
            .collect();
        let all = names.len();
        names.sort_unstable();
        names.dedup();
        assert!(all > 50 && names.len() == all, "{all} functions, {} names", names.len());
    }

    #[test]
    fn no_text_breaks_out_of_its_place() {
        let document = html(&nasty());
        assert_eq!(document.matches("<script").count(), 2);
        assert_eq!(document.matches("</script>").count(), 2);
        assert_eq!(document.matches("<style>").count(), 1);
        assert_eq!(document.matches("<title>").count(), 1);
        assert!(!document.contains("<img") && !document.contains("<!--"));
        assert!(document.contains("<title>&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;&lt;!--&lt;script&gt;{policy}&amp;amp;</title>"));
    }

    #[test]
    fn the_data_come_back_as_they_went_in() {
        let document = html(&nasty());
        let (_, rest) = document.split_once("id=\"data\">").unwrap();
        let (json, _) = rest.split_once("</script>").unwrap();
        let read: serde_json::Value = serde_json::from_str(json).unwrap();
        assert_eq!(read, serde_json::to_value(nasty()).unwrap());
        assert_eq!(read["facts"][0]["name"], NASTY);
    }

    #[test]
    fn style_and_script_name_no_other_place() {
        let own = [STYLE.into(), SCRIPT.concat().replace("http://www.w3.org/2000/svg", "")].concat();
        for word in
            ["://", "url(", "@import", "fetch(", "XMLHttp", "eval(", "innerHTML", "insertAdjacent", "</"]
        {
            assert!(!own.contains(word), "{word}");
        }
    }
}
