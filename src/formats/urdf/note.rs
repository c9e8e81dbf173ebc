//! What of a robot description is read otherwise than it stands there.

use std::fmt;

/// Something that was put right or left out, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfNote {
    /// Line, from 1.
    pub line: usize,
    /// The link or joint: `joint "elbow"`.
    pub element: Option<String>,
    /// What was done.
    pub remark: UrdfRemark,
}

/// What was put right or left out.
#[derive(Debug, Clone, PartialEq)]
pub enum UrdfRemark {
    /// A `<collision>` has no shape.
    EmptyCollision,
    /// A shape has no extent.
    EmptyShape {
        /// Its tag.
        shape: String,
    },
    /// An axis is not a unit vector.
    AxisNormalised {
        /// Its length.
        length: f64,
    },
    /// A pair without collision test has a link that the robot does not have.
    UnknownLink {
        /// Its name.
        name: String,
    },
}

impl fmt::Display for UrdfNote {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "line {}", self.line)?;
        if let Some(element) = &self.element {
            write!(f, ", {element}")?;
        }
        write!(f, ": {}", self.remark)
    }
}

impl fmt::Display for UrdfRemark {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::EmptyCollision => f.write_str("the <collision> has no shape and is left out"),
            Self::EmptyShape { shape } => write!(f, "the <{shape}> has no extent and is left out"),
            Self::AxisNormalised { length } => {
                write!(f, "the axis has length {} and is normalised", (length * 1e6).round() / 1e6)
            }
            Self::UnknownLink { name } => write!(f, "there is no link \"{name}\"; its pairs are left out"),
        }
    }
}
