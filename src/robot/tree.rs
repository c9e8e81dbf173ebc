//! The whole robot as a tree of rigid links: where each link is, and where the centre of mass.

use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};

use super::joint::JointKind;
use crate::spatial::Pose;

/// Links of a robot, every parent before its children; link 0 is the root, whose frame is the base frame B.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tree {
    /// The links.
    pub links: Vec<Link>,
    /// Pairs of links that are never tested for collision.
    pub disabled: Vec<[usize; 2]>,
}

/// A rigid link and how it hangs on its parent.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Name.
    pub name: String,
    /// Index of the parent; none for the root.
    pub parent: Option<usize>,
    /// Fixed pose of the joint frame in the parent's frame; the link's frame is the joint frame, moved.
    pub X_PJ: Pose,
    /// How the link moves against its parent.
    pub motion: Motion,
    /// The solids that must not touch others, hide the target or be hit.
    pub bodies: Vec<Body>,
    /// Mass and its centre, where known.
    pub mass: Option<PointMass>,
}

/// How a link moves against its parent.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// With joint `joint` of the arm: about or along `axis` by `multiplier · q[joint] + offset` (rad or m). A joint that
    /// mimics another has that one's number.
    Driven {
        /// Index into the joint values q.
        joint: usize,
        /// How.
        kind: JointKind,
        /// Axis in the joint frame.
        axis: Unit<Vector3<f64>>,
        /// Factor of the joint value.
        multiplier: f64,
        /// Value at q = 0.
        offset: f64,
    },
}

/// A solid, rigidly attached to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Pose of the solid in the link's frame.
    pub X_LG: Pose,
    /// Its shape.
    pub shape: Shape,
}

/// The shape of a solid, in m, about the origin of its frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A cuboid.
    Box {
        /// Half of each side.
        half_extents: Vector3<f64>,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Length along z.
        length: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A cylinder along z with a half sphere on either end.
    Capsule {
        /// Radius.
        radius: f64,
        /// Length of the cylinder, without the half spheres.
        length: f64,
    },
    /// The convex hull of points, and all within a margin of it.
    Convex {
        /// The points.
        points: Vec<Point3<f64>>,
        /// The margin; 0 for the hull itself.
        margin: f64,
    },
}

/// A mass at its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointMass {
    /// Mass in kg.
    pub mass: f64,
    /// Centre of mass in the link's frame.
    pub center: Point3<f64>,
}

impl Link {
    /// A link rigidly on its parent at `X_PJ`, without bodies and mass.
    pub(super) fn fixed(name: &str, parent: Option<usize>, X_PJ: Pose) -> Self {
        Self { name: name.to_owned(), parent, X_PJ, motion: Motion::Fixed, bodies: Vec::new(), mass: None }
    }
}

impl Motion {
    /// The motion that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        match *self {
            Motion::Fixed => Motion::Fixed,
            Motion::Driven { joint, kind, axis, multiplier, offset } => {
                Motion::Driven { joint, kind, axis, multiplier: -multiplier, offset: -offset }
            }
        }
    }

    /// The pose of the moved joint frame in the joint frame.
    pub fn pose(&self, q: &[f64]) -> Pose {
        match *self {
            Motion::Fixed => Pose::identity(),
            Motion::Driven { joint, kind, axis, multiplier, offset } => {
                let value = multiplier * q[joint] + offset;
                match kind {
                    JointKind::Revolute => {
                        Pose::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&axis, value))
                    }
                    JointKind::Prismatic => Translation3::from(axis.into_inner() * value).into(),
                }
            }
        }
    }
}

impl Tree {
    /// Adds a link `name` with one body, fixed to link `parent` at `X_PJ`, and returns its number.
    pub fn attach(&mut self, name: &str, parent: usize, X_PJ: Pose, body: Body) -> usize {
        let motion = Motion::Fixed;
        self.links.push(Link { name: name.into(), parent: Some(parent), X_PJ, motion, bodies: vec![body], mass: None });
        self.links.len() - 1
    }

    /// The link that `link` is rigidly joined to and that itself moves, or the root.
    pub fn mover(&self, mut link: usize) -> usize {
        while let (Motion::Fixed, Some(parent)) = (&self.links[link].motion, self.links[link].parent) {
            link = parent;
        }
        link
    }

    /// Poses `X_BL` of all links at joint values `q` (rad or m).
    pub fn link_poses(&self, q: &[f64]) -> Vec<Pose> {
        let mut poses: Vec<Pose> = Vec::with_capacity(self.links.len());
        for link in &self.links {
            let X_BP = link.parent.map_or_else(Pose::identity, |parent| poses[parent]);
            poses.push(X_BP * link.X_PJ * link.motion.pose(q));
        }
        poses
    }

    /// Total mass in kg and its centre in the base frame, with the links at `X_BL`; `None` if no link has a mass.
    pub fn center_of_mass(&self, X_BL: &[Pose]) -> Option<PointMass> {
        let mut mass = 0.0;
        let mut moment = Vector3::zeros();
        for (link, X_BL) in self.links.iter().zip(X_BL) {
            if let Some(point) = link.mass {
                mass += point.mass;
                moment += (X_BL * point.center).coords * point.mass;
            }
        }
        (mass > 0.0).then(|| PointMass { mass, center: Point3::from(moment / mass) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bars in the plane: poses and centre of mass by hand.
    #[test]
    fn a_bent_arm_balances_where_it_should() {
        let bar = |name: &str, parent, x, motion, mass| Link {
            name: name.into(),
            parent,
            X_PJ: Pose::translation(x, 0.0, 0.0),
            motion,
            bodies: vec![],
            mass: Some(PointMass { mass, center: Point3::new(0.5, 0.0, 0.0) }),
        };
        let about_z = Motion::Driven {
            joint: 0,
            kind: JointKind::Revolute,
            axis: Vector3::z_axis(),
            multiplier: 2.0,
            offset: 0.0,
        };
        let links = vec![bar("base", None, 0.0, Motion::Fixed, 3.0), bar("arm", Some(0), 1.0, about_z, 1.0)];
        let tree = Tree { links, disabled: vec![] };
        let poses = tree.link_poses(&[std::f64::consts::FRAC_PI_4]);
        assert!((poses[1] * Point3::new(1.0, 0.0, 0.0) - Point3::new(1.0, 1.0, 0.0)).norm() < 1e-15);
        let center = tree.center_of_mass(&poses).unwrap();
        assert_eq!(center.mass, 4.0);
        assert!((center.center - Point3::new(0.625, 0.125, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn weightless_robots_have_no_centre() {
        assert_eq!(Tree::default().center_of_mass(&[]), None);
    }
}
