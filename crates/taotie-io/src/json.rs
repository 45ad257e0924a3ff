//! JSON that is passed through unchanged.

use serde_json::Value;
use serde_json::error::Category;
use std::fmt;
use std::path::Path;
use taotie_engine::error::{Error, Result};

/// A JSON value, kept as read; its `Display` writes it without spaces.
///
/// ```
/// use taotie_io::Json;
///
/// let packet = Json::parse(r#"{ "dc:title": "a jug" }"#)?;
/// assert_eq!(packet.to_string(), r#"{"dc:title":"a jug"}"#);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct Json(pub Value);

impl Json {
    /// Parses one JSON value.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the text is anything else; the message has the line and the column.
    pub fn parse(text: &str) -> Result<Self> {
        serde_json::from_str(text).map(Self).map_err(not_json)
    }

    /// Converts a value through serde.
    ///
    /// # Errors
    /// [`Error::Invalid`] if JSON cannot represent it, such as a map with keys that are not text.
    pub fn of(value: &impl serde::Serialize) -> Result<Self> {
        serde_json::to_value(value).map(Self).map_err(not_json)
    }
}

fn not_json(error: serde_json::Error) -> Error {
    Error::invalid("JSON", error.to_string())
}

/// Returns the error for a file whose JSON cannot be read: the position, the fault and the remedy.
pub(super) fn broken(path: &Path, error: &serde_json::Error) -> Error {
    let at = match error.line() {
        0 => "JSON".to_owned(),
        line => format!("line {line}, column {}", error.column()),
    };
    let text = error.to_string();
    let said = text.split(" at line ").next().unwrap_or_default();
    let what = match error.classify() {
        Category::Eof => "unexpected end of JSON: the file is truncated; download or re-export it".to_owned(),
        Category::Syntax => format!("not valid JSON ({said}): fix the file or re-export it"),
        Category::Data | Category::Io => format!("{said}; fix the file or re-export it"),
    };
    Error::parse(path, at, what)
}

impl fmt::Display for Json {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_json_is_refused_with_its_place() {
        assert_eq!(Json::parse("[1.0, 2]").unwrap().to_string(), "[1.0,2]");
        let error = Json::parse("{\n\"a\": }").unwrap_err().to_string();
        assert!(error.starts_with("JSON: ") && error.contains("line 2 column"), "{error}");
    }

    #[test]
    fn broken_files_are_told_in_plain_words() {
        let said = |text: &str| {
            let error = serde_json::from_str::<Vec<u8>>(text).unwrap_err();
            broken(Path::new("a.gltf"), &error).to_string()
        };
        let cases = [
            ("[1,\n2", "line 2", "unexpected end of JSON: the file is truncated"),
            ("[1,\n}", "line 2", "not valid JSON (expected value): fix the file"),
            ("[\"a\"]", "line 1", "invalid type: string \"a\", expected u8; fix the file"),
        ];
        for (text, at, why) in cases {
            let said = said(text);
            assert!(said.starts_with(&format!("a.gltf: {at}, column ")) && said.contains(why), "{said}");
        }
    }

    #[test]
    fn serde_writes_the_value_itself() {
        let json = Json::of(&[0.1f64, 1e300]).unwrap();
        assert_eq!(serde_json::to_string(&json).unwrap(), json.to_string());
        assert_eq!(
            serde_json::from_str::<Json>(r#"{"a":[1]}"#).unwrap(),
            Json::parse(r#"{"a":[1]}"#).unwrap()
        );
    }
}
