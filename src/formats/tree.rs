//! YAML and its relatives as a tree of values that know their lines.

use std::collections::HashMap;
use std::fmt::Display;

use saphyr_parser::{Event, Parser, ScalarStyle};

use super::error::{ReadError, ReadFault};

/// Deeper nesting is an attack, not a camera.
pub(super) const DEEPEST: usize = 32;
/// So are more keys in one map.
const MOST_KEYS: usize = 1000;
/// And more values that aliases repeat: a few lines of aliases of aliases would stand for billions.
const MOST_REPEATED: usize = 1_000_000;

/// A value and its line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub(super) line: usize,
    pub(super) content: Content,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Content {
    /// A word or number without quotes.
    Plain(String),
    Quoted(String),
    List(Vec<Node>),
    Map(Vec<(String, Node)>),
}

/// A number and its line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Located {
    pub(super) line: usize,
    pub(super) value: f64,
}

impl Located {
    /// The number, which must be between `min` and `max`, both included.
    pub(super) fn between(self, key: &dyn Display, min: f64, max: f64) -> Result<f64, ReadError> {
        let Self { line, value } = self;
        if (min..=max).contains(&value) {
            Ok(value)
        } else {
            Err(ReadFault::OutOfRange { key: key.to_string(), value, min, max }.at(line))
        }
    }
}

/// The first document of `text`.
pub(super) fn parse(text: &str) -> Result<Node, ReadError> {
    let last_line = text.lines().count().max(1);
    if text.trim().is_empty() {
        return Err(ReadFault::Empty.at(last_line));
    }
    let text = plain_yaml(text);
    let mut events = Events { parser: Parser::new_from_str(&text), last_line, anchored: HashMap::new(), repeated: 0 };
    loop {
        match events.next()? {
            (Event::StreamStart | Event::DocumentStart(_) | Event::Nothing, _) => {}
            (Event::StreamEnd | Event::DocumentEnd, _) => return Err(ReadFault::Empty.at(last_line)),
            (event, line) => {
                let root = events.node(event, line, 0)?;
                // What follows the value, such as a second closing bracket, is a mistake of its own.
                return match events.next()? {
                    (Event::DocumentEnd, _) => Ok(root),
                    (_, line) => Err(syntax("something follows the end of the document", line)),
                };
            }
        }
    }
}

/// `text` with what YAML does not know replaced by blanks: OpenCV's directive `%YAML:1.0`, the `b` of mrcal's byte
/// strings.
fn plain_yaml(text: &str) -> String {
    let text = text.trim_start_matches('\u{feff}');
    let body = match text.strip_prefix("%YAML") {
        Some(rest) => rest.find('\n').map_or("", |newline| &rest[newline..]),
        None => text,
    };
    if body.contains("lensmodel") { body.replace(": b'", ":  '").replace(": b\"", ":  \"") } else { body.to_owned() }
}

fn syntax(message: &str, line: usize) -> ReadError {
    ReadFault::Syntax { message: message.to_owned() }.at(line)
}

struct Events<'t> {
    parser: Parser<'t, saphyr_parser::StrInput<'t>>,
    last_line: usize,
    /// The values that aliases may stand for, by their anchors.
    anchored: HashMap<usize, Node>,
    /// Values that aliases have repeated.
    repeated: usize,
}

impl<'t> Events<'t> {
    /// The next event, with its line.
    fn next(&mut self) -> Result<(Event<'t>, usize), ReadError> {
        match self.parser.next() {
            Some(Ok((event, span))) => Ok((event, span.start.line())),
            Some(Err(error)) => Err(syntax(error.info(), error.marker().line().min(self.last_line))),
            None => Err(syntax("the file ends too early", self.last_line)),
        }
    }

    /// The value that begins with `event`.
    fn node(&mut self, event: Event, line: usize, depth: usize) -> Result<Node, ReadError> {
        if depth > DEEPEST {
            return Err(syntax(&format!("nested deeper than {DEEPEST} levels"), line));
        }
        let anchor = match event {
            Event::Scalar(_, _, anchor, _) | Event::SequenceStart(anchor, _) | Event::MappingStart(anchor, _) => anchor,
            _ => 0,
        };
        let content = match event {
            Event::Scalar(text, ScalarStyle::Plain, ..) => Content::Plain(text.into_owned()),
            Event::Scalar(text, ..) => Content::Quoted(text.into_owned()),
            Event::SequenceStart(..) => {
                let mut list = Vec::new();
                loop {
                    match self.next()? {
                        (Event::SequenceEnd, _) => break Content::List(list),
                        (event, line) => list.push(self.node(event, line, depth + 1)?),
                    }
                }
            }
            Event::MappingStart(..) => self.map(depth)?,
            Event::Alias(anchor) => self.repeated(anchor, line, depth)?,
            _ => return Err(syntax("this is no value", line)),
        };
        let node = Node { line, content };
        if anchor > 0 {
            self.anchored.insert(anchor, node.clone());
        }
        Ok(node)
    }

    /// What the alias of `anchor` stands for.
    fn repeated(&mut self, anchor: usize, line: usize, depth: usize) -> Result<Content, ReadError> {
        let Some(node) = self.anchored.get(&anchor) else {
            return Err(syntax("the alias stands for a value that it is in", line));
        };
        let (values, levels) = node.extent();
        self.repeated += values;
        if self.repeated > MOST_REPEATED {
            return Err(syntax(&format!("aliases repeat more than {MOST_REPEATED} values"), line));
        }
        if depth + levels > DEEPEST {
            return Err(syntax(&format!("nested deeper than {DEEPEST} levels"), line));
        }
        Ok(node.content.clone())
    }

    fn map(&mut self, depth: usize) -> Result<Content, ReadError> {
        let mut map: Vec<(String, Node)> = Vec::new();
        loop {
            let key = match self.next()? {
                (Event::MappingEnd, _) => return Ok(Content::Map(map)),
                (Event::Scalar(key, ..), line) if map.iter().any(|(known, _)| *known == key) => {
                    return Err(ReadFault::Repeated { name: key.into_owned() }.at(line));
                }
                (_, line) if map.len() == MOST_KEYS => {
                    return Err(syntax(&format!("more than {MOST_KEYS} keys"), line));
                }
                (Event::Scalar(key, ..), _) => key.into_owned(),
                (_, line) => return Err(syntax("a key must be a string", line)),
            };
            let (event, line) = self.next()?;
            map.push((key, self.node(event, line, depth + 1)?));
        }
    }
}

impl Node {
    /// How many values there are in it, itself among them, and how many levels of them below it.
    fn extent(&self) -> (usize, usize) {
        let below: Vec<&Node> = match &self.content {
            Content::Plain(_) | Content::Quoted(_) => return (1, 0),
            Content::List(list) => list.iter().collect(),
            Content::Map(map) => map.iter().map(|(_, node)| node).collect(),
        };
        let extents = below.into_iter().map(Node::extent);
        extents.fold((1, 1), |(values, levels), (more, deeper)| (values + more, levels.max(1 + deeper)))
    }

    /// The value at `key`, if this is a map that has it.
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        match &self.content {
            Content::Map(map) => map.iter().find(|(name, _)| name == key).map(|(_, node)| node),
            _ => None,
        }
    }

    /// The value at `key`; `within` is the key of this map, with a point, or empty at the root.
    pub(super) fn require(&self, within: &str, key: &str) -> Result<&Node, ReadError> {
        let missing = || ReadFault::Missing { key: format!("{within}{key}") }.at(self.line);
        self.get(key).ok_or_else(missing)
    }

    /// The keys and values of a map; of anything else none.
    pub(super) fn entries(&self) -> &[(String, Node)] {
        match &self.content {
            Content::Map(map) => map,
            _ => &[],
        }
    }

    /// The value at the first of `keys` that this map has, with that key.
    pub(super) fn first_of<'k>(&self, keys: &[&'k str]) -> Option<(&'k str, &Node)> {
        keys.iter().find_map(|&key| Some((key, self.get(key)?)))
    }

    pub(super) fn list(&self, key: &dyn Display) -> Result<&[Node], ReadError> {
        match &self.content {
            Content::List(list) => Ok(list),
            _ => Err(self.mistyped(key, "a list")),
        }
    }

    /// A list of finite numbers, or of rows of them.
    pub(super) fn numbers(&self, key: &dyn Display) -> Result<Vec<Located>, ReadError> {
        if let Content::Plain(text) = &self.content
            && several_numbers(text)
        {
            return Err(ReadFault::Commas { key: key.to_string() }.at(self.line));
        }
        let mut numbers = Vec::new();
        for (i, node) in self.list(key)?.iter().enumerate() {
            match &node.content {
                Content::Plain(text) if several_numbers(text) => {
                    return Err(ReadFault::Commas { key: key.to_string() }.at(node.line));
                }
                Content::List(row) => {
                    for (j, node) in row.iter().enumerate() {
                        numbers.push(node.number(&format_args!("{key}[{i}][{j}]"))?);
                    }
                }
                _ => numbers.push(node.number(&format_args!("{key}[{i}]"))?),
            }
        }
        Ok(numbers)
    }

    pub(super) fn text(&self, key: &dyn Display) -> Result<&str, ReadError> {
        match &self.content {
            Content::Plain(text) | Content::Quoted(text) => Ok(text),
            _ => Err(self.mistyped(key, "a string")),
        }
    }

    pub(super) fn is_null(&self) -> bool {
        matches!(&self.content, Content::Plain(text) if matches!(text.as_str(), "" | "null" | "~"))
    }

    /// A finite number.
    pub(super) fn number(&self, key: &dyn Display) -> Result<Located, ReadError> {
        let value = match &self.content {
            Content::Plain(text) => text.parse().ok().filter(|value: &f64| value.is_finite()),
            _ => None,
        };
        let value = value.ok_or_else(|| self.mistyped(key, "a finite number"))?;
        Ok(Located { line: self.line, value })
    }

    /// A whole number from `min` to `max`.
    pub(super) fn count(&self, key: &dyn Display, min: u32, max: u32) -> Result<u32, ReadError> {
        let value = self.number(key)?.between(key, f64::from(min), f64::from(max))?;
        if value.fract() == 0.0 { Ok(value as u32) } else { Err(self.mistyped(key, "a whole number")) }
    }

    fn mistyped(&self, key: &dyn Display, expected: &'static str) -> ReadError {
        let found = match &self.content {
            Content::Plain(text) if text.is_empty() => "empty".into(),
            Content::Plain(text) => text.clone(),
            Content::Quoted(text) => format!("the string \"{text}\""),
            Content::List(_) => "a list".into(),
            Content::Map(_) => "a map".into(),
        };
        ReadFault::Type { key: key.to_string(), found, expected }.at(self.line)
    }
}

/// Whether `text` is numbers with nothing but blanks between them.
fn several_numbers(text: &str) -> bool {
    let mut words = text.split_whitespace();
    words.clone().count() > 1 && words.all(|word| word.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relatives_of_yaml_are_read_with_their_lines() {
        for text in [
            "%YAML:1.0\n---\na: !!opencv-matrix\n   data: [ 1., -2.5e-1,\n       .5 ]\n",
            "\n\n{ \"a\":\t{\n\t\"data\": [1.0, -0.25,\n\t0.5] } }",
            "# lensmodel\n\n{ 'x': b'}{#]',\n  'a': {'data': [1, -.25, # more\n 5e-1, ], }, }\n",
        ] {
            let root = parse(text).unwrap();
            let data = root.require("", "a").unwrap().require("a.", "data").unwrap();
            let numbers = data.list(&"data").unwrap().iter().map(|node| node.number(&"x").unwrap());
            let numbers: Vec<(f64, usize)> = numbers.map(|x| (x.value, x.line)).collect();
            assert_eq!(numbers, [(1.0, 4), (-0.25, 4), (0.5, 5)], "{text}");
        }
    }

    #[test]
    fn bottomless_nesting_is_refused() {
        for text in ["[".repeat(100_000), "{a: ".repeat(100_000), "- ".repeat(100_000)] {
            assert!(parse(&text).is_err());
        }
    }

    #[test]
    fn aliases_repeat_what_they_stand_for_within_limits() {
        let root = parse("a: &x [1, &y 2]\nb: *x\n\nc: *y\n").unwrap();
        let numbers = root.require("", "b").unwrap().numbers(&"b").unwrap();
        assert_eq!(numbers.iter().map(|number| number.value).collect::<Vec<_>>(), [1.0, 2.0]);
        let c = root.require("", "c").unwrap();
        assert_eq!((c.number(&"c").unwrap().value, c.line), (2.0, 4));
        let refused = |text: &str| parse(text).unwrap_err().to_string();
        assert!(refused("a: &x [*x]").contains("that it is in"));
        // Ten lines for ten billion.
        let bomb: String = (1..=10).map(|i| format!("- &a{i} [{}]\n", format!("*a{}, ", i - 1).repeat(10))).collect();
        assert!(refused(&format!("- &a0 1\n{bomb}")).contains("more than 1000000 values"));
        let tower: String = (1..=40).map(|i| format!("- &a{i} [*a{}]\n", i - 1)).collect();
        assert!(refused(&format!("- &a0 1\n{tower}")).contains("nested deeper than 32 levels"));
    }
}
