//! Detected corners, whatever file they come from.

mod images;
mod observations;
mod vnl;

use nalgebra::Vector2;

use super::error::{ReadError, ReadFault};
use crate::calibration::{Corner, ObservationError, Observations, View};
use crate::target::Board;

/// Largest pixel coordinate that is read, px; beyond it stands no slip of a detector but another kind of file.
pub(super) const LARGEST_PIXEL: f64 = 1e6;

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

/// What is known of the detections beside their file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Stated {
    /// The board.
    pub board: Option<Board>,
    /// Width and height of the images, px.
    pub image: Option<[u32; 2]>,
    /// The names of the images that are meant, `*` for any text and `?` for one character; all where there is none.
    pub images: Option<String>,
}

/// A corner as it was detected.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detected {
    pub(super) pixel: Vector2<f64>,
    pub(super) weight: f64,
}

/// An image of a file: all corners of the board, each with its line and whether it was detected.
pub(super) struct Seen {
    pub(super) name: String,
    pub(super) line: usize,
    pub(super) corners: Vec<(Option<Detected>, usize)>,
}

impl Seen {
    pub(super) fn last_line(&self) -> usize {
        self.corners.last().map_or(self.line, |(_, line)| *line)
    }

    /// Those detected.
    fn detected(&self) -> impl Iterator<Item = Corner> + '_ {
        let corners = self.corners.iter().enumerate();
        corners.filter_map(|(index, (detected, _))| {
            detected.map(|Detected { pixel, weight }| Corner { index, pixel, weight })
        })
    }
}

/// The detections of `text`: calipose's own JSON if it begins with a brace, else mrcal's vnl.
///
/// A file that has board and image size must agree with what is `stated`; one that has not needs it. Images of several cameras,
/// as far as their names tell, need a pattern that chooses one's.
///
/// # Errors
/// The first fault, with its line.
pub fn read_detections(text: &str, stated: &Stated) -> Result<Detections, ReadError> {
    let text = text.trim_start_matches('\u{feff}');
    let (board, [width, height], images) = if text.trim_start().starts_with('{') {
        let file = observations::read(text)?;
        let ((board, board_line), (image, image_line)) = (file.board, file.image);
        if let Some(given) = stated.board.filter(|given| !same(given, &board)) {
            return Err(mismatch("board", &board_text(&board), &board_text(&given)).at(board_line));
        }
        if let Some(given) = stated.image.filter(|given| *given != image) {
            return Err(mismatch("image size", &size_text(image), &size_text(given)).at(image_line));
        }
        (board, image, file.views)
    } else {
        let board = stated.board.ok_or_else(|| ReadFault::NotStated { what: "board" }.at(1))?;
        let image = stated.image.ok_or_else(|| ReadFault::NotStated { what: "image size" }.at(1))?;
        (board, image, vnl::read(text, &board)?)
    };
    let images = chosen(images, stated.images.as_deref())?;
    let (seen, skipped): (Vec<Seen>, Vec<Seen>) = images.into_iter().partition(|image| image.detected().count() > 0);
    let views = seen.iter().map(|image| -> View { image.detected().collect() }).collect();
    let observations =
        Observations::new(board, width, height, views).map_err(|fault| located(fault, &seen, text.lines().count()))?;
    let names = |images: Vec<Seen>| images.into_iter().map(|image| image.name).collect();
    Ok(Detections { observations, names: names(seen), skipped: names(skipped) })
}

/// The images whose names match `pattern`.
fn chosen(mut images: Vec<Seen>, pattern: Option<&str>) -> Result<Vec<Seen>, ReadError> {
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
fn located(fault: ObservationError, seen: &[Seen], last_line: usize) -> ReadError {
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

fn same(a: &Board, b: &Board) -> bool {
    // mm to m and back rounds.
    (a.columns, a.rows) == (b.columns, b.rows) && (a.square / b.square - 1.0).abs() < 1e-9
}

fn mismatch(what: &'static str, found: &str, given: &str) -> ReadFault {
    ReadFault::Mismatch { what, found: found.to_owned(), given: given.to_owned() }
}

fn board_text(board: &Board) -> String {
    format!("{} x {} of {} mm", board.columns, board.rows, (board.square * 1e9).round() / 1e6)
}

fn size_text([width, height]: [u32; 2]) -> String {
    format!("{width} x {height}")
}
