//! The report page in a browser: what a hand does and an eye sees.

mod browser;

use browser::Tab;
use serde_json::json;
use std::path::PathBuf;
use taotie::image::Encoding;
use taotie::io::{PngColor, PngImage, PngSamples};
use taotie_report::{Cell, Column, Fact, Legend, Page, Picture, Section, Series, Tone, View, html};
use tempfile::TempDir;

const RED: [u8; 3] = [200, 30, 30];
const GREEN: [u8; 3] = [30, 160, 60];
const BLUE: [u8; 3] = [40, 60, 200];
const GREY: [u8; 3] = [128, 128, 128];

/// Side of the pictures, pixels.
const SIDE: u32 = 64;

/// A title that would like to be more than text.
const NASTY: &str = "</script><img src=x onerror=\"document.title='pwned'\">";

/// A picture whose quarters have these colours: top left, top right, bottom left, bottom right.
fn quarters(colors: [[u8; 3]; 4]) -> Vec<u8> {
    let half = SIDE / 2;
    let pixels = (0..SIDE * SIDE).map(|i| colors[(i / SIDE / half * 2 + i % SIDE / half) as usize]);
    let bytes: Vec<u8> = pixels.flatten().collect();
    let folder = tempfile::tempdir().expect("temporary folders can be made");
    let path = folder.path().join("p.png");
    let samples = PngSamples::U8(&bytes);
    let picture =
        PngImage { width: SIDE, height: SIDE, color: PngColor::Rgb, samples, encoding: Encoding::Srgb };
    taotie::io::write_png(&path, &picture).expect("a picture can be written");
    std::fs::read(&path).expect("it is there")
}

fn picture(label: &str, colors: [[u8; 3]; 4]) -> Picture {
    Picture { label: label.into(), note: format!("note of {label}"), png: quarters(colors) }
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
        facts: vec![Fact::new("model", NASTY), Fact::new("size", "64 × 64")],
        views: views(),
        sections: vec![prose, table(), histogram()],
        footer: "the end".into(),
    }
}

/// A page on disk, and the folder that it is in.
fn written(page: &Page) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("temporary folders can be made");
    let path = folder.path().join("page.html");
    std::fs::write(&path, html(page)).expect("the folder is writable");
    (folder, path)
}

fn open(page: &Page, size: [u32; 2]) -> Option<(TempDir, Tab)> {
    let (folder, path) = written(page);
    Some((folder, browser::open(&path, size)?))
}

fn same(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 3)
}

/// Fails unless a point of the window, in fractions of an element, has this colour.
fn assert_color(tab: &mut Tab, element: &str, [u, v]: [f64; 2], wanted: [u8; 3]) {
    let [x, y, width, height] = tab.place(element);
    let found = tab.screenshot().at([x + u * width, y + v * height]);
    assert!(same(found, wanted), "{element} at {u}, {v}: {found:?} instead of {wanted:?}");
}

const WIPE: &str = ".wipe .frame";

/// Point of the wipe by its share of the width, low enough to be clear of the knob.
fn across(share: f64) -> [f64; 2] {
    [share, 0.3]
}

#[test]
fn the_wipe_uncovers_what_a_hand_asks_for() {
    // Whole pictures of one colour tell which of the two is seen.
    let whole = |label, color| picture(label, [color; 4]);
    let view = View { pictures: vec![whole("red", RED), whole("blue", BLUE)], ..View::default() };
    let page = Page { views: vec![view], ..Page::default() };
    let Some((_folder, mut tab)) = open(&page, [1200, 900]) else { return };
    for (share, color) in [(0.1, RED), (0.4, RED), (0.6, BLUE), (0.9, BLUE)] {
        assert_color(&mut tab, WIPE, across(share), color);
    }
    let [x, y, width, height] = tab.place(WIPE);
    let at = |share: f64| [x + share * width, y + height / 2.0];
    tab.drag(at(0.5), at(0.25));
    for (share, color) in [(0.1, RED), (0.22, RED), (0.28, BLUE), (0.4, BLUE)] {
        assert_color(&mut tab, WIPE, across(share), color);
    }
    assert_eq!(tab.value("document.querySelector('.handle').ariaValueNow"), "25");
    tab.touch(&[(at(0.25), at(0.75))]);
    assert_color(&mut tab, WIPE, across(0.72), RED);
    assert_color(&mut tab, WIPE, across(0.78), BLUE);
    tab.value("document.querySelector('.handle').focus()");
    tab.key("Home");
    assert_color(&mut tab, WIPE, across(0.05), BLUE);
    for _ in 0..3 {
        tab.key("PageUp");
    }
    tab.key("ArrowRight");
    assert_eq!(tab.value("document.querySelector('.handle').ariaValueText"), "31 % red, 69 % blue");
    assert_color(&mut tab, WIPE, across(0.29), RED);
    assert_color(&mut tab, WIPE, across(0.33), BLUE);
    tab.drag(at(0.31), [x + width * 3.0, y]);
    assert_eq!(tab.value("document.querySelector('.handle').ariaValueNow"), "100");
    assert_color(&mut tab, WIPE, across(0.95), RED);
    tab.assert_quiet();
}

/// For each picture that is seen, the part of it that its frame shows: left, top, right, bottom in fractions.
fn seen(tab: &mut Tab) -> Vec<[f64; 4]> {
    let parts = tab.value(
        "[...document.querySelectorAll('.view:not([hidden]) .frame img')].map((image) => {
            const [all, frame] = [image.getBoundingClientRect(), image.closest('.frame').getBoundingClientRect()];
            const x = (v) => (v - all.x) / all.width, y = (v) => (v - all.y) / all.height;
            return [x(frame.left), y(frame.top), x(frame.right), y(frame.bottom)];
        })",
    );
    serde_json::from_value(parts).expect("numbers")
}

/// The part seen of every picture, which has to be the same one.
fn seen_in_step(tab: &mut Tab, pictures: usize) -> [f64; 4] {
    let parts = seen(tab);
    assert_eq!(parts.len(), pictures);
    for part in &parts {
        assert!(part.iter().zip(parts[0]).all(|(a, b)| (a - b).abs() < 1e-3), "out of step: {parts:?}");
    }
    parts[0]
}

#[test]
fn all_pictures_zoom_and_move_in_step() {
    let page = Page { views: views(), ..Page::default() };
    let Some((_folder, mut tab)) = open(&page, [1200, 900]) else { return };
    assert_eq!(seen_in_step(&mut tab, 5).map(f64::round), [0.0, 0.0, 1.0, 1.0]);
    // Over the second of the small ones, three quarters across and one down.
    let plate = "figure:nth-child(2) .frame";
    let [x, y, width, height] = tab.place(plate);
    let pointer = [x + 0.75 * width, y + 0.25 * height];
    for _ in 0..4 {
        tab.wheel(pointer, -240.0);
    }
    let [left, top, right, bottom] = seen_in_step(&mut tab, 5);
    let zoom = 1.0 / (right - left);
    assert!(zoom > 4.0 && ((bottom - top) * zoom - 1.0).abs() < 1e-3, "zoom {zoom}");
    let under = [left + 0.75 * (right - left), top + 0.25 * (bottom - top)];
    assert!(
        (under[0] - 0.75).abs() < 0.01 && (under[1] - 0.25).abs() < 0.01,
        "{under:?} is under the pointer"
    );
    assert_color(&mut tab, "figure:nth-child(1) .frame", [0.05, 0.5], GREY);
    let sharp = tab.value("getComputedStyle(document.querySelector('.wipe img')).imageRendering");
    assert_eq!(sharp, "pixelated");

    // A drag of the wipe's picture to the right by half a frame moves all by that.
    let [x, y, width, _] = tab.place(WIPE);
    tab.drag([x + 0.1 * width, y + 20.0], [x + 0.6 * width, y + 20.0]);
    let [moved, ..] = seen_in_step(&mut tab, 5);
    assert!((moved - (left - 0.5 / zoom)).abs() < 5e-3, "{left} to {moved}");

    // Far to the right: the borders hold, and the first quarter fills all frames.
    for _ in 0..6 {
        tab.drag([x + 0.1 * width, y + 20.0], [x + 0.95 * width, y + 20.0]);
    }
    let corner = seen_in_step(&mut tab, 5);
    assert!(corner[0].abs() < 1e-3, "{corner:?}");
    for (nth, color) in [(1, RED), (2, GREEN), (3, BLUE)] {
        assert_color(&mut tab, &format!("figure:nth-child({nth}) .frame"), [0.9, 0.9], color);
    }

    tab.click("[role=tab]:nth-child(2)", 1);
    let other = seen_in_step(&mut tab, 5);
    assert!(other.iter().zip(corner).all(|(a, b)| (a - b).abs() < 1e-3), "the other view has another lens");

    tab.click("figure:nth-child(3) .frame:not([hidden])", 2);
    tab.click(".view:not([hidden]) figure:nth-child(3) .frame", 2);
    assert_eq!(seen_in_step(&mut tab, 5).map(|v| (v * 1e3).round()), [0.0, 0.0, 1000.0, 1000.0]);
    tab.assert_quiet();
}

#[test]
fn two_fingers_zoom_and_a_page_that_scrolls_goes_on() {
    let page = Page { views: views(), sections: vec![table(), histogram()], ..Page::default() };
    let Some((_folder, mut tab)) = open(&page, [420, 800]) else { return };
    let [x, y, width, height] = tab.place(WIPE);
    let at = |u: f64, v: f64| [x + u * width, y + v * height];
    tab.touch(&[(at(0.4, 0.2), at(0.2, 0.2)), (at(0.6, 0.2), at(0.8, 0.2))]);
    let [left, top, right, _] = seen_in_step(&mut tab, 5);
    let zoom = 1.0 / (right - left);
    assert!((2.5..3.5).contains(&zoom), "fingers three times as far apart zoom by {zoom}");
    assert!((left + 0.5 / zoom - 0.5).abs() < 0.05 && (top + 0.2 / zoom - 0.2).abs() < 0.05, "{left} {top}");

    tab.click(WIPE, 2);
    let scrolled = tab.value("scrollY").as_f64().unwrap();
    let [x, y] = tab.middle(WIPE);
    tab.wheel([x, y - 60.0], 200.0);
    tab.until(&format!("scrollY > {scrolled} + 50"));
    assert_eq!(seen_in_step(&mut tab, 5).map(|v| (v * 1e3).round()), [0.0, 0.0, 1000.0, 1000.0]);
    tab.assert_quiet();
}

fn chosen(tab: &mut Tab) -> (String, String, String) {
    let text = |tab: &mut Tab, element: &str| {
        let find = format!("document.querySelector('{element}').textContent");
        tab.value(&find).as_str().unwrap().to_owned()
    };
    let view = text(tab, "[role=tab][aria-selected=true]");
    (view, text(tab, ".view:not([hidden]) .tag.left"), text(tab, ".view:not([hidden]) .tag.right"))
}

fn choice(view: &str, left: &str, right: &str) -> (String, String, String) {
    (view.into(), left.into(), right.into())
}

#[test]
fn what_is_chosen_stays_chosen_by_its_label() {
    let page = Page { views: views(), ..Page::default() };
    let Some((_folder, mut tab)) = open(&page, [1200, 900]) else { return };
    assert_eq!(chosen(&mut tab), choice("first", "red", "blue"));
    tab.click("figure:nth-child(3) [aria-label='Show blue on the left']", 1);
    tab.click("figure:nth-child(2) [aria-label='Show green on the right']", 1);
    assert_eq!(chosen(&mut tab), choice("first", "blue", "green"));
    tab.click("[role=tab]:nth-child(2)", 1);
    assert_eq!(chosen(&mut tab), choice("second", "blue", "green"));
    assert_color(&mut tab, ".view:not([hidden]) .wipe .frame", [0.25, 0.25], BLUE);
    tab.click(".view:not([hidden]) [title='Swap left and right']", 1);
    assert_eq!(chosen(&mut tab), choice("second", "green", "blue"));
    tab.value("document.querySelector('[role=tab][aria-selected=true]').focus()");
    tab.key("ArrowRight");
    assert_eq!(chosen(&mut tab), choice("first", "green", "blue"));
    tab.until("location.hash === '#view=first&left=green&right=blue'");

    // The address that the page gave itself brings the same back.
    tab.call("Page.reload", json!({}));
    tab.until("document.readyState === 'complete' && document.querySelector('.tag.left') !== null");
    assert_eq!(chosen(&mut tab), choice("first", "green", "blue"));
    tab.value("location.hash = '#view=second&left=nobody&right=red&zoom=4&x=0.5&wipe=many'");
    tab.until("document.querySelector('[role=tab]:nth-child(2)').ariaSelected === 'true'");
    assert_eq!(chosen(&mut tab), choice("second", "green", "red"));
    assert_eq!(seen_in_step(&mut tab, 5).map(|v| (v * 1e3).round()), [500.0, 0.0, 750.0, 250.0]);
    tab.assert_quiet();
}

#[test]
fn text_is_text_and_nothing_is_asked_of_the_network() {
    let Some((_folder, mut tab)) = open(&full(), [1200, 900]) else { return };
    assert_eq!(tab.value("document.title"), NASTY);
    assert_eq!(tab.value("document.querySelector('h1').textContent"), NASTY);
    assert_eq!(tab.value("[...document.images].filter((image) => !image.src.startsWith('data:')).length"), 0);
    assert_eq!(tab.value("document.querySelectorAll('script').length"), 2);
    tab.assert_quiet();
    // The browser itself refuses whatever a script that came in by mistake would try.
    tab.value("fetch('http://127.0.0.1:9/').then(() => 'sent', (error) => error.name)");
    tab.value("document.body.append(Object.assign(new Image(), { src: 'http://127.0.0.1:9/x.png' }))");
    tab.value("document.body.insertAdjacentHTML('beforeend', '<b onclick=\"document.title = 1\">x</b>')");
    tab.value("document.querySelector('b').click()");
    tab.settle();
    assert_eq!(tab.value("document.title"), NASTY);
    let complaints = tab.complaints();
    let refused = complaints.iter().filter(|text| text.contains("Content Security Policy")).count();
    assert!(refused >= 3, "{complaints:?}");
}

fn column(tab: &mut Tab, nth: usize) -> Vec<String> {
    let cells = tab.value(&format!(
        "[...document.querySelectorAll('td:nth-child({nth})')].map((cell) => cell.textContent)"
    ));
    serde_json::from_value(cells).expect("texts")
}

#[test]
fn tables_are_sorted_and_copied() {
    let Some((_folder, mut tab)) = open(&full(), [1200, 900]) else { return };
    let written = ["b, \"quoted\"", "none", "a10", "a9"];
    assert_eq!(column(&mut tab, 1), written);
    assert_eq!(column(&mut tab, 2), ["9.50", "–", "−12.00", "12\u{202f}345.68"]);
    assert_eq!(tab.value("getComputedStyle(document.querySelector('td:nth-child(2)')).textAlign"), "right");
    tab.click("th:nth-child(2) button", 1);
    assert_eq!(column(&mut tab, 1), ["a10", "b, \"quoted\"", "a9", "none"]);
    tab.click("th:nth-child(2) button", 1);
    assert_eq!(column(&mut tab, 1), ["a9", "b, \"quoted\"", "a10", "none"]);
    tab.click("th:nth-child(2) button", 1);
    assert_eq!(column(&mut tab, 1), written);
    tab.click("th:nth-child(1) button", 1);
    assert_eq!(column(&mut tab, 1), ["a9", "a10", "b, \"quoted\"", "none"]);
    tab.click("th:nth-child(3) button", 1);
    assert_eq!(column(&mut tab, 3), ["1", "21", "31", "4"], "the digit and the number of its reason");
    assert_eq!(tab.value("document.querySelector('.reasons').innerText"), "it differs");
    let csv = tab.value("csvOf(...Object.values(JSON.parse(document.getElementById('data').textContent).sections[1].table).slice(2))");
    let lines =
        "name,mean (°),judged\r\n\"b, \"\"quoted\"\"\",9.5,3\r\nnone,,1\r\na10,-12,2\r\na9,12345.678,4\r\n";
    assert_eq!(csv, lines);
    tab.assert_quiet();
}

#[test]
fn histograms_switch_and_are_read_together() {
    let Some((_folder, mut tab)) = open(&full(), [1200, 900]) else { return };
    let height = |tab: &mut Tab, nth: usize| {
        let path = format!("document.querySelectorAll('.panels .counts')[{nth}].getBBox().height");
        tab.value(&path).as_f64().unwrap()
    };
    let linear = [height(&mut tab, 0), height(&mut tab, 1)];
    assert!((linear[0] / linear[1] - 2.0).abs() < 0.01, "1000 against 500: {linear:?}");
    tab.click(".histogram input", 1);
    let logarithmic = [height(&mut tab, 0), height(&mut tab, 1)];
    let wanted = (3.0 + 0.3) / (2.69897 + 0.3); // log₁₀ of 1000 and of 500
    assert!((logarithmic[0] / logarithmic[1] - wanted).abs() < 0.01, "{logarithmic:?}");
    let [x, y, width, height] = tab.place(".panels svg");
    // The last of six bins between the margins.
    tab.hover([x + width * 0.94, y + height / 2.0]);
    let read = tab.value("[...document.querySelectorAll('.readout')].map((readout) => readout.textContent)");
    assert_eq!(read, json!(["≥ 2.5 °: 7, 0.67 %", "≥ 2.5 °: 1, 0.19 %"]));
    tab.assert_quiet();
}

#[test]
fn little_or_nothing_to_show_is_no_error() {
    let alone = View { name: "alone".into(), pictures: vec![picture("x", [RED; 4])], ..View::default() };
    let broken = Picture { label: "broken".into(), png: b"no picture".to_vec(), ..Picture::default() };
    let bad = View { name: "broken".into(), pictures: vec![broken.clone(), broken], ..View::default() };
    let legend = Legend::default();
    let bare = View { name: "bare".into(), legend: Some(legend), ..View::default() };
    let nothing = [
        Section::Text { title: String::new(), paragraphs: vec![] },
        Section::Table { title: String::new(), note: String::new(), columns: vec![], rows: vec![] },
        Section::Table {
            title: String::new(),
            note: String::new(),
            columns: vec![Column::words("x"), Column::words("y")],
            rows: vec![vec![], vec![Cell::text("more"), Cell::text("than"), Cell::text("columns")]],
        },
        Section::Histogram {
            title: String::new(),
            note: String::new(),
            unit: String::new(),
            bin_width: 0.0,
            last_is_open: false,
            series: vec![Series::default()],
        },
    ];
    let pages = [
        Page::default(),
        Page { views: vec![View::default()], sections: nothing.into(), ..Page::default() },
        Page { views: vec![bare, alone, bad], ..Page::default() },
    ];
    let Some((_folder, mut tab)) = open(&pages[0], [800, 600]) else { return };
    for page in &pages {
        let (_folder, path) = written(page);
        tab.go(&path);
        for button in 1..=3 {
            tab.value(&format!("document.querySelector('[role=tab]:nth-child({button})')?.click()"));
            tab.value("for (const b of document.querySelectorAll('th button, .lens button, .name button')) b.click()");
            tab.settle();
        }
        tab.assert_quiet();
    }
    assert_eq!(tab.value("document.querySelectorAll('.wipe').length"), 1, "one picture needs no wipe");
}

#[test]
fn every_width_has_room_for_the_page() {
    let Some((_folder, mut tab)) = open(&full(), [1800, 1000]) else { return };
    for width in [1800, 1200, 1000, 700, 400, 320] {
        tab.resize([width, 900]);
        tab.settle();
        let wide = tab.value("document.documentElement.scrollWidth").as_f64().unwrap();
        assert!(wide <= f64::from(width), "{wide} at a width of {width}");
        let [_, _, frame, _] = tab.place(WIPE);
        assert!(frame > f64::from(width.min(800)) * 0.45, "{frame} at a width of {width}");
    }
    let ground = "getComputedStyle(document.body).backgroundColor";
    let light = tab.value(ground);
    tab.prefer("dark");
    assert_ne!(tab.value(ground), light);
    tab.assert_quiet();
}

/// A square that faces the camera, whose normal map tilts all of it.
const SQUARE: &str = "mtllib square.mtl\nusemtl square\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";

#[test]
fn a_comparison_opens_from_disk_and_its_wipe_works() {
    let folder = tempfile::tempdir().expect("temporary folders can be made");
    let write = |name: &str, content: &[u8]| {
        std::fs::write(folder.path().join(name), content).expect("the folder is writable");
    };
    write("square.obj", SQUARE.as_bytes());
    write("square.mtl", b"newmtl square\nKd 0.8 0.8 0.8\nnorm tilted.png\n");
    // x = 0.8 and z = 0.6, away from the light.
    write("tilted.png", &quarters([[230, 128, 204]; 4]));
    let compare = std::process::Command::new(env!("CARGO_BIN_EXE_taotie"))
        .args([
            "compare",
            "square.obj",
            "--method",
            "smooth,tangent-normal",
            "--orbit",
            "0,0",
            "--size",
            "96x96",
        ])
        .args(["--light", "directional from=0,0", "--ambient", "0", "-o", "out"])
        .current_dir(folder.path())
        .output()
        .expect("the command runs");
    assert!(compare.status.success(), "{}", String::from_utf8_lossy(&compare.stderr));
    let Some(mut tab) = browser::open(&folder.path().join("out/report.html"), [1200, 900]) else { return };
    let [x, y, width, height] = tab.place(WIPE);
    let at = |share: f64| [x + share * width, y + height / 2.0];
    let seen = |tab: &mut Tab| tab.screenshot().at([x + 0.4 * width, y + 0.3 * height]);
    let smooth = seen(&mut tab);
    tab.drag(at(0.5), at(0.2));
    let tilted = seen(&mut tab);
    assert!(
        smooth[0] > tilted[0] + 20,
        "smooth {smooth:?} left of the handle, tilted {tilted:?} right of it"
    );
    tab.drag(at(0.2), at(0.8));
    assert!(same(seen(&mut tab), smooth));
    assert_eq!(tab.value("document.querySelectorAll('table').length"), json!(4));
    tab.assert_quiet();
}
