//! What is tested besides visibility: bodies against each other, and stability.

use serde_json::{Value, json};

use crate::cli::output::collision::{close_text, tested_text};
use crate::cli::output::short;
use crate::feasibility::{Checks, LinkPair, LinkPairs};
use crate::plan::survey::CollisionDocument;
use crate::problem::Problem;
use crate::robot::PointMass;

/// Centre of mass where the joints are in the middle of their ranges; its mass is that of any configuration.
pub(super) fn center_of_mass(problem: &Problem) -> Option<PointMass> {
    let joints = &problem.robot.chain.joints;
    let q: Vec<f64> = joints.iter().map(|joint| f64::midpoint(joint.limits.min, joint.limits.max)).collect();
    let tree = &problem.robot.tree;
    tree.center_of_mass(&tree.link_poses(&q))
}

/// The pairs of links by what is done about them; null for robots without bodies.
pub(super) fn self_collision(problem: &Problem, checks: &Checks) -> Value {
    let name = |link: usize| problem.robot.tree.links[link].name.as_str();
    let names = |pairs: &[LinkPair]| pairs.iter().map(|&[a, b]| json!([name(a), name(b)])).collect::<Value>();
    let links = checks.collision().links();
    if *links == LinkPairs::default() {
        return Value::Null;
    }
    let never: Vec<LinkPair> = links.tested.iter().filter(|(_, share)| *share == 0.0).map(|&(pair, _)| pair).collect();
    let tested = links.tested.iter().map(|&([a, b], share)| json!({ "links": [name(a), name(b)], "share": share }));
    let close = links.close.iter().map(|close| {
        json!({
            "links": close.links.map(name),
            "nearest_mm": close.nearest * 1e3,
            "farthest_mm": close.farthest * 1e3,
        })
    });
    json!({
        "clearance_mm": problem.clearance * 1e3,
        "adjacent": names(&links.adjacent),
        "ignored": names(&links.disabled),
        "always_in_contact": names(&links.always),
        "never_seen": names(&never),
        "always_within_clearance": close.collect::<Value>(),
        "tested": tested.collect::<Value>(),
    })
}

/// What is tested besides visibility, in lines.
pub(super) fn tests_text(problem: &Problem, checks: &Checks) -> String {
    let links = checks.collision().links();
    let mut text = tested_text(problem, &CollisionDocument::new(problem, links)) + "\n";
    if *links != LinkPairs::default() {
        let name = |link: usize| problem.robot.tree.links[link].name.as_str();
        let list = |pairs: &mut dyn Iterator<Item = LinkPair>| {
            let pairs: Vec<String> = pairs.map(|[a, b]| format!("{}–{}", name(a), name(b))).collect();
            if pairs.is_empty() { "none".into() } else { pairs.join(", ") }
        };
        let of =
            |test: fn(f64) -> bool| links.tested.iter().filter(move |(_, share)| test(*share)).map(|&(pair, _)| pair);
        text += &format!(
            "Pairs of links within the clearance in some of 1000 random configurations: {}; in none, but tested: {}. Not tested, \
             adjacent: {}; always in contact: {}; ignored: {}.\n",
            list(&mut of(|share| share > 0.0)),
            list(&mut of(|share| share == 0.0)),
            list(&mut links.adjacent.iter().copied()),
            list(&mut links.always.iter().copied()),
            list(&mut links.disabled.iter().copied()),
        );
    }
    let close = close_text(problem, links);
    if !close.is_empty() {
        text += &format!("{close}\n");
    }
    if let (Some(stability), Some(center)) = (&problem.stability, center_of_mass(problem)) {
        text += &format!(
            "Stability: {} kg over a support polygon of {} corners, margin {} mm.\n",
            short(center.mass),
            stability.polygon().len(),
            short(stability.margin * 1e3),
        );
    }
    text
}
