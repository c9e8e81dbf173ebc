//! The score of a box: an upper bound of `⟨Y, M(q)⟩` as a Taylor model.
//!
//! ```text
//!     ⟨Y, M(q)⟩ ≤ g(q) = Σ_j tr Lᵀ (A_j − B_j K)ᵀ S_j (A_j − B_j K) L        Y = L Lᵀ, S_j = σ² Σ_j⁻¹
//! ```
//!
//! for any K, here affine in q: the minimiser K̂ at the centre of the box, and its slopes there.

use nalgebra::{DMatrix, Matrix6, Point3, SMatrix, Vector2, Vector6};

use super::frustum::Frustum;
use super::image::{self, Image};
use super::quadratic::Quadratic;
use super::taylor::{Affine, Products, Taylor, residual_squares};
use super::twist::{Kinematics, Moved, direction, point};
use super::{LANES, Lanes};
use crate::camera::Camera;
use crate::information::{Blur, LEAST_SHARE, Measurement, NoiseModel};
use crate::lanes::Number;
use crate::target::Feature;

/// Corners that are looked at together.
#[derive(Debug, Clone)]
pub(super) struct Group {
    indices: [usize; LANES],
    /// In T; those that only fill the group up have no index of their own.
    points: [Point3<f64>; LANES],
    count: usize,
}

/// A corner may have an image of which nothing is bounded: the box is too large.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TooLarge;

/// What a box comes to.
pub(super) enum Outcome<const N: usize, const Q: usize> {
    /// No view has its joint values there.
    Empty,
    /// Nothing can be said of one so large.
    TooLarge,
    /// What it is.
    Score(Box<Scores<N, Q>>),
}

/// A bound of the score, and where it is needed.
pub(super) struct Scores<const N: usize, const Q: usize> {
    /// The score is no greater.
    pub(super) score: Quadratic<N, Q>,
    /// How far inside each of the picture's four sides the corner is that is the nearest to it; of a view none is negative. None
    /// where not every corner must be in the picture.
    pub(super) inside: Vec<Quadratic<N, Q>>,
}

/// The rows of four corners.
struct Rows<const N: usize, const Q: usize, const C: usize> {
    /// A L, a column after the other.
    A: Vec<[Taylor<N, Q, C>; 2]>,
    B: Box<[[Taylor<N, Q, C>; 6]; 2]>,
    /// S: xx, xy, yy.
    S: [Taylor<N, Q, C>; 3],
}

/// The corners, four by four.
pub(super) fn groups(corners: &[Point3<f64>]) -> Vec<Group> {
    let group = |first: usize| {
        let indices: [usize; LANES] = std::array::from_fn(|lane| (first + lane).min(corners.len() - 1));
        Group { indices, points: indices.map(|i| corners[i]), count: LANES.min(corners.len() - first) }
    };
    (0..corners.len()).step_by(LANES).map(group).collect()
}

/// How a view counts corners that are not in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Counting {
    /// Least distance of corners from the picture's border, px.
    pub(super) margin: f64,
    /// Whether every corner must be in the picture.
    pub(super) all: bool,
    /// Fewest corners that make a view.
    pub(super) least: usize,
}

pub(super) fn packed<const N: usize, const Q: usize, const C: usize>(
    moved: &[Moved<N, Q, C>; LANES],
) -> [Taylor<N, Q, C>; 3] {
    std::array::from_fn(|row| {
        let lanes = |of: &dyn Fn(&Moved<N, Q, C>) -> f64| Lanes::of(std::array::from_fn(|lane| of(&moved[lane])));
        Taylor::new(
            lanes(&|moved| moved.c[row]),
            std::array::from_fn(|a| lanes(&|moved| moved.l[a][row])),
            std::array::from_fn(|k| lanes(&|moved| moved.q[k][row])),
            std::array::from_fn(|k| lanes(&|moved| moved.t[k][row])),
            lanes(&|moved| moved.r),
        )
    })
}

/// `g` over the box that the kinematics are of.
pub(super) fn score<const N: usize, const Q: usize, const C: usize>(
    measurement: &Measurement,
    groups: &[Group],
    counting: Counting,
    frustum: Option<&Frustum>,
    root: &DMatrix<f64>,
    kinematics: &Kinematics,
) -> Outcome<N, Q> {
    let rotation = kinematics.X_CT.rotation.to_rotation_matrix();
    let columns = rotation.matrix().column_iter();
    let axes: Vec<[Taylor<N, Q, C>; 3]> =
        columns.map(|axis| packed(&[direction(&kinematics.of_board, &axis.into_owned()); LANES])).collect();
    let mut rows = Vec::with_capacity(groups.len());
    let mut inside = [(f64::INFINITY, None); 4];
    let mut seen = 0;
    for group in groups {
        let points = packed(&group.points.map(|p| point(&kinematics.of_board, &(kinematics.X_CT * p))));
        let camera = measurement.unknowns.camera;
        let image = image::image(camera, &points);
        let is_hidden = frustum.map_or([false; LANES], |frustum| frustum.excludes(&points));
        let mut counts: [bool; LANES] = std::array::from_fn(|lane| lane < group.count);
        for lane in 0..group.count {
            let is_outside = image.exists[lane] && is_outside(&image, lane, measurement, counting.margin);
            if is_hidden[lane] || image.is_behind[lane] || is_outside {
                if counting.all {
                    return Outcome::Empty;
                }
                counts[lane] = false;
            } else if !image.exists[lane] {
                return Outcome::TooLarge;
            }
        }
        if counting.all {
            let depths = depths(&image, camera, counting.margin);
            for (nearest, depth) in inside.iter_mut().zip(&depths) {
                for lane in 0..group.count {
                    if depth.least().0[lane] < nearest.0 {
                        *nearest = (depth.least().0[lane], Some(Quadratic::of(depth, lane)));
                    }
                }
            }
        }
        seen += counts.iter().filter(|&&counts| counts).count();
        let Some(first) = counts.iter().position(|&counts| counts) else { continue };
        let rows_of_group = if image.exists == [true; LANES] {
            rows_of(measurement, group, counts, root, kinematics, &axes, &points, &image)
        } else {
            // What is left out may have no image: one that counts stands in for it.
            let indices = std::array::from_fn(|lane| group.indices[if counts[lane] { lane } else { first }]);
            let group = Group { indices, points: indices.map(|i| measurement.corners[i]), ..*group };
            let points = packed(&group.points.map(|p| point(&kinematics.of_board, &(kinematics.X_CT * p))));
            let image = image::image(camera, &points);
            rows_of(measurement, &group, counts, root, kinematics, &axes, &points, &image)
        };
        match rows_of_group {
            Ok(of_group) => rows.push(of_group),
            Err(TooLarge) => return Outcome::TooLarge,
        }
    }
    if seen < counting.least {
        return Outcome::Empty;
    }
    let Some(K) = elimination(&rows, root.ncols()) else { return Outcome::TooLarge };
    let mut sum = Taylor::constant(0.0);
    for Rows { A, B, S } in &rows {
        let [xx, xy, yy] = residual_squares(A, B, &K).map(|squares| squares.sum());
        let mut weighted = Products::NONE;
        weighted.add(&S[0], &xx);
        weighted.add(&S[1], &xy.scaled(2.0));
        weighted.add(&S[2], &yy);
        sum = &sum + &weighted.sum();
    }
    let score = Quadratic::of(&sum.over_lanes().scaled(measurement.scale()), 0);
    Outcome::Score(Box::new(Scores { score, inside: inside.into_iter().filter_map(|(_, inside)| inside).collect() }))
}

/// How far inside the picture's four sides a corner is, px.
fn depths<const N: usize, const Q: usize, const C: usize>(
    image: &Image<N, Q, C>,
    camera: &Camera,
    margin: f64,
) -> [Taylor<N, Q, C>; 4] {
    let [u, v] = &image.pixel;
    let most = |size: u32| f64::from(size) - 1.0 - margin;
    [u.plus(-margin), (-u).plus(most(camera.width())), v.plus(-margin), (-v).plus(most(camera.height()))]
}

/// Whether the corner is nowhere in the picture.
fn is_outside<const N: usize, const Q: usize, const C: usize>(
    image: &Image<N, Q, C>,
    lane: usize,
    measurement: &Measurement,
    margin: f64,
) -> bool {
    let camera = measurement.unknowns.camera;
    image.pixel.iter().zip([camera.width(), camera.height()]).any(|(pixel, size)| {
        pixel.greatest().0[lane] < margin || pixel.least().0[lane] > f64::from(size) - 1.0 - margin
    })
}

#[expect(clippy::too_many_arguments, reason = "what the rows depend on")]
fn rows_of<const N: usize, const Q: usize, const C: usize>(
    measurement: &Measurement,
    group: &Group,
    counts: [bool; LANES],
    root: &DMatrix<f64>,
    kinematics: &Kinematics,
    axes: &[[Taylor<N, Q, C>; 3]],
    points: &[Taylor<N, Q, C>; 3],
    image: &Image<N, Q, C>,
) -> Result<Rows<N, Q, C>, TooLarge> {
    let arms = packed(&group.points.map(|p| direction(&kinematics.of_board, &(kinematics.X_CT.rotation * p.coords))));
    let P = &image.by_point;
    let B = [0, 1].map(|row| {
        let P = &P[row];
        // −Pᵀ[arm]× is arm × P.
        let across = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &(&arms[i] * &P[j]) - &(&arms[j] * &P[i]));
        let [a, b, c] = across;
        [a, b, c, P[0], P[1], P[2]]
    });
    let along = |axis: &[Taylor<N, Q, C>; 3]| {
        [0, 1].map(|row| &(&(&P[row][0] * &axis[0]) + &(&P[row][1] * &axis[1])) + &(&P[row][2] * &axis[2]))
    };
    let S = precision(measurement, group, counts, &along, axes, points)?;
    let zero = Taylor::constant(0.0);
    let S = if counts == [true; LANES] { S } else { S.map(|entry| entry.or(&zero, counts)) };
    let rise = measurement.warp.map(|warp| {
        let up = along(&axes[2]);
        let rises = group.points.map(|p| warp.rises(&p.coords.xy()));
        [0, 1].map(|height| {
            let rises = Lanes::of(rises.map(|rises| rises[height]));
            [up[0].scaled_by(rises), up[1].scaled_by(rises)]
        })
    });
    let nuisance = measurement.nuisance();
    let A = root.column_iter().map(|column| {
        [0, 1].map(|row| {
            let heights = rise.iter().flatten().enumerate().map(|(i, rise)| (column[i], &rise[row]));
            let estimated = measurement.unknowns.estimated.iter().enumerate();
            let intrinsics = estimated.filter_map(|(j, &parameter)| {
                Some((column[nuisance + j], image.by_intrinsics[row][parameter].as_deref()?))
            });
            Taylor::sum(heights.chain(intrinsics))
        })
    });
    Ok(Rows { A: A.collect(), B: Box::new(B), S })
}

/// `σ² Σ⁻¹` of the corners: see [`NoiseModel`].
fn precision<const N: usize, const Q: usize, const C: usize>(
    measurement: &Measurement,
    group: &Group,
    counts: [bool; LANES],
    along: &dyn Fn(&[Taylor<N, Q, C>; 3]) -> [Taylor<N, Q, C>; 2],
    axes: &[[Taylor<N, Q, C>; 3]],
    points: &[Taylor<N, Q, C>; 3],
) -> Result<[Taylor<N, Q, C>; 3], TooLarge> {
    let (zero, one) = (Taylor::constant(0.0), Taylor::constant(1.0));
    let NoiseModel::Edges { window, blur } = &measurement.noise.model else { return Ok([one, zero, one]) };
    let features = group.indices.map(|i| &measurement.features[i]);
    // A board's points are of one kind.
    if matches!(features[0], Feature::Point) {
        return Ok([one, zero, one]);
    }
    let by_place = [along(&axes[0]), along(&axes[1])];
    let edge = |places: [Vector2<f64>; LANES]| {
        let [x, y] = [0, 1].map(|i| Lanes::of(places.map(|place| place[i])));
        [0, 1].map(|row| &by_place[0][row].scaled_by(x) + &by_place[1][row].scaled_by(y))
    };
    let vergence = vergence(measurement, points);
    let (T, left) = match features[0] {
        Feature::Point => return Ok([one, zero, one]),
        Feature::Corner { .. } => {
            let edges = [0, 1].map(|d| {
                edge(features.map(|feature| match feature {
                    Feature::Corner { edges, .. } => edges[d],
                    _ => Vector2::zeros(),
                }))
            });
            let sides = Lanes::of(features.map(|feature| match feature {
                Feature::Corner { is_crossing: true, .. } => 1.0,
                _ => 0.5,
            }));
            let mut T = [zero; 3];
            for edge in &edges {
                let seen = seen_edge(edge, *window, counts)?;
                T = std::array::from_fn(|i| &T[i] + &seen[i].scaled_by(sides));
            }
            let sine = greatest_sine(&edges);
            let left = std::array::from_fn(|lane| {
                let reach = window * sine.0[lane].max(LEAST_SHARE);
                if *blur == Blur::NONE { 1.0 } else { blur.corner(sharpest(blur, vergence[lane]), reach) }
            });
            (T, left)
        }
        Feature::Circle { radius } => {
            let left =
                std::array::from_fn(
                    |lane| if *blur == Blur::NONE { 1.0 } else { blur.edge(sharpest(blur, vergence[lane])) },
                );
            (circle(*radius, *window, &edge, counts)?, left)
        }
    };
    let T = T.map(|entry| entry.scaled_by(Lanes::of(left)));
    Ok([T[0].plus(LEAST_SHARE), T[1], T[2].plus(LEAST_SHARE)])
}

/// T / 2w of an edge on both sides of a corner, `e⊥e⊥ᵀ/|e| · min(w/|e_x|, w/|e_y|, 1) / w`: instead of the least of the three that
/// which is the least at the centre of the box, an upper bound beside it.
fn seen_edge<const N: usize, const Q: usize, const C: usize>(
    e: &[Taylor<N, Q, C>; 2],
    window: f64,
    counts: [bool; LANES],
) -> Result<[Taylor<N, Q, C>; 3], TooLarge> {
    let [x, y] = e;
    let is_flat = std::array::from_fn(|lane| x.c.0[lane].abs() >= y.c.0[lane].abs());
    let (longer, shorter) = (x.or(y, is_flat), y.or(x, is_flat));
    let is_cut: [bool; LANES] = longer.c.0.map(|longer| longer.abs() >= window);
    let mut T = [Taylor::constant(0.0); 3];
    if is_cut.contains(&true) {
        // With the slope m: [m², −m; −m, 1] / √(1 + m²), or the other way round.
        let (inverse, exists) = longer.recip();
        if (0..LANES).any(|lane| counts[lane] && is_cut[lane] && !exists[lane]) {
            return Err(TooLarge);
        }
        let m = &shorter * &inverse;
        let square = m.squared();
        let (f, _) = square.plus(1.0).recip_sqrt();
        let square = &square * &f;
        T = [square.or(&f, is_flat), -&(&m * &f), f.or(&square, is_flat)];
    }
    if (0..LANES).any(|lane| counts[lane] && !is_cut[lane]) {
        let (inverse, exists) = (&x.squared() + &y.squared()).recip_sqrt();
        if (0..LANES).any(|lane| counts[lane] && !is_cut[lane] && !exists[lane]) {
            return Err(TooLarge);
        }
        let inverse = inverse.scaled(window.recip());
        let (along_x, along_y) = (x * &inverse, y * &inverse);
        let whole = [y * &along_y, -&(x * &along_y), x * &along_x];
        T = std::array::from_fn(|i| T[i].or(&whole[i], is_cut));
    }
    Ok(T)
}

/// T / 2w of the centre of a circle.
fn circle<const N: usize, const Q: usize, const C: usize>(
    radius: f64,
    window: f64,
    edge: &dyn Fn([Vector2<f64>; LANES]) -> [Taylor<N, Q, C>; 2],
    counts: [bool; LANES],
) -> Result<[Taylor<N, Q, C>; 3], TooLarge> {
    // Opposite points tell the same.
    let points = crate::information::EDGE_POINTS;
    let half = points / 2;
    let step = std::f64::consts::TAU / f64::from(points);
    let mut T = [Taylor::constant(0.0); 3];
    for i in 0..half {
        let φ = step * f64::from(i);
        let [x, y] = edge([Vector2::new(-φ.sin(), φ.cos()) * radius; LANES]);
        let (inverse, exists) = (&x.squared() + &y.squared()).recip_sqrt();
        if (0..LANES).any(|lane| counts[lane] && !exists[lane]) {
            return Err(TooLarge);
        }
        let inverse = inverse.scaled(step / window);
        let (along_x, along_y) = (&x * &inverse, &y * &inverse);
        let seen = [&y * &along_y, -&(&x * &along_y), &x * &along_x];
        T = std::array::from_fn(|i| &T[i] + &seen[i]);
    }
    Ok(T)
}

/// Sine of the angle at which two edges meet, at most.
fn greatest_sine<const N: usize, const Q: usize, const C: usize>([a, b]: &[[Taylor<N, Q, C>; 2]; 2]) -> Lanes {
    let area = &(&a[0] * &b[1]) - &(&a[1] * &b[0]);
    let area = area.greatest().zip(-area.least(), f64::max);
    let squared = |e: &[Taylor<N, Q, C>; 2]| (&e[0].squared() + &e[1].squared()).least();
    let lengths = squared(a).zip(squared(b), |a, b| (a.max(0.0) * b.max(0.0)).sqrt());
    area.zip(lengths, |area, lengths| (area / lengths * (1.0 + 1e-12)).min(1.0))
}

/// Between which vergences the corners are.
fn vergence<const N: usize, const Q: usize, const C: usize>(
    measurement: &Measurement,
    p: &[Taylor<N, Q, C>; 3],
) -> [[f64; 2]; LANES] {
    let [near, far] = if measurement.unknowns.camera.lens().is_fisheye() {
        let square = &(&p[0].squared() + &p[1].squared()) + &p[2].squared();
        [square.least(), square.greatest()].map(|square| square.map(|square| square.max(0.0).sqrt()))
    } else {
        [p[2].least(), p[2].greatest()]
    };
    let outward = 1.0 + 1e-12;
    std::array::from_fn(|lane| [far.0[lane].max(0.0).recip() / outward, near.0[lane].max(0.0).recip() * outward])
}

/// The vergence of a range at which the picture is the sharpest.
fn sharpest(blur: &Blur, [least, most]: [f64; 2]) -> f64 {
    let (disc, path) = (blur.aperture * blur.aperture / 16.0, blur.moving * blur.moving / 24.0);
    let best = if disc + path > 0.0 { disc * blur.focus / (disc + path) } else { least };
    best.clamp(least, most)
}

/// K̂ and its slopes, a column for each of L; `None` if the corners do not determine the pose.
fn elimination<const N: usize, const Q: usize, const C: usize>(
    rows: &[Rows<N, Q, C>],
    columns: usize,
) -> Option<Vec<[Affine<N>; 6]>> {
    let mut normal = Matrix6::zeros();
    let mut right = vec![Vector6::zeros(); columns];
    for Rows { A, B, S } in rows {
        for lane in 0..LANES {
            let B = SMatrix::<f64, 2, 6>::from_fn(|row, i| B[row][i].c.0[lane]);
            let S = symmetric(S.each_ref().map(|entry| entry.c.0[lane]));
            let weighted = B.transpose() * S;
            if S.m11 == 0.0 && S.m22 == 0.0 {
                continue;
            }
            normal += weighted * B;
            for (right, A) in right.iter_mut().zip(A) {
                *right += weighted * Vector2::new(A[0].c.0[lane], A[1].c.0[lane]);
            }
        }
    }
    let factor = normal.cholesky()?;
    let K: Vec<Vector6<f64>> = right.iter().map(|right| factor.solve(right)).collect();
    let mut slopes = vec![[Vector6::zeros(); N]; columns];
    for Rows { A, B, S } in rows {
        for lane in 0..LANES {
            let S0 = symmetric(S.each_ref().map(|entry| entry.c.0[lane]));
            if S0.m11 == 0.0 && S0.m22 == 0.0 {
                continue;
            }
            let B0 = SMatrix::<f64, 2, 6>::from_fn(|row, i| B[row][i].c.0[lane]);
            let weighted = B0.transpose() * S0;
            for a in 0..N {
                let B1 = SMatrix::<f64, 2, 6>::from_fn(|row, i| B[row][i].l[a].0[lane]);
                let S1 = symmetric(S.each_ref().map(|entry| entry.l[a].0[lane]));
                let of_residual = B1.transpose() * S0 + B0.transpose() * S1;
                for ((slopes, A), K) in slopes.iter_mut().zip(A).zip(&K) {
                    let A0 = Vector2::new(A[0].c.0[lane], A[1].c.0[lane]);
                    let A1 = Vector2::new(A[0].l[a].0[lane], A[1].l[a].0[lane]);
                    slopes[a] += of_residual * (A0 - B0 * K) + weighted * (A1 - B1 * K);
                }
            }
        }
    }
    let affine = |(K, slopes): (&Vector6<f64>, &[Vector6<f64>; N])| {
        let slopes = slopes.map(|slope| factor.solve(&slope));
        std::array::from_fn(|i| Affine { c: K[i], l: slopes.map(|slope| slope[i]) })
    };
    Some(K.iter().zip(&slopes).map(affine).collect())
}

fn symmetric([xx, xy, yy]: [f64; 3]) -> nalgebra::Matrix2<f64> {
    nalgebra::Matrix2::new(xx, xy, xy, yy)
}
