//! The ranges of joints: limits, and the tighter ones of a safety controller.

use super::element::Element;
use super::error::{UrdfError, UrdfFault};
use crate::robot::Limits;

/// What a description states of a joint's range, in rad or m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StatedRange {
    /// Whether the joint turns without end.
    pub continuous: bool,
    /// Its `<limit>`; none where that is left out, or has neither end, as it may for continuous joints.
    pub limit: Option<Limits>,
    /// The range that its `<safety_controller>` lets it move in, unbounded at an end that is not stated.
    pub soft: Option<Limits>,
}

impl StatedRange {
    /// Whether limits are wanting: not stated, or from 0 to 0, as exporters write that do not know them.
    pub fn is_blank(&self) -> bool {
        let Limits { min, max } = self.bounds();
        !self.continuous && (min.is_infinite() || max.is_infinite())
    }

    /// The bounds that the description sets: both the limits and the soft ones hold. Infinite where there are none.
    pub fn bounds(&self) -> Limits {
        let none = Limits { min: f64::NEG_INFINITY, max: f64::INFINITY };
        let hard = self.limit.filter(|limit| limit.min != 0.0 || limit.max != 0.0).unwrap_or(none);
        let soft = self.soft.unwrap_or(none);
        Limits { min: hard.min.max(soft.min), max: hard.max.min(soft.max) }
    }

    /// The limits to move in, where nobody else states them: the bounds; for a continuous joint without any a whole turn, half
    /// of it either way; none but the value nearest to 0 for a joint whose limits are wanting.
    pub fn limits(&self) -> Limits {
        let Limits { min, max } = self.bounds();
        let turn = Limits::FULL_TURN.max - Limits::FULL_TURN.min;
        match (min.is_finite(), max.is_finite()) {
            (true, true) => Limits { min, max },
            _ if !self.continuous => {
                let rest = 0f64.max(min).min(max);
                Limits { min: rest, max: rest }
            }
            (true, false) => Limits { min, max: min + turn },
            (false, true) => Limits { min: max - turn, max },
            (false, false) => Limits::FULL_TURN,
        }
    }

    /// Whether the safety controller's range is tighter than the limits.
    pub fn is_softened(&self) -> bool {
        let Limits { min, max } = self.bounds();
        self.soft.is_some() && self.limit.is_none_or(|limit| limit.min < min || max < limit.max)
    }

    /// The range of a joint that mimics no other; `bounded` joints end somewhere.
    pub(super) fn read(joint: Element<'_>, bounded: bool) -> Result<Self, UrdfError> {
        let limit = if bounded { joint.child("limit") } else { None };
        let stated = match limit {
            None => None,
            Some(limit) => {
                let lower = limit.number("lower")?.unwrap_or(0.0);
                let upper = limit.number("upper")?.unwrap_or(0.0);
                if lower > upper {
                    return Err(limit.error(UrdfFault::LimitsReversed { lower, upper }));
                }
                Some(Limits { min: lower, max: upper })
            }
        };
        let range = Self { continuous: !bounded, limit: stated, soft: soft(joint)? };
        let Limits { min: lower, max: upper } = range.bounds();
        if lower > upper {
            return Err(joint.error(UrdfFault::SoftLimitsOutside { lower, upper }));
        }
        Ok(range)
    }
}

/// The soft limits of a joint's safety controller. Both are 0 by default, which says that there are none.
fn soft(joint: Element<'_>) -> Result<Option<Limits>, UrdfError> {
    let Some(controller) = joint.child("safety_controller") else { return Ok(None) };
    let lower = controller.number("soft_lower_limit")?;
    let upper = controller.number("soft_upper_limit")?;
    if lower.unwrap_or(0.0) == 0.0 && upper.unwrap_or(0.0) == 0.0 {
        return Ok(None);
    }
    let soft = Limits { min: lower.unwrap_or(f64::NEG_INFINITY), max: upper.unwrap_or(f64::INFINITY) };
    if soft.min > soft.max {
        return Err(controller.error(UrdfFault::LimitsReversed { lower: soft.min, upper: soft.max }));
    }
    Ok(Some(soft))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::urdf::element::parse;

    fn range(bounded: bool, inside: &str) -> Result<StatedRange, String> {
        let text = format!("<joint>{inside}</joint>");
        let document = parse(&text).unwrap();
        StatedRange::read(Element::root(&document), bounded).map_err(|error| error.fault.to_string())
    }

    fn limits(min: f64, max: f64) -> Limits {
        Limits { min, max }
    }

    #[test]
    fn the_tighter_of_limits_and_soft_limits_holds_at_either_end() {
        let softened = |soft: &str| {
            let text = format!("<limit lower='-1' upper='2'/><safety_controller {soft}/>");
            range(true, &text).map(|range| (range.limits(), range.is_softened()))
        };
        assert_eq!(softened("soft_lower_limit='-0.5' soft_upper_limit='3'"), Ok((limits(-0.5, 2.0), true)));
        assert_eq!(softened("soft_lower_limit='-2' soft_upper_limit='2'"), Ok((limits(-1.0, 2.0), false)));
        assert_eq!(softened("soft_upper_limit='1.5'"), Ok((limits(-1.0, 1.5), true)));
        for none in ["k_velocity='10'", "soft_lower_limit='0' soft_upper_limit='0.0' k_velocity='1'"] {
            assert_eq!(softened(none), Ok((limits(-1.0, 2.0), false)), "{none}");
        }
        assert!(softened("soft_lower_limit='2' soft_upper_limit='1'").is_err());
        assert!(softened("soft_lower_limit='3' soft_upper_limit='4'").is_err());
    }

    #[test]
    fn limits_that_are_not_filled_in_are_none() {
        let blank = |bounded, inside| range(bounded, inside).map(|range| (range.is_blank(), range.bounds()));
        let none = limits(f64::NEG_INFINITY, f64::INFINITY);
        for inside in ["", "<limit effort='1'/>", "<limit lower='0' upper='0'/>"] {
            assert_eq!(blank(true, inside), Ok((true, none)), "{inside}");
        }
        assert_eq!(blank(true, "<limit lower='1' upper='1'/>"), Ok((false, limits(1.0, 1.0))));
        assert_eq!(blank(false, "<limit lower='-1' upper='1'/>"), Ok((false, none)));
        assert_eq!(range(false, "").map(|range| range.limits()), Ok(Limits::FULL_TURN));
        let kept = range(false, "<safety_controller soft_lower_limit='-1' soft_upper_limit='2'/>").unwrap();
        assert_eq!((kept.limits(), kept.is_softened()), (limits(-1.0, 2.0), true));
        let soft = range(true, "<safety_controller soft_lower_limit='0.5' soft_upper_limit='2'/>").unwrap();
        assert_eq!((soft.limits(), soft.is_blank()), (limits(0.5, 2.0), false));
    }
}
