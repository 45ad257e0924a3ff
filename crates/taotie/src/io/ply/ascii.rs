//! Ascii payloads, rewritten as binary ones. `ply-rs-bw` reads one row a line by a grammar that refuses `.5`, `1.` and
//! `nan`, which writers do write, so words are taken one by one here, wherever lines end.

use super::super::text::quote;
use super::names::is_float;
use crate::error::{Error, Result};
use ply_rs_bw::ply::{ElementDef, PropertyType, ScalarType};
use std::path::Path;

/// The words of a payload, with the line they stand in.
pub(super) struct Tokens<'a> {
    path: &'a Path,
    rest: &'a [u8],
    line: usize,
}

impl<'a> Tokens<'a> {
    /// The words of `payload`, which starts at the given line of the file.
    pub(super) fn new(path: &'a Path, payload: &'a [u8], line: usize) -> Self {
        Self { path, rest: payload, line }
    }

    /// The rows of an element as little-endian numbers, and the element with the types that these have.
    ///
    /// Lists are widened, since writers declare indices as narrower than they are.
    pub(super) fn rows(&mut self, element: &ElementDef) -> Result<(Vec<u8>, ElementDef)> {
        let mut widened = element.clone();
        for (_, property) in widened.properties.iter_mut() {
            if let PropertyType::List(_, scalar) = &property.data_type {
                let scalar = if is_float(scalar) { ScalarType::Double } else { ScalarType::UInt };
                property.data_type = PropertyType::List(ScalarType::UInt, scalar);
            }
        }
        let mut rows = Vec::new();
        for i in 0..element.count {
            for (_, property) in &widened.properties {
                self.property(&property.data_type, &mut rows).map_err(|what| {
                    let what = format!("{what} in {} {i} of {}", element.name, element.count);
                    Error::parse(self.path, format!("line {}", self.line), what)
                })?;
            }
        }
        Ok((rows, widened))
    }

    fn property(&mut self, data_type: &PropertyType, row: &mut Vec<u8>) -> std::result::Result<(), String> {
        let scalar = match data_type {
            PropertyType::Scalar(scalar) => {
                push_number(self.number()?, scalar, row);
                return Ok(());
            }
            PropertyType::List(_, scalar) => scalar,
        };
        let count = self.number()?;
        if count < 0.0 || count != count.floor() {
            return Err(format!("a list of {count} values"));
        }
        row.extend((count as u32).to_le_bytes());
        for _ in 0..count as u64 {
            let value = self.number()?;
            match scalar {
                // What is no index is made one that is out of range.
                ScalarType::UInt if !(value >= 0.0 && value == value.floor()) => row.extend([0xFF; 4]),
                _ => push_number(value, scalar, row),
            }
        }
        Ok(())
    }

    fn number(&mut self) -> std::result::Result<f64, String> {
        let word = self.word().ok_or("the file ends too early")?;
        let text = String::from_utf8_lossy(word);
        text.parse().map_err(|_| format!("{} is not a number", quote(&text)))
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace());
        let (space, rest) = self.rest.split_at(start.unwrap_or(self.rest.len()));
        self.line += space.iter().filter(|b| **b == b'\n').count();
        let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// Appends a number as its declared type; out-of-range whole numbers take the nearest.
fn push_number(value: f64, scalar: &ScalarType, row: &mut Vec<u8>) {
    match scalar {
        ScalarType::Char => row.extend((value as i8).to_le_bytes()),
        ScalarType::UChar => row.push(value as u8),
        ScalarType::Short => row.extend((value as i16).to_le_bytes()),
        ScalarType::UShort => row.extend((value as u16).to_le_bytes()),
        ScalarType::Int => row.extend((value as i32).to_le_bytes()),
        ScalarType::UInt => row.extend((value as u32).to_le_bytes()),
        ScalarType::Float => row.extend((value as f32).to_le_bytes()),
        ScalarType::Double => row.extend(value.to_le_bytes()),
    }
}
