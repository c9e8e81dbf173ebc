//! XML elements with typed attributes, and the place of what is wrong with them.

use nalgebra::{Translation3, UnitQuaternion};
use roxmltree::{Document, Error, Node};

use super::error::{UrdfError, UrdfFault};
use super::note::{UrdfNote, UrdfRemark};
use crate::formats::xml::{self, XmlError};
use crate::spatial::Pose;

/// An element of a robot description.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element<'a>(Node<'a, 'a>);

/// The XML document of `text`, which must be expanded.
pub(super) fn parse(text: &str) -> Result<Document<'_>, UrdfError> {
    let document = xml::parse(text).map_err(|error| {
        let fault = match &error {
            XmlError::Syntax(Error::UnknownNamespace(prefix, _)) if prefix == "xacro" => {
                UrdfFault::Xacro { found: "xacro:".into() }
            }
            _ => UrdfFault::Syntax { message: error.to_string() },
        };
        UrdfError { line: error.line(), element: None, fault }
    })?;
    for node in document.descendants().filter(Node::is_element) {
        let of_xacro = node.tag_name().namespace().is_some_and(|namespace| namespace.contains("xacro"));
        let found = if of_xacro {
            Some(format!("<xacro:{}>", node.tag_name().name()))
        } else {
            let values = node.attributes().map(|attribute| attribute.value());
            values.chain(node.text()).find(|value| value.contains("${") || value.contains("$(")).map(str::to_owned)
        };
        if let Some(found) = found {
            return Err(Element(node).error(UrdfFault::Xacro { found: found.trim().to_owned() }));
        }
    }
    Ok(document)
}

impl<'a> Element<'a> {
    pub(super) fn root(document: &'a Document<'a>) -> Self {
        Self(document.root_element())
    }

    pub(super) fn tag(&self) -> &'a str {
        self.0.tag_name().name()
    }

    /// Line of the element, from 1.
    pub(super) fn line(&self) -> usize {
        self.0.document().text_pos_at(self.0.range().start).row as usize
    }

    /// The link or joint around this element: `joint "elbow"`.
    fn surrounding(&self) -> Option<String> {
        let named =
            |node: &Node| matches!(node.tag_name().name(), "link" | "joint") && node.attribute("name").is_some();
        let name =
            |node: Node| format!("{} \"{}\"", node.tag_name().name(), node.attribute("name").unwrap_or_default());
        self.0.ancestors().find(named).map(name)
    }

    /// `fault` in the link or joint around this element.
    pub(super) fn error(&self, fault: UrdfFault) -> UrdfError {
        UrdfError { line: self.line(), element: self.surrounding(), fault }
    }

    /// `remark` on the link or joint around this element.
    pub(super) fn note(&self, remark: UrdfRemark) -> UrdfNote {
        UrdfNote { line: self.line(), element: self.surrounding(), remark }
    }

    pub(super) fn children(&self) -> impl Iterator<Item = Element<'a>> + use<'a> {
        self.0.children().filter(Node::is_element).map(Element)
    }

    /// The children with that tag.
    pub(super) fn all(&self, tag: &'static str) -> impl Iterator<Item = Element<'a>> + use<'a> {
        self.children().filter(move |child| child.tag() == tag)
    }

    /// The first child with that tag.
    pub(super) fn child(&self, tag: &'static str) -> Option<Element<'a>> {
        self.all(tag).next()
    }

    /// The child with that tag, which must be there.
    pub(super) fn required_child(&self, tag: &'static str) -> Result<Element<'a>, UrdfError> {
        self.child(tag).ok_or_else(|| self.error(UrdfFault::Missing { what: format!("<{tag}>") }))
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        self.0.attribute(name)
    }

    /// The attribute, which must be there.
    pub(super) fn required(&self, name: &str) -> Result<&'a str, UrdfError> {
        let missing = || self.error(UrdfFault::Missing { what: format!("`{name}` of <{}>", self.tag()) });
        self.attribute(name).ok_or_else(missing)
    }

    /// The element's name.
    pub(super) fn name(&self) -> Result<&'a str, UrdfError> {
        let name = self.required("name")?.trim();
        if name.is_empty() { Err(self.error(UrdfFault::Unnamed)) } else { Ok(name) }
    }

    /// Exactly `N` finite numbers, if the attribute is there.
    pub(super) fn numbers<const N: usize>(&self, attribute: &str) -> Result<Option<[f64; N]>, UrdfError> {
        let Some(text) = self.attribute(attribute) else { return Ok(None) };
        let numbers: Option<Vec<f64>> =
            text.split_whitespace().map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect();
        match numbers.and_then(|numbers| numbers.try_into().ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(self.error(UrdfFault::Numbers { attribute: attribute.into(), text: text.into(), expected: N })),
        }
    }

    /// A finite number, if the attribute is there.
    pub(super) fn number(&self, attribute: &str) -> Result<Option<f64>, UrdfError> {
        Ok(self.numbers::<1>(attribute)?.map(|[number]| number))
    }

    /// Sizes in m, none negative.
    pub(super) fn sizes<const N: usize>(&self, attribute: &'static str) -> Result<[f64; N], UrdfError> {
        self.required(attribute)?;
        let sizes = self.numbers::<N>(attribute)?.unwrap_or([0.0; N]);
        match sizes.iter().find(|&&size| size < 0.0) {
            Some(&value) => Err(self.error(UrdfFault::Negative { what: attribute, value })),
            None => Ok(sizes),
        }
    }

    /// The pose that the child `<origin>` states; the identity without one.
    pub(super) fn origin(&self) -> Result<Pose, UrdfError> {
        let Some(origin) = self.child("origin") else { return Ok(Pose::identity()) };
        let [x, y, z] = origin.numbers("xyz")?.unwrap_or_default();
        let [roll, pitch, yaw] = origin.numbers("rpy")?.unwrap_or_default();
        Ok(Pose::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw)))
    }
}
