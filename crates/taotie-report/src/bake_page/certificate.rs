//! The certificate as the opening statement of a page.

use crate::{Cell, Column, Fact, Notice, PlainTable, Statement, Tone};
use taotie::asset::{
    Certificate, Figure, FigureUnit, HashedFile, HashedMap, KeyFigure, RequirementOutcome, ScanOptions,
    Verdict,
};
use taotie_engine::names::Named;
use taotie_engine::scene::GreenChannel;

/// The maximum number of table rows, so that the statement fits one sheet; other files go in a table below it.
const MOST_ROWS: usize = 22;
/// The minimum numbers of further figures and files that it lists. All figures are in the tables below it.
const LEAST_FIGURES: usize = 4;
const LEAST_FILES: usize = 4;

/// The page that judges the figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judge {
    /// This page.
    Here,
    /// The page of a collection, whose requirements may change.
    Collection,
}

/// Builds the statement for a certificate.
pub fn statement(certificate: &Certificate, judge: Judge) -> Statement {
    let mut tables = Vec::new();
    if !certificate.required.is_empty() {
        tables.push(requirements(certificate));
    }
    tables.extend([figures(certificate), files(certificate)]);
    Statement {
        title: "Certificate".into(),
        verdict: verdict(certificate, judge),
        facts: facts(certificate),
        tables,
        command_note: match certificate.command {
            Some(_) => "To recompute this certificate and the `proof` section of the JSON report, byte for byte, run this in a \
                        folder containing the files above:"
                .into(),
            None if certificate.scan_models > 1 => {
                "No command recomputes this certificate: a model file lacks some of the compared data, or files of the \
                 scan have the same name."
                    .into()
            }
            None => "This certificate cannot be recomputed from a model file, which lacks some of the compared data."
                .into(),
        },
        command: certificate.command.clone().unwrap_or_default(),
    }
}

/// Builds the table of all files if the statement has no room for all of them; otherwise `None`.
pub fn further_files(certificate: &Certificate) -> Option<crate::Section> {
    let rows = rows_of_files(certificate);
    (rows.len() > listed_files(certificate)).then(|| crate::Section::Table {
        title: "All files".into(),
        note: "Maps embedded in the model file are hashed as stored.".into(),
        columns: columns_of_files(),
        rows,
    })
}

fn verdict(certificate: &Certificate, judge: Judge) -> Notice {
    let count =
        |is: fn(&RequirementOutcome) -> bool| certificate.required.iter().filter(|met| is(met)).count();
    let (all, unmet) = (certificate.required.len(), count(|met| !met.met));
    match certificate.verdict {
        _ if judge == Judge::Collection => Notice::new(
            "Measured. The collection page lists the requirements for this asset and whether they are met.",
            Tone::Changed,
        ),
        Verdict::NothingRequired => {
            Notice::new("Measured; no requirements were set. The figures are below.", Tone::Changed)
        }
        Verdict::Met => Notice::new("All requirements are met.", Tone::Good),
        Verdict::Undecided => Notice::new(
            format!(
                "Not met: {unmet} of {all} requirements are undecided: the limit is within the interval."
            ),
            Tone::Bad,
        ),
        Verdict::NotMet => Notice::new(format!("Not met: {unmet} of {all} requirements."), Tone::Bad),
    }
}

fn facts(certificate: &Certificate) -> Vec<Fact> {
    let name = |files: &[HashedFile]| files.first().map_or("in memory".to_owned(), |file| file.name.clone());
    let more = match certificate.scan_models {
        0 | 1 => String::new(),
        2 => " and 1 more file".into(),
        all => format!(" and {} more files", all - 1),
    };
    let levels: Vec<String> = certificate.triangles.iter().map(|count| grouped(*count as u64)).collect();
    let options = &certificate.options;
    let images = format!(
        "{} initial samples, images of {} × {}",
        grouped(options.points as u64),
        options.view,
        options.view
    );
    let mut facts = vec![
        Fact::new("Scan", name(&certificate.scan) + &more),
        Fact::new("Triangles of the scan", grouped(certificate.scan_triangles as u64)),
        Fact::new("Asset", name(&certificate.asset)),
        Fact::new("Triangles of the asset", levels.join("; ")),
        Fact::new("Scan read with", reading(&options.scan)),
        Fact::new("Measured with", images),
        Fact::new("Measured by", certificate.program.clone()),
    ];
    let signed = [("Date", &certificate.date), ("Operator", &certificate.operator)];
    facts.extend(signed.into_iter().filter_map(|(name, text)| Some(Fact::new(name, text.as_ref()?))));
    facts
}

/// Describes how a scan was read.
fn reading(options: &ScanOptions) -> String {
    let crease_angle = options.crease_angle_deg.map(|angle| format!("hard edges from {angle}°"));
    let green = options.green.map(|green| match green {
        GreenChannel::Up => "normal maps with green up".to_owned(),
        GreenChannel::Down => "normal maps with green down".to_owned(),
    });
    let unit = options.unit.map(|unit| format!("coordinates in {}", unit.name()));
    let all: Vec<String> = [unit, crease_angle, green].into_iter().flatten().collect();
    if all.is_empty() { "default options".into() } else { all.join(", ") }
}

/// Returns a whole number with commas between thousands.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let group = |(i, digit): (usize, char)| match (digits.len() - i).is_multiple_of(3) && i > 0 {
        true => vec![',', digit],
        false => vec![digit],
    };
    digits.chars().enumerate().flat_map(group).collect()
}

fn requirements(certificate: &Certificate) -> PlainTable {
    let has_levels = certificate.triangles.len() > 1;
    let mut columns = vec![Column::words("required"), Column::words("shown by")];
    columns.extend(has_levels.then(|| Column::words("level")));
    columns.extend(["value", "interval", "limit", "result"].map(Column::words));
    PlainTable {
        title: "Requirements".into(),
        note: match has_levels {
            true => {
                "Each level of detail is judged; the worst is shown. Level 0 is the finest. ".to_owned()
                    + INTERVALS
            }
            false => INTERVALS.into(),
        },
        columns,
        rows: worst(&certificate.required)
            .into_iter()
            .map(|met| row_of_requirement(met, has_levels))
            .collect(),
    }
}

const INTERVALS: &str = "Means and quantiles lie within their interval with a confidence of 99 %; the largest distance lies \
                         within proven bounds. A requirement is met only if the whole interval meets the limit.";

/// Returns the worst result of each requirement over all levels, in order.
fn worst(required: &[RequirementOutcome]) -> Vec<&RequirementOutcome> {
    let mut worst: Vec<&RequirementOutcome> = Vec::new();
    for met in required {
        let limit = |of: &RequirementOutcome| (of.figure, of.within, of.most, of.is_length);
        let is_same = |known: &&mut &RequirementOutcome| limit(known) == limit(met);
        match worst.iter_mut().find(is_same) {
            Some(known) if is_worse(met, known) => *known = met,
            Some(_) => {}
            None => worst.push(met),
        }
    }
    worst
}

fn is_worse(a: &RequirementOutcome, b: &RequirementOutcome) -> bool {
    if a.met != b.met {
        return b.met;
    }
    let (Some(of_a), Some(of_b)) = (a.value, b.value) else { return a.value.is_none() && b.value.is_some() };
    if a.figure.is_at_least() { of_a < of_b } else { of_a > of_b }
}

fn row_of_requirement(met: &RequirementOutcome, has_level: bool) -> Vec<Cell> {
    let (text, tone) = match met.met {
        true => ("met", Tone::Good),
        false if met.is_undecided() => ("undecided", Tone::Bad),
        false => ("not met", Tone::Bad),
    };
    let bound = if met.figure.is_at_least() { "≥" } else { "≤" };
    let unit = met.unit();
    let limit = shown(unit, met.most);
    // Five digits may hide that a limit is exceeded; the result is then shown with all digits.
    let value = match met.value.map(|value| shown(unit, value)) {
        None => "not measured".into(),
        Some(value) if !met.met && value == limit => met.text(),
        Some(value) => value,
    };
    let mut row =
        vec![Cell::text(title(met.figure, &met.title(), unit)), Cell::text(met.figure.looking().words())];
    row.extend(has_level.then(|| Cell::text(met.level.map_or("all".into(), |level| level.to_string()))));
    row.extend([
        Cell::text(value),
        Cell::text(met.interval.map_or_else(String::new, |interval| between(unit, interval))),
        Cell::text(format!("{bound} {limit}")),
        Cell::Mark { text: text.into(), tone, why: String::new() },
    ]);
    row
}

/// Returns an interval as text; an empty string if the value is exact.
fn between(unit: FigureUnit, [low, high]: [f64; 2]) -> String {
    let [from, to] = [low, high].map(|bound| shown(unit, bound));
    if low == high { String::new() } else { format!("{from} to {to}") }
}

/// Returns a value in its unit: bytes with commas, and rounding residues as 0.
fn shown(unit: FigureUnit, value: f64) -> String {
    const NOTHING: f64 = 1e-9;
    match unit.name {
        "B" => format!("{} B", grouped(value as u64)),
        _ if value.abs() < NOTHING * unit.size => unit.text(0.0),
        _ => unit.text(value),
    }
}

/// Returns the title of a figure, with the quantity it is relative to.
fn title(figure: Figure, title: &str, unit: FigureUnit) -> String {
    let of_diagonal = figure == Figure::Hausdorff && unit.name == "%";
    format!("{title}{}", if of_diagonal { ", of the diagonal" } else { "" })
}

/// Builds the table of the key figures that no requirement covers.
fn figures(certificate: &Certificate) -> PlainTable {
    let has_row = |figure: &KeyFigure| {
        certificate
            .required
            .iter()
            .any(|met| met.figure == figure.figure && met.level.is_none_or(|level| level == 0))
    };
    let is_single = certificate.triangles.len() < 2;
    let room = (MOST_ROWS - LEAST_FILES).saturating_sub(worst(&certificate.required).len());
    let further = certificate.figures.iter().filter(|figure| !(is_single && has_row(figure)));
    let further = further.take(room.max(LEAST_FIGURES));
    let row = |KeyFigure { figure, value, interval, .. }: &KeyFigure| {
        vec![
            Cell::text(title(*figure, figure.title(), figure.unit())),
            Cell::text(figure.looking().words()),
            Cell::text(shown(figure.unit(), *value)),
            Cell::text(between(figure.unit(), *interval)),
        ]
    };
    let unseen = &certificate.not_compared;
    PlainTable {
        title: if certificate.required.is_empty() { "Figures" } else { "Further figures" }.into(),
        note: match (unseen.is_empty(), is_single) {
            (true, true) => String::new(),
            (true, false) => "For the finest level of detail.".into(),
            (false, _) => format!("Not compared: {}.", unseen.join("; ")),
        },
        columns: ["figure", "shown by", "value", "interval"].map(Column::words).to_vec(),
        rows: further.map(row).collect(),
    }
}

fn files(certificate: &Certificate) -> PlainTable {
    let mut rows = rows_of_files(certificate);
    let listed = listed_files(certificate);
    let more = rows.len().saturating_sub(listed);
    // The asset is listed however many files the scan has.
    let asset = certificate.scan_models.min(certificate.scan.len());
    if (listed..rows.len()).contains(&asset) {
        rows.swap(listed - 1, asset);
    }
    rows.truncate(listed);
    let further = format!(" {more} more are listed under “All files”.");
    PlainTable {
        title: "Files".into(),
        note: "Maps embedded in the model file are hashed as stored.".to_owned()
            + if more > 0 { &further } else { "" },
        columns: columns_of_files(),
        rows,
    }
}

/// Returns the number of files that fit in the statement.
fn listed_files(certificate: &Certificate) -> usize {
    let others = worst(&certificate.required).len() + figures(certificate).rows.len();
    MOST_ROWS.saturating_sub(others).max(LEAST_FILES)
}

fn columns_of_files() -> Vec<Column> {
    vec![Column::words("file"), Column::words("name"), Column::numbers("bytes", ""), Column::words("SHA-256")]
}

/// Returns all files: the models of the scan, those of the asset, its maps, and the other files of the scan.
fn rows_of_files(certificate: &Certificate) -> Vec<Vec<Cell>> {
    let row = |what: String, file: &HashedFile| {
        let HashedFile { name, bytes, sha256, .. } = file;
        vec![Cell::text(what), Cell::text(name), Cell::number(*bytes as f64, 0), Cell::Code(sha256.clone())]
    };
    let map = |map: &HashedMap| {
        let uses = if map.uses.is_empty() { "unused" } else { &map.uses };
        let name = map.file.clone().unwrap_or_else(|| "in the model file".into());
        let hash = map.sha256.clone().map_or_else(|| Cell::text("missing"), Cell::Code);
        let bytes = Cell::Number { value: map.bytes.map(|bytes| bytes as f64), digits: 0 };
        vec![Cell::text(format!("map: {uses}")), Cell::text(name), bytes, hash]
    };
    let Certificate { scan, scan_models, asset, maps, .. } = certificate;
    let (models, parts) = scan.split_at((*scan_models).min(scan.len()));
    let of = |what: &str, files: &[HashedFile]| -> Vec<Vec<Cell>> {
        files.iter().map(|file| row(what.into(), file)).collect()
    };
    let (model, others) = asset.split_at(asset.len().min(1));
    let of_maps: Vec<Vec<Cell>> = maps.iter().map(map).collect();
    [of("scan", models), of("asset", model), of("asset, part", others), of_maps, of("scan, part", parts)]
        .concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie::asset::{Figure, Figures, LevelFigures, Requirement};

    #[test]
    fn numbers_have_commas() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn values_are_formatted_for_readers() {
        let [bytes, share] = [Figure::Bytes, Figure::Missed].map(Figure::unit);
        assert_eq!(shown(bytes, 5_000_000.0), "5,000,000 B");
        assert_eq!(between(share, [2.7e-20, 0.000_331_6]), "0 % to 0.03316 %");
        assert_eq!(between(share, [0.1; 2]), "", "the value is exact");
        assert!(
            title(Figure::Hausdorff, Figure::Hausdorff.title(), Figure::Hausdorff.unit())
                .ends_with("of the diagonal")
        );
    }

    #[test]
    fn the_worst_level_represents_all() {
        let level = |share: f64| {
            let mut level = LevelFigures::default();
            level.coverage.missed_interval = [share; 2];
            level
        };
        let mut figures = Figures::default();
        figures.levels = [0.0, 0.02, 0.01].map(level).to_vec();
        let required = figures.evaluate(&[Requirement::missed(0.001), Requirement::missed(0.5)]);
        let [strict, mild] = worst(&required)[..] else { panic!("two limits") };
        assert_eq!((strict.met, strict.level), (false, Some(1)));
        assert_eq!((mild.met, mild.most), (true, 0.5));
        assert_eq!(row_of_requirement(strict, true)[2], Cell::text("1"));
    }

    #[test]
    fn shares_within_different_limits_are_different_requirements() {
        let mut figures = Figures::default();
        figures.levels = vec![LevelFigures::default(); 2];
        let within = |limit: f64| Requirement::within(Figure::WithinAngle, limit, 0.99);
        let required = figures.evaluate(&[within(5.0), within(10.0)]);
        let titles = worst(&required).into_iter().map(|met| row_of_requirement(met, false)[0].clone());
        let wanted = ["surface within a normal error of 5°", "surface within a normal error of 10°"];
        assert_eq!(titles.collect::<Vec<_>>(), wanted.map(Cell::text));
    }
}
