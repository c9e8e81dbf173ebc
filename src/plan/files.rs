//! Writing files that are never half-written.

use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// Why a file could not be written.
#[derive(Debug, Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// What the system said.
    pub source: std::io::Error,
}

/// Writes `bytes` to `path`, creating its folder: to a temporary name beside it first, then renamed, so that the old file
/// stays whole until the new one is.
///
/// # Errors
/// When the folder or the file cannot be written.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let stage = || -> std::io::Result<()> {
        stage(path, bytes)?.persist(path)?;
        Ok(())
    };
    stage().map_err(|source| FileError { path: path.to_owned(), source })
}

/// Writes files that belong together to `folder`: all under temporary names first, then renamed, so that none is touched
/// unless all could be written. Those of `stale` that are not among them are removed: they told of what was there before.
///
/// # Errors
/// When the folder or a file cannot be written.
pub fn write_together(folder: &Path, files: &[(&str, Vec<u8>)], stale: &[&str]) -> Result<(), FileError> {
    let failed = |path: &Path, source| FileError { path: path.to_owned(), source };
    let mut staged = Vec::new();
    for (name, bytes) in files {
        let path = folder.join(name);
        let file = stage(&path, bytes).map_err(|source| failed(&path, source))?;
        staged.push((path, file));
    }
    for (path, file) in staged {
        file.persist(&path).map_err(|error| failed(&path, error.error))?;
    }
    for name in stale.iter().filter(|name| files.iter().all(|(written, _)| written != *name)) {
        let path = folder.join(name);
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => return Err(failed(&path, source)),
            _ => {}
        }
    }
    Ok(())
}

/// A temporary file beside `path`, which it may replace, with `bytes` written to the disk.
fn stage(path: &Path, bytes: &[u8]) -> std::io::Result<NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::Builder::new().prefix(".calipose-").tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    // Temporary files are private by default; a plan is as readable as any file its user makes.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(path).map_or(0o644, |old| old.permissions().mode());
        file.as_file().set_permissions(std::fs::Permissions::from_mode(mode))?;
    }
    Ok(file)
}
