//! The collection's page, and the files next to it.

use crate::collection::{Collection, QUICK};
use crate::files::all_files_below;
use crate::schemas;
use serde_json::Value;

#[test]
fn the_page_links_what_was_made_and_says_what_was_not() {
    let collection = Collection::of_balls(1);
    let broken = "v 1 2 </script><b>\n";
    collection.write("scans/b & c.obj", broken);
    let address = "title = \"Balls & more\"\naddress = \"https://museum.example/balls/\"\n";
    collection.configure(&format!("{address}{QUICK}"));
    collection.report("");
    let read = |name: &str| std::fs::read_to_string(collection.path(&format!("out/{name}"))).unwrap();
    let page = read("index.html");
    assert!(page.contains("<title>Balls &amp; more</title>") && page.matches("</script>").count() == 2);
    let data: Value = serde_json::from_str(&read("collection.json")).unwrap();
    schemas::check("batch-collection", &data);
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    let inside: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    assert_eq!(inside, data);
    let [broken, ball] = [&data["assets"][0], &data["assets"][1]];
    assert_eq!((&broken["state"], &ball["state"]), (&"failed".into(), &"done".into()));
    assert!(broken["error"].as_str().unwrap().contains("line 1"), "{broken}");
    for key in ["model", "report", "thumbnail"] {
        let path = collection.path("out").join(ball[key].as_str().unwrap());
        assert!(path.is_file(), "{key}");
    }
    let iiif: Value = serde_json::from_str(&read("iiif.json")).unwrap();
    assert_eq!((&iiif["type"], iiif["items"].as_array().unwrap().len()), (&"Collection".into(), 1));
    let body = &iiif["items"][0]["items"][0]["items"][0]["items"][0]["body"][0];
    let model = format!("https://museum.example/balls/{}", ball["model"].as_str().unwrap());
    assert_eq!((&body["type"], &body["id"]), (&"Model".into(), &model.into()));
}

#[test]
fn assets_that_nobody_has_attempted_stand_on_the_page_too() {
    let collection = Collection::of_balls(1);
    assert_eq!(collection.run("--page-only").status.code(), Some(0));
    let data: Value =
        serde_json::from_slice(&std::fs::read(collection.path("out/collection.json")).unwrap()).unwrap();
    schemas::check("batch-collection", &data);
    assert_eq!(data["assets"][0]["state"], "waiting");
}

#[test]
fn nothing_that_is_written_names_a_folder_of_the_machine() {
    let collection = Collection::of_balls(1);
    collection.write("scans/broken.obj", "v 1 2\n");
    collection.configure(&format!("report = true\nviewer = true\n{QUICK}"));
    let mut command = collection.command("--json");
    // Given by its full path, from another folder.
    let output = command.arg(collection.path("collection.toml")).current_dir(std::env::temp_dir()).output();
    let output = output.expect("the command runs");
    let folder = collection.path("").to_string_lossy().trim_end_matches('/').to_owned();
    let names_it = |bytes: &[u8]| bytes.windows(folder.len()).any(|window| window == folder.as_bytes());
    let files = all_files_below(&collection.path("out"));
    assert!(files.iter().any(|file| file.to_string_lossy().ends_with(".report.html")), "{files:?}");
    for file in files {
        assert!(
            !names_it(&std::fs::read(&file).expect("it can be read")),
            "{} names {folder}",
            file.display()
        );
    }
    assert!(!names_it(&output.stdout), "{}", String::from_utf8_lossy(&output.stdout));
}
