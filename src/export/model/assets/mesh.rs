//! Triangles as Wavefront OBJ.

use nalgebra::{Point2, Point3};

use crate::export::text::decimal;

/// A closed surface of triangles, counter-clockwise from outside.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mesh {
    /// Corners, m.
    pub(super) vertices: Vec<Point3<f64>>,
    /// Places in a picture, from its lower left corner (0, 0) to its upper right (1, 1).
    pub(super) places: Vec<Point2<f64>>,
    /// Triangles by their corners' numbers, each with that of its place where there are places.
    pub(super) triangles: Vec<[[usize; 2]; 3]>,
}

/// The material of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Material<'a> {
    /// File of the material.
    pub(super) file: &'a str,
    /// Its name there.
    pub(super) name: &'a str,
}

impl Mesh {
    /// The mesh as text, with a material where there is one.
    pub(super) fn obj(&self, material: Option<Material>) -> String {
        let line = |key: &str, values: &[f64]| {
            let values: String = values.iter().map(|&value| format!(" {}", decimal(value))).collect();
            format!("{key}{values}\n")
        };
        let mut text = format!("# Made by calipose {}, in metres.\n", env!("CARGO_PKG_VERSION"));
        text += &material.map_or_else(String::new, |material| format!("mtllib {}\n", material.file));
        text += &self.vertices.iter().map(|p| line("v", p.coords.as_slice())).collect::<String>();
        text += &self.places.iter().map(|p| line("vt", p.coords.as_slice())).collect::<String>();
        text += &material.map_or_else(String::new, |material| format!("usemtl {}\n", material.name));
        for triangle in &self.triangles {
            let corner = |&[vertex, place]: &[usize; 2]| {
                if self.places.is_empty() {
                    format!(" {}", vertex + 1)
                } else {
                    format!(" {}/{}", vertex + 1, place + 1)
                }
            };
            text += &format!("f{}\n", triangle.iter().map(corner).collect::<String>());
        }
        text
    }
}
