//! Files that state experiments, as written.

mod design;
mod factor;
mod study;

pub(super) use design::{DesignFile, Search, Surface};
pub(super) use factor::{Factor, Range, Scale};
pub(super) use study::{Choose, Design, DesignKind, Sequence, Simulate, StudyFile};
