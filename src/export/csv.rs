//! A table for programs of one's own: a row a stop, joint values in rad and degrees (m and mm of joints that slide).

use super::Export;
use super::program::{Leg, Program};
use super::text::{decimal, file_name, fixed};
use crate::robot::JointKind;

pub(super) const EXPORT: Export =
    Export { name: "csv", file_name: |program| file_name(program.name, "csv"), write: |program| Ok(write(program)) };

fn write(program: &Program) -> String {
    let legs = program.legs();
    let rows = legs.iter().map(|leg| row(program, leg));
    std::iter::once(head(program)).chain(rows).map(|cells| line(&cells)).collect()
}

/// The units of a joint's columns, SI's first.
fn units(kind: JointKind) -> [&'static str; 2] {
    match kind {
        JointKind::Revolute => ["rad", "deg"],
        JointKind::Prismatic => ["m", "mm"],
    }
}

fn head(program: &Program) -> Vec<String> {
    let of = |unit: usize| program.joints.iter().map(move |j| format!("joint_{}_{}", j.name, units(j.kind)[unit]));
    let mut cells = vec!["visit".to_owned(), "label".to_owned()];
    cells.extend(of(0).chain(of(1)));
    cells.extend(["seconds", "dwell"].map(str::to_owned));
    cells
}

/// At home, and where the robot only turns, the number of the visit is 0.
fn row(program: &Program, leg: &Leg) -> Vec<String> {
    let mut cells = vec![leg.visit.unwrap_or(0).to_string(), leg.label.to_owned()];
    cells.extend(leg.to.iter().map(|&value| decimal(value)));
    cells.extend(leg.to.iter().zip(program.joints).map(|(&value, joint)| match joint.kind {
        JointKind::Revolute => fixed(value.to_degrees(), 6),
        JointKind::Prismatic => fixed(value * 1e3, 6),
    }));
    let dwell = if leg.visit.is_some() { program.dwell } else { 0.0 };
    cells.extend([leg.seconds, dwell].map(decimal));
    cells
}

/// The cells as a line; in quotes, doubled inside, those that would not survive (RFC 4180).
fn line(cells: &[String]) -> String {
    let quoted = |cell: &String| {
        if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.clone() }
    };
    cells.iter().map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{joints, program, stops};
    use crate::export::program::{Home, Stop};

    #[test]
    fn a_row_a_visit() {
        let mut joints = joints();
        joints.truncate(2);
        joints[0].kind = JointKind::Prismatic;
        joints[1].name = "a,\"b\"".into();
        let stops = [Stop { label: "pose 7".into(), q: vec![0.25, -0.5], seconds: 2.0, picture: true }];
        let mut tour = program(&joints, &stops);
        let [si, shown] = ["m,\"joint_a,\"\"b\"\"_rad\"", "mm,\"joint_a,\"\"b\"\"_deg\""];
        let head = format!("visit,label,joint_joint_1_{si},joint_joint_1_{shown},seconds,dwell\n");
        assert_eq!(write(&tour), format!("{head}1,pose 7,0.25,-0.5,250.000000,-28.647890,0.0,1.5\n"));
        tour.home = Some(Home { q: vec![0.0, 0.0], back: Some(3.0) });
        let rows = "0,home,0.0,0.0,0.000000,0.000000,0.0,0.0\n1,pose 7,0.25,-0.5,250.000000,-28.647890,2.0,1.5\n\
                    0,home,0.0,0.0,0.000000,0.000000,3.0,0.0\n";
        assert_eq!(write(&tour), format!("{head}{rows}"));
    }

    #[test]
    fn degrees_keep_what_robots_resolve() {
        let (joints, stops) = (joints(), stops());
        let text = write(&program(&joints, &stops));
        assert!(text.contains(",5.729578,-28.647890,57.295780,0.000000,0.000006,171.887339,"));
    }
}
