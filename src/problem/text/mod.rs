//! The text of a problem file, with what is given in place of its values: what it says, and where.

mod at;
mod document;
mod merge;
mod overrides;
mod path;
mod source;
mod syntax;

pub(crate) use at::{At, Optional, key};
pub(crate) use document::Document;
pub(crate) use merge::excluded_by;
pub use overrides::{OverrideError, Overrides};
pub(crate) use path::KeyPath;
pub(crate) use source::Source;
pub(crate) use syntax::{fault, read};
