//! The folder of a study's results: its cells, each in a file that is named by all that it follows from.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::Study;
use crate::plan::document::{CellDocument, Document, StudyDocument};
use crate::plan::results::{FileError, write_atomically};

/// The folder of a study's results, held against other runs while this lives.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    _lock: File,
}

/// Why a folder cannot be used.
#[derive(Debug, Error)]
pub enum StoreError {
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Another run works there.
    #[error("another run is at work in {}", folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// The results of another study are there.
    #[error("{} holds the study \"{theirs}\"", folder.display())]
    Other {
        /// The folder.
        folder: PathBuf,
        /// The name of the study.
        theirs: String,
    },
}

/// Characters of a fingerprint that name a file: as many as never agree by chance.
const NAMED_BY: usize = 32;

/// Name of the file that says whose the folder is.
const OWNER_FILE: &str = "study.json";

/// Name of the file that is locked.
const LOCK_FILE: &str = ".lock";

impl Store {
    /// The folder for a whole run, which no other may be at work in.
    ///
    /// # Errors
    /// When another is, or the folder is of another study and `force` is not given, or cannot be written.
    pub fn alone(folder: &Path, study: &Study, force: bool) -> Result<Self, StoreError> {
        Self::open(folder, study, force, File::try_lock)
    }

    /// The folder for some of the cells, which others may add to at the same time.
    ///
    /// # Errors
    /// As [`Store::alone`].
    pub fn shared(folder: &Path, study: &Study, force: bool) -> Result<Self, StoreError> {
        Self::open(folder, study, force, File::try_lock_shared)
    }

    fn open(
        folder: &Path,
        study: &Study,
        force: bool,
        lock: fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, StoreError> {
        let refused = |path: &Path| {
            let path = path.to_owned();
            move |source| FileError { path, source, done: Vec::new() }
        };
        if let Some(theirs) = owner(folder).filter(|theirs| *theirs != study.name && !force) {
            return Err(StoreError::Other { folder: folder.to_owned(), theirs });
        }
        fs::create_dir_all(folder).map_err(refused(folder))?;
        let path = folder.join(LOCK_FILE);
        let file = File::options().create(true).truncate(false).write(true).open(&path).map_err(refused(&path))?;
        match lock(&file) {
            Err(TryLockError::WouldBlock) => Err(StoreError::Busy { folder: folder.to_owned() }),
            // Where files cannot be locked, nobody is kept out: what is written is whole nevertheless.
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Self { folder: folder.to_owned(), _lock: file }),
        }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn path(&self, fingerprint: &str) -> PathBuf {
        self.folder.join("cells").join(&fingerprint[..2]).join(format!("{}.json", &fingerprint[..NAMED_BY]))
    }

    /// The cell of that fingerprint, if it is there and whole.
    pub(super) fn cell(&self, fingerprint: &str) -> Option<CellDocument> {
        let document: CellDocument = serde_json::from_slice(&fs::read(self.path(fingerprint)).ok()?).ok()?;
        (document.fingerprint == fingerprint).then_some(document)
    }

    /// Writes a cell.
    pub(super) fn keep(&self, cell: &CellDocument) -> Result<(), FileError> {
        write_atomically(&self.path(&cell.fingerprint), cell.to_json().as_bytes())
    }

    /// How many cells are there, of this study as it is or of others.
    pub fn kept(&self) -> usize {
        let entries = |folder: &Path| fs::read_dir(folder).into_iter().flatten().flatten();
        let named = |entry: &fs::DirEntry| entry.path().extension().is_some_and(|extension| extension == "json");
        entries(&self.folder.join("cells")).map(|sub| entries(&sub.path()).filter(named).count()).sum()
    }
}

/// The name of the study whose results are in the folder.
fn owner(folder: &Path) -> Option<String> {
    let document: StudyDocument = serde_json::from_slice(&fs::read(folder.join(OWNER_FILE)).ok()?).ok()?;
    Some(document.name)
}
