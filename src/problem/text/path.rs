//! Keys of a problem file, by the ways to them.

use std::fmt;

/// The way from the root of a document to a key: `robot.joints[2].a_mm`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct KeyPath(pub(super) Vec<Segment>);

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Segment {
    Key(String),
    Index(usize),
}

impl KeyPath {
    /// The path that `text` writes as [`Display`](fmt::Display) does, if it is one.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let mut path = Self::default();
        for part in text.split('.') {
            let (name, indices) = part.split_at(part.find('[').unwrap_or(part.len()));
            let is_bare =
                |name: &str| !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || "_-".contains(c));
            path = path.key(Some(name).filter(|name| is_bare(name))?);
            for index in indices.split_terminator(']') {
                path = path.at(index.strip_prefix('[')?.parse().ok()?);
            }
            if !indices.is_empty() && !indices.ends_with(']') {
                return None;
            }
        }
        Some(path)
    }

    /// The path of a section.
    pub(crate) fn section(name: &str) -> Self {
        Self::default().key(name)
    }

    /// The key `name` below this one.
    pub(crate) fn key(&self, name: &str) -> Self {
        self.then(Segment::Key(name.to_owned()))
    }

    /// Element `index` of this list.
    pub(crate) fn at(&self, index: usize) -> Self {
        self.then(Segment::Index(index))
    }

    /// The names of the keys on the way, indices left out.
    pub(crate) fn keys(&self) -> impl Iterator<Item = &str> {
        self.0.iter().filter_map(|segment| match segment {
            Segment::Key(name) => Some(name.as_str()),
            Segment::Index(_) => None,
        })
    }

    /// The name of the key itself.
    pub(crate) fn name(&self) -> &str {
        self.keys().last().unwrap_or_default()
    }

    fn then(&self, segment: Segment) -> Self {
        let mut path = self.clone();
        path.0.push(segment);
        path
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (i, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Key(name) => write!(f, "{}{name}", if i == 0 { "" } else { "." })?,
                Segment::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_read_as_they_are_written() {
        let path = KeyPath::default().key("robot").key("joints").at(2).key("limits_deg").at(1);
        assert_eq!(path.to_string(), "robot.joints[2].limits_deg[1]");
        assert_eq!(KeyPath::parse(&path.to_string()), Some(path.clone()));
        assert_eq!(path.name(), "limits_deg");
    }
}
