//! What is tested besides visibility: bodies against each other, and stability.

use crate::cli::output::collision::{close_text, tested_text};
use crate::cli::output::short;
use crate::feasibility::{Checks, LinkPair, LinkPairs};
use crate::plan::document::CheckDocument;
use crate::problem::Problem;

/// What is tested besides visibility, in lines.
pub(super) fn tests_text(problem: &Problem, checks: &Checks, document: &CheckDocument) -> String {
    let links = checks.collision().links();
    let mut text = tested_text(problem, &document.collision) + "\n";
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
    if let (Some(stability), Some(mass)) = (&problem.stability, document.mass_kg) {
        text += &format!(
            "Stability: {} kg over a support polygon of {} corners, margin {} mm.\n",
            short(mass),
            stability.polygon().len(),
            short(stability.margin * 1e3),
        );
    }
    text
}
