//! What is clustered.

use thiserror::Error;

/// Points with the same number of finite coordinates.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    width: usize,
    /// Point after point.
    coordinates: Vec<f64>,
}

/// Why points cannot be clustered.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ClusteringError {
    /// A point is not of as many finite coordinates as the first, one or more.
    #[error("k-means needs points with the same number of finite coordinates; point {point}, counted from 0, differs")]
    Point {
        /// The point.
        point: usize,
    },
    /// No cluster is asked for, or more than there are points.
    #[error("{points} points do not make {count} clusters")]
    Count {
        /// Clusters asked for.
        count: usize,
        /// Number of points.
        points: usize,
    },
}

impl Points {
    /// The points of these coordinates.
    ///
    /// # Errors
    /// When a point is not of as many finite coordinates as the first, one or more.
    pub fn new(points: impl IntoIterator<Item: AsRef<[f64]>>) -> Result<Self, ClusteringError> {
        let (mut width, mut coordinates) = (0, vec![]);
        for (i, point) in points.into_iter().enumerate() {
            let point = point.as_ref();
            if i == 0 {
                width = point.len();
            }
            if point.len() != width || width == 0 || !point.iter().all(|x| x.is_finite()) {
                return Err(ClusteringError::Point { point: i });
            }
            coordinates.extend_from_slice(point);
        }
        coordinates.shrink_to_fit();
        Ok(Self { width, coordinates })
    }

    /// Every `step`th of them, from the first on.
    pub(super) fn every(&self, step: usize) -> Self {
        Self { width: self.width, coordinates: self.iter().step_by(step).flatten().copied().collect() }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.coordinates.len() / self.width.max(1)
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.coordinates.is_empty()
    }

    /// Number of coordinates of each.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn point(&self, i: usize) -> &[f64] {
        &self.coordinates[i * self.width..(i + 1) * self.width]
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[f64]> {
        self.coordinates.chunks_exact(self.width.max(1))
    }
}

pub(super) fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}
