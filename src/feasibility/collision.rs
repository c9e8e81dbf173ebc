//! Collision: which pairs of links are tested, the robot's own and the obstacles around it, and whether any is too close.

use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use super::solid::{Placed, Solid};
use super::travel::{common_ancestor, travel};
use crate::robot::{Limits, Motion, Robot, Tree};
use crate::spatial::Pose;

/// Random configurations from which the pairs that always touch are found.
const SAMPLES: usize = 1000;

/// Two links, by their numbers in the tree, the lower first.
pub type LinkPair = [usize; 2];

/// The pairs of links that have bodies, by what is done about them. Each list is ascending.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LinkPairs {
    /// Not tested: they never move against each other, or one is the other's nearest ancestor with bodies and at most one moving
    /// joint is between.
    pub adjacent: Vec<LinkPair>,
    /// Not tested: disabled by the robot's description.
    pub disabled: Vec<LinkPair>,
    /// Not tested: in contact in every one of the random configurations.
    pub always: Vec<LinkPair>,
    /// Tested, and the share of the random configurations in which they were within the clearance. A pair that none showed
    /// is tested all the same: that it was never seen does not prove that it cannot be.
    pub tested: Vec<(LinkPair, f64)>,
    /// Of the tested, those within the clearance in every one of the random configurations, though not always in contact: no
    /// pose is likely to pass.
    pub close: Vec<Close>,
}

/// Two links that are always within the clearance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Close {
    /// The links.
    pub links: LinkPair,
    /// Least distance in the random configurations, m; 0 where they touch.
    pub nearest: f64,
    /// Greatest distance, m.
    pub farthest: f64,
}

/// The test for collision of the robot with itself and with the obstacles around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Collision {
    solids: Vec<Solid>,
    /// Solids to measure against each other: those of the robot's own links, then those with an obstacle; among each those of
    /// the pairs that collide most often first.
    pairs: Vec<[usize; 2]>,
    clearance: f64,
    links: LinkPairs,
}

impl Collision {
    /// The test for the bodies of `robot` and of the obstacles around it with `clearance` (m, not negative): touching is a
    /// collision at a clearance of 0. Pairs in contact in all of 1000 random configurations within the joint limits are left out,
    /// as `MoveIt`'s setup does: their models overlap where the robot does not.
    pub fn new(robot: &Robot, clearance: f64) -> Self {
        let limits: Vec<Limits> = robot.chain.joints.iter().map(|joint| joint.limits).collect();
        Self::of_tree(&robot.tree, &robot.obstacles, &limits, clearance)
    }

    fn of_tree(tree: &Tree, obstacles: &[usize], limits: &[Limits], clearance: f64) -> Self {
        let solids = Solid::all(tree);
        let mut links = LinkPairs { adjacent: adjacent(tree), ..LinkPairs::default() };
        let bodied: Vec<usize> = (0..tree.links.len()).filter(|&i| !tree.links[i].bodies.is_empty()).collect();
        let disabled = |pair: LinkPair| tree.disabled.iter().any(|&[a, b]| pair == [a.min(b), a.max(b)]);
        let mut candidates = Vec::new();
        for (n, &b) in bodied.iter().enumerate() {
            for &a in &bodied[..n] {
                if links.adjacent.contains(&[a, b]) {
                    continue;
                }
                if disabled([a, b]) {
                    links.disabled.push([a, b]);
                } else {
                    candidates.push([a, b]);
                }
            }
        }
        let of = |link: usize| solids.iter().enumerate().filter(move |(_, solid)| solid.link == link).map(|(i, _)| i);
        let between = |[a, b]: LinkPair| of(a).flat_map(move |i| of(b).map(move |j| [i, j]));
        let samples = if candidates.is_empty() { Vec::new() } else { samples(limits) };
        let placed: Vec<Vec<Placed>> = samples.par_iter().map(|q| Placed::all(&solids, &tree.link_poses(q))).collect();
        let frequency = |pair: LinkPair, clearance: f64| -> usize {
            let within = |placed: &&Vec<Placed>| between(pair).any(|[i, j]| placed[i].is_within(clearance, &placed[j]));
            placed.par_iter().filter(within).count()
        };
        let mut tested = Vec::new();
        for pair in candidates {
            if frequency(pair, 0.0) == SAMPLES {
                links.always.push(pair);
            } else {
                tested.push((pair, frequency(pair, clearance)));
            }
        }
        let share = |&(pair, count): &(LinkPair, usize)| (pair, count as f64 / SAMPLES as f64);
        links.tested = tested.iter().map(share).collect();
        for &(pair, _) in tested.iter().filter(|&&(_, count)| count == SAMPLES) {
            let gap = |placed: &Vec<Placed>| {
                let gaps = between(pair).map(|[i, j]| placed[i].gap(&placed[j]));
                gaps.fold(f64::INFINITY, f64::min).max(0.0)
            };
            let gaps: Vec<f64> = placed.par_iter().map(gap).collect();
            let (nearest, farthest) = gaps.iter().fold((f64::INFINITY, 0.0f64), |(a, b), &g| (a.min(g), b.max(g)));
            links.close.push(Close { links: pair, nearest, farthest });
        }
        let with_obstacle = |[a, b]: LinkPair| obstacles.contains(&a) || obstacles.contains(&b);
        tested.sort_by_key(|&(pair, count)| (with_obstacle(pair), std::cmp::Reverse(count)));
        let pairs = tested.iter().flat_map(|&(pair, _)| between(pair)).collect();
        drop(placed);
        for list in [&mut links.adjacent, &mut links.disabled, &mut links.always] {
            list.sort_unstable();
        }
        links.tested.sort_by_key(|&(pair, _)| pair);
        links.close.sort_by_key(|close| close.links);
        Self { solids, pairs, clearance, links }
    }

    /// What is tested and what is not.
    pub fn links(&self) -> &LinkPairs {
        &self.links
    }

    /// Whether there is anything to test.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Whether two links of a tested pair are within the clearance of each other, the links being at `X_BL`.
    ///
    /// "No" is proven by a plane between every two bodies, but for rounding.
    pub fn collides(&self, X_BL: &[Pose]) -> bool {
        self.first(X_BL).is_some()
    }

    /// A tested pair of links within the clearance of each other, the links being at `X_BL`, if there is one: of the robot's own
    /// links where there are such, of a link and an obstacle else.
    pub fn first(&self, X_BL: &[Pose]) -> Option<LinkPair> {
        let placed = Placed::all(&self.solids, X_BL);
        let close = self.pairs.iter().find(|&&[i, j]| placed[i].is_within(self.clearance, &placed[j]));
        close.map(|&[i, j]| [self.solids[i].link, self.solids[j].link])
    }

    /// The tested pairs of links with the distance in m between their nearest bodies, the links being at `X_BL`. Not positive
    /// where they touch, and then not their depth.
    pub fn gaps(&self, X_BL: &[Pose]) -> Vec<(LinkPair, f64)> {
        let placed = Placed::all(&self.solids, X_BL);
        let gap = |pair: LinkPair| {
            let links = |&&[i, j]: &&[usize; 2]| [self.solids[i].link, self.solids[j].link] == pair;
            let gaps = self.pairs.iter().filter(links).map(|&[i, j]| placed[i].gap(&placed[j]));
            (pair, gaps.fold(f64::INFINITY, f64::min))
        };
        self.links.tested.iter().map(|&(pair, _)| gap(pair)).collect()
    }

    /// The clearance, m.
    pub fn clearance(&self) -> f64 {
        self.clearance
    }

    /// The solids with their links at `X_BL`.
    pub(crate) fn placed(&self, X_BL: &[Pose]) -> PlacedSolids<'_> {
        PlacedSolids { collision: self, placed: Placed::all(&self.solids, X_BL) }
    }

    /// For each pair of [`LinkPairs::tested`] a bound in m on how much its distance changes on the way from joint values `from` to `to`,
    /// straight in joint space; on a part of the way, by no more than that share of it.
    pub(crate) fn changes(&self, tree: &Tree, from: &[f64], to: &[f64]) -> Vec<f64> {
        let arm = |link: usize| {
            let own = self.solids.iter().filter(|solid| solid.link == link);
            own.map(Solid::arm).fold(0.0, f64::max)
        };
        let change = |&([a, b], _): &(LinkPair, f64)| {
            let ancestor = common_ancestor(tree, a, b);
            [a, b].map(|link| travel(tree, link, ancestor, arm(link), from, to)).iter().sum()
        };
        self.links.tested.iter().map(change).collect()
    }
}

/// The solids at one configuration.
pub(crate) struct PlacedSolids<'c> {
    collision: &'c Collision,
    placed: Vec<Placed<'c>>,
}

impl PlacedSolids<'_> {
    /// Distance in m between the nearest bodies of the pair of that number in [`LinkPairs::tested`]; no less than `enough` where it is
    /// more than that. Not positive where they touch, and then not their depth.
    pub(crate) fn gap(&self, pair: usize, enough: f64) -> f64 {
        let Collision { solids, pairs, links, .. } = self.collision;
        let (links, _) = links.tested[pair];
        let own = pairs.iter().filter(|&&[i, j]| [solids[i].link, solids[j].link] == links);
        own.map(|&[i, j]| self.placed[i].gap_up_to(enough, &self.placed[j])).fold(enough, f64::min)
    }
}

/// Random joint values within the limits, always the same ones.
fn samples(limits: &[Limits]) -> Vec<Vec<f64>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0);
    let mut value = |limits: &Limits| limits.min + (limits.max - limits.min) * rng.r#gen::<f64>();
    (0..SAMPLES).map(|_| limits.iter().map(&mut value).collect()).collect()
}

/// The pairs of links with bodies that never move against each other, or that are neighbours: one the nearest ancestor with
/// bodies of the other, and at most one moving joint between.
fn adjacent(tree: &Tree) -> Vec<LinkPair> {
    let is_bodied = |link: usize| !tree.links[link].bodies.is_empty();
    let moves = |link: usize| tree.links[link].motion != Motion::Fixed;
    let is_neighbour = |ancestor: usize, mut link: usize| {
        let mut joints = 0;
        loop {
            joints += usize::from(moves(link));
            match tree.links[link].parent {
                Some(parent) if parent == ancestor => return joints <= 1,
                Some(parent) if !is_bodied(parent) => link = parent,
                _ => return false,
            }
        }
    };
    let bodied: Vec<usize> = (0..tree.links.len()).filter(|&link| is_bodied(link)).collect();
    let pairs = bodied.iter().enumerate().flat_map(|(n, &b)| bodied[..n].iter().map(move |&a| [a, b]));
    pairs.filter(|&[a, b]| tree.mover(a) == tree.mover(b) || is_neighbour(a, b)).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;
    use crate::robot::dh::{self, Convention, Row, frame_link};
    use crate::robot::{Body, JointKind, Shape};

    /// A planar arm of three bars of 1 m, each a capsule along its link.
    fn arm(radius: f64) -> (Tree, Vec<Limits>) {
        let limits = Limits { min: -PI, max: PI };
        let row = |name: &str| Row {
            name: name.into(),
            kind: JointKind::Revolute,
            a: 1.0,
            alpha: 0.0,
            d: 0.0,
            theta: 0.0,
            limits,
            max_speed: None,
        };
        let mut tree = dh::tree(&["one", "two", "three"].map(row), Convention::Standard, Pose::identity());
        for i in 1..=3 {
            let along_x = Pose::new(Vector3::new(-0.5, 0.0, 0.0), Vector3::y() * PI / 2.0);
            let shape = Shape::Capsule { radius, length: 1.0 };
            tree.links[frame_link(i)].bodies.push(Body { X_LG: along_x, shape });
        }
        (tree, vec![limits; 3])
    }

    #[test]
    fn neighbours_are_not_tested_and_the_others_are() {
        let (tree, limits) = arm(0.05);
        let collision = Collision::of_tree(&tree, &[], &limits, 0.0);
        assert_eq!(collision.links().adjacent, [[2, 4], [4, 6]]);
        let [([2, 6], share)] = collision.links().tested[..] else { panic!("{:?}", collision.links()) };
        assert!((0.1..0.5).contains(&share), "{share}");
        // A body removed from the middle makes the outer two no neighbours: two joints move between them.
        let mut open = tree.clone();
        open.links[4].bodies.clear();
        assert_eq!(Collision::of_tree(&open, &[], &limits, 0.0).links().tested.len(), 1);
        // A plate on a base without bodies, and a block bolted to it: they do not move against each other, but the bar passes by.
        let mut plated = tree.clone();
        let ball = || Body { X_LG: Pose::identity(), shape: Shape::Sphere { radius: 0.3 } };
        let plate = plated.attach("plate", 0, Pose::translation(0.0, 1.0, 0.0), ball());
        let block = plated.attach("block", plate, Pose::translation(0.0, 0.0, 0.1), ball());
        let links = Collision::of_tree(&plated, &[], &limits, 0.0).links().clone();
        assert_eq!(links.adjacent, [[2, 4], [4, 6], [plate, block]]);
        assert!(links.tested.iter().any(|&(pair, share)| pair == [2, plate] && share > 0.0));
        let disabled = Tree { disabled: vec![[6, 2]], ..tree };
        let collision = Collision::of_tree(&disabled, &[], &limits, 0.0);
        assert_eq!((collision.links().disabled.clone(), collision.is_empty()), (vec![[2, 6]], true));
    }

    #[test]
    fn pairs_that_always_touch_are_left_out() {
        let (mut tree, limits) = arm(0.05);
        tree.links[0].bodies.push(Body { X_LG: Pose::identity(), shape: Shape::Sphere { radius: 1.1 } });
        let collision = Collision::of_tree(&tree, &[], &limits, 0.0);
        // The second bar starts 1 m from the ball's centre.
        assert_eq!(collision.links().always, [[0, 4]]);
        assert!(!collision.collides(&tree.link_poses(&[0.0, 0.0, 0.0])));
        assert!(collision.collides(&tree.link_poses(&[0.0, 2.8, 0.0])));
    }

    /// A bar that can get away from a ball in a few configurations only is tested.
    #[test]
    fn pairs_that_seldom_part_are_tested() {
        let (mut tree, mut limits) = arm(0.05);
        tree.links[0].bodies.push(Body { X_LG: Pose::identity(), shape: Shape::Sphere { radius: 1.1 } });
        // The third bar's end touches the ball if the second is turned back by more than 110°.
        let from = 2.0 * (1.15f64 / 2.0).acos();
        limits[1] = Limits { min: from - 0.08, max: PI };
        let collision = Collision::of_tree(&tree, &[], &limits, 0.0);
        assert_eq!(collision.links().always, [[0, 4]]);
        assert!((0.93..1.0).contains(&share_of(&collision, [0, 6]).unwrap()), "{:?}", collision.links());
        assert!(collision.links().close.is_empty());
        // Always in contact is judged without the clearance.
        limits[1] = Limits { min: from - 0.03, max: from - 0.001 };
        limits[2] = Limits { min: 0.0, max: 0.0 };
        let wide = Collision::of_tree(&tree, &[], &limits, 0.1);
        let [close] = wide.links().close[..] else { panic!("{:?}", wide.links()) };
        assert_eq!((close.links, share_of(&wide, [0, 6])), ([0, 6], Some(1.0)));
        assert!(close.nearest > 0.0 && close.nearest < close.farthest && close.farthest < 0.1);
    }

    fn share_of(collision: &Collision, pair: LinkPair) -> Option<f64> {
        collision.links().tested.iter().find(|(other, _)| *other == pair).map(|&(_, share)| share)
    }

    #[test]
    fn contact_of_the_robot_with_itself_is_told_before_contact_with_an_obstacle() {
        let (mut tree, limits) = arm(0.05);
        // A wall 10 mm beside the plane of the bars, and a ball in it.
        let half_extents = Vector3::new(3.0, 3.0, 0.1);
        let wall = Body { X_LG: Pose::translation(0.0, 0.0, -0.16), shape: Shape::Box { half_extents } };
        let wall = tree.attach("wall", 0, Pose::identity(), wall);
        let gate = Body { X_LG: Pose::translation(-2.0, 0.0, 0.0), shape: Shape::Sphere { radius: 0.5 } };
        let gate = tree.attach("gate", 0, Pose::identity(), gate);
        let collision = Collision::of_tree(&tree, &[wall, gate], &limits, 0.0);
        let first = |q: [f64; 3]| collision.first(&tree.link_poses(&q));
        assert_eq!(first([0.0, 0.0, 0.0]), None);
        assert_eq!(first([PI, 0.0, 0.0]).unwrap()[1], gate);
        // Folded on itself away from the ball; almost so, in the ball; altogether, in the ball.
        assert_eq!(first([0.0, 3.1, 3.1]), Some([2, 6]));
        assert_eq!(first([PI, 0.5, 3.0]).unwrap()[1], gate);
        assert_eq!(first([PI, 0.05, 3.1]), Some([2, 6]));
        let near = Collision::of_tree(&tree, &[wall, gate], &limits, 0.011);
        assert_eq!(
            near.links().close.iter().map(|close| close.links).collect::<Vec<_>>(),
            [[2, wall], [4, wall], [6, wall]]
        );
        assert!(
            near.links().close.iter().all(|close| (close.nearest - 0.01).abs() < 1e-6 && close.farthest < 0.010_001)
        );
    }

    #[test]
    fn just_inside_and_just_outside_the_clearance() {
        let (tree, limits) = arm(0.05);
        // A square open at one side: first and third bar are parallel, 1 m apart less two radii.
        let X_BL = tree.link_poses(&[0.3, PI / 2.0, PI / 2.0]);
        let gaps = Collision::of_tree(&tree, &[], &limits, 0.0).gaps(&X_BL);
        assert!((gaps[0].1 - 0.9).abs() < 1e-9);
        assert!(!Collision::of_tree(&tree, &[], &limits, 0.899).collides(&X_BL));
        let wide = Collision::of_tree(&tree, &[], &limits, 0.901);
        assert!(wide.collides(&X_BL));
        // The bars are never farther apart; a pair that is always too close is told, not left out.
        assert_eq!((wide.links().tested.clone(), wide.links().always.len()), (vec![([2, 6], 1.0)], 0));
    }

    proptest! {
        /// Turning the whole robot changes nothing.
        #[test]
        fn verdicts_do_not_depend_on_where_the_robot_stands(
            q in prop::array::uniform3(-PI..PI),
            p in prop::array::uniform3(-5.0..5.0f64),
            r in prop::array::uniform3(-2.0..2.0f64),
        ) {
            let (tree, limits) = arm(0.05);
            let collision = Collision::of_tree(&tree, &[], &limits, 0.01);
            let X_BL = tree.link_poses(&q);
            let X_WB = Pose::new(Vector3::from(p), Vector3::from(r));
            let moved: Vec<Pose> = X_BL.iter().map(|X_BL| X_WB * X_BL).collect();
            let (gap, moved_gap) = (collision.gaps(&X_BL)[0].1, collision.gaps(&moved)[0].1);
            prop_assert!((gap - moved_gap).abs() < 1e-7 || gap.max(moved_gap) < 1e-7);
            if (gap - 0.01).abs() > 1e-7 {
                prop_assert_eq!(collision.collides(&X_BL), collision.collides(&moved));
                prop_assert_eq!(collision.collides(&X_BL), gap < 0.01);
            }
        }
    }
}
