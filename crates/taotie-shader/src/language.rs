//! The syntax of the languages.

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
