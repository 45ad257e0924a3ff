//! The study as text for the terminal: sections of aligned lines. The page uses the same wording.

use super::law::{AXES, Misprint, Number};
use super::printed::{ANGLES, Angle, NORMALS};
use super::{Distance, Row, Study};
use taotie_report::table::Table;

impl Study {
    /// Returns the whole study as text for a terminal: sections of aligned lines.
    pub fn text(&self) -> String {
        let sections = [
            (title().to_string(), lines(&preface())),
            (LAW.to_string(), laws(&self.rows)),
            (TABLE_2.to_string(), normals(&self.rows)),
            (TABLE_3.to_string(), angles(self)),
            (MISPRINTS.to_string(), self.misprints.iter().map(misprint).collect()),
            (CONCLUSION.to_string(), lines(&conclusion(self))),
        ];
        sections.map(|(title, lines)| format!("{title}\n{lines}")).join("\n")
    }
}

/// Paragraphs, wrapped.
fn lines(paragraphs: &[String]) -> String {
    paragraphs.iter().map(|paragraph| wrapped(paragraph, 2)).collect()
}

/// The column at which text is wrapped.
const WIDTH: usize = 110;

fn wrapped(text: &str, indent: usize) -> String {
    let mut out = String::new();
    let mut line = " ".repeat(indent);
    for word in text.split(' ') {
        if line.chars().count() + word.chars().count() > WIDTH {
            out += &format!("{}\n", line.trim_end());
            line = " ".repeat(indent);
        }
        line += &format!("{word} ");
    }
    out + &format!("{}\n", line.trim_end())
}

fn laws(rows: &[Row]) -> String {
    let mut table = Table::new(&[">row", ">N2.x", ">N2.y", ">N3.x", ">N3.y", ">g", ">numbers that agree"]);
    for Row { row, law, .. } in rows {
        let [a, b, c, d] = law.estimates.map(|g| format!("{g:.2}"));
        table.row([row.to_string(), a, b, c, d, law.g.to_string(), format!("{} of 9", law.agreeing)]);
    }
    table.lines(2)
}

fn normals(rows: &[Row]) -> String {
    let mut table = Table::new(&[">row", "", ">printed x", ">y", ">z", ">recomputed x", ">y", ">z", ""]);
    for row in rows {
        for (which, numbers) in row.law.normals.iter().enumerate() {
            let head = if which == 0 { row.row.to_string() } else { String::new() };
            let [a, b, c] = numbers.map(|number| four(number.printed));
            let [d, e, f] = numbers.map(|number| four(number.recomputed));
            table.row([head, NORMALS[which].into(), a, b, c, d, e, f, verdict(numbers)]);
        }
        let [a, b, c] = row.n4.map(four);
        let none = || "–".to_string();
        table.row([
            String::new(),
            NORMALS[3].into(),
            a,
            b,
            c,
            none(),
            none(),
            none(),
            "cannot be recomputed".into(),
        ]);
    }
    table.lines(2)
}

fn verdict(numbers: &[Number; 3]) -> String {
    let wrong: Vec<&str> = (0..3).filter(|axis| !numbers[*axis].agrees).map(|axis| AXES[axis]).collect();
    match wrong.as_slice() {
        [] => "agrees".into(),
        [one] => format!("{one} DIFFERS"),
        some => format!("{} DIFFER", some.join(" and ")),
    }
}

fn angles(study: &Study) -> String {
    let mut table = Table::new(&[
        ">row",
        "",
        ">printed",
        ">from Table 2 as printed",
        "",
        ">from Table 2 corrected",
        "",
        "follows from N1 and g",
    ]);
    for row in &study.rows {
        for (which, name) in ANGLES.into_iter().enumerate() {
            let head = if which == 0 { row.row.to_string() } else { String::new() };
            let (before, after) = (&row.angles_as_printed[which], &row.angles_corrected[which]);
            table.row([
                head,
                name.into(),
                format!("{:.2}", before.printed),
                prints(before),
                agreement(before),
                prints(after),
                corrected(before, after),
                row.explained
                    .get(which)
                    .map_or("–", |explained| if *explained { "yes" } else { "no" })
                    .into(),
            ]);
        }
    }
    format!("{}{}", table.lines(2), lines(&[counts(study)]))
}

fn agreement(angle: &Angle) -> String {
    if angle.agrees { "agrees".into() } else { "DIFFERS".into() }
}

/// Like `agreement`, with the corrected angle if the printed angle itself was corrected.
fn corrected(before: &Angle, after: &Angle) -> String {
    match before.printed == after.printed {
        true => agreement(after),
        false => format!("{} with {:.2}", agreement(after), after.printed),
    }
}

fn misprint(misprint: &Misprint) -> String {
    let Misprint { table, row, cell, .. } = misprint;
    let (printed, corrected) = numbers(misprint);
    let head = format!("  Table {table}, row {row}, {cell}: printed {printed}, should be {corrected}");
    format!("{head}\n{}", wrapped(&format!("{}.", misprint.reason), 6))
}

fn four(number: f64) -> String {
    format!("{number:.4}")
}

/// The headings.
pub const LAW: &str = "The law of N2 and N3: n + s · (g/255) · (1, 1, 0), with s = 5 and 50";
/// As [`LAW`].
pub const TABLE_2: &str = "Table 2, normals at ten points of the jue";
/// As [`LAW`].
pub const TABLE_3: &str = "Table 3, their angles in degrees";
/// As [`LAW`].
pub const MISPRINTS: &str = "Misprints in the journal or in the transcribed copy";
/// As [`LAW`].
pub const CONCLUSION: &str = "Conclusion";

/// The study's title.
pub fn title() -> &'static str {
    "Guo and Wang 2025, Tables 2 and 3, recomputed"
}

/// The citation of the paper.
pub const SOURCE: &str = "Guo Huifang and Wang Junxiu, \"Analysis and application of Physically-Based Rendering (PBR) \
    normal mapping technology in bronze wares\", Intelligent Computer and Applications 15(6), 2025, pp. 122–126, \
    doi:10.20169/j.issn.2095-2163.24121501";

/// The meaning of the symbols.
const LEGEND: &str = "N1 is the mesh normal, N2 and N3 are those of the bump method with factors s = 5 and s = 50, \
    and N4 is that of the paper's own method; θ1, θ2 and θ3 are the angles of N2, N3 and N4 to N1; g is half the \
    difference between two grey levels of the height map.";

/// Returns the source, the meaning of the symbols, and the rule for when two numbers agree.
pub fn preface() -> Vec<String> {
    vec![
        format!("{SOURCE}."),
        LEGEND.into(),
        "The paper truncates decimals: it prints four for normals and two for angles. A printed number therefore \
         represents a range, and agrees with others if some numbers in their ranges would be printed this way. \
         Angles are arccos(a·b / (|a||b|))."
            .into(),
        "In each row, g is the multiple of one half that agrees with most of the row's numbers. N4 cannot be \
         recomputed, since neither the mesh nor its textures were published."
            .into(),
    ]
}

/// Returns a sentence with the counts of angles that agree.
pub fn counts(study: &Study) -> String {
    let counts = study.agreeing;
    format!(
        "{} of {} printed angles follow from Table 2 as printed, and {} after correcting {} misprints. From just N1 \
         and g, the law gives {} of the {} angles θ1 and θ2 as printed.",
        counts.as_printed,
        counts.of,
        counts.corrected,
        study.misprints.len(),
        counts.explained_by_the_law,
        2 * study.rows.len(),
    )
}

/// Returns the conclusions from the corrected tables about the paper's methods.
pub fn conclusion(study: &Study) -> Vec<String> {
    let (corrected, points) = (study.conclusion.corrected, study.rows.len());
    let [n1, n3, n4] = study.conclusion.lengths;
    vec![
        format!(
            "{} at {} of {points} points, and with a mean of {:.1}° instead of {:.1}° (as printed: {} points, {:.1}° \
             and {:.1}°). The paper states for its Figure 8 that bump 5 is far from its own method and that bump 50 \
             is much the same; Tables 2 and 3 do not support this.",
            nearer(&corrected),
            most(&corrected, points),
            corrected.mean_bump_5,
            corrected.mean_bump_50,
            study.conclusion.as_printed.bump_5_is_nearer,
            study.conclusion.as_printed.mean_bump_5,
            study.conclusion.as_printed.mean_bump_50,
        ),
        format!(
            "The paper's bump method moves the normal along (1, 1, 0) in object space regardless of how the surface \
             faces, and does not normalise it: the length of N1 is {:.3} to {:.3}, that of N3 up to {:.2}, and that \
             of N4 {:.2} to {:.2}.",
            n1[0], n1[1], n3[1], n4[0], n4[1]
        ),
    ]
}

fn nearer(distance: &Distance) -> &'static str {
    match distance.mean_bump_5 < distance.mean_bump_50 {
        true => "Bump 5 is closer to the paper's own method (N4) than bump 50:",
        false => "Bump 50 is closer to the paper's own method (N4) than bump 5:",
    }
}

/// Returns the number of points at which the method that is closer on average is closer.
fn most(distance: &Distance, points: usize) -> usize {
    match distance.mean_bump_5 < distance.mean_bump_50 {
        true => distance.bump_5_is_nearer,
        false => points - distance.bump_5_is_nearer,
    }
}

/// Returns the angles that may be printed: a single angle or a range.
pub fn prints(angle: &Angle) -> String {
    match angle.prints() {
        [low, high] if low == high => format!("{low:.2}"),
        [low, high] => format!("{low:.2} to {high:.2}"),
    }
}

/// Returns the printed and the correct numbers, with the decimals of their table.
pub fn numbers(misprint: &Misprint) -> (String, String) {
    let decimals = if misprint.table == 2 { 4 } else { 2 };
    let format = |numbers: &[f64]| match numbers {
        [one] => format!("{one:.decimals$}"),
        some => {
            format!("({})", some.iter().map(|v| format!("{v:.decimals$}")).collect::<Vec<_>>().join(", "))
        }
    };
    (format(&misprint.printed), format(&misprint.corrected))
}
