//! The text of a problem file, with what is given in place of its values: what it says, and where.

mod document;
mod merge;
mod overrides;
mod path;
mod source;
mod syntax;

pub(super) use document::Document;
pub use overrides::{OverrideError, Overrides};
pub(super) use path::KeyPath;
pub(super) use source::Source;
pub(super) use syntax::{fault, read};
