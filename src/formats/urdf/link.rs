//! What a link is made of: its bodies and its mass.

use nalgebra::{Point3, Vector3};

use super::element::Element;
use super::error::{UrdfError, UrdfFault};
use super::mesh_folders::MeshFolders;
use crate::formats::mesh::read_mesh;
use crate::robot::{Body, PointMass, Shape};

/// The solids of the `<collision>` elements.
pub(super) fn bodies(link: Element<'_>, folders: &MeshFolders) -> Result<Vec<Body>, UrdfError> {
    let body = |collision: Element<'_>| {
        let X_LG = collision.origin()?;
        let shape = shape(collision.required_child("geometry")?, folders)?;
        Ok(Body { X_LG, shape })
    };
    link.all("collision").map(body).collect()
}

/// Mass and centre of the `<inertial>` element, if there is one.
pub(super) fn mass(link: Element<'_>) -> Result<Option<PointMass>, UrdfError> {
    let Some(inertial) = link.child("inertial") else { return Ok(None) };
    let element = inertial.required_child("mass")?;
    element.required("value")?;
    let mass = element.number("value")?.unwrap_or_default();
    if mass < 0.0 {
        return Err(element.error(UrdfFault::Negative { what: "the mass", value: mass }));
    }
    Ok(Some(PointMass { mass, center: inertial.origin()? * Point3::origin() }))
}

fn shape(geometry: Element<'_>, folders: &MeshFolders) -> Result<Shape, UrdfError> {
    let shapes: Vec<Element> = geometry.children().collect();
    let found = || match &shapes[..] {
        [] => "none".into(),
        _ => shapes.iter().map(|shape| format!("<{}>", shape.tag())).collect::<Vec<_>>().join(" "),
    };
    let [shape] = shapes[..] else {
        return Err(geometry.error(UrdfFault::Geometry { found: found() }));
    };
    let radius = || shape.sizes("radius").map(|[radius]| radius);
    let length = || shape.sizes("length").map(|[length]| length);
    match shape.tag() {
        "box" => {
            let sides: [f64; 3] = shape.sizes("size")?;
            Ok(Shape::Box { half_extents: Vector3::from(sides) / 2.0 })
        }
        "cylinder" => Ok(Shape::Cylinder { radius: radius()?, length: length()? }),
        "sphere" => Ok(Shape::Sphere { radius: radius()? }),
        "capsule" => Ok(Shape::Capsule { radius: radius()?, length: length()? }),
        "mesh" => mesh(shape, folders),
        _ => Err(geometry.error(UrdfFault::Geometry { found: found() })),
    }
}

/// The convex hull of a mesh, scaled.
fn mesh(mesh: Element<'_>, folders: &MeshFolders) -> Result<Shape, UrdfError> {
    let filename = mesh.required("filename")?;
    let scale: [f64; 3] = mesh.numbers("scale")?.unwrap_or([1.0; 3]);
    if scale.contains(&0.0) {
        return Err(mesh.error(UrdfFault::ZeroScale { scale }));
    }
    let path = folders.resolve(filename).map_err(|fault| mesh.error(fault))?;
    let points = read_mesh(&path)
        .map_err(|error| mesh.error(UrdfFault::Mesh { filename: filename.into(), error }))?
        .into_iter()
        .map(|point| Point3::from(point.coords.component_mul(&Vector3::from(scale))));
    Ok(Shape::Convex { points: points.collect() })
}
