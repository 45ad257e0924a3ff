//! The study as a page.

use super::angles::Angle;
use super::law::Number;
use super::misprints::Misprint;
use super::printed::{ANGLES, NORMALS};
use super::study::{Row, Study};
use super::words;
use taotie_report::{Cell, Column, Fact, Page, Section, Tone};

impl Study {
    /// Returns the study as a page.
    pub fn page(&self) -> Page {
        let counts = self.agreeing;
        Page {
            title: words::title().into(),
            subtitle: words::SOURCE.into(),
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
                Section::Text { title: "Method".into(), paragraphs: words::preface().split_off(1) },
                Section::Text { title: words::CONCLUSION.into(), paragraphs: words::conclusion(self) },
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
        let (printed, corrected) = words::numbers(misprint);
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
        title: words::MISPRINTS.into(),
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
        title: words::LAW.into(),
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
        title: words::TABLE_2.into(),
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
        title: words::TABLE_3.into(),
        note: words::counts(study),
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
        Cell::text(words::prints(before)),
        agreement(before, before),
        Cell::text(words::prints(after)),
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
