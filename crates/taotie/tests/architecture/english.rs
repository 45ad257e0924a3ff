//! Counts phrases that docs/style.md advises against, in comments, messages and pages.

use regex::Regex;
use std::sync::LazyLock;

/// A phrase to avoid, and how to say it instead.
const PATTERNS: [(&str, &str); 13] = [
    (
        r"\b(?:is|are) no [A-Za-z`]+",
        "not a, invalid; `there is no`, `is no longer` and comparisons (`is no larger than`) are fine",
    ),
    (r"\b(?:tells?|told|telling|foretells?|foretold)\b", "report, return, state, estimate"),
    (r"\b[Bb]eside\b", "next to, alongside, in addition to, compared with"),
    (r"\balone\b", "only"),
    (r"(?m)(?:///|//!|//)\s*(?:What|Whatever|Who|Whoever) [^?\n]*$", "name the thing"),
    (r"\b(?:stands?|stood)\b", "is, appears"),
    (r"\bso (?:many|few|large)\b", "the number, or the parameter's name"),
    (r"\b(?:anew|once more)\b", "again"),
    (r"\bof (?:its|their|his|our|your) own\b", "its own, separate"),
    (r"\b(?:but for|that is there|that are there|but where|but when)\b", "except for; existing"),
    (
        r"\b(?:mend|mends|mended|mending|foresees?|foreseen|held against|goes before)\b",
        "fix, estimate, compare with",
    ),
    (r"\b(?:Says|Tells) (?:whether|what|how|which|that)\b|\bReturns what\b", "Returns true if, Returns the"),
    (r"\b(?:if|when) not given\b", "[default: …]"),
];

/// Good English that the first pattern would also find.
const NEGATIONS: &str =
    r"(?:[Tt]here )(?:is|are) no |\b(?:is|are) no (?:longer|one|[a-z]+er than|more than|less than)\b";

fn compiled(pattern: &str) -> Regex {
    Regex::new(pattern).expect("the pattern is valid")
}

static SOUND: LazyLock<Regex> = LazyLock::new(|| compiled(NEGATIONS));
static POOR: LazyLock<Vec<(Regex, &str)>> =
    LazyLock::new(|| PATTERNS.iter().map(|(pattern, advice)| (compiled(pattern), *advice)).collect());

/// Returns the phrases of a text: line, phrase and advice.
pub fn phrases(text: &str) -> Vec<(usize, String, &'static str)> {
    let text = SOUND.replace_all(text, "");
    let mut found = Vec::new();
    for (pattern, advice) in POOR.iter() {
        for hit in pattern.find_iter(&text) {
            let line = text[..hit.start()].matches('\n').count() + 1;
            found.push((line, hit.as_str().trim().to_owned(), *advice));
        }
    }
    found
}

/// Returns true if a file, given by its path from the root of the repository, is written by hand in English.
pub fn is_prose(path: &str) -> bool {
    let generated = ["docs/help/", "docs/shaders/", "/viewer/bundle/", "/golden/", "/snapshots/"];
    let about_patterns = ["architecture/english.rs", "architecture/figures.rs", "docs/style.md"];
    let kinds = [".rs", ".md", ".py", ".ts", ".js", ".wgsl"];
    kinds.iter().any(|kind| path.ends_with(kind))
        && !generated.iter().any(|part| path.contains(part))
        && !about_patterns.iter().any(|part| path.ends_with(part))
}
