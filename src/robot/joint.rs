//! A joint: how it moves, how far and in which units.

/// One joint of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, as the robot's driver knows it.
    pub name: String,
    /// How the joint moves.
    pub kind: JointKind,
    /// Range of joint values.
    pub limits: Limits,
    /// Largest speed in rad/s or m/s, where known.
    pub max_speed: Option<f64>,
}

/// The motion of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Rotation about the axis, in rad.
    Revolute,
    /// Translation along the axis, in m.
    Prismatic,
}

impl JointKind {
    /// Unit of joint values: `rad` or `m`.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad",
            Self::Prismatic => "m",
        }
    }

    /// Unit of joint values as people read them: `deg` or `mm`.
    pub fn display_unit(self) -> &'static str {
        match self {
            Self::Revolute => "deg",
            Self::Prismatic => "mm",
        }
    }

    /// The same behind a number: `°`, or ` mm`.
    pub fn display_sign(self) -> &'static str {
        match self {
            Self::Revolute => "°",
            Self::Prismatic => " mm",
        }
    }

    /// A joint value in its display unit.
    pub fn to_display(self, value: f64) -> f64 {
        match self {
            Self::Revolute => value.to_degrees(),
            Self::Prismatic => value * 1e3,
        }
    }

    /// The joint value, in rad or m, that is `value` in its display unit.
    pub fn in_si(self, value: f64) -> f64 {
        match self {
            Self::Revolute => value.to_radians(),
            Self::Prismatic => value / 1e3,
        }
    }
}

/// A closed range of joint values in rad or m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

impl Limits {
    /// Half a turn either way: every direction of a joint without limits.
    pub const FULL_TURN: Self = Self { min: -std::f64::consts::PI, max: std::f64::consts::PI };
}
