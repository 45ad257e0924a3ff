//! `taotie batch`: collections that go on where they were cut off, whatever ended them.
#![allow(clippy::print_stdout, reason = "tests say what they found")]

#[allow(dead_code)]
#[path = "../cli/balls.rs"]
mod balls;
#[path = "../../../taotie/tests/common/mod.rs"]
mod common;
#[allow(dead_code)]
#[path = "../../../taotie/tests/common/files.rs"]
mod files;

mod audited;
mod collection;
mod configured;
#[cfg(unix)]
mod ended;
mod page;
mod shared_scans;
mod worked;
