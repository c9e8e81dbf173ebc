//! The best of many.

/// The `most` of the candidates with the highest scores, of equal ones the first, in no particular order.
pub(crate) fn highest(scores: &[f64], candidates: impl IntoIterator<Item = usize>, most: usize) -> Vec<usize> {
    if most == 0 {
        return vec![];
    }
    let by_score = |&a: &usize, &b: &usize| scores[b].total_cmp(&scores[a]).then(a.cmp(&b));
    // A buffer of the best so far, cut back whenever it has doubled: few candidates get past its least score.
    let mut best: Vec<usize> = Vec::with_capacity(2 * most);
    let mut least = f64::NEG_INFINITY;
    for i in candidates {
        if scores[i] >= least {
            best.push(i);
            if best.len() == 2 * most {
                best.select_nth_unstable_by(most - 1, by_score);
                best.truncate(most);
                least = scores[best[most - 1]];
            }
        }
    }
    if best.len() > most {
        best.select_nth_unstable_by(most - 1, by_score);
        best.truncate(most);
    }
    best
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_highest_are_the_first_of_a_sort(scores in prop::collection::vec(-3i32..3, 0..60), most in 0usize..9) {
            let scores: Vec<f64> = scores.into_iter().map(f64::from).collect();
            let mut sorted: Vec<usize> = (0..scores.len()).filter(|i| i % 3 != 1).collect();
            sorted.sort_by(|&a, &b| scores[b].total_cmp(&scores[a]).then(a.cmp(&b)));
            sorted.truncate(most);
            sorted.sort_unstable();
            let mut found = highest(&scores, (0..scores.len()).filter(|i| i % 3 != 1), most);
            found.sort_unstable();
            prop_assert_eq!(found, sorted);
        }
    }
}
