//! The board and its zone.

use std::ops::Bound;
use std::path::Path;

use super::check::{Check, LENGTH, SIZE};
use crate::formats::{StatedBoard, read_board_file};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema::{self, Choice, TargetKind};
use crate::problem::text::{At, KeyPath, Optional, key};
use crate::target::{AprilGrid, Board, BoardError, Charuco, Circles, Dictionary, Points, Target, Warp, Zone};

/// Corners, squares or circles along one side. A homography needs four points, two by two.
const CORNERS: Allowed = Allowed::between(2.0, 1000.0);
/// A chessboard with four inner corners has three squares by three.
const SQUARES: Allowed = Allowed::between(3.0, 1000.0);
const TAGS: Allowed = Allowed::between(1.0, 1000.0);
/// Space between tags, of their side.
const TAG_SPACING: Allowed = Allowed::between(0.01, 1.0);

/// A board that is bent by more is none.
const WARP: Allowed = Allowed::between(1e-3, 20.0);

/// Keys of some kinds only.
const OF_KINDS: [&str; 12] = [
    "file",
    "columns",
    "rows",
    "square_mm",
    "marker_mm",
    "dictionary",
    "legacy_pattern",
    "tag_mm",
    "tag_spacing",
    "spacing_mm",
    "diameter_mm",
    "points_mm",
];

impl TargetKind {
    /// Its keys, of [`OF_KINDS`].
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Checkerboard => &["file", "columns", "rows", "square_mm"],
            Self::Charuco => &["file", "columns", "rows", "square_mm", "marker_mm", "dictionary", "legacy_pattern"],
            Self::AprilGrid => &["file", "columns", "rows", "tag_mm", "tag_spacing"],
            Self::Circles | Self::AsymmetricCircles => &["file", "columns", "rows", "spacing_mm", "diameter_mm"],
            Self::Points => &["file", "points_mm"],
        }
    }
}

impl Check<'_, '_> {
    /// The target, or none if something is wrong with it; files are sought from `folder`.
    pub(super) fn target(&mut self, target: &At<schema::Target>, folder: &Path) -> Option<Target> {
        let faults = self.faults.len();
        let board = self.printed(target, folder);
        let X_BT = self.pose(&key!(target, pose));
        let board = board.filter(|_| self.faults.len() == faults)?;
        let (width, height) = board.printed_size();
        let mut zone = Zone {
            width: self.zone_side(key!(target, zone.width_mm), width * 1e3),
            height: self.zone_side(key!(target, zone.height_mm), height * 1e3),
            edge_margin: 0.0,
        };
        let deepest_mm = zone.width.min(zone.height) * 1e3 / 2.0;
        let margin = Allowed { min: Bound::Included(0.0), max: Bound::Excluded(deepest_mm) };
        zone.edge_margin = self.length(&key!(target, zone.edge_margin_mm), margin);
        let warp = key!(target, warp_mm).given().map(|warp| self.length(&warp, WARP));
        let warp = warp.map(|deviation| Warp::new(deviation, &board));
        let thickness = self.length(&key!(target, thickness_mm), SIZE);
        (self.faults.len() == faults).then_some(Target { board, X_BT, zone, warp, thickness })
    }

    /// What is printed.
    fn printed(&mut self, target: &At<schema::Target>, folder: &Path) -> Option<Board> {
        let stated = key!(target, kind).given().map(|kind| kind.value.0);
        let Some(file) = key!(target, file).given() else {
            let kind = stated.unwrap_or(TargetKind::Checkerboard);
            self.of_kind(target, kind, &[]);
            return self.stated_board(target, kind);
        };
        let path = folder.join(file.value);
        let found = match read_board_file(&path) {
            Ok(found) => found,
            Err(error) => {
                self.fault(&file.path, Reason::TargetFile { path, error });
                return None;
            }
        };
        let (kind, of_file): (_, &[&str]) = match found {
            StatedBoard::Checkerboard(_) => (TargetKind::Checkerboard, &["columns", "rows", "square_mm"]),
            StatedBoard::AprilGrid(_) => (TargetKind::AprilGrid, &["columns", "rows", "tag_mm", "tag_spacing"]),
            StatedBoard::Circles { is_asymmetric: false, .. } => {
                (TargetKind::Circles, &["columns", "rows", "spacing_mm"])
            }
            StatedBoard::Circles { .. } => (TargetKind::AsymmetricCircles, &["columns", "rows", "spacing_mm"]),
            StatedBoard::Charuco { .. } => (TargetKind::Charuco, &["square_mm", "marker_mm", "dictionary"]),
            StatedBoard::Points(_) => (TargetKind::Points, &["points_mm"]),
        };
        if let Some(stated) = stated.filter(|&stated| stated != kind) {
            let (stated, found) = (stated.name(), kind.name());
            self.fault(&key!(target, kind).path, Reason::OtherKind { stated, found, file: path });
            return None;
        }
        self.of_kind(target, kind, of_file);
        match found {
            StatedBoard::Checkerboard(board) => Some(Board::Checkerboard(board)),
            StatedBoard::AprilGrid(board) => Some(Board::AprilGrid(board)),
            StatedBoard::Points(board) => Some(Board::Points(board)),
            StatedBoard::Circles { columns, rows, spacing, is_asymmetric } => {
                let diameter = self.required(key!(target, diameter_mm), &[])?;
                let size = self.length(&diameter, SIZE);
                let circles = Circles::new([columns as usize, rows as usize], spacing, size, is_asymmetric);
                self.built(circles, &diameter.path).map(Board::Circles)
            }
            StatedBoard::Charuco { dictionary, square, marker } => {
                let sides = self.sides(target, SQUARES)?;
                let is_legacy = target.value.legacy_pattern.unwrap_or(false);
                let board = Charuco::new(sides, square, marker, dictionary, is_legacy);
                self.built(board, &file.path).map(Board::Charuco)
            }
        }
    }

    /// What the keys state.
    fn stated_board(&mut self, target: &At<schema::Target>, kind: TargetKind) -> Option<Board> {
        let faults = self.faults.len();
        let is_good = |check: &Self| check.faults.len() == faults;
        match kind {
            TargetKind::Checkerboard => {
                let sides = self.sides(target, CORNERS);
                let square = self.size(key!(target, square_mm));
                let [columns, rows] = sides.filter(|_| is_good(self))?;
                Some(Board::checkerboard(columns, rows, square?))
            }
            TargetKind::Charuco => {
                let sides = self.sides(target, SQUARES);
                let (square, marker) = (self.size(key!(target, square_mm)), self.size(key!(target, marker_mm)));
                let dictionary = self.dictionary(key!(target, dictionary));
                let is_legacy = target.value.legacy_pattern.unwrap_or(false);
                let sides = sides.filter(|_| is_good(self))?;
                let board = Charuco::new(sides, square?, marker?, dictionary?, is_legacy);
                let culprit = match board {
                    Err(BoardError::TooLarge { .. }) => key!(target, marker_mm).path,
                    _ => key!(target, dictionary).path,
                };
                self.built(board, &culprit).map(Board::Charuco)
            }
            TargetKind::AprilGrid => {
                let sides = self.sides(target, TAGS);
                let tag = self.size(key!(target, tag_mm));
                let spacing = self.required(key!(target, tag_spacing), &[]);
                let spacing = spacing.map(|spacing| self.number(&spacing, TAG_SPACING));
                let sides = sides.filter(|_| is_good(self))?;
                let board = AprilGrid::new(sides, tag?, spacing?);
                self.built(board, &key!(target, columns).path).map(Board::AprilGrid)
            }
            TargetKind::Circles | TargetKind::AsymmetricCircles => {
                let sides = self.sides(target, CORNERS);
                let (spacing, diameter) = (self.size(key!(target, spacing_mm)), self.size(key!(target, diameter_mm)));
                let sides = sides.filter(|_| is_good(self))?;
                let board = Circles::new(sides, spacing?, diameter?, kind == TargetKind::AsymmetricCircles);
                self.built(board, &key!(target, diameter_mm).path).map(Board::Circles)
            }
            TargetKind::Points => {
                let points = key!(target, points_mm);
                if !points.is_given() {
                    self.fault(&key!(target, file).path, Reason::Missing { allowed: Vec::new() });
                    return None;
                }
                let mut listed = Vec::new();
                for point in points.elements() {
                    let (&[x, y] | &[x, y, _]) = point.value.as_slice() else {
                        let found = point.value.len();
                        self.fault(&point.path, Reason::Length { found, expected: 2, per: "coordinate" });
                        continue;
                    };
                    for number in point.elements() {
                        self.number(&number, LENGTH);
                    }
                    if let Some(group) = point.elements().nth(2).filter(|group| group.value.fract() != 0.0) {
                        let found = group.value.to_string();
                        self.fault(&group.path, Reason::Type { found, expected: "a whole number".into() });
                    }
                    listed.push(([x / 1e3, y / 1e3], point.value.get(2).map(|&group| group as i64)));
                }
                if !is_good(self) {
                    return None;
                }
                let board = Points::new(&listed);
                let culprit = match board {
                    Err(BoardError::Duplicate { second, .. }) => points.path.at(second),
                    _ => points.path,
                };
                self.built(board, &culprit).map(Board::Points)
            }
        }
    }

    /// Refuses keys of other kinds, and those that the target's file gives already.
    fn of_kind(&mut self, target: &At<schema::Target>, kind: TargetKind, of_file: &[&str]) {
        let keys: [&dyn Optional; OF_KINDS.len()] = [
            &key!(target, file),
            &key!(target, columns),
            &key!(target, rows),
            &key!(target, square_mm),
            &key!(target, marker_mm),
            &key!(target, dictionary),
            &key!(target, legacy_pattern),
            &key!(target, tag_mm),
            &key!(target, tag_spacing),
            &key!(target, spacing_mm),
            &key!(target, diameter_mm),
            &key!(target, points_mm),
        ];
        for (name, key) in OF_KINDS.iter().zip(keys) {
            if of_file.contains(name) {
                self.excluded(&[key], "target.file");
            } else if !kind.keys().contains(name) {
                let names: Vec<String> = kind.keys().iter().map(|name| format!("`{name}`")).collect();
                let instead = format!("a target of the kind \"{}\" has {}", kind.name(), names.join(", "));
                self.refused(&[key], &format!("the kind \"{}\"", kind.name()), &instead);
            }
        }
    }

    /// Columns and rows.
    fn sides(&mut self, target: &At<schema::Target>, allowed: Allowed) -> Option<[usize; 2]> {
        let columns = self.required(key!(target, columns), &[]);
        let rows = self.required(key!(target, rows), &[]);
        let columns = columns.map(|columns| self.count(&columns, allowed));
        let rows = rows.map(|rows| self.count(&rows, allowed));
        Some([columns?, rows?])
    }

    /// A size that must be given, in m.
    fn size(&mut self, size: At<Option<f64>>) -> Option<f64> {
        self.required(size, &[]).map(|size| self.length(&size, SIZE))
    }

    fn dictionary(&mut self, name: At<Option<String>>) -> Option<Dictionary> {
        let names: Vec<&str> = Dictionary::all().map(Dictionary::name).collect();
        let name = self.required(name, &names)?;
        let found = Dictionary::named(name.value);
        if found.is_none() {
            self.unknown(&name.path, name.value, &names);
        }
        found
    }

    /// The board, or what is wrong with it at the key that is to blame.
    fn built<T>(&mut self, board: Result<T, BoardError>, culprit: &KeyPath) -> Option<T> {
        board.map_err(|error| self.fault(culprit, Reason::Board { error })).ok()
    }

    /// A side of the zone, in m: at least the printed board's.
    fn zone_side(&mut self, side: At<Option<f64>>, printed_mm: f64) -> f64 {
        let Some(side) = side.given() else {
            return printed_mm / 1e3;
        };
        let side_mm = *side.value;
        // In binary, three squares of 0.1 mm are a little more than 0.3 mm.
        if side_mm > 0.0 && side_mm < printed_mm * (1.0 - 1e-9) {
            self.fault(&side.path, Reason::BoardBeyondZone { zone: side_mm, board: printed_mm });
        }
        self.length(&side, SIZE)
    }
}
