//! What a plan says held against what is found.

use std::fmt::{Debug, Display};

use super::error::CertifyError;

pub(crate) fn different(what: &str, stated: f64, found: f64) -> CertifyError {
    CertifyError::Number { what: what.into(), stated, found }
}

pub(crate) fn other(what: &str, stated: &(impl Display + ?Sized), found: &(impl Display + ?Sized)) -> CertifyError {
    CertifyError::Other { what: what.into(), stated: stated.to_string(), found: found.to_string() }
}

/// Checks what is the same or not.
pub(crate) fn same<T: PartialEq + Display + ?Sized>(what: &str, stated: &T, found: &T) -> Result<(), CertifyError> {
    if stated == found { Ok(()) } else { Err(other(what, stated, found)) }
}

/// Checks a number to a share of it.
pub(crate) fn number(what: &str, stated: f64, found: f64, tolerance: f64) -> Result<(), CertifyError> {
    near(what, stated, found, tolerance * stated.abs().max(found.abs()))
}

/// Checks a number.
pub(crate) fn near(what: &str, stated: f64, found: f64, tolerance: f64) -> Result<(), CertifyError> {
    if (stated - found).abs() <= tolerance { Ok(()) } else { Err(different(what, stated, found)) }
}

/// Checks the numbers of a list by `check`.
pub(crate) fn numbers(
    what: &str,
    stated: &[f64],
    found: &[f64],
    check: impl Fn(&str, f64, f64) -> Result<(), CertifyError>,
) -> Result<(), CertifyError> {
    same(&format!("how many {what}s there are"), &stated.len(), &found.len())?;
    stated.iter().zip(found).try_for_each(|(&stated, &found)| check(&format!("a {what}"), stated, found))
}

/// Checks what is not a number or a text.
pub(crate) fn alike<T: PartialEq + Debug>(what: &str, stated: &T, found: &T) -> Result<(), CertifyError> {
    if stated == found { Ok(()) } else { Err(other(what, &format!("{stated:?}"), &format!("{found:?}"))) }
}
