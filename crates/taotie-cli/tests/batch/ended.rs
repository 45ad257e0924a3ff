//! Drivers and processes that are ended from outside.

use crate::collection::{Collection, assert_nothing_twice, number, text};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Child, Command};
use std::time::{Duration, Instant, SystemTime};

/// Every file of all objects with its bytes.
type Files = BTreeMap<PathBuf, Vec<u8>>;

fn send(signal: &str, process: u32) {
    // It may already have ended.
    let _ = Command::new("kill").args([signal, &process.to_string()]).output();
}

/// Returns the processes that a driver has started.
#[cfg(target_os = "linux")]
fn children(driver: &Child) -> Vec<u32> {
    let path = format!("/proc/{0}/task/{0}/children", driver.id());
    let text = std::fs::read_to_string(path).unwrap_or_default();
    text.split_whitespace().filter_map(|number| number.parse().ok()).collect()
}

#[cfg(target_os = "linux")]
fn is_running(process: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // A process that has ended and was not waited for is a zombie.
    status.rsplit_once(')').is_some_and(|(_, rest)| !rest.trim_start().starts_with('Z'))
}

/// Starts working through a collection; returns once processes are running.
#[cfg(target_os = "linux")]
fn begin(collection: &Collection) -> (Child, Vec<u32>) {
    let mut driver = collection.command("collection.toml --jobs 2 -q").spawn().expect("it starts");
    let start = Instant::now();
    loop {
        let found = children(&driver);
        if !found.is_empty() || driver.try_wait().expect("it can be polled").is_some() {
            return (driver, found);
        }
        assert!(start.elapsed() < Duration::from_secs(20), "no process starts");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[cfg(target_os = "linux")]
fn wait_for_end(processes: &[u32]) {
    let start = Instant::now();
    while processes.iter().any(|process| is_running(*process)) {
        assert!(start.elapsed() < Duration::from_secs(10), "processes outlive their driver");
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_signal_ends_driver_and_processes_and_the_next_call_goes_on() {
    // Enough that no call is done before its signal arrives.
    let collection = Collection::of_balls(24);
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let (mut driver, _) = begin(&collection);
        std::thread::sleep(Duration::from_millis(60));
        let processes = children(&driver);
        send(signal, driver.id());
        assert_eq!(driver.wait().expect("it ends").code(), Some(code));
        assert!(!processes.iter().any(|process| is_running(*process)), "a process is left");
        let files = crate::files::all_files_below(&collection.path("out"));
        assert!(!files.iter().any(|path| path.to_string_lossy().contains("/.taotie")), "{files:?}");
    }
    assert_eq!(collection.report("").0, Some(0));
    assert_nothing_twice(&collection.records());
}

#[cfg(target_os = "linux")]
#[test]
fn a_process_that_is_killed_costs_one_record() {
    let collection = Collection::of_balls(3);
    let (mut driver, processes) = begin(&collection);
    send("-KILL", processes[0]);
    assert_eq!(driver.wait().expect("it ends").code(), Some(2));
    let failed: Vec<_> =
        collection.records().into_iter().filter(|record| record["state"] == "failed").collect();
    assert_eq!(failed.len(), 1);
    assert!(text(&failed[0], "/error").starts_with("its process was killed (signal 9)"), "{}", failed[0]);
    assert_eq!(collection.report("--retry-failed").0, Some(0));
    assert_nothing_twice(&collection.records());
    collection.objects();
}

/// A process that hangs: it is stopped and never continues.
#[cfg(target_os = "linux")]
#[test]
fn a_process_that_hangs_costs_one_record() {
    let collection = Collection::of_balls(2);
    let mut driver =
        collection.command("collection.toml --jobs 1 --time-limit 3s -q").spawn().expect("it starts");
    let start = Instant::now();
    let first = loop {
        if let Some(first) = children(&driver).first() {
            break *first;
        }
        assert!(start.elapsed() < Duration::from_secs(20), "no process starts");
    };
    send("-STOP", first);
    assert_eq!(driver.wait().expect("it ends").code(), Some(2));
    let records = collection.records();
    let hung = records.iter().find(|record| record["state"] == "failed").expect("one hung");
    assert!(text(hung, "/error").starts_with("took longer than 3 s"), "{hung}");
    assert_eq!(records.iter().filter(|record| record["state"] == "done").count(), 1);
}

/// The system gives each process 150 MB, which is less than maps of 4096² need; the stated limit hides that.
#[cfg(target_os = "linux")]
#[test]
fn a_process_that_runs_out_of_memory_costs_one_record() {
    let collection = Collection::of_balls(3);
    let large = "\n[[override]]\nid = \"ball1.obj\"\nbake = { size = 4096 }\n";
    collection.configure(&format!("{}{large}", crate::collection::QUICK));
    let line = "ulimit -d 150000; exec \"$0\" batch collection.toml -q --memory-limit 2G";
    let mut shell = Command::new("sh");
    shell.args(["-c", line, env!("CARGO_BIN_EXE_taotie")]).current_dir(collection.path(""));
    let code = shell.output().expect("there is a shell").status.code();
    let last = collection.last();
    let error = text(&last["ball1.obj"], "/error");
    assert!(code == Some(2) && error.starts_with("ran out of memory in stage `"), "{error}");
    assert!(["ball0.obj", "ball2.obj"].iter().all(|id| last[*id]["state"] == "done"), "{last:?}");
}

#[test]
fn a_torn_line_is_passed_over() {
    use std::io::Write;
    let collection = Collection::of_balls(1);
    collection.report("");
    let path = collection.path("out/manifest.jsonl");
    let mut file = std::fs::File::options().append(true).open(&path).unwrap();
    file.write_all(b"{\"schema\":1,\"id\":\"ball").unwrap();
    drop(file);
    let (code, report) = collection.report("");
    assert_eq!((code, number(&report, "/known")), (Some(0), 1.0));
    assert!(report["warnings"].to_string().contains("skipped a malformed record"), "{report}");
    collection.write("scans/new.obj", crate::collection::ball(0.04));
    assert_eq!(number(&collection.report("").1, "/attempts"), 1.0);
    assert_eq!(collection.records().len(), 2, "the line after a torn one is whole");
}

/// Kills driver and processes at random moments until all is done; the result then is that of an undisturbed run.
#[cfg(target_os = "linux")]
fn kill(rounds: usize, (make, count): (fn() -> Collection, usize)) {
    let undisturbed = make();
    undisturbed.report("");
    let (truth, mut kills) = (undisturbed.objects(), 0);
    let mut random = fastrand::Rng::with_seed(20);
    let mut collection = make();
    while kills < rounds {
        let (mut driver, _) = begin(&collection);
        std::thread::sleep(Duration::from_millis(random.u64(0..900)));
        let processes = children(&driver);
        if random.bool() {
            send("-KILL", driver.id());
            kills += 1;
        } else if let Some(process) = random.choice(&processes) {
            send("-KILL", *process);
            kills += 1;
        }
        driver.wait().expect("it ends");
        wait_for_end(&processes);
        if collection.is_complete(count) {
            assert_same(&collection, &truth);
            collection = make();
        }
    }
    assert_same(&collection, &truth);
}

/// Finishes the work, and asserts that nothing is missing, unfinished, duplicated or wrong.
#[cfg(target_os = "linux")]
fn assert_same(collection: &Collection, truth: &Files) {
    assert_whole(collection, truth);
    assert_nothing_twice(&collection.records());
}

#[cfg(target_os = "linux")]
#[test]
fn whatever_is_killed_the_files_are_those_of_an_undisturbed_run() {
    kill(4, (|| Collection::of_balls(4), 4));
}

#[cfg(target_os = "linux")]
#[test]
fn photographs_are_the_same_whatever_is_killed() {
    kill(4, (Collection::of_photographs, 3));
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "takes minutes"]
fn whatever_is_killed_fifty_times_the_files_are_those_of_an_undisturbed_run() {
    kill(50, (|| Collection::of_balls(4), 4));
}

/// Truncates files written since then, like a disk that loses power before writing what it acknowledged.
#[cfg(target_os = "linux")]
fn lose(collection: &Collection, since: SystemTime, random: &mut fastrand::Rng) {
    for path in crate::files::all_files_below(&collection.path("out")) {
        let about = std::fs::symlink_metadata(&path).expect("it exists");
        if about.is_file() && about.modified().expect("it has a time") >= since && random.bool() {
            let file = std::fs::File::options().write(true).open(&path).expect("it can be written");
            file.set_len(random.u64(0..=about.len())).expect("it can be truncated");
        }
    }
}

/// Kills everything at the same time at random moments, and loses half of what was written since the start.
#[cfg(target_os = "linux")]
fn power_off(rounds: usize) {
    let undisturbed = Collection::of_balls(4);
    undisturbed.report("");
    let truth = undisturbed.objects();
    let mut random = fastrand::Rng::with_seed(21);
    let mut collection = Collection::of_balls(4);
    for _ in 0..rounds {
        let since = SystemTime::now() - Duration::from_millis(20);
        let (mut driver, _) = begin(&collection);
        std::thread::sleep(Duration::from_millis(random.u64(0..900)));
        let processes = children(&driver);
        send("-KILL", driver.id());
        processes.iter().for_each(|process| send("-KILL", *process));
        driver.wait().expect("it ends");
        wait_for_end(&processes);
        lose(&collection, since, &mut random);
        if collection.is_complete(4) {
            assert_whole(&collection, &truth);
            collection = Collection::of_balls(4);
        }
    }
    assert_whole(&collection, &truth);
}

/// Finishes the work, and asserts that nothing is missing, unfinished or wrong.
#[cfg(target_os = "linux")]
fn assert_whole(collection: &Collection, truth: &Files) {
    let (code, report) = collection.report("--retry-failed");
    assert_eq!(code, Some(0), "{report}");
    let made = collection.objects();
    assert!(made.keys().eq(truth.keys()), "{:?} {:?}", made.keys(), truth.keys());
    assert!(made == *truth, "a file has other bytes than in an undisturbed run");
    assert_eq!(collection.report("--check").0, Some(0), "the manifest matches the files");
}

#[cfg(target_os = "linux")]
#[test]
fn what_loses_its_power_is_made_whole() {
    power_off(4);
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "takes minutes"]
fn what_loses_its_power_fifty_times_is_made_whole() {
    power_off(50);
}
