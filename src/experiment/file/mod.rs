//! Files that state experiments, as written.

mod factor;
mod study;

pub(super) use factor::{Draw, Factor, Range, Scale};
pub(super) use study::{Choose, Design, DesignKind, Sequence, Simulate, StudyFile};
