//! Names of files as relative URIs.

use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};

/// Characters that a relative URI cannot hold as they are.
const RESERVED: &AsciiSet = &CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b':')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'[')
    .add(b'\\')
    .add(b']')
    .add(b'^')
    .add(b'`')
    .add(b'{')
    .add(b'|')
    .add(b'}');

/// Returns the relative URI of a file.
pub(super) fn uri(name: &str) -> String {
    utf8_percent_encode(name, RESERVED).to_string()
}
