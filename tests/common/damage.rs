//! Damage to files, the same on every run.

/// Knuth's linear congruential generator; the high half is used.
pub struct Dice(pub u64);

impl Dice {
    /// Returns a number below `sides`.
    pub fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % sides.max(1)
    }
}

/// Typical numbers in damaged files.
const WORDS: [&str; 8] = ["-1", "0", "nan", "1e39", "4294967295", "99999999999999999999", "\0", "\n"];

/// Returns a copy of `seed` with up to four changes.
pub fn damage(seed: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=dice.roll(3) {
        let at = dice.roll(bytes.len());
        match dice.roll(6) {
            0 => bytes.truncate(at),
            1 if at < bytes.len() => bytes[at] ^= 1 << dice.roll(8),
            2 if at < bytes.len() => bytes[at] = [0, 0x7F, 0x80, 0xFF][dice.roll(4)],
            3 => drop(bytes.drain(at..bytes.len().min(at + 1 + dice.roll(8)))),
            4 => {
                let word = WORDS[dice.roll(WORDS.len())];
                bytes.splice(at..bytes.len().min(at + 1), word.bytes());
            }
            _ => {
                let copied = bytes[at..bytes.len().min(at + 1 + dice.roll(40))].to_vec();
                let to = dice.roll(bytes.len());
                bytes.splice(to..to, copied);
            }
        }
    }
    bytes
}
