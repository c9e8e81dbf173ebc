//! Bodies and masses of a robot, and the tests made with them.

use nalgebra::{Point2, Point3, Vector3};

use crate::feasibility::Stability;
use crate::problem::fault::{Allowed, Reason};
use crate::problem::resolve::check::{Check, LENGTH, NOT_NEGATIVE, SIZE};
use crate::problem::schema;
use crate::problem::text::{At, Optional, key};
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
    pub(super) fn bodies(&mut self, bodies: &At<Vec<schema::Body>>, links: &Links, tree: &mut Tree) {
        for body in bodies.elements() {
            let link = self.required(key!(body, link), &names(links)).and_then(|link| self.link(&link, links));
            let resolved = self.body(&body);
            if let (Some(link), Some(body)) = (link, resolved) {
                tree.links[link].bodies.push(body);
            }
        }
    }

    /// Attaches `robot.masses` to the tree; those of one link add up.
    pub(super) fn masses(&mut self, masses: &At<Vec<schema::Mass>>, links: &Links, tree: &mut Tree) {
        for mass in masses.elements() {
            let link = self.link(&key!(mass, link), links);
            let kilograms = self.number(&key!(mass, mass_kg), MASS);
            let center = key!(mass, center_mm).numbers().map(|p| self.length(&p, LENGTH));
            let Some(link) = link else { continue };
            let slot = &mut tree.links[link].mass;
            let (before, moment) = slot.map_or((0.0, Vector3::zeros()), |m| (m.mass, m.center.coords * m.mass));
            let total = before + kilograms;
            let moment = moment + Vector3::from(center) * kilograms;
            *slot = Some(PointMass { mass: total, center: Point3::from(moment / total) });
        }
    }

    /// Attaches the camera's housing to link `flange`, with the camera at `X_FC` on it.
    pub(super) fn housing(&mut self, housing: &At<schema::Body>, X_FC: Pose, flange: usize, tree: &mut Tree) {
        let instead = "leave it out; the housing is on the flange";
        self.refused(&[&key!(housing, link)], "the camera's housing", instead);
        if let Some(body) = self.body(housing) {
            tree.attach("camera", flange, X_FC, body);
        }
    }

    /// Attaches the board to link `carrier`, in whose frame it is given, as a plate under its printed side, if anything could touch
    /// it.
    pub(in crate::problem::resolve) fn board(target: &Target, carrier: usize, tree: &mut Tree) {
        if tree.links.iter().all(|link| link.bodies.is_empty()) {
            return;
        }
        let (width, height) = target.board.printed_size();
        let thickness = target.thickness;
        let shape = Shape::Box { half_extents: Vector3::new(width, height, thickness) / 2.0 };
        tree.attach("board", carrier, target.X_BT, Body { X_LG: Pose::translation(0.0, 0.0, -thickness / 2.0), shape });
    }

    /// The clearance in m; the pairs to ignore join those disabled in the tree.
    pub(in crate::problem::resolve) fn collision(
        &mut self,
        collision: &At<schema::Collision>,
        tree: Option<&mut Tree>,
    ) -> f64 {
        let clearance = self.length(&key!(collision, clearance_mm), NOT_NEGATIVE);
        let Some(tree) = tree else { return clearance };
        let bodied = tree.links.iter().enumerate().filter(|(_, link)| !link.bodies.is_empty());
        let links: Vec<(String, usize)> = bodied.map(|(i, link)| (link.name.clone(), i)).collect();
        let links: Links = links.iter().map(|(name, i)| (name.as_str(), *i)).collect();
        for pair in key!(collision, ignore).elements() {
            let [a, b] = &pair.elements().collect::<Vec<_>>()[..] else {
                self.fault(
                    &pair.path,
                    Reason::Length { found: pair.value.len(), expected: 2, per: "link of the pair" },
                );
                continue;
            };
            let (a, b) = (self.link(a, &links), self.link(b, &links));
            if let (Some(a), Some(b)) = (a, b) {
                tree.disabled.push([a, b]);
            }
        }
        clearance
    }

    /// The test for stability, or none if something is wrong with it.
    pub(in crate::problem::resolve) fn stability(
        &mut self,
        stability: &At<schema::Stability>,
        tree: Option<&Tree>,
    ) -> Option<Stability> {
        let faults = self.faults.len();
        let support = key!(stability, support_mm);
        let point = |point: At<schema::Numbers<2>>| Point2::from(point.numbers().map(|x| self.length(&x, LENGTH)));
        let points: Vec<_> = support.elements().map(point).collect();
        let ground = self.length(&key!(stability, ground_mm), LENGTH);
        let margin = self.length(&key!(stability, margin_mm), NOT_NEGATIVE);
        let roll = self.angle(&key!(stability, roll_deg), SLOPE);
        let pitch = self.angle(&key!(stability, pitch_deg), SLOPE);
        if tree.is_some_and(|tree| tree.links.iter().all(|link| link.mass.is_none())) {
            self.fault(&stability.path, Reason::NoMasses);
        }
        if self.faults.len() > faults {
            return None;
        }
        match Stability::new(&points, ground, margin, roll, pitch) {
            Ok(stability) => Some(stability),
            Err(error) => {
                self.fault(&support.path, Reason::Support { error });
                None
            }
        }
    }

    /// The number of the link of that name.
    fn link(&mut self, name: &At<String>, links: &Links) -> Option<usize> {
        let mut found = links.iter().filter(|(known, _)| known == name.value).map(|&(_, number)| number);
        match (found.next(), found.next()) {
            (Some(number), None) => return Some(number),
            (Some(_), Some(_)) => self.fault(&name.path, Reason::Ambiguous { name: name.value.clone() }),
            (None, _) => self.unknown(&name.path, name.value, &names(links)),
        }
        None
    }

    pub(super) fn body(&mut self, body: &At<schema::Body>) -> Option<Body> {
        let faults = self.faults.len();
        let X_LG = self.pose(&key!(body, pose));
        let (cuboid, sphere) = (key!(body, box_mm), key!(body, sphere_mm));
        let (cylinder, capsule) = (key!(body, cylinder_mm), key!(body, capsule_mm));
        let keys: [&dyn Optional; 4] = [&cuboid, &sphere, &cylinder, &capsule];
        let Some(first) = keys.iter().position(|key| key.is_given()) else {
            let allowed = keys.map(|key| key.path().name().to_owned()).to_vec();
            self.fault(&body.path, Reason::NoShape { allowed });
            return None;
        };
        self.excluded(&keys[first + 1..], keys[first].path().name());
        let mut size = |length: At<f64>| self.length(&length, SIZE);
        let shape = if let Some(sides) = cuboid.given() {
            Shape::Box { half_extents: Vector3::from(sides.numbers().map(size)) / 2.0 }
        } else if let Some(radius) = sphere.given() {
            Shape::Sphere { radius: size(radius) }
        } else if let Some(cylinder) = cylinder.given() {
            let [radius, length] = cylinder.numbers().map(size);
            Shape::Cylinder { radius, length }
        } else {
            let [radius, length] = capsule.given()?.numbers().map(size);
            Shape::Capsule { radius, length }
        };
        (self.faults.len() == faults).then_some(Body { X_LG, shape })
    }
}

fn names<'n>(links: &Links<'n>) -> Vec<&'n str> {
    links.iter().map(|&(name, _)| name).collect()
}
