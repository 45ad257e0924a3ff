//! Whole collections: `collection.toml` names scans and photographs and what to make from them; a driver starts a process
//! for each, and adds a line to the manifest for every attempt.
//!
//! [`Collection`] reads the file. [`drive`] does the work: it starts the program named by [`Worker`] once for each
//! asset, and sends it a [`Job`]; that program calls [`work`]. [`audit`] checks the written files against the
//! manifest, and [`write_page`] shows all of it.

mod audit;
mod collection;
mod driver;
mod job;
mod manifest;
mod page;
mod record;
mod settings;
mod store;
mod work;

pub use audit::{Audit, AuditOptions, Fault, audit};
pub use collection::{Collection, Found, Kind, RunSettings, Scan, duration};
pub use driver::{DriveOptions, Event, Planned, Remote, Summary, Told, Worker, drive};
pub use job::{Go, Job, Message, Outcome};
pub use manifest::{History, Manifest, Shard};
pub use page::write_page;
pub use record::{EstimateFigures, FileEntry, InputFile, Part, Record, ShortFigures, Stage, State};
pub use settings::{AssetSettings, PhotometricSettings, Settings, Task, Thumbnail, Turntable, ViewerPage};
pub use store::VERSION;
pub use work::{Host, Order, run as work};
