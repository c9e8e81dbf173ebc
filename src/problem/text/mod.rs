//! The text of a problem file: what it says, and where.

mod document;
mod syntax;

pub(super) use document::{Document, KeyPath};
pub(super) use syntax::{fault, read};
