//! How far detected points scatter.
//!
//! Point j of a view has a 2×2 covariance `Σ_j`. *Edges*: a corner is found where the edges that meet in it are seen to cross.
//! In the picture they run along the unit vectors e₁ and e₂, `n_d ⟂ e_d`, and within the detector's window lengths `ℓ_d` of
//! them are seen. What the grey values' gradients there know of the corner's place is their structure tensor (Förstner and
//! Gülch 1987),
//!
//! ```text
//!     T = ℓ₁ n₁n₁ᵀ + ℓ₂ n₂n₂ᵀ        Σ = σ² 2w T⁻¹        (w half the window's side)
//! ```
//!
//! so that σ is the deviation of a corner of large squares that are seen square-on, for which T = 2w·1. The edge of a circle
//! tells of its centre in the same way, `T = ∮ n nᵀ ds`. Of blurred edges, T is less ([`Blur`]).

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Matrix2x3, Matrix3, SMatrix, Vector2};

use super::blur::Blur;
use crate::camera::Camera;
use crate::lanes::{Lanes, Number};
use crate::target::Feature;

/// How far detected points scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation in px, in each direction; of the edges' model that of a corner of large squares seen square-on.
    pub sigma: f64,
    /// How it depends on the view.
    pub model: NoiseModel,
}

/// How the scatter of a detected point depends on how it is seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum NoiseModel {
    /// Not at all.
    #[default]
    Constant,
    /// By the edges that the detector sees.
    Edges {
        /// Half the side of the detector's window in px.
        window: f64,
        /// Defocus and motion; with them σ is that of a sharp corner.
        blur: Blur,
    },
}

/// A [`NoiseModel`] without its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NoiseName {
    /// [`NoiseModel::Constant`].
    Constant,
    /// [`NoiseModel::Edges`], which rendered pictures confirm.
    #[default]
    Edges,
}

/// The upper triangle W of a 2×2 matrix with `WᵀW = σ² Σ⁻¹`: residuals and derivatives times W are as those of a point with
/// the standard deviation σ in each direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Whitening<N = f64> {
    xx: N,
    xy: N,
    yy: N,
}

/// What a point is, or what several of one kind are: a [`Feature`] as plain numbers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind<N> {
    /// Edges that meet, and on how many sides of the corner each is seen.
    Corner {
        edges: [[N; 2]; 2],
        sides: N,
    },
    Circle {
        radius: N,
    },
    Point,
}

/// Points of a circle's edge that are looked at.
pub(crate) const EDGE_POINTS: u32 = 24;

/// Least share of a window's edges that a detector sees in a direction: a square seen edge-on is no corner, and the limit only
/// keeps the numbers finite.
pub(crate) const LEAST_SHARE: f64 = 1e-6;

impl Whitening {
    /// Of a point with the standard deviation σ in each direction.
    pub const NONE: Self = Self { xx: 1.0, xy: 0.0, yy: 1.0 };

    /// The same of a point of another weight: that much less scatter.
    #[must_use]
    pub fn weighted(self, weight: f64) -> Self {
        Self { xx: weight * self.xx, xy: weight * self.xy, yy: weight * self.yy }
    }

    /// `W A`.
    pub fn of_rows<const N: usize>(&self, A: &SMatrix<f64, 2, N>) -> SMatrix<f64, 2, N> {
        Matrix2::new(self.xx, self.xy, 0.0, self.yy) * A
    }

    /// `W⁻¹ z`: of a z with unit covariance a draw of the point's scatter, over σ.
    pub fn coloured(&self, [x, y]: [f64; 2]) -> Vector2<f64> {
        let y = y / self.yy;
        Vector2::new((x - self.xy * y) / self.xx, y)
    }

    /// `Σ / σ²`.
    pub fn covariance(&self) -> Matrix2<f64> {
        let columns = [[1.0, 0.0], [0.0, 1.0]].map(|z| self.coloured(z));
        columns[0] * columns[0].transpose() + columns[1] * columns[1].transpose()
    }
}

#[allow(private_bounds, reason = "what is here is the crate's own")]
impl<N: Number> Whitening<N> {
    /// Of points with the standard deviation σ in each direction.
    #[inline(always)]
    fn none() -> Self {
        let [zero, one] = [0.0, 1.0].map(N::all);
        Self { xx: one, xy: zero, yy: one }
    }

    /// Of a symmetric positive definite matrix `σ² Σ⁻¹`, by its entries xx, xy and yy.
    #[inline(always)]
    fn of(precision: [N; 3]) -> Self {
        let xx = precision[0].sqrt();
        let xy = precision[1] / xx;
        Self { xx, xy, yy: (precision[2] - xy * xy).map(|rest| rest.max(0.0)).sqrt() }
    }

    /// `W r`.
    #[inline(always)]
    pub(crate) fn whitened(&self, [x, y]: [N; 2]) -> [N; 2] {
        [self.xx * x + self.xy * y, self.yy * y]
    }
}

impl NoiseModel {
    /// Half the side of the window, px, where nothing is said: what most programs give OpenCV's `cornerSubPix`.
    pub const USUAL_WINDOW: f64 = 5.0;

    /// The whitening of a point in a view by what it is, by the derivative of its pixel by its place in C (px per m), by the
    /// rotation of `X_CT`, and by its vergence, [`Camera::vergence`](crate::camera::Camera::vergence).
    #[inline]
    pub fn whitening_in_view(
        &self,
        feature: &Feature,
        by_point: &Matrix2x3<f64>,
        R: &Matrix3<f64>,
        vergence: f64,
    ) -> Whitening {
        match self {
            Self::Constant => Whitening::NONE,
            Self::Edges { window, blur } => {
                edges(*window, blur, &feature.into(), &rows(&(by_point * R.fixed_columns::<2>(0))), vergence)
            }
        }
    }

    /// The same of one point or of several, by the derivatives of their pixels by their places on the board (px per m), two rows.
    #[inline(always)]
    pub(super) fn whitening_of<N: Number>(&self, kind: &Kind<N>, by_place: &[[N; 2]; 2], vergence: N) -> Whitening<N> {
        match self {
            Self::Constant => Whitening::none(),
            Self::Edges { window, blur } => edges(*window, blur, kind, by_place, vergence),
        }
    }

    /// The whitening of a point by what it is and by the derivative of its pixel by its place on the board (px per m). How far
    /// it is away, which blur depends on, follows from that as if it were on the axis.
    #[inline]
    pub fn whitening(&self, feature: &Feature, by_place: &Matrix2<f64>) -> Whitening {
        match self {
            Self::Constant => Whitening::NONE,
            Self::Edges { window, blur } => {
                // The direction that is seen square-on is magnified by f/z.
                let magnification = by_place.singular_values().max();
                edges(*window, blur, &feature.into(), &rows(by_place), magnification / blur.focal_length)
            }
        }
    }

    /// The same where the pictures are of another camera.
    #[must_use]
    pub fn through(self, camera: &Camera) -> Self {
        match self {
            Self::Constant => self,
            Self::Edges { window, blur } => Self::Edges { window, blur: blur.through(camera) },
        }
    }

    /// Which it is.
    pub fn name(&self) -> NoiseName {
        match self {
            Self::Constant => NoiseName::Constant,
            Self::Edges { .. } => NoiseName::Edges,
        }
    }
}

impl NoiseName {
    /// Every model.
    pub const ALL: [Self; 2] = [Self::Constant, Self::Edges];

    /// Name as written in problem files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Edges => "edges",
        }
    }
}

impl From<&Feature> for Kind<f64> {
    #[inline(always)]
    fn from(feature: &Feature) -> Self {
        match *feature {
            Feature::Corner { edges, is_crossing } => {
                Self::Corner { edges: edges.map(Into::into), sides: if is_crossing { 2.0 } else { 1.0 } }
            }
            Feature::Circle { radius } => Self::Circle { radius },
            Feature::Point => Self::Point,
        }
    }
}

impl<const L: usize> Kind<Lanes<L>> {
    /// Of several; none if they are not of one kind.
    #[inline(always)]
    pub(super) fn of_all(features: [&Feature; L]) -> Option<Self> {
        let (mut edges, mut sides, mut radius) = ([[Lanes::ZERO; 2]; 2], Lanes::ZERO, Lanes::ZERO);
        let [mut corners, mut circles] = [0; 2];
        for (lane, feature) in features.into_iter().enumerate() {
            match feature.into() {
                Kind::Corner { edges: own, sides: own_sides } => {
                    corners += 1;
                    sides.0[lane] = own_sides;
                    for (d, along) in own.into_iter().enumerate() {
                        [edges[d][0].0[lane], edges[d][1].0[lane]] = along;
                    }
                }
                Kind::Circle { radius: own } => {
                    circles += 1;
                    radius.0[lane] = own;
                }
                Kind::Point => {}
            }
        }
        match (corners, circles) {
            (0, 0) => Some(Self::Point),
            (corners, 0) if corners == L => Some(Self::Corner { edges, sides }),
            (0, circles) if circles == L => Some(Self::Circle { radius }),
            _ => None,
        }
    }
}

/// The rows of a matrix.
fn rows(matrix: &Matrix2<f64>) -> [[f64; 2]; 2] {
    [[matrix.m11, matrix.m12], [matrix.m21, matrix.m22]]
}

#[inline(always)]
fn edges<N: Number>(window: f64, blur: &Blur, kind: &Kind<N>, by_place: &[[N; 2]; 2], vergence: N) -> Whitening<N> {
    let T = match kind {
        Kind::Point => return Whitening::none(),
        Kind::Corner { edges, sides } => {
            let in_picture = edges.map(|edge| times(by_place, edge));
            let T = of_corner(window, &in_picture, *sides);
            if blur.is_sharp() {
                T
            } else {
                let reach = sine(&in_picture).map(|sine| window * sine.max(LEAST_SHARE));
                let left = vergence.zip(reach, |vergence, reach| blur.corner(vergence, reach));
                T.map(|entry| entry * left)
            }
        }
        Kind::Circle { radius } => {
            let left = vergence.map(|vergence| blur.edge(vergence));
            of_circle(*radius, by_place).map(|entry| entry * left)
        }
    };
    let [xx, xy, yy] = T.map(|entry| entry / N::all(2.0 * window));
    let least = N::all(LEAST_SHARE);
    Whitening::of([xx + least, xy, yy + least])
}

/// The product with a matrix of those rows.
#[inline(always)]
fn times<N: Number>(rows: &[[N; 2]; 2], [x, y]: [N; 2]) -> [N; 2] {
    rows.map(|[a, b]| a * x + b * y)
}

#[inline(always)]
fn norm<N: Number>([x, y]: [N; 2]) -> N {
    (x * x + y * y).sqrt()
}

/// Sine of the angle at which two edges meet; 0 where one has no length.
#[inline(always)]
fn sine<N: Number>([a, b]: &[[N; 2]; 2]) -> N {
    let perpendicular = a[0] * b[1] - a[1] * b[0];
    let lengths = norm(*a) * norm(*b);
    perpendicular.zip(lengths, |perpendicular, lengths| if lengths > 0.0 { perpendicular.abs() / lengths } else { 0.0 })
}

/// T of a corner, px, its entries xx, xy and yy: of its edges in the picture, px, the part that is in the window and not beyond the
/// next corner.
#[inline(always)]
fn of_corner<N: Number>(window: f64, edges: &[[N; 2]; 2], sides: N) -> [N; 3] {
    let [a, b] = edges.map(|[x, y]| {
        // The window is a square.
        let longest = x.zip(y, |x, y| x.abs().max(y.abs()));
        let share = longest.map(|longest| (window / longest).min(1.0));
        let factor =
            (sides * share / norm([x, y])).zip(longest, |factor, longest| if longest == 0.0 { 0.0 } else { factor });
        outer([-y, x]).map(|entry| entry * factor)
    });
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// T of the centre of a circle, px, its entries xx, xy and yy.
#[inline(always)]
fn of_circle<N: Number>(radius: N, by_place: &[[N; 2]; 2]) -> [N; 3] {
    let step = TAU / f64::from(EDGE_POINTS);
    let mut T = [N::all(0.0); 3];
    for i in 0..EDGE_POINTS {
        let (sin, cos) = (step * f64::from(i)).sin_cos();
        let [x, y] = times(by_place, [-sin, cos].map(N::all)).map(|entry| entry * radius);
        let length = norm([x, y]);
        for (sum, entry) in T.iter_mut().zip(outer([-y, x])) {
            *sum = *sum + entry / length * step;
        }
    }
    T
}

/// `v vᵀ`, its entries xx, xy and yy.
#[inline(always)]
fn outer<N: Number>([x, y]: [N; 2]) -> [N; 3] {
    [x * x, x * y, y * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGES: NoiseModel = NoiseModel::Edges { window: 5.0, blur: Blur::NONE };

    fn corner(is_crossing: bool) -> Feature {
        Feature::Corner { edges: [Vector2::new(0.03, 0.0), Vector2::new(0.0, 0.03)], is_crossing }
    }

    /// Σ / σ² of a crossing whose edges in the picture are `a` and `b`, in px.
    fn covariance(a: [f64; 2], b: [f64; 2]) -> Matrix2<f64> {
        let by_place = Matrix2::from_columns(&[a.into(), b.into()]) / 0.03;
        EDGES.whitening(&corner(true), &by_place).covariance()
    }

    fn assert_near(found: &Matrix2<f64>, expected: [[f64; 2]; 2]) {
        let expected = Matrix2::new(expected[0][0], expected[0][1], expected[1][0], expected[1][1]);
        assert!((found - expected).abs().max() < 1e-5 * expected.abs().max(), "{found} {expected}");
    }

    #[test]
    fn a_large_corner_seen_square_on_has_the_noise_stated() {
        assert_near(&covariance([30.0, 0.0], [0.0, 30.0]), [[1.0, 0.0], [0.0, 1.0]]);
        // Turned by 45°, the window's diagonals are √2 as long.
        assert_near(&covariance([30.0, 30.0], [-30.0, 30.0]), [[0.5f64.sqrt(), 0.0], [0.0, 0.5f64.sqrt()]]);
    }

    #[test]
    fn small_squares_show_less_of_their_edges() {
        // Of the window's 5 px 4 are seen on each side; along the longer edge, which tells of y, all.
        assert_near(&covariance([4.0, 0.0], [0.0, 4.0]), [[1.25, 0.0], [0.0, 1.25]]);
        assert_near(&covariance([30.0, 0.0], [0.0, 4.0]), [[1.25, 0.0], [0.0, 1.0]]);
    }

    #[test]
    fn edges_that_meet_at_a_sharp_angle_leave_the_place_along_them_open() {
        // At ±30° to the x axis, both seen over 2 · 5 / cos 30°: T = 2w / cos 30° · diag(2 sin² 30°, 2 cos² 30°).
        let (c, s) = (30f64.to_radians().cos(), 30f64.to_radians().sin());
        let found = covariance([60.0 * c, 60.0 * s], [60.0 * c, -60.0 * s]);
        assert_near(&found, [[c / (2.0 * s * s), 0.0], [0.0, c / (2.0 * c * c)]]);
    }

    #[test]
    fn an_edge_that_ends_in_the_corner_tells_half_as_much() {
        let by_place = Matrix2::identity() * 1000.0;
        let ratio = EDGES.whitening(&corner(false), &by_place).covariance() / 2.0;
        assert_near(&ratio, [[1.0, 0.0], [0.0, 1.0]]);
    }

    #[test]
    fn a_circle_seen_at_an_angle_is_worse_known_along_its_long_axis() {
        let circle = Feature::Circle { radius: 0.01 };
        // Square-on, radius 20 px: T = π · 20 · 1, against 2 · 5.
        let round = EDGES.whitening(&circle, &(Matrix2::identity() * 2000.0)).covariance();
        assert_near(&round, [[10.0 / (20.0 * std::f64::consts::PI), 0.0], [0.0, 10.0 / (20.0 * std::f64::consts::PI)]]);
        let flat = EDGES.whitening(&circle, &Matrix2::new(2000.0, 0.0, 0.0, 500.0)).covariance();
        assert!(flat.m11 > 2.0 * flat.m22 && flat.m12.abs() < 1e-12, "{flat}");
    }

    #[test]
    fn edges_out_of_focus_scatter_more_and_the_most_where_they_meet_at_a_sharp_angle() {
        // A disc of 4 px widens the edges: see `blur`.
        let blur = Blur { focal_length: 1000.0, aperture: 0.002, focus: 2.0, ..Blur::NONE };
        let blurred = NoiseModel::Edges { window: 5.0, blur };
        let R = Matrix3::identity();
        let by_point = Matrix2x3::new(4000.0, 0.0, 0.0, 0.0, 4000.0, 0.0);
        let found = blurred.whitening_in_view(&corner(true), &by_point, &R, 4.0).covariance();
        assert_near(&found, [[1.0 / 0.292_165, 0.0], [0.0, 1.0 / 0.292_165]]);
        // On the axis the distance follows from the derivative by the place, however the board is tilted.
        let tilted = *nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::x_axis(), 1.1).matrix();
        let [in_view, on_board] = [
            blurred.whitening_in_view(&corner(true), &by_point, &tilted, 4.0),
            blurred.whitening(&corner(true), &(by_point * tilted.fixed_columns::<2>(0))),
        ];
        assert!((in_view.covariance() - on_board.covariance()).norm() < 1e-9);
        let loss = |feature: &Feature| {
            let by_place = by_point * tilted.fixed_columns::<2>(0);
            let [dim, clear] =
                [blurred, EDGES].map(|model| model.whitening(feature, &by_place).covariance().determinant());
            dim / clear
        };
        let sharp_angle =
            Feature::Corner { edges: [Vector2::new(0.03, 0.03), Vector2::new(-0.03, 0.03)], is_crossing: true };
        assert!(loss(&sharp_angle) > 1.2 * loss(&corner(true)));
        assert!((loss(&corner(true)) / loss(&corner(false)) - 1.0).abs() < 1e-3);
        assert!(loss(&corner(true)) > 1.2 * loss(&Feature::Circle { radius: 0.01 }));
        assert!((loss(&Feature::Circle { radius: 0.01 }) - 13.0 / 4.0).abs() < 1e-3);
    }

    #[test]
    fn whitening_and_colouring_are_inverse() {
        let by_place = Matrix2::new(900.0, 200.0, -150.0, 300.0);
        let whitening = EDGES.whitening(&corner(true), &by_place).weighted(1.7);
        let z = [0.3, -1.2];
        let back = whitening.whitened(whitening.coloured(z).into());
        assert!((back[0] - z[0]).abs() < 1e-14 && (back[1] - z[1]).abs() < 1e-14);
        let W = Matrix2::from_columns(&[whitening.whitened([1.0, 0.0]).into(), whitening.whitened([0.0, 1.0]).into()]);
        assert!((whitening.covariance() * W.transpose() * W - Matrix2::identity()).norm() < 1e-12);
    }

    #[test]
    fn an_edge_on_board_has_finite_noise() {
        let by_place = Matrix2::new(900.0, 0.0, 0.0, 1e-9);
        assert!(EDGES.whitening(&corner(true), &by_place).covariance().iter().all(|entry| entry.is_finite()));
        let nothing = Matrix2::new(900.0, 0.0, 0.0, 0.0);
        assert!(EDGES.whitening(&corner(true), &nothing).covariance().iter().all(|entry| entry.is_finite()));
    }
}
