//! A small scanner for Rust source: the paths it names, the macros that print, and uses of `unsafe`.
//!
//! It knows comments, strings, `use` groups, `super` chains and inline modules, and no other part of the language.

/// A finding to be judged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Found {
    /// A path that starts with `crate` or `std`, with `super` and `self` resolved.
    Import(Vec<String>),
    /// A macro that prints.
    Macro(String),
    /// The word `unsafe`.
    Unsafe,
}

const PRINTING: [&str; 5] = ["print", "println", "eprint", "eprintln", "dbg"];

/// Returns the findings in the source text of `module`, with line numbers.
pub fn scan(module: &[String], text: &str) -> Vec<(usize, Found)> {
    let tokens = tokens(text);
    Scanner {
        tokens: &tokens,
        at: 0,
        module: module.to_vec(),
        inline: Vec::new(),
        depth: 0,
        found: Vec::new(),
    }
    .run()
}

/// A word or a symbol; `::` is one token. Comments, strings, characters and numbers are skipped.
#[derive(Debug)]
struct Token {
    line: usize,
    text: String,
}

fn tokens(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let (mut i, mut line) = (0, 1);
    let mut tokens = Vec::new();
    while i < chars.len() {
        let end = skip(&chars, i).unwrap_or_else(|| {
            let end = token_end(&chars, i);
            tokens.push(Token { line, text: chars[i..end].iter().collect() });
            end
        });
        line += chars[i..end].iter().filter(|c| **c == '\n').count();
        i = end;
    }
    tokens
}

/// Returns the end of a non-token at `i`: space, a comment, a string, a character or a lifetime.
fn skip(chars: &[char], i: usize) -> Option<usize> {
    let next = chars.get(i + 1);
    match chars[i] {
        c if c.is_whitespace() => Some(i + 1),
        '/' if next == Some(&'/') => Some(find(chars, i, |rest| rest[0] == '\n', 0)),
        '/' if next == Some(&'*') => Some(comment_end(chars, i)),
        '"' => Some(quoted_end(chars, i, '"')),
        'r' | 'b' | 'c' => prefixed_string_end(chars, i),
        '\'' if next == Some(&'\\') || chars.get(i + 2) == Some(&'\'') => Some(quoted_end(chars, i, '\'')),
        '\'' => Some(i + 1),
        _ => None,
    }
}

/// Returns the first position from `i` where `is` holds, plus `more`.
fn find(chars: &[char], i: usize, is: impl Fn(&[char]) -> bool, more: usize) -> usize {
    (i..chars.len()).find(|j| is(&chars[*j..])).map_or(chars.len(), |j| j + more)
}

fn comment_end(chars: &[char], start: usize) -> usize {
    let (mut i, mut depth) = (start, 0);
    while i < chars.len() {
        match &chars[i..] {
            ['/', '*', ..] => (depth, i) = (depth + 1, i + 2),
            ['*', '/', ..] => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            break;
        }
    }
    i
}

fn quoted_end(chars: &[char], start: usize, quote: char) -> usize {
    let mut i = start + 1;
    while i < chars.len() && chars[i] != quote {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    (i + 1).min(chars.len())
}

/// Returns the end of `b"…"`, `b'…'`, `r"…"`, `br#"…"#` and the like; `None` if a word merely starts with that
/// letter.
fn prefixed_string_end(chars: &[char], start: usize) -> Option<usize> {
    if start > 0 && is_word(chars[start - 1]) {
        return None;
    }
    let prefix = chars[start..].iter().take_while(|c| ['r', 'b', 'c'].contains(c)).count();
    let open = start + prefix;
    let hashes = chars[open..].iter().take_while(|c| **c == '#').count();
    let raw = chars[start..open].contains(&'r');
    match chars.get(open + hashes)? {
        '"' if raw => {
            let close: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
            Some(find(chars, open + hashes + 1, |rest| rest.starts_with(&close), close.len()))
        }
        quote @ ('"' | '\'') if hashes == 0 => Some(quoted_end(chars, open, *quote)),
        _ => None,
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn token_end(chars: &[char], i: usize) -> usize {
    if is_word(chars[i]) {
        return i + chars[i..].iter().take_while(|c| is_word(**c)).count();
    }
    if chars[i..].starts_with(&[':', ':']) { i + 2 } else { i + 1 }
}

struct Scanner<'a> {
    tokens: &'a [Token],
    at: usize,
    /// The path of the file and of the open inline modules.
    module: Vec<String>,
    /// The brace depth inside each open inline module.
    inline: Vec<usize>,
    depth: usize,
    found: Vec<(usize, Found)>,
}

impl Scanner<'_> {
    fn run(mut self) -> Vec<(usize, Found)> {
        while self.at < self.tokens.len() {
            self.step();
        }
        self.found
    }

    fn text(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |token| &token.text)
    }

    fn note(&mut self, at: usize, found: Found) {
        self.found.push((self.tokens[at].line, found));
    }

    fn step(&mut self) {
        let at = self.at;
        self.at += 1;
        let starts_path = at == 0 || self.text(at - 1) != "::";
        match self.text(at) {
            "{" => self.depth += 1,
            "}" => self.close(),
            "mod" if self.text(at + 2) == "{" => self.open(at),
            "unsafe" => self.note(at, Found::Unsafe),
            "crate" | "std" | "super" | "self" if starts_path => {
                self.at = at;
                self.path(&[]);
            }
            name if PRINTING.contains(&name) && self.text(at + 1) == "!" => {
                self.note(at, Found::Macro(name.to_owned()));
            }
            _ => {}
        }
    }

    fn open(&mut self, at: usize) {
        self.module.push(self.text(at + 1).to_owned());
        self.depth += 1;
        self.inline.push(self.depth);
        self.at = at + 3;
    }

    fn close(&mut self) {
        if self.inline.last() == Some(&self.depth) {
            self.inline.pop();
            self.module.pop();
        }
        self.depth = self.depth.saturating_sub(1);
    }

    /// Reads a path that continues `before`, with its groups; notes each full path.
    fn path(&mut self, before: &[String]) {
        let start = self.at;
        let mut path = before.to_vec();
        loop {
            match self.text(self.at) {
                "{" => return self.group(&path),
                word if word == "*" || word.starts_with(is_word) => path.push(word.to_owned()),
                _ => break,
            }
            self.at += 1;
            if self.text(self.at) != "::" {
                break;
            }
            self.at += 1;
        }
        if path.len() > before.len()
            && let Some(absolute) = self.absolute(&path)
        {
            self.note(start, Found::Import(absolute));
        }
    }

    fn group(&mut self, before: &[String]) {
        self.at += 1;
        while !["}", ""].contains(&self.text(self.at)) {
            let start = self.at;
            self.path(before);
            // Skip `as name` and the comma, at least one token per turn.
            self.at = self.at.max(start + 1);
            while ![",", "}", ""].contains(&self.text(self.at)) {
                self.at += 1;
            }
            if self.text(self.at) == "," {
                self.at += 1;
            }
        }
        self.at += 1;
    }

    /// Returns the path from `crate` or `std`; `None` if it does not start with one of the four words.
    fn absolute(&self, path: &[String]) -> Option<Vec<String>> {
        let supers = path.iter().take_while(|part| *part == "super" || *part == "self").count();
        let ups = path[..supers].iter().filter(|part| *part == "super").count();
        if supers == 0 {
            return ["crate", "std"].contains(&path.first()?.as_str()).then(|| path.to_vec());
        }
        if supers == path.len() {
            return None;
        }
        let home = &self.module[..self.module.len().saturating_sub(ups)];
        let crate_word = std::iter::once("crate".to_owned());
        Some(crate_word.chain(home.iter().cloned()).chain(path[supers..].iter().cloned()).collect())
    }
}
