//! An instance on some of its candidates.

use std::sync::Arc;

use super::{Block, Instance};
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
    /// The part that consists of `members`, ascending, among them all required candidates.
    pub(crate) fn new(whole: &'a Instance<'a>, members: Vec<usize>) -> Self {
        debug_assert!(members.is_sorted() && whole.required().iter().all(|i| members.binary_search(i).is_ok()));
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
