//! The syntax of the languages, and the translation of GLSL ES to WGSL.

use crate::graph::Kind;

/// A shading language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Language {
    /// WGSL, of WebGPU.
    Wgsl,
    /// GLSL ES 3.00, of WebGL 2. Standalone functions need a host that declares `precision highp float`.
    GlslEs,
}

/// The precedence of an expression's outermost operator; later variants bind more tightly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Tightness {
    Comparison,
    Sum,
    Product,
    Sign,
    Atom,
}

/// The text of an expression.
#[derive(Debug, Clone)]
pub(crate) struct Phrase {
    pub(crate) text: String,
    pub(crate) tightness: Tightness,
}

impl Phrase {
    pub(crate) fn atom(text: impl Into<String>) -> Self {
        Self { text: text.into(), tightness: Tightness::Atom }
    }

    /// A call of a function or constructor.
    pub(crate) fn call(name: &str, arguments: &[&Phrase]) -> Self {
        let texts: Vec<&str> = arguments.iter().map(|argument| argument.text.as_str()).collect();
        Self::atom(format!("{name}({})", texts.join(", ")))
    }

    /// The constant as a single-precision literal.
    pub(crate) fn constant(value: f64) -> Self {
        let tightness = if value.is_sign_negative() { Tightness::Sign } else { Tightness::Atom };
        Self { text: format!("{:?}", value as f32), tightness }
    }

    /// The text, in parentheses if it binds less tightly than `least`.
    pub(crate) fn within(&self, least: Tightness) -> String {
        if self.tightness < least { format!("({})", self.text) } else { self.text.clone() }
    }
}

impl Language {
    /// The name of a type.
    pub(crate) fn kind(self, kind: Kind) -> &'static str {
        match (self, kind) {
            (Self::Wgsl, Kind::Number) => "f32",
            (Self::Wgsl, Kind::Vector) => "vec3f",
            (Self::GlslEs, Kind::Number) => "float",
            (Self::GlslEs, Kind::Vector) => "vec3",
            (_, Kind::Truth) => "bool",
            (_, Kind::Structure(name)) => name,
        }
    }

    /// A declared name with its type, as in arguments and fields.
    pub(crate) fn declared(self, name: &str, of: &str) -> String {
        match self {
            Self::Wgsl => format!("{name}: {of}"),
            Self::GlslEs => format!("{of} {name}"),
        }
    }

    /// The declaration of a named value.
    pub(crate) fn binding(self, name: &str, kind: Kind, text: &str) -> String {
        match self {
            Self::Wgsl => format!("    let {name} = {text};\n"),
            Self::GlslEs => format!("    {} {name} = {text};\n", self.kind(kind)),
        }
    }

    /// The first line of a function.
    pub(crate) fn opening(self, name: &str, arguments: &str, result: &str) -> String {
        match self {
            Self::Wgsl => format!("fn {name}({arguments}) -> {result} {{\n"),
            Self::GlslEs => format!("{result} {name}({arguments}) {{\n"),
        }
    }

    /// A field of a structure.
    pub(crate) fn field(self, name: &str, kind: Kind) -> String {
        let end = if self == Self::Wgsl { ',' } else { ';' };
        format!("    {}{end}\n", self.declared(name, self.kind(kind)))
    }

    /// The end of a structure.
    pub(crate) fn structure_end(self) -> &'static str {
        if self == Self::Wgsl { "}\n" } else { "};\n" }
    }

    /// Selects `yes` if `condition` holds, else `no`.
    pub(crate) fn select(self, [condition, yes, no]: [&Phrase; 3]) -> Phrase {
        match self {
            Self::Wgsl => Phrase::call("select", &[no, yes, condition]),
            Self::GlslEs => Phrase::atom(format!("({} ? {} : {})", condition.text, yes.text, no.text)),
        }
    }

    /// The function used for powers, which shading languages leave undefined at zero and below.
    pub(crate) fn power(self) -> String {
        let arguments = ["base", "exponent"].map(|name| self.declared(name, self.kind(Kind::Number)));
        let phrase = |text: &str| Phrase { text: text.into(), tightness: Tightness::Comparison };
        let above = phrase("pow(max(base, 1.1754944e-38), exponent)");
        let at_zero =
            self.select([&phrase("0.0 < exponent"), &Phrase::constant(0.0), &Phrase::constant(1.0)]);
        let value = self.select([&phrase("0.0 < base"), &above, &at_zero]);
        let opening = self.opening("power", &arguments.join(", "), self.kind(Kind::Number));
        format!("// base^exponent; a base below 0 counts as 0.\n{opening}    return {};\n}}\n", value.text)
    }
}

/// The hand-written text in a language.
///
/// The code that joins recorded functions is written once, in the subset of GLSL ES that has a word-for-word
/// counterpart: functions without overloads, values declared where they are computed (with `mut` before those that
/// change), `if` and `for`.
pub(crate) fn translated(text: &str, language: Language) -> String {
    match language {
        Language::GlslEs => text.replace("mut ", ""),
        Language::Wgsl => text.lines().map(|line| wgsl_line(line) + "\n").collect(),
    }
}

/// The words that differ between GLSL ES and WGSL.
const WORDS: [(&str, &str); 13] = [
    ("float", "f32"),
    ("int", "i32"),
    ("vec2", "vec2f"),
    ("vec3", "vec3f"),
    ("vec4", "vec4f"),
    ("mat4", "mat4x4f"),
    ("ivec2", "vec2i"),
    ("dFdx", "dpdx"),
    ("dFdy", "dpdy"),
    ("atan", "atan2"),
    ("texelFetch", "textureLoad"),
    ("textureLod", "textureSampleLevel"),
    ("textureSize", "textureDimensions"),
];

/// The functions whose first argument is a texture with its sampler.
const SAMPLED: [&str; 2] = ["textureSampleLevel(", "texel("];

fn wgsl_line(line: &str) -> String {
    let (indent, rest) = line.split_at(line.len() - line.trim_start().len());
    if rest.starts_with("//") {
        return line.into();
    }
    let statement = match rest.strip_suffix(") {") {
        Some(opening) if indent.is_empty() => function(opening),
        _ => declared(rest),
    };
    format!("{indent}{}", sampled(worded(&statement)))
}

/// The first line of a function: `vec3 name(vec3 a, float b` becomes `fn name(a: vec3, b: float) -> vec3 {`.
fn function(opening: &str) -> String {
    let (head, arguments) = opening.split_once('(').unwrap_or((opening, ""));
    let (result, name) = head.split_once(' ').unwrap_or(("", head));
    let arguments: Vec<String> =
        arguments.split(", ").filter(|each| !each.is_empty()).map(argument).collect();
    format!("fn {name}({}) -> {result} {{", arguments.join(", "))
}

fn argument(argument: &str) -> String {
    match argument.split_once(' ') {
        Some(("sampler2D", name)) => format!("{name}: texture_2d<f32>, {name}_sampler: sampler"),
        Some((kind, name)) => format!("{name}: {kind}"),
        None => argument.into(),
    }
}

/// A declaration: `vec3 name = value;` becomes `let name = value;`.
fn declared(statement: &str) -> String {
    if let Some(rest) = statement.strip_prefix("for (int ") {
        return format!("for (var {rest}");
    }
    let (word, rest) = match statement.strip_prefix("mut ") {
        Some(rest) => ("var", rest),
        None => ("let", statement),
    };
    let Some((left, value)) = rest.split_once(" = ") else { return statement.into() };
    match left.split_once(' ') {
        Some((_, name)) if !name.contains([' ', '(']) => format!("{word} {name} = {value}"),
        _ => statement.into(),
    }
}

/// The statement with WGSL's words.
fn worded(statement: &str) -> String {
    let mut text = String::new();
    let mut word = String::new();
    let flush = |word: &mut String, text: &mut String| {
        let known = WORDS.iter().find(|(glsl, _)| glsl == word);
        text.push_str(known.map_or(word.as_str(), |(_, wgsl)| wgsl));
        word.clear();
    };
    for letter in statement.chars() {
        if letter.is_alphanumeric() || letter == '_' {
            word.push(letter);
        } else {
            flush(&mut word, &mut text);
            text.push(letter);
        }
    }
    flush(&mut word, &mut text);
    text
}

/// The statement with samplers after sampled textures, and without the level of `textureDimensions`.
fn sampled(mut statement: String) -> String {
    for call in SAMPLED {
        let mut from = 0;
        while let Some(found) = statement[from..].find(call) {
            let start = from + found;
            let is_word = statement[..start].ends_with(|c: char| c.is_alphanumeric() || c == '_');
            let name_at = start + call.len();
            let length = statement[name_at..].find(',').unwrap_or_default();
            let name = statement[name_at..name_at + length].to_owned();
            from = name_at + length;
            let is_argument = name.contains(' ') || name.contains(':');
            if !is_word && !is_argument && length > 0 {
                statement.insert_str(from, &format!(", {name}_sampler"));
            }
        }
    }
    without_level(statement)
}

fn without_level(statement: String) -> String {
    let Some((before, after)) = statement.split_once("textureDimensions(") else { return statement };
    format!("{before}textureDimensions({}", after.replacen(", 0)", ")", 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_and_values_become_those_of_wgsl() {
        let glsl = "vec4 texel(sampler2D map, Coordinates at) {
    // The vec2 stays here.
    vec2 size = vec2(textureSize(map, 0));
    mut float level = level_of(at, size);
    if (level < 0.0) {
        level = 0.0;
    }
    for (int i = 0; i < int(level); i++) {
        level += 1.0;
    }
    return textureLod(map, at.uv, level);
}
";
        let wgsl = "fn texel(map: texture_2d<f32>, map_sampler: sampler, at: Coordinates) -> vec4f {
    // The vec2 stays here.
    let size = vec2f(textureDimensions(map));
    var level = level_of(at, size);
    if (level < 0.0) {
        level = 0.0;
    }
    for (var i = 0; i < i32(level); i++) {
        level += 1.0;
    }
    return textureSampleLevel(map, map_sampler, at.uv, level);
}
";
        assert_eq!(translated(glsl, Language::Wgsl), wgsl);
        assert!(translated(glsl, Language::GlslEs).contains("    float level = level_of(at, size);\n"));
        let call = translated("    vec4 a = texel(x_texture, uv0);\n", Language::Wgsl);
        assert_eq!(call, "    let a = texel(x_texture, x_texture_sampler, uv0);\n");
    }
}
