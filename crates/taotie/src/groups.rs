//! Values grouped by group number: counted first, then placed, so that no sorting is needed.

/// The values of each group, group after group, in the order they came in.
#[derive(Debug)]
pub(crate) struct Groups<T> {
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
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the values of a group.
    pub fn of(&self, group: usize) -> &[T] {
        &self.values[self.starts[group]..self.starts[group + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stand_in_their_groups_in_the_order_in_which_they_came() {
        let entries = [(3, 'a'), (0, 'b'), (3, 'c'), (1, 'd'), (0, 'e')];
        let groups = Groups::new(5, || entries.into_iter());
        let found: Vec<&[char]> = (0..groups.len()).map(|group| groups.of(group)).collect();
        assert_eq!(found, [&['b', 'e'][..], &['d'], &[], &['a', 'c'], &[]]);
        assert_eq!(Groups::<u8>::new(0, std::iter::empty).len(), 0);
    }
}
