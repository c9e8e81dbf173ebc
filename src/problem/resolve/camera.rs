//! The nominal camera.

use std::path::Path;

use super::check::Check;
use crate::camera::{Camera, Lens};
use crate::formats::{FileReadError, ReadFault, StatedCamera, read_camera_file};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;
use crate::problem::text::{At, KeyPath, Optional, key};

/// Image sides in px.
const IMAGE_SIDE: Allowed = Allowed::between(1.0, 100_000.0);
/// Focal lengths in px.
const FOCAL_LENGTH: Allowed = Allowed::positive(1e6);
/// Distortion coefficients.
const COEFFICIENT: Allowed = Allowed::between(-1e6, 1e6);

/// The share of the picture that a lens has to reach. The image circle of a fisheye may end far inside it. Other lenses fill their
/// pictures: a model that folds back within the inner half is not of the camera that took them.
fn least_coverage(lens: Lens) -> f64 {
    if lens.is_fisheye() { 0.1 } else { 0.5 }
}

/// The key that is to be changed where a camera file gives `error`.
fn culprit(camera: &At<schema::Camera>, error: &FileReadError) -> KeyPath {
    match error {
        FileReadError::Content(error) => match error.fault {
            ReadFault::UnknownCamera { .. } => key!(camera, file_camera).path,
            ReadFault::Mismatch { .. } => key!(camera, width_px).path,
            _ => key!(camera, file).path,
        },
        _ => key!(camera, file).path,
    }
}

impl schema::Camera {
    /// The lens model, if the problem file itself says it.
    pub(super) fn stated_lens(&self) -> Option<Lens> {
        let stated = || self.distortion.as_ref().map_or(Lens::Pinhole, |distortion| distortion.model.0);
        self.file.is_none().then(stated)
    }
}

impl Check<'_, '_> {
    /// The camera, or none if something is wrong with it; `folder` is the problem file's.
    pub(super) fn camera(&mut self, camera: &At<schema::Camera>, folder: &Path) -> Option<Camera> {
        let (model, distortion) = match key!(camera, file).given() {
            Some(file) => (self.imported(camera, &file, &folder.join(file.value))?, file.path),
            None => (self.stated(camera)?, key!(camera, distortion).path),
        };
        let (least, share) = (least_coverage(model.lens()), model.coverage());
        if share < least {
            self.fault(&distortion, Reason::FoldsBack { angle: model.fold(), share, least });
            return None;
        }
        Some(model)
    }

    /// The camera of the file at `path`, which takes the place of the keys but the mount's and those of what it may leave open.
    fn imported(&mut self, camera: &At<schema::Camera>, file: &At<String>, path: &Path) -> Option<Camera> {
        let faults = self.faults.len();
        self.excluded(
            &[
                &key!(camera, fx_px),
                &key!(camera, fy_px),
                &key!(camera, cx_px),
                &key!(camera, cy_px),
                &key!(camera, distortion),
            ],
            &file.path.to_string(),
        );
        let (width, height) = (key!(camera, width_px), key!(camera, height_px));
        let image = if width.is_given() || height.is_given() {
            let (width, height) = (self.image_side(width), self.image_side(height));
            Some([width?, height?])
        } else {
            None
        };
        match read_camera_file(path, &StatedCamera { image, name: camera.value.file_camera.clone() }) {
            Ok(model) => (self.faults.len() == faults).then_some(model),
            Err(error) => {
                self.fault(&culprit(camera, &error), Reason::CameraFile { path: path.to_owned(), error });
                None
            }
        }
    }

    /// The camera that the keys state.
    fn stated(&mut self, camera: &At<schema::Camera>) -> Option<Camera> {
        let faults = self.faults.len();
        let instead = format!("`{}` names the camera file", key!(camera, file).path.name());
        self.refused(&[&key!(camera, file_camera)], "a camera that is not from a file", &instead);
        let width = self.image_side(key!(camera, width_px));
        let height = self.image_side(key!(camera, height_px));
        let fx = self.required(key!(camera, fx_px), &[]).map(|fx| self.number(&fx, FOCAL_LENGTH));
        let fy = key!(camera, fy_px).given().map(|fy| self.number(&fy, FOCAL_LENGTH)).or(fx);
        let cx = width.map(|width| self.principal_point(key!(camera, cx_px), f64::from(width)));
        let cy = height.map(|height| self.principal_point(key!(camera, cy_px), f64::from(height)));
        let no_distortion = schema::Distortion::default();
        let distortion = key!(camera, distortion).or(&no_distortion);
        let lens = distortion.value.model.0;
        let coefficients = self.coefficients(&distortion, lens);
        if self.faults.len() > faults {
            return None;
        }
        let mut θ = vec![fx?, fy?, cx?, cy?];
        θ.extend(coefficients);
        // What Camera::new refuses has been refused above, with its place in the file.
        Camera::new(lens, width?, height?, &θ).ok()
    }

    fn image_side(&mut self, side: At<Option<u32>>) -> Option<u32> {
        let side = self.required(side, &[])?;
        self.count(&side, IMAGE_SIDE);
        Some(*side.value)
    }

    fn principal_point(&mut self, point: At<Option<f64>>, size: f64) -> f64 {
        match point.given() {
            // The image's border runs half a pixel outside the outermost pixel centres.
            Some(point) => self.number(&point, Allowed::between(-0.5, size - 0.5)),
            None => (size - 1.0) / 2.0,
        }
    }

    /// The coefficients of `lens`, in the order of θ.
    fn coefficients(&mut self, distortion: &At<schema::Distortion>, lens: Lens) -> Vec<f64> {
        let names = &lens.parameter_names()[4..];
        let mut coefficients = vec![0.0; names.len()];
        let keys = [
            key!(distortion, k1),
            key!(distortion, k2),
            key!(distortion, p1),
            key!(distortion, p2),
            key!(distortion, k3),
            key!(distortion, k4),
            key!(distortion, k5),
            key!(distortion, k6),
        ];
        for coefficient in keys.into_iter().filter_map(At::given) {
            if let Some(i) = names.iter().position(|&name| name == coefficient.path.name()) {
                coefficients[i] = self.number(&coefficient, COEFFICIENT);
            } else {
                let instead = if names.is_empty() {
                    "choose another `model`, such as \"brown-conrady\"".to_owned()
                } else {
                    format!("its coefficients are {}", names.join(", "))
                };
                let to = format!("the lens model \"{}\"", lens.name());
                self.not_applicable(&coefficient.path, &to, &instead);
            }
        }
        coefficients
    }
}
