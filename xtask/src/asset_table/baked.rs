//! The figures of a bake, read from its report.

use serde_json::{Value, json};

/// The start of warnings about properties that are already listed as left out.
const ALREADY_LISTED: &str = "left out: the scan's ";
/// Words in warnings about losses.
const WORDS: [&str; 6] = ["ignored", "skipped", "dropped", "left out", "lost", "baked at rest"];

/// The figures of a bake.
#[derive(Debug, PartialEq)]
pub struct Baked {
    /// The triangles of scan and asset.
    pub triangles: [u64; 2],
    /// The bytes of scan and asset, each with all its files.
    pub bytes: [u64; 2],
    /// The degrees between the normals of asset and scan: mean and 95th percentile; `None` if there were no points.
    pub angles: Option<[f64; 2]>,
    /// The mean CIEDE2000 difference; `None` if the scan does not specify its material.
    pub color: Option<f64>,
    /// The properties carried over to the asset.
    pub carried: Vec<String>,
    /// The properties that the asset lacks, and other reported losses.
    pub lost: Vec<String>,
}

impl Baked {
    /// Reads a report; `None` if a figure is missing.
    pub fn of(report: &Value) -> Option<Self> {
        let whole = |path: &str| report.pointer(path)?.as_u64();
        let number = |path: &str| report.pointer(path)?.as_f64();
        let mean = number("/proof/angles/mean");
        Some(Self {
            triangles: [whole("/high_triangles")?, whole("/triangles/0")?],
            bytes: [whole("/proof/bytes_in")?, whole("/proof/bytes_out")?],
            angles: mean.zip(number("/proof/angles/p95")).map(|(mean, p95)| [mean, p95]),
            color: number("/proof/material/color/mean"),
            carried: texts(report.get("carried")?)?,
            lost: [left(report.get("left")?)?, losses(report.get("warnings")?)?].concat(),
        })
    }

    /// Returns the figures as JSON.
    pub fn json(&self) -> Value {
        let Self { triangles, bytes, angles, color, carried, lost } = self;
        json!({
            "triangles": triangles, "bytes": bytes, "angles": angles, "color": color,
            "carried": carried, "lost": lost,
        })
    }
}

fn texts(list: &Value) -> Option<Vec<String>> {
    list.as_array()?.iter().map(|text| text.as_str().map(str::to_owned)).collect()
}

/// Returns the properties left out, each with its share of the surface.
fn left(list: &Value) -> Option<Vec<String>> {
    let text =
        |left: &Value| Some(format!("{} ({:.1} %)", left["what"].as_str()?, left["part"].as_f64()? * 100.0));
    list.as_array()?.iter().map(text).collect()
}

/// Returns the warnings about losses, each with its count if that is not 1.
fn losses(list: &Value) -> Option<Vec<String>> {
    let texts = list.as_array()?.iter().map(|warning| {
        let (what, count) = (warning["what"].as_str()?, warning["count"].as_u64()?);
        Some(if count == 1 { what.to_owned() } else { format!("{what} ({count} times)") })
    });
    let is_loss =
        |what: &String| WORDS.iter().any(|word| what.contains(word)) && !what.starts_with(ALREADY_LISTED);
    let texts: Option<Vec<String>> = texts.collect();
    Some(texts?.into_iter().filter(is_loss).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_and_losses_are_read_from_a_report() {
        let report = json!({
            "high_triangles": 4510, "triangles": [451, 90],
            "carried": ["base colour"], "left": [{"what": "clearcoat", "part": 0.25}],
            "proof": {
                "bytes_in": 9000, "bytes_out": 800, "angles": {"mean": 1.5, "p95": 4.0},
                "material": {"color": null},
            },
            "warnings": [
                {"count": 1, "what": "left out: the scan's clearcoat, on 25.0 % of its surface"},
                {"count": 2, "what": "small parts, left out because too few triangles were requested"},
                {"count": 1, "what": "ignored extension KHR_materials_transmission"},
                {"count": 5, "what": "open (boundary) edges of the scan"},
            ],
        });
        let lost = [
            "clearcoat (25.0 %)",
            "small parts, left out because too few triangles were requested (2 times)",
            "ignored extension KHR_materials_transmission",
        ];
        let expected = Baked {
            triangles: [4510, 451],
            bytes: [9000, 800],
            angles: Some([1.5, 4.0]),
            color: None,
            carried: vec!["base colour".into()],
            lost: lost.map(str::to_owned).into(),
        };
        assert_eq!(Baked::of(&report), Some(expected));
        let unproved = json!({"high_triangles": 1, "triangles": [1], "proof": null});
        assert_eq!(Baked::of(&unproved), None);
    }
}
