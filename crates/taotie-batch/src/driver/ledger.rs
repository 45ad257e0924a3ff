//! The memory that processes may use together.

use taotie::asset::Bytes;

/// The memory promised to processes, out of the total.
#[derive(Debug)]
pub struct Ledger {
    budget: u64,
    taken: u64,
}

/// Returns the memory for reading a scan until its estimate is known: that of a file of `bytes` bytes, unpacked, plus
/// the
/// program itself.
pub fn reading(bytes: u64) -> u64 {
    const PROGRAM: u64 = 64 << 20;
    const UNPACKED: u64 = 6;
    bytes.saturating_mul(UNPACKED).saturating_add(PROGRAM)
}

impl Ledger {
    /// Creates a ledger; without a budget there is always room.
    pub fn new(budget: Option<Bytes>) -> Self {
        Self { budget: budget.map_or(u64::MAX, |bytes| bytes.0), taken: 0 }
    }

    /// Returns true if there is room for `want` bytes in place of the `held` bytes already promised.
    pub fn has_room(&self, want: u64, held: u64) -> bool {
        self.taken.saturating_sub(held).saturating_add(want) <= self.budget
    }

    /// Reserves memory.
    pub fn take(&mut self, bytes: u64) {
        self.taken = self.taken.saturating_add(bytes);
    }

    /// Releases reserved memory.
    pub fn give_back(&mut self, bytes: u64) {
        self.taken = self.taken.saturating_sub(bytes);
    }

    /// Returns how many processes of `each` bytes fit, at least one.
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
        assert!(ledger.has_room(70, 30), "a process's own share does not count against it");
        ledger.give_back(60);
        assert!(ledger.has_room(100, 0) && !ledger.has_room(101, 0));
        assert_eq!((ledger.holds(30), ledger.holds(1000), ledger.holds(0)), (3, 1, 100));
        assert!(Ledger::new(None).has_room(u64::MAX, 0));
    }
}
