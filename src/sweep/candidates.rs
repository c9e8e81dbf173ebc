//! The configurations that a sweep keeps.

use std::ops::Range;

/// Numbers of configurations of a joint space, in ascending order.
///
/// They are kept as runs of consecutive numbers: all of a space are one run, and where the optical axis sweeps over the zone, the
/// last joint makes a run of some length.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Candidates {
    /// None of them empty, none adjacent to the next.
    runs: Vec<Range<usize>>,
    len: usize,
}

impl Candidates {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The numbers.
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        self.runs.iter().cloned().flatten()
    }

    /// The runs, cut into pieces of at most `most` numbers.
    pub(crate) fn pieces(&self, most: usize) -> impl Iterator<Item = Range<usize>> {
        let cut = move |run: &Range<usize>| {
            let end = run.end;
            run.clone().step_by(most).map(move |start| start..end.min(start.saturating_add(most)))
        };
        self.runs.iter().flat_map(cut)
    }

    /// Adds numbers, all greater than those before.
    pub(super) fn push(&mut self, run: Range<usize>) {
        debug_assert!(self.runs.last().is_none_or(|last| last.end <= run.start));
        self.len += run.len();
        match self.runs.last_mut() {
            Some(last) if last.end == run.start => last.end = run.end,
            _ if run.is_empty() => {}
            _ => self.runs.push(run),
        }
    }

    /// Adds numbers that are all greater than these.
    pub(super) fn append(&mut self, others: Self) {
        let mut runs = others.runs.into_iter();
        if let Some(first) = runs.next() {
            self.len += others.len - first.len();
            self.push(first);
            self.runs.extend(runs);
        }
    }
}

impl FromIterator<usize> for Candidates {
    /// Numbers in ascending order.
    fn from_iter<I: IntoIterator<Item = usize>>(ids: I) -> Self {
        ids.into_iter().fold(Self::default(), |mut candidates, id| {
            candidates.push(id..id + 1);
            candidates
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_whole_however_they_came_together() {
        let ids = [0, 1, 2, 5, 6, 9];
        let whole: Candidates = ids.into_iter().collect();
        assert_eq!(whole.iter().collect::<Vec<_>>(), ids);
        for cut in 0..=ids.len() {
            let [mut head, tail] = [&ids[..cut], &ids[cut..]].map(|part| part.iter().copied().collect::<Candidates>());
            head.append(tail);
            assert_eq!(head, whole);
        }
        assert_eq!((whole.len(), whole.is_empty(), Candidates::default().is_empty()), (6, false, true));
    }

    #[test]
    fn pieces_are_all_there_is() {
        let candidates: Candidates = (0..7).chain(9..11).collect();
        assert_eq!(candidates.pieces(3).collect::<Vec<_>>(), [0..3, 3..6, 6..7, 9..11]);
        assert_eq!(candidates.pieces(usize::MAX).collect::<Vec<_>>(), [0..7, 9..11]);
    }
}
