//! The study as files: a page for people, JSON for machines.

use super::law::{Misprint, Number};
use super::printed::{ANGLES, Angle, NORMALS};
use super::{Row, Study, text};
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie_engine::Result;
use taotie_io::FileSet;
use taotie_report::{Cell, Column, Fact, Page, Section, Tone};

/// Version of the JSON.
const SCHEMA: u32 = 1;

/// The JSON document.
#[derive(Serialize)]
struct Document<'a> {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The paper.
    source: &'static str,
    /// The law that the normals of its Table 2 follow.
    law: &'static str,
    #[serde(flatten)]
    study: &'a Study,
}

impl Study {
    /// Returns the study as JSON, without a trailing newline.
    pub fn json(&self) -> String {
        let law = "N = N1 + s · (g/255) · (1, 1, 0), s = 5 for N2 and 50 for N3";
        let version = env!("CARGO_PKG_VERSION");
        let document = Document { schema: SCHEMA, version, source: text::SOURCE, law, study: self };
        serde_json::to_string_pretty(&document).expect("the study has only text keys")
    }

    /// Writes `paper.html` and `paper.json` to `folder`, which is created if necessary, as files of a set; returns
    /// the files.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`] if the folder cannot be created or written to.
    pub fn write(&self, set: &FileSet, folder: &Path) -> Result<Vec<PathBuf>> {
        set.claim_folder(folder)?;
        let files = ["paper.html", "paper.json"].map(|name| folder.join(name));
        set.write_text(&files[0], &taotie_report::html(&self.page()))?;
        set.write_text(&files[1], &format!("{}\n", self.json()))?;
        Ok(files.into())
    }
}

impl Study {
    /// Returns the study as a page.
    pub fn page(&self) -> Page {
        let counts = self.agreeing;
        Page {
            title: text::title().into(),
            subtitle: text::SOURCE.into(),
            notices: Vec::new(),
            facts: vec![
                Fact::new(
                    "angles that follow from Table 2 as printed",
                    format!("{} of {}", counts.as_printed, counts.of),
                ),
                Fact::new("after correcting misprints", format!("{} of {}", counts.corrected, counts.of)),
                Fact::new("misprints", self.misprints.len().to_string()),
                Fact::new(
                    "mean angle between bump 5 and the paper's method",
                    mean(self.conclusion.corrected.mean_bump_5),
                ),
                Fact::new("mean angle between bump 50 and it", mean(self.conclusion.corrected.mean_bump_50)),
            ],
            views: Vec::new(),
            sections: vec![
                Section::Text { title: "Method".into(), paragraphs: text::preface().split_off(1) },
                Section::Text { title: text::CONCLUSION.into(), paragraphs: text::conclusion(self) },
                misprints(self),
                law(self),
                normals(self),
                angles(self),
            ],
            footer: format!("Made by taotie {}: `taotie compare --paper`.", env!("CARGO_PKG_VERSION")),
            ..Page::default()
        }
    }
}

fn mean(degrees: f64) -> String {
    format!("{degrees:.1}°")
}

fn misprints(study: &Study) -> Section {
    let row = |misprint: &Misprint| {
        let (printed, corrected) = text::numbers(misprint);
        let mark = |text, tone| Cell::Mark { text, tone, why: String::new() };
        vec![
            Cell::number(f64::from(misprint.table), 0),
            Cell::number(misprint.row as f64, 0),
            Cell::text(&misprint.cell),
            mark(printed, Tone::Bad),
            mark(corrected, Tone::Changed),
            Cell::text(&misprint.reason),
        ]
    };
    Section::Table {
        title: text::MISPRINTS.into(),
        note: String::new(),
        columns: vec![
            Column::numbers("table", ""),
            Column::numbers("row", ""),
            Column::words("number"),
            Column::words("printed"),
            Column::words("should be"),
            Column::words("reason"),
        ],
        rows: study.misprints.iter().map(row).collect(),
    }
}

fn law(study: &Study) -> Section {
    let row = |row: &Row| {
        let estimates = row.law.estimates.map(|g| Cell::number(g, 2));
        let ends = [Cell::number(row.law.g, 1), Cell::number(row.law.agreeing as f64, 0)];
        [Cell::number(row.row as f64, 0)].into_iter().chain(estimates).chain(ends).collect()
    };
    let names = ["row", "g of N2.x", "g of N2.y", "g of N3.x", "g of N3.y", "g", "agreeing numbers of 9"];
    Section::Table {
        title: text::LAW.into(),
        note: "The g that follows from each individual number, and the g that agrees with most numbers of the row."
            .into(),
        columns: names.map(|name| Column::numbers(name, "")).into(),
        rows: study.rows.iter().map(row).collect(),
    }
}

fn normals(study: &Study) -> Section {
    let mut columns = vec![Column::numbers("row", ""), Column::words("normal")];
    let names = ["printed x", "y", "z", "recomputed x", "y", "z"];
    columns.extend(names.map(|name| Column::numbers(name, "")));
    Section::Table {
        title: text::TABLE_2.into(),
        note: "N1 is the mesh normal, N2 and N3 those of bump with s = 5 and 50, N4 that of the paper's own method."
            .into(),
        columns,
        rows: study.rows.iter().flat_map(rows_of_normals).collect(),
    }
}

fn rows_of_normals(row: &Row) -> Vec<Vec<Cell>> {
    let head = |which: usize| [Cell::number(row.row as f64, 0), Cell::text(NORMALS[which])];
    let line = |which: usize| {
        let numbers = row.law.normals[which];
        let cells = numbers.map(printed_number).into_iter().chain(numbers.map(recomputed));
        head(which).into_iter().chain(cells).collect()
    };
    let n4 = row.n4.map(|number| Cell::number(number, 4)).into_iter();
    let missing = [(); 3].map(|()| Cell::Number { value: None, digits: 4 });
    let mut lines: Vec<Vec<Cell>> = (0..3).map(line).collect();
    lines.push(head(3).into_iter().chain(n4).chain(missing).collect());
    lines
}

fn printed_number(number: Number) -> Cell {
    let tone = if number.agrees { Tone::Good } else { Tone::Bad };
    Cell::Mark { text: signed(number.printed), tone, why: String::new() }
}

fn recomputed(number: Number) -> Cell {
    match number.agrees {
        true => Cell::number(number.recomputed, 4),
        false => Cell::Mark { text: signed(number.recomputed), tone: Tone::Changed, why: String::new() },
    }
}

/// Formats a number with the minus sign used on the page.
fn signed(number: f64) -> String {
    format!("{number:.4}").replace('-', "−")
}

fn angles(study: &Study) -> Section {
    let columns = vec![
        Column::numbers("row", ""),
        Column::words("angle"),
        Column::numbers("printed", "°"),
        Column::numbers("from Table 2 as printed", "°"),
        Column::words("before"),
        Column::numbers("from Table 2 corrected", "°"),
        Column::words("after"),
        Column::words("follows from N1 and g"),
    ];
    Section::Table {
        title: text::TABLE_3.into(),
        note: text::counts(study),
        columns,
        rows: study.rows.iter().flat_map(|row| (0..3).map(|which| row_of_angle(row, which))).collect(),
    }
}

fn row_of_angle(row: &Row, which: usize) -> Vec<Cell> {
    let (before, after) = (&row.angles_as_printed[which], &row.angles_corrected[which]);
    vec![
        Cell::number(row.row as f64, 0),
        Cell::text(ANGLES[which]),
        Cell::number(before.printed, 2),
        Cell::text(text::prints(before)),
        agreement(before, before),
        Cell::text(text::prints(after)),
        agreement(before, after),
        Cell::text(row.explained.get(which).map_or("–", |explained| if *explained { "yes" } else { "no" })),
    ]
}

/// The mark of an angle that agrees or not, with the corrected angle if it was corrected.
fn agreement(printed: &Angle, angle: &Angle) -> Cell {
    let mark = |text: String, tone| Cell::Mark { text, tone, why: String::new() };
    match (angle.agrees, printed.printed == angle.printed) {
        (true, true) => mark("agrees".into(), Tone::Good),
        (true, false) => mark(format!("agrees with {:.2}", angle.printed), Tone::Changed),
        (false, _) => mark("differs".into(), Tone::Bad),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_files_contain_the_study_and_a_folder_that_cannot_be_created_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let study = Study::new();
        let files = FileSet::one(|set| study.write(set, &folder.path().join("made"))).unwrap();
        let [page, json] = [0, 1].map(|i| std::fs::read_to_string(&files[i]).unwrap());
        assert!(page.contains("<title>Guo and Wang 2025, Tables 2 and 3, recomputed</title>"));
        let read: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!((read["schema"].as_u64(), read["source"].as_str()), (Some(1), Some(text::SOURCE)));
        assert_eq!(read["misprints"].as_array().unwrap().len(), study.misprints.len());
        let error = study.write(&FileSet::new(), &files[0].join("below")).unwrap_err().to_string();
        assert!(error.contains("paper.html"), "{error}");
    }
}
