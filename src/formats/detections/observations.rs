//! calipose's own observations, JSON: board, image and the corners of every view.

use nalgebra::Vector2;

use super::known::Known;
use super::listed_image::{Detected, LARGEST_PIXEL, ListedImage, ListedImages};
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::Node;
use crate::formats::{image_size, tree};
use crate::target::Board;

const FORMAT: &str = "calipose.observations";
/// Most corners along one side, as in problem files.
const MOST_CORNERS: u32 = 1000;

/// The images of the file.
pub(super) fn read(text: &str, known: &Known) -> Result<ListedImages, ReadError> {
    let root = tree::parse(text)?;
    let format = root.require("", "format")?;
    let name = format.text(&"format")?;
    if name != FORMAT {
        let (key, found) = ("format".to_owned(), name.to_owned());
        return Err(ReadFault::Unsupported { key, found, supported: FORMAT }.at(format.line));
    }
    root.require("", "version")?.count(&"version", 1, 1)?;
    let stated = if known.board.is_some() { root.get("board") } else { Some(root.require("", "board")?) };
    let stated_board = stated.map(grid).transpose()?;
    let line = stated.map_or(root.line, |stated| stated.line);
    // A file that lists what its own board has is not refused for that before it is for its board.
    let board = if let Some(found) = &stated_board { found.clone() } else { known.board(None, line)? };
    let size = root.require("", "image")?;
    let side = |key: &str| image_size::side(size.require("image.", key)?, &format!("image.{key}"));
    let found = [side("width_px")?, side("height_px")?];
    let list = root.require("", "views")?.list(&"views")?;
    let images = list.iter().enumerate().map(|(i, node)| view(node, i, &board)).collect::<Result<_, _>>()?;
    Ok(ListedImages {
        board: known.board(stated_board, line)?,
        size: known.image_size(Some(found), size.line)?,
        images,
    })
}

/// The grid of corners that `stated` describes.
fn grid(stated: &Node) -> Result<Board, ReadError> {
    let side = |key: &str| stated.require("board.", key)?.count(&format_args!("board.{key}"), 2, MOST_CORNERS);
    let (columns, rows) = (side("columns")? as usize, side("rows")? as usize);
    let key = "board.square_mm";
    let square = stated.require("board.", "square_mm")?.number(&key)?.between(&key, 1e-3, 1e6)? / 1e3;
    Ok(Board::checkerboard(columns, rows, square))
}

fn view(node: &Node, i: usize, board: &Board) -> Result<ListedImage, ReadError> {
    let within = format!("views[{i}].");
    let name = match node.get("name") {
        Some(name) => name.text(&format_args!("{within}name"))?.to_owned(),
        None => format!("view {i}"),
    };
    let list = node.require(&within, "corners")?;
    let corners = list.list(&format_args!("{within}corners"))?;
    if corners.len() != board.corner_count() {
        let line = corners.last().map_or(list.line, |corner| corner.line);
        let fault = ReadFault::CornerCount {
            view: name,
            found: corners.len(),
            board: board.to_string(),
            corners: board.corner_count(),
        };
        return Err(fault.at(line));
    }
    let pixel = |(j, corner): (usize, &Node)| {
        if corner.is_null() {
            return Ok((None, corner.line));
        }
        let key = || format!("{within}corners[{j}]");
        let coordinates = corner.list(&format_args!("{within}corners[{j}]"))?;
        let [u, v] = coordinates else {
            let (found, expected) = (coordinates.len(), "2".to_owned());
            return Err(ReadFault::Length { key: key(), found, expected }.at(corner.line));
        };
        let number = |i: usize, node: &Node| {
            let key = format_args!("{within}corners[{j}][{i}]");
            node.number(&key)?.between(&key, -LARGEST_PIXEL, LARGEST_PIXEL)
        };
        let (u, v) = (number(0, u)?, number(1, v)?);
        Ok((Some(Detected { pixel: Vector2::new(u, v), weight: 1.0 }), corner.line))
    };
    let corners = corners.iter().enumerate().map(pixel).collect::<Result<_, ReadError>>()?;
    Ok(ListedImage { name, line: node.line, corners })
}
