//! The nominal camera.

use nalgebra::Vector2;

use super::Check;
use crate::camera::{Camera, Lens};
use crate::problem::document::KeyPath;
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;

/// Image sides in px.
const IMAGE_SIDE: Allowed = Allowed::between(1.0, 100_000.0);
/// Focal lengths in px.
const FOCAL_LENGTH: Allowed = Allowed::positive(1e6);
/// Distortion coefficients.
const COEFFICIENT: Allowed = Allowed::between(-1e6, 1e6);

impl Check<'_, '_> {
    /// The camera, or none if something is wrong with it.
    pub(super) fn camera(&mut self, camera: &schema::Camera) -> Option<Camera> {
        let faults = self.faults.len();
        let at = KeyPath::section("camera");
        let width = self.number(&at.key("width_px"), f64::from(camera.width_px), IMAGE_SIDE);
        let height = self.number(&at.key("height_px"), f64::from(camera.height_px), IMAGE_SIDE);
        let fx = self.number(&at.key("fx_px"), camera.fx_px, FOCAL_LENGTH);
        let fy = camera.fy_px.map_or(fx, |fy| self.number(&at.key("fy_px"), fy, FOCAL_LENGTH));
        let cx = self.principal_point(&at.key("cx_px"), camera.cx_px, width);
        let cy = self.principal_point(&at.key("cy_px"), camera.cy_px, height);
        let lens = camera.distortion.model.0;
        let mut θ = vec![fx, fy, cx, cy];
        θ.extend(self.coefficients(&at.key("distortion"), &camera.distortion, lens));
        if self.faults.len() > faults {
            return None;
        }
        // What Camera::new refuses has been refused above, with its place in the file.
        let model = Camera::new(lens, camera.width_px, camera.height_px, &θ).ok()?;
        let border = [(0.0, cy), (width - 1.0, cy), (cx, 0.0), (cx, height - 1.0)];
        if let Some((u, v)) = border.into_iter().find(|&(u, v)| model.unproject(&Vector2::new(u, v)).is_none()) {
            self.fault(&at.key("distortion"), Reason::FoldsBack { pixel: [u, v] });
            return None;
        }
        Some(model)
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
