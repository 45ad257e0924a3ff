//! The memory that processes may take together.

use taotie::asset::Bytes;

/// What is promised to processes, out of what there is.
#[derive(Debug)]
pub struct Ledger {
    budget: u64,
    taken: u64,
}

/// Returns the memory that reading a scan takes until its forecast is known: a file of so many bytes, unpacked, beside the
/// program itself.
pub fn reading(bytes: u64) -> u64 {
    const PROGRAM: u64 = 64 << 20;
    const UNPACKED: u64 = 6;
    bytes.saturating_mul(UNPACKED).saturating_add(PROGRAM)
}

impl Ledger {
    /// Makes a ledger; without a budget there is always room.
    pub fn new(budget: Option<Bytes>) -> Self {
        Self { budget: budget.map_or(u64::MAX, |bytes| bytes.0), taken: 0 }
    }

    /// Says whether there is room for so much in place of what is held already.
    pub fn has_room(&self, want: u64, held: u64) -> bool {
        self.taken.saturating_sub(held).saturating_add(want) <= self.budget
    }

    /// Promises memory.
    pub fn take(&mut self, bytes: u64) {
        self.taken = self.taken.saturating_add(bytes);
    }

    /// Takes a promise back.
    pub fn give_back(&mut self, bytes: u64) {
        self.taken = self.taken.saturating_sub(bytes);
    }

    /// Returns how many processes of so much memory there is room for, at least one.
    pub fn holds(&self, each: u64) -> usize {
        usize::try_from(self.budget / each.max(1)).unwrap_or(usize::MAX).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_is_what_others_leave() {
        let mut ledger = Ledger::new(Some(Bytes(100)));
        ledger.take(60);
        assert!(ledger.has_room(40, 0) && !ledger.has_room(41, 0));
        assert!(ledger.has_room(70, 30), "what a process holds itself is not in its way");
        ledger.give_back(60);
        assert!(ledger.has_room(100, 0) && !ledger.has_room(101, 0));
        assert_eq!((ledger.holds(30), ledger.holds(1000), ledger.holds(0)), (3, 1, 100));
        assert!(Ledger::new(None).has_room(u64::MAX, 0));
    }
}
