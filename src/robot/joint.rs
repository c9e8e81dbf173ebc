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
    /// Values that it can be told.
    pub resolution: Resolution,
    /// Least distance in rad or m that a pose keeps from either limit.
    pub limit_margin: f64,
}

/// The joint values that a robot can be told: whole multiples of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    kind: JointKind,
    /// In the joint's display unit; 0 where any value can be told.
    step: f64,
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
    /// `revolute` or `prismatic`.
    pub fn adjective(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
        }
    }

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

impl Joint {
    /// A joint that can be told any value up to its limits.
    pub fn free(name: String, kind: JointKind, limits: Limits, max_speed: Option<f64>) -> Self {
        Self { name, kind, limits, max_speed, resolution: Resolution::new(kind, 0.0), limit_margin: 0.0 }
    }

    /// The range that poses keep to: the limits less the margin.
    pub fn range(&self) -> Limits {
        Limits { min: self.limits.min + self.limit_margin, max: self.limits.max - self.limit_margin }
    }

    /// Whether a joint value is as far from the limits as poses keep.
    pub fn keeps_margin(&self, value: f64) -> bool {
        self.limit_margin == 0.0 || self.range().holds(value)
    }
}

/// Rounding of joint values, rad or m.
const SLACK: f64 = 1e-12;

/// Rounding, as a share of a step: 0.1° and 36.7° are no binary fractions of a rad.
const ROUNDING: f64 = 1e-9;

impl Resolution {
    /// Of a joint of that kind, in steps of `step` degrees (mm); 0 where any value can be told.
    pub fn new(kind: JointKind, step: f64) -> Self {
        Self { kind, step }
    }

    /// The step in degrees (mm); 0 where any value can be told.
    pub fn step(self) -> f64 {
        self.step
    }

    /// The value next to `value` (rad or m) that can be told within `limits`; `value` itself where there is none.
    pub fn nearest(self, value: f64, limits: &Limits) -> f64 {
        let Self { kind, step } = self;
        if step == 0.0 {
            return value;
        }
        let in_steps = |value: f64| kind.to_display(value) / step;
        let least = (in_steps(limits.min) - ROUNDING).ceil();
        let greatest = (in_steps(limits.max) + ROUNDING).floor();
        if least > greatest {
            return value;
        }
        let steps = in_steps(value).round().clamp(least, greatest);
        // 1234 hundredths are 12.34, which 1234 times a hundredth is not.
        let per_unit = (1.0 / step).round();
        let is_part = (per_unit * step - 1.0).abs() < ROUNDING;
        kind.in_si(if is_part { steps / per_unit } else { steps * step })
    }
}

impl Limits {
    /// Half a turn either way: every direction of a joint without limits.
    pub const FULL_TURN: Self = Self { min: -std::f64::consts::PI, max: std::f64::consts::PI };

    /// Whether the value is within the range, but for rounding.
    pub fn holds(&self, value: f64) -> bool {
        (self.min - SLACK..=self.max + SLACK).contains(&value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_decimals_in_the_unit_that_people_read() {
        let limits = Limits { min: (-200f64).to_radians(), max: 200f64.to_radians() };
        let hundredths = Resolution::new(JointKind::Revolute, 0.01);
        assert_eq!(hundredths.nearest(12.3449f64.to_radians(), &limits), 12.34f64.to_radians());
        assert_eq!(hundredths.nearest(-214.2f64.to_radians(), &limits), (-200f64).to_radians());
        let swept = -88.2f64.to_radians() + 3.0 * 8f64.to_radians();
        assert_eq!(hundredths.nearest(swept, &limits), (-64.2f64).to_radians());
        let quarters = Resolution::new(JointKind::Prismatic, 0.25);
        assert_eq!(quarters.nearest(0.01013, &limits), 0.01025);
        assert_eq!(Resolution::new(JointKind::Revolute, 7.0).nearest(0.3, &limits), 14f64.to_radians());
        assert_eq!(Resolution::new(JointKind::Revolute, 0.0).nearest(0.3, &limits), 0.3);
    }

    #[test]
    fn values_stay_within_the_limits() {
        let limits = Limits { min: 0.004f64.to_radians(), max: 0.026f64.to_radians() };
        let hundredths = Resolution::new(JointKind::Revolute, 0.01);
        assert_eq!(hundredths.nearest(limits.min, &limits), 0.01f64.to_radians());
        assert_eq!(hundredths.nearest(limits.max, &limits), 0.02f64.to_radians());
        // Between two steps there is none.
        let narrow = Limits { min: 0.011f64.to_radians(), max: 0.019f64.to_radians() };
        assert_eq!(hundredths.nearest(narrow.max, &narrow), narrow.max);
        // A limit that is a step itself, but for rounding.
        let limits = Limits { min: -216.9f64.to_radians(), max: 0.0 };
        assert_eq!(hundredths.nearest(limits.min, &limits), limits.min);
        let joint = Joint {
            resolution: hundredths,
            limit_margin: 0.5f64.to_radians(),
            ..Joint::free("elbow".into(), JointKind::Revolute, limits, None)
        };
        let settable = |value: f64| hundredths.nearest(value, &joint.range());
        assert_eq!(settable(0.0), (-0.5f64).to_radians());
        assert_eq!(settable(-9.0), (-216.4f64).to_radians());
        assert!(joint.keeps_margin((-0.5f64).to_radians()) && !joint.keeps_margin((-0.49f64).to_radians()));
    }
}
