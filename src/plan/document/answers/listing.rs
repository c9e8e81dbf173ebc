//! Documents that list poses, of whatever kind.

use super::next::NextDocument;
use crate::plan::document::header::{Document, Header};
use crate::plan::document::plan::{Plan, PlanReadError, PolishedPlan, read};

/// Checks that `text` is a document whose poses can be read: a plan, a polished one, or poses proposed to be taken next.
///
/// # Errors
/// When it is not JSON, another document, or of a version that this program does not know.
pub fn lists_poses(text: &str) -> Result<(), PlanReadError> {
    let kinds = [
        (Plan::FORMAT, Plan::VERSION),
        (PolishedPlan::FORMAT, PolishedPlan::VERSION),
        (NextDocument::FORMAT, NextDocument::VERSION),
    ];
    read::<Header>(text, &kinds).map(drop)
}
