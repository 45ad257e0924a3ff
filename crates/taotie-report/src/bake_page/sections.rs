//! The tables, histogram and texts of a proof page.

use super::breakdown;
use crate::table::{figures, sizes_text};
use crate::{Cell, Column, Section, Series, Tone};
use taotie::asset::{
    BakeFigures, FigureUnit, Figures, LevelFigures, MaterialFigures, PartFlip, Report, RequirementOutcome,
    StageTime, ViewFigures,
};
use taotie_engine::compare::Summary;
use taotie_engine::length::{ShownLength, Unit, dpi};
use taotie_engine::proof::Estimate;
use taotie_engine::surface::Noise;

/// Builds all sections in order.
pub fn sections(report: &Report, (proof, flips): (&Figures, &[PartFlip])) -> Vec<Section> {
    let mut sections = Vec::new();
    if report.triangles.len() > 1 && !report.required().is_empty() {
        sections.push(required(report));
    }
    if let Some(finest) = proof.finest() {
        sections.push(as_seen(finest));
        sections.extend(breakdown::worst_parts(proof, &finest.worst_parts, flips));
        sections.extend(breakdown::beyond(&finest.beyond));
        sections.extend([shape(finest, proof.unit), on_surface(report, finest), histogram(finest)]);
        sections.extend(color_and_material(&finest.material));
        sections.extend(breakdown::materials(&proof.parts));
        sections.push(views(finest));
    }
    sections.extend(breakdown::levels(&proof.levels));
    sections.extend(breakdown::maps(report));
    sections.extend(report.bake.as_ref().map(|bake| rays(report, bake)));
    sections.extend(report.noise.as_ref().map(|noise| scanner_noise(noise, proof.unit)));
    if !report.stages.is_empty() {
        sections.push(stages(report));
    }
    sections
}

fn required(report: &Report) -> Section {
    Section::Table {
        title: "Requirements by level".into(),
        note: "The result of each requirement at each level of detail; level 0 is the finest.".into(),
        columns: vec![
            Column::words("figure"),
            Column::words("level"),
            Column::numbers("value", ""),
            Column::numbers("limit", ""),
            Column::words("unit"),
            Column::words("result"),
        ],
        rows: report.required().iter().map(row_of_requirement).collect(),
    }
}

fn row_of_requirement(met: &RequirementOutcome) -> Vec<Cell> {
    let (text, tone) = match met.met {
        true => ("met", Tone::Good),
        false if met.is_undecided() => ("undecided", Tone::Bad),
        false => ("not met", Tone::Bad),
    };
    let FigureUnit { name, size } = met.unit();
    let (value, most) = (met.value.map(|value| value / size), met.most / size);
    let digits = digits(met.met, value.unwrap_or(most), most);
    vec![
        Cell::text(met.name()),
        Cell::text(met.level.map_or("all".into(), |level| level.to_string())),
        value.map_or_else(|| Cell::text("not measured"), |value| Cell::number(value, digits)),
        Cell::number(most, digits),
        Cell::text(name),
        Cell::Mark { text: text.into(), tone, why: String::new() },
    ]
}

/// Returns the number of decimals for a value and its limit: four, or more if needed to show that a value beyond the
/// limit differs from it.
fn digits(met: bool, value: f64, most: f64) -> usize {
    const FEW: usize = 4;
    /// Enough to distinguish any two numbers of at least 0.1.
    const ALL: usize = 17;
    let differ = |digits: &usize| format!("{value:.digits$}") != format!("{most:.digits$}");
    if met || value == most { FEW } else { (FEW..ALL).find(differ).unwrap_or(ALL) }
}

fn quantiles(title: &str) -> Vec<Column> {
    let mut columns = vec![Column::words(title)];
    columns.extend(["mean", "median", "95 %", "max"].map(|name| Column::numbers(name, "")));
    columns
}

/// Builds the row for a summary; `None` if nothing was measured.
fn row_of_summary(name: &str, summary: Option<&Summary>) -> Option<Vec<Cell>> {
    let numbers = figures(summary?).map(|value| Cell::number(value, 3));
    Some([Cell::text(name)].into_iter().chain(numbers).collect())
}

fn as_seen(level: &LevelFigures) -> Section {
    let overview = &level.overview;
    let of = |estimate: &Option<Estimate>| estimate.as_ref().map(|estimate| estimate.summary);
    let mut rows: Vec<Vec<Cell>> = [
        row_of_summary("normals, overview (°)", of(&overview.angles).as_ref()),
        row_of_summary("colours, overview (ΔE00)", of(&overview.color).as_ref()),
        row_of_summary("metallic, roughness or occlusion, overview", of(&overview.material).as_ref()),
    ]
    .into_iter()
    .flatten()
    .collect();
    let patches = [
        ("normals, close-up, worst 1 % of the surface (°)", &level.patches.angle),
        ("colours, close-up, worst 1 % of the surface (ΔE00)", &level.patches.color),
        ("metallic, roughness or occlusion, close-up, worst 1 % of the surface", &level.patches.material),
        ("detail lost, close-up, worst 1 % of the surface", &level.patches.detail),
    ];
    for (name, patch) in patches {
        let Some(patch) = patch else { continue };
        let none = || Cell::Number { value: None, digits: 3 };
        rows.push(vec![Cell::text(name), Cell::number(patch.mean, 3), none(), none(), none()]);
    }
    Section::Table {
        title: "As seen: overview and close-up".into(),
        note: format!(
            "Differences between scan and asset at the same pixel, including parallax and texture filtering but not \
             outlines. Overview: {} random pixels from 32 fixed views in which the object fills 512 × 512 pixels. \
             Worst 1 %: the window covering 1 % of the visible surface with the largest mean, seen close up at the \
             resolution of the scan's detail. Maxima are over these samples.",
            overview.pixels
        ),
        columns: quantiles("figure"),
        rows,
    }
}

fn on_surface(report: &Report, level: &LevelFigures) -> Section {
    let rows = [("normal error", &level.surface_angles), ("error without normal map", &level.without_map)];
    Section::Table {
        title: "Normal error on the surface (°)".into(),
        note: note_of_normals(report.bake.as_ref()),
        columns: quantiles("figure"),
        rows: rows.into_iter().filter_map(|(name, summary)| row_of_summary(name, summary.as_ref())).collect(),
    }
}

fn note_of_normals(bake: Option<&BakeFigures>) -> String {
    let note = "The angle between the normals of asset and scan, at points spread evenly over the asset as written \
                and read back. Each point is compared with the point of the scan that its projection ray hits. \
                This is not what a viewer sees: parallax, filtering and silhouettes are not included.";
    match bake.and_then(|bake| bake.floor_8_bit) {
        Some([mean, most]) => format!(
            "{note} The error floor of 8-bit normals is {mean}° on average and {most}° at most; dithering raises the \
             average slightly but removes banding in gentle curves."
        ),
        None => note.into(),
    }
}

fn histogram(level: &LevelFigures) -> Section {
    Section::Histogram {
        title: "Histogram of normal error on the surface".into(),
        note: "Number of points by normal error; the last bin includes all larger errors.".into(),
        unit: "°".into(),
        bin_width: LevelFigures::BIN_WIDTH,
        last_is_open: true,
        series: vec![Series { label: "asset".into(), counts: level.histogram.clone() }],
    }
}

/// Builds the table of all differences between the materials; `None` if nothing was compared.
fn color_and_material(material: &MaterialFigures) -> Option<Section> {
    if material.color.is_none() && material.not_finite == 0.0 {
        return None;
    }
    let color = [("colour (CIEDE2000)", material.color)];
    Some(Section::Table {
        title: "Colour and material error on the surface".into(),
        note: note_of_material(material),
        columns: quantiles("figure"),
        rows: color
            .into_iter()
            .chain(material.numbers())
            .filter_map(|(name, summary)| row_of_summary(name, summary.as_ref()))
            .collect(),
    })
}

fn note_of_material(material: &MaterialFigures) -> String {
    let note = "Differences between the materials of asset and scan, at the points where normal errors are measured. \
                A CIEDE2000 difference of about 1 is just visible between adjacent colours. Baked roughness also \
                includes relief finer than a texel, which is counted as a difference here.";
    let part = material.not_finite * 100.0;
    if part == 0.0 {
        return note.into();
    }
    format!(
        "{note} At {part:.4} % of the points a value is not finite; such values are excluded from all figures."
    )
}

/// Builds the row for a number with its unit.
fn row_of_number(name: &str, value: f64, (digits, unit): (usize, &str)) -> Vec<Cell> {
    vec![Cell::text(name), Cell::number(value, digits), Cell::text(unit)]
}

/// Builds the row for a length on the scan, in a unit that suits its size.
fn row_of_length(name: &str, length: f64, unit: Option<Unit>) -> Vec<Cell> {
    let ShownLength { value, decimals, unit } = ShownLength::of(length, unit, 4);
    row_of_number(name, value, (decimals, unit))
}

fn numbers(title: &str, note: &str, rows: Vec<Vec<Cell>>) -> Section {
    Section::Table {
        title: title.into(),
        note: note.into(),
        columns: vec![Column::words("figure"), Column::numbers("value", ""), Column::words("unit")],
        rows,
    }
}

fn shape(level: &LevelFigures, unit: Option<Unit>) -> Section {
    let LevelFigures { hausdorff, hausdorff_of_diagonal, silhouette, coverage, .. } = level;
    let length = |name, value| row_of_length(name, value, unit);
    let of_diagonal = (4, "% of the diagonal");
    let percent = (4, "%");
    let row = row_of_number;
    let mut rows = vec![
        length("largest distance (Hausdorff), at least", hausdorff.lower),
        length("largest distance (Hausdorff), at most", hausdorff.upper),
        row("largest distance (Hausdorff), at most", hausdorff_of_diagonal.upper * 100.0, of_diagonal),
        length("root mean square distance", level.rms),
        row("root mean square distance", level.rms_of_diagonal * 100.0, of_diagonal),
        row("silhouette, mean deviation", silhouette.mean_pixels, (3, "pixels of 512")),
        row("silhouette, largest deviation", silhouette.max_pixels, (2, "pixels of 512")),
        length("silhouette, largest deviation", silhouette.max_length),
        row("scan without a counterpart on the asset", coverage.missed_of_scan * 100.0, percent),
        row("asset without a counterpart on the scan", coverage.missed_of_asset * 100.0, percent),
        row("scan within 0.5 % of the diagonal of the asset", coverage.completeness * 100.0, percent),
        row("hidden part of the scan", coverage.hidden_of_scan * 100.0, percent),
    ];
    if let Some(resolution) = &level.resolution {
        rows.push(length("texel, median width", resolution.texel));
        rows.extend(
            unit.map(|unit| row("texels, median resolution", dpi(resolution.texel, unit), (0, "dpi"))),
        );
        rows.push(row(
            "surface with texels over twice as coarse as the scan",
            resolution.share * 100.0,
            percent,
        ));
    }
    let note = "Distances between the visible surfaces, in both directions. The largest distance lies between two \
                proven bounds; all other figures are estimates from samples.";
    numbers("Shape and completeness", note, rows)
}

fn rays(report: &Report, bake: &BakeFigures) -> Section {
    let percent = (4, "%");
    let rows = vec![
        row_of_number("texels with a missed ray", bake.missed_texels * 100.0, percent),
        row_of_number("samples whose ray missed (closest point used)", bake.missed_samples * 100.0, percent),
        row_of_number("samples with no hit (low-poly normal used)", bake.lost_samples * 100.0, percent),
        row_of_number("map area covered by UV islands", bake.uv_use * 100.0, (1, "%")),
    ];
    let (sizes, carried) = (sizes_text(&report.sizes), report.carried.join(", "));
    let carried =
        if carried.is_empty() { carried } else { format!("Carried over from the scan: {carried}. ") };
    let maps = if sizes.is_empty() { sizes } else { format!("Maps of {sizes} texels. ") };
    let note = format!("{maps}{carried}A ray misses if it hits no surface of the scan that faces it.");
    numbers("The bake", &note, rows)
}

fn scanner_noise(noise: &Noise, unit: Option<Unit>) -> Section {
    let length = |name, value| row_of_length(name, value, unit);
    let mut rows = vec![
        length("standard deviation of vertices along the normals", noise.sigma),
        length("shortest wavelength that the vertices represent", noise.scale),
    ];
    let note = "Random differences between neighbouring vertices of the scan.";
    let Some(removed) = &noise.removed else {
        return numbers("Scanner noise", &format!("{note} The asset was made from the scan as given."), rows);
    };
    rows.push(length("displacement by its removal, root mean square", removed.rms));
    rows.push(row_of_number("change of the normals by its removal, mean", removed.mean_deg, (3, "°")));
    rows.push(row_of_number("change of the normals by its removal, 95 %", removed.p95_deg, (3, "°")));
    let note = format!(
        "{note} The asset was made from the scan without them. All other figures compare it with the scan as given, and \
         thus include what was removed."
    );
    numbers("Scanner noise", &note, rows)
}

fn views(level: &LevelFigures) -> Section {
    let row = |(look, view): (&str, &ViewFigures)| {
        vec![
            Cell::text(look),
            Cell::number(view.azimuth_deg, 0),
            Cell::number(view.elevation_deg, 0),
            Cell::number(view.flip, 4),
            Cell::number(view.ssim, 4),
        ]
    };
    let grey = level.views.iter().map(|view| ("grey", view));
    let full = level.full_views.iter().map(|view| ("full", view));
    Section::Table {
        title: "Visual difference in images".into(),
        note: "Renders of scan and asset, compared pixel by pixel; FLIP is 0 and SSIM is 1 for equal images. Both \
               include misalignment between the low-poly mesh and the scan. Grey images show only shape and \
               normals; full images show both with their materials, if the scan has any."
            .into(),
        columns: vec![
            Column::words("look"),
            Column::numbers("azimuth", "°"),
            Column::numbers("elevation", "°"),
            Column::numbers("FLIP", ""),
            Column::numbers("SSIM", ""),
        ],
        rows: grey.chain(full).map(row).collect(),
    }
}

fn stages(report: &Report) -> Section {
    let row = |stage: &StageTime| vec![Cell::text(stage.stage), Cell::number(stage.milliseconds, 1)];
    Section::Table {
        title: "Time".into(),
        note: String::new(),
        columns: vec![Column::words("stage"), Column::numbers("time", "ms")],
        rows: report.stages.iter().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie::asset::Requirement;

    /// One level with this share missed.
    fn missing(share: f64) -> Figures {
        let (mut figures, mut level) = (Figures::default(), LevelFigures::default());
        (level.coverage.missed_of_scan, level.coverage.missed_interval) = (share, [share; 2]);
        figures.levels.push(level);
        figures
    }

    #[test]
    fn requirements_are_shown_in_their_unit() {
        let figures = missing(0.02);
        let row = |requirement| row_of_requirement(&figures.evaluate(&[requirement])[0]);
        let missed = row(Requirement::missed(0.001));
        let wanted = [Cell::text("missed"), Cell::text("0"), Cell::number(2.0, 4), Cell::number(0.1, 4)];
        assert_eq!((&missed[..4], &missed[4]), (&wanted[..], &Cell::text("%")));
        let angle = row(Requirement::mean_angle_deg(1.0).at_level(2));
        assert_eq!((&angle[1], &angle[2]), (&Cell::text("2"), &Cell::text("not measured")));
    }

    #[test]
    fn a_value_that_is_too_large_looks_larger() {
        let figures = missing(0.001_234_12);
        let row = |most| row_of_requirement(&figures.evaluate(&[Requirement::missed(most)])[0]);
        let shown = |most| {
            let row = row(most);
            let [
                Cell::Number { value: Some(value), digits },
                Cell::Number { value: Some(most), digits: same },
            ] = row[2..4]
            else {
                panic!("{row:?}")
            };
            assert_eq!(digits, same);
            [value, most].map(|number| format!("{number:.digits$}"))
        };
        assert_eq!(shown(0.001_234_1), ["0.123412", "0.123410"]);
        assert_eq!(shown(0.001), ["0.1234", "0.1000"]);
        assert_eq!(shown(0.001_234_2), ["0.1234", "0.1234"], "the limit is met");
        let [value, most] = shown(f64::from_bits(0.001_234_12f64.to_bits() - 1));
        assert_ne!(value, most);
    }

    #[test]
    fn values_that_are_not_finite_are_reported() {
        let mut material = MaterialFigures::default();
        assert!(color_and_material(&material).is_none());
        material.not_finite = 0.25;
        let Some(Section::Table { note, .. }) = color_and_material(&material) else { panic!("no table") };
        assert!(note.contains("At 25.0000 % of the points"), "{note}");
    }
}
