//! Where the refinement starts: a camera and the views' poses from the images alone.

use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector2, Vector3};

use super::CalibrationError;
use super::homography::homography;
use super::observations::Observations;
use super::zhang::{Pinhole, pose_of_homography};
use crate::camera::{Camera, MAX_INTRINSICS};
use crate::spatial::Pose;
use crate::target::Surface;

/// A camera and the poses `X_CT` of the board in it, one a view.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The camera.
    pub camera: Camera,
    /// The views' poses.
    pub poses: Vec<Pose>,
    /// The board's face.
    pub surface: Surface,
}

/// Focal lengths tried where there is no closed form, as shares of the image's longer side: from a fisheye that sees
/// 180° within a quarter of the image to a long lens.
const FOCAL_SHARES: [f64; 16] =
    [0.1, 0.13, 0.17, 0.22, 0.28, 0.36, 0.47, 0.61, 0.8, 1.0, 1.35, 1.75, 2.3, 3.0, 4.5, 7.0];

/// Views that judge a focal length.
const VIEWS_TRIED: usize = 12;

/// Cosine of the widest angle between a corner's ray and the board's middle that a virtual camera still images.
const VIRTUAL_HALF_ANGLE: f64 = 0.2;

/// Finds a start for the intrinsics `estimated` (indices into [`Camera::intrinsics`]); the others keep their values
/// in `nominal`, whose estimated values are not read.
///
/// Lenses near a pinhole take Zhang's closed form: focal lengths and principal point without skew or, where noise or
/// the lens defeats it, one focal length about the image's centre; then the distortion's first two coefficients
/// by linear least squares. A fisheye, or a set of views that defeats both, takes the focal length that explains the
/// views best among a ladder of them.
///
/// # Errors
/// [`CalibrationError::NoStart`] with the view for which no pose could be found; inconsistent arguments as for
/// [`crate::calibration::calibrate`].
pub fn start(observations: &Observations, nominal: &Camera, estimated: &[usize]) -> Result<Start, CalibrationError> {
    crate::calibration::check_problem(observations, nominal, estimated)?;
    let unknown = Unknown::new(observations, nominal, estimated);
    if nominal.lens().is_fisheye() { unknown.by_focal_ladder() } else { unknown.by_closed_form() }
}

/// The board's pose `X_CT` in view `view` of `observations` for a known camera, from the homography of its corners; `None` where
/// the camera sees no such corners.
pub fn pose_of_view(observations: &Observations, view: usize, camera: &Camera) -> Option<Pose> {
    let mut points = Points::default();
    points.load(observations, view);
    points.resect(camera)
}

/// What is sought, and what is known before any view is looked at.
struct Unknown<'a> {
    observations: &'a Observations,
    nominal: &'a Camera,
    /// The fixed intrinsics; zero distortion and the image's centre for the estimated ones.
    θ: [f64; MAX_INTRINSICS],
    is_estimated: [bool; MAX_INTRINSICS],
}

impl<'a> Unknown<'a> {
    fn new(observations: &'a Observations, nominal: &'a Camera, estimated: &[usize]) -> Self {
        let mut θ = [0.0; MAX_INTRINSICS];
        θ[..nominal.intrinsics().len()].copy_from_slice(nominal.intrinsics());
        let mut is_estimated = [false; MAX_INTRINSICS];
        for &j in estimated {
            is_estimated[j] = true;
            θ[j] = match j {
                2 => (f64::from(nominal.width()) - 1.0) / 2.0,
                3 => (f64::from(nominal.height()) - 1.0) / 2.0,
                _ => 0.0,
            };
        }
        Self { observations, nominal, θ, is_estimated }
    }

    fn longer_side(&self) -> f64 {
        f64::from(self.nominal.width().max(self.nominal.height()))
    }

    /// θ with the estimated ones of `fx fy cx cy` taken from `pinhole`.
    fn with_pinhole(&self, pinhole: &Pinhole) -> [f64; MAX_INTRINSICS] {
        let mut θ = self.θ;
        for (j, value) in [pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy].into_iter().enumerate() {
            if self.is_estimated[j] {
                θ[j] = value;
            }
        }
        θ
    }

    fn by_closed_form(&self) -> Result<Start, CalibrationError> {
        let mut points = Points::default();
        let mut homographies = Vec::with_capacity(self.observations.views().len());
        for view in 0..self.observations.views().len() {
            points.load(self.observations, view);
            homographies.push(homography(&points.board, &points.image).ok_or(CalibrationError::NoStart { view })?);
        }
        let centre = Vector2::new(self.θ[2], self.θ[3]);
        let plausible = |p: &Pinhole| {
            // A principal point outside the image or a focal length off the ladder is noise.
            let (w, h) = (f64::from(self.nominal.width()), f64::from(self.nominal.height()));
            let focal = |f: f64| (FOCAL_SHARES[0]..FOCAL_SHARES[15]).contains(&(f / w.max(h)));
            focal(p.fx) && focal(p.fy) && p.cx > 0.0 && p.cx < w && p.cy > 0.0 && p.cy < h
        };
        let scale = self.longer_side();
        let pinhole = Some(&homographies)
            .filter(|_| self.is_estimated[2] && self.is_estimated[3])
            .and_then(|H| Pinhole::without_skew(H, centre, scale).filter(plausible))
            .or_else(|| Pinhole::with_principal_point(&homographies, centre, scale).filter(plausible));
        let Some(pinhole) = pinhole else {
            return self.by_focal_ladder();
        };
        let mut θ = self.with_pinhole(&pinhole);
        let K_inverse = Pinhole { fx: θ[0], fy: θ[1], cx: θ[2], cy: θ[3], skew: 0.0 }.inverse_matrix();
        let poses = homographies
            .iter()
            .enumerate()
            .map(|(view, H)| pose_of_homography(&(K_inverse * H)).ok_or(CalibrationError::NoStart { view }));
        let poses = poses.collect::<Result<Vec<_>, _>>()?;
        if let Some([k1, k2]) = self.nominal.lens().radial_polynomial()
            && self.is_estimated[k1]
            && self.is_estimated[k2]
        {
            [θ[k1], θ[k2]] = self.radial_distortion(&θ, &poses);
        }
        Ok(Start { camera: self.nominal.extrapolated(&θ), poses, surface: Surface::FLAT })
    }

    /// `k1` and `k2` by linear least squares from what the undistorted camera leaves (Zhang, eq. 13), or zeros where
    /// they would not be small against one.
    fn radial_distortion(&self, θ: &[f64; MAX_INTRINSICS], poses: &[Pose]) -> [f64; 2] {
        let (mut a11, mut a12, mut a22, mut b1, mut b2, mut r2_max) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0f64);
        let focal = Vector2::new(θ[0], θ[1]);
        let centre = Vector2::new(θ[2], θ[3]);
        for (view, X_CT) in self.observations.views().iter().zip(poses) {
            for corner in view {
                let p_C = X_CT * Point3::from(self.observations.on_board(corner).push(0.0));
                let m = p_C.coords.xy() / p_C.z;
                let r2 = m.norm_squared();
                let image = m.component_mul(&focal);
                let rest = corner.pixel - centre - image;
                let (d, e) = (image.norm_squared() * r2 * r2, image.dot(&rest) * r2);
                a11 += d;
                a12 += d * r2;
                a22 += d * r2 * r2;
                b1 += e;
                b2 += e * r2;
                r2_max = r2_max.max(r2);
            }
        }
        let det = a11 * a22 - a12 * a12;
        let k = [(a22 * b1 - a12 * b2) / det, (a11 * b2 - a12 * b1) / det];
        let small = k[0].abs() * r2_max + k[1].abs() * r2_max * r2_max < 0.5;
        if small { k } else { [0.0; 2] }
    }

    fn by_focal_ladder(&self) -> Result<Start, CalibrationError> {
        let count = self.observations.views().len();
        let every = count.div_ceil(VIEWS_TRIED);
        let mut points = Points::default();
        let mut best: Option<(f64, Camera)> = None;
        for share in FOCAL_SHARES {
            let f = share * self.longer_side();
            let camera = self.nominal.extrapolated(&self.with_pinhole(&Pinhole {
                fx: f,
                fy: f,
                cx: self.θ[2],
                cy: self.θ[3],
                skew: 0.0,
            }));
            let mut cost = 0.0;
            for view in (0..count).step_by(every) {
                points.load(self.observations, view);
                // A view that a wrong focal length leaves without a pose counts as missed by the whole image.
                let miss = self.longer_side().powi(2) * points.board.len() as f64;
                cost += points.resect(&camera).map_or(miss, |X_CT| points.cost(&camera, &X_CT).min(miss));
            }
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, camera));
            }
        }
        let Some((_, camera)) = best else {
            return Err(CalibrationError::NoStart { view: 0 });
        };
        let poses = (0..count).map(|view| {
            points.load(self.observations, view);
            points.resect(&camera).ok_or(CalibrationError::NoStart { view })
        });
        let poses = poses.collect::<Result<Vec<_>, _>>()?;
        Ok(Start { camera, poses, surface: Surface::FLAT })
    }
}

/// The corners of one view, by column: buffers that every view reuses.
#[derive(Default)]
struct Points {
    board: Vec<Vector2<f64>>,
    image: Vec<Vector2<f64>>,
    /// Directions in C, and the same in the virtual camera's plane.
    rays: Vec<Vector3<f64>>,
    seen: Vec<Vector2<f64>>,
    virtual_image: Vec<Vector2<f64>>,
}

impl Points {
    fn load(&mut self, observations: &Observations, view: usize) {
        let corners = &observations.views()[view];
        self.board.clear();
        self.board.extend(corners.iter().map(|c| observations.on_board(c)));
        self.image.clear();
        self.image.extend(corners.iter().map(|c| c.pixel));
    }

    /// The board's pose in a known camera, from the homography to a virtual pinhole camera that looks at the middle
    /// of the corners: so a fisheye's rays beyond 90° of its axis serve as well as any.
    fn resect(&mut self, camera: &Camera) -> Option<Pose> {
        self.rays.clear();
        for pixel in &self.image {
            self.rays.push(camera.unproject(pixel)?.into_inner());
        }
        let middle = self.rays.iter().sum::<Vector3<f64>>();
        // Rotation from C to the virtual camera V, which looks along +z.
        let R_VC = Rotation3::rotation_between(&middle, &Vector3::z())
            .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        self.seen.clear();
        self.virtual_image.clear();
        for (point, ray) in self.board.iter().zip(&self.rays) {
            let ray = R_VC * ray;
            if ray.z > VIRTUAL_HALF_ANGLE {
                self.seen.push(*point);
                self.virtual_image.push(ray.xy() / ray.z);
            }
        }
        let H: Matrix3<f64> = homography(&self.seen, &self.virtual_image)?;
        let X_VT = pose_of_homography(&H)?;
        Some(UnitQuaternion::from_rotation_matrix(&R_VC.inverse()) * X_VT)
    }

    /// Sum of squared residuals, px²; infinite where a corner has no image.
    fn cost(&self, camera: &Camera, X_CT: &Pose) -> f64 {
        let squares = self.board.iter().zip(&self.image).map(|(point, pixel)| {
            let p_C = X_CT * Point3::from(point.push(0.0));
            camera.project(&p_C).map_or(f64::INFINITY, |image| (image - pixel).norm_squared())
        });
        squares.sum()
    }
}
