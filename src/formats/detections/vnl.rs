//! mrcal's corners: a table of `filename x y level` or `filename x y weight`, one corner a line, the board's corners row by
//! row.
//!
//! Written by `mrgingham` and read by `mrcal-calibrate-cameras`. A corner whose pixel is `-`, or whose level or weight is `-`
//! or negative, was not detected; so was the whole board in an image with one such line. A corner that was found in the
//! image made smaller `level` times by half counts with the weight ½^level, as it does for mrcal.

use std::collections::HashSet;

use nalgebra::Vector2;

use super::known::Known;
use super::listed_image::{Detected, LARGEST_PIXEL, ListedImage, ListedImages};
use crate::calibration::{Corner, Observations};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::Located;
use crate::target::Board;

/// Largest level: an image made smaller so often has no pixels left.
const LARGEST_LEVEL: f64 = 20.0;

/// Weights further from 1 are slips.
const LARGEST_WEIGHT: f64 = 1e6;

/// What the fourth column says of a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Trust {
    None,
    Level,
    Weight,
}

/// The images of the file, which states neither board nor image size.
pub(super) fn read(text: &str, known: &Known) -> Result<ListedImages, ReadError> {
    let (board, size) = (known.board(None, 1)?, known.image_size(None, 1)?);
    let images = table(text, &board)?;
    Ok(ListedImages { board, size, images })
}

/// The table of views with those names: words, none twice.
pub(super) fn write(observations: &Observations, names: &[String]) -> String {
    let mut text = "# filename x y weight\n".to_owned();
    for (view, name) in observations.views().iter().zip(names) {
        let mut lines = vec![format!("{name} - - -\n"); observations.board().corner_count()];
        for Corner { index, pixel, weight } in view {
            lines[*index] = format!("{name} {} {} {weight}\n", pixel.x, pixel.y);
        }
        text.extend(lines);
    }
    text
}

/// The images of the table.
fn table(text: &str, board: &Board) -> Result<Vec<ListedImage>, ReadError> {
    let last_line = text.lines().count().max(1);
    if text.trim().is_empty() {
        return Err(ReadFault::Empty.at(last_line));
    }
    let mut trust: Option<Trust> = None;
    let mut images: Vec<ListedImage> = Vec::new();
    let mut names = HashSet::new();
    for (line, row) in text.lines().enumerate().map(|(i, row)| (i + 1, row.trim())) {
        // `#` begins the header, once; `##` and `#!` are comments anywhere.
        let header = row.strip_prefix('#').filter(|rest| !rest.starts_with(['#', '!']));
        match (header, trust) {
            (Some(header), None) => trust = Some(fourth(header, line)?),
            (None, Some(trust)) if !row.is_empty() && !row.starts_with('#') => {
                let cells: Vec<&str> = row.split_whitespace().collect();
                let name = cells[0];
                if images.last().is_none_or(|image| image.name != name) {
                    if !names.insert(name) {
                        return Err(ReadFault::Repeated { name: name.to_owned() }.at(line));
                    }
                    images.push(ListedImage { name: name.to_owned(), line, corners: Vec::new() });
                }
                let corner = corner(&cells, trust, line)?;
                if let Some(image) = images.last_mut() {
                    image.corners.push((corner, line));
                }
            }
            (None, None) if !row.is_empty() && !row.starts_with('#') => {
                let message =
                    "there is no header before the first corner; it must be `# filename x y level`".to_owned();
                return Err(ReadFault::Syntax { message }.at(line));
            }
            _ => {}
        }
    }
    if images.is_empty() {
        let message = "the table has no corners".to_owned();
        return Err(ReadFault::Syntax { message }.at(last_line));
    }
    for image in &mut images {
        if let [(None, _)] = image.corners[..] {
            image.corners.clear();
        } else if image.corners.len() != board.corner_count() {
            let (view, found, line) = (image.name.clone(), image.corners.len(), image.last_line());
            let (board, corners) = (board.to_string(), board.corner_count());
            return Err(ReadFault::CornerCount { view, found, board, corners }.at(line));
        }
    }
    Ok(images)
}

/// What the header says of the fourth column.
fn fourth(header: &str, line: usize) -> Result<Trust, ReadError> {
    let names: Vec<&str> = header.split_whitespace().collect();
    match names[..] {
        ["filename", "x", "y"] => Ok(Trust::None),
        ["filename", "x", "y", "level"] => Ok(Trust::Level),
        ["filename", "x", "y", "weight"] => Ok(Trust::Weight),
        _ => {
            let (key, found) = ("header".to_owned(), names.join(" "));
            let supported = "# filename x y, and level or weight";
            Err(ReadFault::Unsupported { key, found, supported }.at(line))
        }
    }
}

/// The corner of a line, if it was detected.
fn corner(cells: &[&str], trust: Trust, line: usize) -> Result<Option<Detected>, ReadError> {
    let expected = if trust == Trust::None { 3 } else { 4 };
    // mrgingham leaves the level out where it says that there is nothing.
    let nothing = cells.len() == 3 && cells[1..] == ["-", "-"];
    if cells.len() != expected && !nothing {
        return Err(ReadFault::Columns { found: cells.len(), expected }.at(line));
    }
    let number = |i: usize, key: &str, max: f64| {
        let Some(&cell) = cells.get(i).filter(|cell| **cell != "-") else { return Ok(None) };
        let value = cell.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
            let (key, found) = (key.to_owned(), format!("\"{cell}\""));
            ReadFault::Type { key, found, expected: "a finite number or -" }.at(line)
        })?;
        Located { line, value }.between(&key, -LARGEST_PIXEL, max).map(Some)
    };
    let (x, y) = (number(1, "x", LARGEST_PIXEL)?, number(2, "y", LARGEST_PIXEL)?);
    let weight = match trust {
        Trust::None => Some(1.0),
        Trust::Level => {
            number(3, "level", LARGEST_LEVEL)?.filter(|level| *level >= 0.0).map(|level| 0.5f64.powf(level))
        }
        Trust::Weight => match number(3, "weight", LARGEST_WEIGHT)?.filter(|weight| *weight > 0.0) {
            Some(value) => Some(Located { line, value }.between(&"weight", 1.0 / LARGEST_WEIGHT, LARGEST_WEIGHT)?),
            None => None,
        },
    };
    Ok(match (x, y, weight) {
        (Some(x), Some(y), Some(weight)) => Some(Detected { pixel: Vector2::new(x, y), weight }),
        _ => None,
    })
}
