//! Joint values among other numbers, as a table that fits a terminal of 80 columns.

use super::{WIDTH, table, tight_table, wrapped};
use crate::robot::Joint;

/// Heading of a column beside those of the joints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heading {
    /// With the unit.
    pub(crate) full: &'static str,
    /// Where that is too wide; the legend says the rest.
    pub(crate) brief: &'static str,
}

/// Rows of the columns `before`, of one for each joint, and of those `after`. Where names are too wide, joints have numbers that
/// a line before the table explains, with `legend` on the brief headings.
pub(crate) fn joint_table(
    joints: &[Joint],
    before: &[Heading],
    after: &[Heading],
    legend: &str,
    rows: &[Vec<String>],
) -> String {
    let header = |joint: &dyn Fn(usize, &Joint) -> String, heading: fn(&Heading) -> &'static str| -> Vec<String> {
        let joints = joints.iter().enumerate().map(|(i, each)| joint(i, each));
        let others = |headings: &[Heading]| headings.iter().map(|each| heading(each).to_owned()).collect::<Vec<_>>();
        others(before).into_iter().chain(joints).chain(others(after)).collect()
    };
    let named = header(&|_, joint| format!("{} [{}]", joint.name, joint.kind.display_unit()), |heading| heading.full);
    let full = table(&named, rows);
    if full.lines().all(|line| line.chars().count() <= WIDTH) {
        return full;
    }
    let names: Vec<String> = joints
        .iter()
        .enumerate()
        .map(|(i, joint)| format!("j{} {} [{}]", i + 1, joint.name, joint.kind.display_unit()))
        .collect();
    let numbered = header(&|i, _| format!("j{}", i + 1), |heading| heading.brief);
    format!("{}\n\n{}", wrapped(&format!("Joints: {}. {legend}", names.join(", "))), tight_table(&numbered, rows))
}
