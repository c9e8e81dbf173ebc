//! Writing files that are never half-written.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// Why files could not be written.
#[derive(Debug, Error)]
#[error("cannot write {}", path.display())]
pub struct FileError {
    /// The file or folder.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
    /// The files of the same set that were replaced or removed before.
    pub done: Vec<PathBuf>,
}

impl FileError {
    fn new(path: &Path, source: io::Error) -> Self {
        Self { path: path.to_owned(), source, done: Vec::new() }
    }
}

/// What the names of temporary files begin with.
const PREFIX: &str = ".calipose-";

/// Random characters after it.
const RANDOM: usize = 6;

/// Writes `bytes` to `path`, creating its folder: to a temporary name beside it first, then renamed, so that the old file
/// stays whole until the new one is. A link is followed.
///
/// # Errors
/// When the folder or the file cannot be written.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_together(path.parent().unwrap_or(Path::new("")), &[(path.file_name().unwrap_or_default(), bytes)], &[])
}

/// Writes files that belong together to `folder`, creating it: all are staged before the first is renamed. Those of `stale`
/// that are not among them are removed: they told of what was there before.
///
/// # Errors
/// When the folder or a file cannot be written. The error names the files that were replaced nevertheless.
pub fn write_together(
    folder: &Path,
    files: &[(impl AsRef<Path>, impl AsRef<[u8]>)],
    stale: &[&str],
) -> Result<(), FileError> {
    let is_left = |name: &&&str| {
        files.iter().all(|(written, _)| written.as_ref() != Path::new(name))
            && folder.join(name).symlink_metadata().is_ok()
    };
    let stale: Vec<&str> = stale.iter().filter(is_left).copied().collect();
    Held::new(folder)?.write(files, &stale)
}

/// A folder that other runs of the program do not write to while this lives, as far as the system can lock folders.
pub(crate) struct Held {
    folder: PathBuf,
    _lock: Option<File>,
}

impl Held {
    /// Waits for runs that write to `folder`, which is created if need be.
    pub(crate) fn new(folder: &Path) -> Result<Self, FileError> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        fs::create_dir_all(folder).map_err(|source| FileError::new(folder, source))?;
        let lock = File::open(folder).ok().filter(|handle| handle.lock().is_ok());
        Ok(Self { folder: folder.to_owned(), _lock: lock })
    }

    /// Waits until no run writes to `folder`, and keeps all from it until the handle is dropped.
    pub(crate) fn to_read(folder: &Path) -> Option<File> {
        File::open(folder).ok().filter(|handle| handle.lock_shared().is_ok())
    }

    /// Writes files: all under temporary names first, then renamed in their order, so that none is touched unless all could
    /// be written. The `stale` are removed before the last is renamed.
    pub(crate) fn write(
        &self,
        files: &[(impl AsRef<Path>, impl AsRef<[u8]>)],
        stale: &[&str],
    ) -> Result<(), FileError> {
        let mut done = Vec::new();
        for step in self.steps(files, stale)? {
            let path = step.path().to_owned();
            if let Err(source) = step.take() {
                return Err(FileError { path, source, done });
            }
            done.push(path);
        }
        // The renames themselves are to outlast a power failure; where folders cannot be synchronised, they may not.
        if let Ok(handle) = File::open(&self.folder) {
            let _ = handle.sync_all();
        }
        Ok(())
    }

    /// Stages the files, and says what is left to do; see [`write`](Self::write).
    pub(crate) fn steps(
        &self,
        files: &[(impl AsRef<Path>, impl AsRef<[u8]>)],
        stale: &[&str],
    ) -> Result<Vec<Step>, FileError> {
        let mut steps = Vec::new();
        for (name, bytes) in files {
            let path = self.folder.join(name);
            let staged =
                destination(&path).and_then(|path| Ok(Step::Replace { staged: stage(&path, bytes.as_ref())?, path }));
            steps.push(staged.map_err(|source| FileError::new(&path, source))?);
        }
        let before_last = steps.len().saturating_sub(1);
        let removed = stale.iter().map(|name| Step::Remove(self.folder.join(name)));
        steps.splice(before_last..before_last, removed);
        Ok(steps)
    }
}

/// A step of writing files together. A run can be killed between any two.
pub(crate) enum Step {
    Replace { staged: NamedTempFile, path: PathBuf },
    Remove(PathBuf),
}

impl Step {
    fn path(&self) -> &Path {
        match self {
            Self::Replace { path, .. } | Self::Remove(path) => path,
        }
    }

    pub(crate) fn take(self) -> io::Result<()> {
        match self {
            Self::Replace { staged, path } => staged.persist(path).map(drop).map_err(|error| error.error),
            Self::Remove(path) => fs::remove_file(path),
        }
    }
}

/// The file that `path` names, through links; it need not exist, but must not be anything but a file.
fn destination(path: &Path) -> io::Result<PathBuf> {
    /// As many links as Linux follows.
    const MOST_LINKS: usize = 40;
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match path.symlink_metadata() {
            Ok(found) if found.is_symlink() => path = path.parent().unwrap_or(Path::new("")).join(path.read_link()?),
            Ok(found) if found.is_file() => return Ok(path),
            Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(_) => return Err(io::Error::other("it is not a regular file")),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(path),
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::other("too many links"))
}

/// A temporary file beside `path`, which it may replace, with `bytes` written to the disk. What runs that were killed left
/// there is removed.
fn stage(path: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    remove_leftovers(folder);
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM);
    // Temporary files are private by default; a plan is as readable as any file its user makes.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    // Held until it is renamed: what is not held is left over. Where files cannot be locked, none is taken for left over.
    let _ = file.as_file().try_lock();
    file.write_all(bytes)?;
    if let Ok(old) = fs::metadata(path) {
        file.as_file().set_permissions(old.permissions())?;
    }
    file.as_file().sync_all()?;
    Ok(file)
}

/// Removes the temporary files in `folder` that no run of the program holds.
fn remove_leftovers(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let random = name.to_str().and_then(|name| name.strip_prefix(PREFIX));
        let temporary = random.is_some_and(|random| {
            random.len() == RANDOM && random.bytes().all(|character| character.is_ascii_alphanumeric())
        });
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        // Where it cannot be removed, it is no worse than before.
        if temporary && is_file && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Finds out whether files can be written to `folder`, and leaves no trace: a folder that is missing is made and taken away
/// again.
///
/// # Errors
/// When they cannot.
pub fn probe(folder: &Path) -> Result<(), FileError> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let missing: Vec<&Path> = folder.ancestors().take_while(|folder| folder.symlink_metadata().is_err()).collect();
    let probed = fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder));
    for made in missing.into_iter().filter(|folder| !folder.as_os_str().is_empty()) {
        // Not if another run has put something there.
        let _ = fs::remove_dir(made);
    }
    probed.map(drop).map_err(|source| FileError::new(folder, source))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_failed_write_says_what_was_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("a"), "old").unwrap();
        fs::create_dir(folder.join("b")).unwrap();
        let error = write_together(folder, &[("a", "new"), ("b", "new")], &[]).unwrap_err();
        assert_eq!((error.path, error.done.len()), (folder.join("b"), 0), "found before anything is touched");
        assert_eq!(fs::read_to_string(folder.join("a")).unwrap(), "old");
        fs::remove_dir(folder.join("b")).unwrap();
        // What comes in between after the look is found out by the rename itself.
        let held = Held::new(folder).unwrap();
        let mut steps = held.steps(&[("a", "new"), ("b", "new")], &[]).unwrap();
        fs::create_dir(folder.join("b")).unwrap();
        let last = steps.pop().unwrap();
        steps.pop().unwrap().take().unwrap();
        last.take().unwrap_err();
        assert_eq!(names(folder), ["a", "b"]);
    }

    #[test]
    fn leftovers_of_killed_runs_go_and_those_of_living_ones_stay() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        for name in [".calipose-aB3dE9", ".calipose-notes.txt", ".calipose-abc-ef", "calipose-abcdef"] {
            fs::write(folder.join(name), "").unwrap();
        }
        fs::create_dir(folder.join(".calipose-folder")).unwrap();
        let living = stage(&folder.join("slow"), b"").unwrap();
        assert!(!names(folder).contains(&".calipose-aB3dE9".to_owned()));
        write_atomically(&folder.join("quick"), b"").unwrap();
        assert!(living.path().exists());
        living.persist(folder.join("slow")).unwrap();
        let kept = [".calipose-abc-ef", ".calipose-folder", ".calipose-notes.txt", "calipose-abcdef", "quick", "slow"];
        assert_eq!(names(folder), kept);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let at = |name: &str| folder.join(name);
        fs::create_dir(at("elsewhere")).unwrap();
        fs::write(at("elsewhere/real"), "old").unwrap();
        fs::set_permissions(at("elsewhere/real"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink("elsewhere/real", at("link")).unwrap();
        symlink("elsewhere/new", at("dangling")).unwrap();
        symlink("elsewhere", at("folder")).unwrap();
        symlink("loop", at("loop")).unwrap();
        write_atomically(&at("link"), b"new").unwrap();
        write_atomically(&at("dangling"), b"made").unwrap();
        write_atomically(&at("folder/within"), b"in").unwrap();
        assert!(at("link").symlink_metadata().unwrap().is_symlink());
        assert_eq!(fs::read_to_string(at("elsewhere/real")).unwrap(), "new");
        assert_eq!(at("elsewhere/real").metadata().unwrap().permissions().mode() & 0o777, 0o640);
        assert_eq!(names(&at("elsewhere")), ["new", "real", "within"]);
        assert!(write_atomically(&at("loop"), b"").unwrap_err().source.to_string().contains("links"));
        assert!(at("folder").symlink_metadata().unwrap().is_symlink());
    }

    #[test]
    fn probing_a_folder_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("file"), "").unwrap();
        fs::create_dir(folder.join("empty")).unwrap();
        probe(&folder.join("a/b/c")).unwrap();
        probe(&folder.join("empty")).unwrap();
        probe(&folder.join("file/below")).unwrap_err();
        probe(&folder.join("file")).unwrap_err();
        assert_eq!(names(folder), ["empty", "file"]);
    }
}
