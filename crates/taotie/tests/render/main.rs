//! Pictures: golden ones, and comparisons with the reference renderer, with closed forms, and with pictures by
//! others.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests print their findings")]

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/files.rs"]
mod files;
#[path = "../common/finishes.rs"]
mod finishes;
#[allow(dead_code, reason = "each test uses a part")]
#[path = "../common/hostile.rs"]
mod hostile;
#[path = "../common/ktx.rs"]
mod ktx;
#[path = "../common/pictures.rs"]
mod pictures;
#[path = "../common/random.rs"]
mod random;
#[path = "../common/scenes.rs"]
mod scenes;
#[path = "../common/skies.rs"]
mod skies;
#[path = "../common/views.rs"]
mod views;
#[path = "../common/walls.rs"]
mod walls;

mod asset_generator;
mod environments;
mod fidelity;
mod fill_rule;
mod golden;
mod ground;
mod huge;
mod normal_tangent;
mod raking;
mod reference;
mod reference_light;
mod reference_normals;
mod relief_light;
mod renderer;
mod white_room;
