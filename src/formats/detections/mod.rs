//! Detected corners, whatever file they come from.

mod images;
mod known;
mod listed_image;
mod observations;
mod vnl;

pub use known::Known;

use super::error::{ReadError, ReadFault};
use crate::calibration::{ObservationError, Observations, View};
use listed_image::{ListedImage, ListedImages};

/// The detections of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Detections {
    /// The views, checked.
    pub observations: Observations,
    /// The image of each view.
    pub names: Vec<String>,
    /// Images in which no corner was detected; they are no views.
    pub skipped: Vec<String>,
}

/// The detections of `text`: calipose's own JSON if it begins with a brace, else mrcal's vnl.
///
/// A file that has board and image size must agree with what is `known`; one that has not needs it. Images of several cameras,
/// as far as their names tell, need a pattern that chooses one's.
///
/// ```
/// use calipose::formats::{Known, read_detections};
/// use calipose::target::Board;
///
/// let board = Board::checkerboard(2, 2, 0.03);
/// let text = "# filename x y level\na.png 100 100 0\na.png 200 101 0\na.png 99 201 1\na.png 201 202 0\nb.png - - -\n";
/// let known = Known { board: Some(board), image: Some([640, 480]), images: None };
/// let detections = read_detections(text, &known)?;
/// assert_eq!(detections.names, ["a.png"]);
/// assert_eq!(detections.skipped, ["b.png"]);
/// # Ok::<(), calipose::formats::ReadError>(())
/// ```
///
/// # Errors
/// The first fault, with its line.
pub fn read_detections(text: &str, known: &Known) -> Result<Detections, ReadError> {
    let ListedImages { board, size: [width, height], images } = listed(text, known)?;
    let images = chosen(images, known.images.as_deref())?;
    let (seen, skipped): (Vec<ListedImage>, Vec<ListedImage>) =
        images.into_iter().partition(|image| image.detected().count() > 0);
    let views = seen.iter().map(|image| -> View { image.detected().collect() }).collect();
    let observations =
        Observations::new(board, width, height, views).map_err(|fault| located(fault, &seen, text.lines().count()))?;
    let names = |images: Vec<ListedImage>| images.into_iter().map(|image| image.name).collect();
    Ok(Detections { observations, names: names(seen), skipped: names(skipped) })
}

/// The views as a file of mrcal's, vnl, under `names` that are words and differ; [`read_detections`] reads the same from it.
pub fn write_vnl(observations: &Observations, names: &[String]) -> String {
    vnl::write(observations, names)
}

/// An image of a file, and the corners that were detected in it: any number, and not checked.
#[derive(Debug, Clone, PartialEq)]
pub struct DetectedImage {
    /// Its name.
    pub name: String,
    /// The corners.
    pub corners: View,
}

/// The images of `text`, which is read as by [`read_detections`], each for itself: images without corners, and with corners that no
/// calibration takes, are among them. There may be none of the camera that is meant.
///
/// # Errors
/// The first fault that keeps the file from being read, with its line.
pub fn read_images(text: &str, known: &Known) -> Result<Vec<DetectedImage>, ReadError> {
    let images = match chosen(listed(text, known)?.images, known.images.as_deref()) {
        Err(ReadError { fault: ReadFault::NoImage { .. }, .. }) => Vec::new(),
        images => images?,
    };
    Ok(images
        .into_iter()
        .map(|image| DetectedImage { corners: image.detected().collect(), name: image.name })
        .collect())
}

/// The images of a file of either format.
fn listed(text: &str, known: &Known) -> Result<ListedImages, ReadError> {
    let text = text.trim_start_matches('\u{feff}');
    let read = if text.trim_start().starts_with('{') { observations::read } else { vnl::read };
    read(text, known)
}

/// The images whose names match `pattern`.
fn chosen(mut images: Vec<ListedImage>, pattern: Option<&str>) -> Result<Vec<ListedImage>, ReadError> {
    let line = images.first().map_or(1, |image| image.line);
    if let Some(pattern) = pattern {
        let (of, first) = (images.len(), images.first().map(|image| image.name.clone()).unwrap_or_default());
        images.retain(|image| images::matches(pattern, &image.name));
        if images.is_empty() {
            return Err(ReadFault::NoImage { pattern: pattern.to_owned(), of, first }.at(line));
        }
    } else {
        let cameras = images::cameras(images.iter().map(|image| image.name.as_str()));
        if !cameras.is_empty() {
            let cameras = cameras.into_iter().map(|(name, count)| (name.to_owned(), count)).collect();
            return Err(ReadFault::Cameras { cameras }.at(line));
        }
    }
    Ok(images)
}

/// The place in the file of what the check of all views found.
fn located(fault: ObservationError, seen: &[ListedImage], last_line: usize) -> ReadError {
    use ObservationError as E;
    let (view, index) = match fault {
        E::NoViews | E::BoardSize { .. } | E::SquareSize { .. } => (None, None),
        E::TooFewCorners { view, .. } | E::Collinear { view } => (Some(view), None),
        E::NotOnBoard { view, index, .. }
        | E::Duplicate { view, index }
        | E::NotFinite { view, index, .. }
        | E::Weight { view, index, .. }
        | E::OutsideImage { view, index, .. } => (Some(view), Some(index)),
    };
    let Some(image) = view.and_then(|view| seen.get(view)) else {
        return ReadFault::Observations(fault).at(last_line.max(1));
    };
    let line = index.and_then(|index| image.corners.get(index)).map_or(image.line, |(_, line)| *line);
    ReadFault::View { view: image.name.clone(), fault: fault.clone() }.at(line)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use nalgebra::Vector2;

    use super::*;
    use crate::calibration::Corner;
    use crate::target::Board;

    fn known() -> Known {
        Known { board: Some(Board::checkerboard(3, 2, 0.03)), image: Some([640, 480]), images: None }
    }

    #[test]
    fn views_are_read_as_they_were_written() {
        let corner = |i: usize| Corner {
            index: i,
            pixel: Vector2::new(100.0 + 200.0 * (i % 3) as f64 / 3.0, 300.0 - 0.1 * i as f64 - 50.0 * (i / 3) as f64),
            weight: [1.0, 0.3][i % 2],
        };
        let views: Vec<View> = vec![(0..6).map(corner).collect(), [0, 1, 3, 4].map(corner).to_vec()];
        let written = Observations::new(known().board.unwrap(), 640, 480, views).unwrap();
        let names = ["a.png".to_owned(), "b.png".to_owned()];
        let read = read_detections(&write_vnl(&written, &names), &known()).unwrap();
        assert_eq!((read.observations, read.names), (written, names.to_vec()));
    }

    #[test]
    fn images_are_read_each_for_itself() {
        let table = "# filename x y\n".to_owned()
            + &(0..6).map(|i| format!("good.png {} {}\n", 100 + 90 * (i % 3), 100 + 80 * (i / 3))).collect::<String>()
            + "few.png 1 1\nfew.png 50 2\nfew.png - -\nfew.png - -\nfew.png - -\nfew.png - -\nnone.png - -\n";
        let found = |images: Option<&str>| {
            let known = Known { images: images.map(str::to_owned), ..known() };
            let images = read_images(&table, &known).unwrap();
            images.into_iter().map(|image| (image.name, image.corners.len())).collect::<Vec<_>>()
        };
        assert_eq!(found(None), [("good.png".into(), 6), ("few.png".into(), 2), ("none.png".into(), 0)]);
        assert_eq!(found(Some("f*")), [("few.png".into(), 2)]);
        assert_eq!(found(Some("*cam1*")), []);
        assert!(read_detections(&table, &known()).unwrap_err().to_string().contains("few.png"));
        // Half a file is none.
        let half: String = table.lines().take(5).map(|line| format!("{line}\n")).collect();
        let error = read_images(&half, &known()).unwrap_err();
        assert!(error.to_string().contains("image \"good.png\" has 4 corners"), "{error}");
    }
}
