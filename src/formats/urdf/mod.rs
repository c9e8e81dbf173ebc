//! Robot descriptions: URDF, and the pairs that an SRDF never tests for collision.
//!
//! Read from the XML tree itself, because only that knows the line of what is wrong.

mod element;
mod error;
mod joint;
mod link;
mod mesh_folders;
mod note;
mod range;
mod srdf;

pub use error::{UrdfError, UrdfFault};
pub use note::{UrdfNote, UrdfRemark};
pub use range::StatedRange;
pub use srdf::read_srdf;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use element::{Element, parse};
use joint::{UrdfJoint, motions};
use link::Meshes;
use mesh_folders::MeshFolders;

use crate::robot::{Body, Link, Mechanism, Motion, Tree};
use crate::spatial::Pose;

/// More links are no robot's; what is done with pairs of them takes its time.
const MOST_LINKS: usize = 1000;
/// More bodies likewise.
const MOST_BODIES: usize = 5000;

/// A robot description as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Name of the robot; empty if it has none.
    pub name: String,
    /// The robot. The limits of its joints are [`StatedRange::limits`].
    pub mechanism: Mechanism,
    /// What is stated of the ranges of the mechanism's joints.
    pub ranges: Vec<StatedRange>,
    /// Links whose joint is to move in a way that cannot be followed, and why. Each stands where the joint is at 0.
    pub stuck: Vec<(usize, UrdfError)>,
    /// What was put right or left out.
    pub notes: Vec<UrdfNote>,
}

/// The robot that a URDF describes. Its meshes are sought from `folder`, the description's own, and in `package_folders`, which
/// are packages or hold them; the solid of a mesh is its convex hull.
///
/// Links come parents first, otherwise as in the file. The limits of a joint that mimics another are not looked at.
///
/// ```
/// use std::path::Path;
///
/// use calipose::formats::read_urdf;
///
/// let text = r#"<robot name="arm"><link name="base"/><link name="hand"/>
///     <joint name="shoulder" type="revolute"><parent link="base"/><child link="hand"/><axis xyz="0 0 1"/>
///         <limit lower="-1" upper="2" effort="1" velocity="1"/></joint></robot>"#;
/// let robot = read_urdf(text, Path::new(""), &[])?;
/// assert_eq!(robot.name, "arm");
/// assert_eq!(robot.mechanism.tree.links.len(), 2);
/// # Ok::<(), calipose::formats::UrdfError>(())
/// ```
///
/// # Errors
/// When the text is not the URDF of a tree of links, or a mesh cannot be read.
pub fn read_urdf(text: &str, folder: &Path, package_folders: &[PathBuf]) -> Result<Description, UrdfError> {
    let mut meshes = Meshes::new(MeshFolders::new(folder, package_folders));
    described(text, &mut |link, notes| link::bodies(link, &mut meshes, notes))
}

/// A robot description without the robot's bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The robot; no link has a body.
    pub description: Description,
    /// How many `<collision>` elements were passed over.
    pub collisions: usize,
    /// The files that their meshes are named by.
    pub meshes: Vec<String>,
}

/// As [`read_urdf`], without the robot's bodies and so without its meshes.
///
/// ```
/// use calipose::formats::outline_urdf;
///
/// let text = r#"<robot name="rock"><link name="base">
///     <collision><geometry><mesh filename="package://rock/base.stl"/></geometry></collision></link></robot>"#;
/// assert_eq!(outline_urdf(text)?.meshes, ["package://rock/base.stl"]);
/// # Ok::<(), calipose::formats::UrdfError>(())
/// ```
///
/// # Errors
/// When the text is not the URDF of a tree of links.
pub fn outline_urdf(text: &str) -> Result<Outline, UrdfError> {
    let (mut collisions, mut meshes) = (0, Vec::new());
    let description = described(text, &mut |link, _| {
        collisions += link.all("collision").count();
        let shapes = link.all("collision").filter_map(|collision| collision.child("geometry")?.child("mesh"));
        meshes.extend(shapes.filter_map(|mesh| mesh.attribute("filename")).map(str::to_owned));
        Ok(Vec::new())
    })?;
    Ok(Outline { description, collisions, meshes })
}

/// The bodies of a link, and notes about them.
type Bodies<'b> = dyn FnMut(Element<'_>, &mut Vec<UrdfNote>) -> Result<Vec<Body>, UrdfError> + 'b;

fn described(text: &str, bodies: &mut Bodies) -> Result<Description, UrdfError> {
    let document = parse(text)?;
    let robot = Element::root(&document);
    if robot.tag() != "robot" {
        return Err(robot.error(UrdfFault::Root { found: robot.tag().into() }));
    }
    let links: Vec<Element> = robot.all("link").collect();
    if links.is_empty() {
        return Err(robot.error(UrdfFault::NoLinks));
    }
    let elements: Vec<Element> = robot.all("joint").collect();
    let collisions = links.iter().map(|link| link.all("collision").count()).sum();
    for (tag, found, most) in [
        ("link", links.len(), MOST_LINKS),
        ("joint", elements.len(), MOST_LINKS),
        ("collision", collisions, MOST_BODIES),
    ] {
        if found > most {
            return Err(robot.error(UrdfFault::TooMany { tag, found, most }));
        }
    }
    let index = numbered(&links)?;
    numbered(&elements)?;
    let joints = elements.into_iter().map(UrdfJoint::read).collect::<Result<Vec<_>, _>>()?;
    let above = joints_above(&joints, &index)?;
    let motions = motions(&joints);
    let mut notes: Vec<UrdfNote> = joints.iter().filter_map(UrdfJoint::note).collect();

    let mut tree = Tree::default();
    let mut place: HashMap<&str, usize> = HashMap::new();
    for i in parents_first(&links, &joints, &above, &index)? {
        let (element, name) = (links[i], links[i].name()?);
        let (parent, X_PJ, motion) = match above[i] {
            None => (None, Pose::identity(), Motion::Fixed),
            Some(joint) => {
                let motion = motions.of_joints[joint].clone();
                (place.get(joints[joint].parent).copied(), joints[joint].X_PJ, motion)
            }
        };
        let (bodies, mass) = (bodies(element, &mut notes)?, link::mass(element)?);
        place.insert(name, tree.links.len());
        tree.links.push(Link { name: name.into(), parent, X_PJ, motion, bodies, mass });
    }
    notes.sort_by_key(|note| note.line);
    let stuck = motions.stuck.into_iter();
    let stuck = stuck.filter_map(|(joint, error)| Some((*place.get(joints[joint].child)?, error))).collect();
    let followers = joints.iter().filter(|joint| joint.mimics()).map(|joint| joint.name.to_owned()).collect();
    let (free, ranges) = motions.free.into_iter().unzip();
    let name = robot.attribute("name").unwrap_or_default().trim().to_owned();
    Ok(Description { name, mechanism: Mechanism { tree, joints: free, followers }, ranges, stuck, notes })
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
    let mut reached = vec![false; links.len()];
    for &link in &order {
        reached[link] = true;
    }
    let Some(lost) = reached.iter().position(|&reached| !reached) else { return Ok(order) };
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
