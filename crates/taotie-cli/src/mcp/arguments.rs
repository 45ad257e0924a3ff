//! The arguments of a call, as a command line that names only files in the allowed folders.

use super::folders::Folders;
use super::tools::{
    JSON, OPTIONS, OUTPUT, REFUSED, Subcommand, is_flag, name_of, takes_only_path, takes_path,
};
use crate::{Cli, Command, studio};
use anyhow::{Result, anyhow, bail};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Parser};
use rmcp::model::JsonObject;
use serde_json::Value;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// A checked command line.
#[derive(Debug)]
pub struct CommandLine {
    /// The subcommand and its arguments. All paths are absolute.
    pub arguments: Vec<OsString>,
    /// Where the written files are; `None` if none is kept.
    pub written: Option<Written>,
}

/// Where a command writes.
#[derive(Debug)]
pub struct Written {
    /// The folder of the output.
    pub folder: PathBuf,
    /// All paths of the command line, some of them outputs in other folders.
    pub named: Vec<PathBuf>,
}

impl Written {
    /// Returns the path of a file that the report lists by name.
    pub fn path(&self, name: &str) -> PathBuf {
        let usual = self.folder.join(name);
        let elsewhere = || self.named.iter().find(|path| path.file_name() == Some(name.as_ref()));
        if usual.is_file() { usual } else { elsewhere().cloned().unwrap_or(usual) }
    }
}

impl CommandLine {
    /// Returns the command line of a call, whose `temporary` folder holds an output that is not kept.
    ///
    /// The arguments are parsed as the subcommand would parse them, and the line is rebuilt from the result, so that
    /// no spelling of an option avoids the check of its path.
    ///
    /// # Errors
    /// If an argument is invalid, not available to clients, or a file outside the folders.
    pub fn of(tool: &Subcommand, given: &JsonObject, place: (&Folders, &Path)) -> Result<Self> {
        let (folders, temporary) = place;
        let command = tool.command();
        let matches = command.clone().try_get_matches_from(words(tool, &command, given)?).map_err(reason)?;
        let mut line = Rebuilt {
            folders,
            options: vec![tool.name.into()],
            positional: Vec::new(),
            output: None,
            named: Vec::new(),
        };
        for arg in command.get_arguments() {
            if matches.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine) {
                line.add(arg, &matches)?;
            }
        }
        if line.output.is_none() && tool.may_lack_output {
            line.options.push(option(OUTPUT, temporary.join("picture.png").as_os_str()));
        }
        line.options.push(format!("--{JSON}").into());
        let folder = line.output.as_ref().and_then(|path| path.parent()).map(Path::to_path_buf);
        let written = folder.map(|folder| Written { folder, named: line.named });
        let arguments = [line.options, line.positional].concat();
        check_materials(&arguments, folders)?;
        Ok(Self { arguments, written })
    }
}

/// Returns the words of the command line for JSON arguments.
fn words(tool: &Subcommand, command: &clap::Command, given: &JsonObject) -> Result<Vec<OsString>> {
    let (mut words, mut positional) = (Vec::new(), Vec::new());
    for (name, value) in given.iter().filter(|(name, value)| *name != OPTIONS && !value.is_null()) {
        let unknown = || anyhow!("unknown argument `{name}`; pass other options in `{OPTIONS}`");
        let arg = tool.argument(command, name).ok_or_else(unknown)?;
        match (is_flag(arg), value, arg.get_long()) {
            (true, Value::Bool(false), _) => {}
            (true, Value::Bool(true), Some(long)) => words.push(format!("--{long}").into()),
            (true, ..) => bail!("`{name}`: expected true or false"),
            (false, _, long) => {
                for text in texts(arg, value)? {
                    match long {
                        Some(long) => words.push(option(long, text.as_ref())),
                        None => positional.push(OsString::from(text)),
                    }
                }
            }
        }
    }
    words.extend(further(given)?);
    words.push("--".into());
    Ok([words, positional].concat())
}

/// Returns the further options.
fn further(given: &JsonObject) -> Result<Vec<OsString>> {
    let wrong = || anyhow!("`{OPTIONS}`: expected a list of texts, such as [\"--threads\", \"2\"]");
    match given.get(OPTIONS) {
        None | Some(Value::Null) => Ok(Vec::new()),
        Some(Value::Array(items)) => {
            items.iter().map(|item| Ok(item.as_str().ok_or_else(wrong)?.into())).collect()
        }
        Some(_) => Err(wrong()),
    }
}

/// Returns the values of an argument: several only if it may be repeated.
fn texts(arg: &Arg, value: &Value) -> Result<Vec<String>> {
    let wrong = || anyhow!("`{}`: expected a text or a number", name_of(arg));
    let items = match value {
        Value::Array(items) => items.as_slice(),
        single => std::slice::from_ref(single),
    };
    let texts: Vec<String> = items.iter().map(|item| text(item).ok_or_else(wrong)).collect::<Result<_>>()?;
    let may_repeat = matches!(arg.get_action(), ArgAction::Append);
    Ok(if may_repeat || texts.len() == 1 { texts } else { vec![texts.join(",")] })
}

fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        // Some clients send whole numbers as 50000.0.
        Value::Number(number) => Some(match number.as_f64() {
            Some(whole) if whole.fract() == 0.0 && whole.abs() < 1e15 => format!("{whole:.0}"),
            _ => number.to_string(),
        }),
        _ => None,
    }
}

fn option(long: &str, value: &OsStr) -> OsString {
    let mut word = OsString::from(format!("--{long}="));
    word.push(value);
    word
}

/// Returns the message of a parsing error, without usage and hints for terminals.
fn reason(error: clap::Error) -> anyhow::Error {
    let text = error.to_string();
    let text = text.split("\n\nUsage:").next().unwrap_or_default();
    let text = text.split("\n\nFor more information").next().unwrap_or_default();
    anyhow!("{}", text.trim_start_matches("error: ").trim())
}

/// A command line that is rebuilt from parsed arguments.
struct Rebuilt<'a> {
    folders: &'a Folders,
    options: Vec<OsString>,
    /// The arguments without an option.
    positional: Vec<OsString>,
    output: Option<PathBuf>,
    /// All resolved paths.
    named: Vec<PathBuf>,
}

impl Rebuilt<'_> {
    /// Adds a parsed argument with all its values.
    fn add(&mut self, arg: &Arg, matches: &ArgMatches) -> Result<()> {
        let id = arg.get_id().as_str();
        if REFUSED.contains(&id) {
            bail!("--{}: not available to clients", arg.get_long().unwrap_or(id));
        }
        if is_flag(arg) {
            self.options.extend(arg.get_long().filter(|_| id != JSON).map(|long| format!("--{long}").into()));
            return Ok(());
        }
        for value in matches.get_raw(id).into_iter().flatten() {
            let value = self.confined(arg, value)?;
            if id == OUTPUT {
                self.output = Some(PathBuf::from(&value));
            }
            match arg.get_long() {
                Some(long) => self.options.push(option(long, &value)),
                None => self.positional.push(value),
            }
        }
        Ok(())
    }

    /// Returns a value, with a path resolved.
    fn confined(&mut self, arg: &Arg, value: &OsStr) -> Result<OsString> {
        // The subcommand runs in an empty folder, so that a plain word cannot name a file.
        if !takes_path(arg) || !takes_only_path(arg) && is_word(value) {
            return Ok(value.to_owned());
        }
        let resolved =
            self.folders.resolve(value).map_err(|error| anyhow!("`{}`: {error:#}", name_of(arg)))?;
        self.named.push(resolved.clone());
        Ok(resolved.into_os_string())
    }
}

/// Returns true for the name of something built in, such as `studio`.
fn is_word(value: &OsStr) -> bool {
    value.to_str().is_some_and(|text| {
        !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-')
    })
}

/// Rejects a material file whose maps are outside the folders.
fn check_materials(arguments: &[OsString], folders: &Folders) -> Result<()> {
    let line = std::iter::once(OsString::from("taotie")).chain(arguments.iter().cloned());
    if let Command::Render(args) = Cli::try_parse_from(line).map_err(reason)?.command {
        studio::material_files(&args.material)?.iter().try_for_each(|file| folders.check(file))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;

    /// Returns the line of a call in a folder with a few files, or the reason against it.
    fn line(tool: &str, given: Value) -> std::result::Result<String, String> {
        let place = tempfile::tempdir().unwrap();
        let inside = place.path().join("in");
        fs::create_dir(&inside).unwrap();
        fs::write(place.path().join("secret.png"), "").unwrap();
        fs::write(inside.join("a.toml"), "maps = { normal = '../secret.png' }").unwrap();
        fs::write(inside.join("b.toml"), "maps = { normal = 'n.png' }").unwrap();
        let folders = Folders::of_command(std::slice::from_ref(&inside), Path::new(".")).unwrap();
        let tool = Subcommand::named(tool).unwrap();
        let line = CommandLine::of(tool, given.as_object().unwrap(), (&folders, place.path()));
        let (inside, place) = (inside.canonicalize().unwrap(), place.path().display().to_string());
        let short = |text: String| text.replace(&inside.display().to_string(), "IN").replace(&place, "PLACE");
        match line {
            Ok(line) => {
                let words: Vec<_> =
                    line.arguments.iter().map(|word| word.to_string_lossy().into_owned()).collect();
                Ok(short(words.join(" ")))
            }
            Err(error) => Err(short(format!("{error:#}"))),
        }
    }

    #[test]
    fn arguments_become_a_command_line() {
        let bake = json!({
            "high": "scan.ply", "output": "new/out.glb", "triangles": 5000.0, "error": null,
            "maps": ["normal", "ao"], "options": ["--meshopt", "--ao-rays", "8", "--json"],
        });
        let wanted = "bake --output=IN/new/out.glb --triangles=5000 --maps=normal --maps=ao --ao-rays=8 --meshopt --json \
                      IN/scan.ply";
        assert_eq!(line("bake", bake), Ok(wanted.into()));
        let render = json!({ "model": "a.glb", "orbit": [30, -20.5], "shadows": true, "ground": false, "env": "studio",
            "material": "bronze", "light": ["point at=0,1,0"] });
        let built = line("render", render).unwrap();
        for word in [
            "--orbit=30,-20.5",
            "--env=studio",
            "--shadows",
            "--output=PLACE/picture.png",
            "--material=bronze",
        ] {
            assert!(built.contains(word), "{word}: {built}");
        }
        assert!(!built.contains("--ground"), "{built}");
    }

    #[test]
    fn a_mask_for_skew_correction_is_a_path_and_the_rules_are_words() {
        let with = |skew: &str| {
            let options = ["--skew", skew];
            line("bake", json!({ "high": "a.ply", "output": "b.glb", "options": options }))
        };
        assert!(with("keep").unwrap().contains("--skew=keep "));
        assert!(with("masks/m.png").unwrap().contains("--skew=IN/masks/m.png "));
        assert!(with("../secret.png").unwrap_err().contains("not allowed"));
        assert!(with("/etc/m.png").unwrap_err().contains("outside the allowed"));
    }

    #[test]
    fn no_spelling_avoids_the_check() {
        let with = |options: Value| line("render", json!({ "model": "a.glb", "options": options }));
        for options in [
            json!(["--env", "/etc/passwd"]),
            json!(["--env=/etc/sky.hdr"]),
            json!(["--env", "../sky.hdr"]),
            json!(["--normal-map=../secret.png"]),
            json!(["-o/tmp/x.png"]),
            json!(["-o", "/tmp/x.png"]),
            json!(["-qo/tmp/x.png"]),
            json!(["--output=../x.png"]),
            json!(["--material", "/etc/m.toml"]),
            json!(["--material=a.toml"]),
            json!(["--allow-outside"]),
            json!(["--", "/etc/passwd"]),
            json!(["/etc/passwd"]),
            json!(["--help"]),
            json!(["--low"]),
            json!([1]),
            json!("--shadows"),
        ] {
            assert!(with(options.clone()).is_err(), "{options}");
        }
        assert!(
            with(json!(["--material", "b.toml", "--env", "sky.hdr"])).unwrap().contains("--env=IN/sky.hdr")
        );
        for model in
            ["--allow-outside", "--output=/etc/x", "-o/etc/x.png", "/etc/passwd", "../secret.png", "a\0b"]
        {
            let built = line("render", json!({ "model": model }));
            assert!(
                built.as_ref().is_err() || built.as_ref().unwrap().ends_with(&format!("IN/{model}")),
                "{built:?}"
            );
        }
        assert!(
            line("render", json!({ "model": "/etc/passwd" })).unwrap_err().contains("outside the allowed")
        );
        assert!(
            line("inspect", json!({ "model": "a.glb", "output": "x" }))
                .unwrap_err()
                .contains("unknown argument")
        );
    }

    #[test]
    fn files_are_found_next_to_the_output_or_where_the_line_names_them() {
        let place = tempfile::tempdir().unwrap();
        let [scan, asset, trials] =
            ["scans/a.glb", "out/a.glb", "tables/t.csv"].map(|name| place.path().join(name));
        fs::create_dir(place.path().join("out")).unwrap();
        fs::write(&asset, "").unwrap();
        let written =
            Written { folder: place.path().join("out"), named: vec![scan, asset.clone(), trials.clone()] };
        assert_eq!(["a.glb", "t.csv"].map(|name| written.path(name)), [asset, trials]);
        assert_eq!(written.path("gone.png"), place.path().join("out/gone.png"));
    }

    #[test]
    fn errors_are_those_of_the_command_line() {
        let bake = |more: Value| {
            let mut given = json!({ "high": "a.ply", "output": "b.glb" });
            given.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
            line("bake", given).unwrap_err()
        };
        assert!(bake(json!({ "triangles": 2 })).contains("2 is not in 4.."));
        assert!(bake(json!({ "triangles": 9, "error": 1 })).contains("cannot be used with"));
        assert!(bake(json!({ "options": ["--webp"] })).contains("--images webp"));
        assert_eq!(
            bake(json!({ "meshopt": true })),
            "unknown argument `meshopt`; pass other options in `options`"
        );
        assert!(line("bake", json!({ "high": "a.ply" })).unwrap_err().contains("--output <OUT>"));
    }
}
