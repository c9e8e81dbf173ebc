//! Tables of points: CSV with the header `x_mm,y_mm` or `x_mm,y_mm,group`.

use super::refused;
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::Located;
use crate::target::{BoardError, Points};

/// Largest coordinate, mm.
const MOST: f64 = 1e6;

/// Whether the text begins as such a table does.
pub(super) fn is_table(text: &str) -> bool {
    rows(text).next().is_some_and(|(_, header)| header.starts_with("x_mm"))
}

/// The points of a table: `x_mm,y_mm` and perhaps a whole number, the group, in every line after the header. `#` begins a
/// comment.
///
/// # Errors
/// The first fault, with its line.
pub fn read_points(text: &str) -> Result<Points, ReadError> {
    let mut rows = rows(text);
    let (line, header) = rows.next().ok_or_else(|| ReadFault::Empty.at(1))?;
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let expected = names.len();
    if !matches!(names[..], ["x_mm", "y_mm"] | ["x_mm", "y_mm", "group"]) {
        let (key, found) = ("header".to_owned(), header.to_owned());
        return Err(ReadFault::Unsupported { key, found, supported: "x_mm,y_mm and x_mm,y_mm,group" }.at(line));
    }
    let mut lines = Vec::new();
    let mut points = Vec::new();
    for (line, row) in rows {
        let cells: Vec<&str> = row.split(',').map(str::trim).collect();
        if cells.len() != expected {
            return Err(ReadFault::Columns { found: cells.len(), expected }.at(line));
        }
        let mistyped = |key: &str, cell: &str, expected| {
            let (key, found) = (key.to_owned(), format!("\"{cell}\""));
            ReadFault::Type { key, found, expected }.at(line)
        };
        let number = |i: usize| {
            let value = cells[i].parse().ok().filter(|x: &f64| x.is_finite());
            let value = value.ok_or_else(|| mistyped(names[i], cells[i], "a finite number"))?;
            Located { line, value }.between(&names[i], -MOST, MOST).map(|mm| mm / 1e3)
        };
        let group = match cells.get(2) {
            None | Some(&"") => None,
            Some(cell) => Some(cell.parse().map_err(|_| mistyped("group", cell, "a whole number"))?),
        };
        points.push(([number(0)?, number(1)?], group));
        lines.push(line);
    }
    Points::new(&points).map_err(|error| {
        let point = match error {
            BoardError::NotFinite { point, .. } => Some(point),
            BoardError::Duplicate { second, .. } => Some(second),
            _ => None,
        };
        let line = point.and_then(|point| lines.get(point)).or(lines.last()).copied().unwrap_or(line);
        refused(error, line)
    })
}

/// The lines that say something, with their numbers.
fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().enumerate().map(|(i, row)| (i + 1, row.trim()));
    lines.filter(|(_, row)| !row.is_empty() && !row.starts_with('#'))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn tables_are_read_line_by_line() {
        let text = "# from the CAD\nx_mm,y_mm,group\n0,0,1\n100,0,1\n\n100,50,\n0,50,-2\n";
        let points: Vec<_> = read_points(text).unwrap().listed().collect();
        assert_eq!(points.len(), 4);
        assert_eq!(points.iter().map(|point| point.1).collect::<Vec<_>>(), [Some(1), Some(1), None, Some(-2)]);
        let wrong = |from: &str, to: &str| read_points(&text.replace(from, to)).unwrap_err().to_string();
        assert_eq!(wrong("100,50,", "NaN,50,"), "line 6: `x_mm` is \"NaN\"; it must be a finite number");
        assert_eq!(wrong("100,50,", "100,0,"), "line 6: points 1 and 2 are one: (100, 0) mm");
        assert_eq!(wrong("0,50,-2", "0,50"), "line 7: 2 columns, but the header has 3");
        assert_eq!(wrong("0,50,-2", "0,50,a"), "line 7: `group` is \"a\"; it must be a whole number");
        assert!(wrong("0,50,-2\n", "").contains("3 points are too few"));
    }
}
