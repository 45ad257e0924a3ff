//! `taotie batch`: collections resume where they were interrupted, regardless of the cause.
#![allow(clippy::print_stdout, reason = "tests print their findings")]

#[allow(dead_code)]
#[path = "../cli/balls.rs"]
mod balls;
#[path = "../../../../tests/common/mod.rs"]
mod common;
#[allow(dead_code)]
#[path = "../../../../tests/common/files.rs"]
mod files;
#[path = "../cli/photographs.rs"]
mod photographed;
#[allow(dead_code)]
#[path = "../../../../tests/common/schemas.rs"]
mod schemas;

mod audited;
mod collection;
mod configured;
#[cfg(unix)]
mod ended;
#[cfg(unix)]
mod found;
mod page;
mod photographs;
mod shared_scans;
mod worked;
