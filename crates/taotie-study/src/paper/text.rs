//! The study as text for the terminal: sections of aligned lines.

use super::angles::Angle;
use super::law::Number;
use super::misprints::{AXES, Misprint};
use super::printed::{ANGLES, NORMALS};
use super::study::{Row, Study};
use super::words;
use taotie_report::table::Table;

impl Study {
    /// Returns the whole study as text for a terminal: sections of aligned lines.
    pub fn text(&self) -> String {
        let sections = [
            (words::title().to_string(), lines(&words::preface())),
            (words::LAW.to_string(), laws(&self.rows)),
            (words::TABLE_2.to_string(), normals(&self.rows)),
            (words::TABLE_3.to_string(), angles(self)),
            (words::MISPRINTS.to_string(), self.misprints.iter().map(misprint).collect()),
            (words::CONCLUSION.to_string(), lines(&words::conclusion(self))),
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
                words::prints(before),
                agreement(before),
                words::prints(after),
                corrected(before, after),
                row.explained
                    .get(which)
                    .map_or("–", |explained| if *explained { "yes" } else { "no" })
                    .into(),
            ]);
        }
    }
    format!("{}{}", table.lines(2), lines(&[words::counts(study)]))
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
    let (printed, corrected) = words::numbers(misprint);
    let head = format!("  Table {table}, row {row}, {cell}: printed {printed}, should be {corrected}");
    format!("{head}\n{}", wrapped(&format!("{}.", misprint.reason), 6))
}

fn four(number: f64) -> String {
    format!("{number:.4}")
}
