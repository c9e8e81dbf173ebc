//! Intrinsics that share one value.

use crate::camera::MAX_INTRINSICS;

/// Which intrinsics have one value: of those tied together the first is free, and the others follow it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ties {
    /// The first of those that each one is tied to; itself where it is not.
    leader: [usize; MAX_INTRINSICS],
}

impl Default for Ties {
    fn default() -> Self {
        Self { leader: std::array::from_fn(|j| j) }
    }
}

impl Ties {
    /// These, and `a` and `b` (indices into [`crate::camera::Camera::intrinsics`]) tied together; indices beyond the
    /// largest camera model's tie nothing.
    #[must_use]
    pub fn and(mut self, a: usize, b: usize) -> Self {
        if a.max(b) < MAX_INTRINSICS {
            let (first, other) = (self.leader[a].min(self.leader[b]), self.leader[a].max(self.leader[b]));
            for leader in self.leader.iter_mut().filter(|leader| **leader == other) {
                *leader = first;
            }
        }
        self
    }

    /// The intrinsic that `j` follows; itself where it is free.
    pub fn leader(&self, j: usize) -> usize {
        self.leader.get(j).copied().unwrap_or(j)
    }

    /// The intrinsics that follow another, with that.
    pub fn followers(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.leader.iter().copied().enumerate().filter(|(j, leader)| j != leader)
    }

    /// The free ones among `estimated`, in its order.
    pub(super) fn free(&self, estimated: &[usize]) -> Vec<usize> {
        estimated.iter().copied().filter(|&j| self.leader(j) == j).collect()
    }

    /// Two that are tied together, of which `estimated` names one only.
    pub(super) fn torn(&self, estimated: &[usize]) -> Option<(usize, usize)> {
        self.followers().map(|(j, leader)| (leader, j)).find(|(a, b)| estimated.contains(a) != estimated.contains(b))
    }

    /// Gives those that are tied together their mean.
    pub(super) fn level(&self, θ: &mut [f64; MAX_INTRINSICS]) {
        for first in 0..MAX_INTRINSICS {
            let group = || (first..MAX_INTRINSICS).filter(|&j| self.leader[j] == first);
            let mean = group().map(|j| θ[j]).sum::<f64>() / group().count() as f64;
            if group().count() > 1 {
                for j in group() {
                    θ[j] = mean;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_join_into_groups() {
        let ties = Ties::default().and(1, 0).and(5, 4).and(6, 5);
        assert_eq!(ties.followers().collect::<Vec<_>>(), [(1, 0), (5, 4), (6, 4)]);
        assert_eq!(ties.free(&[6, 0, 1, 4, 2, 5]), [0, 4, 2]);
        assert_eq!(ties.torn(&[0, 1, 2]), None);
        assert_eq!(ties.torn(&[0, 1, 4, 6]), Some((4, 5)));
        let mut θ = [0.0; MAX_INTRINSICS];
        θ[..7].copy_from_slice(&[2.0, 4.0, 7.0, 8.0, 1.0, 2.0, 6.0]);
        ties.level(&mut θ);
        assert_eq!(θ[..7], [3.0, 3.0, 7.0, 8.0, 3.0, 3.0, 3.0]);
        assert_eq!(Ties::default().and(2, 40), Ties::default());
    }
}
