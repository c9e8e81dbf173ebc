//! What a format calls the lens models that it has.

use crate::camera::Lens;
use crate::formats::camera::format::WriteError;
use crate::formats::camera::unsupported;
use crate::formats::error::ReadError;

/// The names that a format has for lens models. A model without a name is none of the format's; of several that it has, the first
/// is written.
pub(in crate::formats::camera) struct LensNames<const N: usize> {
    /// Name of the format.
    pub(in crate::formats::camera) format: &'static str,
    pub(in crate::formats::camera) names: [(&'static str, Lens); N],
}

impl<const N: usize> LensNames<N> {
    /// The name of `lens` in the format.
    pub(in crate::formats::camera) fn of(&self, lens: Lens) -> Result<&'static str, WriteError> {
        let named = self.names.iter().find(|(_, named)| *named == lens);
        named.map(|(name, _)| *name).ok_or(WriteError::Lens { format: self.format, lens: lens.name() })
    }

    /// The lens that the format calls `found`, the value of `key` on `line`.
    pub(in crate::formats::camera) fn lens(&self, key: &str, found: &str, line: usize) -> Result<Lens, ReadError> {
        let named = self.names.iter().find(|(name, _)| *name == found);
        named.map(|(_, lens)| *lens).ok_or_else(|| {
            let supported = self.names.map(|(name, _)| name).join(", ");
            unsupported::model(key, found, supported, line)
        })
    }
}
