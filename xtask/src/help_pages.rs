//! The help pages in `docs/help`: the output of `taotie --help` and `taotie <subcommand> --help`.

use crate::generated::{Content, Generated};
use clap::Command;
use std::collections::BTreeMap;
use std::path::Path;

/// The column at which text is wrapped.
const WIDTH: usize = 100;

/// Returns all pages below the repository's `root`.
pub fn generated(root: &Path) -> Generated {
    let folder = root.join("docs/help");
    let pages = pages(taotie_cli::command()).into_iter();
    let files = pages.map(|(name, text)| (folder.join(name), Content::Text(text))).collect();
    Generated { files, folder: Some(folder) }
}

/// Returns the text of each page by file name: the front page and one page per subcommand.
fn pages(command: Command) -> BTreeMap<String, String> {
    let mut command = command.term_width(WIDTH);
    // Passes the program name and the width on to the subcommands.
    command.build();
    let links: String = command.get_subcommands().filter(is_for_users).map(link).collect();
    let name = command.get_name().to_string();
    let front = format!("{}\n{links}", page(&name, &mut command));
    let shown = command.get_subcommands_mut().filter(|subcommand| is_for_users(&&**subcommand));
    let subcommands = shown.map(|subcommand| {
        let title = format!("{name} {}", subcommand.get_name());
        (file_name(subcommand.get_name()), page(&title, subcommand))
    });
    std::iter::once((file_name(&name), front)).chain(subcommands).collect()
}

/// Returns true for subcommands for users rather than for the program itself.
fn is_for_users(command: &&Command) -> bool {
    !command.is_hide_set()
}

fn file_name(command: &str) -> String {
    format!("{command}.md")
}

fn link(subcommand: &Command) -> String {
    let name = subcommand.get_name();
    format!("- [{name}]({})\n", file_name(name))
}

fn page(title: &str, command: &mut Command) -> String {
    let help = command.render_long_help().to_string();
    let lines: Vec<&str> = help.trim().lines().map(str::trim_end).collect();
    format!("# {title}\n\n```text\n{}\n```\n", lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_pages_are_up_to_date() {
        let stale = generated(&crate::root()).stale().expect("the pages are readable");
        assert!(stale.is_empty(), "run `make docs` to update {stale:?}");
    }

    #[test]
    fn every_subcommand_has_a_page_that_the_front_page_links() {
        let pages = pages(taotie_cli::command());
        for name in ["render", "inspect", "normals", "diff", "demo"] {
            assert!(pages["taotie.md"].contains(&format!("]({name}.md)")));
            let usage = format!("Usage: taotie {name} ");
            assert!(pages[&format!("{name}.md")].contains(&usage), "{pages:#?}");
        }
    }

    #[test]
    fn the_text_is_as_wide_as_stated() {
        let widest = |page: &String| page.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        let pages = pages(taotie_cli::command());
        let widths: Vec<usize> = pages.values().map(widest).collect();
        assert!(widths.iter().all(|width| *width <= WIDTH), "{widths:?}");
        assert!(widths.iter().any(|width| *width > WIDTH * 9 / 10), "{widths:?}");
    }
}
