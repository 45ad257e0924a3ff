//! Help pages.

use super::place::Place;

// The cargo feature `mcp` adds a subcommand.
#[cfg(not(feature = "mcp"))]
#[test]
fn the_program_names_its_subcommands() {
    Place::new().taotie("--help").assert().success().stderr_eq("").stdout_eq(snapbox::str![[r#"
Bakes high-poly scans to low-poly glTF with normal maps, renders them, and measures the error

Usage: taotie [OPTIONS] <COMMAND>

Commands:
  render       Renders a model to a picture or an animation
  compare      Renders a model with several surface methods and measures their error
  bake         Bakes a high-poly scan to low-poly glTF with a normal map, and measures the error
  verify       Compares an asset, made with any program, with its scan
  batch        Bakes the scans of a collection, and estimates normals from its photographs
  inspect      Lists the content of a model file and its defects
  normals      Makes normal maps from height maps, and converts normal maps
  photometric  Estimates normals from photographs, each with its uncertainty in degrees
  diff         Measures the difference of two pictures or normal maps
  shader       Writes the shaders of a model's materials, or of a plain one
  view         Writes a model as a single offline web page, or opens it in a browser
  materials    Lists the material presets for `--material`
  demo         Renders the built-in bronze with every method and model, and measures the error
  completions  Prints a shell completion script for subcommands and options

Options:
  -q, --quiet    Print only results and errors: no progress, messages or warnings
  -h, --help     Print help
  -V, --version  Print version

"#]]);
}

#[test]
fn without_a_subcommand_the_help_goes_to_stderr() {
    let assert = Place::new().taotie("").assert().code(2).stdout_eq("");
    assert!(String::from_utf8_lossy(&assert.get_output().stderr).contains("Usage: taotie"));
}

#[test]
fn the_version_is_the_packages() {
    let version = format!("taotie {}\n", env!("CARGO_PKG_VERSION"));
    Place::new().taotie("--version").assert().success().stderr_eq("").stdout_eq(version);
}

#[test]
fn every_help_page_opens_with_an_example() {
    let place = Place::new();
    let help = |line: &str| {
        let assert = place.taotie(line).assert().success().stderr_eq("");
        String::from_utf8_lossy(&assert.get_output().stdout).into_owned()
    };
    let top = help("--help");
    let commands = top.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands: Vec<&str> = commands
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(commands.len() >= 3, "{top}");
    for command in commands {
        let page = help(&format!("{command} --help"));
        assert!(page.starts_with(&format!("Examples:\n  taotie {command}")), "{page}");
    }
}

#[test]
fn every_shell_gets_a_script() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let assert = Place::new().taotie(&format!("completions {shell}")).assert().success().stderr_eq("");
        let script = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
        for word in ["taotie", "inspect", "provenance"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
}

#[test]
fn every_subcommand_has_a_manual_page() {
    let place = Place::new();
    let output = place.taotie("man-pages man").assert().success().stderr_eq("").get_output().clone();
    let help = place.taotie("--help").output().expect("the command runs").stdout;
    let help = String::from_utf8_lossy(&help).into_owned();
    let commands =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = commands.filter_map(|line| Some(format!("taotie-{}.1", line.split_whitespace().next()?)));
    let mut expected: Vec<String> = names.chain([String::from("taotie.1")]).collect();
    expected.sort();
    let printed = String::from_utf8(output.stdout).expect("names are text");
    let mut written: Vec<&str> = printed.lines().filter_map(|line| line.strip_prefix("man/")).collect();
    written.sort_unstable();
    assert_eq!(written, expected);
    let page = String::from_utf8(place.read("man/taotie-bake.1")).expect("a page is text");
    for part in [".SH EXAMPLES", "taotie bake ", "taotie\\-bake", r"\-\-images"] {
        assert!(page.contains(part), "{part} is missing from {page}");
    }
}

#[test]
fn help_may_come_first() {
    let place = Place::new();
    let said = |line: &str| place.taotie(line).output().expect("the command runs").stdout;
    assert_eq!(said("help bake"), said("bake --help"));
    assert_eq!(said("help"), said("--help"));
    place.taotie("help origami").assert().code(2);
}
