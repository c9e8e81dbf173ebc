//! The picture that a camera should give: the board, and the robot's bodies as grey solids.
//!
//! Every pixel takes the mean of the grey values that rays through it meet, so that edges are antialiased; the lens's blur, a gradient
//! of the light and the sensor's noise follow. It is a picture to hold a real one against, and to try detectors on, not a photograph:
//! the board is evenly lit and matt, and bodies are shaded by their direction alone.

mod bodies;

pub use bodies::{Bodies, PlacedBody};

use nalgebra::{Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use self::bodies::Hit;
use crate::camera::Camera;
use crate::feasibility::FLUSH;
use crate::print::Pattern;
use crate::spatial::Pose;

/// Grey values of the printed black, the paper, and what is behind.
const BLACK: f64 = 40.0;
const WHITE: f64 = 200.0;
const BEHIND: f64 = 110.0;

/// How pictures are rendered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderSettings {
    /// Rays along each side of a pixel that sees the board or the edge of a body. Default: 6.
    pub supersampling: u32,
    /// Standard deviation of the lens's blur in px. Default: 0.6.
    pub blur: f64,
    /// Change of the light from the picture's left to its right, as a share of it. Default: 0.1.
    pub gradient: f64,
    /// Standard deviation of the sensor's noise in grey values of 255. Default: 2.
    pub noise: f64,
    /// Seed of the noise. Default: 0.
    pub seed: u64,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self { supersampling: 6, blur: 0.6, gradient: 0.1, noise: 2.0, seed: 0 }
    }
}

/// A grey picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// Grey values, row by row from the top left.
    pub grey: Vec<u8>,
}

/// The picture that `camera` gives of `pattern` at `X_CT` and of `bodies`, which are given in the camera's frame. Directions beyond the lens are
/// black. The same settings give the same picture on any number of threads.
pub fn render(camera: &Camera, pattern: &Pattern, X_CT: &Pose, bodies: &Bodies, settings: &RenderSettings) -> Picture {
    let (width, height) = (camera.width() as usize, camera.height() as usize);
    let pixel = |i: usize| Vector2::new((i % width) as f64, (i / width) as f64);
    let ray = |i: usize| camera.unproject(&pixel(i)).map(nalgebra::Unit::into_inner);
    let rays: Vec<Option<Vector3<f64>>> = (0..width * height).into_par_iter().map(ray).collect();
    let hits = rays.par_iter().map(|ray| bodies.first(&(*ray)?)).collect();
    let offsets = offsets(settings.supersampling);
    let scene = Scene { rays, hits, width, pattern, X_TC: X_CT.inverse(), bodies, offsets };
    let mut grey: Vec<f64> = vec![0.0; width * height];
    grey.par_chunks_mut(width).enumerate().for_each(|(v, row)| scene.fill(v, row));
    let kernel = gauss(settings.blur);
    let mut grey = transposed(&blurred(&grey, width, &kernel), width);
    grey = transposed(&blurred(&grey, height, &kernel), height);
    let mut picture = vec![0; width * height];
    picture.par_chunks_mut(width).zip(grey.par_chunks(width)).enumerate().for_each(|(v, (pixels, grey))| {
        // A stream a row, whichever thread draws it.
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(settings.seed ^ (v as u64).rotate_left(32));
        for (u, (pixel, grey)) in pixels.iter_mut().zip(grey).enumerate() {
            let light = 1.0 + settings.gradient * (u as f64 / (width.max(2) - 1) as f64 - 0.5);
            let noise = settings.noise * rng.sample::<f64, _>(StandardNormal);
            *pixel = (grey * light + noise).round().clamp(0.0, 255.0) as u8;
        }
    });
    Picture { width: camera.width(), height: camera.height(), grey: picture }
}

/// What the camera sees.
struct Scene<'a> {
    /// The directions that the pixels show, of unit length, row by row; none beyond the lens.
    rays: Vec<Option<Vector3<f64>>>,
    /// The bodies that they meet.
    hits: Vec<Option<Hit>>,
    width: usize,
    pattern: &'a Pattern,
    X_TC: Pose,
    bodies: &'a Bodies,
    /// Of the rays through a pixel from its centre, px.
    offsets: Vec<Vector2<f64>>,
}

impl Scene<'_> {
    /// The grey values of row `v`, without blur and noise.
    fn fill(&self, v: usize, row: &mut [f64]) {
        for (u, grey) in row.iter_mut().enumerate() {
            let at = v * self.width + u;
            let Some(ray) = self.rays[at] else { continue };
            // Between pixels a ray changes as from one to the next.
            let beside = [(u > 0).then(|| at - 1), (u + 1 < self.width).then_some(at + 1)];
            let above = [at.checked_sub(self.width), Some(at + self.width).filter(|&i| i < self.rays.len())];
            let (along_u, along_v) = (self.slope(beside, at), self.slope(above, at));
            let through = |offset: &Vector2<f64>| ray + along_u * offset.x + along_v * offset.y;
            let mut neighbours = [beside, above].into_iter().flatten().flatten().filter(|&i| self.rays[i].is_some());
            let is_edge = neighbours.any(|i| Hit::is_edge(self.hits[at], self.hits[i]));
            let grey_of = |offset: &Vector2<f64>| {
                let ray = through(offset);
                self.grey(&ray, if is_edge { self.bodies.first(&ray.normalize()) } else { self.hits[at] })
            };
            *grey = if is_edge || CORNERS.iter().any(|offset| self.on_board(&through(offset)).is_some()) {
                self.offsets.iter().map(grey_of).sum::<f64>() / self.offsets.len() as f64
            } else {
                self.hits[at].map_or(BEHIND, |hit| hit.shade)
            };
        }
    }

    /// The grey value that a ray from the camera meets, with the body that it meets.
    fn grey(&self, ray: &Vector3<f64>, body: Option<Hit>) -> f64 {
        match (self.on_board(ray), body) {
            (Some(_), Some(hit)) if self.rises(ray, hit.depth) => hit.shade,
            (Some(true), _) => BLACK,
            (Some(false), _) => WHITE,
            (None, Some(hit)) => hit.shade,
            (None, None) => BEHIND,
        }
    }

    /// How the ray changes per pixel at `at` between its neighbours before and after.
    fn slope(&self, [before, after]: [Option<usize>; 2], at: usize) -> Vector3<f64> {
        let ray = |i: Option<usize>| i.and_then(|i| self.rays[i]);
        match (ray(before), self.rays[at], ray(after)) {
            (Some(before), _, Some(after)) => 0.5 * (after - before),
            (None, Some(here), Some(after)) => after - here,
            (Some(before), Some(here), None) => here - before,
            _ => Vector3::zeros(),
        }
    }

    /// Whether the board is black where a ray from the camera meets its printed side; `None` if it does not.
    fn on_board(&self, ray: &Vector3<f64>) -> Option<bool> {
        let (centre, direction) = (self.X_TC.translation.vector, self.X_TC.rotation * ray);
        let depth = -centre.z / direction.z;
        // From behind nothing printed is seen.
        if !(depth > 0.0 && centre.z > 0.0) {
            return None;
        }
        let at = centre + direction * depth;
        self.pattern.is_black(at.x, at.y)
    }

    /// Whether what a ray meets at `depth`, in m, is far enough above the board's plane to hide it; the plate that it is printed on
    /// is not.
    fn rises(&self, ray: &Vector3<f64>, depth: f64) -> bool {
        let direction = self.X_TC.rotation * ray.normalize();
        self.X_TC.translation.vector.z + direction.z * depth > FLUSH
    }
}

/// The middle of a pixel and its corners.
const CORNERS: [Vector2<f64>; 5] = [
    Vector2::new(0.0, 0.0),
    Vector2::new(-0.5, -0.5),
    Vector2::new(0.5, -0.5),
    Vector2::new(-0.5, 0.5),
    Vector2::new(0.5, 0.5),
];

/// Offsets of `side` x `side` rays, evenly over a pixel.
fn offsets(side: u32) -> Vec<Vector2<f64>> {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side) - 0.5;
    (0..side).flat_map(|j| (0..side).map(move |i| Vector2::new(at(i), at(j)))).collect()
}

/// The weights of a Gaussian of that standard deviation in px, from its middle outwards; they add up to 1 over both sides.
fn gauss(sigma: f64) -> Vec<f64> {
    let reach = (4.0 * sigma).ceil() as usize;
    let weight = |i: usize| if sigma > 0.0 { (-0.5 * (i as f64 / sigma).powi(2)).exp() } else { 1.0 };
    let weights: Vec<f64> = (0..=reach).map(weight).collect();
    let sum = 2.0 * weights.iter().sum::<f64>() - weights[0];
    weights.into_iter().map(|weight| weight / sum).collect()
}

/// Rows of `width` blurred along themselves; what is beyond an end is as the end.
fn blurred(grey: &[f64], width: usize, kernel: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; grey.len()];
    result.par_chunks_mut(width).zip(grey.par_chunks(width)).for_each(|(result, row)| {
        for (u, result) in result.iter_mut().enumerate() {
            let beside = kernel.iter().enumerate().skip(1);
            let sum = beside.map(|(i, weight)| weight * (row[u.saturating_sub(i)] + row[(u + i).min(width - 1)]));
            *result = kernel[0] * row[u] + sum.sum::<f64>();
        }
    });
    result
}

/// Columns as rows.
fn transposed(grey: &[f64], width: usize) -> Vec<f64> {
    let height = grey.len() / width;
    (0..grey.len()).map(|i| grey[(i % height) * width + i / height]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Lens;
    use crate::feasibility::Occlusion;
    use crate::print::Artwork;
    use crate::robot::{Body, Link, Motion, Shape, Tree};
    use crate::target::{Board, viewpoint};

    const BOARD: Board = Board::checkerboard(5, 4, 0.03);
    const CLEAN: RenderSettings = RenderSettings { supersampling: 8, blur: 0.6, gradient: 0.0, noise: 0.0, seed: 0 };

    fn camera() -> Camera {
        let θ = [400.0, 400.0, 159.5, 119.5, -0.2, 0.05, 0.0, 0.0, 0.0];
        Camera::new(Lens::BrownConrady, 320, 240, &θ).unwrap()
    }

    fn pattern() -> Pattern {
        Pattern::new(&Artwork::new(&BOARD).unwrap())
    }

    /// The corner near `near`: where the edges around it meet, to which all grey values' gradients are at right angles (as OpenCV's
    /// `cornerSubPix` has it).
    fn corner_near(picture: &Picture, near: &Vector2<f64>) -> Vector2<f64> {
        let at = |u: f64, v: f64| f64::from(picture.grey[v as usize * picture.width as usize + u as usize]);
        let mut T = nalgebra::Matrix2::zeros();
        let mut b = Vector2::zeros();
        for (i, j) in (-5..=5).flat_map(|i| (-5..=5).map(move |j| (f64::from(i), f64::from(j)))) {
            let pixel = Vector2::new(near.x.round() + i, near.y.round() + j);
            let (u, v) = (pixel.x, pixel.y);
            let gradient = Vector2::new(at(u + 1.0, v) - at(u - 1.0, v), at(u, v + 1.0) - at(u, v - 1.0));
            T += gradient * gradient.transpose();
            b += gradient * gradient.dot(&pixel);
        }
        T.try_inverse().unwrap() * b
    }

    #[test]
    fn corners_are_where_they_are_projected() {
        let (camera, pattern) = (camera(), pattern());
        for tilt in [0.0, 0.6] {
            let X_CT = viewpoint(0.45, tilt, 0.4, 0.2).inverse();
            let picture = render(&camera, &pattern, &X_CT, &Bodies::default(), &CLEAN);
            let off = |corner: nalgebra::Point3<f64>| {
                let pixel = camera.project(&(X_CT * corner)).unwrap();
                corner_near(&picture, &pixel) - pixel
            };
            let off: Vec<_> = BOARD.corners().map(off).collect();
            // The detector errs on its own, the picture as a whole is not shifted.
            assert!(off.iter().all(|off| off.norm() < 0.1), "{tilt}: {off:?}");
            let mean = off.iter().sum::<Vector2<f64>>() / off.len() as f64;
            assert!(mean.norm() < 0.03, "{tilt}: {mean}");
        }
    }

    #[test]
    fn bodies_hide_what_is_behind_them() {
        let (camera, pattern) = (camera(), pattern());
        let X_CT = viewpoint(0.45, 0.0, 0.0, 0.0).inverse();
        let ball = |z: f64| {
            let body = Body { X_LG: Pose::translation(0.0, 0.0, z), shape: Shape::Sphere { radius: 0.02 } };
            Bodies::new([PlacedBody { body: &body, X_CL: Pose::identity() }])
        };
        let middle = |bodies: &Bodies| {
            let picture = render(&camera, &pattern, &X_CT, bodies, &CLEAN);
            // In the middle of a square.
            picture.grey[120 * 320 + 172]
        };
        let free = middle(&Bodies::default());
        assert!(free.abs_diff(40) < 10 || free.abs_diff(200) < 10, "{free}");
        let hidden = middle(&ball(0.3));
        assert!(hidden > 60 && hidden < 180, "{hidden}");
        // Behind the board, and around the camera, they hide nothing.
        assert_eq!((middle(&ball(0.6)), middle(&ball(0.0))), (free, free));
    }

    #[test]
    fn edges_of_bodies_are_antialiased() {
        let camera = Camera::new(Lens::Pinhole, 320, 240, &[400.0, 400.0, 159.5, 119.5]).unwrap();
        let picture = |supersampling: u32| {
            // Its front is 0.9 m before the camera, and its right side, which is not seen, at the pixel 200.25; the board is
            // behind.
            let edge = (200.25 - 159.5) / 400.0 * 0.9;
            let half_extents = Vector3::new(edge, 0.1, 0.1);
            let wall = Body { X_LG: Pose::translation(0.0, 0.0, 1.0), shape: Shape::Box { half_extents } };
            let bodies = Bodies::new([PlacedBody { body: &wall, X_CL: Pose::identity() }]);
            let settings = RenderSettings { supersampling, blur: 0.0, ..CLEAN };
            let X_CT = Pose::translation(0.0, 0.0, -1.0);
            render(&camera, &pattern(), &X_CT, &bodies, &settings).grey
        };
        let row = |grey: &[u8]| [199, 200, 201].map(|u| f64::from(grey[120 * 320 + u]));
        let [wall, edge, behind] = row(&picture(8));
        assert!(wall > 140.0 && behind == 110.0);
        // Three quarters of the pixel.
        assert!((edge - (0.75 * wall + 0.25 * behind)).abs() <= 1.0, "{wall} {edge} {behind}");
        assert_eq!(row(&picture(1))[1], wall);
    }

    #[test]
    fn corners_are_hidden_where_occlusion_says_so() {
        let (camera, pattern) = (camera(), pattern());
        // The board is at the base, and a wall stands before some of its columns.
        let X_BC = viewpoint(0.45, 0.0, 0.0, 0.0);
        let half_extents = Vector3::new(0.05, 0.2, 0.02);
        let wall = Body { X_LG: Pose::translation(0.058, 0.0, 0.2), shape: Shape::Box { half_extents } };
        let bodies = Bodies::new([PlacedBody { body: &wall, X_CL: X_BC.inverse() }]);
        let picture = render(&camera, &pattern, &X_BC.inverse(), &bodies, &CLEAN);
        let link = Link {
            name: "base".into(),
            parent: None,
            X_PJ: Pose::identity(),
            motion: Motion::Fixed,
            bodies: vec![wall],
            mass: None,
        };
        let occlusion = Occlusion::new(&Tree { links: vec![link], disabled: vec![] }, 0);
        let corners: Vec<_> = BOARD.corners().collect();
        let hidden = occlusion.hidden(&[Pose::identity()], &X_BC, &Pose::identity(), &corners);
        assert!(hidden.contains(&true) && hidden.contains(&false));
        for (corner, hidden) in corners.iter().zip(hidden) {
            let pixel = camera.project(&(X_BC.inverse() * corner)).unwrap();
            // Around a corner there is black and white, on a body one grey.
            let around = [[-3.0, -3.0], [3.0, -3.0], [-3.0, 3.0], [3.0, 3.0]].map(|[i, j]| {
                picture.grey[(pixel.y + j).round() as usize * picture.width as usize + (pixel.x + i).round() as usize]
            });
            assert_eq!(around.iter().all(|grey| grey.abs_diff(around[0]) < 50), hidden, "{corner} {around:?}");
        }
    }

    #[test]
    fn a_plate_hides_the_board_if_it_rises_above_it() {
        let (camera, pattern) = (camera(), pattern());
        // So slanted that half a millimetre of height is more than one along the rays.
        let X_CT = viewpoint(0.45, 1.2, 0.0, 0.0).inverse();
        let white_behind = |height: f64| {
            let half_extents = Vector3::new(0.2, 0.2, height);
            let plate = Body { X_LG: Pose::identity(), shape: Shape::Box { half_extents } };
            let bodies = Bodies::new([PlacedBody { body: &plate, X_CL: X_CT }]);
            let picture = render(&camera, &pattern, &X_CT, &bodies, &CLEAN);
            picture.grey.iter().filter(|&&grey| grey > 180).count()
        };
        assert!(white_behind(0.5e-3) > 1000);
        assert_eq!(white_behind(2e-3), 0);
    }

    #[test]
    fn the_same_seed_gives_the_same_noise() {
        let (camera, pattern) = (camera(), pattern());
        let X_CT = viewpoint(0.5, 0.3, 0.0, 0.0).inverse();
        let picture = |noise: f64, seed: u64| {
            let settings = RenderSettings { noise, seed, ..CLEAN };
            render(&camera, &pattern, &X_CT, &Bodies::default(), &settings).grey
        };
        assert_eq!(picture(3.0, 1), picture(3.0, 1));
        assert_ne!(picture(3.0, 1), picture(3.0, 2));
        let clean = picture(0.0, 1);
        let square = |(a, b): (&u8, &u8)| (f64::from(*a) - f64::from(*b)).powi(2);
        let sum: f64 = picture(3.0, 1).iter().zip(&clean).map(square).sum();
        assert!(((sum / clean.len() as f64).sqrt() - 3.0).abs() < 0.1);
        // From behind there is no pattern.
        let behind = viewpoint(0.5, 0.3, 0.0, 0.0).inverse() * Pose::rotation(Vector3::x() * std::f64::consts::PI);
        let grey = render(&camera, &pattern, &behind, &Bodies::default(), &CLEAN).grey;
        assert!(grey.iter().all(|&grey| grey == 110));
    }
}
