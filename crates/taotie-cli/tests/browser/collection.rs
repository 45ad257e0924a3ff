//! The page of a collection that `collection.test.mjs` tests.

use std::path::Path;
use taotie_engine::image::{Bitmap, Texels};
use taotie_io::encode_webp_bitmap;
use taotie_report::collection_page::{Entry, Gallery, html};

/// Number of assets on the page.
const COUNT: usize = 10_000;

/// Writes the page, and the one picture that all its assets share.
pub fn write(folder: &Path) {
    let red = Bitmap::new(16, 16, 3, Texels::U8(vec![[200, 30, 30, 255]; 256])).expect("a picture");
    std::fs::write(folder.join("red.webp"), encode_webp_bitmap(&red).expect("WebP")).expect("it is writable");
    let gallery = Gallery { title: "Ten thousand".into(), assets: (0..COUNT).map(entry).collect() };
    std::fs::write(folder.join("collection.html"), html(&gallery)).expect("it is writable");
}

fn entry(index: usize) -> Entry {
    let id = format!("room {}/{index:05}.ply", index / 100);
    let title = Some(format!("Asset {index}"));
    let why = "</script><b>line 1</b>";
    match index % 100 {
        7 => Entry { id, title, state: "failed".into(), error: Some(why.into()), ..Entry::default() },
        8 => {
            Entry { id, title, state: "refused".into(), error: Some("too large".into()), ..Entry::default() }
        }
        9 => Entry { id, title, state: "waiting".into(), ..Entry::default() },
        10 => Entry {
            state: "required-not-met".into(),
            unmet: vec!["mean-angle is 3°, at most 2°".into()],
            ..done(index, (id, title))
        },
        11 => {
            Entry { warnings: vec!["filled 12 holes of the scan".repeat(3); 7], ..done(index, (id, title)) }
        }
        _ => done(index, (id, title)),
    }
}

fn done(index: usize, (id, title): (String, Option<String>)) -> Entry {
    let angle = (index * 7919 % COUNT) as f64 / COUNT as f64;
    Entry {
        id,
        title,
        state: "done".into(),
        thumbnail: Some("red.webp".into()),
        report: Some("report.html".into()),
        model: Some("model.glb".into()),
        warnings: vec!["open edges".into()],
        triangles_in: Some(1000 * index),
        triangles: Some(500),
        bytes_in: Some(36_000 * index as u64),
        bytes_out: Some(100_000),
        mean_angle: Some(angle),
        p95_angle: Some(3.0 * angle),
        max_angle: Some(90.0),
        hausdorff: Some(0.001),
        missed: Some(0.0),
        seconds: Some(1.5),
        peak_bytes: Some(1 << 28),
        ..Entry::default()
    }
}
