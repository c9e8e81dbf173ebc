//! Link poses and centres of mass of a URDF at given joint values, for comparison with other libraries.
//!
//! ```text
//! urdf_kinematics ROBOT.urdf [PACKAGE_FOLDER]... < configurations.json > poses.json
//! ```
//!
//! The input is `{"joints": [names], "configurations": [[rad or m]]}`; joints that are not named stay at 0, those that mimic follow.
//! The output has the links' names and, for each configuration, their poses in the root's frame, each as position (m) and
//! quaternion x y z w, and the centre of mass (m) with the mass (kg). `meshes` has, for each link, the bounding boxes of its
//! collision meshes in the link's frame.

#![allow(non_snake_case, clippy::print_stdout)]

use std::error::Error;
use std::io::stdin;
use std::path::{Path, PathBuf};

use calipose::formats::read_urdf_file;
use calipose::robot::{Link, Shape};
use serde::Deserialize;
use serde_json::json;

#[derive(Deserialize)]
struct Request {
    joints: Vec<String>,
    configurations: Vec<Vec<f64>>,
}

/// Least and greatest coordinates in the link's frame of each mesh.
fn mesh_bounds(link: &Link) -> Vec<[f64; 6]> {
    let mut all = Vec::new();
    for body in &link.bodies {
        let Shape::Convex { points, .. } = &body.shape else { continue };
        let mut bounds = [f64::INFINITY, f64::INFINITY, f64::INFINITY, -f64::INFINITY, -f64::INFINITY, -f64::INFINITY];
        for point in points {
            let p = body.X_LG * point;
            for i in 0..3 {
                bounds[i] = bounds[i].min(p[i]);
                bounds[i + 3] = bounds[i + 3].max(p[i]);
            }
        }
        all.push(bounds);
    }
    all
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let urdf = arguments.next().ok_or("name a URDF file")?;
    let folders: Vec<PathBuf> = arguments.map(PathBuf::from).collect();
    let mechanism = read_urdf_file(Path::new(&urdf), &folders)?.mechanism;
    let request: Request = serde_json::from_reader(stdin().lock())?;
    let place = |name: &String| mechanism.joint(name).ok_or_else(|| format!("{urdf} has no free joint {name}"));
    let places = request.joints.iter().map(place).collect::<Result<Vec<_>, _>>()?;
    let mut poses = Vec::new();
    let mut centers = Vec::new();
    for values in &request.configurations {
        let mut q = vec![0.0; mechanism.joints.len()];
        for (&place, &value) in places.iter().zip(values) {
            q[place] = value;
        }
        let X_BL = mechanism.tree.link_poses(&q);
        let center = mechanism.tree.center_of_mass(&X_BL);
        centers.push(center.map(|center| [center.center.x, center.center.y, center.center.z, center.mass]));
        let pose = |X: &calipose::spatial::Pose| {
            let (p, q) = (X.translation.vector, X.rotation.coords);
            [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
        };
        poses.push(X_BL.iter().map(pose).collect::<Vec<_>>());
    }
    let links: Vec<&str> = mechanism.tree.links.iter().map(|link| link.name.as_str()).collect();
    let joints: Vec<_> = mechanism
        .joints
        .iter()
        .map(|joint| json!({ "name": joint.name, "min": joint.limits.min, "max": joint.limits.max }))
        .collect();
    let meshes: Vec<Vec<[f64; 6]>> = mechanism.tree.links.iter().map(mesh_bounds).collect();
    println!("{}", json!({ "joints": joints, "links": links, "poses": poses, "centers": centers, "meshes": meshes }));
    Ok(())
}
