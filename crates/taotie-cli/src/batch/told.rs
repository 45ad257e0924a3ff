//! What the driver tells, as the user sees it.

use crate::console::{self, Bar};
use taotie_batch::{Event, Record};

/// Shows how far a collection is, and says what was not done.
#[derive(Default)]
pub struct Told {
    bar: Option<Bar>,
}

impl Told {
    /// Takes an event.
    pub fn hear(&mut self, event: Event<'_>) {
        match event {
            Event::Planned { todo, known } => {
                console::say(&format!("taotie: {todo} assets to do, {known} known from before"));
                self.bar = (todo > 0).then(|| Bar::new(format!("{todo} assets")));
            }
            Event::Ended(record) => say(record),
            Event::Running { fraction, left, .. } => {
                if let Some(bar) = &self.bar {
                    bar.tell_all(fraction, left);
                }
            }
        }
    }
}

/// Says why an asset was not made, or is not good enough.
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
