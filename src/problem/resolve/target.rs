//! The board and its zone.

use std::ops::Bound;

use super::check::{Check, SIZE};
use crate::problem::fault::{Allowed, Reason};
use crate::problem::schema;
use crate::problem::text::{At, key};
use crate::target::{Board, Target, Zone};

/// Corners along one side. A homography needs four points, two by two.
const CORNERS: Allowed = Allowed::between(2.0, 1000.0);

impl Check<'_, '_> {
    /// The target, or none if something is wrong with it.
    pub(super) fn target(&mut self, target: &At<schema::Target>) -> Option<Target> {
        let faults = self.faults.len();
        let board = Board {
            columns: self.count(&key!(target, columns), CORNERS),
            rows: self.count(&key!(target, rows), CORNERS),
            square: self.length(&key!(target, square_mm), SIZE),
        };
        let X_BT = self.pose(&key!(target, pose));
        let mut zone = Zone { width: 0.0, height: 0.0, edge_margin: 0.0 };
        if self.faults.len() == faults {
            let printed_mm = |inner_corners: u32| f64::from(inner_corners + 1) * target.value.square_mm;
            zone.width = self.zone_side(key!(target, zone.width_mm), printed_mm(target.value.columns));
            zone.height = self.zone_side(key!(target, zone.height_mm), printed_mm(target.value.rows));
            let deepest_mm = zone.width.min(zone.height) * 1e3 / 2.0;
            let margin = Allowed { min: Bound::Included(0.0), max: Bound::Excluded(deepest_mm) };
            zone.edge_margin = self.length(&key!(target, zone.edge_margin_mm), margin);
        }
        (self.faults.len() == faults).then_some(Target { board, X_BT, zone })
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
