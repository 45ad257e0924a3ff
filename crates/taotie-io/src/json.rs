//! JSON that is passed through unchanged, and tolerant parsing of large documents.

use serde::de::value::CowStrDeserializer;
use serde::de::{
    self, Deserialize, DeserializeOwned, DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess,
    Visitor,
};
use serde::forward_to_deserialize_any;
use serde_json::Value;
use serde_json::error::Category;
use std::borrow::Cow;
use std::fmt;
use std::path::Path;
use taotie_engine::error::Error;

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
    pub fn parse(text: &str) -> Result<Self, Error> {
        serde_json::from_str(text).map(Self).map_err(not_json)
    }

    /// Converts a value through serde.
    ///
    /// # Errors
    /// [`Error::Invalid`] if JSON cannot represent it, such as a map with keys that are not text.
    pub fn of(value: &impl serde::Serialize) -> Result<Self, Error> {
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
        Category::Eof if error.column() == 0 && error.line() <= 1 => {
            "the file is empty: download or re-export it".to_owned()
        }
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

/// Parses JSON as tolerantly as other readers do: numbers such as `4.0` are integers. Members of the outer object that
/// are called `skipped` are not read, and neither are members of any object that are called [`EXTRAS`]. Values are
/// built directly from the text, in a fraction of the time and memory that a [`Value`] in between would take.
///
/// # Errors
/// Those of the parser.
pub(super) fn parse_tolerant<T: DeserializeOwned>(
    text: &[u8],
    skipped: &'static str,
) -> serde_json::Result<T> {
    let mut parser = serde_json::Deserializer::from_slice(text);
    let value = T::deserialize(Tolerant { inner: &mut parser, skipped })?;
    parser.end().map(|()| value)
}

/// The name of members with application data.
pub(super) const EXTRAS: &str = "extras";

/// Returns the integer that a number such as `4.0` means.
pub(super) fn as_integer(number: f64) -> Option<u64> {
    ((0.0..9e15).contains(&number) && number.floor() == number).then_some(number as u64)
}

/// Parses an object without its members of other names.
///
/// # Errors
/// Those of the parser.
pub(super) fn parse_members(text: &[u8], names: &[&str]) -> serde_json::Result<Value> {
    struct Members<'n>(&'n [&'n str]);
    impl<'de> Visitor<'de> for Members<'_> {
        type Value = Value;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("an object")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Value, A::Error> {
            let mut kept = serde_json::Map::new();
            while let Some(Name(name)) = members.next_key()? {
                if self.0.contains(&name.as_ref()) {
                    kept.insert(name.into_owned(), members.next_value()?);
                } else {
                    members.next_value::<IgnoredAny>()?;
                }
            }
            Ok(Value::Object(kept))
        }
    }
    let mut parser = serde_json::Deserializer::from_slice(text);
    let kept = parser.deserialize_map(Members(names))?;
    parser.end().map(|()| kept)
}

/// A parser, a visitor, or a list or object that is being parsed, with the name of its members that are not read.
struct Tolerant<T> {
    inner: T,
    skipped: &'static str,
}

impl<T> Tolerant<T> {
    /// Returns the same place in another form.
    fn part<P>(&self, inner: P) -> Tolerant<P> {
        Tolerant { inner, skipped: self.skipped }
    }

    /// Returns an element or a member.
    fn below<P>(&self, inner: P) -> Tolerant<P> {
        Tolerant { inner, skipped: EXTRAS }
    }
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Tolerant<D> {
    type Error = D::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let visitor = self.part(visitor);
        self.inner.deserialize_any(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let visitor = self.part(visitor);
        self.inner.deserialize_option(visitor)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = self.part(visitor);
        self.inner.deserialize_newtype_struct(name, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.inner.deserialize_enum(name, variants, visitor)
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.inner.deserialize_ignored_any(visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map struct identifier
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Tolerant<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.inner.expecting(f)
    }

    fn visit_bool<E: de::Error>(self, value: bool) -> Result<V::Value, E> {
        self.inner.visit_bool(value)
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<V::Value, E> {
        self.inner.visit_i64(value)
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<V::Value, E> {
        self.inner.visit_u64(value)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<V::Value, E> {
        match as_integer(value) {
            Some(integer) => self.inner.visit_u64(integer),
            None => self.inner.visit_f64(value),
        }
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<V::Value, E> {
        self.inner.visit_str(value)
    }

    fn visit_borrowed_str<E: de::Error>(self, value: &'de str) -> Result<V::Value, E> {
        self.inner.visit_borrowed_str(value)
    }

    fn visit_none<E: de::Error>(self) -> Result<V::Value, E> {
        self.inner.visit_none()
    }

    fn visit_unit<E: de::Error>(self) -> Result<V::Value, E> {
        self.inner.visit_unit()
    }

    fn visit_some<D: Deserializer<'de>>(self, value: D) -> Result<V::Value, D::Error> {
        let value = self.part(value);
        self.inner.visit_some(value)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, value: D) -> Result<V::Value, D::Error> {
        let value = self.part(value);
        self.inner.visit_newtype_struct(value)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, items: A) -> Result<V::Value, A::Error> {
        let items = self.part(items);
        self.inner.visit_seq(items)
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<V::Value, A::Error> {
        let members = self.part(members);
        self.inner.visit_map(members)
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Tolerant<S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, value: D) -> Result<S::Value, D::Error> {
        let value = self.part(value);
        self.inner.deserialize(value)
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Tolerant<A> {
    type Error = A::Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, A::Error> {
        let seed = self.below(seed);
        self.inner.next_element_seed(seed)
    }
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Tolerant<A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, A::Error> {
        while let Some(Name(name)) = self.inner.next_key()? {
            if name != self.skipped && name != EXTRAS {
                return seed.deserialize(CowStrDeserializer::new(name)).map(Some);
            }
            self.inner.next_value::<IgnoredAny>()?;
        }
        Ok(None)
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, A::Error> {
        let seed = self.below(seed);
        self.inner.next_value_seed(seed)
    }
}

/// The name of a member, not copied unless it has escapes.
struct Name<'de>(Cow<'de, str>);

impl<'de> Deserialize<'de> for Name<'de> {
    fn deserialize<D: Deserializer<'de>>(value: D) -> Result<Self, D::Error> {
        struct NameVisitor;
        impl<'de> Visitor<'de> for NameVisitor {
            type Value = Name<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a name")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<Name<'de>, E> {
                Ok(Name(name.to_owned().into()))
            }

            fn visit_borrowed_str<E: de::Error>(self, name: &'de str) -> Result<Name<'de>, E> {
                Ok(Name(name.into()))
            }
        }
        value.deserialize_str(NameVisitor)
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

    #[test]
    fn tolerant_parsing_equals_that_of_a_tidied_value() {
        let text = br#"{"a":4.0,"b":[1.5,-2.0,{"extras":{"x":1},"list":3,"c":"\u00e9"}],"list":{"d":[]},"e":null,"extras":7,
            "f":{"list":1e3,"g":true},"h":9.5e15}"#;
        let read: Value = parse_tolerant(text, "list").unwrap();
        let wanted = serde_json::json!({
            "a": 4, "b": [1.5, -2.0, { "list": 3, "c": "é" }], "e": null, "f": { "list": 1000, "g": true },
            "h": 9.5e15,
        });
        assert_eq!(read, wanted);
        assert_eq!(
            parse_members(text, &["e", "list"]).unwrap(),
            serde_json::json!({ "e": null, "list": { "d": [] } })
        );
        for wrong in [&b"{\"a\":1} 2"[..], b"{\"a\":}", b"[1,"] {
            assert!(parse_tolerant::<Value>(wrong, "list").is_err() && parse_members(wrong, &["b"]).is_err());
        }
    }
}
