//! The command on scans and models by others, on broken files, and its demo.
#![allow(clippy::print_stdout, reason = "tests say what they found")]

#[path = "../../../taotie/tests/common/mod.rs"]
mod common;
#[path = "../../../taotie/tests/common/files.rs"]
mod files;
#[path = "../../../taotie/tests/common/glb.rs"]
mod glb;
#[path = "../../../taotie/tests/common/validator.rs"]
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
