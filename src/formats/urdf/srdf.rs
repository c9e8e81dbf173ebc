//! SRDF: the pairs of links that are never tested for collision.

use super::element::{Element, parse};
use super::error::{UrdfError, UrdfFault};
use crate::robot::Tree;

/// The pairs of links of `tree` that an SRDF's `<disable_collisions>` name, as [`Tree::disabled`] has them.
///
/// # Errors
/// When the text is not SRDF, or names a link that the tree does not have.
pub fn read_srdf(text: &str, tree: &Tree) -> Result<Vec<[usize; 2]>, UrdfError> {
    let document = parse(text)?;
    let robot = Element::root(&document);
    if robot.tag() != "robot" {
        return Err(robot.error(UrdfFault::Root { found: robot.tag().into() }));
    }
    let pair = |element: Element<'_>| {
        let link = |attribute| {
            let name = element.required(attribute)?;
            let unknown = || element.error(UrdfFault::UnknownLink { name: name.into() });
            tree.links.iter().position(|link| link.name == name).ok_or_else(unknown)
        };
        let (a, b) = (link("link1")?, link("link2")?);
        Ok([a.min(b), a.max(b)])
    };
    let mut pairs = robot.all("disable_collisions").map(pair).collect::<Result<Vec<_>, _>>()?;
    pairs.sort_unstable();
    pairs.dedup();
    Ok(pairs)
}
