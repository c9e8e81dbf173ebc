//! Which numbers are allowed.

use std::fmt;
use std::ops::{Bound, RangeBounds};

/// An interval of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// Lower end.
    pub min: Bound<f64>,
    /// Upper end.
    pub max: Bound<f64>,
}

impl Allowed {
    /// From `min` to `max`, both included.
    pub(crate) const fn between(min: f64, max: f64) -> Self {
        Self { min: Bound::Included(min), max: Bound::Included(max) }
    }

    /// Greater than 0, at most `max`.
    pub(crate) const fn positive(max: f64) -> Self {
        Self { min: Bound::Excluded(0.0), max: Bound::Included(max) }
    }

    /// Whether `value` is in the interval; NaN never is.
    pub fn contains(&self, value: f64) -> bool {
        (self.min, self.max).contains(&value)
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match (self.min, self.max) {
            (Bound::Included(min), Bound::Included(max)) => write!(f, "from {} to {}", Number(min), Number(max)),
            (min, max) => {
                match min {
                    Bound::Included(min) => write!(f, "at least {}", Number(min))?,
                    Bound::Excluded(min) => write!(f, "greater than {}", Number(min))?,
                    Bound::Unbounded => {}
                }
                f.write_str(if min == Bound::Unbounded || max == Bound::Unbounded { "" } else { " and " })?;
                match max {
                    Bound::Included(max) => write!(f, "at most {}", Number(max)),
                    Bound::Excluded(max) => write!(f, "less than {}", Number(max)),
                    Bound::Unbounded => Ok(()),
                }
            }
        }
    }
}

/// A number as one would write it: very large and very small ones with an exponent.
pub(super) struct Number(pub(super) f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let size = self.0.abs();
        if size >= 1e7 || (size > 0.0 && size < 1e-4) { write!(f, "{:e}", self.0) } else { write!(f, "{}", self.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_hold_their_ends_and_no_nan() {
        let unit = Allowed::between(0.0, 1.0);
        assert!(unit.contains(0.0) && unit.contains(1.0));
        assert!(!unit.contains(-f64::MIN_POSITIVE) && !unit.contains(1.0f64.next_up()) && !unit.contains(f64::NAN));
        assert!(!Allowed::positive(1.0).contains(0.0) && Allowed::positive(1.0).contains(f64::MIN_POSITIVE));
        assert_eq!(unit.to_string(), "from 0 to 1");
        assert_eq!(Allowed::positive(1e9).to_string(), "greater than 0 and at most 1e9");
        let open = Allowed { min: Bound::Included(2.5), max: Bound::Unbounded };
        assert_eq!(open.to_string(), "at least 2.5");
    }
}
