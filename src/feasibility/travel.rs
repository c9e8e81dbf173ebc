//! How far parts of the robot go on a way.

use crate::robot::{JointKind, Motion, Tree};

/// A bound in m on the length of the way, seen from the frame of the link `ancestor` (from the base frame where there is none), of any
/// point that is within `arm` (m) of the origin of `link`'s frame and fixed to it, from joint values `from` to `to`, straight in joint
/// space: no joint moves a point faster than its own rate times the farthest that the point can be from its axis.
pub(super) fn travel(tree: &Tree, link: usize, ancestor: Option<usize>, mut arm: f64, from: &[f64], to: &[f64]) -> f64 {
    // Greatest length of a link's own motion along the way.
    let stretch = |motion: &Motion| match *motion {
        Motion::Driven { joint, kind: JointKind::Prismatic, multiplier, offset, .. } => {
            (multiplier * from[joint] + offset).abs().max((multiplier * to[joint] + offset).abs())
        }
        _ => 0.0,
    };
    let mut travelled = 0.0;
    let mut next = Some(link);
    // From the link down; `arm` is how far the point can be from the frame reached.
    while let Some(here) = next.filter(|_| next != ancestor) {
        let link = &tree.links[here];
        if let Motion::Driven { joint, kind, multiplier, .. } = link.motion {
            let turned = (multiplier * (to[joint] - from[joint])).abs();
            travelled += turned * if kind == JointKind::Revolute { arm } else { 1.0 };
        }
        arm += stretch(&link.motion) + link.X_PJ.translation.vector.norm();
        next = link.parent;
    }
    travelled
}

/// The nearest link that both links hang on, or are.
pub(super) fn common_ancestor(tree: &Tree, a: usize, b: usize) -> Option<usize> {
    let parent = |&link: &usize| tree.links[link].parent;
    let above: Vec<usize> = std::iter::successors(Some(a), parent).collect();
    std::iter::successors(Some(b), parent).find(|link| above.contains(link))
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use proptest::prelude::*;

    use super::*;
    use crate::robot::Limits;
    use crate::robot::dh::{self, Convention, Row};
    use crate::spatial::Pose;

    /// Two joints that turn and one that slides between them, none parallel to another.
    fn arm() -> Tree {
        let row = |name: &str, kind, alpha| Row {
            name: name.into(),
            kind,
            a: 0.3,
            alpha,
            d: 0.1,
            theta: 0.4,
            limits: Limits { min: -1.0, max: 1.0 },
            max_speed: None,
        };
        let (turns, slides) = (JointKind::Revolute, JointKind::Prismatic);
        let rows = [row("one", turns, 1.2), row("two", slides, -0.9), row("three", turns, 0.5)];
        dh::tree(&rows, Convention::Standard, Pose::identity())
    }

    proptest! {
        /// Between two places of a way no point of a link goes farther, seen from another link, than its share of the bound.
        #[test]
        fn points_go_no_farther(
            [from, to] in prop::array::uniform2(prop::array::uniform3(-2.0..2.0f64)),
            [a, b] in prop::array::uniform2(0.0..1.0f64),
            point in prop::array::uniform3(-0.5..0.5f64),
            links in prop::array::uniform2(0usize..20),
        ) {
            let tree = arm();
            let [link, seen_from] = links.map(|link| link % tree.links.len());
            let ancestor = common_ancestor(&tree, link, seen_from).unwrap();
            let point = Point3::from(point);
            let at = |t: f64| {
                let X_BL = tree.link_poses(&[0, 1, 2].map(|j| from[j] + t * (to[j] - from[j])));
                X_BL[ancestor].inverse() * X_BL[link] * point
            };
            let bound = travel(&tree, link, Some(ancestor), point.coords.norm(), &from, &to);
            prop_assert!((at(a) - at(b)).norm() <= bound * (a - b).abs() + 1e-12);
        }
    }
}
