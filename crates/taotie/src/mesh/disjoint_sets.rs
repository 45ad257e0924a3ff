//! Disjoint sets of numbers, joined in pairs.

/// The numbers below a count in sets, initially one each; the lowest number of a set represents it.
pub(crate) struct DisjointSets {
    parents: Vec<u32>,
}

impl DisjointSets {
    /// Creates a set for each number below `count`, at most 2^32.
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// Joins the sets of two numbers.
    pub fn join(&mut self, one: u32, other: u32) {
        let [a, b] = [one, other].map(|i| self.lowest(i));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// Returns the lowest number of the set of each number.
    pub fn into_lowest(mut self) -> Vec<u32> {
        // A set's lowest number precedes all others, which refer to it by then.
        for i in 0..self.parents.len() {
            self.parents[i] = self.parents[self.parents[i] as usize];
        }
        self.parents
    }

    /// Returns the lowest number of a set, and halves the path to it.
    fn lowest(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            self.parents[i as usize] = self.parents[self.parents[i as usize] as usize];
            i = self.parents[i as usize];
        }
        i
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_number_stands_for_its_set() {
        let mut sets = DisjointSets::new(7);
        [(5, 6), (3, 5), (6, 1), (2, 4), (4, 2)].into_iter().for_each(|(a, b)| sets.join(a, b));
        assert_eq!(sets.into_lowest(), [0, 1, 2, 1, 2, 1, 1]);
    }
}
