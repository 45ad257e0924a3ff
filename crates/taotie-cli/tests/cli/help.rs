//! Help pages.

use super::place::Place;
use snapbox::str;

#[test]
fn the_program_names_its_subcommands() {
    Place::new().taotie("--help").assert().success().stderr_eq("").stdout_eq(str![[r#"
Puts a scan's relief on a light mesh and shades it by physics

Usage: taotie <COMMAND>

Commands:
  render     Renders a model to a picture
  compare    Renders a model by several surface methods and measures how they differ
  bake       Bakes a scan's relief onto a light mesh and proves that it looks the same
  inspect    Says what is in a model and what is wrong with it
  normals    Makes normal maps from heights, and converts them
  diff       Says how two pictures or normal maps differ
  materials  Lists the materials that `--material` knows
  demo       Renders the built-in bronze jue by every method and model, and measures them

Options:
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
