//! The tools and the schemas of their arguments, derived from the command line.

use clap::{Arg, ArgAction, ValueHint};
use rmcp::model::{JsonObject, Tool, ToolAnnotations};
use serde_json::{Value, json};
use std::any::TypeId;
use std::path::PathBuf;
use std::sync::Arc;

/// A subcommand that clients may call.
pub struct Subcommand {
    /// Its name, and that of the tool.
    pub name: &'static str,
    /// The arguments that have properties; all others are passed as [`OPTIONS`].
    properties: &'static [&'static str],
    /// The result of a call, in a sentence.
    returns: &'static str,
    /// True if a call without an output writes to a temporary file.
    pub may_lack_output: bool,
    /// True if a call only reads files, and is fast.
    pub is_light: bool,
}

/// The property for further options, as on the command line.
pub const OPTIONS: &str = "options";

/// Options that no client may set: the first would lift the restriction to the allowed folders.
pub const REFUSED: [&str; 1] = ["allow_outside"];

const SUBCOMMANDS: [Subcommand; 4] = [
    Subcommand {
        name: "inspect",
        properties: &["model"],
        returns: "Returns meshes, materials, textures, defects and warnings.",
        may_lack_output: false,
        is_light: true,
    },
    Subcommand {
        name: "bake",
        properties: &[
            "high",
            "output",
            "low",
            "error",
            "require",
            "preset",
            "bytes",
            "triangles",
            "size",
            "lods",
            "maps",
            "unit",
        ],
        returns: "Returns the verdict with the value of each requirement, the figures, warnings, the written files, \
                  and pictures of the worst patch: scan, asset, difference. A search can take minutes; triangles and \
                  size turn it off.",
        may_lack_output: false,
        is_light: false,
    },
    Subcommand {
        name: "verify",
        properties: &["asset", "scan", "require", "output", "unit"],
        returns: "Returns the verdict with the value of each requirement, the figures, warnings, and pictures of the \
                  worst patch: scan, asset, difference.",
        may_lack_output: false,
        is_light: false,
    },
    Subcommand {
        name: "render",
        properties: &[
            "model",
            "output",
            "size",
            "orbit",
            "target",
            "camera",
            "lights",
            "ambient",
            "env",
            "shadows",
            "ground",
            "material",
            "shading",
            "surface",
            "exposure",
            "background",
            "integrator",
        ],
        returns: "Returns the picture, camera, lights and warnings. Without an output, no file is kept.",
        may_lack_output: true,
        is_light: false,
    },
];

impl Subcommand {
    /// Returns the subcommand of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SUBCOMMANDS.iter().find(|known| known.name == name)
    }

    /// Returns its definition on the command line.
    pub fn command(&self) -> clap::Command {
        let all = crate::with_renamed_options(crate::command());
        let found = all.find_subcommand(self.name).cloned().unwrap_or_default();
        let found = found.disable_help_flag(true).no_binary_name(true);
        match self.may_lack_output {
            true => found.mut_arg(OUTPUT, |arg| arg.required(false)),
            false => found,
        }
    }

    /// Returns the argument of a property.
    pub fn argument<'c>(&self, command: &'c clap::Command, property: &str) -> Option<&'c Arg> {
        let has_property = |arg: &&Arg| self.properties.contains(&arg.get_id().as_str());
        command.get_arguments().filter(has_property).find(|arg| name_of(arg) == property)
    }

    /// Returns the tool of the protocol.
    fn tool(&self) -> Tool {
        let command = self.command();
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        let hints = ToolAnnotations::new().read_only(self.is_light).open_world(false);
        Tool::new(
            self.name,
            format!("{}. {}", about.trim_end_matches('.'), self.returns),
            self.schema(&command),
        )
        .with_annotations(hints)
    }

    /// Returns the JSON schema of its arguments.
    fn schema(&self, command: &clap::Command) -> Arc<JsonObject> {
        let arguments =
            self.properties.iter().filter_map(|id| command.get_arguments().find(|arg| arg.get_id() == id));
        let mut properties: JsonObject = arguments.clone().map(|arg| (name_of(arg), property(arg))).collect();
        let required: Vec<String> = arguments.filter(|arg| arg.is_required_set()).map(name_of).collect();
        properties.insert(
            OPTIONS.into(),
            json!({ "type": "array", "items": { "type": "string" }, "description": self.further(command) }),
        );
        let schema = json!({
            "type": "object", "properties": properties, "required": required, "additionalProperties": false,
        });
        Arc::new(schema.as_object().cloned().unwrap_or_default())
    }

    /// Describes all options without a property.
    fn further(&self, command: &clap::Command) -> String {
        let is_further = |arg: &&Arg| {
            let id = arg.get_id().as_str();
            !self.properties.contains(&id) && id != JSON && !REFUSED.contains(&id) && !arg.is_hide_set()
        };
        let lines: Vec<String> = command.get_arguments().filter(is_further).filter_map(described).collect();
        format!(
            "Further options, as on the command line, such as [\"--threads\", \"2\"]:\n{}",
            lines.join("\n")
        )
    }
}

/// The argument with the file to write.
pub const OUTPUT: &str = "output";

/// The argument that chooses JSON, which every call does.
pub const JSON: &str = "json";

/// Returns all tools.
pub fn tools() -> Vec<Tool> {
    SUBCOMMANDS.iter().map(Subcommand::tool).collect()
}

/// Returns the property of an argument: its option with underscores, or the name of its place.
pub fn name_of(arg: &Arg) -> String {
    arg.get_long().map_or_else(|| arg.get_id().to_string(), |long| long.replace('-', "_"))
}

/// Returns true if values of an argument may be paths.
pub fn takes_path(arg: &Arg) -> bool {
    !matches!(arg.get_value_hint(), ValueHint::Unknown | ValueHint::Other)
}

/// Returns true if every value of an argument is a path, not the name of something else.
pub fn takes_only_path(arg: &Arg) -> bool {
    arg.get_value_parser().type_id() == TypeId::of::<PathBuf>()
}

/// Returns true if an argument takes no value.
pub fn is_flag(arg: &Arg) -> bool {
    matches!(arg.get_action(), ArgAction::SetTrue)
}

fn property(arg: &Arg) -> Value {
    let mut schema = JsonObject::new();
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    schema.insert("description".into(), help.into());
    let item = if is_flag(arg) { json!({ "type": "boolean" }) } else { value(arg) };
    match arg.get_action() {
        ArgAction::Append => {
            schema.insert("type".into(), "array".into());
            schema.insert("items".into(), item);
        }
        _ => schema.extend(item.as_object().cloned().unwrap_or_default()),
    }
    schema.into()
}

/// Returns the schema of one value.
fn value(arg: &Arg) -> Value {
    let parser = arg.get_value_parser();
    let names: Vec<String> =
        arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
    match parser.type_id() {
        id if id == TypeId::of::<u32>() => json!({ "type": "integer" }),
        id if id == TypeId::of::<f64>() => json!({ "type": "number" }),
        _ if !names.is_empty() => json!({ "type": "string", "enum": names }),
        _ => json!({ "type": "string" }),
    }
}

/// Describes an option in one line: its value, and the first sentence of its help.
fn described(arg: &Arg) -> Option<String> {
    let long = arg.get_long()?;
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let first = help.split_once(". ").map_or(help.as_str(), |(first, _)| first);
    let possible: Vec<String> =
        arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
    let value = match arg.get_value_names() {
        _ if is_flag(arg) => String::new(),
        _ if !possible.is_empty() => format!(" {}", possible.join("|")),
        names => names.map(|names| format!(" {}", names.join(" "))).unwrap_or_default(),
    };
    Some(format!("--{long}{value}: {first}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_property_is_an_argument_of_its_subcommand() {
        for known in &SUBCOMMANDS {
            let command = known.command();
            for id in known.properties {
                assert!(command.get_arguments().any(|arg| arg.get_id() == id), "{} {id}", known.name);
            }
            assert!(command.get_arguments().any(|arg| arg.get_id() == JSON), "{}", known.name);
        }
    }

    #[test]
    fn schemas_have_the_types_of_values() {
        let command = Subcommand::named("bake").unwrap().command();
        let schema = Subcommand::named("bake").unwrap().schema(&command);
        let kind = |name: &str| schema["properties"][name]["type"].as_str().unwrap_or_default().to_owned();
        let kinds = ["triangles", "error", "low", "size", "require", "bytes", "options"].map(kind);
        assert_eq!(kinds, ["integer", "number", "string", "string", "array", "string", "array"]);
        assert_eq!(schema["required"], json!(["high", "output"]));
        let further = schema["properties"][OPTIONS]["description"].as_str().unwrap();
        assert!(
            further.contains("\n--meshopt: ")
                && further.contains("--cage FILE: ")
                && !further.contains("outside")
        );
    }

    /// A file is confined only if the definition of its option has a path as type or hint. Add each new option
    /// that clients can set here, to the paths or to the texts that name no file.
    #[test]
    fn every_option_is_known_to_take_a_path_or_none() {
        let (mut paths, mut texts) = (Vec::new(), Vec::new());
        for known in &SUBCOMMANDS {
            let command = known.command();
            let mut arguments: Vec<&Arg> =
                command.get_arguments().filter(|arg| !is_flag(arg) && !arg.is_hide_set()).collect();
            arguments.sort_by_key(|arg| name_of(arg));
            for arg in arguments {
                let is_text = arg.get_value_parser().type_id() == TypeId::of::<String>();
                let name = format!("{} {}", known.name, name_of(arg));
                match takes_path(arg) {
                    true => paths.push(name),
                    false if is_text && arg.get_possible_values().is_empty() => texts.push(name),
                    false => {}
                }
            }
        }
        assert_eq!(
            paths.join(", "),
            "inspect audit, inspect model, inspect product_info, bake cage, bake high, bake low, bake output, \
             bake provenance, bake skew, bake trials, verify asset, verify output, verify scan, \
             render base_color_map, render env, render height_map, render material, render model, \
             render normal_map, render occlusion_map, render output"
        );
        assert_eq!(
            texts.join(", "),
            "bake date, bake operator, verify date, verify operator, render animation, render aov, \
             render background, render camera, render light, render variant"
        );
    }

    /// The help of an option says that its values are files; a parser with its own type would hide it from the check.
    #[test]
    fn options_whose_values_are_named_after_files_take_paths() {
        const FILES: [&str; 12] =
            ["FILE", "FOLDER", "DIR", "PATH", "MASK", "MESH", "MODEL", "SCAN", "ASSET", "HIGH", "LOW", "OUT"];
        let mut named = Vec::new();
        for known in &SUBCOMMANDS {
            let command = known.command();
            for arg in command.get_arguments().filter(|arg| !is_flag(arg)) {
                let names = arg.get_value_names().unwrap_or_default().iter();
                let mut words = names.flat_map(|name| {
                    name.as_str().split(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_')
                });
                if words.any(|word| FILES.contains(&word)) {
                    assert!(takes_path(arg), "{} {}", known.name, name_of(arg));
                    named.push(name_of(arg));
                }
            }
        }
        for name in ["skew", "cage", "env", "material", "high", "model"] {
            assert!(named.iter().any(|known| known == name), "{name} in {named:?}");
        }
    }
}
