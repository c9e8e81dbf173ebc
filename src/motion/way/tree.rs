//! A tree of configurations that safe moves join.

/// Configurations, each joined to its parent by a safe straight move; the root is number 0.
pub(super) struct Tree {
    nodes: Vec<Vec<f64>>,
    /// Of each node; the root's is the root.
    parents: Vec<usize>,
}

impl Tree {
    pub(super) fn rooted(root: &[f64]) -> Self {
        Self { nodes: vec![root.to_vec()], parents: vec![0] }
    }

    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn at(&self, node: usize) -> &[f64] {
        &self.nodes[node]
    }

    /// Adds a configuration; its number.
    pub(super) fn add(&mut self, parent: usize, q: Vec<f64>) -> usize {
        self.nodes.push(q);
        self.parents.push(parent);
        self.nodes.len() - 1
    }

    /// The node that costs least to move from to `q`.
    pub(super) fn nearest(&self, q: &[f64], cost: &dyn Fn(&[f64], &[f64]) -> f64) -> usize {
        let (mut nearest, mut least) = (0, f64::INFINITY);
        for (node, at) in self.nodes.iter().enumerate() {
            let cost = cost(at, q);
            if cost < least {
                (nearest, least) = (node, cost);
            }
        }
        nearest
    }

    /// The configurations from the root to a node.
    pub(super) fn branch(&self, mut node: usize) -> Vec<Vec<f64>> {
        let mut branch = vec![self.nodes[node].clone()];
        while node > 0 {
            node = self.parents[node];
            branch.push(self.nodes[node].clone());
        }
        branch.reverse();
        branch
    }
}
