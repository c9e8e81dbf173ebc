//! What a link is made of: its bodies and its mass.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::PathBuf;

use nalgebra::{Point3, Vector3};

use super::element::Element;
use super::error::{UrdfError, UrdfFault};
use super::mesh_folders::MeshFolders;
use super::note::{UrdfNote, UrdfRemark};
use crate::formats::mesh::read_mesh;
use crate::robot::{Body, PointMass, Shape};

/// The solids of the `<collision>` elements; shapes without extent are left out, and noted.
pub(super) fn bodies(
    link: Element<'_>,
    meshes: &mut Meshes,
    notes: &mut Vec<UrdfNote>,
) -> Result<Vec<Body>, UrdfError> {
    let mut bodies = Vec::new();
    for collision in link.all("collision") {
        let X_LG = collision.origin()?;
        let geometry = collision.child("geometry");
        let Some(geometry) = geometry.filter(|geometry| geometry.children().next().is_some()) else {
            notes.push(collision.note(UrdfRemark::EmptyCollision));
            continue;
        };
        match shape(geometry, meshes)? {
            Geometry::Solid(shape) => bodies.push(Body { X_LG, shape }),
            Geometry::Point { shape } => notes.push(collision.note(UrdfRemark::EmptyShape { shape })),
        }
    }
    Ok(bodies)
}

/// What a `<geometry>` holds.
enum Geometry {
    Solid(Shape),
    /// All its sizes are 0.
    Point {
        /// Its tag.
        shape: String,
    },
}

/// Mass and centre of the `<inertial>` element, if there is one.
pub(super) fn mass(link: Element<'_>) -> Result<Option<PointMass>, UrdfError> {
    let Some(inertial) = link.child("inertial") else { return Ok(None) };
    let element = inertial.required_child("mass")?;
    element.required("value")?;
    let mass = element.number("value")?.unwrap_or_default();
    if mass < 0.0 {
        return Err(element.error(UrdfFault::Negative { what: "mass", value: mass }));
    }
    Ok(Some(PointMass { mass, center: inertial.origin()? * Point3::origin() }))
}

fn shape(geometry: Element<'_>, meshes: &mut Meshes) -> Result<Geometry, UrdfError> {
    let shapes: Vec<Element> = geometry.children().collect();
    let found = || shapes.iter().map(|shape| format!("<{}>", shape.tag())).collect::<Vec<_>>().join(" ");
    let [shape] = shapes[..] else {
        return Err(geometry.error(UrdfFault::Geometry { found: found() }));
    };
    let radius = || shape.sizes("radius").map(|[radius]| radius);
    let length = || shape.sizes("length").map(|[length]| length);
    // Plates and rods without thickness stay: others can touch them.
    let (solid, greatest) = match shape.tag() {
        "box" => {
            let sides: [f64; 3] = shape.sizes("size")?;
            let half_extents = Vector3::from(sides) / 2.0;
            (Shape::Box { half_extents }, half_extents.max())
        }
        "cylinder" => {
            let (radius, length) = (radius()?, length()?);
            (Shape::Cylinder { radius, length }, radius.max(length))
        }
        "sphere" => {
            let radius = radius()?;
            (Shape::Sphere { radius }, radius)
        }
        "capsule" => {
            let (radius, length) = (radius()?, length()?);
            (Shape::Capsule { radius, length }, radius.max(length))
        }
        "mesh" => return Ok(Geometry::Solid(mesh(shape, meshes)?)),
        _ => return Err(geometry.error(UrdfFault::Geometry { found: found() })),
    };
    Ok(if greatest > 0.0 { Geometry::Solid(solid) } else { Geometry::Point { shape: shape.tag().into() } })
}

/// The convex hull of a mesh, scaled.
fn mesh(mesh: Element<'_>, meshes: &mut Meshes) -> Result<Shape, UrdfError> {
    let filename = mesh.required("filename")?;
    let scale: [f64; 3] = mesh.numbers("scale")?.unwrap_or([1.0; 3]);
    if scale.contains(&0.0) {
        return Err(mesh.error(UrdfFault::ZeroScale { scale }));
    }
    let vertices = meshes.vertices(filename).map_err(|fault| mesh.error(fault))?;
    let scaled = |point: &Point3<f64>| Point3::from(point.coords.component_mul(&Vector3::from(scale)));
    Ok(Shape::Convex { points: vertices.iter().map(scaled).collect(), margin: 0.0 })
}

/// The meshes of a description, each read once.
pub(super) struct Meshes {
    folders: MeshFolders,
    read: HashMap<PathBuf, Vec<Point3<f64>>>,
}

impl Meshes {
    pub(super) fn new(folders: MeshFolders) -> Self {
        Self { folders, read: HashMap::new() }
    }

    /// The vertices of the mesh that `filename` means.
    fn vertices(&mut self, filename: &str) -> Result<&[Point3<f64>], UrdfFault> {
        let path = self.folders.resolve(filename)?;
        match self.read.entry(path) {
            Entry::Occupied(known) => Ok(known.into_mut()),
            Entry::Vacant(new) => {
                let vertices = read_mesh(new.key());
                Ok(new.insert(vertices.map_err(|error| UrdfFault::Mesh { filename: filename.into(), error })?))
            }
        }
    }
}
