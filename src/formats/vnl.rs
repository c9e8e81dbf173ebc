//! mrcal's corners: a table of `filename x y level`, one corner a line, the board's corners row by row.
//!
//! Written by `mrgingham` and read by `mrcal-calibrate-cameras`. A corner whose pixel is `-`, or whose level is `-` or
//! negative, was not detected; so was the whole board in an image with one such line. Other levels are not weighed.

use nalgebra::Vector2;

use super::detections::{LARGEST_PIXEL, Seen};
use super::error::{ReadError, ReadFault};
use super::tree::Located;
use crate::target::Board;

/// The images of the table.
pub(super) fn read(text: &str, board: &Board) -> Result<Vec<Seen>, ReadError> {
    let last_line = text.lines().count().max(1);
    if text.trim().is_empty() {
        return Err(ReadFault::Empty.at(last_line));
    }
    let mut columns: Option<usize> = None;
    let mut images: Vec<Seen> = Vec::new();
    for (line, row) in text.lines().enumerate().map(|(i, row)| (i + 1, row.trim())) {
        // `#` begins the header, once; `##` and `#!` are comments anywhere.
        let header = row.strip_prefix('#').filter(|rest| !rest.starts_with(['#', '!']));
        match (header, columns) {
            (Some(names), None) => columns = Some(width(names, line)?),
            (None, Some(columns)) if !row.is_empty() && !row.starts_with('#') => {
                let cells: Vec<&str> = row.split_whitespace().collect();
                if cells.len() != columns {
                    return Err(ReadFault::Columns { found: cells.len(), expected: columns }.at(line));
                }
                add(&mut images, &cells, line)?;
            }
            (None, None) if !row.is_empty() && !row.starts_with('#') => {
                let message = "no header before the first corner; it is `# filename x y level`".to_owned();
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
            let Board { columns, rows, .. } = *board;
            return Err(ReadFault::CornerCount { view, found, columns, rows }.at(line));
        }
    }
    Ok(images)
}

/// Columns of the header, which must be `filename x y` or `filename x y level`.
fn width(header: &str, line: usize) -> Result<usize, ReadError> {
    let names: Vec<&str> = header.split_whitespace().collect();
    match names[..] {
        ["filename", "x", "y"] | ["filename", "x", "y", "level"] => Ok(names.len()),
        _ => {
            let (key, found) = ("header".to_owned(), names.join(" "));
            Err(ReadFault::Unsupported { key, found, supported: "# filename x y level" }.at(line))
        }
    }
}

/// Adds the corner of a line to its image.
fn add(images: &mut Vec<Seen>, cells: &[&str], line: usize) -> Result<(), ReadError> {
    let name = cells[0];
    if images.last().is_none_or(|image| image.name != name) {
        if images.iter().any(|image| image.name == name) {
            return Err(ReadFault::Repeated { name: name.to_owned() }.at(line));
        }
        images.push(Seen { name: name.to_owned(), line, corners: Vec::new() });
    }
    let numbers = [(1, "x"), (2, "y"), (3, "level")].map(|(i, key)| {
        let Some(&cell) = cells.get(i) else { return Ok(Some(0.0)) };
        if cell == "-" {
            return Ok(None);
        }
        let value = cell.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
            let (key, found) = (key.to_owned(), format!("\"{cell}\""));
            ReadFault::Type { key, found, expected: "a finite number or -" }.at(line)
        })?;
        Located { line, value }.between(&key, -LARGEST_PIXEL, LARGEST_PIXEL).map(Some)
    });
    let [x, y, level] = numbers;
    let pixel = match (x?, y?, level?) {
        (Some(x), Some(y), Some(level)) if level >= 0.0 => Some(Vector2::new(x, y)),
        _ => None,
    };
    if let Some(image) = images.last_mut() {
        image.corners.push((pixel, line));
    }
    Ok(())
}
