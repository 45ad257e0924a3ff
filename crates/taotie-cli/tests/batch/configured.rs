//! `collection.toml`: errors are reported with their line, before any work.

use crate::collection::{Collection, QUICK, ball, text};

#[track_caller]
fn assert_told(text: &str, line: usize, why: &str) {
    let collection = Collection::new("");
    collection.write("scans/a.obj", "");
    collection.write("collection.toml", text);
    let output = collection.run("");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains(&format!("collection.toml: line {line}: ")) && stderr.contains(why), "{stderr}");
    assert!(!collection.path("out").exists(), "nothing was started");
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    let source = "[[source]]\nfolder = \"scans\"\n";
    assert_told("", 1, "source");
    assert_told("source = []", 1, "at least one [[source]]");
    assert_told(
        "[[source]]\nfolder = \"a\"\nglob = \"*\"\n",
        1,
        "one of `folder`, `photographs`, `glob` and `list`",
    );
    assert_told("[[source]]\nglob = \"***\"\n", 1, "glob: ");
    assert_told(
        &format!("{source}[bake]\ntriangels = 5\n"),
        4,
        "unknown key `triangels` in [bake]; expected one of ao_distance, ",
    );
    assert_told(&format!("{source}[bake]\ntriangles = \"many\"\n"), 4, "invalid type");
    assert_told(&format!("{source}[bake]\nmaps = [\"norm\"]\n"), 4, "unknown variant `norm`");
    assert_told(&format!("{source}[bake]\nsize = 4\n"), 4, "use 16 to 16384 texels");
    assert_told(
        &format!("{source}[packing]\nimages = \"gif\"\n"),
        4,
        "unknown image format `gif`: expected one of: ",
    );
    assert_told(
        &format!("{source}[scan]\nunits = \"mm\"\n"),
        4,
        "unknown key `units` in [scan]; expected one of ",
    );
    assert_told(&format!("{source}[scan]\nunit = \"ft\"\n"), 4, "unknown variant `ft`");
    assert_told(&format!("{source}[scan]\ncrease_angle_deg = 181\n"), 4, "between 0 and 180 degrees");
    assert_told(
        &format!("{source}[photometric]\ntruth = \"n.exr\"\n"),
        4,
        "unknown key `truth` in [photometric]; expected one of balls, encoding, flat, ",
    );
    assert_told(
        &format!("{source}[photometric]\nencoding = \"gamma\"\n"),
        4,
        "expected one of: auto, linear",
    );
    assert_told(&format!("{source}[photometric]\nballs = [[9, 9, 2]]\n"), 4, "at least 8 pixels");
    assert_told(&format!("{source}[photometric]\npixel_size = 0\n"), 4, "use a number above 0");
    assert_told(&format!("{source}[thumbnail]\nsize = 4\n"), 1, "thumbnail: a size of 4");
    assert_told(&format!("{source}[thumbnail]\nwidth = 4\n"), 3, "width");
    assert_told(&format!("require = [\n\"mean-angle=2\",\n\"beauty=1\"]\n{source}"), 3, "beauty");
    assert_told(&format!("{source}[run]\nmemory = \"much\"\n"), 4, "memory: ");
    assert_told(&format!("{source}[run]\ntime_limit = \"soon\"\n"), 4, "invalid time `soon`");
    assert_told(&format!("{source}[run]\njobs = 0\n"), 4, "at least one process");
    let over = "\n[[override]]\nid = \"a*\"\nbake.triangles = 50000\nbake.lods = [90000]\n";
    assert_told(&format!("{source}{over}"), 4, "the level of detail 90000");
    assert_told(&format!("{source}\n[[override]]\nid = \"[\"\n"), 5, "id: ");
    assert_told(
        &format!("{source}\n[[override]]\nid = \"a\"\nverify.sharp = 1\n"),
        6,
        "unknown key `sharp` in [verify]",
    );
}

#[test]
fn lists_name_scans_with_ids_and_titles() {
    let collection = Collection::new(QUICK);
    collection.write("scans/a.obj", ball(0.01));
    collection.write("scans/b.obj", ball(0.02));
    collection.write(
        "list.csv",
        "path,id,title,rights\nscans/a.obj,first/a,A ball,CC0\nscans/b.obj,,\"B, too\",\n",
    );
    collection.write("list.jsonl", "{\"path\": \"scans/a.obj\", \"id\": \"again\"}\n\n");
    let lists = "output = \"out\"\n[[source]]\nlist = \"list.csv\"\n[[source]]\nlist = \"list.jsonl\"\n[[source]]\nglob = \"scans/*.obj\"\n";
    collection
        .write("collection.toml", format!("{lists}{QUICK}\n[[override]]\nid = \"c*\"\nreport = false\n"));
    let output = collection.run("");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(
        stderr.contains("ignored unknown column `rights`") && stderr.contains("`c*` matches no asset"),
        "{stderr}"
    );
    let last = collection.last();
    assert_eq!(last.keys().collect::<Vec<_>>(), ["a.obj", "again", "b.obj", "first/a", "scans/b.obj"]);
    assert_eq!(
        (&last["first/a"]["title"], &last["scans/b.obj"]["title"]),
        (&"A ball".into(), &"B, too".into())
    );
    collection.write("list.csv", "path,id\nscans/a.obj,x\nscans/b.obj,x\n");
    let stderr = String::from_utf8_lossy(&collection.run("").stderr).into_owned();
    assert!(stderr.contains("the id `x`: used by both scans/a.obj and scans/b.obj"), "{stderr}");
    collection.write("list.csv", "file\nscans/a.obj\n");
    let stderr = String::from_utf8_lossy(&collection.run("").stderr).into_owned();
    assert!(stderr.contains("list.csv: line 1: ") && stderr.contains("`path`"), "{stderr}");
}

#[test]
fn scans_are_read_as_their_table_says() {
    let collection = Collection::new("");
    collection.write("scans/a.obj", ball(0.01));
    collection.write("scans/b.obj", ball(0.02));
    let tables = "\n[scan]\nunit = \"mm\"\n\n[[override]]\nid = \"b.obj\"\nscan = { unit = \"in\" }\n";
    collection.configure(&format!("require = [\"hausdorff=0.3mm\"]\n{QUICK}{tables}"));
    // Of a ball of a millimetre 100 triangles are nowhere so far, of a ball of an inch they are.
    let (code, report) = collection.report("");
    assert_eq!(code, Some(1), "{report}");
    let last = collection.last();
    let states = ["a.obj", "b.obj"].map(|id| text(&last[id], "/state"));
    assert_eq!(states, ["done", "required-not-met"]);
    #[cfg(unix)]
    for (id, path, unit) in [("a.obj", "a.obj/a.glb", 0.001), ("b.obj", "b.obj/b.glb", 0.0254)] {
        let path = collection.path("out/assets").join(path);
        let asset = taotie_io::load_model(&path).expect("the asset can be read").scene;
        let top = asset.bounds().expect("it has triangles").max.y;
        assert!((top / unit - 1.0).abs() < 0.05, "{id} is in metres: {top}");
    }
}
