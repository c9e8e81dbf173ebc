//! The links of a model: the robot's, its camera's and its board's.

use std::collections::HashSet;
use std::f64::consts::PI;

use nalgebra::{Unit, Vector3};

use super::setup::Setup;
use crate::export::error::ExportError;
use crate::robot::{Body, JointKind, Limits, Motion, PointMass, Tree};
use crate::spatial::Pose;

/// The link of the camera's frame C where the robot has none: ROS's name for a frame with z forward, x right and y down.
const CAMERA: &str = "camera_optical_frame";
/// The link of the board's frame T.
const BOARD: &str = "board";
/// Names of the links that problems attach for the camera's housing and the board.
const HOUSING: &str = "camera";

/// Least size of a link name's ending that counts: `shoulder` becomes `shoulder_link`.
const ENDING: &str = "_link";

/// A robot as a tree of links and joints that have names of their own.
///
/// Link names differ from each other and from joint names, because SDF has one space of names for both; joints have the names that the
/// robot's driver knows.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::export) struct Assembly<'a> {
    /// The links, every parent before its children: those of the robot's tree by their numbers there, then what had no link.
    pub(in crate::export) links: Vec<ModelLink<'a>>,
    /// The link whose frame is C.
    pub(in crate::export) camera: usize,
    /// The link whose frame is T.
    pub(in crate::export) board: usize,
}

/// A rigid link, and the joint by which it hangs on its parent.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::export) struct ModelLink<'a> {
    /// Its name.
    pub(in crate::export) name: String,
    /// Number of the parent; none for the root.
    pub(in crate::export) parent: Option<usize>,
    /// Name of the joint; empty for the root.
    pub(in crate::export) joint: String,
    /// Pose of the joint's frame in the parent's; the link's frame is the joint's, moved.
    pub(in crate::export) X_PJ: Pose,
    /// How it moves.
    pub(in crate::export) movement: Movement,
    /// Its solids.
    pub(super) bodies: &'a [Body],
    /// Its mass, where known.
    pub(super) mass: Option<PointMass>,
}

/// How a link moves in the frame of its joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::export) enum Movement {
    /// Not at all.
    Fixed,
    /// With the arm's joint of that number itself.
    Leads {
        /// Number of the joint.
        joint: usize,
        /// How.
        kind: JointKind,
        /// About or along what, in the joint's frame.
        axis: Unit<Vector3<f64>>,
    },
    /// By `multiplier · q + offset` (rad or m), where q is the value of the arm's joint of that number.
    Follows {
        /// Number of the joint that it follows.
        joint: usize,
        /// How.
        kind: JointKind,
        /// About or along what, in the joint's frame.
        axis: Unit<Vector3<f64>>,
        /// Factor of the joint's value.
        multiplier: f64,
        /// Value at q = 0.
        offset: f64,
    },
}

/// What a simulator wants to know of a link's mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inertia {
    /// Mass, kg.
    pub(super) mass: f64,
    /// Its centre in the link's frame, m.
    pub(super) center: Vector3<f64>,
    /// Its moment of inertia about every axis through the centre, kg m².
    pub(super) moment: f64,
}

/// Density in kg/m³ of the ball whose inertia a mass at a point is given: water's.
const DENSITY: f64 = 1000.0;

/// What stands for a mass that is not known: simulators take none of nothing, or think of a kilogram.
const UNKNOWN: Inertia = Inertia { mass: 1e-3, center: Vector3::new(0.0, 0.0, 0.0), moment: 1e-6 };

impl<'a> Assembly<'a> {
    /// The links of `setup`; none has a name of `reserved`, which the format keeps for itself.
    ///
    /// # Errors
    /// When a joint drives no link by its own value.
    pub(in crate::export) fn new(setup: &Setup<'a>, reserved: &[&str]) -> Result<Self, ExportError> {
        let Tree { links: own, .. } = &setup.robot.tree;
        let joints = setup.program.joints;
        let mut taken: HashSet<String> = joints.iter().map(|joint| joint.name.clone()).collect();
        taken.extend(reserved.iter().map(|&name| name.to_owned()));
        let mut leaders = vec![None; joints.len()];
        let mut links: Vec<ModelLink> = Vec::with_capacity(own.len() + 2);
        for (number, link) in own.iter().enumerate() {
            let (X_PJ, movement) = moved(&link.X_PJ, &link.motion, number, &mut leaders);
            let (bodies, mass) = (link.bodies.as_slice(), link.mass.filter(|point| point.mass > 0.0));
            let name = free(&link.name, &mut taken);
            links.push(ModelLink { name, parent: link.parent, joint: String::new(), X_PJ, movement, bodies, mass });
        }
        if let Some(joint) = leaders.iter().position(Option::is_none) {
            return Err(ExportError::NoLeader { joint: joints[joint].name.clone() });
        }
        let mut place = |name: &str, attached: Option<usize>, carrier: usize, X_PJ: Pose| {
            attached.unwrap_or_else(|| {
                let name = free(name, &mut taken);
                let (joint, movement) = (String::new(), Movement::Fixed);
                links.push(ModelLink { name, parent: Some(carrier), joint, X_PJ, movement, bodies: &[], mass: None });
                links.len() - 1
            })
        };
        let robot = setup.robot;
        // A link that lies there already, the one that carries it or the solid attached for it, need not be told twice.
        let is_there = |link: usize, name: &str, carrier: usize, X_PJ: &Pose| {
            own[link].name == name && own[link].parent == Some(carrier) && own[link].X_PJ == *X_PJ
        };
        let attached = |name: &str, carrier: usize, X_PJ: &Pose| {
            (0..own.len()).rev().find(|&link| own[link].motion == Motion::Fixed && is_there(link, name, carrier, X_PJ))
        };
        let (carrier, X_FC) = (robot.camera_link, robot.X_FC);
        let there = (X_FC == Pose::identity()).then_some(carrier);
        let camera = place(CAMERA, there.or_else(|| attached(HOUSING, carrier, &X_FC)), carrier, X_FC);
        let (carrier, X_BT) = (robot.board_link, setup.target.X_BT);
        let board = place(BOARD, attached(BOARD, carrier, &X_BT), carrier, X_BT);
        for link in links.iter_mut().skip(1) {
            link.joint = match link.movement {
                Movement::Leads { joint, .. } => joints[joint].name.clone(),
                Movement::Fixed | Movement::Follows { .. } => free(&format!("{}_joint", link.name), &mut taken),
            };
        }
        Ok(Self { links, camera, board })
    }

    /// Numbers of the links that hang on link `parent`.
    pub(super) fn children(&self, parent: usize) -> impl Iterator<Item = usize> {
        (0..self.links.len()).filter(move |&link| self.links[link].parent == Some(parent))
    }

    /// Numbers of the moving links from the root on, each branch to its end before the next: the order of MJCF's joint values.
    pub(super) fn moving(&self) -> Vec<usize> {
        let mut order = Vec::new();
        let mut waiting = vec![0];
        while let Some(link) = waiting.pop() {
            if self.links[link].movement != Movement::Fixed {
                order.push(link);
            }
            let children: Vec<usize> = self.children(link).collect();
            waiting.extend(children.into_iter().rev());
        }
        order
    }
}

impl ModelLink<'_> {
    /// Its mass with the inertia of a ball of water, or a gram where none is known.
    pub(super) fn inertia(&self) -> Inertia {
        self.mass.map_or(UNKNOWN, |PointMass { mass, center }| {
            let radius = (0.75 * mass / (PI * DENSITY)).cbrt();
            Inertia { mass, center: center.coords, moment: 0.4 * mass * radius * radius }
        })
    }

    /// Pose of the link in the frame of its parent at joint values `q` (rad or m).
    pub(in crate::export) fn pose(&self, q: &[f64]) -> Pose {
        self.X_PJ * self.movement.motion().pose(q)
    }
}

impl Movement {
    /// As the robot's tree has it.
    fn motion(self) -> Motion {
        match self {
            Self::Fixed => Motion::Fixed,
            Self::Leads { joint, kind, axis } => Motion::Driven { joint, kind, axis, multiplier: 1.0, offset: 0.0 },
            Self::Follows { joint, kind, axis, multiplier, offset } => {
                Motion::Driven { joint, kind, axis, multiplier, offset }
            }
        }
    }

    /// The joint's value at joint values `q`; 0 for a fixed one.
    pub(super) fn value(self, q: &[f64]) -> f64 {
        match self {
            Self::Fixed => 0.0,
            Self::Leads { joint, .. } => q[joint],
            Self::Follows { joint, multiplier, offset, .. } => multiplier * q[joint] + offset,
        }
    }

    /// How much its value changes with that of the joint.
    pub(super) fn rate(self) -> f64 {
        match self {
            Self::Fixed => 0.0,
            Self::Leads { .. } => 1.0,
            Self::Follows { multiplier, .. } => multiplier,
        }
    }

    /// The range of the joint's value, with those of the arm's joints.
    pub(super) fn range(self, limits: impl Fn(usize) -> Limits) -> Limits {
        match self {
            Self::Fixed => Limits { min: 0.0, max: 0.0 },
            Self::Leads { joint, .. } => limits(joint),
            Self::Follows { joint, multiplier, offset, .. } => {
                let Limits { min, max } = limits(joint);
                let (a, b) = (multiplier * min + offset, multiplier * max + offset);
                Limits { min: a.min(b), max: a.max(b) }
            }
        }
    }
}

/// Where the joint's frame is and how the link moves in it. The first link that moves by a joint's value itself, but for its sign and a
/// constant, leads: the sign goes to the axis and the constant to the frame.
fn moved(X_PJ: &Pose, motion: &Motion, link: usize, leaders: &mut [Option<usize>]) -> (Pose, Movement) {
    let Motion::Driven { joint, kind, axis, multiplier, offset } = *motion else { return (*X_PJ, Movement::Fixed) };
    if leaders[joint].is_some() || multiplier.abs() != 1.0 {
        return (*X_PJ, Movement::Follows { joint, kind, axis, multiplier, offset });
    }
    leaders[joint] = Some(link);
    let constant = Motion::Driven { joint: 0, kind, axis, multiplier: 1.0, offset };
    let X_PJ = if offset == 0.0 { *X_PJ } else { X_PJ * constant.pose(&[0.0]) };
    let axis = if multiplier < 0.0 { -axis } else { axis };
    (X_PJ, Movement::Leads { joint, kind, axis })
}

/// The name nearest to `wish` that is not taken, without what paths of names are made of: letters, digits and `_`, `-`, `.`, `/` alone.
fn free(wish: &str, taken: &mut HashSet<String>) -> String {
    let kept = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '/');
    let legal: String = wish.trim().chars().map(|c| if kept(c) { c } else { '_' }).collect();
    let legal = if legal.is_empty() { "link".to_owned() } else { legal };
    let mut name = legal.clone();
    let mut nth = 0;
    while !taken.insert(name.clone()) {
        nth += 1;
        name = if nth == 1 { format!("{legal}{ENDING}") } else { format!("{legal}{ENDING}_{nth}") };
    }
    name
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::export::model::example::Example;

    #[test]
    fn links_joints_camera_and_board_have_names_of_their_own() {
        let example = Example::new();
        let program = example.program();
        let assembly = Assembly::new(&example.setup(&program), &["world"]).unwrap();
        let names: Vec<(&str, &str)> =
            assembly.links.iter().map(|link| (link.name.as_str(), link.joint.as_str())).collect();
        assert_eq!(
            names,
            [
                ("world_link", ""),
                ("lift_link", "lift"),
                ("arm", "shoulder"),
                ("finger", "finger_joint"),
                ("camera", "camera_joint"),
                ("board", "board_joint"),
            ]
        );
        assert_eq!((assembly.camera, assembly.board), (4, 5));
        assert_eq!(assembly.moving(), [1, 2, 3]);
    }

    #[test]
    fn links_are_where_the_robot_has_them() {
        let example = Example::new();
        let program = example.program();
        let assembly = Assembly::new(&example.setup(&program), &[]).unwrap();
        let q = [0.2, 0.7];
        let expected = example.robot.tree.link_poses(&q);
        let mut poses: Vec<Pose> = Vec::new();
        for link in &assembly.links {
            poses.push(link.parent.map_or_else(Pose::identity, |parent| poses[parent]) * link.pose(&q));
        }
        for (found, expected) in poses.iter().zip(expected) {
            assert!((found.to_homogeneous() - expected.to_homogeneous()).norm() < 1e-15);
        }
        let X_BC = example.robot.camera_pose(&q);
        assert!((poses[assembly.camera].to_homogeneous() - X_BC.to_homogeneous()).norm() < 1e-15);
    }

    #[test]
    fn a_joint_that_only_others_at_another_rate_follow_is_refused() {
        let mut example = Example::new();
        for link in &mut example.robot.tree.links {
            if let Motion::Driven { joint: 1, multiplier, .. } = &mut link.motion {
                *multiplier = 0.5;
            }
        }
        let program = example.program();
        let error = Assembly::new(&example.setup(&program), &[]).unwrap_err();
        assert_eq!(error.to_string(), "no link moves by the value of joint \"shoulder\" itself; models need one");
    }

    #[test]
    fn a_mass_has_the_inertia_of_a_ball_of_water() {
        let mut example = Example::new();
        // A kilogram is a ball of 62 mm radius.
        example.robot.tree.links[2].mass = Some(PointMass { mass: 1.0, center: Point3::new(0.1, 0.2, 0.3) });
        example.robot.tree.links[3].mass = Some(PointMass { mass: 0.0, center: Point3::origin() });
        let program = example.program();
        let assembly = Assembly::new(&example.setup(&program), &[]).unwrap();
        let Inertia { mass, center, moment } = assembly.links[2].inertia();
        assert_eq!((mass, center), (1.0, Vector3::new(0.1, 0.2, 0.3)));
        assert!((moment - 0.4 * 0.062_035_049_f64.powi(2)).abs() < 1e-9);
        assert_eq!(assembly.links[3].inertia(), UNKNOWN);
    }

    #[test]
    fn names_keep_to_letters_digits_and_few_marks() {
        let mut taken = HashSet::from(["waist".to_owned()]);
        let wishes = ["waist axis", "waist", "waist", "a::b", "日本", " "];
        let expected = ["waist_axis", "waist_link", "waist_link_2", "a__b", "日本", "link"];
        assert_eq!(wishes.map(|wish| free(wish, &mut taken)), expected);
    }
}
