//! What the camera sees from a pose.

use nalgebra::{Point2, Point3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::camera::Camera;
use crate::feasibility::{View, convex_hull};
use crate::target::{Board, Corners};

/// The board in the picture, px; pixel (0, 0) is the centre of the top-left pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Picture {
    /// Every corner, row by row; `null` where the lens shows none.
    pub corners_px: Vec<Option<[f64; 2]>>,
    /// Numbers of the corners that do not count: outside of the picture, or hidden.
    pub unseen: Vec<usize>,
    /// Those of them that a body hides.
    pub hidden: Vec<usize>,
    /// The border of what is printed, as the lens bends it.
    pub border_px: Vec<[f64; 2]>,
    /// The outlines of all that is black.
    pub pattern_px: Vec<Vec<[f64; 2]>>,
    /// Share of the picture that the corners seen span.
    pub image_share: f64,
    /// Distance of the corners seen from the picture's nearest side.
    pub margin_px: f64,
    /// The bodies in the picture, the farthest first.
    pub bodies: Vec<Silhouette>,
}

/// A body in a picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Silhouette {
    /// Its link, by its number in the review.
    pub link: usize,
    /// Whether it is between the camera and the board's plane.
    pub before_board: bool,
    /// Its outline, which may reach beyond the picture.
    pub outline_px: Vec<[f64; 2]>,
}

impl Picture {
    /// `margin` (px) is how far corners must be from the picture's sides; `pattern` has the black outlines on the board, m.
    pub(crate) fn new(
        camera: &Camera,
        board: &Board,
        pattern: &[Vec<[f64; 2]>],
        margin: f64,
        view: &View,
        bodies: Vec<Silhouette>,
    ) -> Self {
        let project = |point| camera.project(&(view.X_CT * point)).map(<[f64; 2]>::from);
        let corners_px: Vec<_> = board.corners().map(project).collect();
        let seen = |i: usize| view.seen.contains(i);
        let on_board = |&[x, y]: &[f64; 2]| project([x, y, 0.0].into());
        let outline = |points: &Vec<[f64; 2]>| points.iter().map(on_board).collect::<Option<Vec<_>>>();
        let (width, height) = (f64::from(camera.width()), f64::from(camera.height()));
        let to_side = |&[u, v]: &[f64; 2]| u.min(v).min(width - 1.0 - u).min(height - 1.0 - v);
        let counted =
            || corners_px.iter().enumerate().filter(|&(i, _)| seen(i)).filter_map(|(_, corner)| corner.as_ref());
        let unseen: Vec<usize> = (0..corners_px.len()).filter(|&i| !seen(i)).collect();
        let inside = |i: &&usize| corners_px[**i].is_some_and(|corner| camera.contains(&corner.into(), margin));
        Self {
            hidden: unseen.iter().filter(inside).copied().collect(),
            unseen,
            border_px: border(board).iter().filter_map(on_board).collect(),
            pattern_px: pattern.iter().filter_map(outline).collect(),
            image_share: image_share(camera, board, view),
            margin_px: counted().map(to_side).fold(f64::INFINITY, f64::min),
            corners_px,
            bodies,
        }
    }
}

/// Area in px² of the quadrilateral of the outermost corners, a b c d around, of a view that sees all; 0 where the lens does not show
/// all four.
fn spanned(outermost: [Option<[f64; 2]>; 4]) -> f64 {
    let [Some(a), Some(b), Some(c), Some(d)] = outermost else { return 0.0 };
    area([a, b, c, d].into_iter())
}

/// Area of a polygon, px².
fn area(corners: impl ExactSizeIterator<Item = [f64; 2]> + Clone) -> f64 {
    let next = corners.clone().cycle().skip(1);
    0.5 * corners.zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>().abs()
}

/// Points around what is printed, m.
fn border(board: &Board) -> Vec<[f64; 2]> {
    /// Points of a side.
    const SIDE: usize = 9;
    let (width, height) = board.printed_size();
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, y)| [x * width, y * height]);
    let along = |side: usize, i: usize| {
        let ([ax, ay], [bx, by], share) = (corners[side], corners[(side + 1) % 4], i as f64 / SIDE as f64);
        [ax + share * (bx - ax), ay + share * (by - ay)]
    };
    (0..4 * SIDE).map(|i| along(i / SIDE, i % SIDE)).collect()
}

/// Share of the picture that the corners seen span.
pub(crate) fn image_share(camera: &Camera, board: &Board, view: &View) -> f64 {
    let project = |corner: &Point3<f64>| camera.project(&(view.X_CT * corner)).map(<[f64; 2]>::from);
    let area = match (&view.seen, board.grid()) {
        (Corners::All, Some((columns, rows, _))) => {
            let last = columns * rows - 1;
            spanned([0, columns - 1, last, last + 1 - columns].map(|i| project(&board.corner(i))))
        }
        (seen, _) => {
            let indices = seen.indices(board.corner_count());
            let seen = indices.iter().filter_map(|&i| project(&board.corner(i)));
            let hull = convex_hull(&seen.map(Point2::from).collect::<Vec<_>>());
            area(hull.iter().map(|corner| [corner.x, corner.y]))
        }
    };
    area / (f64::from(camera.width()) * f64::from(camera.height()))
}
