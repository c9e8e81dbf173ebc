//! From a whole robot, as a description file states it, to the arm that matters.

use super::chain::Stage;
use super::{Chain, Joint, Link, Motion, Robot, Tree};
use crate::spatial::Pose;

/// A robot as a description file states it: all its links, all its joints free.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mechanism {
    /// The links; what they move with are indices into `joints`.
    pub tree: Tree,
    /// The joints that mimic no other.
    pub joints: Vec<Joint>,
    /// Names of the joints that do.
    pub followers: Vec<String>,
}

/// What makes an arm of a mechanism. Links are indices into its tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembly {
    /// The link that stands on the ground: the root of the robot's tree.
    pub base_link: usize,
    /// The link that carries the board.
    pub board_link: usize,
    /// The link that carries the camera.
    pub camera_link: usize,
    /// Pose of the camera in the frame of its link.
    pub X_FC: Pose,
    /// For each joint of the mechanism the value (rad or m) at which it is held, if it is; else it belongs to the arm if it
    /// moves the camera against the board, and stays at the value nearest to 0 within its limits if it does not.
    pub held: Vec<Option<f64>>,
}

/// One step on the way from a link to another.
enum Step {
    /// From this link to its parent.
    Up(usize),
    /// From its parent to this link.
    Down(usize),
}

impl Mechanism {
    /// Index of the link of that name.
    pub fn link(&self, name: &str) -> Option<usize> {
        self.tree.links.iter().position(|link| link.name == name)
    }

    /// Index of the joint of that name.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// The links whose joints are on the way between two links.
    pub fn between(&self, from: usize, to: usize) -> Vec<usize> {
        let passed = |step| match step {
            Step::Up(link) | Step::Down(link) => link,
        };
        self.way(from, to).into_iter().map(passed).collect()
    }

    /// The robot whose joints move the camera against the board; the others are held. Without such joints the chain is empty.
    ///
    /// The chain runs from the board's link to the camera's; a joint that it passes from child to parent moves the other way.
    pub fn robot(&self, assembly: &Assembly) -> Robot {
        let way = self.way(assembly.board_link, assembly.camera_link);
        // The arm's joints in the order in which the way meets them, so that the first is the outermost of a sweep.
        let mut arm: Vec<usize> = Vec::new();
        for step in &way {
            let (Step::Up(link) | Step::Down(link)) = *step;
            if let Motion::Driven { joint, .. } = self.tree.links[link].motion
                && assembly.held[joint].is_none()
                && !arm.contains(&joint)
            {
                arm.push(joint);
            }
        }
        let tree = self.held(&arm, &assembly.held);
        let mut stages = Vec::new();
        let mut X_before = Pose::identity();
        for step in way {
            let (Step::Up(link) | Step::Down(link)) = step;
            let Link { X_PJ, motion, .. } = &tree.links[link];
            let (ahead, motion, behind) = match step {
                Step::Up(_) => (Pose::identity(), motion.inverse(), X_PJ.inverse()),
                Step::Down(_) => (*X_PJ, motion.clone(), Pose::identity()),
            };
            if motion == Motion::Fixed {
                X_before *= ahead * behind;
            } else {
                stages.push(Stage { X_PJ: X_before * ahead, motion });
                X_before = behind;
            }
        }
        let joints = arm.iter().map(|&joint| self.joints[joint].clone()).collect();
        let (tree, place) = rerooted(tree, assembly.base_link);
        Robot {
            chain: Chain { joints, stages, X_nF: X_before },
            X_FC: assembly.X_FC,
            tree,
            board_link: place[assembly.board_link],
            camera_link: place[assembly.camera_link],
            obstacles: Vec::new(),
        }
    }

    /// The way from link `from` up to the nearest link above both, and down to link `to`.
    fn way(&self, from: usize, to: usize) -> Vec<Step> {
        let above =
            |link: usize| std::iter::successors(Some(link), |&link| self.tree.links[link].parent).collect::<Vec<_>>();
        let (mut up, mut down) = (above(from), above(to));
        while up.len() > 1 && down.len() > 1 && up[up.len() - 2] == down[down.len() - 2] {
            up.pop();
            down.pop();
        }
        // One of the two may itself be above the other; what is left in common is the link at the top.
        up.pop();
        down.pop();
        up.into_iter().map(Step::Up).chain(down.into_iter().rev().map(Step::Down)).collect()
    }

    /// The tree with only the joints of `arm` moving, numbered in that order.
    fn held(&self, arm: &[usize], held: &[Option<f64>]) -> Tree {
        let values: Vec<f64> = self
            .joints
            .iter()
            .zip(held)
            .map(|(joint, held)| held.unwrap_or(0f64.max(joint.limits.min).min(joint.limits.max)))
            .collect();
        let mut tree = self.tree.clone();
        for link in &mut tree.links {
            let Motion::Driven { joint, .. } = &mut link.motion else { continue };
            if let Some(place) = arm.iter().position(|moving| moving == joint) {
                *joint = place;
            } else {
                link.X_PJ *= link.motion.pose(&values);
                link.motion = Motion::Fixed;
            }
        }
        tree
    }
}

/// The same links hung up at link `root`, and where each one is now.
///
/// A moving joint that is turned over gets a link of its own between its two: the motion comes first then, the fixed transform
/// after it.
fn rerooted(tree: Tree, root: usize) -> (Tree, Vec<usize>) {
    let mut place: Vec<usize> = (0..tree.links.len()).collect();
    if root == 0 {
        return (tree, place);
    }
    let mut links: Vec<Link> = Vec::with_capacity(tree.links.len());
    // The links from the new root to the old one turn over.
    let mut below: Option<&Link> = None;
    for turned in std::iter::successors(Some(root), |&link| tree.links[link].parent) {
        let link = &tree.links[turned];
        let mut hung = Link { parent: None, X_PJ: Pose::identity(), motion: Motion::Fixed, ..link.clone() };
        if let Some(below) = below {
            hung.X_PJ = below.X_PJ.inverse();
            if below.motion != Motion::Fixed {
                let name = format!("{} (joint)", below.name);
                let parent = Some(links.len() - 1);
                links.push(Link { motion: below.motion.inverse(), ..Link::fixed(&name, parent, Pose::identity()) });
            }
            hung.parent = Some(links.len() - 1);
        }
        place[turned] = links.len();
        links.push(hung);
        below = Some(link);
    }
    let turned: Vec<usize> = std::iter::successors(Some(root), |&link| tree.links[link].parent).collect();
    for (i, link) in tree.links.iter().enumerate().filter(|(i, _)| !turned.contains(i)) {
        place[i] = links.len();
        links.push(Link { parent: link.parent.map(|parent| place[parent]), ..link.clone() });
    }
    let mut disabled: Vec<[usize; 2]> = tree.disabled.iter().map(|&[a, b]| sorted(place[a], place[b])).collect();
    disabled.sort_unstable();
    (Tree { links, disabled }, place)
}

fn sorted(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::{Unit, Vector3};

    use super::*;
    use crate::robot::{JointKind, Limits};

    /// base ─j0→ lift ─j1→ shoulder ─j2→ elbow (and a finger that mimics j2), base ─j3→ tray.
    fn mechanism() -> Mechanism {
        let driven = |joint, kind, axis: [f64; 3], multiplier, offset| Motion::Driven {
            joint,
            kind,
            axis: Unit::new_normalize(Vector3::from(axis)),
            multiplier,
            offset,
        };
        let pose = |i: f64| Pose::new(Vector3::new(0.1 * i, 0.2, -0.3), Vector3::new(0.3, -0.1 * i, 0.2 * i));
        let link = |name: &str, parent, i, motion| Link { motion, ..Link::fixed(name, parent, pose(i)) };
        let revolute = JointKind::Revolute;
        let links = vec![
            Link::fixed("base", None, Pose::identity()),
            link("lift", Some(0), 1.0, driven(0, JointKind::Prismatic, [0.0, 0.3, 1.0], 1.0, 0.0)),
            link("shoulder", Some(1), 2.0, driven(1, revolute, [1.0, 0.0, 0.0], 1.0, 0.0)),
            link("elbow", Some(2), 3.0, driven(2, revolute, [0.0, 1.0, 1.0], 1.0, 0.0)),
            link("finger", Some(3), 4.0, driven(2, revolute, [0.0, 0.0, 1.0], -0.5, 0.2)),
            link("tray", Some(0), 5.0, driven(3, revolute, [0.0, 1.0, 0.0], 1.0, 0.0)),
        ];
        let joint = |name: &str, kind, min| Joint::free(name.into(), kind, Limits { min, max: PI }, None);
        let joints = vec![
            joint("j0", JointKind::Prismatic, 0.25),
            joint("j1", revolute, -PI),
            joint("j2", revolute, -PI),
            joint("j3", revolute, -PI),
        ];
        let followers = vec!["finger".into()];
        Mechanism { tree: Tree { links, disabled: vec![[0, 2], [3, 5]] }, joints, followers }
    }

    /// The whole mechanism's own kinematics, for every choice of links.
    #[test]
    fn chains_and_trees_agree_with_the_mechanism_whatever_link_is_where() {
        let mechanism = mechanism();
        let q = [0.4, -0.7, 1.1, 0.6];
        for base_link in 0..6 {
            for board_link in 0..6 {
                for camera_link in 0..6 {
                    let X_FC = Pose::translation(0.0, 0.1, 0.2);
                    let held = vec![None, Some(0.3), None, None];
                    let assembly = Assembly { base_link, board_link, camera_link, X_FC, held };
                    let robot = mechanism.robot(&assembly);
                    let own: Vec<f64> =
                        robot.chain.joints.iter().map(|joint| q[mechanism.joint(&joint.name).unwrap()]).collect();
                    // Joints off the way stay where they are held: at 0, or the limit next to it.
                    let moves = |name| robot.chain.joints.iter().any(|joint| joint.name == name);
                    let at = |i: usize, rest: f64| if moves(mechanism.joints[i].name.as_str()) { q[i] } else { rest };
                    let all = [at(0, 0.25), 0.3, at(2, 0.0), at(3, 0.0)];
                    let X_WL = mechanism.tree.link_poses(&all);
                    let close = |a: &Pose, b: &Pose| (a.to_homogeneous() - b.to_homogeneous()).norm() < 1e-13;
                    let X_BF = X_WL[board_link].inverse() * X_WL[camera_link];
                    assert!(close(&robot.camera_pose(&own), &(X_BF * X_FC)));
                    let X_BL = robot.link_poses(&own);
                    let X_RL = robot.tree.link_poses(&own);
                    assert!(close(&X_BL[robot.camera_link], &X_BF));
                    for (i, link) in mechanism.tree.links.iter().enumerate() {
                        let now = robot.tree.links.iter().position(|other| other.name == link.name).unwrap();
                        assert!(close(&X_RL[now], &(X_WL[base_link].inverse() * X_WL[i])), "{}", link.name);
                        assert!(close(&X_BL[now], &(X_WL[board_link].inverse() * X_WL[i])));
                    }
                    let mut disabled: Vec<_> = robot
                        .tree
                        .disabled
                        .iter()
                        .map(|pair| {
                            let mut names = pair.map(|i| robot.tree.links[i].name.as_str());
                            names.sort_unstable();
                            names
                        })
                        .collect();
                    disabled.sort_unstable();
                    assert_eq!(disabled, [["base", "shoulder"], ["elbow", "tray"]]);
                }
            }
        }
    }

    #[test]
    fn a_joint_that_others_mimic_is_one_joint() {
        let assembly =
            Assembly { base_link: 0, board_link: 5, camera_link: 4, X_FC: Pose::identity(), held: vec![None; 4] };
        let robot = mechanism().robot(&assembly);
        let names: Vec<&str> = robot.chain.joints.iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names, ["j3", "j0", "j1", "j2"]);
        assert_eq!(robot.chain.stages.len(), 5);
    }
}
