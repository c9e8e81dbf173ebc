//! An instance on some of its candidates.

use std::sync::Arc;

use super::{Block, Group, Instance};
use crate::selection::InformationSet;

/// Some candidates of an instance, with copies of their matrices: what is left to look at once the others are known to be in no
/// selection that is sought.
#[derive(Debug, Clone)]
pub(crate) struct Part<'a> {
    whole: &'a Instance<'a>,
    /// The candidates, ascending; the required ones are among them.
    members: Vec<usize>,
    /// Their matrices, term by term.
    tables: Vec<InformationSet>,
}

impl<'a> Part<'a> {
    /// The part that consists of `candidates`, in any order, and of the required ones.
    pub(crate) fn new(whole: &'a Instance<'a>, candidates: impl IntoIterator<Item = usize>) -> Self {
        let mut members: Vec<usize> = candidates.into_iter().chain(whole.required().iter().copied()).collect();
        members.sort_unstable();
        members.dedup();
        let tables = whole.blocks.iter().map(|block| block.candidates.select(&members)).collect();
        Self { whole, members, tables }
    }

    /// The same problem with these candidates alone, numbered by their places.
    pub(crate) fn instance(&self) -> Instance<'_> {
        let blocks = self.whole.blocks.iter().zip(&self.tables).map(|(block, candidates)| Block {
            candidates,
            prior: block.prior.clone(),
            function: block.function.clone(),
            share: block.share,
            place: block.place.clone(),
        });
        Instance {
            blocks: blocks.collect(),
            scenarios: self.whole.scenarios.clone(),
            softness: self.whole.softness,
            count: self.whole.count,
            rules: Arc::new(self.whole.rules.of_part(&self.members)),
        }
    }

    /// What it is a part of.
    pub(crate) fn whole(&self) -> &'a Instance<'a> {
        self.whole
    }

    /// Prices of the part's groups as those of the whole: balls are between the same candidates there, and hold more.
    pub(crate) fn whole_prices(&self, prices: &[(Group, f64)]) -> Vec<(Group, f64)> {
        let of_whole = |group| match group {
            Group::Ball { separation, between } => {
                Group::Ball { separation, between: between.map(|i| self.members[i]) }
            }
            cap @ Group::Cap(_) => cap,
        };
        prices.iter().map(|&(group, price)| (of_whole(group), price)).collect()
    }

    /// The place of a member.
    pub(crate) fn place(&self, member: usize) -> Option<usize> {
        self.members.binary_search(&member).ok()
    }

    /// The places of candidates all of which are members.
    pub(crate) fn places(&self, members: &[usize]) -> Vec<usize> {
        members.iter().filter_map(|&member| self.place(member)).collect()
    }

    /// The members at places.
    pub(crate) fn members(&self, places: &[usize]) -> Vec<usize> {
        places.iter().map(|&place| self.members[place]).collect()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::selection::{Cap, Constraints, InformationFunction, Separation, Term, exchange};

    /// Values, rules and what exchange makes of them are those of the whole, as far as its members go.
    #[test]
    fn a_part_is_the_whole_without_the_others() {
        let matrices: Vec<DMatrix<f64>> = (0..12)
            .map(|i| DMatrix::from_diagonal(&vec![f64::from(i % 5) + 0.5, f64::from(i * 7 % 11) + 0.2].into()))
            .collect();
        let candidates = InformationSet::from_matrices(2, &matrices).unwrap();
        let function = InformationFunction::Determinant;
        let term = Term { candidates: &candidates, prior: None, function: &function, share: 1.0 };
        let constraints = Constraints {
            required: vec![3],
            forbidden: vec![4],
            caps: vec![Cap { members: vec![1, 5, 9], most: 1 }],
            separations: vec![Separation::of(&(0..12).map(|i| [f64::from(i)]).collect::<Vec<_>>(), 1.5)],
        };
        let whole = Instance::constrained(&[term], 3, constraints).unwrap();
        let members = vec![1, 3, 4, 5, 6, 9, 11];
        let part = Part::new(&whole, members.clone());
        let instance = part.instance();
        assert_eq!((instance.len(), instance.required()), (7, [1].as_slice()));
        assert_eq!(part.places(&[3, 9, 11]), [1, 5, 6]);
        assert_eq!(part.members(&[1, 5, 6]), [3, 9, 11]);
        assert_eq!(instance.log_value(&[1, 5, 6]), whole.log_value(&[3, 9, 11]));
        for (a, &i) in members.iter().enumerate() {
            assert_eq!(instance.is_open(a), whole.is_open(i));
            assert!(instance.rules().caps_of(a).eq(whole.rules().caps_of(i)));
            let [of_part, of_whole] = [a, i].map(|i| Group::Ball { separation: 0, between: [i, i] });
            assert_eq!(
                part.whole_prices(&[(Group::Cap(0), 0.5), (of_part, 1.5)]),
                [(Group::Cap(0), 0.5), (of_whole, 1.5)]
            );
            for (b, &j) in members.iter().enumerate() {
                assert_eq!(instance.rules().allows(&[a], None, b), whole.rules().allows(&[i], None, j), "{i} {j}");
            }
        }
        let found = part.members(&exchange(&instance, vec![0, 1, 6]).unwrap());
        assert!(found.contains(&3) && found.iter().all(|i| members.contains(i)));
        assert!(whole.log_value(&found).unwrap() >= whole.log_value(&[1, 3, 11]).unwrap());
    }
}
