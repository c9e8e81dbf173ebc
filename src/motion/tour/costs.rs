//! Costs of the moves between stops.

/// Costs of all moves between stops, each the same there and back.
#[derive(Debug, Clone, PartialEq)]
pub struct Costs {
    len: usize,
    /// Row by row, both halves.
    values: Vec<f64>,
}

impl Costs {
    /// Costs between `len` stops: `cost(i, j)`, asked for i < j alone, is finite and not negative.
    pub fn from_fn(len: usize, mut cost: impl FnMut(usize, usize) -> f64) -> Self {
        let mut values = vec![0.0; len * len];
        for i in 0..len {
            for j in i + 1..len {
                let value = cost(i, j);
                debug_assert!(value.is_finite(), "cost {value} between {i} and {j}");
                values[i * len + j] = value;
                values[j * len + i] = value;
            }
        }
        Self { len, values }
    }

    /// Number of stops.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Cost of the move between `i` and `j`.
    pub fn between(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.len + j]
    }

    /// Costs of the moves between `i` and each stop.
    pub(super) fn of(&self, i: usize) -> &[f64] {
        &self.values[i * self.len..][..self.len]
    }

    /// Cost of the way along `stops`.
    pub(super) fn along(&self, stops: &[usize]) -> f64 {
        stops.windows(2).map(|pair| self.between(pair[0], pair[1])).sum()
    }

    /// Cost of the way along `stops` and back to the first.
    pub(super) fn around(&self, stops: &[usize]) -> f64 {
        let back = if let [first, .., last] = *stops { self.between(last, first) } else { 0.0 };
        self.along(stops) + back
    }

    /// The greatest cost; 0 where there are no moves.
    pub(super) fn greatest(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }
}
