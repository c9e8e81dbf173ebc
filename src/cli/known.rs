//! What is known of detected corners beside their file: the board, the images' size, and which images to use.

use std::path::{Path, PathBuf};

use clap::Args;

use super::output::failure::Failure;
use crate::formats::{Detections, Known, StatedBoard, read_board_file, read_detections_file};
use crate::problem::Problem;
use crate::target::Board;

#[derive(Debug, Args)]
pub(crate) struct KnownArguments {
    /// Problem file that gives the board, image size, lens and intrinsics to estimate
    #[arg(long, conflicts_with_all = ["board", "square", "target", "image"])]
    problem: Option<PathBuf>,
    /// Inner corners of the board along x and y
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = board_size, requires = "square")]
    board: Option<[u32; 2]>,
    /// Distance between neighbouring corners (side of a square), in mm
    #[arg(long = "square-mm", value_name = "MM", value_parser = length, requires = "board")]
    square: Option<f64>,
    /// File of a board of another kind, in place of --board: Kalibr's target (YAML), or a table of its points in mm (CSV)
    #[arg(long, value_name = "FILE", conflicts_with = "board")]
    target: Option<PathBuf>,
    /// Size of the images in px
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = image_size)]
    image: Option<[u32; 2]>,
    /// Use only images whose names match, with `*` for any text, as in '*cam0*'
    #[arg(long, value_name = "PATTERN")]
    images: Option<String>,
}

impl KnownArguments {
    /// The problem, if one is given, and what is known by it or by the other options.
    pub(crate) fn read(&self) -> Result<(Option<Problem>, Known), Failure> {
        let problem = self.problem.as_deref().map(Problem::read).transpose()?;
        let images = self.images.clone();
        let known = if let Some(problem) = &problem {
            known_by(problem, images)
        } else {
            let of_options = self
                .board
                .zip(self.square)
                .map(|([columns, rows], square)| Board::checkerboard(columns as usize, rows as usize, square / 1e3));
            let board = self.target.as_deref().map(board_of_file).transpose()?.or(of_options);
            Known { board, image: self.image, images }
        };
        Ok((problem, known))
    }
}

/// The board that the file at `path` describes, if it does so completely.
fn board_of_file(path: &Path) -> Result<Board, Failure> {
    let stated = read_board_file(path).map_err(|error| Failure::TargetFile { path: path.to_owned(), error })?;
    let lacking =
        |what: &str, instead: &str| Err(Failure::Usage(format!("{} does not tell {what}; {instead}", path.display())));
    let grid = "give the grid of its corners by --board and --square-mm";
    match stated {
        StatedBoard::Checkerboard(board) => Ok(Board::Checkerboard(board)),
        StatedBoard::AprilGrid(board) => Ok(Board::AprilGrid(board)),
        StatedBoard::Points(board) => Ok(Board::Points(board)),
        StatedBoard::Charuco { .. } => lacking("how many squares the board has", grid),
        StatedBoard::Circles { is_asymmetric: false, .. } => lacking("the diameter of the circles", grid),
        StatedBoard::Circles { .. } => {
            lacking("the diameter of the circles", "list their centres in a table of points, or give --problem FILE")
        }
    }
}

/// What is known by a problem, of those images.
pub(crate) fn known_by(Problem { camera, target, .. }: &Problem, images: Option<String>) -> Known {
    Known { board: Some(target.board.clone()), image: Some([camera.width(), camera.height()]), images }
}

/// The corners in the file at `path`.
pub(crate) fn read_detections(path: &Path, known: &Known) -> Result<Detections, Failure> {
    read_detections_file(path, known).map_err(|error| Failure::Observations { path: path.to_owned(), error })
}

fn board_size(text: &str) -> Result<[u32; 2], String> {
    pair(text, 2, 1000, "8x6")
}

fn image_size(text: &str) -> Result<[u32; 2], String> {
    pair(text, 1, 100_000, "1280x720")
}

fn pair(text: &str, min: u32, max: u32, example: &str) -> Result<[u32; 2], String> {
    let number = |text: &str| text.parse().ok().filter(|x| (min..=max).contains(x));
    let parsed = text.split_once('x').and_then(|(a, b)| Some([number(a)?, number(b)?]));
    parsed.ok_or_else(|| format!("must be two whole numbers from {min} to {max}, as in {example}"))
}

fn length(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|x| (1e-3..=1e6).contains(x));
    parsed.ok_or_else(|| "must be a number from 0.001 to 1000000".into())
}

/// Parser of half the side of a detector's window, px.
pub(crate) fn window(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|x| (1.0..=1000.0).contains(x));
    parsed.ok_or_else(|| "must be a number from 1 to 1000".into())
}
