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
    let text = text.trim_start_matches('\u{feff}');
    let read = if text.trim_start().starts_with('{') { observations::read } else { vnl::read };
    let ListedImages { board, size: [width, height], images } = read(text, known)?;
    let images = chosen(images, known.images.as_deref())?;
    let (seen, skipped): (Vec<ListedImage>, Vec<ListedImage>) =
        images.into_iter().partition(|image| image.detected().count() > 0);
    let views = seen.iter().map(|image| -> View { image.detected().collect() }).collect();
    let observations =
        Observations::new(board, width, height, views).map_err(|fault| located(fault, &seen, text.lines().count()))?;
    let names = |images: Vec<ListedImage>| images.into_iter().map(|image| image.name).collect();
    Ok(Detections { observations, names: names(seen), skipped: names(skipped) })
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
