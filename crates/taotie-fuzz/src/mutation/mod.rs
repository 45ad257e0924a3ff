//! Changes of a file, as data: a finding is the name of a sound file and a list of these.
//!
//! A change whose position does not exist does nothing, so a list stays valid when other changes are removed from it.

mod bytes;
mod chunks;
mod json;
mod lines;

use bytes::ByteChange;
use chunks::ChunkChange;
use fastrand::Rng;
use json::JsonChange;
use lines::LineChange;
use serde::{Deserialize, Serialize};

/// The most changes to one file.
const MOST: usize = 4;

/// One change to a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mutation {
    /// Of its bytes, regardless of their meaning.
    Bytes(ByteChange),
    /// Of its JSON, standalone or inside a GLB.
    Json(JsonChange),
    /// Of the chunks of a PNG, GLB or RIFF.
    Chunks(ChunkChange),
    /// Of its lines and their words.
    Lines(LineChange),
    /// Corrects lengths and checksums of the container, so that readers look further.
    Mend,
}

impl Mutation {
    /// Applies the change to `bytes`.
    pub fn apply(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Bytes(change) => change.apply(bytes),
            Self::Json(change) => change.apply(bytes),
            Self::Chunks(change) => change.apply(bytes),
            Self::Lines(change) => change.apply(bytes),
            Self::Mend => chunks::repair(bytes),
        }
    }

    /// Chooses a change that fits `bytes`.
    fn choose(rng: &mut Rng, bytes: &[u8]) -> Self {
        let structured = rng.u8(..4) > 0;
        if structured && let Some(change) = JsonChange::choose(rng, bytes) {
            return Self::Json(change);
        }
        if structured
            && rng.bool()
            && let Some(change) = ChunkChange::choose(rng, bytes)
        {
            return Self::Chunks(change);
        }
        if structured && let Some(change) = LineChange::choose(rng, bytes) {
            return Self::Lines(change);
        }
        Self::Bytes(ByteChange::choose(rng, bytes.len()))
    }
}

/// Chooses changes to the file `sound`: rarely none, usually one to four, each fitting the result of those before it.
pub fn choose(rng: &mut Rng, sound: &[u8]) -> Vec<Mutation> {
    let (mut bytes, mut chosen) = (sound.to_vec(), Vec::new());
    for _ in 0..rng.usize(..=MOST) {
        let mutation = Mutation::choose(rng, &bytes);
        mutation.apply(&mut bytes);
        chosen.push(mutation);
    }
    if chunks::is_container(sound) && rng.u8(..4) > 0 {
        chosen.push(Mutation::Mend);
    }
    chosen
}

/// Returns a copy of the file `sound` with these changes applied.
pub fn changed(sound: &[u8], mutations: &[Mutation]) -> Vec<u8> {
    let mut bytes = sound.to_vec();
    mutations.iter().for_each(|mutation| mutation.apply(&mut bytes));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_changes_are_the_same_for_a_seed_and_survive_json() {
        let sound = br#"{"accessors":[{"count":3,"componentType":5126}],"scene":0}"#;
        for seed in 0..500 {
            let chosen = choose(&mut Rng::with_seed(seed), sound);
            assert_eq!(chosen, choose(&mut Rng::with_seed(seed), sound));
            let text = serde_json::to_string(&chosen).unwrap();
            let read: Vec<Mutation> = serde_json::from_str(&text).unwrap();
            assert_eq!(changed(sound, &read), changed(sound, &chosen), "{text}");
        }
    }

    #[test]
    fn every_kind_of_change_is_chosen() {
        let text = b"v 0 0 0\nf 1 2 3\n";
        let png = [&b"\x89PNG\r\n\x1a\n"[..], &[0, 0, 0, 1], b"tEXt", &[7, 1, 2, 3, 4]].concat();
        let mut seen = [false; 5];
        for seed in 0..300 {
            for sound in [&text[..], &png, b"{\"a\":[1]}"] {
                for mutation in choose(&mut Rng::with_seed(seed), sound) {
                    let kind = match mutation {
                        Mutation::Bytes(_) => 0,
                        Mutation::Json(_) => 1,
                        Mutation::Chunks(_) => 2,
                        Mutation::Lines(_) => 3,
                        Mutation::Mend => 4,
                    };
                    seen[kind] = true;
                }
            }
        }
        assert_eq!(seen, [true; 5]);
    }

    /// Removing changes may leave others whose positions no longer exist.
    #[test]
    fn any_change_applies_to_any_file() {
        let sound: [&[u8]; 5] = [b"", b"x", b"{}", b"glTF\x02\0\0\0", b"RIFF\xff\xff\xff\xffWEBPVP8 "];
        for seed in 0..300 {
            for mutation in choose(&mut Rng::with_seed(seed), br#"{"a":[1,"b"]}"#) {
                sound.iter().for_each(|file| drop(changed(file, std::slice::from_ref(&mutation))));
            }
        }
    }
}
