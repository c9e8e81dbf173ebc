//! Files that this program wrote before, which it may replace.

use std::path::Path;

use crate::formats::read_at_most;

/// Larger than any that it writes.
const LARGEST: u64 = 100_000_000;

/// Whether the file at `path` bears the `mark` that this program leaves in what it writes.
pub(crate) fn bears(path: &Path, mark: &str) -> bool {
    read_at_most(path, LARGEST).is_ok_and(|bytes| bytes.windows(mark.len()).any(|found| found == mark.as_bytes()))
}
