//! Where the meshes of a robot description are.

use std::path::{Path, PathBuf};

use super::error::UrdfFault;

/// The folders that meshes may be in: the description's own and those of packages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct MeshFolders {
    /// Folder of the description, where relative paths start.
    own: PathBuf,
    /// Folders that are packages or hold them.
    packages: Vec<PathBuf>,
}

impl MeshFolders {
    pub(super) fn new(own: &Path, packages: &[PathBuf]) -> Self {
        // A file without a folder in its name is in the working directory.
        let own = if own.as_os_str().is_empty() { Path::new(".") } else { own };
        Self { own: own.into(), packages: packages.to_vec() }
    }

    /// The file that a mesh's `filename` means: `package://PACKAGE/PATH`, `file:///PATH` or a path from the description's folder.
    pub(super) fn resolve(&self, filename: &str) -> Result<PathBuf, UrdfFault> {
        let address = || UrdfFault::MeshAddress { filename: filename.into() };
        let sought: Vec<PathBuf> = if let Some(address_in_package) = filename.strip_prefix("package://") {
            let (package, path) = address_in_package.split_once('/').ok_or_else(address)?;
            let own = std::iter::once(&self.own);
            own.chain(&self.packages)
                .flat_map(|folder| {
                    // The folder may be the package itself.
                    let is_package = folder.file_name().is_some_and(|name| name == package);
                    [Some(folder.join(package).join(path)), is_package.then(|| folder.join(path))]
                })
                .flatten()
                .collect()
        } else if let Some(path) = filename.strip_prefix("file://") {
            vec![PathBuf::from(path)]
        } else if filename.contains("://") {
            return Err(address());
        } else {
            vec![self.own.join(filename)]
        };
        let Some(found) = sought.iter().find_map(|path| path.canonicalize().ok()) else {
            return Err(UrdfFault::MeshNotFound { filename: filename.into(), sought });
        };
        // Canonical paths have no `..` and no symbolic links left to leave a folder by.
        let folders: Vec<PathBuf> = std::iter::once(&self.own).chain(&self.packages).cloned().collect();
        let inside = |folder: &PathBuf| folder.canonicalize().is_ok_and(|folder| found.starts_with(folder));
        if folders.iter().any(inside) {
            Ok(found)
        } else {
            Err(UrdfFault::MeshOutside { filename: filename.into(), folders })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_lead_into_the_folders_and_nowhere_else() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path().canonicalize().unwrap();
        for file in ["robot/arm.stl", "share/pkg/meshes/hand.stl", "elsewhere/other.stl"] {
            std::fs::create_dir_all(root.join(file).parent().unwrap()).unwrap();
            std::fs::write(root.join(file), "").unwrap();
        }
        let folders = MeshFolders::new(&root.join("robot"), &[root.join("share")]);
        let hand = root.join("share/pkg/meshes/hand.stl");
        assert_eq!(folders.resolve("arm.stl"), Ok(root.join("robot/arm.stl")));
        assert_eq!(folders.resolve("package://pkg/meshes/hand.stl"), Ok(hand.clone()));
        assert_eq!(folders.resolve(&format!("file://{}", hand.display())), Ok(hand.clone()));
        let package = MeshFolders::new(&root.join("robot"), &[root.join("share/pkg")]);
        assert_eq!(package.resolve("package://pkg/meshes/hand.stl"), Ok(hand));
        for outside in ["../elsewhere/other.stl", "package://pkg/../../elsewhere/other.stl"] {
            assert!(matches!(folders.resolve(outside), Err(UrdfFault::MeshOutside { .. })), "{outside}");
        }
        assert!(
            matches!(folders.resolve("package://none/hand.stl"), Err(UrdfFault::MeshNotFound { sought, .. }) if sought.len() == 2)
        );
        for address in ["https://example.org/a.stl", "package://pkg"] {
            assert!(matches!(folders.resolve(address), Err(UrdfFault::MeshAddress { .. })), "{address}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_do_not_lead_out() {
        let root = tempfile::tempdir().unwrap();
        std::fs::create_dir(root.path().join("robot")).unwrap();
        std::fs::write(root.path().join("secret"), "").unwrap();
        std::os::unix::fs::symlink(root.path().join("secret"), root.path().join("robot/arm.stl")).unwrap();
        let folders = MeshFolders::new(&root.path().join("robot"), &[]);
        assert!(matches!(folders.resolve("arm.stl"), Err(UrdfFault::MeshOutside { .. })));
    }
}
