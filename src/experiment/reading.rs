//! Reading files that state experiments: as problem files are read, with every fault under its line.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use crate::problem::{At, Check, Fault, Overrides, ProblemError, Source, SourceFile, Vocabulary, read, read_text};

/// What is common to all of them.
pub(super) struct Stated {
    /// Name of the experiment.
    pub(super) name: String,
    /// SHA-256 of the file's bytes, in lower-case hexadecimal.
    pub(super) sha256: String,
    /// Folder for its results, relative to the working directory.
    pub(super) output: PathBuf,
}

/// A kind of file that states experiments.
pub(super) trait ExperimentFile: DeserializeOwned {
    /// Where results go if the file does not say.
    const FOLDERS: &str;

    /// The keys with the name and with the folder for results.
    fn common<'f>(file: &At<'f, Self>) -> [At<'f, Option<String>>; 2];
}

/// The file at `path`, as `resolve` understands it: given what is common, and the folder that paths in it are relative to.
///
/// # Errors
/// When the file cannot be read or `resolve` finds fault with it.
pub(super) fn read_experiment<F: ExperimentFile, T>(
    path: &Path,
    words: Vocabulary,
    resolve: impl FnOnce(&mut Check, &At<F>, Stated, &Path) -> Result<Option<T>, ProblemError>,
) -> Result<T, ProblemError> {
    let text = read_text(path)?;
    let source = Source::new(&text, &Overrides::new());
    let refused = |faults: Vec<Fault>| ProblemError::Invalid {
        file: SourceFile { name: path.to_string_lossy().into_owned(), text: text.clone() },
        faults,
    };
    let (document, file) = read::<F>(&source, words).map_err(|fault| refused(vec![*fault]))?;
    let mut check = Check { document: &document, faults: Vec::new(), notes: Vec::new() };
    let file = &At::root(&file);
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let [name, output] = F::common(file);
    let name = check.name(&name, &stem);
    let output = check.output(output, F::FOLDERS, &name);
    let stated = Stated { name, sha256: document.sha256(), output };
    let resolved = resolve(&mut check, file, stated, path.parent().unwrap_or(Path::new("")))?;
    match resolved {
        Some(resolved) if check.faults.is_empty() => Ok(resolved),
        _ => Err(refused(check.faults)),
    }
}
