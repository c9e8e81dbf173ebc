//! The nominal camera.

use std::path::Path;

use super::Check;
use crate::camera::{Camera, Lens};
use crate::formats::{FileReadError, ReadFault, StatedCamera, read_camera_file};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;
use crate::problem::text::KeyPath;

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
fn culprit(error: &FileReadError) -> &'static str {
    match error {
        FileReadError::Content(error) => match error.fault {
            ReadFault::UnknownCamera { .. } => "file_camera",
            ReadFault::Mismatch { .. } => "width_px",
            _ => "file",
        },
        _ => "file",
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
    pub(super) fn camera(&mut self, camera: &schema::Camera, folder: &Path) -> Option<Camera> {
        let at = KeyPath::section("camera");
        let (model, distortion) = match &camera.file {
            Some(file) => (self.imported(&at, camera, &folder.join(file))?, at.key("file")),
            None => (self.stated(&at, camera)?, at.key("distortion")),
        };
        let (least, share) = (least_coverage(model.lens()), model.coverage());
        if share < least {
            self.fault(&distortion, Reason::FoldsBack { angle: model.fold(), share, least });
            return None;
        }
        Some(model)
    }

    /// The camera of the file at `path`, which takes the place of the keys but the mount's and those of what it may leave open.
    fn imported(&mut self, at: &KeyPath, camera: &schema::Camera, path: &Path) -> Option<Camera> {
        let faults = self.faults.len();
        let given = [
            ("fx_px", camera.fx_px.is_some()),
            ("fy_px", camera.fy_px.is_some()),
            ("cx_px", camera.cx_px.is_some()),
            ("cy_px", camera.cy_px.is_some()),
            ("distortion", camera.distortion.is_some()),
        ];
        for (name, _) in given.into_iter().filter(|(_, given)| *given) {
            self.fault(&at.key(name), Reason::Conflict { with: "camera.file".into() });
        }
        let image = if camera.width_px.is_some() || camera.height_px.is_some() {
            let width = self.image_side(&at.key("width_px"), camera.width_px);
            let height = self.image_side(&at.key("height_px"), camera.height_px);
            Some([width?, height?])
        } else {
            None
        };
        match read_camera_file(path, &StatedCamera { image, name: camera.file_camera.clone() }) {
            Ok(model) => (self.faults.len() == faults).then_some(model),
            Err(error) => {
                self.fault(&at.key(culprit(&error)), Reason::CameraFile { path: path.to_owned(), error });
                None
            }
        }
    }

    /// The camera that the keys state.
    fn stated(&mut self, at: &KeyPath, camera: &schema::Camera) -> Option<Camera> {
        let faults = self.faults.len();
        if camera.file_camera.is_some() {
            let (to, instead) =
                ("a camera that is not from a file".to_owned(), "`file` names the camera file".to_owned());
            self.fault(&at.key("file_camera"), Reason::NotApplicable { to, instead });
        }
        let width = self.image_side(&at.key("width_px"), camera.width_px);
        let height = self.image_side(&at.key("height_px"), camera.height_px);
        let fx = self.required(&at.key("fx_px"), camera.fx_px);
        let fx = fx.map(|fx| self.number(&at.key("fx_px"), fx, FOCAL_LENGTH));
        let fy = camera.fy_px.map(|fy| self.number(&at.key("fy_px"), fy, FOCAL_LENGTH)).or(fx);
        let cx = width.map(|width| self.principal_point(&at.key("cx_px"), camera.cx_px, f64::from(width)));
        let cy = height.map(|height| self.principal_point(&at.key("cy_px"), camera.cy_px, f64::from(height)));
        let distortion = camera.distortion.clone().unwrap_or_default();
        let lens = distortion.model.0;
        let coefficients = self.coefficients(&at.key("distortion"), &distortion, lens);
        if self.faults.len() > faults {
            return None;
        }
        let mut θ = vec![fx?, fy?, cx?, cy?];
        θ.extend(coefficients);
        // What Camera::new refuses has been refused above, with its place in the file.
        Camera::new(lens, width?, height?, &θ).ok()
    }

    fn image_side(&mut self, path: &KeyPath, value: Option<u32>) -> Option<u32> {
        let value = self.required(path, value)?;
        self.number(path, f64::from(value), IMAGE_SIDE);
        Some(value)
    }

    fn required<T>(&mut self, path: &KeyPath, value: Option<T>) -> Option<T> {
        if value.is_none() {
            self.fault(path, Reason::Missing { allowed: Vec::new() });
        }
        value
    }

    fn principal_point(&mut self, path: &KeyPath, value: Option<f64>, size: f64) -> f64 {
        match value {
            // The image's border runs half a pixel outside the outermost pixel centres.
            Some(value) => self.number(path, value, Allowed::between(-0.5, size - 0.5)),
            None => (size - 1.0) / 2.0,
        }
    }

    /// The coefficients of `lens`, in the order of θ.
    fn coefficients(&mut self, at: &KeyPath, distortion: &schema::Distortion, lens: Lens) -> Vec<f64> {
        let schema::Distortion { model: _, k1, k2, p1, p2, k3, k4, k5, k6 } = *distortion;
        let given = [("k1", k1), ("k2", k2), ("p1", p1), ("p2", p2), ("k3", k3), ("k4", k4), ("k5", k5), ("k6", k6)];
        let names = &lens.parameter_names()[4..];
        let mut coefficients = vec![0.0; names.len()];
        for (name, value) in given {
            let Some(value) = value else { continue };
            if let Some(i) = names.iter().position(|&known| known == name) {
                coefficients[i] = self.number(&at.key(name), value, COEFFICIENT);
            } else {
                let instead = if names.is_empty() {
                    "choose another `model`, \"brown-conrady\" for instance".to_owned()
                } else {
                    format!("its coefficients are {}", names.join(", "))
                };
                let to = format!("the lens model \"{}\"", lens.name());
                self.fault(&at.key(name), Reason::NotApplicable { to, instead });
            }
        }
        coefficients
    }
}
