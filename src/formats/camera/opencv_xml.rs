//! OpenCV's XML as the tree of its YAML.

use std::collections::HashSet;

use roxmltree::Node as Element;

use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::{Content, DEEPEST, Node};
use crate::formats::xml;

/// The value of the storage that `text` is.
pub(super) fn parse(text: &str) -> Result<Node, ReadError> {
    let document =
        xml::parse(text).map_err(|error| ReadFault::Syntax { message: error.to_string() }.at(error.line()))?;
    let root = document.root_element();
    if root.tag_name().name() != "opencv_storage" {
        let message =
            format!("the outermost element is <{}>; in OpenCV's XML it is <opencv_storage>", root.tag_name().name());
        return Err(ReadFault::Syntax { message }.at(line(root)));
    }
    node(root, 0)
}

fn line(element: Element) -> usize {
    element.document().text_pos_at(element.range().start).row as usize
}

/// A map where `element` has elements, a list where it is the numbers of a matrix or its elements have no names.
fn node(element: Element, depth: usize) -> Result<Node, ReadError> {
    let line = line(element);
    if depth > DEEPEST {
        return Err(ReadFault::Syntax { message: format!("nested deeper than {DEEPEST} levels") }.at(line));
    }
    let children: Vec<Element> = element.children().filter(Element::is_element).collect();
    let text = element.text().unwrap_or_default();
    let content = if children.is_empty() && element.tag_name().name() == "data" {
        numbers(text, line)
    } else if children.is_empty() {
        let text = text.trim();
        match text.strip_prefix('"').and_then(|text| text.strip_suffix('"')) {
            Some(quoted) => Content::Quoted(quoted.to_owned()),
            None => Content::Plain(text.to_owned()),
        }
    } else if children.iter().all(|child| child.tag_name().name() == "_") {
        Content::List(children.into_iter().map(|child| node(child, depth + 1)).collect::<Result<_, _>>()?)
    } else {
        let (mut map, mut names) = (Vec::new(), HashSet::new());
        for child in children {
            let name = child.tag_name().name();
            let value = node(child, depth + 1)?;
            if !names.insert(name) {
                return Err(ReadFault::Repeated { name: name.to_owned() }.at(value.line));
            }
            map.push((name.to_owned(), value));
        }
        Content::Map(map)
    };
    Ok(Node { line, content })
}

/// The words of `text`, which begins on `line`.
fn numbers(text: &str, line: usize) -> Content {
    let words = text.lines().enumerate().flat_map(|(below, words)| {
        let number = move |word: &str| Node { line: line + below, content: Content::Plain(word.to_owned()) };
        words.split_whitespace().map(number)
    });
    Content::List(words.collect())
}
