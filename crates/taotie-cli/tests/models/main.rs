//! The command on third-party scans and models, on broken files, and its demo.
#![allow(clippy::print_stdout, reason = "tests print their findings")]

#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../../../../tests/common/files.rs"]
mod files;
#[path = "../../../../tests/common/glb.rs"]
mod glb;
#[allow(dead_code)]
#[path = "../../../../tests/common/schemas.rs"]
mod schemas;
#[path = "../../../../tests/common/validator.rs"]
mod validator;

mod bake_alpha;
mod bake_documents;
mod bake_materials;
mod bake_properties;
mod bake_scans;
mod command;
mod demo;
mod material_looks;
mod models_by_others;
mod printed;
