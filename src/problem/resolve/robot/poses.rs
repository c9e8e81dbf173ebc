//! Which joint values poses may have: what the controller can be told, and how near to the limits.

use crate::problem::fault::Allowed;
use crate::problem::resolve::check::{Check, file_unit};
use crate::problem::schema;
use crate::problem::text::{At, Optional, key};
use crate::robot::{Joint, JointKind, Resolution, Robot};
use crate::sweep::JointSpace;

/// Degrees and mm, where poses may leave the grid: what controllers' panels show.
const RESOLUTION: f64 = 0.01;
/// Degrees and mm, where poses may leave the grid, whose ends are the limits.
const MARGIN: f64 = 0.5;

impl Check<'_, '_> {
    /// Sets the resolutions and margins of the arm's joints, which sweep `space`; `leave_grid` is whether poses may leave it.
    pub(crate) fn settable(
        &mut self,
        keys: &At<schema::Robot>,
        robot: &mut Robot,
        space: &JointSpace,
        leave_grid: bool,
    ) {
        // A joint that goes round meets no limit, and one that is held keeps no distance from its own.
        let meets_limits: Vec<bool> = robot
            .spans()
            .iter()
            .zip(&robot.chain.joints)
            .map(|(span, joint)| !span.is_turn && joint.limits.max > joint.limits.min)
            .collect();
        let joints = &mut robot.chain.joints;
        let kinds = [
            (JointKind::Revolute, key!(keys, joint_resolution_deg), key!(keys, limit_margin_deg)),
            (JointKind::Prismatic, key!(keys, joint_resolution_mm), key!(keys, limit_margin_mm)),
        ];
        for (kind, resolution, margin) in kinds {
            if joints.iter().all(|joint| joint.kind != kind) {
                let given: [&dyn Optional; 2] = [&resolution, &margin];
                self.refused(&given, &format!("a robot without {} joints", kind.adjective()), "leave it out");
                continue;
            }
            let range = |joint: &Joint| file_unit(kind, joint.limits.max - joint.limits.min);
            let ranges = joints.iter().zip(&meets_limits).filter(|(joint, meets)| joint.kind == kind && **meets);
            let narrowest = ranges.map(|(joint, _)| range(joint)).fold(360.0, f64::min);
            // Two swept values must not become one.
            let finest = match space {
                JointSpace::Grid(grid) => {
                    let steps = joints.iter().zip(grid.steps()).filter(|(joint, _)| joint.kind == kind);
                    steps.map(|(_, step)| file_unit(kind, step)).fold(narrowest, f64::min)
                }
                JointSpace::Sample(_) => narrowest,
            };
            let step = resolution.given().map(|step| self.number(&step, Allowed::between(0.0, finest)));
            let step = step.unwrap_or(if leave_grid { RESOLUTION.min(finest) } else { 0.0 });
            // Half the range would leave a single place.
            let allowed = Allowed::between(0.0, (490.0 * narrowest).floor() / 1e3);
            let margin = margin.given().map(|margin| self.number(&margin, allowed));
            for (i, joint) in joints.iter_mut().enumerate().filter(|(_, joint)| joint.kind == kind) {
                joint.resolution = Resolution::new(kind, step);
                if meets_limits[i] {
                    joint.limit_margin = kind.in_si(margin.unwrap_or(if leave_grid { MARGIN } else { 0.0 }));
                    if margin.is_none() && !space.has_within(i, &joint.range(), joint.resolution) {
                        joint.limit_margin = 0.0;
                    }
                }
            }
        }
    }
}
