//! The text of a problem file, with what is given in place of its values: what it says, and where.

mod document;
mod merge;
mod overrides;
mod syntax;
mod unreadable;

pub(super) use super::key_path::KeyPath;
pub(super) use document::{Document, Source};
pub use overrides::{OverrideError, Overrides};
pub(super) use syntax::{fault, read};
