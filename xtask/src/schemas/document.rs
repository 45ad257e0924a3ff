//! The schema of one document: its root, and the definitions of all types below it.

use super::attributes::{Attributes, Documentation};
use super::sources::{Declared, Sources};
use anyhow::{Context, Result, bail};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use syn::{Expr, ExprLit, Fields, GenericArgument, ItemEnum, ItemStruct, Lit, PathArguments, Type, Variant};

/// Declarations that types lack, by `Type` or `Type.field`.
pub type Exceptions = BTreeMap<&'static str, Exception>;

/// The schema of a value whose type does not declare it.
#[derive(Clone)]
pub enum Exception {
    /// This schema; for a flattened field, that of each property.
    Schema(Value),
    /// That of another type.
    Same(&'static str),
    /// That of another type, or null.
    SameOrNull(&'static str),
}

/// A schema in the making.
pub struct Document<'a> {
    sources: &'a Sources,
    exceptions: &'a Exceptions,
    /// The name of each definition by the type's number.
    names: BTreeMap<usize, String>,
    definitions: BTreeMap<String, Value>,
}

/// A field of an object, or the whole content of a variant.
struct Place<'a> {
    file: usize,
    documentation: &'a Documentation,
}

/// A struct or variant whose fields are described.
struct Owner<'a> {
    name: &'a str,
    file: usize,
    attributes: &'a Attributes,
}

/// The properties of an object.
#[derive(Default)]
struct Properties {
    all: Map<String, Value>,
    required: Vec<String>,
    /// The properties of each variant of a flattened enum, one of which is added.
    choices: Vec<Value>,
}

impl Properties {
    fn schema(self, documentation: &str) -> Value {
        let mut schema = json!({
            "type": "object",
            "properties": &self.all,
            "required": &self.required,
            "additionalProperties": false,
        });
        if !documentation.is_empty() {
            schema["description"] = documentation.into();
        }
        if self.choices.is_empty() {
            return schema;
        }
        let whole = |mut choice: Value| {
            if let (Some(all), Some(own)) =
                (choice["properties"].as_object_mut(), schema["properties"].as_object())
            {
                all.extend(own.clone());
            }
            if let (Some(all), Some(own)) = (choice["required"].as_array_mut(), schema["required"].as_array())
            {
                all.extend(own.clone());
            }
            choice
        };
        let choices: Vec<Value> = self.choices.into_iter().map(whole).collect();
        json!({ "description": documentation, "oneOf": choices })
    }
}

impl<'a> Document<'a> {
    /// Starts a document.
    pub fn new(sources: &'a Sources, exceptions: &'a Exceptions) -> Self {
        Self { sources, exceptions, names: BTreeMap::new(), definitions: BTreeMap::new() }
    }

    /// Returns the schema of a type, and all definitions.
    ///
    /// # Errors
    /// If part of it cannot be described.
    pub fn finish(mut self, number: usize) -> Result<(Value, BTreeMap<String, Value>)> {
        let root = self.declared(number)?;
        Ok((root, self.definitions))
    }

    /// Returns a reference to a type's definition, which it adds if needed; simple types are repeated in place.
    fn reference(&mut self, number: usize) -> Result<Value> {
        let declaration = self.sources.declaration(number);
        if let Some(exception) = self.exceptions.get(declaration.name.as_str()) {
            return self.exception(exception);
        }
        let is_object = match &declaration.declared {
            Declared::Struct(item) => {
                let attributes = Attributes::of(&item.attrs)?;
                matches!(item.fields, Fields::Named(_))
                    && !attributes.has("transparent")
                    && !attributes.has("into")
            }
            Declared::Enum(_) => true,
            Declared::Alias(_) => false,
        };
        if !is_object {
            return self.declared(number);
        }
        if !self.names.contains_key(&number) {
            let is_taken = self.names.values().any(|name| *name == declaration.name);
            let module = declaration.module.last().map_or(String::new(), |module| capitalised(module));
            let name =
                if is_taken { format!("{module}{}", declaration.name) } else { declaration.name.clone() };
            self.names.insert(number, name.clone());
            let schema = self.declared(number)?;
            if self.definitions.insert(name.clone(), schema).is_some() {
                bail!("two types have the name `{name}`; rename one of them");
            }
        }
        Ok(json!({ "$ref": format!("#/$defs/{}", self.names[&number]) }))
    }

    fn exception(&mut self, exception: &Exception) -> Result<Value> {
        match exception {
            Exception::Schema(schema) => Ok(schema.clone()),
            Exception::Same(path) => self.reference(self.sources.named(path)?),
            Exception::SameOrNull(path) => Ok(or_null(self.reference(self.sources.named(path)?)?)),
        }
    }

    fn declared(&mut self, number: usize) -> Result<Value> {
        let declaration = self.sources.declaration(number);
        let file = declaration.file;
        match &declaration.declared {
            Declared::Struct(item) => self.of_struct(item, file),
            Declared::Enum(item) => self.of_enum(item, file),
            Declared::Alias(aliased) => self.of_type(aliased, file),
        }
        .with_context(|| format!("{}::{}", declaration.module.join("::"), declaration.name))
    }

    fn of_struct(&mut self, item: &ItemStruct, file: usize) -> Result<Value> {
        let attributes = Attributes::of(&item.attrs)?;
        let documentation = Documentation::of(&item.attrs);
        if !is_serialised(&item.attrs) {
            bail!("`Serialize` is not derived; derive it, or add an exception in xtask/src/schemas/mod.rs");
        }
        if let Some(other) = attributes.text("into") {
            return self.of_type(&syn::parse_str(other)?, file);
        }
        match &item.fields {
            Fields::Named(fields) if attributes.has("transparent") => match fields.named.first() {
                Some(field) => self.of_type(&field.ty, file),
                None => bail!("it has no field"),
            },
            Fields::Named(_) => {
                let mut properties = Properties::default();
                self.add_struct(item, file, &mut properties)?;
                Ok(properties.schema(&documentation.text()))
            }
            Fields::Unnamed(fields) if fields.unnamed.len() == 1 => {
                self.of_place(&fields.unnamed[0].ty, &Place { file, documentation: &documentation })
            }
            _ => bail!("schemas do not support such structs yet"),
        }
    }

    /// Adds the fields of a struct to an object.
    fn add_struct(&mut self, item: &ItemStruct, file: usize, to: &mut Properties) -> Result<()> {
        let attributes = Attributes::of(&item.attrs)?;
        let owner = Owner { name: &item.ident.to_string(), file, attributes: &attributes };
        self.add_fields(&item.fields, &owner, to)
    }

    /// Adds the fields of a struct or variant to an object.
    fn add_fields(&mut self, fields: &Fields, owner: &Owner<'_>, to: &mut Properties) -> Result<()> {
        for field in fields {
            let attributes = Attributes::of(&field.attrs)?;
            let Some(ident) = field.ident.as_ref().filter(|_| !attributes.is_skipped()) else { continue };
            let name = attributes.field_name(owner.attributes, &ident.to_string())?;
            let what = format!("{}.{name}", owner.name);
            if attributes.has("flatten") {
                let inner = Owner { name: &what, file: owner.file, attributes: &attributes };
                self.flatten(&field.ty, &inner, to).with_context(|| what.clone())?;
                continue;
            }
            let documentation = Documentation::of(&field.attrs);
            let place = Place { file: owner.file, documentation: &documentation };
            let mut schema = match self.exceptions.get(what.as_str()) {
                Some(exception) => self.exception(exception)?,
                None if name == "schema" => self.version(&place),
                None => self.of_place(&field.ty, &place).with_context(|| what.clone())?,
            };
            let text = documentation.text();
            if text.is_empty() && schema.get("description").is_none() {
                bail!("{what} has no documentation; describe it with its unit and range");
            }
            if !text.is_empty() {
                schema["description"] = text.into();
            }
            if !attributes.has("skip_serializing_if") {
                to.required.push(name.clone());
            }
            to.all.insert(name, schema);
        }
        Ok(())
    }

    /// Adds the fields of a flattened field, with its full name and its attributes, to an object.
    fn flatten(&mut self, kind: &Type, field: &Owner<'_>, to: &mut Properties) -> Result<()> {
        if let Some(Exception::Schema(Value::Object(fields))) = self.exceptions.get(field.name) {
            to.required.extend(fields.keys().cloned());
            to.all.extend(fields.clone());
            return Ok(());
        }
        let path = match field.attributes.text("with") {
            Some(module) => vec![module.to_owned(), "Fields".into()],
            None => path_of(kind).context("only structs can be flattened")?,
        };
        let declaration = self.sources.declaration(self.sources.find(field.file, &path)?);
        match &declaration.declared {
            Declared::Struct(item) => self.add_struct(item, declaration.file, to),
            Declared::Enum(item) => {
                let schema = self.of_enum(item, declaration.file)?;
                to.choices = schema["oneOf"].as_array().cloned().unwrap_or_default();
                Ok(())
            }
            Declared::Alias(_) => bail!("aliases cannot be flattened"),
        }
    }

    /// Returns the schema of a layout's version: the constant that the documentation names, or `SCHEMA`.
    fn version(&self, place: &Place<'_>) -> Value {
        let links = place.documentation.links();
        let name = links.first().map_or("SCHEMA", String::as_str);
        match self.sources.constant(place.file, name) {
            Some(number) => json!({ "const": number, "description": "Version of this layout." }),
            None => json!({ "type": "integer", "minimum": 1, "description": "Version of this layout." }),
        }
    }

    fn of_enum(&mut self, item: &ItemEnum, file: usize) -> Result<Value> {
        let attributes = Attributes::of(&item.attrs)?;
        let documentation = Documentation::of(&item.attrs).text();
        if !is_serialised(&item.attrs) {
            bail!("`Serialize` is not derived; derive it, or add an exception in xtask/src/schemas/mod.rs");
        }
        if let Some(other) = attributes.text("into") {
            return self.of_type(&syn::parse_str(other)?, file);
        }
        let mut all = Vec::new();
        for variant in &item.variants {
            if Attributes::of(&variant.attrs)?.is_skipped() {
                continue;
            }
            let documentation = Documentation::of(&variant.attrs);
            let place = Place { file, documentation: &documentation };
            let mut schema = self
                .of_variant(variant, &place, &attributes)
                .with_context(|| format!("the variant {}", variant.ident))?;
            if schema.get("description").is_none() {
                schema["description"] = documentation.text().into();
            }
            all.push(schema);
        }
        let choice = if attributes.has("untagged") { "anyOf" } else { "oneOf" };
        Ok(json!({ "description": documentation, choice: all }))
    }

    fn of_variant(&mut self, variant: &Variant, place: &Place<'_>, container: &Attributes) -> Result<Value> {
        let file = place.file;
        let name = &Attributes::of(&variant.attrs)?.variant_name(container, &variant.ident.to_string())?;
        let mut properties = Properties::default();
        let tag = container.text("tag");
        if let Some(tag) = tag {
            properties.all.insert(tag.into(), json!({ "const": name }));
            properties.required.push(tag.into());
        }
        let content = match &variant.fields {
            Fields::Unit if tag.is_none() => return Ok(json!({ "const": name })),
            Fields::Unit => return Ok(properties.schema("")),
            Fields::Named(_) => {
                let attributes = Attributes::default();
                let owner = Owner { name: &variant.ident.to_string(), file, attributes: &attributes };
                self.add_fields(&variant.fields, &owner, &mut properties)?;
                if tag.is_some() {
                    return Ok(properties.schema(""));
                }
                std::mem::take(&mut properties).schema("")
            }
            Fields::Unnamed(fields) if fields.unnamed.len() == 1 && tag.is_none() => {
                self.of_place(&fields.unnamed[0].ty, place)?
            }
            Fields::Unnamed(fields) if fields.unnamed.len() == 1 => {
                let path = path_of(&fields.unnamed[0].ty).context("it is not a struct")?;
                let inner = self.sources.declaration(self.sources.find(file, &path)?);
                let Declared::Struct(item) = &inner.declared else { bail!("it is not a struct") };
                self.add_struct(item, inner.file, &mut properties)?;
                return Ok(properties.schema(""));
            }
            Fields::Unnamed(_) => bail!("schemas do not support several values without names yet"),
        };
        if container.has("untagged") {
            return Ok(content);
        }
        properties.all.insert(name.clone(), content);
        properties.required.push(name.clone());
        Ok(properties.schema(""))
    }

    /// Returns the schema of a type with what the documentation adds: ranges, lists of values, null.
    fn of_place(&mut self, kind: &Type, place: &Place<'_>) -> Result<Value> {
        let schema = self.of_type(kind, place.file)?;
        self.refine(schema, place)
    }

    /// Returns the number of the first type that the documentation links to.
    fn linked(&self, place: &Place<'_>) -> Option<usize> {
        place.documentation.links().iter().find_map(|link| {
            let path: Vec<String> = link.split("::").map(str::to_owned).collect();
            self.sources.find(place.file, &path).ok()
        })
    }

    fn refine(&mut self, mut schema: Value, place: &Place<'_>) -> Result<Value> {
        let documentation = place.documentation;
        if let Some(items) = schema.get_mut("items") {
            *items = self.refine(items.take(), place)?;
            return Ok(schema);
        }
        if schema.get("$ref").is_some() || schema.get("const").is_some() {
            return Ok(schema);
        }
        if let Some(choices) = schema.get_mut("anyOf").and_then(Value::as_array_mut) {
            for choice in choices {
                *choice = self.refine(choice.take(), place)?;
            }
            return Ok(schema);
        }
        match (schema["type"].as_str(), schema.is_object()) {
            (Some("number"), _) => {
                if let Some([low, high]) = documentation.range() {
                    schema["minimum"] = json!(low);
                    schema["maximum"] = json!(high);
                }
                if ["infinit", "NaN", "not a number"].iter().any(|words| documentation.has(words)) {
                    return Ok(or_null(schema));
                }
            }
            (Some("string"), _) => {
                if let Some(values) = documentation.values() {
                    schema["enum"] = json!(values);
                } else if documentation.has("name of")
                    && let Some(number) = self.linked(place)
                {
                    return self.reference(number);
                }
            }
            (None, true) if schema.as_object().is_some_and(|fields| !fields.contains_key("oneOf")) => {
                // A JSON value without a type: the documentation names it.
                if let Some(number) = self.linked(place) {
                    return self.reference(number);
                }
                bail!("a `Value` has no schema; link to its type in its documentation");
            }
            _ => {}
        }
        Ok(schema)
    }

    fn of_type(&mut self, kind: &Type, file: usize) -> Result<Value> {
        match kind {
            Type::Reference(inner) => self.of_type(&inner.elem, file),
            Type::Paren(inner) => self.of_type(&inner.elem, file),
            Type::Slice(inner) => Ok(json!({ "type": "array", "items": self.of_type(&inner.elem, file)? })),
            Type::Array(inner) => {
                let length = self.length(&inner.len, file)?;
                let items = self.of_type(&inner.elem, file)?;
                Ok(json!({ "type": "array", "items": items, "minItems": length, "maxItems": length }))
            }
            Type::Path(path) => {
                let last = path.path.segments.last().context("the type has no name")?;
                let arguments: Vec<&Type> = match &last.arguments {
                    PathArguments::AngleBracketed(all) => {
                        let types = all.args.iter().filter_map(|argument| match argument {
                            GenericArgument::Type(inner) => Some(inner),
                            _ => None,
                        });
                        types.collect()
                    }
                    _ => Vec::new(),
                };
                self.of_named((&last.ident.to_string(), kind), &arguments, file)
            }
            _ => bail!("schemas do not support this type yet"),
        }
    }

    fn of_named(&mut self, (name, kind): (&str, &Type), arguments: &[&Type], file: usize) -> Result<Value> {
        match (name, arguments) {
            ("bool", []) => Ok(json!({ "type": "boolean" })),
            ("f32" | "f64", []) => Ok(json!({ "type": "number" })),
            ("u8", []) => Ok(json!({ "type": "integer", "minimum": 0, "maximum": 255 })),
            ("u16", []) => Ok(json!({ "type": "integer", "minimum": 0, "maximum": 65535 })),
            ("u32" | "u64" | "usize", []) => Ok(json!({ "type": "integer", "minimum": 0 })),
            ("i8" | "i16" | "i32" | "i64" | "isize", []) => Ok(json!({ "type": "integer" })),
            ("str" | "String" | "Path" | "PathBuf", []) => Ok(json!({ "type": "string" })),
            ("Value", []) => Ok(json!({})),
            ("Option", [inner]) => Ok(or_null(self.of_type(inner, file)?)),
            ("Box" | "Arc" | "Cow", [inner]) => self.of_type(inner, file),
            ("Vec", [inner]) => Ok(json!({ "type": "array", "items": self.of_type(inner, file)? })),
            ("BTreeMap" | "HashMap", [_, inner]) => {
                Ok(json!({ "type": "object", "additionalProperties": self.of_type(inner, file)? }))
            }
            _ => {
                let path = path_of(kind).context("the type has no name")?;
                if let Some(exception) = self.exceptions.get(name) {
                    return self.exception(exception);
                }
                self.reference(self.sources.find(file, &path)?)
            }
        }
    }

    fn length(&self, length: &Expr, file: usize) -> Result<u64> {
        match length {
            Expr::Lit(ExprLit { lit: Lit::Int(number), .. }) => Ok(number.base10_parse()?),
            Expr::Path(path) => {
                let name = path.path.segments.last().context("the length has no name")?.ident.to_string();
                self.sources
                    .constant(file, &name)
                    .with_context(|| format!("{name} is not a number in this file"))
            }
            _ => bail!("the length of an array is not a number"),
        }
    }
}

/// Returns a schema that also allows null.
pub fn or_null(schema: Value) -> Value {
    json!({ "anyOf": [schema, { "type": "null" }] })
}

fn path_of(kind: &Type) -> Option<Vec<String>> {
    match kind {
        Type::Path(path) => Some(path.path.segments.iter().map(|part| part.ident.to_string()).collect()),
        Type::Reference(inner) => path_of(&inner.elem),
        _ => None,
    }
}

fn is_serialised(attributes: &[syn::Attribute]) -> bool {
    let mut is = false;
    for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("derive")) {
        let _ = attribute.parse_nested_meta(|meta| {
            is |= meta.path.segments.last().is_some_and(|last| last.ident == "Serialize");
            Ok(())
        });
    }
    is
}

fn capitalised(name: &str) -> String {
    name.split('_')
        .flat_map(|word| {
            word.chars().next().into_iter().flat_map(char::to_uppercase).chain(word.chars().skip(1))
        })
        .collect()
}
