//! What a problem's user should know although nothing is wrong.

/// Something that was read otherwise than it stands there, put right or left out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// The key that it is about, or that names the file it is about: `robot.urdf`.
    pub key: String,
    /// What was done.
    pub text: String,
}
