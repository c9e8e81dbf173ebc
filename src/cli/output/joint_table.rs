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

/// Rows of the columns `before`, of one for each joint, and of those `after`. Where units in the headings are too wide, a line before
/// the table says them, with `legend` on the brief headings; where names are too wide as well, joints have numbers that it explains.
pub(crate) fn joint_table(
    joints: &[Joint],
    before: &[Heading],
    after: &[Heading],
    legend: &str,
    rows: &[Vec<String>],
) -> String {
    let header = |names: Vec<String>, heading: fn(&Heading) -> &'static str| -> Vec<String> {
        let others = |headings: &[Heading]| headings.iter().map(|each| heading(each).to_owned()).collect::<Vec<_>>();
        others(before).into_iter().chain(names).chain(others(after)).collect()
    };
    let unit = |joint: &Joint| joint.kind.display_unit();
    let with_units = joints.iter().map(|joint| format!("{} [{}]", joint.name, unit(joint))).collect();
    let full = table(&header(with_units, |heading| heading.full), rows);
    if fits(&full) {
        return full;
    }
    let in_mm: Vec<&str> = joints.iter().filter(|joint| unit(joint) == "mm").map(|joint| joint.name.as_str()).collect();
    let but = if in_mm.is_empty() { String::new() } else { format!(" ({} in mm)", in_mm.join(", ")) };
    let legend = format!("Joint values in degrees{but}. {legend}");
    let names: Vec<String> = joints.iter().map(|joint| joint.name.clone()).collect();
    let named = table(&header(names.clone(), |heading| heading.brief), rows);
    if fits(&named) {
        return format!("{}\n\n{named}", wrapped(&legend));
    }
    let numbers: Vec<String> = (1..=joints.len()).map(|i| format!("j{i}")).collect();
    let numbered = tight_table(&header(numbers.clone(), |heading| heading.brief), rows);
    let who: Vec<String> = numbers.iter().zip(&names).map(|(number, name)| format!("{number} {name}")).collect();
    format!("{}\n\n{numbered}", wrapped(&format!("{legend} Joints: {}.", who.join(", "))))
}

fn fits(table: &str) -> bool {
    table.lines().all(|line| line.chars().count() <= WIDTH)
}
