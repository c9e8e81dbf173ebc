//! Centres of clusters, and which are nearest to a point.

#![expect(clippy::inline_always, reason = "only so are they compiled for the instructions of those that call them")]

use super::points::Points;

/// Centres that are looked at together: two registers of AVX2 full.
const LANES: usize = 8;

/// Centres in blocks of [`LANES`], coordinate by coordinate, so that the compiler uses vector instructions. Distances are summed over
/// the coordinates in their order and nothing is fused, so that every processor finds the same.
#[derive(Debug, Clone)]
pub(super) struct Centres {
    width: usize,
    count: usize,
    /// `width` rows for each block; centres that are missing in the last block are infinitely far away.
    rows: Vec<[f64; LANES]>,
}

/// The centre that is nearest to a point, the first of those equally near; its squared distance, and that of the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    pub(super) centre: usize,
    pub(super) squared: f64,
    pub(super) second_squared: f64,
}

impl Nearest {
    const NONE: Self = Self { centre: 0, squared: f64::INFINITY, second_squared: f64::INFINITY };

    /// Takes note of the squared distances of a block of centres, the blocks in their order.
    #[inline(always)]
    fn or_nearer(&mut self, block: usize, squared: &[f64; LANES]) {
        if squared.map(|squared| squared < self.second_squared) == [false; LANES] {
            return;
        }
        for (lane, &squared) in squared.iter().enumerate() {
            if squared < self.squared {
                *self = Self { centre: block * LANES + lane, squared, second_squared: self.squared };
            } else if squared < self.second_squared {
                self.second_squared = squared;
            }
        }
    }
}

impl Centres {
    pub(super) fn new<'p>(width: usize, points: impl ExactSizeIterator<Item = &'p [f64]>) -> Self {
        let count = points.len();
        let rows = vec![[f64::INFINITY; LANES]; count.div_ceil(LANES) * width];
        let mut centres = Self { width, count, rows };
        for (c, point) in points.enumerate() {
            centres.put(c, point);
        }
        centres
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    pub(super) fn get(&self, c: usize) -> Vec<f64> {
        let rows = &self.rows[c / LANES * self.width..][..self.width];
        rows.iter().map(|row| row[c % LANES]).collect()
    }

    pub(super) fn put(&mut self, c: usize, point: &[f64]) {
        let rows = &mut self.rows[c / LANES * self.width..][..self.width];
        for (row, x) in rows.iter_mut().zip(point) {
            row[c % LANES] = *x;
        }
    }

    #[inline(always)]
    pub(super) fn squared_distance(&self, point: &[f64], c: usize) -> f64 {
        let rows = &self.rows[c / LANES * self.width..][..self.width];
        rows.iter().zip(point).map(|(row, x)| (x - row[c % LANES]) * (x - row[c % LANES])).sum()
    }

    #[inline(always)]
    pub(super) fn nearest(&self, point: &[f64]) -> Nearest {
        let mut found = Nearest::NONE;
        for (block, rows) in self.rows.chunks_exact(self.width).enumerate() {
            found.or_nearer(block, &squared_distances(rows, point));
        }
        found
    }

    /// Of each centre the point nearest to it, the first of those equally near.
    #[inline(always)]
    pub(super) fn nearest_points(&self, points: &Points) -> Vec<usize> {
        let blocks = self.rows.len() / self.width;
        let (mut least, mut nearest) = (vec![[f64::INFINITY; LANES]; blocks], vec![[0; LANES]; blocks]);
        for (i, point) in points.iter().enumerate() {
            for ((rows, least), nearest) in self.rows.chunks_exact(self.width).zip(&mut least).zip(&mut nearest) {
                let squared = squared_distances(rows, point);
                let mut nearer = [false; LANES];
                for lane in 0..LANES {
                    nearer[lane] = squared[lane] < least[lane];
                }
                if nearer == [false; LANES] {
                    continue;
                }
                for lane in (0..LANES).filter(|&lane| nearer[lane]) {
                    (least[lane], nearest[lane]) = (squared[lane], i);
                }
            }
        }
        nearest.into_iter().flatten().take(self.count).collect()
    }
}

#[inline(always)]
fn squared_distances(rows: &[[f64; LANES]], point: &[f64]) -> [f64; LANES] {
    let mut sums = [0.0; LANES];
    for (row, x) in rows.iter().zip(point) {
        for lane in 0..LANES {
            let apart = x - row[lane];
            sums[lane] += apart * apart;
        }
    }
    sums
}
