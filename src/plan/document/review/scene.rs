//! The robot, the board and what stands around them, as they are drawn.

use nalgebra::{Isometry3, Point3, Translation3, Vector2, Vector3};
use parry3d_f64::transformation::try_convex_hull;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::camera::Camera;
use crate::plan::document::plan::Pose;
use crate::print::Artwork;
use crate::problem::Problem;
use crate::robot::{Body, Joint, JointKind, Motion, Shape};
use crate::target::Board;

/// Everything that has a place in space. The frame of `base_link` is the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scene {
    /// The arm's joints.
    pub joints: Vec<SceneJoint>,
    /// All links, each after its parent; the first is the root.
    pub links: Vec<SceneLink>,
    /// The link that carries the board.
    pub base_link: usize,
    /// The link that carries the camera.
    pub camera_link: usize,
    /// The solids that poses are tested against. A mesh's is its convex hull.
    pub solids: Vec<SceneSolid>,
    /// The calibration board.
    pub board: SceneBoard,
    /// The camera.
    pub camera: SceneCamera,
    /// Up, in the base frame: the root's z.
    pub up: [f64; 3],
}

/// A joint of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneJoint {
    /// Name.
    pub name: String,
    /// `revolute` or `prismatic`.
    pub kind: String,
    /// Unit of the limits: `deg` or `mm`.
    pub unit: String,
    /// Lower limit.
    pub min: f64,
    /// Upper limit.
    pub max: f64,
}

/// A link: its frame is the parent's, moved by `origin` and then by the joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneLink {
    /// Name.
    pub name: String,
    /// Its parent; none for the root.
    pub parent: Option<usize>,
    /// Pose of the joint's frame in the parent's.
    pub origin: Pose,
    /// How it moves; `null` where it does not.
    pub motion: Option<SceneMotion>,
    /// Whether it is none of the robot's.
    pub obstacle: bool,
}

/// About or along `axis`, by `multiplier` times the joint's value plus `offset`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneMotion {
    /// Number of the joint.
    pub joint: usize,
    /// `revolute` or `prismatic`.
    pub kind: String,
    /// Axis in the joint's frame.
    pub axis: [f64; 3],
    /// Factor of the joint's value.
    pub multiplier: f64,
    /// Value at 0, rad or m.
    pub offset: f64,
}

/// A solid on a link.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneSolid {
    /// The link.
    pub link: usize,
    /// Pose in the link's frame.
    pub pose: Pose,
    /// Its shape, about the pose's origin.
    pub shape: SceneShape,
}

/// The shape of a solid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SceneShape {
    /// A cuboid.
    Box {
        /// Its sides.
        size_m: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius.
        radius_m: f64,
        /// Length.
        length_m: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius.
        radius_m: f64,
    },
    /// A cylinder along z with a half sphere on either end.
    Capsule {
        /// Radius.
        radius_m: f64,
        /// Length of the cylinder alone.
        length_m: f64,
    },
    /// Triangles.
    Mesh {
        /// x y z of each vertex.
        vertices_m: Vec<f64>,
        /// Three numbers of vertices for each, seen from outside counter-clockwise.
        triangles: Vec<u32>,
    },
}

/// The board, its middle in its frame's origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneBoard {
    /// Pose in the base frame; z points out of the printed side.
    pub pose: Pose,
    /// Width and height of what is printed.
    pub size_m: [f64; 2],
    /// Least distance of neighbouring corners.
    pub spacing_m: f64,
    /// The outlines of all that is black.
    pub pattern_m: Vec<Vec<[f64; 2]>>,
    /// Width and height of the zone that the optical axis is to meet.
    pub zone_m: [f64; 2],
}

/// The camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SceneCamera {
    /// Pose in the frame of its link: z forward, x to the right, y down in the picture.
    pub pose: Pose,
    /// Width of the picture.
    pub width_px: u32,
    /// Height of the picture.
    pub height_px: u32,
    /// The picture's border as directions (x, y, 1), clockwise as seen by the camera; without those that no such direction has.
    pub outline: Vec<[f64; 2]>,
}

impl Scene {
    /// Points of the outline of a lens that sees less than 90° off its axis.
    pub(crate) const OUTLINE_POINTS: usize = 4 * OUTLINE as usize;

    pub(crate) fn new(problem: &Problem) -> Self {
        let Problem { robot, camera, target, .. } = problem;
        let rest: Vec<f64> =
            robot.chain.joints.iter().map(|joint| 0f64.clamp(joint.limits.min, joint.limits.max)).collect();
        let links = &robot.tree.links;
        let solids = links.iter().enumerate().flat_map(|(link, of)| {
            of.bodies.iter().filter_map(move |Body { X_LG, shape }| {
                Some(SceneSolid { link, pose: Pose::new(X_LG), shape: SceneShape::new(shape)? })
            })
        });
        Self {
            joints: robot.chain.joints.iter().map(SceneJoint::new).collect(),
            links: links
                .iter()
                .enumerate()
                .map(|(i, link)| SceneLink {
                    name: link.name.clone(),
                    parent: link.parent,
                    origin: Pose::new(&link.X_PJ),
                    motion: SceneMotion::new(&link.motion),
                    obstacle: robot.obstacles.contains(&i),
                })
                .collect(),
            base_link: robot.board_link,
            camera_link: robot.camera_link,
            solids: solids.collect(),
            board: SceneBoard {
                pose: Pose::new(&target.X_BT),
                size_m: target.board.printed_size().into(),
                spacing_m: target.board.spacing(),
                pattern_m: pattern(&target.board),
                zone_m: [target.zone.width, target.zone.height],
            },
            camera: SceneCamera {
                pose: Pose::new(&robot.X_FC),
                width_px: camera.width(),
                height_px: camera.height(),
                outline: outline(camera),
            },
            up: (robot.link_poses(&rest)[0].rotation * Vector3::z()).into(),
        }
    }

    /// Poses of all links in the base frame at joint values `q` (rad or m, one for each joint); `None` where they are of another
    /// number, or a link names what is not there.
    pub fn link_poses(&self, q: &[f64]) -> Option<Vec<Isometry3<f64>>> {
        if q.len() != self.joints.len() {
            return None;
        }
        let mut poses: Vec<Isometry3<f64>> = Vec::with_capacity(self.links.len());
        for SceneLink { parent, origin, motion, .. } in &self.links {
            let X_RP = parent.map_or(Some(Isometry3::identity()), |parent| poses.get(parent).copied())?;
            let moved = match motion {
                None => Isometry3::identity(),
                Some(SceneMotion { joint, kind, axis, multiplier, offset }) => {
                    let along = Vector3::from(*axis) * (multiplier * q.get(*joint)? + offset);
                    if kind == "prismatic" { Translation3::from(along).into() } else { Isometry3::rotation(along) }
                }
            };
            poses.push(X_RP * origin.transform() * moved);
        }
        let X_BR = poses.get(self.base_link)?.inverse();
        Some(poses.iter().map(|X_RL| X_BR * X_RL).collect())
    }
}

impl SceneJoint {
    fn new(joint: &Joint) -> Self {
        Self {
            name: joint.name.clone(),
            kind: kind(joint.kind).into(),
            unit: joint.kind.display_unit().into(),
            min: joint.kind.to_display(joint.limits.min),
            max: joint.kind.to_display(joint.limits.max),
        }
    }
}

impl SceneMotion {
    fn new(motion: &Motion) -> Option<Self> {
        let &Motion::Driven { joint, kind: moves, axis, multiplier, offset } = motion else { return None };
        Some(Self { joint, kind: kind(moves).into(), axis: axis.into_inner().into(), multiplier, offset })
    }
}

impl SceneShape {
    /// `None` for points that have no hull.
    fn new(shape: &Shape) -> Option<Self> {
        Some(match *shape {
            Shape::Box { half_extents } => Self::Box { size_m: (2.0 * half_extents).into() },
            Shape::Cylinder { radius, length } => Self::Cylinder { radius_m: radius, length_m: length },
            Shape::Sphere { radius } => Self::Sphere { radius_m: radius },
            Shape::Capsule { radius, length } => Self::Capsule { radius_m: radius, length_m: length },
            Shape::Convex { ref points, .. } => {
                let (vertices, triangles) = try_convex_hull(points).ok()?;
                let vertices_m = vertices.iter().flat_map(|p: &Point3<f64>| [p.x, p.y, p.z]).collect();
                Self::Mesh { vertices_m, triangles: triangles.concat() }
            }
        })
    }
}

/// The outlines of what is black on a board, m; none where there is no telling what is printed.
fn pattern(board: &Board) -> Vec<Vec<[f64; 2]>> {
    Artwork::new(board).map_or(Vec::new(), |artwork| artwork.outlines())
}

fn kind(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
    }
}

/// Points of the border for each side.
const OUTLINE: u32 = 8;

fn outline(camera: &Camera) -> Vec<[f64; 2]> {
    let (right, bottom) = (f64::from(camera.width()) - 0.5, f64::from(camera.height()) - 0.5);
    let corners = [(-0.5, -0.5), (right, -0.5), (right, bottom), (-0.5, bottom)].map(|(u, v)| Vector2::new(u, v));
    let border = (0..4 * OUTLINE).map(|i| {
        let (side, along) = ((i / OUTLINE) as usize, f64::from(i % OUTLINE) / f64::from(OUTLINE));
        corners[side].lerp(&corners[(side + 1) % 4], along)
    });
    let ray = |pixel: Vector2<f64>| camera.unproject(&pixel).filter(|ray| ray.z > 0.0);
    border.filter_map(ray).map(|ray| [ray.x / ray.z, ray.y / ray.z]).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::problem::Problem;

    /// The document tells where every link is as the robot does, boards on links that move among them.
    #[test]
    fn links_are_where_the_robot_has_them() {
        for name in ["servosila-engineer", "servosila-engineer-bodies", "six-axis-rover", "seven-axis-carrier"] {
            let problem = Problem::read(&Path::new("problems").join(format!("{name}.toml"))).unwrap();
            let scene = Scene::new(&problem);
            let joints = &problem.robot.chain.joints;
            for share in [0.1, 0.45, 0.8] {
                let q: Vec<f64> = joints.iter().map(|j| j.limits.min + share * (j.limits.max - j.limits.min)).collect();
                let drawn = scene.link_poses(&q).unwrap();
                for (X, expected) in drawn.iter().zip(problem.robot.link_poses(&q)) {
                    assert!((X.to_homogeneous() - expected.to_homogeneous()).amax() < 1e-12, "{name}");
                }
                let X_BC = drawn[scene.camera_link] * scene.camera.pose.transform();
                let expected = problem.robot.camera_pose(&q);
                assert!((X_BC.to_homogeneous() - expected.to_homogeneous()).amax() < 1e-12, "{name}");
            }
        }
    }
}
