//! COLLADA.
//!
//! The up axis of the asset is not applied: ROS's tools do not either, and descriptions are written for them.

use std::collections::HashMap;
use std::rc::Rc;

use nalgebra::{Matrix4, Point3, Rotation3, Translation3, Unit, Vector3};
use roxmltree::{Node, NodeId};

use super::{MeshError, text};
use crate::formats::xml;

/// Deepest nesting of nodes, which instances of nodes could make endless.
const DEEPEST: usize = 64;

/// Most elements and corners of faces that a scene may come to: instances of instances multiply.
const MOST_ELEMENTS: usize = 10_000_000;
const MOST_CORNERS: usize = 20_000_000;

/// Elements whose vertices make faces.
const FACES: [&str; 5] = ["triangles", "polylist", "polygons", "trifans", "tristrips"];

/// The positions of every geometry in the scene, in m; of every geometry as it stands, without a scene.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<Point3<f64>>, MeshError> {
    let text = text(bytes);
    let document = xml::parse(&text).map_err(|error| MeshError::at(error.line(), error.to_string()))?;
    let root = document.root_element();
    let unit = match descendant(root, "unit").and_then(|unit| unit.attribute("meter")) {
        Some(meter) => meter.parse().map_err(|_| MeshError::at(1, format!("the unit is \"{meter}\" m")))?,
        None => 1.0,
    };
    let by_id = root.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let mut scene = Scene { by_id, positions: HashMap::new(), elements: 0, points: Vec::new() };
    let stated = descendant(root, "instance_visual_scene").and_then(|instance| scene.referred(instance, "url"));
    match stated.or_else(|| descendant(root, "visual_scene")) {
        Some(visual) => scene.place(visual, &Matrix4::identity(), 0)?,
        None => {
            for geometry in root.descendants().filter(|node| node.has_tag_name_of("geometry")) {
                scene.geometry(geometry, &Matrix4::identity())?;
            }
        }
    }
    Ok(scene.points.iter().map(|point| point * unit).collect())
}

struct Scene<'a> {
    by_id: HashMap<&'a str, Node<'a, 'a>>,
    /// The positions of the sources read so far, which many faces may share.
    positions: HashMap<NodeId, Rc<[Point3<f64>]>>,
    /// Elements gone through so far, each as often as it is instanced.
    elements: usize,
    points: Vec<Point3<f64>>,
}

/// Elements of any namespace by their name.
trait Named {
    fn has_tag_name_of(&self, name: &str) -> bool;
}

impl Named for Node<'_, '_> {
    fn has_tag_name_of(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

fn descendant<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.descendants().find(|node| node.has_tag_name_of(name))
}

fn line(node: Node<'_, '_>) -> usize {
    node.document().text_pos_at(node.range().start).row as usize
}

/// The numbers that an element holds.
fn numbers(node: Node<'_, '_>) -> Result<Vec<f64>, MeshError> {
    let number =
        |word: &str| word.parse().map_err(|_| MeshError::at(line(node), format!("\"{word}\" is not a number")));
    node.text().unwrap_or_default().split_whitespace().map(number).collect()
}

impl<'a> Scene<'a> {
    /// The element that an attribute refers to: `#id`.
    fn referred(&self, node: Node<'a, 'a>, attribute: &str) -> Option<Node<'a, 'a>> {
        self.by_id.get(node.attribute(attribute)?.trim_start_matches('#')).copied()
    }

    /// Adds what `node` holds, whose parent stands at `X`.
    fn place(&mut self, node: Node<'a, 'a>, X: &Matrix4<f64>, depth: usize) -> Result<(), MeshError> {
        if depth > DEEPEST {
            return Err(MeshError::at(line(node), "the nodes of the scene are nested too deeply"));
        }
        let mut X = *X;
        for child in node.children().filter(Node::is_element) {
            self.count(child)?;
            let name = child.tag_name().name();
            match name {
                "matrix" | "translate" | "rotate" | "scale" => X *= transform(child, name)?,
                "instance_geometry" => {
                    if let Some(geometry) = self.referred(child, "url") {
                        self.geometry(geometry, &X)?;
                    }
                }
                "instance_node" => {
                    if let Some(instance) = self.referred(child, "url") {
                        self.place(instance, &X, depth + 1)?;
                    }
                }
                "node" => self.place(child, &X, depth + 1)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Counts an element that is gone through, of which there may be so many.
    fn count(&mut self, node: Node<'a, 'a>) -> Result<(), MeshError> {
        self.elements += 1;
        if self.elements > MOST_ELEMENTS {
            let message = format!("the instances of the scene have more than {MOST_ELEMENTS} elements in all");
            return Err(MeshError::at(line(node), message));
        }
        Ok(())
    }

    /// Adds the positions that the faces of a geometry at `X` use.
    fn geometry(&mut self, geometry: Node<'a, 'a>, X: &Matrix4<f64>) -> Result<(), MeshError> {
        for faces in geometry.descendants() {
            self.count(faces)?;
            if !FACES.contains(&faces.tag_name().name()) {
                continue;
            }
            let inputs = || faces.children().filter(|node| node.has_tag_name_of("input"));
            let offset = |input: Node| input.attribute("offset").and_then(|offset| offset.parse::<usize>().ok());
            let Some(vertex) = inputs().find(|input| input.attribute("semantic") == Some("VERTEX")) else { continue };
            let Some(positions) = self.positions(vertex)? else { continue };
            let per_corner = inputs().filter_map(offset).max().unwrap_or(0) + 1;
            for p in faces.children().filter(|node| node.has_tag_name_of("p")) {
                let indices = p.text().unwrap_or_default().split_whitespace();
                for index in indices.skip(offset(vertex).unwrap_or(0)).step_by(per_corner) {
                    let position = index.parse().ok().and_then(|index: usize| positions.get(index));
                    let unknown = || MeshError::at(line(p), format!("there is no vertex \"{index}\""));
                    if self.points.len() == MOST_CORNERS {
                        let message = format!("the faces of the scene have more than {MOST_CORNERS} corners");
                        return Err(MeshError::at(line(p), message));
                    }
                    self.points.push(X.transform_point(position.ok_or_else(unknown)?));
                }
            }
        }
        Ok(())
    }

    /// The positions of the vertices that an input names.
    fn positions(&mut self, vertex: Node<'a, 'a>) -> Result<Option<Rc<[Point3<f64>]>>, MeshError> {
        let Some(vertices) = self.referred(vertex, "source") else { return Ok(None) };
        let position = vertices.children().find(|node| node.attribute("semantic") == Some("POSITION"));
        let Some(source) = position.and_then(|position| self.referred(position, "source")) else { return Ok(None) };
        if let Some(known) = self.positions.get(&source.id()) {
            return Ok(Some(Rc::clone(known)));
        }
        let Some(array) = descendant(source, "float_array") else { return Ok(None) };
        let stride = descendant(source, "accessor").and_then(|accessor| accessor.attribute("stride"));
        let stride = stride.and_then(|stride| stride.parse().ok()).unwrap_or(3).max(3);
        let numbers = numbers(array)?;
        let positions = numbers.chunks_exact(stride).map(|xyz| Point3::new(xyz[0], xyz[1], xyz[2])).collect();
        Ok(Some(Rc::clone(self.positions.entry(source.id()).or_insert(positions))))
    }
}

fn transform(node: Node<'_, '_>, name: &str) -> Result<Matrix4<f64>, MeshError> {
    let n = numbers(node)?;
    let X = match (name, &n[..]) {
        ("matrix", rows) if rows.len() == 16 => Some(Matrix4::from_row_slice(rows)),
        ("translate", &[x, y, z]) => Some(Translation3::new(x, y, z).to_homogeneous()),
        ("scale", &[x, y, z]) => Some(Matrix4::new_nonuniform_scaling(&Vector3::new(x, y, z))),
        ("rotate", &[x, y, z, degrees]) => Unit::try_new(Vector3::new(x, y, z), 0.0)
            .map(|axis| Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous()),
        _ => None,
    };
    X.ok_or_else(|| {
        MeshError::at(line(node), format!("<{name}> has {} numbers, which do not form a transform", n.len()))
    })
}
