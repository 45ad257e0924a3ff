//! Output on pages: a block without a language in `README.md` or `docs/*.md` is what a command prints, which a comment
//! in front of it names as `<!-- printed: COMMAND -->`. A line that ends in ` ...` is cut off.

use crate::common::absent;
use crate::files::{data_files, files_below};
use std::path::{Path, PathBuf};
use std::process::Command;
use taotie::SurfaceMethod;
use taotie::comparison::{Comparison, ComparisonOptions, Method, Subject};
use taotie_engine::Progress;
use taotie_engine::names::Named;
use taotie_engine::render::RenderSettings;
use taotie_report::comparison::{Document, Options};
use taotie_study::demo::truth;
use taotie_study::jue;

/// A block on a page.
struct Block {
    page: PathBuf,
    /// The command that prints it; `None` if the page does not name it.
    command: Option<String>,
    lines: Vec<String>,
}

/// Returns all blocks of output on a page.
fn blocks_of(page: &Path) -> Vec<Block> {
    let text = std::fs::read_to_string(page).expect("the page is readable");
    let (mut blocks, mut before, mut open) = (Vec::new(), "", None);
    for line in text.lines() {
        match (line.trim_start().strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take().flatten()),
            (Some(""), None) => {
                let command =
                    before.strip_prefix("<!-- printed: ").and_then(|rest| rest.strip_suffix(" -->"));
                let command = command.map(str::to_owned);
                open = Some(Some(Block { page: page.to_path_buf(), command, lines: Vec::new() }));
            }
            (Some(_), None) => open = Some(None),
            (None, Some(Some(block))) => block.lines.push(line.to_owned()),
            (None, _) => {}
        }
        before = line;
    }
    blocks
}

/// Returns all blocks of output on the pages for users.
fn blocks() -> Vec<Block> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let docs = root.join("docs");
    let folders = [docs.clone(), docs.join("tutorials")];
    let is_page =
        |path: &PathBuf| path.parent().is_some_and(|folder| folders.iter().any(|one| one == folder));
    let pages = files_below(&docs, &["md"]).into_iter().filter(is_page);
    std::iter::once(root.join("README.md")).chain(pages).flat_map(|page| blocks_of(&page)).collect()
}

impl Block {
    /// Returns true if consecutive lines of the output are those of the block.
    fn is_in(&self, output: &str) -> bool {
        let lines: Vec<&str> = output.lines().collect();
        let is = |(shown, line): (&String, &&str)| match shown.strip_suffix(" ...") {
            Some(start) => line.starts_with(start),
            None => line == shown,
        };
        lines.windows(self.lines.len()).any(|window| self.lines.iter().zip(window).all(is))
    }
}

/// Runs a command of a page in a folder with the data that it reads, and returns its output and its messages; `None`
/// if the data is absent.
fn output(command: &str) -> Option<String> {
    let words: Vec<&str> = command.split(' ').collect();
    let ["taotie", "bake", scan, ..] = words[..] else { panic!("{command}: prepare its data here") };
    let (folder, names): (&str, &[&str]) = match scan {
        "nefertiti.obj" => ("odedstein-meshes/nefertiti", &["nefertiti-lowres.obj"]),
        "spot.obj" => ("odedstein-meshes/spot", &["spot.obj"]),
        "Box.gltf" => ("khronos-gltf-sample-assets/Box/glTF", &["Box.gltf", "Box0.bin"]),
        other => panic!("{other}: name its data here"),
    };
    let place = tempfile::tempdir().expect("temporary folders can be made");
    let all = data_files(folder, &["obj", "gltf", "bin"]);
    for name in names {
        let Some(file) = all.iter().find(|file| file.ends_with(name)) else {
            absent(&format!("{folder} lacks {name}"));
            return None;
        };
        let to = if names.len() == 1 { scan } else { name };
        std::fs::write(place.path().join(to), std::fs::read(file).expect("it is readable"))
            .expect("it is writable");
    }
    let mut run = Command::new(env!("CARGO_BIN_EXE_taotie"));
    let run = run.args(&words[1..]).current_dir(place.path()).output().expect("the command runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("it prints text");
    Some(text(run.stdout) + &text(run.stderr))
}

/// Returns the lines about errors of methods that `taotie demo` prints, without its pictures.
fn demo() -> String {
    let scene = jue::scene(2048);
    let high = jue::with_relief(&scene, jue::displaced_mesh(jue::FINEST));
    let method =
        |(name, _): (&str, &str)| Method::from(SurfaceMethod::from_name(name).expect("it is a method"));
    let all = truth::options(&scene).expect("the scene is sound");
    let options = ComparisonOptions {
        methods: truth::REASONS.map(method).to_vec(),
        settings: RenderSettings { shadows: false, ..all.settings.clone() },
        ..all
    };
    let subject = Subject::new("jue", &scene).with_reference("relief", &high);
    let compared = Comparison::of(&subject, &options, Progress::SILENT).expect("all can be rendered");
    truth::lines(&Document::new(&compared, &Options::default()).expect("it is JSON")).join("\n")
}

#[test]
fn blocks_of_output_are_what_the_commands_print() {
    let blocks = blocks();
    assert!(blocks.len() >= 4, "only {} blocks with a command were found", blocks.len());
    let mut faults = Vec::new();
    for block in &blocks {
        let page = block.page.display();
        let printed = match block.command.as_deref() {
            Some("taotie demo") => Some(demo()),
            Some(command) => output(command),
            None => {
                faults.push(format!("{page}: no command in front of\n{}", block.lines.join("\n")));
                continue;
            }
        };
        let Some(printed) = printed.filter(|printed| !block.is_in(printed)) else { continue };
        let command = block.command.as_deref().unwrap_or_default();
        faults.push(format!("{page}: `{command}` prints something else; update the page:\n{printed}"));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}
