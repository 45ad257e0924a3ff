//! The tables, histogram and texts of a proof.

use super::{levels, material, parts};
use crate::summary::figures;
use crate::{Cell, Column, Section, Series, Tone};
use taotie::asset::{BIN_WIDTH, FigureUnit, Figures, Met, Report, StageTime, ViewFigures};
use taotie::compare::Summary;
use taotie::names::Named;

/// Makes all sections in order.
pub fn sections(report: &Report, proof: &Figures) -> Vec<Section> {
    let mut sections = Vec::new();
    if !report.required.is_empty() {
        sections.push(required(report));
    }
    sections.extend([normals(proof), histogram(proof), shape(proof)]);
    sections.extend(material::section(&proof.material));
    sections.extend(parts::table(&proof.parts));
    sections.push(views(proof));
    sections.extend(levels::table(&proof.levels));
    if !report.stages.is_empty() {
        sections.push(stages(report));
    }
    sections
}

fn required(report: &Report) -> Section {
    Section::Table {
        title: "Required".into(),
        note: "The figures demanded by --require. Level 0 is the finest level of detail.".into(),
        columns: vec![
            Column::words("figure"),
            Column::words("level"),
            Column::numbers("value", ""),
            Column::numbers("at most", ""),
            Column::words("unit"),
            Column::words("result"),
        ],
        rows: report.required.iter().map(row_of_requirement).collect(),
    }
}

fn row_of_requirement(met: &Met) -> Vec<Cell> {
    let (text, tone) = if met.met { ("met", Tone::Good) } else { ("not met", Tone::Bad) };
    let FigureUnit { name, size } = met.figure.unit();
    let (value, most) = (met.value.map(|value| value / size), met.most / size);
    let digits = digits(met.met, value.unwrap_or(most), most);
    vec![
        Cell::text(met.figure.name()),
        Cell::text(met.level.map_or("all".into(), |level| level.to_string())),
        value.map_or_else(|| Cell::text("not measured"), |value| Cell::number(value, digits)),
        Cell::number(most, digits),
        Cell::text(name),
        Cell::Mark { text: text.into(), tone, why: String::new() },
    ]
}

/// Returns the digits behind the point of a value and its limit: four, and as many more as it takes to see that a value
/// which is too large is larger.
fn digits(met: bool, value: f64, most: f64) -> usize {
    const FEW: usize = 4;
    /// As many as tell any two numbers from 0.1 on apart.
    const ALL: usize = 17;
    let differ = |digits: &usize| format!("{value:.digits$}") != format!("{most:.digits$}");
    if met || value <= most { FEW } else { (FEW..ALL).find(differ).unwrap_or(ALL) }
}

fn normals(proof: &Figures) -> Section {
    let mut columns = vec![Column::words("figure")];
    columns.extend(["mean", "median", "95 %", "max"].map(|name| Column::numbers(name, "°")));
    let rows = [("normal error", &proof.angles), ("error without normal map", &proof.without_map)];
    let row = |(name, summary): (&str, &Option<Summary>)| {
        let numbers = figures(summary.as_ref()?).map(|value| Cell::number(value, 3));
        Some([Cell::text(name)].into_iter().chain(numbers).collect())
    };
    Section::Table {
        title: "Normal error".into(),
        note: note_of_normals(proof),
        columns,
        rows: rows.into_iter().filter_map(row).collect(),
    }
}

fn note_of_normals(proof: &Figures) -> String {
    let note = "The angle between the normals of asset and scan, at points spread evenly over the asset as it was \
                written and read back.";
    match proof.floor_8_bit {
        Some([mean, most]) => format!(
            "{note} Storing normals in 8 bits alone costs {mean}° on average and {most}° at most; dithering raises the \
             average a little and removes the steps in gentle curves."
        ),
        None => note.into(),
    }
}

fn histogram(proof: &Figures) -> Section {
    Section::Histogram {
        title: "Histogram of normal error".into(),
        note: "Points by their normal error; the last bin holds all that is larger.".into(),
        unit: "°".into(),
        bin_width: BIN_WIDTH,
        last_is_open: true,
        series: vec![Series { label: "asset".into(), counts: proof.histogram.clone() }],
    }
}

fn shape(proof: &Figures) -> Section {
    let row = |name: &str, value: f64, digits: usize, unit: &str| {
        vec![Cell::text(name), Cell::number(value, digits), Cell::text(unit)]
    };
    let mut rows = vec![
        row("shape error, largest (Hausdorff distance)", proof.hausdorff, 6, "model units"),
        row("shape error, largest", proof.hausdorff_of_diagonal * 100.0, 4, "% of the diagonal"),
        row("shape error, root mean square", proof.rms, 6, "model units"),
        row("shape error, root mean square", proof.rms_of_diagonal * 100.0, 4, "% of the diagonal"),
        row("texels with a missed ray", proof.missed_texels * 100.0, 4, "%"),
        row("samples whose ray missed (closest point used)", proof.fallback * 100.0, 4, "%"),
        row("samples with no hit (low-poly normal used)", proof.lost * 100.0, 4, "%"),
        row("map covered by UV islands", proof.uv_use * 100.0, 1, "%"),
    ];
    if let Some(density) = &proof.density {
        rows.push(row("texel density, median", density.median, 2, "texels per unit"));
    }
    Section::Table {
        title: "Shape, rays and map".into(),
        note: "The shape error is the distance from points spread evenly over each surface to the other. A ray misses \
               where it meets no surface of the scan that faces it."
            .into(),
        columns: vec![Column::words("figure"), Column::numbers("value", ""), Column::words("unit")],
        rows,
    }
}

fn views(proof: &Figures) -> Section {
    let row = |(look, view): (&str, &ViewFigures)| {
        vec![
            Cell::text(look),
            Cell::number(view.azimuth_deg, 0),
            Cell::number(view.elevation_deg, 0),
            Cell::number(view.flip, 4),
            Cell::number(view.ssim, 4),
        ]
    };
    let grey = proof.views.iter().map(|view| ("grey", view));
    let full = proof.full_views.iter().map(|view| ("full", view));
    Section::Table {
        title: "Visual difference".into(),
        note: "Pictures of scan and asset, compared pixel by pixel: FLIP is 0 and SSIM is 1 where they are equal. Both \
               also count where the low-poly mesh lies beside the scan. Grey pictures show shape and normals alone; \
               full ones the materials of both, where the scan says anything of its own."
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

    #[test]
    fn what_is_required_is_told_in_its_unit() {
        let mut figures = Figures::default();
        figures.missed_texels = 0.02;
        let row = |requirement| row_of_requirement(&figures.require(&[requirement])[0]);
        let missed = row(Requirement::missed(0.001));
        let wanted = [Cell::text("missed"), Cell::text("all"), Cell::number(2.0, 4), Cell::number(0.1, 4)];
        assert_eq!((&missed[..4], &missed[4]), (&wanted[..], &Cell::text("%")));
        let angle = row(Requirement::mean_angle_deg(1.0).at_level(2));
        assert_eq!((&angle[1], &angle[2]), (&Cell::text("2"), &Cell::text("not measured")));
    }
    #[test]
    fn a_value_that_is_too_large_looks_larger() {
        let mut figures = Figures::default();
        figures.missed_texels = 0.001_234_12;
        let row = |most| row_of_requirement(&figures.require(&[Requirement::missed(most)])[0]);
        let told = |most| {
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
        assert_eq!(told(0.001_234_1), ["0.123412", "0.123410"]);
        assert_eq!(told(0.001), ["0.1234", "0.1000"]);
        assert_eq!(told(0.001_234_2), ["0.1234", "0.1234"], "it is met");
        let [value, most] = told(f64::from_bits(0.001_234_12f64.to_bits() - 1));
        assert_ne!(value, most);
    }
}
