//! The report pages that the scripts of `tests/browser` test.

use std::path::Path;
use std::process::Command;
use taotie_engine::image::Encoding;
use taotie_io::{PngColor, PngImage, PngSamples, encode_png};
use taotie_report::{
    Cell, Column, Fact, Legend, Notice, Page, Picture, PlainTable, Section, Series, Statement, Tone, View,
    html,
};

const RED: [u8; 3] = [200, 30, 30];
const GREEN: [u8; 3] = [30, 160, 60];
const BLUE: [u8; 3] = [40, 60, 200];
const GREY: [u8; 3] = [128, 128, 128];

/// Side of the pictures, pixels.
const SIDE: u32 = 64;

/// A title that tries to inject markup.
const NASTY: &str = "</script><img src=x onerror=\"document.title='pwned'\">";

/// A picture whose quarters have these colours: top left, top right, bottom left, bottom right.
fn quarters(colors: [[u8; 3]; 4]) -> Vec<u8> {
    let half = SIDE / 2;
    let pixels = (0..SIDE * SIDE).map(|i| colors[(i / SIDE / half * 2 + i % SIDE / half) as usize]);
    let bytes: Vec<u8> = pixels.flatten().collect();
    let samples = PngSamples::U8(&bytes);
    let picture =
        PngImage { width: SIDE, height: SIDE, color: PngColor::Rgb, samples, encoding: Encoding::Srgb };
    encode_png(&picture).expect("a picture can be encoded")
}

fn picture(label: &str, colors: [[u8; 3]; 4]) -> Picture {
    Picture { label: label.into(), note: format!("note of {label}"), file: quarters(colors) }
}

/// Two views of the same three labels; the second begins with another one, and has a legend.
fn views() -> Vec<View> {
    let (red, blue) = (picture("red", [RED, GREY, GREY, GREY]), picture("blue", [BLUE, GREY, GREY, GREY]));
    let green = picture("green", [GREEN; 4]);
    let legend =
        Legend { title: "angle".into(), unit: "°".into(), top: 30.0, stops: vec![RED, GREEN, BLUE] };
    let first = View {
        name: "first".into(),
        note: "a note".into(),
        pictures: vec![red.clone(), green.clone(), blue.clone()],
        legend: None,
    };
    let second = View {
        name: "second".into(),
        pictures: vec![green, red, blue],
        legend: Some(legend),
        ..View::default()
    };
    vec![first, second]
}

fn table() -> Section {
    let mark = |text: &str, tone, why: &str| Cell::Mark { text: text.into(), tone, why: why.into() };
    let row = |name: &str, value: Option<f64>, last: Cell| {
        vec![Cell::text(name), Cell::Number { value, digits: 2 }, last]
    };
    Section::Table {
        title: "A table".into(),
        note: "Sorted by a click.".into(),
        columns: vec![Column::words("name"), Column::numbers("mean", "°"), Column::numbers("judged", "")],
        rows: vec![
            row("b, \"quoted\"", Some(9.5), mark("3", Tone::Bad, "it differs")),
            row("none", None, mark("1", Tone::Good, "")),
            row("a10", Some(-12.0), mark("2", Tone::Changed, "it differs")),
            row("a9", Some(12345.678), mark("4", Tone::Good, "")),
        ],
    }
}

fn histogram() -> Section {
    let series = |label: &str, counts: [u64; 6]| Series { label: label.into(), counts: counts.into() };
    Section::Histogram {
        title: "A histogram".into(),
        note: String::new(),
        unit: "°".into(),
        bin_width: 0.5,
        last_is_open: true,
        series: vec![series("one", [10, 1000, 20, 1, 0, 7]), series("two", [500, 20, 0, 0, 0, 1])],
    }
}

fn full() -> Page {
    let prose = Section::Text { title: NASTY.into(), paragraphs: vec![NASTY.into(), "Two.".into()] };
    Page {
        title: NASTY.into(),
        subtitle: "A page for tests".into(),
        notices: vec![Notice::new("It holds.", Tone::Good), Notice::new(NASTY, Tone::Changed)],
        facts: vec![Fact::new("model", NASTY), Fact::new("size", "64 × 64")],
        views: views(),
        sections: vec![prose, table(), histogram()],
        footer: "the end".into(),
        ..Page::default()
    }
}

/// A long certificate: ten requirements, eight further figures, four files.
fn certificate() -> Page {
    let words = |names: &[&str]| names.iter().map(|name| Column::words(*name)).collect();
    let table = |title: &str, columns, row: Vec<Cell>, count: usize| PlainTable {
        title: title.into(),
        note: "Means and quantiles lie within their interval with a confidence of 99 %. ".repeat(2),
        columns,
        rows: vec![row; count],
    };
    let judged = || Cell::Mark { text: "not met".into(), tone: Tone::Bad, why: String::new() };
    let texts = |texts: &[&str]| texts.iter().map(|text| Cell::text(*text)).collect::<Vec<_>>();
    let figure = ["normal error, mean in the worst 1 % of the surface", "on the surface"];
    let values = ["1.2346°", "1.2345° to 1.2347°", "≤ 1°"];
    let required = [texts(&figure), texts(&["0"]), texts(&values), vec![judged()]].concat();
    let measured = [texts(&figure), texts(&values[..2])].concat();
    let file = [
        texts(&["map: metallic roughness, occlusion", "a-scan-with-a-rather-long-name.height.png"]),
        vec![Cell::number(12_345_678.0, 0), Cell::Code("0123456789abcdef".repeat(4))],
    ];
    let columns = words(&["required", "shown by", "level", "value", "interval", "limit", "result"]);
    let statement = Statement {
        title: "Certificate".into(),
        verdict: Notice::new("Not met: 1 of 10 requirements.", Tone::Bad),
        facts: vec![Fact::new("Measured by", "taotie 0.1.0"); 10],
        tables: vec![
            table("Requirements", columns, required, 10),
            table("Further figures", words(&["figure", "shown by", "value", "interval"]), measured, 8),
            table("Files", words(&["file", "name", "bytes", "SHA-256"]), file.concat(), 4),
        ],
        command_note: "To recompute this certificate, run this in a folder containing the files above:"
            .into(),
        command:
            "taotie verify a-scan-with-a-rather-long-name.glb --scan a-scan-with-a-rather-long-name.ply "
                .repeat(4),
    };
    let feature = View { name: "Worst patch".into(), ..views().remove(1) };
    Page {
        title: "a-scan-with-a-rather-long-name.ply".into(),
        subtitle: "The scan and the low-poly asset made from it".into(),
        statement: Some(statement),
        features: vec![feature],
        views: views(),
        ..Page::default()
    }
}

/// Sections with no content, and with too much.
fn hollow() -> [Section; 4] {
    let rows = vec![vec![], vec![Cell::text("more"), Cell::text("than"), Cell::text("columns")]];
    let columns = vec![Column::words("x"), Column::words("y")];
    let table = |columns, rows| Section::Table { title: String::new(), note: String::new(), columns, rows };
    let histogram = Section::Histogram {
        title: String::new(),
        note: String::new(),
        unit: String::new(),
        bin_width: 0.0,
        last_is_open: false,
        series: vec![Series::default()],
    };
    let text = Section::Text { title: String::new(), paragraphs: vec![] };
    [text, table(vec![], vec![]), table(columns, rows), histogram]
}

/// Views without a picture, with one, and with files that are not pictures.
fn odd() -> Vec<View> {
    let single = View { name: "single".into(), pictures: vec![picture("x", [RED; 4])], ..View::default() };
    let broken = Picture { label: "broken".into(), file: b"no picture".to_vec(), ..Picture::default() };
    let bad = View { name: "broken".into(), pictures: vec![broken.clone(), broken], ..View::default() };
    let bare = View { name: "bare".into(), legend: Some(Legend::default()), ..View::default() };
    vec![bare, single, bad]
}

/// Writes all pages except that of [`compare`] into a folder.
pub fn write_all(folder: &Path) {
    // Pictures of one colour reveal which of the two is visible.
    let whole = |label, color| picture(label, [color; 4]);
    let wipe = View { pictures: vec![whole("red", RED), whole("blue", BLUE)], ..View::default() };
    let of_views = |views| Page { views, ..Page::default() };
    let pages = [
        ("wipe", of_views(vec![wipe])),
        ("views", of_views(views())),
        ("long", Page { sections: vec![table(), histogram()], ..of_views(views()) }),
        ("full", full()),
        ("certificate", certificate()),
        ("empty", Page::default()),
        ("hollow", Page { sections: hollow().into(), ..of_views(vec![View::default()]) }),
        ("odd", of_views(odd())),
    ];
    for (name, page) in pages {
        write(&folder.join(format!("{name}.html")), html(&page).as_bytes());
    }
}

fn write(path: &Path, content: &[u8]) {
    std::fs::write(path, content).expect("the folder is writable");
}

/// A square that faces the camera; its normal map tilts all of it.
const SQUARE: &str = "mtllib square.mtl\nusemtl square\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";

/// Writes `compared/report.html` into a folder with the command: `smooth` next to `tangent-normal`, which is darker.
pub fn compare(folder: &Path) {
    write(&folder.join("square.obj"), SQUARE.as_bytes());
    write(&folder.join("square.mtl"), b"newmtl square\nKd 0.8 0.8 0.8\nnorm tilted.png\n");
    // x = 0.8 and z = 0.6, away from the light.
    write(&folder.join("tilted.png"), &quarters([[230, 128, 204]; 4]));
    let output = Command::new(env!("CARGO_BIN_EXE_taotie"))
        .args(["compare", "square.obj", "--method", "smooth,tangent-normal", "--orbit", "0,0"])
        .args(["--size", "96x96", "--light", "directional from=0,0", "--ambient", "0", "-o", "compared"])
        .current_dir(folder)
        .output()
        .expect("the command runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
