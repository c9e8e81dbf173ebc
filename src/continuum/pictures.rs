//! Boxes whose pictures of the board are certainly near a given one.

use nalgebra::Point3;

use super::quadratic::Quadratic;
use super::score::packed;
use super::taylor::Taylor;
use super::twist::{Kinematics, point};
use super::{LANES, Lanes};
use crate::camera::Camera;
use crate::feasibility::{half_focal, outer_corners};
use crate::target::Board;

/// All views whose [pictures](crate::feasibility::View::picture) are nearer than a radius to a centre, and what each of them scores less.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureBall {
    /// 12 numbers, px.
    pub centre: [f64; 12],
    /// Px.
    pub radius: f64,
    /// What a view in it scores less.
    pub price: f64,
}

impl PictureBall {
    /// Whether a picture is in it.
    pub fn contains(&self, picture: &[f64; 12]) -> bool {
        self.centre.iter().zip(picture).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() < self.radius * self.radius
    }

    /// What a view of this picture scores less, all balls together.
    pub fn price_of(balls: &[Self], picture: &[f64; 12]) -> f64 {
        balls.iter().filter(|ball| ball.contains(picture)).map(|ball| ball.price).sum()
    }
}

/// What is known of the balls that pictures of a box are in.
pub(super) struct Balls<const N: usize, const Q: usize> {
    /// The price of those that certainly hold them all.
    pub(super) certain: f64,
    /// Of those that may hold some: how far outside a picture is, square px, and the price.
    pub(super) possible: Vec<(Quadratic<N, Q>, f64)>,
}

impl<const N: usize, const Q: usize> Balls<N, Q> {
    pub(super) const NONE: Self = Self { certain: 0.0, possible: Vec::new() };

    pub(super) fn new<const C: usize>(
        balls: &[PictureBall],
        camera: &Camera,
        board: &Board,
        kinematics: &Kinematics,
    ) -> Self {
        let mut of_box = Self::NONE;
        if balls.is_empty() {
            return of_box;
        }
        // As pictures are: directions of the printed area's corners, times half the focal length.
        let half_focal = half_focal(camera);
        let corner = |p: Point3<f64>| point(&kinematics.of_board, &(kinematics.X_CT * p));
        let points = packed::<N, Q, C>(&outer_corners(board).map(corner));
        let square = &(&points[0].squared() + &points[1].squared()) + &points[2].squared();
        let (inverse, exists) = square.recip_sqrt();
        if exists != [true; LANES] {
            return of_box;
        }
        let directions = points.map(|p| (&p * &inverse).scaled(half_focal));
        for ball in balls {
            // |z − c|² = |z|² − 2 z·c + |c|², and the former is as long in every picture.
            let [x, y, z]: [Taylor<N, Q, C>; 3] = std::array::from_fn(|row| {
                let of_corner = Lanes::of(std::array::from_fn(|corner| -2.0 * ball.centre[3 * corner + row]));
                directions[row].scaled_by(of_corner)
            });
            let lengths = 4.0 * half_focal * half_focal + ball.centre.iter().map(|c| c * c).sum::<f64>();
            let outside = (&(&x + &y) + &z).over_lanes().plus(lengths).plus(-ball.radius * ball.radius);
            let outside = Quadratic::of(&outside, 0);
            if outside.greatest() < 0.0 {
                of_box.certain += ball.price;
            } else if outside.least() < 0.0 {
                of_box.possible.push((outside, ball.price));
            }
        }
        of_box
    }

    /// No score within the limits exceeds it, less the prices of the balls that it is in.
    pub(super) fn greatest(&self, score: &Quadratic<N, Q>, limits: &mut Vec<Quadratic<N, Q>>) -> f64 {
        let anywhere = score.greatest_within(limits);
        let Some(least) = self.possible.iter().map(|(_, price)| *price).reduce(f64::min) else {
            return anywhere - self.certain;
        };
        // A picture is in one of them at least, or outside all.
        limits.extend(self.possible.iter().map(|(outside, _)| *outside));
        (anywhere - least).max(score.greatest_within(limits).min(anywhere)) - self.certain
    }
}
