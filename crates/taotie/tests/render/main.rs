//! Pictures: golden ones, and comparisons with the reference renderer, with closed forms, and with pictures by
//! others.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests print their findings")]

#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../../../../tests/common/files.rs"]
mod files;
#[path = "../../../../tests/common/finishes.rs"]
mod finishes;
#[allow(dead_code, reason = "each test uses a part")]
#[path = "../../../../tests/common/hostile.rs"]
mod hostile;
#[path = "../../../../tests/common/ktx.rs"]
mod ktx;
#[path = "../../../../tests/common/pictures.rs"]
mod pictures;
#[path = "../../../../tests/common/random.rs"]
mod random;
#[path = "../../../../tests/common/scenes.rs"]
mod scenes;
#[path = "../../../../tests/common/skies.rs"]
mod skies;
#[path = "../../../../tests/common/views.rs"]
mod views;
#[path = "../../../../tests/common/walls.rs"]
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
