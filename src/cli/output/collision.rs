//! What is tested for collision and what is not, in words.

use super::short;
use crate::feasibility::LinkPairs;
use crate::plan::document::CollisionDocument;
use crate::plan::survey::Contact;
use crate::problem::Problem;

/// What poses are tested against, in one line; what is not is said first.
pub(crate) fn tested_text(problem: &Problem, document: &CollisionDocument) -> String {
    let CollisionDocument { tested, clearance_m, scene, joints_without_bodies, always_in_contact } = document;
    let obstacles = scene.join(", ");
    if !tested {
        let reason = match (!problem.robot.has_bodies(), scene.is_empty()) {
            (true, true) => {
                "no bodies): poses may drive the arm into itself, the board or its surroundings. Add bodies to the \
                             robot, and the cell as [[scene.bodies]]"
                    .to_owned()
            }
            (true, false) => {
                format!("the robot has no bodies): {obstacles} can only hide the board. Add [[robot.bodies]]")
            }
            (false, _) => "no pair of links is left to test): see the pairs that `calipose check` lists".to_owned(),
        };
        return format!("Collision: NOT tested ({reason}.");
    }
    let against = if scene.is_empty() { " and the board".to_owned() } else { format!(", the board and {obstacles}") };
    let clearance = short(clearance_m * 1e3);
    let mut text = format!("Collision: links tested against each other{against}, clearance {clearance} mm.");
    if scene.is_empty() {
        text += " The cell is NOT modelled: add [[scene.bodies]] for the table, walls and fixtures.";
    }
    if !always_in_contact.is_empty() {
        let pairs: Vec<String> = always_in_contact.iter().map(|[a, b]| format!("{a}–{b}")).collect();
        text += &format!(" NOT tested, because always in contact: {}; check their bodies.", pairs.join(", "));
    }
    if !joints_without_bodies.is_empty() {
        text +=
            &format!(" NOT tested, because without bodies: the parts moved by {}.", joints_without_bodies.join(", "));
    }
    text
}

/// That nothing is tested, where no part of the robot that moves has a body.
pub(crate) fn untested_text(problem: &Problem) -> Option<String> {
    (!problem.robot.has_bodies()).then(|| tested_text(problem, &CollisionDocument::new(problem, &LinkPairs::default())))
}

/// The pairs of links that are always within the clearance, with what to do about each; empty if there are none.
pub(crate) fn close_text(problem: &Problem, links: &LinkPairs) -> String {
    let name = |link: usize| problem.robot.tree.links[link].name.as_str();
    let remedies = links.close.iter().map(|close| remedy(close.links.map(name), close.nearest, close.farthest));
    let remedies: Vec<String> = remedies.collect();
    if remedies.is_empty() {
        return String::new();
    }
    format!(
        "Hardly any configuration can pass. These links are within the clearance of {} mm in every one of 1000 random configurations:\n{}",
        short(problem.clearance * 1e3),
        remedies.join("\n")
    )
}

/// What keeps candidates from being views that only collisions do, and what to do about it; empty if there are none.
pub(crate) fn contacts_text(contacts: &[Contact]) -> String {
    const MOST: usize = 5;
    let Some(&Contact { of, .. }) = contacts.first() else { return String::new() };
    let always: Vec<String> = contacts
        .iter()
        .filter(|contact| contact.count == of)
        .map(|Contact { links: [a, b], nearest, farthest, .. }| remedy([a, b], *nearest, *farthest))
        .collect();
    if !always.is_empty() {
        return format!(
            "these links are within the clearance in all {of} colliding candidates that were examined:\n{}",
            always.join("\n")
        );
    }
    let pairs: Vec<String> = contacts
        .iter()
        .take(MOST)
        .map(|Contact { links: [a, b], count, .. }| format!("{a}–{b} ({:.0} %)", 100.0 * *count as f64 / of as f64))
        .collect();
    format!("the pairs that collide most often are {}; check the sizes and poses of their bodies", pairs.join(", "))
}

/// Two links that are always so near (m), and what to do.
fn remedy([a, b]: [&str; 2], nearest: f64, farthest: f64) -> String {
    let ignore = format!("`ignore = [[\"{a}\", \"{b}\"]]` under [collision]");
    let [nearest, farthest] = [nearest, farthest].map(|m| m * 1e3);
    if farthest <= 0.0 {
        return format!(
            "  {a}–{b}, which touch: check the sizes and poses of their bodies; if only these overlap, {ignore}"
        );
    }
    let apart =
        if farthest - nearest < 0.01 { short(farthest) } else { format!("{} to {}", short(nearest), short(farthest)) };
    format!(
        "  {a}–{b}, {apart} mm apart: if they cannot touch, {ignore}; if they can, a clearance_mm below {}",
        short(farthest)
    )
}
