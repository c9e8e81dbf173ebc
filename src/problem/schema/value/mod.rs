//! Values of the problem file that are more than one number or text.

mod flexible;
mod named;
mod pose;

pub(crate) use flexible::{NumberOrList, Numbers, Range, RangeOrSets, TextOrTable};
pub(crate) use named::{Choice, MountName, Named};
pub(crate) use pose::Pose;
