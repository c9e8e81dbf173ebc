//! What is known of a camera beside its file.

use crate::formats::error::{ReadError, ReadFault};
use crate::formats::image_size::agreed;

/// What is known of a camera beside its file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StatedCamera {
    /// Width and height of its images, px; needed where the file does not state them, and to agree where it does.
    pub image: Option<[u32; 2]>,
    /// Its name, in a file of several cameras.
    pub name: Option<String>,
}

impl StatedCamera {
    /// The image size that is stated and `found`, on `line` of the file.
    pub(super) fn image_size(&self, found: Option<[u32; 2]>, line: usize) -> Result<[u32; 2], ReadError> {
        agreed(found, self.image, line)
    }

    /// Whichever of `cameras` is stated, or the only one; cameras without name are alone in their file.
    pub(super) fn choose<T: Clone>(&self, cameras: &[(String, T)], line: usize) -> Result<(String, T), ReadError> {
        let names = || cameras.iter().map(|(name, _)| name.clone()).filter(|name| !name.is_empty()).collect();
        match (&self.name, cameras) {
            (None, [only]) => Ok(only.clone()),
            (None, _) => Err(ReadFault::SeveralCameras { names: names() }.at(line)),
            (Some(name), _) => {
                let found = cameras.iter().find(|(known, _)| !known.is_empty() && known == name);
                found.cloned().ok_or_else(|| ReadFault::UnknownCamera { name: name.clone(), names: names() }.at(line))
            }
        }
    }
}
