//! Names, counts, numbers, layers of materials and hints, as text.

use crate::console;
use taotie::inspection::{Hint, LayerReport, MaterialReport};
use taotie_engine::names::Named;
use taotie_engine::scene::{FactorValue, LAYERS, Layer, Material};
use taotie_engine::surface::{GreenVerdict, NormalMapKind};

/// Length above which names are shortened, characters.
const NAME: usize = 40;

/// Length above which other text of a file is shortened, characters.
const TEXT: usize = 400;

/// Returns at most [`TEXT`] characters of a file's text, without control characters, which could control the
/// terminal.
pub fn clean(text: &str) -> String {
    cut(text, TEXT)
}

/// Returns at most [`NAME`] characters.
pub fn short(name: &str) -> String {
    cut(name, NAME)
}

/// Returns at most `most` characters, without those that could control the terminal.
fn cut(text: &str, most: usize) -> String {
    if text.len() <= most && text.bytes().all(|byte| (b' '..=b'~').contains(&byte)) {
        return text.to_owned();
    }
    match text.char_indices().nth(most) {
        Some(_) => console::plain(&text.chars().take(most - 1).chain(['…']).collect::<String>()),
        None => console::plain(text),
    }
}

/// Returns `yes` or `no`.
pub fn yes_or_no(there: bool) -> String {
    if there { "yes".into() } else { "no".into() }
}

/// Formats digits in groups of three.
pub fn thousands(count: impl ToString) -> String {
    let digits = count.to_string();
    let start = digits.len() % 3;
    let (first, rest) = digits.split_at(start);
    let groups = rest.as_bytes().chunks(3).map(|group| String::from_utf8_lossy(group).into_owned());
    let groups = std::iter::once(first.to_owned()).filter(|first| !first.is_empty()).chain(groups);
    groups.collect::<Vec<_>>().join(",")
}

/// Formats a fraction as per cent.
pub fn percent(fraction: f64) -> String {
    format!("{:.1} %", 100.0 * fraction)
}

/// Formats numbers, separated by spaces.
pub fn numbers(values: &[f64]) -> String {
    values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(" ")
}

/// Formats about six digits, without trailing zeros.
pub fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e9).contains(&value.abs()) {
        return format!("{value:.4e}");
    }
    let decimals = match value.abs() {
        large if large >= 1e5 => 0,
        large if large >= 1e2 => 3,
        _ => 6,
    };
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

/// Returns a suggestion, or `None` if this program has no option for it.
pub fn hint(hint: &Hint) -> Option<String> {
    Some(match hint {
        Hint::NoNormalMap { material } => {
            format!("the pixels of the normal map of '{material}' do not look like normals")
        }
        Hint::OtherSpace { material, drawn, by_pixels } => {
            let (drawn, kind) = (drawn.name(), by_pixels.name());
            format!(
                "the pixels of the normal map of '{material}' look {kind}-space, but it is drawn as {drawn}-space; \
                 use --normal-map FILE --normal-space {kind}"
            )
        }
        Hint::OtherGreen { material, drawn, by_pixels } => {
            let (drawn, found) = (drawn.name(), by_pixels.name());
            format!(
                "the pixels of the normal map of '{material}' look green-{found}, but it is drawn green-{drawn}; \
                 try --green {found}"
            )
        }
        Hint::FarFromMikkTSpace { mesh, mean_degrees } => format!(
            "the tangents of '{mesh}' are {mean_degrees:.1} degrees from MikkTSpace's on average; \
             if the map was baked for MikkTSpace, try --tangents mikktspace"
        ),
        _ => return None,
    })
}

/// The kind of a normal map.
pub fn kind(kind: NormalMapKind) -> &'static str {
    match kind {
        NormalMapKind::Tangent => "tangent-space",
        NormalMapKind::Object => "object-space",
        NormalMapKind::No => "not a normal map",
    }
}

/// The green direction that pixels indicate.
pub fn verdict(verdict: GreenVerdict) -> &'static str {
    match verdict {
        GreenVerdict::Up => "up",
        GreenVerdict::Down => "down",
        GreenVerdict::Unclear => "unclear",
    }
}

/// Returns the differences from a plain material.
pub fn layers(material: &MaterialReport) -> Vec<String> {
    let ior = (material.ior != 1.5).then(|| format!("ior {}", material.ior));
    let layers = LAYERS.iter().zip(&material.layers).flat_map(|(layer, report)| differences(layer, report));
    ior.into_iter().chain(layers).collect()
}

/// Returns an optional layer in one text, or the factors of another that differ from the default.
fn differences(layer: &Layer, report: &LayerReport) -> Vec<String> {
    match report.values.split_first() {
        None => Vec::new(),
        Some(((_, first), others)) if layer.is_optional() => {
            let others: String = others.iter().map(|(name, value)| further(name, *value)).collect();
            vec![format!("{} {}{others}", layer.name, text(*first))]
        }
        _ => {
            let plain = Material::default();
            let values = layer.factors.iter().zip(&report.values);
            let others = values.filter(|(factor, (_, value))| (factor.get)(&plain) != *value);
            others.map(|(factor, (_, value))| format!("{} {}", factor.name, text(*value))).collect()
        }
    }
}

/// Returns a value of a layer after its first.
fn further(name: &str, value: Option<FactorValue>) -> String {
    match value {
        None => String::new(),
        Some(FactorValue::Angle(_)) => format!(" at {}", text(value)),
        Some(_) if name == "normal_scale" => format!(" and normal map scale {}", text(value)),
        Some(_) => format!(" with {} {}", name.replace('_', " "), text(value)),
    }
}

fn text(value: Option<FactorValue>) -> String {
    match value {
        None => String::new(),
        Some(FactorValue::Number(number)) => number.to_string(),
        Some(FactorValue::Color(color)) => color.map(|v| v.to_string()).join(" "),
        Some(FactorValue::Angle(angle)) => format!("{:.1}°", angle.to_degrees()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        let counts = [0, 999, 1000, 1_234_567].map(thousands);
        assert_eq!(counts, ["0", "999", "1,000", "1,234,567"]);
        let values = [0.0, -0.0, 1.0, 0.1_f64 + 0.2, -1234.5678, 1.5e-7, 123_456.7, 1e12].map(number);
        assert_eq!(values, ["0", "0", "1", "0.3", "-1234.568", "1.5000e-7", "123457", "1.0000e12"]);
        assert_eq!(percent(1.0 / 3.0), "33.3 %");
    }

    #[test]
    fn names_cannot_rule_the_terminal() {
        assert_eq!(clean("a\u{1b}[31m\nb"), "a\u{fffd}[31m\u{fffd}b");
        assert_eq!(short(&"x".repeat(50)).chars().count(), NAME);
        assert_eq!(short("Suzanne"), "Suzanne");
        assert_eq!(clean(&"x".repeat(1 << 17)).chars().count(), TEXT);
    }
}
