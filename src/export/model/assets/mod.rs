//! Files that models name: the hulls of meshes, and the board's plate with its picture.

mod hull;
mod mesh;
mod plate;

use std::collections::BTreeMap;

use super::assembly::Assembly;
use super::setup::Setup;
use crate::export::ExportFile;
use crate::export::text::file_name;
use crate::robot::Shape;

use hull::hull;
use plate::plate;

/// The files beside a model.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Assets {
    /// The files.
    pub(super) files: Vec<ExportFile>,
    /// Names of the hulls' files, by link and body.
    hulls: BTreeMap<[usize; 2], String>,
    /// Name of the plate's file.
    pub(super) plate: String,
    /// Name of its picture's, where the board's pattern is known.
    pub(super) picture: Option<String>,
    /// How far a solid of the problem reaches beyond its hull at most, m.
    pub(super) margin: f64,
}

impl Assets {
    /// Those of a model.
    pub(super) fn new(setup: &Setup, assembly: &Assembly) -> Self {
        let name = setup.program.name;
        let plate = plate(setup.target, name);
        let mut files = plate.files;
        let (mut hulls, mut margin) = (BTreeMap::new(), 0.0_f64);
        for (i, link) in assembly.links.iter().enumerate() {
            for (j, body) in link.bodies.iter().enumerate() {
                let Shape::Convex { points, margin: beyond } = &body.shape else { continue };
                let Some(mesh) = hull(points) else { continue };
                let file = file_name(name, &format!("hull-{}.obj", hulls.len() + 1));
                files.push(ExportFile { name: file.clone(), bytes: mesh.obj(None).into_bytes() });
                hulls.insert([i, j], file);
                margin = margin.max(*beyond);
            }
        }
        Self { files, hulls, plate: plate.mesh, picture: plate.picture, margin }
    }

    /// Name of the file of the hull that is body `body` of link `link`; none of one without points.
    pub(super) fn hull(&self, link: usize, body: usize) -> Option<&str> {
        self.hulls.get(&[link, body]).map(String::as_str)
    }

    /// Names of the hulls' files.
    pub(super) fn hulls(&self) -> impl Iterator<Item = &str> {
        self.hulls.values().map(String::as_str)
    }

    /// What the model says of its hulls, where it has any.
    pub(super) fn note(&self) -> Option<String> {
        (!self.hulls.is_empty()).then(|| {
            format!(
                "Meshes are the convex hulls that are tested for collision; the solids tested reach at most {:.3} mm beyond.",
                1e3 * self.margin
            )
        })
    }
}
