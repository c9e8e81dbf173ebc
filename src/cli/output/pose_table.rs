//! Poses as a table that fits a terminal of 80 columns.

use comfy_table::presets;
use comfy_table::{CellAlignment, Table};

use super::{WIDTH, fixed};
use crate::plan::document::PlannedPose;
use crate::problem::Problem;
use crate::robot::Joint;

/// The poses, one a row, under a line that says the units: in full where that fits, with the joints' names abbreviated or without
/// bars where it does not.
pub(crate) fn pose_table(problem: &Problem, poses: &[&PlannedPose]) -> String {
    let joints = &problem.robot.chain.joints;
    let layouts =
        [Layout { names: true, bars: true }, Layout { names: false, bars: true }, Layout { names: false, bars: false }];
    let drawn = layouts.map(|layout| (layout, layout.draw(problem, poses)));
    let fits = |text: &str| text.lines().all(|line| line.chars().count() <= WIDTH);
    let narrowest = drawn.len() - 1;
    let (layout, table) = &drawn[drawn.iter().position(|(_, text)| fits(text)).unwrap_or(narrowest)];
    format!("{}\n\n{table}", legend(joints, layout.names, problem))
}

#[derive(Clone, Copy)]
struct Layout {
    /// Whether joints have their names, or numbers that the legend explains.
    names: bool,
    bars: bool,
}

/// Cells of a bar.
const BAR: usize = 6;

impl Layout {
    fn draw(self, problem: &Problem, poses: &[&PlannedPose]) -> String {
        let joints = problem.robot.chain.joints.iter().enumerate();
        let joints = joints.map(|(i, joint)| if self.names { joint.name.clone() } else { format!("j{}", i + 1) });
        let stable = problem.stability.as_ref().map(|_| "margin".into());
        let partly = problem.visibility.min_corners.map(|_| "corners".into());
        let fixed_columns = ["tilt", "distance", "share"].map(String::from);
        let header: Vec<String> =
            std::iter::once("pose".into()).chain(joints).chain(fixed_columns).chain(stable).chain(partly).collect();
        let corners = problem.target.board.corner_count();
        let greatest = poses.iter().map(|pose| pose.share).fold(0.0, f64::max);
        let row = |pose: &&PlannedPose| {
            let share = format!("{:.1}", 100.0 * pose.share);
            let share = if self.bars { format!("{} {share:>4}", bar(pose.share / greatest)) } else { share };
            std::iter::once(pose.id.to_string())
                .chain(pose.joints_deg.iter().map(|&q| fixed(q, 1)))
                .chain([format!("{:.1}", pose.tilt_deg), format!("{:.0}", 1e3 * pose.distance_m), share])
                .chain(pose.stability_margin_m.map(|margin| fixed(1e3 * margin, 0)))
                .chain(
                    problem
                        .visibility
                        .min_corners
                        .map(|_| pose.corners_seen.as_ref().map_or(corners, Vec::len).to_string()),
                )
                .collect::<Vec<String>>()
        };
        let mut table = Table::new();
        table.load_preset(presets::NOTHING).set_header(header).add_rows(poses.iter().map(row));
        for (i, column) in table.column_iter_mut().enumerate() {
            column.set_padding((u16::from(i != 0), u16::from(self.names)));
            column.set_cell_alignment(if i == 0 { CellAlignment::Left } else { CellAlignment::Right });
        }
        table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
    }
}

/// A bar of `share` of its whole length, in eighths of a cell.
fn bar(share: f64) -> String {
    const EIGHTHS: [char; 8] = [' ', '▏', '▎', '▍', '▌', '▋', '▊', '▉'];
    let eighths = (share.clamp(0.0, 1.0) * (8 * BAR) as f64).round() as usize;
    let mut bar = "█".repeat(eighths / 8);
    if !eighths.is_multiple_of(8) {
        bar.push(EIGHTHS[eighths % 8]);
    }
    format!("{bar:<BAR$}")
}

/// The units, and what the joints' numbers mean where they have no names.
fn legend(joints: &[Joint], named: bool, problem: &Problem) -> String {
    let in_mm: Vec<&str> =
        joints.iter().filter(|joint| joint.kind.display_unit() == "mm").map(|joint| joint.name.as_str()).collect();
    let values = match in_mm.len() {
        0 => "Joint values and tilt in degrees".to_owned(),
        _ => format!("Joint values and tilt in degrees ({} in mm)", in_mm.join(", ")),
    };
    let margin = problem.stability.as_ref().map_or("", |_| ", margin to tipping over in mm");
    let mut text = format!("{values}, distance in mm, share of the information in %{margin}.");
    if !named {
        let names: Vec<String> =
            joints.iter().enumerate().map(|(i, joint)| format!("j{} {}", i + 1, joint.name)).collect();
        text += &format!(" Joints: {}.", names.join(", "));
    }
    super::wrapped(&text)
}

#[cfg(test)]
mod tests {
    use super::bar;

    #[test]
    fn bars_are_as_long_as_their_share() {
        assert_eq!(bar(1.0), "██████");
        assert_eq!(bar(0.5), "███   ");
        assert_eq!(bar(0.0), "      ");
        // A sixteenth of six cells is three eighths of one.
        assert_eq!(bar(1.0 / 16.0), "▍     ");
    }
}
