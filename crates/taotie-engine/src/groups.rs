//! Items in groups: counted and placed without sorting, or joined in pairs.

/// Values grouped by group number: those of each group, group after group, in the order they came in. They are counted
/// first, then placed, so that no sorting is needed.
#[derive(Debug)]
pub struct Groups<T> {
    /// The start of each group in `values`, and the end of the last.
    starts: Vec<usize>,
    values: Vec<T>,
}

impl<T: Copy + Default> Groups<T> {
    /// Groups values, each given with its group, which is below `count`. `entries` is called twice and must give the
    /// same both times.
    pub fn new<I: Iterator<Item = (usize, T)>>(count: usize, entries: impl Fn() -> I) -> Self {
        // The start of group i begins at index i + 1 and advances to the group's end, which is the start of the next.
        let mut starts = vec![0; count + 2];
        entries().for_each(|(group, _)| starts[group + 2] += 1);
        (2..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut values = vec![T::default(); starts[count + 1]];
        entries().for_each(|(group, value)| {
            let next = &mut starts[group + 1];
            values[*next] = value;
            *next += 1;
        });
        starts.pop();
        Self { starts, values }
    }

    /// Returns the number of groups.
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the values of a group.
    pub fn of(&self, group: usize) -> &[T] {
        &self.values[self.starts[group]..self.starts[group + 1]]
    }
}

/// Disjoint sets, joined in pairs: the numbers below a count, initially one each; the lowest number of a set represents
/// it.
#[derive(Debug)]
pub struct DisjointSets {
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
    fn values_stand_in_their_groups_in_the_order_in_which_they_came() {
        let entries = [(3, 'a'), (0, 'b'), (3, 'c'), (1, 'd'), (0, 'e')];
        let groups = Groups::new(5, || entries.into_iter());
        let found: Vec<&[char]> = (0..groups.count()).map(|group| groups.of(group)).collect();
        assert_eq!(found, [&['b', 'e'][..], &['d'], &[], &['a', 'c'], &[]]);
        assert_eq!(Groups::<u8>::new(0, std::iter::empty).count(), 0);
    }

    #[test]
    fn the_lowest_number_stands_for_its_set() {
        let mut sets = DisjointSets::new(7);
        [(5, 6), (3, 5), (6, 1), (2, 4), (4, 2)].into_iter().for_each(|(a, b)| sets.join(a, b));
        assert_eq!(sets.into_lowest(), [0, 1, 2, 1, 2, 1, 1]);
    }
}
