//! SRDF: the pairs of links that are never tested for collision.

use std::collections::HashMap;

use super::element::{Element, parse};
use super::error::{UrdfError, UrdfFault};
use super::note::{UrdfNote, UrdfRemark};
use crate::robot::Tree;

/// The pairs of links of `tree` that an SRDF's `<disable_collisions>` name, as [`Tree::disabled`] has them. Pairs with links that
/// the tree does not have, such as those of a gripper that is not mounted, are left out and noted.
///
/// ```
/// use std::path::Path;
///
/// use calipose::formats::{read_srdf, read_urdf};
///
/// let urdf = r#"<robot name="arm"><link name="base"/><link name="hand"/>
///     <joint name="weld" type="fixed"><parent link="base"/><child link="hand"/></joint></robot>"#;
/// let srdf = r#"<robot name="arm"><disable_collisions link1="hand" link2="base" reason="Adjacent"/></robot>"#;
/// let tree = read_urdf(urdf, Path::new(""), &[])?.mechanism.tree;
/// let (pairs, notes) = read_srdf(srdf, &tree)?;
/// assert_eq!(pairs, [[0, 1]]);
/// assert!(notes.is_empty());
/// # Ok::<(), calipose::formats::UrdfError>(())
/// ```
///
/// # Errors
/// When the text is not SRDF, or has pairs but none of this robot.
pub fn read_srdf(text: &str, tree: &Tree) -> Result<(Vec<[usize; 2]>, Vec<UrdfNote>), UrdfError> {
    let document = parse(text)?;
    let robot = Element::root(&document);
    if robot.tag() != "robot" {
        return Err(robot.error(UrdfFault::Root { found: robot.tag().into() }));
    }
    let place: HashMap<&str, usize> = tree.links.iter().enumerate().map(|(i, link)| (link.name.as_str(), i)).collect();
    let mut pairs = Vec::new();
    let mut strangers: Vec<(&str, Element)> = Vec::new();
    for element in robot.all("disable_collisions") {
        let names = [element.required("link1")?, element.required("link2")?];
        if let [Some(&a), Some(&b)] = names.map(|name| place.get(name)) {
            pairs.push([a.min(b), a.max(b)]);
        } else {
            strangers.extend(names.into_iter().filter(|name| !place.contains_key(name)).map(|name| (name, element)));
        }
    }
    if let ([], [(name, element), ..]) = (&pairs[..], &strangers[..]) {
        return Err(element.error(UrdfFault::UnknownLink { name: (*name).to_owned() }));
    }
    // Each is named once, with the first pair that it is in.
    strangers.sort_by_key(|&(name, _)| name);
    strangers.dedup_by_key(|&mut (name, _)| name);
    let note = |(name, element): &(&str, Element)| element.note(UrdfRemark::UnknownLink { name: (*name).to_owned() });
    let notes = strangers.iter().map(note).collect();
    pairs.sort_unstable();
    pairs.dedup();
    Ok((pairs, notes))
}
