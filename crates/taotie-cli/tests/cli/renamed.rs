//! Options of earlier versions.

use super::models::TRIANGLE;
use super::place::Place;
use snapbox::str;

#[test]
fn earlier_options_name_their_replacement() {
    let place = Place::with("a.obj", TRIANGLE);
    place.taotie("bake a.obj -o a.glb --for web").assert().code(2).stderr_eq(str![[r#"
error: unexpected argument '--for [<VALUE>]' found

  tip: use `--preset` instead

Usage: taotie bake [OPTIONS] --output <OUT> <HIGH>...

For more information, try '--help'.

"#]]);
    for (option, new) in [
        ("--webp", "--images webp"),
        ("--webp-quality 80", "--images webp:QUALITY"),
        ("--jpeg=90", "--images jpeg:QUALITY"),
        ("--ktx2", "--images ktx2"),
        ("--uastc-rdo 2", "--images ktx2:LAMBDA"),
    ] {
        let assert = place.taotie(&format!("bake a.obj -o a.glb {option}")).assert().code(2);
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(stderr.contains(&format!("use `{new}` instead")), "{option}: {stderr}");
    }
}
