//! Attributes of Serde and documentation of a type, a field or a variant.

use anyhow::{Result, bail};
use syn::{Attribute, Expr, ExprLit, Lit, LitStr, Meta, Token};

/// The attributes that change the JSON, and those that only change how it is read.
const KNOWN: [&str; 18] = [
    "default",
    "deny_unknown_fields",
    "deserialize_with",
    "flatten",
    "from",
    "into",
    "rename",
    "rename_all",
    "serialize_with",
    "skip",
    "skip_deserializing",
    "skip_serializing",
    "skip_serializing_if",
    "tag",
    "transparent",
    "try_from",
    "untagged",
    "with",
];

/// Serde's attributes of an item.
#[derive(Default)]
pub struct Attributes(Vec<(String, Option<String>)>);

impl Attributes {
    /// Reads the attributes of an item.
    ///
    /// # Errors
    /// For an attribute that the schemas do not support.
    pub fn of(attributes: &[Attribute]) -> Result<Self> {
        let mut all = Vec::new();
        for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("serde")) {
            attribute.parse_nested_meta(|meta| {
                let name = meta.path.require_ident()?.to_string();
                let value = match meta.input.peek(Token![=]) {
                    true => Some(meta.value()?.parse::<LitStr>()?.value()),
                    false => None,
                };
                all.push((name, value));
                Ok(())
            })?;
        }
        if let Some((name, _)) = all.iter().find(|(name, _)| !KNOWN.contains(&name.as_str())) {
            bail!("schemas do not support `#[serde({name})]` yet");
        }
        Ok(Self(all))
    }

    /// Returns true if the item has the attribute.
    pub fn has(&self, name: &str) -> bool {
        self.0.iter().any(|(known, _)| known == name)
    }

    /// Returns the text of an attribute.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == name)?.1.as_deref()
    }

    /// Returns true if the item is never written.
    pub fn is_skipped(&self) -> bool {
        self.has("skip") || self.has("skip_serializing")
    }

    /// Returns a variant's name as written, given the attributes of its enum.
    pub fn variant_name(&self, container: &Self, name: &str) -> Result<String> {
        match (self.text("rename"), container.text("rename_all")) {
            (Some(renamed), _) => Ok(renamed.into()),
            (None, None) => Ok(name.into()),
            (None, Some("lowercase")) => Ok(name.to_lowercase()),
            (None, Some("kebab-case")) => Ok(split(name, '-')),
            (None, Some("snake_case")) => Ok(split(name, '_')),
            (None, Some(other)) => bail!("schemas do not support `rename_all = \"{other}\"` of variants yet"),
        }
    }

    /// Returns a field's name as written, given the attributes of its struct.
    pub fn field_name(&self, container: &Self, name: &str) -> Result<String> {
        match (self.text("rename"), container.text("rename_all")) {
            (Some(renamed), _) => Ok(renamed.into()),
            (None, None) => Ok(name.trim_start_matches("r#").into()),
            (None, Some("kebab-case")) => Ok(name.replace('_', "-")),
            (None, Some(other)) => bail!("schemas do not support `rename_all = \"{other}\"` of fields yet"),
        }
    }
}

fn split(name: &str, by: char) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push(by);
        }
        text.extend(letter.to_lowercase());
    }
    text
}

/// The documentation of an item, up to its examples.
#[derive(Default, Clone)]
pub struct Documentation(String);

impl Documentation {
    /// Reads the doc comments of an item.
    pub fn of(attributes: &[Attribute]) -> Self {
        let lines = attributes.iter().filter_map(|attribute| match &attribute.meta {
            Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
                Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) => Some(text.value()),
                _ => None,
            },
            _ => None,
        });
        let is_example = |line: &String| line.trim_start().starts_with(['#', '`']) && line.contains("```");
        let lines: Vec<String> = lines.take_while(|line| !is_example(line)).collect();
        Self(lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ").trim().into())
    }

    /// Returns the text for readers of JSON: links become names, `None` becomes `null`.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut rest = self.0.as_str();
        while let Some((before, after)) = rest.split_once("[`") {
            let Some((name, tail)) = after.split_once("`]") else { break };
            let last = name.rsplit("::").next().unwrap_or(name);
            text.push_str(&format!("{before}`{last}`"));
            rest = tail;
            // The target of a link.
            if let Some((_, after)) = rest.strip_prefix('(').and_then(|link| link.split_once(')')) {
                rest = after;
            }
        }
        text.push_str(rest);
        text.replace("`None`", "`null`")
    }

    /// Returns the names that the text links to.
    pub fn links(&self) -> Vec<String> {
        let names = self.0.split("[`").skip(1).filter_map(|after| Some(after.split_once("`]")?.0.to_owned()));
        names.collect()
    }

    /// Returns true if the text has the words.
    pub fn has(&self, words: &str) -> bool {
        self.0.contains(words)
    }

    /// Returns the range of numbers, such as `[0, 1]`.
    pub fn range(&self) -> Option<[f64; 2]> {
        let inside = self.0.split('[').skip(1).filter_map(|after| after.split_once(']'));
        let mut ranges = inside.filter_map(|(inside, _)| {
            let (low, high) = inside.split_once(", ")?;
            Some([low.replace('−', "-").parse().ok()?, high.parse().ok()?])
        });
        ranges.next().filter(|_| !self.0.contains("outside ["))
    }

    /// Returns the values of a text, if the documentation begins with all of them or lists them after a colon:
    /// `up` or `down`.
    pub fn values(&self) -> Option<Vec<&str>> {
        let sentence = self.0.split_once(". ").map_or(self.0.as_str(), |(first, _)| first);
        let list = match sentence.split_once(": `") {
            _ if sentence.starts_with('`') => sentence,
            Some((before, _)) => &sentence[before.len() + 2..],
            None => return None,
        };
        let mut parts = list.split('`').skip(1);
        let mut values = Vec::new();
        let mut is_closed = false;
        while let Some(value) = parts.next() {
            values.push(value);
            match parts.next() {
                Some(", ") if !is_closed => {}
                Some(" or " | ", or ") if !is_closed => is_closed = true,
                _ => break,
            }
        }
        (is_closed && values.len() > 1).then_some(values)
    }
}
