//! The command's contract: exit codes, stdout, stderr and the files that a run leaves.
//!
//! After an intended change of output, update the snapshots: `SNAPSHOTS=overwrite cargo test -p taotie-cli --test
//! cli`.

mod arguments;
mod audit;
mod bake;
mod bake_carried;
mod bake_document;
mod bake_document_materials;
mod bake_maps;
mod bake_page;
mod bake_pairs;
mod bake_scan;
mod bake_several;
mod balls;
mod certificate;
mod compare;
mod compare_paper;
mod device;
mod diff;
mod environment;
mod examples;
mod fbx;
#[path = "../../../../tests/common/glb.rs"]
mod glb;
mod help;
mod inspect;
mod interrupted;
mod json;
mod json_bake;
mod json_compare;
mod kept;
mod limits;
mod maps_alone;
#[cfg(feature = "mcp")]
mod mcp;
mod models;
mod motion;
mod normals;
mod packed;
mod photographs;
mod photometric;
mod pictures;
mod place;
mod provenance;
mod renamed;
mod render;
mod running;
mod same_bits;
mod schemas;
mod shader;
mod sizes;
mod units;
mod unread;
#[path = "../../../../tests/common/validator.rs"]
mod validator;
mod variants;
mod verify;
