//! Which files are scans, on file systems with odd names and broken links.

use crate::collection::{Collection, QUICK, number, text};
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::symlink;
use std::process::Output;

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_name_that_is_not_utf_8_costs_one_record() {
    let collection = Collection::of_balls(1);
    let broken = collection.path("scans").join(OsStr::from_bytes(b"b\xe9.obj"));
    if std::fs::write(broken, "v 0 0 0\n").is_err() {
        println!("skipped: this file system has only UTF-8 names");
        return;
    }
    let (code, report) = collection.report("");
    assert_eq!((code, number(&report, "/states/done"), number(&report, "/attempts")), (Some(2), 1.0, 2.0));
    let error = text(&collection.last()["b%E9.obj"], "/error");
    assert!(error.contains("b%E9.obj") && error.contains("UTF-8"), "{error}");
    // The same by a pattern: nothing is left to do, and the earlier failure is named again.
    let glob = format!("output = \"out\"\n[[source]]\nglob = \"scans/*.obj\"\n{QUICK}");
    collection.write("collection.toml", glob);
    let output = collection.run("--retry-failed");
    assert!(output.status.code() == Some(2) && stderr(&output).contains(&error), "{}", stderr(&output));
    assert_eq!(collection.records().len(), 2);
}

/// Folders as the program sees them are relative, so that their own names do not matter.
#[test]
fn a_folder_whose_name_is_not_utf_8_is_no_obstacle() {
    let collection = Collection::new(QUICK);
    let folder = collection.path("").join(OsStr::from_bytes(b"b\xe9"));
    if std::fs::create_dir(&folder).is_err() {
        println!("skipped: this file system has only UTF-8 names");
        return;
    }
    std::fs::write(folder.join("ball.obj"), crate::collection::ball(0.01)).unwrap();
    let text = format!("[[source]]\nfolder = \".\"\n{QUICK}");
    std::fs::write(folder.join("collection.toml"), text).unwrap();
    for line in ["", "--check --proofs 1"] {
        let mut command = collection.command(line);
        let output = command.arg(folder.join("collection.toml")).output().expect("the command runs");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}

#[test]
fn broken_links_cost_a_record_or_a_warning() {
    let collection = Collection::of_balls(1);
    symlink("nowhere", collection.path("scans/lost.obj")).unwrap();
    symlink("self.obj", collection.path("scans/self.obj")).unwrap();
    symlink("nowhere", collection.path("scans/older")).unwrap();
    std::fs::create_dir(collection.path("scans/deep")).unwrap();
    symlink("..", collection.path("scans/deep/up")).unwrap();
    symlink("../..", collection.path("scans/deep/above")).unwrap();
    let output = collection.run("");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    for skipped in
        ["older: the link's target", "deep/up: the link leads back", "deep/above: the link leads back"]
    {
        assert!(stderr(&output).contains(&format!("skipped scans/{skipped}")), "{}", stderr(&output));
    }
    let last = collection.last();
    assert_eq!(last.keys().collect::<Vec<_>>(), ["ball0.obj", "lost.obj", "self.obj"]);
    let lost = text(&last["lost.obj"], "/error");
    assert!(lost.contains("link scans/lost.obj") && lost.contains("does not exist"), "{lost}");
    assert!(text(&last["self.obj"], "/error").contains("scans/self.obj: "), "{}", last["self.obj"]);
    assert_eq!(text(&last["ball0.obj"], "/state"), "done");
    // Once its target exists, it is a scan like any other.
    std::fs::copy(collection.path("scans/ball0.obj"), collection.path("scans/nowhere")).unwrap();
    let (_, report) = collection.report("");
    assert_eq!((number(&report, "/attempts"), number(&report, "/states/done")), (1.0, 2.0), "{report}");
}

#[test]
fn ids_that_differ_only_in_case_are_refused() {
    let collection = Collection::of_balls(1);
    collection.write("scans/Ball0.OBJ", "v 0 0 0\n");
    if std::fs::read(collection.path("scans/ball0.obj")).unwrap().len() < 10 {
        println!("skipped: this file system ignores case");
        return;
    }
    let output = collection.run("");
    let said = stderr(&output);
    assert!(output.status.code() == Some(2) && said.contains("`Ball0.OBJ` and `ball0.obj`"), "{said}");
    assert!(!collection.path("out").exists(), "nothing was started");
}

#[test]
fn later_runs_name_what_failed_before_and_why() {
    let collection = Collection::new(&format!("require = [\"mean-angle=0.001\"]\n{QUICK}"));
    collection.write("scans/ball.obj", crate::collection::ball(0.01));
    collection.write("scans/broken.obj", "v 1 2\n");
    let first = stderr(&collection.run(""));
    let second = collection.run("");
    assert!(String::from_utf8_lossy(&second.stdout).contains("(2 from earlier runs)"));
    let said = stderr(&second);
    for part in ["broken.obj: failed: scans/broken.obj: line 1: ", "ball.obj: required-not-met: mean-angle"] {
        assert!(first.contains(part) && said.contains(part), "{first}\n{said}");
    }
}
