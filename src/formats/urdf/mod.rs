//! Robot descriptions: URDF, and the pairs that an SRDF never tests for collision.
//!
//! Read from the XML tree itself, because only that knows the line of what is wrong.

mod element;
mod error;
mod joint;
mod link;
mod mesh_folders;
mod srdf;

pub use error::{UrdfError, UrdfFault};
pub use srdf::read_srdf;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use element::{Element, parse};
use joint::{UrdfJoint, motions};
use mesh_folders::MeshFolders;

use crate::robot::{Link, Mechanism, Motion, Tree};
use crate::spatial::Pose;

/// The robot that a URDF describes. Its meshes are sought from `folder`, the description's own, and in `package_folders`, which
/// are packages or hold them; the solid of a mesh is its convex hull.
///
/// Links come parents first, otherwise as in the file. A continuous joint has limits of half a turn either way. The limits of a
/// joint that mimics another are not looked at.
///
/// # Errors
/// When the text is not the URDF of a tree of links, or a mesh cannot be read.
pub fn read_urdf(text: &str, folder: &Path, package_folders: &[PathBuf]) -> Result<Mechanism, UrdfError> {
    let document = parse(text)?;
    let robot = Element::root(&document);
    if robot.tag() != "robot" {
        return Err(robot.error(UrdfFault::Root { found: robot.tag().into() }));
    }
    let links: Vec<Element> = robot.all("link").collect();
    if links.is_empty() {
        return Err(robot.error(UrdfFault::NoLinks));
    }
    let index = numbered(&links)?;
    let elements: Vec<Element> = robot.all("joint").collect();
    numbered(&elements)?;
    let joints = elements.into_iter().map(UrdfJoint::read).collect::<Result<Vec<_>, _>>()?;
    let above = joints_above(&joints, &index)?;
    let (free, motions) = motions(&joints)?;
    let folders = MeshFolders::new(folder, package_folders);

    let mut tree = Tree::default();
    let mut place: HashMap<&str, usize> = HashMap::new();
    for i in parents_first(&links, &joints, &above, &index)? {
        let (element, name) = (links[i], links[i].name()?);
        let (parent, X_PJ, motion) = match above[i] {
            None => (None, Pose::identity(), Motion::Fixed),
            Some(joint) => (place.get(joints[joint].parent).copied(), joints[joint].X_PJ, motions[joint].clone()),
        };
        let (bodies, mass) = (link::bodies(element, &folders)?, link::mass(element)?);
        place.insert(name, tree.links.len());
        tree.links.push(Link { name: name.into(), parent, X_PJ, motion, bodies, mass });
    }
    let followers = joints.iter().filter(|joint| joint.mimics()).map(|joint| joint.name.to_owned()).collect();
    Ok(Mechanism { tree, joints: free, followers })
}

/// The elements by their names, each of which must occur once.
fn numbered<'a>(elements: &[Element<'a>]) -> Result<HashMap<&'a str, usize>, UrdfError> {
    let mut index = HashMap::new();
    for (i, element) in elements.iter().enumerate() {
        if let Some(before) = index.insert(element.name()?, i) {
            return Err(element.error(UrdfFault::Repeated { line: elements[before].line() }));
        }
    }
    Ok(index)
}

/// For each link the joint that it is the child of.
fn joints_above(joints: &[UrdfJoint<'_>], index: &HashMap<&str, usize>) -> Result<Vec<Option<usize>>, UrdfError> {
    let mut above: Vec<Option<usize>> = vec![None; index.len()];
    for (j, joint) in joints.iter().enumerate() {
        let unknown = |name: &str| joint.element.error(UrdfFault::UnknownLink { name: name.into() });
        if !index.contains_key(joint.parent) {
            return Err(unknown(joint.parent));
        }
        let child = *index.get(joint.child).ok_or_else(|| unknown(joint.child))?;
        if let Some(other) = above[child] {
            let names = [joints[other].name.to_owned(), joint.name.to_owned()];
            let error = joint.element.error(UrdfFault::TwoParents { joints: names });
            return Err(UrdfError { element: Some(format!("link \"{}\"", joint.child)), ..error });
        }
        above[child] = Some(j);
    }
    Ok(above)
}

/// The links, every parent before its children, otherwise as in the file.
fn parents_first(
    links: &[Element<'_>],
    joints: &[UrdfJoint<'_>],
    above: &[Option<usize>],
    index: &HashMap<&str, usize>,
) -> Result<Vec<usize>, UrdfError> {
    let parent = |link: usize| above[link].and_then(|joint| index.get(joints[joint].parent).copied());
    let roots: Vec<usize> = (0..links.len()).filter(|&link| above[link].is_none()).collect();
    if let [first, second, ..] = roots[..] {
        let (other, line) = (links[first].name()?.to_owned(), links[first].line());
        return Err(links[second].error(UrdfFault::TwoRoots { other, line }));
    }
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    for link in 0..links.len() {
        if let Some(parent) = parent(link) {
            children[parent].push(link);
        }
    }
    let mut order = Vec::with_capacity(links.len());
    let mut waiting = roots;
    while let Some(link) = waiting.pop() {
        order.push(link);
        waiting.extend(children[link].iter().rev());
    }
    // With at most one root, a link that is not reached hangs on itself.
    let Some(lost) = (0..links.len()).find(|link| !order.contains(link)) else { return Ok(order) };
    let mut way = vec![lost];
    let mut at = lost;
    while let Some(next) = parent(at) {
        if let Some(start) = way.iter().position(|&link| link == next) {
            way.drain(..start);
            way.push(next);
            break;
        }
        way.push(next);
        at = next;
    }
    let names = way.iter().map(|&link| links[link].name().map(str::to_owned)).collect::<Result<_, _>>()?;
    Err(links[way[0]].error(UrdfFault::Loop { links: names }))
}
