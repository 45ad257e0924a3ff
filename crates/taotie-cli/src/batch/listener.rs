//! The driver's events, as shown to the user.

use crate::console::{self, Bar};
use taotie_batch::{Event, Record};

/// Shows the progress of a collection, and reports what was not made.
#[derive(Default)]
pub struct Listener {
    bar: Option<Bar>,
}

impl Listener {
    /// Handles an event.
    pub fn hear(&mut self, event: Event<'_>) {
        match event {
            Event::Planned { todo, known } => {
                console::say(&format!("taotie: {todo} assets to do, {known} from earlier runs"));
                self.bar = (todo > 0).then(|| Bar::new(format!("{todo} assets")));
            }
            Event::Ended(record) => say(record),
            Event::Running { fraction, left, .. } => {
                if let Some(bar) = &self.bar {
                    bar.show_all(fraction, left);
                }
            }
        }
    }
}

/// Reports why an asset was not made or does not meet a requirement.
fn say(record: &Record) {
    let name = console::plain(&record.id);
    if let Some(error) = &record.error {
        console::say(&format!("taotie: {name}: {}: {}", record.state.name(), console::plain(error)));
    }
    for met in record.required.iter().filter(|met| !met.met) {
        let figure = met.name();
        console::say(&format!("taotie: {name}: {}: {figure} {}", record.state.name(), met.text()));
    }
}
