//! Bodies and masses of a robot, and the tests made with them.

use nalgebra::{Point2, Point3, Vector3};

use super::{Check, LENGTH, NOT_NEGATIVE, SIZE};
use crate::feasibility::Stability;
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema::{self, Numbers};
use crate::problem::text::KeyPath;
use crate::robot::{Body, PointMass, Shape, Tree};
use crate::spatial::Pose;
use crate::target::Target;

/// Masses in kg.
const MASS: Allowed = Allowed::positive(1e6);
/// Slopes in degrees.
const SLOPE: Allowed = Allowed::between(-60.0, 60.0);

/// Links that can be named, and their numbers in the tree.
pub(super) type Links<'n> = Vec<(&'n str, usize)>;

impl Check<'_, '_> {
    /// Attaches `robot.bodies` to the tree.
    pub(super) fn bodies(&mut self, bodies: &[schema::Body], links: &Links, tree: &mut Tree) {
        for (i, body) in bodies.iter().enumerate() {
            let at = KeyPath::section("robot").key("bodies").at(i);
            if body.link.is_none() {
                self.fault(&at.key("link"), Reason::Missing { allowed: names(links) });
            }
            let link = body.link.as_ref().and_then(|name| self.link(&at.key("link"), name, links));
            let resolved = self.body(&at, body);
            if let (Some(link), Some(body)) = (link, resolved) {
                tree.links[link].bodies.push(body);
            }
        }
    }

    /// Attaches `robot.masses` to the tree; those of one link add up.
    pub(super) fn masses(&mut self, masses: &[schema::Mass], links: &Links, tree: &mut Tree) {
        for (i, mass) in masses.iter().enumerate() {
            let at = KeyPath::section("robot").key("masses").at(i);
            let link = self.link(&at.key("link"), &mass.link, links);
            let kilograms = self.number(&at.key("mass_kg"), mass.mass_kg, MASS);
            let Numbers(mut center) = mass.center_mm;
            for (j, p) in center.iter_mut().enumerate() {
                *p = self.length(&at.key("center_mm").at(j), *p, LENGTH);
            }
            let Some(link) = link else { continue };
            let slot = &mut tree.links[link].mass;
            let (before, moment) = slot.map_or((0.0, Vector3::zeros()), |m| (m.mass, m.center.coords * m.mass));
            let total = before + kilograms;
            let moment = moment + Vector3::from(center) * kilograms;
            *slot = Some(PointMass { mass: total, center: Point3::from(moment / total) });
        }
    }

    /// Attaches the camera's housing to link `flange`, with the camera at `X_FC` on it.
    pub(super) fn housing(&mut self, housing: &schema::Body, X_FC: Pose, flange: usize, tree: &mut Tree) {
        let at = KeyPath::section("camera").key("housing");
        if housing.link.is_some() {
            let reason = Reason::NotApplicable {
                to: "the camera's housing".into(),
                instead: "leave it out; the housing is on the flange".into(),
            };
            self.fault(&at.key("link"), reason);
        }
        if let Some(body) = self.body(&at, housing) {
            tree.attach("camera", flange, X_FC, body);
        }
    }

    /// Attaches the board to link `carrier`, in whose frame it is given, as a plate of `thickness` (m) under its printed side, if
    /// anything could touch it.
    pub(super) fn board(target: &Target, thickness: f64, carrier: usize, tree: &mut Tree) {
        if tree.links.iter().all(|link| link.bodies.is_empty()) {
            return;
        }
        let (width, height) = target.board.printed_size();
        let shape = Shape::Box { half_extents: Vector3::new(width, height, thickness) / 2.0 };
        tree.attach("board", carrier, target.X_BT, Body { X_LG: Pose::translation(0.0, 0.0, -thickness / 2.0), shape });
    }

    /// The clearance in m; the pairs to ignore join those disabled in the tree.
    pub(super) fn collision(&mut self, collision: &schema::Collision, tree: Option<&mut Tree>) -> f64 {
        let at = KeyPath::section("collision");
        let clearance = self.length(&at.key("clearance_mm"), collision.clearance_mm, NOT_NEGATIVE);
        let Some(tree) = tree else { return clearance };
        let bodied = tree.links.iter().enumerate().filter(|(_, link)| !link.bodies.is_empty());
        let links: Vec<(String, usize)> = bodied.map(|(i, link)| (link.name.clone(), i)).collect();
        let links: Links = links.iter().map(|(name, i)| (name.as_str(), *i)).collect();
        for (i, pair) in collision.ignore.iter().enumerate() {
            let at = at.key("ignore").at(i);
            let [a, b] = &pair[..] else {
                self.fault(&at, Reason::Length { found: pair.len(), expected: 2, per: "link of the pair" });
                continue;
            };
            let (a, b) = (self.link(&at.at(0), a, &links), self.link(&at.at(1), b, &links));
            if let (Some(a), Some(b)) = (a, b) {
                tree.disabled.push([a, b]);
            }
        }
        clearance
    }

    /// The test for stability, or none if none is asked for or something is wrong with it.
    pub(super) fn stability(
        &mut self,
        stability: Option<&schema::Stability>,
        tree: Option<&Tree>,
    ) -> Option<Stability> {
        let stability = stability?;
        let at = KeyPath::section("stability");
        let faults = self.faults.len();
        let support_at = at.key("support_mm");
        let mut points = Vec::new();
        for (i, &Numbers([x, y])) in stability.support_mm.iter().enumerate() {
            let at = support_at.at(i);
            points.push(Point2::new(self.length(&at.at(0), x, LENGTH), self.length(&at.at(1), y, LENGTH)));
        }
        let ground = self.length(&at.key("ground_mm"), stability.ground_mm, LENGTH);
        let margin = self.length(&at.key("margin_mm"), stability.margin_mm, NOT_NEGATIVE);
        let roll = self.angle(&at.key("roll_deg"), stability.roll_deg, SLOPE);
        let pitch = self.angle(&at.key("pitch_deg"), stability.pitch_deg, SLOPE);
        if tree.is_some_and(|tree| tree.links.iter().all(|link| link.mass.is_none())) {
            self.fault(&at, Reason::NoMasses);
        }
        if self.faults.len() > faults {
            return None;
        }
        match Stability::new(&points, ground, margin, roll, pitch) {
            Ok(stability) => Some(stability),
            Err(error) => {
                self.fault(&support_at, Reason::Support { error });
                None
            }
        }
    }

    /// The number of the link called `name`.
    fn link(&mut self, path: &KeyPath, name: &str, links: &Links) -> Option<usize> {
        let mut found = links.iter().filter(|(known, _)| *known == name).map(|&(_, number)| number);
        match (found.next(), found.next()) {
            (Some(number), None) => return Some(number),
            (Some(_), Some(_)) => self.fault(path, Reason::Ambiguous { name: name.into() }),
            (None, _) => self.fault(path, Reason::UnknownName { name: name.into(), allowed: names(links) }),
        }
        None
    }

    pub(super) fn body(&mut self, at: &KeyPath, body: &schema::Body) -> Option<Body> {
        let faults = self.faults.len();
        let X_LG = self.pose(&at.key("pose"), &body.pose);
        let given = [
            ("box_mm", body.box_mm.is_some()),
            ("sphere_mm", body.sphere_mm.is_some()),
            ("cylinder_mm", body.cylinder_mm.is_some()),
            ("capsule_mm", body.capsule_mm.is_some()),
        ];
        let mut shapes = given.into_iter().filter(|(_, given)| *given).map(|(key, _)| key);
        let Some(first) = shapes.next() else {
            self.fault(at, Reason::NoShape { allowed: given.map(|(key, _)| key.to_owned()).to_vec() });
            return None;
        };
        for other in shapes {
            self.fault(&at.key(other), Reason::Conflict { with: first.into() });
        }
        let at = at.key(first);
        let mut size = |path: &KeyPath, millimetres: f64| self.length(path, millimetres, SIZE);
        let shape = if let Some(Numbers([x, y, z])) = body.box_mm {
            let sides = Vector3::new(size(&at.at(0), x), size(&at.at(1), y), size(&at.at(2), z));
            Shape::Box { half_extents: sides / 2.0 }
        } else if let Some(radius) = body.sphere_mm {
            Shape::Sphere { radius: size(&at, radius) }
        } else if let Some(Numbers([radius, length])) = body.cylinder_mm {
            Shape::Cylinder { radius: size(&at.at(0), radius), length: size(&at.at(1), length) }
        } else {
            let Numbers([radius, length]) = body.capsule_mm?;
            Shape::Capsule { radius: size(&at.at(0), radius), length: size(&at.at(1), length) }
        };
        (self.faults.len() == faults).then_some(Body { X_LG, shape })
    }
}

fn names(links: &Links) -> Vec<String> {
    links.iter().map(|&(name, _)| name.to_owned()).collect()
}
