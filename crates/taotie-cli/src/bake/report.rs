//! `OUT.report.json`: every parameter and every figure.

use super::args::{Auto, BakeArgs};
use super::proof::Proof;
use super::requirement::Met;
use super::stages::Stage;
use super::textures::MapNote;
use super::work::Origin;
use crate::studio::Space;
use serde::Serialize;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use taotie::names::Named;

/// Version of the report.
const SCHEMA: u32 = 1;

/// The file as a whole.
#[derive(Serialize)]
pub struct Report {
    /// Version of this layout.
    pub schema: u32,
    /// What kind of report this is.
    pub kind: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// The scan's file.
    pub high: String,
    /// The SHA-256 of its bytes.
    pub high_sha256: String,
    /// Its triangles.
    pub high_triangles: usize,
    /// The light mesh's file, or `None` where it was made.
    pub low: Option<String>,
    /// Where the light mesh came from.
    pub light: Origin,
    /// Triangles of each level of detail, the finest first.
    pub triangles: Vec<usize>,
    /// Texels across and down.
    pub size: [u32; 2],
    /// All else that was asked for.
    pub parameters: Value,
    /// The files written.
    pub files: Vec<PathBuf>,
    /// What each map is and where.
    pub maps: Vec<MapNote>,
    /// What was measured; `None` with `--no-verify`.
    pub proof: Option<Proof>,
    /// What was required.
    pub required: Vec<Met>,
    /// The trials of `--error`.
    pub trials: Vec<Trial>,
    /// How long each stage took.
    pub stages: Vec<Stage>,
    /// What is wrong or was put right.
    pub warnings: Value,
}

/// A mesh and a map that `--error` tried.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side.
    pub size: u32,
    /// The mean angle, degrees.
    pub mean_angle: f64,
}

impl Report {
    /// With nothing in it yet but what was asked for.
    pub fn begin(args: &BakeArgs) -> Self {
        Self {
            schema: SCHEMA,
            kind: "taotie bake",
            version: env!("CARGO_PKG_VERSION"),
            high: args.high.display().to_string(),
            high_sha256: String::new(),
            high_triangles: 0,
            low: args.low.as_ref().map(|path| path.display().to_string()),
            light: Origin::default(),
            triangles: Vec::new(),
            size: [args.size; 2],
            parameters: parameters(args),
            files: Vec::new(),
            maps: Vec::new(),
            proof: None,
            required: Vec::new(),
            trials: Vec::new(),
            stages: Vec::new(),
            warnings: Value::Null,
        }
    }

    /// Whether all that was required is met.
    pub fn is_met(&self) -> bool {
        self.required.iter().all(|met| met.met)
    }

    /// For people.
    pub fn text(&self) -> String {
        let triangles: Vec<String> = self.triangles.iter().map(ToString::to_string).collect();
        let mut text = format!(
            "{} triangles onto {}, maps of {}×{}",
            self.high_triangles,
            triangles.join(", "),
            self.size[0],
            self.size[1]
        );
        if let Some(proof) = &self.proof {
            let _ = write!(text, "\n{}", proof.text());
        }
        for met in &self.required {
            let verdict = if met.met { "met" } else { "NOT met" };
            let value = met.value.map_or("could not be measured".into(), |value| format!("is {value:.4}"));
            let _ =
                write!(text, "\n{:<12} {verdict}: {} {value}, at most {}", "required", met.figure, met.most);
        }
        for file in &self.files {
            let _ = write!(text, "\nwrote {}", file.display());
        }
        text
    }
}

impl Proof {
    fn text(&self) -> String {
        let percent = |part: f64| format!("{:.3} %", part * 100.0);
        let mut text = String::new();
        if let Some(angles) = &self.angles {
            let _ = writeln!(text, "{:<12} {}", "normals off", angles.text(3, "°"));
            let [mean, _] = self.floor_8_bit;
            let _ = writeln!(text, "{:<12} {mean}° is what 8 bits cost at least", "");
        }
        if let Some(plain) = &self.without_map {
            let _ = writeln!(text, "{:<12} mean {:.3}° by vertex normals alone", "without map", plain.mean);
        }
        let _ = writeln!(
            text,
            "{:<12} {} of the texels, {} of the samples; {} found nothing",
            "missed",
            percent(self.missed_texels),
            percent(self.fallback),
            percent(self.lost)
        );
        let _ = writeln!(
            text,
            "{:<12} at most {:.4} ({} of the diagonal), RMS {:.5} ({})",
            "shape off",
            self.hausdorff,
            percent(self.hausdorff_of_diagonal),
            self.rms,
            percent(self.rms_of_diagonal)
        );
        if let Some(density) = &self.density {
            let _ = writeln!(
                text,
                "{:<12} {:.1} a model unit (median), {} of the map used",
                "texels",
                density.median,
                percent(self.uv_use)
            );
        }
        let mean = |of: fn(&super::proof::ViewFigures) -> f64| {
            self.views.iter().map(of).sum::<f64>() / self.views.len().max(1) as f64
        };
        let _ = writeln!(
            text,
            "{:<12} FLIP {:.4}, SSIM {:.4}, mean of {} views",
            "seen",
            mean(|v| v.flip),
            mean(|v| v.ssim),
            self.views.len()
        );
        let _ = write!(text, "{:<12} {} in, {} out", "bytes", self.bytes_in, self.bytes_out);
        text
    }
}

/// All that was asked for.
pub fn parameters(args: &BakeArgs) -> Value {
    let auto = |value: Option<f64>| value.map_or(json!("auto"), |value| json!(value));
    json!({
        "triangles": (args.low.is_none() && args.error.is_none()).then_some(args.triangles),
        "error_deg": args.error,
        "lods": args.lods,
        "size": args.error.is_none().then_some(args.size),
        "maps": args.maps.iter().map(|map| map.name()).collect::<Vec<_>>(),
        "space": match args.space { Space::Tangent => "tangent", Space::Object => "object" },
        "samples": args.side() * args.side(),
        "bits": args.bits(),
        "dilation": auto(match args.dilation { Auto::Auto => None, Auto::Given(texels) => Some(f64::from(texels)) }),
        "ao_rays": args.ao_rays,
        "ao_distance": args.ao_distance,
        "roughness": args.roughness,
        "ray_distance": auto(match args.ray_distance { Auto::Auto => None, Auto::Given(distance) => Some(distance) }),
        "cage": args.cage.as_ref().map(|path| path.display().to_string()),
        "images": if args.ktx2 { "ktx2" } else if args.webp { "webp" } else { "png" },
        "meshopt": args.meshopt,
    })
}
