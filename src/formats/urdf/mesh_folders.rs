//! Where the meshes of a robot description are.

use std::path::{Component, Path, PathBuf};

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
        let mut package = None;
        let sought: Vec<PathBuf> = if let Some(address_in_package) = filename.strip_prefix("package://") {
            let (name, path) = address_in_package.split_once('/').ok_or_else(address)?;
            package = Some(name);
            let of = |folder: &PathBuf| {
                [Some(folder.join(name).join(path)), is_called(folder, name).then(|| folder.join(path))]
            };
            self.all().flat_map(of).flatten().collect()
        } else if let Some(path) = filename.strip_prefix("file://") {
            vec![PathBuf::from(path)]
        } else if filename.contains("://") {
            return Err(address());
        } else {
            vec![self.own.join(filename)]
        };
        let Some((path, found)) = sought.iter().find_map(|path| Some((path, path.canonicalize().ok()?))) else {
            let package = package.and_then(|name| self.above(name));
            return Err(UrdfFault::MeshNotFound { filename: filename.into(), sought, package });
        };
        // Canonical paths have no `..` and no symbolic links left to leave a folder by.
        if self.all().any(|folder| folder.canonicalize().is_ok_and(|folder| found.starts_with(folder))) {
            return Ok(found);
        }
        let (filename, folders) = (filename.to_owned(), self.all().cloned().collect());
        // Without its links the path would have stayed inside.
        if self.all().any(|folder| plain(path).starts_with(plain(folder))) {
            Err(UrdfFault::MeshLinked { filename, target: found, folders })
        } else {
            Err(UrdfFault::MeshOutside { filename, folders })
        }
    }

    fn all(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.own).chain(&self.packages)
    }

    /// The folder called `package` that holds the description, at whatever depth.
    fn above(&self, package: &str) -> Option<PathBuf> {
        let own = self.own.canonicalize().ok()?;
        own.ancestors().find(|folder| folder.file_name().is_some_and(|name| name == package)).map(Path::to_owned)
    }
}

/// Whether `folder` is of that name, by its own path or where its `..` and links lead.
fn is_called(folder: &Path, name: &str) -> bool {
    let called = |folder: &Path| folder.file_name().is_some_and(|last| last == name);
    called(folder) || folder.canonicalize().is_ok_and(|folder| called(&folder))
}

/// `path` with its `.` and `..` carried out, its symbolic links not followed.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(plain.components().next_back(), Some(Component::Normal(_))) => {
                plain.pop();
            }
            part => plain.push(part),
        }
    }
    plain
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
        let target = root.path().canonicalize().unwrap().join("secret");
        let linked = folders.resolve("arm.stl").unwrap_err();
        assert!(matches!(&linked, UrdfFault::MeshLinked { target: leads, .. } if *leads == target), "{linked}");
        // `..` carried out, it leads out by itself.
        let outside = folders.resolve("../robot/../secret").unwrap_err();
        assert!(matches!(outside, UrdfFault::MeshOutside { .. }), "{outside}");
    }

    /// A workspace installed by links, and the folder that they lead to as a package folder.
    #[cfg(unix)]
    #[test]
    fn links_may_lead_into_a_package_folder() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path().canonicalize().unwrap();
        for folder in ["src/pkg/meshes", "install/share/pkg/meshes", "src/pkg/urdf"] {
            std::fs::create_dir_all(root.join(folder)).unwrap();
        }
        let mesh = root.join("src/pkg/meshes/arm.stl");
        std::fs::write(&mesh, "").unwrap();
        std::os::unix::fs::symlink(&mesh, root.join("install/share/pkg/meshes/arm.stl")).unwrap();
        let (urdf, share) = (root.join("src/pkg/urdf"), root.join("install/share"));
        let resolve = |folders: &[PathBuf]| MeshFolders::new(&urdf, folders).resolve("package://pkg/meshes/arm.stl");
        assert!(
            matches!(resolve(std::slice::from_ref(&share)), Err(UrdfFault::MeshLinked { target, .. }) if target == mesh)
        );
        assert_eq!(resolve(&[share, root.join("src")]), Ok(mesh.clone()));
        // A folder whose path ends in `..` has no name of its own.
        assert_eq!(resolve(&[urdf.join("..")]), Ok(mesh));
        let package = |error| matches!(error, UrdfFault::MeshNotFound { package: Some(folder), .. } if folder == root.join("src/pkg"));
        assert!(package(resolve(&[]).unwrap_err()));
    }
}
