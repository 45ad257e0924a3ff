//! The figures of a bake, out of its report.

use serde_json::{Value, json};

/// Beginnings of warnings that the list of what is left out holds already.
const TOLD_ALREADY: &str = "left out: the scan's ";
/// What warnings of something lost say.
const WORDS: [&str; 4] = ["ignored", "left out", "lost", "baked at rest"];

/// What is told of a bake.
#[derive(Debug, PartialEq)]
pub struct Baked {
    /// Triangles of scan and asset.
    pub triangles: [u64; 2],
    /// Bytes of scan and asset, each with all its files.
    pub bytes: [u64; 2],
    /// Degrees between the normals shown and the scan's: mean, and 95 % quantile; `None` where there was no point.
    pub angles: Option<[f64; 2]>,
    /// The mean of CIEDE2000; `None` where the scan says nothing of its material.
    pub color: Option<f64>,
    /// The properties that the asset has.
    pub carried: Vec<String>,
    /// Those that it has not, and other losses that are told.
    pub lost: Vec<String>,
}

impl Baked {
    /// Reads a report; `None` where it lacks a figure.
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

    /// The same as JSON.
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

/// Properties left out, each with its part of the surface.
fn left(list: &Value) -> Option<Vec<String>> {
    let text =
        |left: &Value| Some(format!("{} ({:.1} %)", left["what"].as_str()?, left["part"].as_f64()? * 100.0));
    list.as_array()?.iter().map(text).collect()
}

/// Warnings of something lost, each with its count where that is not 1.
fn losses(list: &Value) -> Option<Vec<String>> {
    let texts = list.as_array()?.iter().map(|warning| {
        let (what, count) = (warning["what"].as_str()?, warning["count"].as_u64()?);
        Some(if count == 1 { what.to_owned() } else { format!("{what} ({count} times)") })
    });
    let is_loss =
        |what: &String| WORDS.iter().any(|word| what.contains(word)) && !what.starts_with(TOLD_ALREADY);
    let texts: Option<Vec<String>> = texts.collect();
    Some(texts?.into_iter().filter(is_loss).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_tells_its_figures_and_losses() {
        let report = json!({
            "high_triangles": 4510, "triangles": [451, 90],
            "carried": ["base colour"], "left": [{"what": "clearcoat", "part": 0.25}],
            "proof": {
                "bytes_in": 9000, "bytes_out": 800, "angles": {"mean": 1.5, "p95": 4.0},
                "material": {"color": null},
            },
            "warnings": [
                {"count": 1, "what": "left out: the scan's clearcoat, on 25.0 % of its surface"},
                {"count": 2, "what": "small parts, left out since so few triangles were wanted"},
                {"count": 1, "what": "the extension KHR_materials_transmission is ignored"},
                {"count": 5, "what": "open (boundary) edges of the scan"},
            ],
        });
        let lost = [
            "clearcoat (25.0 %)",
            "small parts, left out since so few triangles were wanted (2 times)",
            "the extension KHR_materials_transmission is ignored",
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
