//! The camera: image size, lens model, projection with derivatives, and its inverse.
//!
//! Frame **C** has x to the right, y down and z forward, as in OpenCV. Pixel (0, 0) is the centre of the top-left
//! pixel. The intrinsic parameters θ are `fx fy cx cy` in pixels, then the lens's coefficients in OpenCV's order.

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

mod error;
mod lens;

pub use error::CameraError;
pub use lens::Lens;

use nalgebra::{Matrix2x3, Point3, SMatrix, Unit, Vector2, Vector3};

use crate::lanes::Number;
use lens::Distorted;

/// Parameters of the largest camera model: `fx fy cx cy` and the eight coefficients of [`Lens::Rational`].
pub const MAX_INTRINSICS: usize = 12;

/// Cells of the grid of [`Camera::coverage`] along the picture's longer side.
const COVERAGE_CELLS: u32 = 64;

/// Derivative of a pixel (2 rows) by the intrinsics (as many of the columns as the model has; the rest are zero).
pub type IntrinsicsJacobian = SMatrix<f64, 2, MAX_INTRINSICS>;

/// A calibrated camera.
///
/// ```
/// use calipose::camera::{Camera, Lens};
/// use nalgebra::{Point3, Vector2};
///
/// let camera = Camera::new(Lens::Pinhole, 1280, 720, &[900.0, 900.0, 639.5, 359.5])?;
/// assert_eq!(camera.project(&Point3::new(0.1, 0.0, 1.0)), Some(Vector2::new(729.5, 359.5)));
/// # Ok::<(), calipose::camera::CameraError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    lens: Lens,
    width: u32,
    height: u32,
    /// θ, padded with zeros.
    intrinsics: [f64; MAX_INTRINSICS],
    /// Beyond this measure of the angle to the optical axis the lens model folds back; see [`Lens::reach`].
    reach: f64,
}

/// A pixel with its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    /// The pixel `(u, v)`.
    pub pixel: Vector2<f64>,
    /// `∂(u, v)/∂p_C`, px per m.
    pub by_point: Matrix2x3<f64>,
    /// `∂(u, v)/∂θ`, px per unit of each parameter.
    pub by_intrinsics: IntrinsicsJacobian,
}

/// The same of one point or of several, as plain numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Image<N> {
    pixel: [N; 2],
    /// Two rows.
    pub(crate) by_point: [[N; 3]; 2],
    /// Columns.
    pub(crate) by_intrinsics: [[N; 2]; MAX_INTRINSICS],
}

impl Camera {
    /// A camera from its `intrinsics`: `fx fy cx cy` in px, then the coefficients of `lens`.
    ///
    /// # Errors
    /// When the image is empty, the number of parameters is not the model's, one is not finite, or a focal length
    /// is not positive.
    pub fn new(lens: Lens, width: u32, height: u32, intrinsics: &[f64]) -> Result<Self, CameraError> {
        if width == 0 || height == 0 {
            return Err(CameraError::EmptyImage { width, height });
        }
        let names = lens.parameter_names();
        if intrinsics.len() != names.len() {
            return Err(CameraError::ParameterCount {
                lens: lens.name(),
                expected: names.len(),
                found: intrinsics.len(),
            });
        }
        for (&name, &value) in names.iter().zip(intrinsics) {
            if !value.is_finite() {
                return Err(CameraError::NotFinite { name, value });
            }
        }
        for (&name, &value) in names.iter().zip(&intrinsics[..2]) {
            if value <= 0.0 {
                return Err(CameraError::FocalLength { name, value });
            }
        }
        let mut θ = [0.0; MAX_INTRINSICS];
        θ[..intrinsics.len()].copy_from_slice(intrinsics);
        Ok(Self { lens, width, height, intrinsics: θ, reach: lens.reach(&θ[4..]) })
    }

    /// The same image and lens model with other intrinsics.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn with_intrinsics(&self, intrinsics: &[f64]) -> Result<Self, CameraError> {
        Self::new(self.lens, self.width, self.height, intrinsics)
    }

    /// The same camera with other intrinsics and its lens model continued past the fold: what an optimiser needs
    /// between its start and its end, where a cost that jumps would only hide the way.
    ///
    /// Takes the parameters unchecked; entries beyond the model's are not read.
    pub(crate) fn extrapolated(&self, intrinsics: &[f64; MAX_INTRINSICS]) -> Self {
        Self { intrinsics: *intrinsics, reach: f64::INFINITY, ..*self }
    }

    /// The lens model.
    pub fn lens(&self) -> Lens {
        self.lens
    }

    /// Image width in px.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Image height in px.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// θ: `fx fy cx cy` in px, then the lens's coefficients; as long as [`Lens::parameter_names`].
    pub fn intrinsics(&self) -> &[f64] {
        &self.intrinsics[..self.lens.parameter_names().len()]
    }

    /// The angle to the optical axis, rad, beyond which the lens model folds back and nothing is seen; none where it does not.
    pub fn fold(&self) -> Option<f64> {
        self.lens.fold(self.reach)
    }

    /// The share of the picture's area that the lens reaches: beyond the image circle of a fisheye, or the fold of another lens, there
    /// is no direction that a pixel sees. Counted on a grid, to a hundredth or so.
    pub fn coverage(&self) -> f64 {
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        let cell = width.max(height) / f64::from(COVERAGE_CELLS);
        let (columns, rows) = ((width / cell).ceil() as u32, (height / cell).ceil() as u32);
        let middle = |i: u32, count: u32, size: f64| (f64::from(i) + 0.5) / f64::from(count) * size - 0.5;
        let seen = |g: u32| {
            let (u, v) = (middle(g % columns, columns, width), middle(g / columns, rows, height));
            self.unproject(&Vector2::new(u, v)).is_some()
        };
        (0..columns * rows).filter(|&g| seen(g)).count() as f64 / f64::from(columns * rows)
    }

    /// Whether `pixel` lies between the outermost pixel centres, at least `margin` px from them.
    pub fn contains(&self, pixel: &Vector2<f64>, margin: f64) -> bool {
        let inside = |x: f64, size: u32| x >= margin && x <= f64::from(size) - 1.0 - margin;
        inside(pixel.x, self.width) && inside(pixel.y, self.height)
    }

    /// The pixel of point `p_C` (m), or `None` behind the camera or where the lens model folds back.
    pub fn project(&self, p_C: &Point3<f64>) -> Option<Vector2<f64>> {
        let [fx, fy, cx, cy, ref coefficients @ ..] = self.intrinsics;
        let m = self.lens.distort(&p_C.coords, coefficients, self.reach)?;
        Some(Vector2::new(fx * m.x + cx, fy * m.y + cy))
    }

    /// The pixel of point `p_C` (m) with its derivatives, or `None` where [`Camera::project`] gives none.
    #[inline]
    pub fn project_with_derivatives(&self, p_C: &Point3<f64>) -> Option<Projection> {
        let Image { pixel, by_point, by_intrinsics } = self.image(p_C.coords.into())?;
        let by_point = Matrix2x3::from_fn(|r, c| by_point[r][c]);
        Some(Projection { pixel: pixel.into(), by_point, by_intrinsics: by_intrinsics.into() })
    }

    /// The same as plain numbers, of one point or of several; none unless all have a pixel.
    #[inline(always)]
    pub(crate) fn image<N: Number>(&self, p_C: [N; 3]) -> Option<Image<N>> {
        let [fx, fy, cx, cy, ref coefficients @ ..] = self.intrinsics;
        let Distorted { point: [x, y], by_point, by_coefficients } =
            self.lens.distort_with_derivatives(p_C, coefficients, self.reach)?;
        let [zero, one] = [0.0, 1.0].map(N::all);
        let mut by_intrinsics = [[zero; 2]; MAX_INTRINSICS];
        by_intrinsics[..4].copy_from_slice(&[[x, zero], [zero, y], [one, zero], [zero, one]]);
        for (column, [u, v]) in by_intrinsics[4..].iter_mut().zip(by_coefficients) {
            *column = [u * fx, v * fy];
        }
        let pixel = [x * fx + N::all(cx), y * fy + N::all(cy)];
        let by_point = [by_point[0].map(|entry| entry * fx), by_point[1].map(|entry| entry * fy)];
        Some(Image { pixel, by_point, by_intrinsics })
    }

    /// Vergence of a point `p_C` (m), in 1/m: one over its distance as the lens is focused on it, which is that along the axis,
    /// or through a fisheye, which sees a sphere sharp and not a plane, that from its centre.
    #[inline]
    pub fn vergence(&self, p_C: &Point3<f64>) -> f64 {
        self.vergence_of(p_C.coords.into())
    }

    /// The same of one point or of several.
    #[inline(always)]
    pub(crate) fn vergence_of<N: Number>(&self, [x, y, z]: [N; 3]) -> N {
        let distance = if self.lens.is_fisheye() { (x * x + y * y + z * z).sqrt() } else { z };
        N::all(1.0) / distance
    }

    /// The direction in C whose image is `pixel`, or `None` where the lens reaches no such pixel.
    pub fn unproject(&self, pixel: &Vector2<f64>) -> Option<Unit<Vector3<f64>>> {
        let [fx, fy, cx, cy, ref coefficients @ ..] = self.intrinsics;
        let m = Vector2::new((pixel.x - cx) / fx, (pixel.y - cy) / fy);
        self.lens.undistort(&m, coefficients, self.reach)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cameras() -> Vec<Camera> {
        let focal = [1000.0, 990.0, 641.0, 362.0];
        let camera = |lens: Lens| Camera::new(lens, 1280, 720, &[&focal[..], lens.typical()].concat()).unwrap();
        Lens::ALL.map(camera).to_vec()
    }

    proptest! {
        #[test]
        fn derivatives_equal_finite_differences(x in -0.6..0.6, y in -0.35..0.35, z in 0.5..2.0) {
            let p_C = Point3::new(x * z, y * z, z);
            for camera in cameras() {
                let projection = camera.project_with_derivatives(&p_C).unwrap();
                prop_assert!((projection.pixel - camera.project(&p_C).unwrap()).norm() < 1e-10);
                for axis in 0..3 {
                    let h = 1e-6;
                    let mut step = Vector3::zeros();
                    step[axis] = h;
                    let slope = (camera.project(&(p_C + step)).unwrap() - camera.project(&(p_C - step)).unwrap()) / (2.0 * h);
                    prop_assert!((slope - projection.by_point.column(axis)).norm() < 1e-5 * slope.norm().max(100.0));
                }
                for j in 0..camera.intrinsics().len() {
                    let h = 1e-6;
                    let at = |offset: f64| {
                        let mut θ = camera.intrinsics().to_vec();
                        θ[j] += offset;
                        camera.with_intrinsics(&θ).unwrap().project(&p_C).unwrap()
                    };
                    let slope = (at(h) - at(-h)) / (2.0 * h);
                    prop_assert!((slope - projection.by_intrinsics.column(j)).norm() < 1e-5 * slope.norm().max(1.0));
                }
            }
        }

        #[test]
        fn unprojection_inverts_projection(u in 0.0..1279.0, v in 0.0..719.0) {
            let pixel = Vector2::new(u, v);
            for camera in cameras() {
                let ray = camera.unproject(&pixel).unwrap();
                let again = camera.project(&Point3::from(ray.into_inner() * 3.0)).unwrap();
                prop_assert!((again - pixel).norm() < 1e-9, "{camera:?}: {again}");
            }
        }
    }

    #[test]
    fn points_behind_the_camera_or_beyond_the_fold_have_no_pixel() {
        for camera in cameras().iter().filter(|camera| !camera.lens().is_fisheye()) {
            assert_eq!(camera.project(&Point3::new(0.1, 0.0, -1.0)), None);
        }
        // r(1 − 0.2 r²) turns back at r = √(1/0.6) = 1.291.
        let camera =
            Camera::new(Lens::BrownConrady, 640, 480, &[500.0, 500.0, 320.0, 240.0, -0.2, 0.0, 0.0, 0.0, 0.0]).unwrap();
        assert!(camera.project(&Point3::new(1.29, 0.0, 1.0)).is_some());
        assert!(camera.project(&Point3::new(1.292, 0.0, 1.0)).is_none());
        assert!(camera.project_with_derivatives(&Point3::new(1.292, 0.0, 1.0)).is_none());
        assert!(camera.unproject(&Vector2::new(320.0 + 500.0 * 0.9, 240.0)).is_none());
    }

    #[test]
    fn what_the_lens_reaches_is_the_disc_within_its_fold() {
        let folding = [
            (Lens::BrownConrady, 400.0, vec![-0.35, 0.0, 0.0, 0.0, 0.0]),
            (Lens::BrownConrady, 300.0, vec![-0.4, 0.1, 0.0, 0.0, -0.02]),
            (Lens::Rational, 300.0, vec![-0.5, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02, 0.0]),
            (Lens::KannalaBrandt, 130.0, vec![-0.042, 0.003, -0.0024, 0.0]),
            (Lens::KannalaBrandt, 70.0, vec![0.0; 4]),
        ];
        for (lens, focal, coefficients) in folding {
            let θ = [&[focal, focal, 322.0, 239.0], &coefficients[..]].concat();
            let camera = Camera::new(lens, 640, 480, &θ).unwrap();
            let fold = camera.fold().unwrap_or(std::f64::consts::PI);
            let rim = |share: f64| camera.project(&Point3::new((share * fold).sin(), 0.0, (share * fold).cos()));
            let radius = rim(1.0 - 1e-9).unwrap().x - 322.0;
            assert!(camera.fold().is_none() || rim(1.0 + 1e-6).is_none());
            let pixels =
                (0..160 * 120).map(|i| Vector2::new(1.5 + 4.0 * f64::from(i % 160), 1.5 + 4.0 * f64::from(i / 160)));
            let distances = pixels.map(|pixel| (pixel, (pixel - Vector2::new(322.0, 239.0)).norm()));
            let mut inside = 0;
            for (pixel, distance) in distances.filter(|(_, distance)| (distance - radius).abs() > 1e-3) {
                inside += u32::from(distance < radius);
                assert_eq!(camera.unproject(&pixel).is_some(), distance < radius, "{camera:?} {pixel}");
            }
            let share = f64::from(inside) / (160.0 * 120.0);
            assert!((camera.coverage() - share).abs() < 0.01, "{} {share}", camera.coverage());
            assert!((0.2..0.9).contains(&share), "{share}");
        }
    }

    #[test]
    fn the_fisheye_sees_past_ninety_degrees() {
        let camera =
            Camera::new(Lens::KannalaBrandt, 1000, 1000, &[250.0, 250.0, 500.0, 500.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
        let pixel = camera.project(&Point3::new(1.0, 0.0, -0.1)).unwrap();
        assert!((pixel.x - 500.0 - 250.0 * (1.0f64).atan2(-0.1)).abs() < 1e-9);
    }

    #[test]
    fn vergence_is_by_the_depth_and_through_a_fisheye_by_the_distance() {
        let point = Point3::new(0.3, 0.0, 0.4);
        let vergence = |lens: Lens| {
            let intrinsics =
                [[250.0, 250.0, 500.0, 500.0].as_slice(), &vec![0.0; lens.parameter_names().len() - 4]].concat();
            Camera::new(lens, 1000, 1000, &intrinsics).unwrap().vergence(&point)
        };
        assert_eq!(vergence(Lens::BrownConrady), 2.5);
        assert_eq!(vergence(Lens::KannalaBrandt), 2.0);
    }

    #[test]
    fn the_image_ends_at_its_outermost_pixel_centres() {
        let camera = &cameras()[0];
        assert!(camera.contains(&Vector2::new(0.0, 719.0), 0.0));
        assert!(!camera.contains(&Vector2::new(-0.01, 10.0), 0.0));
        assert!(!camera.contains(&Vector2::new(9.0, 10.0), 10.0));
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let good = [500.0, 500.0, 320.0, 240.0];
        assert_eq!(Camera::new(Lens::Pinhole, 0, 480, &good), Err(CameraError::EmptyImage { width: 0, height: 480 }));
        assert!(matches!(
            Camera::new(Lens::BrownConrady, 640, 480, &good),
            Err(CameraError::ParameterCount { expected: 9, found: 4, .. })
        ));
        assert!(matches!(
            Camera::new(Lens::Pinhole, 640, 480, &[500.0, -1.0, 0.0, 0.0]),
            Err(CameraError::FocalLength { name: "fy", .. })
        ));
        assert!(matches!(
            Camera::new(Lens::Pinhole, 640, 480, &[500.0, 500.0, f64::NAN, 0.0]),
            Err(CameraError::NotFinite { name: "cx", .. })
        ));
    }
}
