//! A closed tour to be rearranged.

/// A closed tour of all nodes, in which each is found at once.
pub(super) struct Cycle {
    order: Vec<usize>,
    /// Each node's place in the order.
    places: Vec<usize>,
}

impl Cycle {
    pub(super) fn new(order: Vec<usize>) -> Self {
        let mut cycle = Self { places: vec![0; order.len()], order };
        cycle.find(0, cycle.order.len());
        cycle
    }

    pub(super) fn order(&self) -> &[usize] {
        &self.order
    }

    pub(super) fn set_order(&mut self, order: &[usize]) {
        self.order.copy_from_slice(order);
        self.find(0, order.len());
    }

    pub(super) fn after(&self, node: usize) -> usize {
        self.order[self.next(self.places[node])]
    }

    pub(super) fn before(&self, node: usize) -> usize {
        self.order[self.previous(self.places[node])]
    }

    /// Replaces the edges a–c and b–d by a–b and c–d, where c and d come both after a and b or both before.
    pub(super) fn cross(&mut self, [a, c]: [usize; 2], [b, d]: [usize; 2]) {
        if self.after(a) == c { self.reverse(c, b) } else { self.reverse(a, d) }
    }

    /// Turns round the part from one node on to another, or all the rest where that is shorter: the same tour, the other way.
    fn reverse(&mut self, from: usize, to: usize) {
        let n = self.order.len();
        let (mut first, mut last) = (self.places[from], self.places[to]);
        let mut len = if first <= last { last - first + 1 } else { last + n - first + 1 };
        if 2 * len > n {
            (first, last, len) = (self.next(last), self.previous(first), n - len);
        }
        for _ in 0..len / 2 {
            self.order.swap(first, last);
            self.places[self.order[first]] = first;
            self.places[self.order[last]] = last;
            (first, last) = (self.next(first), self.previous(last));
        }
    }

    /// Swaps the part of places `first..middle` and that of `middle..end`.
    pub(super) fn swap(&mut self, [first, middle, end]: [usize; 3]) {
        self.order[first..end].rotate_left(middle - first);
        self.find(first, end);
    }

    fn find(&mut self, first: usize, end: usize) {
        for place in first..end {
            self.places[self.order[place]] = place;
        }
    }

    fn next(&self, place: usize) -> usize {
        if place + 1 == self.order.len() { 0 } else { place + 1 }
    }

    fn previous(&self, place: usize) -> usize {
        if place == 0 { self.order.len() - 1 } else { place - 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossing_replaces_two_edges() {
        let n = 7;
        for a in 0..n {
            for b in (0..n).filter(|&b| b != a) {
                for next in [Cycle::after, Cycle::before] {
                    let mut cycle = Cycle::new(vec![3, 1, 4, 0, 5, 2, 6]);
                    let mut edges = edges_of(&cycle);
                    let (c, d) = (next(&cycle, a), next(&cycle, b));
                    if c == b || d == a {
                        continue;
                    }
                    cycle.cross([a, c], [b, d]);
                    edges.retain(|&edge| edge != sorted(a, c) && edge != sorted(b, d));
                    edges.extend([sorted(a, b), sorted(c, d)]);
                    edges.sort_unstable();
                    assert_eq!(edges_of(&cycle), edges);
                }
            }
        }
    }

    #[test]
    fn parts_swap() {
        let mut cycle = Cycle::new(vec![3, 1, 4, 0, 5, 2, 6]);
        cycle.swap([1, 3, 6]);
        assert_eq!(cycle.order(), [3, 0, 5, 2, 1, 4, 6]);
        assert_eq!((cycle.after(6), cycle.before(3), cycle.after(2)), (3, 6, 1));
    }

    fn sorted(a: usize, b: usize) -> (usize, usize) {
        (a.min(b), a.max(b))
    }

    fn edges_of(cycle: &Cycle) -> Vec<(usize, usize)> {
        let mut edges: Vec<_> = (0..cycle.order.len()).map(|i| sorted(i, cycle.after(i))).collect();
        edges.sort_unstable();
        edges
    }
}
