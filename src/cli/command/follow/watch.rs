//! Files of detections that are written while a plan is carried out, and the new pictures in them.

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::formats::{FileReadError, Known, read_images_file};
use crate::plan::document::TakenPicture;

/// What a look at the files brings.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum News {
    /// A picture that was not there before.
    Picture(TakenPicture),
    /// A file that cannot be read as it is now.
    Unreadable {
        /// Its name.
        file: String,
        /// Why not.
        reason: String,
    },
}

/// What was there already.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Early {
    /// Names of pictures that are new.
    pub(super) pictures: Vec<String>,
    /// Files that cannot be read, and why not.
    pub(super) unreadable: Vec<(String, String)>,
}

/// A watched folder or file.
///
/// A file is looked into once it is the same, by size and time, in two looks: then it is written completely. A picture is new where none of
/// its name had the same corners, in whatever file.
pub(super) struct Watch {
    place: Place,
    known: Known,
    files: BTreeMap<PathBuf, Seen>,
    pictures: HashSet<Mark>,
}

enum Place {
    Folder(PathBuf),
    File(PathBuf),
}

/// How a file was in the last look.
struct Seen {
    stamp: Stamp,
    /// Whether it was looked into.
    is_read: bool,
}

/// Size and time of a file.
type Stamp = (u64, Option<SystemTime>);

/// What tells pictures apart: the name, and index and pixel of each corner, the latter bit by bit.
type Mark = (String, Vec<(usize, [u64; 2])>);

/// Endings of files in a folder that may hold detections.
const ENDINGS: [&str; 2] = ["vnl", "json"];

impl Watch {
    /// Of the files in a folder. `known` is what is known of detections beside their files; the pictures `taken` are there already.
    pub(super) fn folder(folder: PathBuf, known: Known, taken: &[TakenPicture]) -> Self {
        Self::new(Place::Folder(folder), known, taken)
    }

    /// Of one file, which need not be there yet.
    pub(super) fn file(file: PathBuf, known: Known, taken: &[TakenPicture]) -> Self {
        Self::new(Place::File(file), known, taken)
    }

    fn new(place: Place, known: Known, taken: &[TakenPicture]) -> Self {
        Self { place, known, files: BTreeMap::new(), pictures: taken.iter().map(mark).collect() }
    }

    /// New pictures of files that are written completely, and files that cannot be read, each once as it is.
    pub(super) fn look(&mut self) -> Vec<News> {
        let mut news = Vec::new();
        for (path, stamp) in self.stamps() {
            let settled = self.files.get(&path).filter(|seen| seen.stamp == stamp);
            if settled.is_none_or(|seen| seen.is_read) {
                let is_read = settled.is_some();
                self.files.insert(path, Seen { stamp, is_read });
                continue;
            }
            match self.new_pictures(&path) {
                Ok(pictures) => news.extend(pictures.into_iter().map(News::Picture)),
                Err(error) => news.push(News::Unreadable { file: name(&path), reason: error.to_string() }),
            }
            self.files.insert(path, Seen { stamp, is_read: true });
        }
        news
    }

    /// Takes note of what is there, so that it is not new any more. What is not written completely yet may become so later.
    pub(super) fn mark(&mut self) -> Early {
        let mut early = Early::default();
        for (path, stamp) in self.stamps() {
            let before = self.files.get(&path);
            if before.is_some_and(|seen| seen.stamp == stamp && seen.is_read) {
                continue;
            }
            let is_first = before.is_none();
            match self.new_pictures(&path) {
                Ok(pictures) => {
                    early.pictures.extend(pictures.into_iter().map(|picture| picture.name));
                    self.files.insert(path, Seen { stamp, is_read: false });
                }
                Err(error) => {
                    if is_first {
                        early.unreadable.push((name(&path), error.to_string()));
                    }
                    self.files.insert(path, Seen { stamp, is_read: is_first });
                }
            }
        }
        early
    }

    /// The files that are there.
    fn stamps(&self) -> Vec<(PathBuf, Stamp)> {
        let paths = match &self.place {
            Place::File(file) => vec![file.clone()],
            Place::Folder(folder) => {
                let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
                let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| may_hold(path)).collect();
                paths.sort();
                paths
            }
        };
        let stamp = |path: PathBuf| {
            let data = std::fs::metadata(&path).ok().filter(std::fs::Metadata::is_file)?;
            Some((path, (data.len(), data.modified().ok())))
        };
        paths.into_iter().filter_map(stamp).collect()
    }

    /// Pictures of a file that were not there before; from now on they were.
    fn new_pictures(&mut self, path: &Path) -> Result<Vec<TakenPicture>, FileReadError> {
        let images = read_images_file(path, &self.known)?;
        let pictures = images.iter().map(|image| TakenPicture::new(&name(path), &image.name, &image.corners));
        Ok(pictures.filter(|picture| self.pictures.insert(mark(picture))).collect())
    }
}

/// Whether a file in a folder may hold detections, by its name. Hidden ones are still being written, by programs that rename them then.
fn may_hold(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    !name(path).starts_with('.') && ENDINGS.iter().any(|known| known.eq_ignore_ascii_case(ending))
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn mark(picture: &TakenPicture) -> Mark {
    let corners = picture.corners.iter().map(|corner| (corner.index, corner.corner_px.map(f64::to_bits)));
    (picture.name.clone(), corners.collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::target::Board;

    fn known() -> Known {
        Known { board: Some(Board::checkerboard(2, 2, 0.03)), image: Some([640, 480]), images: None }
    }

    /// A table of pictures, each with its board at another place.
    fn table(pictures: &[(&str, usize)]) -> String {
        let rows = pictures.iter().flat_map(|&(name, x)| {
            (0..4).map(move |i| format!("{name} {} {} 0\n", x + 90 * (i % 2), 100 + 80 * (i / 2)))
        });
        "# filename x y level\n".to_owned() + &rows.collect::<String>()
    }

    fn pictures<'n>(news: &'n [News]) -> Vec<(&'n str, &'n str)> {
        let picture = |news: &'n News| match news {
            News::Picture(TakenPicture { file, name, .. }) => Some((file.as_str(), name.as_str())),
            News::Unreadable { .. } => None,
        };
        news.iter().filter_map(picture).collect()
    }

    #[test]
    fn a_picture_counts_once_its_file_rests() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        let mut watch = Watch::folder(folder.path().to_owned(), known(), &[]);
        write("old.vnl", &table(&[("old.png", 100)]));
        write("notes.txt", "no corners");
        write(".half.vnl", "no corners");
        assert_eq!(watch.mark(), Early { pictures: vec!["old.png".into()], unreadable: vec![] });
        assert_eq!(watch.mark(), Early::default());
        assert_eq!(watch.look(), []);
        // Two looks see it change, the third sees it rest.
        let whole = table(&[("a.png", 100), ("b.png", 150)]);
        write("new.vnl", &whole[..60]);
        assert_eq!(watch.look(), []);
        write("new.vnl", &whole);
        assert_eq!(watch.look(), []);
        assert_eq!(pictures(&watch.look()), [("new.vnl", "a.png"), ("new.vnl", "b.png")]);
        assert_eq!(watch.look(), []);
        // It grows; the old one is written again as it is, and under another name.
        write("new.vnl", &table(&[("a.png", 100), ("b.png", 150), ("c.png", 200)]));
        write("old.vnl", &(table(&[("old.png", 100)]) + "\n"));
        write("copy.vnl", &table(&[("old.png", 100)]));
        assert_eq!(watch.look(), []);
        assert_eq!(pictures(&watch.look()), [("new.vnl", "c.png")]);
        // One that is always called the same.
        write("old.vnl", &table(&[("old.png", 300)]));
        watch.look();
        assert_eq!(pictures(&watch.look()), [("old.vnl", "old.png")]);
    }

    #[test]
    fn what_cannot_be_read_is_told_once_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("all.json");
        let mut watch = Watch::file(file.clone(), known(), &[]);
        assert_eq!((watch.mark(), watch.look()), (Early::default(), vec![]));
        std::fs::write(&file, "{").unwrap();
        assert_eq!(watch.look(), []);
        let told = watch.look();
        assert!(matches!(&told[..], [News::Unreadable { file, .. }] if file == "all.json"), "{told:?}");
        assert_eq!(watch.look(), []);
        std::fs::write(&file, table(&[("a.png", 100)])).unwrap();
        watch.look();
        assert_eq!(pictures(&watch.look()), [("all.json", "a.png")]);
        // There already where it begins.
        std::fs::write(&file, "{}").unwrap();
        let mut other = Watch::file(file, known(), &[]);
        assert_eq!(other.mark().unreadable.len(), 1);
        assert_eq!((other.look(), other.look()), (vec![], vec![]));
    }

    #[test]
    fn pictures_that_count_already_are_not_new() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.vnl"), table(&[("a.png", 100), ("b.png", 150)])).unwrap();
        let mut first = Watch::folder(folder.path().to_owned(), known(), &[]);
        first.look();
        let News::Picture(a) = first.look().remove(0) else { panic!("no picture") };
        let mut second = Watch::folder(folder.path().to_owned(), known(), &[a]);
        assert_eq!(second.mark().pictures, ["b.png"]);
    }
}
