//! Tables with a column for each joint: `plan.csv`, what `calipose export --to csv` writes, and tables of one's own.
//!
//! A heading is a joint's name with its unit, `elbow_deg` or `joint_elbow_deg`; of a joint with two columns that in rad or m counts.
//! Columns of other things are passed over. A pose is called by the column `label`, `name` or `id`; where there is a column `visit`, rows
//! with 0 in it are passed.

use super::joint_names::complete;
use super::listed::{ListedPose, PoseList, StatedPlace};
use crate::formats::error::{ReadError, ReadFault};
use crate::robot::Joint;

/// Columns that poses are called by, the first that there is.
const NAMES: [&str; 3] = ["label", "name", "id"];

/// Units that joint values may have.
const UNITS: [&str; 4] = ["rad", "m", "deg", "mm"];

/// Whether the text begins as such a table does: a line with commas, or one heading with a unit, and no sign of YAML; `#` begins a comment.
pub(super) fn is_table(text: &str) -> bool {
    let first = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    let is_yaml = first.starts_with(['-', '{', '[', '%']) || first.contains(": ") || first.trim_end().ends_with(':');
    !is_yaml && (first.contains(',') || stated_unit(first.trim()).is_some())
}

/// The poses of a table, for a robot with these `joints`.
pub(super) fn read(text: &str, joints: &[Joint]) -> Result<PoseList, ReadError> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let headings: Vec<String> = reader.headers().map_err(|error| refused(&error))?.iter().map(str::to_owned).collect();
    let columns = columns(&headings, joints).map_err(|fault| fault.at(1))?;
    let called = NAMES.iter().find_map(|name| headings.iter().position(|heading| heading == name));
    let visit = headings.iter().position(|heading| heading == "visit");
    let mut list = PoseList { poses: vec![], passed: 0 };
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|error| refused(&error))?;
        let line = record.position().map_or(1, |position| position.line() as usize);
        if visit.is_some_and(|visit| &record[visit] == "0") {
            list.passed += 1;
            continue;
        }
        let value = |(&(column, unit), joint): (&(usize, &str), &Joint)| {
            let cell = &record[column];
            let value = cell.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
                let (key, found) = (headings[column].clone(), format!("\"{cell}\""));
                ReadFault::Type { key, found, expected: "a finite number" }.at(line)
            })?;
            Ok(if unit == joint.kind.unit() { value } else { joint.kind.in_si(value) })
        };
        let q = columns.iter().zip(joints).map(value).collect::<Result<_, ReadError>>()?;
        let name = called.map_or_else(|| (row + 1).to_string(), |called| record[called].to_owned());
        list.poses.push(ListedPose { name, place: StatedPlace::Joints(q) });
    }
    Ok(list)
}

/// Of each joint the column of its values, and their unit.
fn columns(headings: &[String], joints: &[Joint]) -> Result<Vec<(usize, &'static str)>, ReadFault> {
    let mut found: Vec<Option<(usize, &'static str)>> = vec![None; joints.len()];
    for (column, heading) in headings.iter().enumerate() {
        let joint_of = |name: &str| joints.iter().position(|joint| joint.name == name);
        let of_name = |name: &str| joint_of(name).or_else(|| name.strip_prefix("joint_").and_then(joint_of));
        // A name may end as a unit does.
        let (joint, stated) = match (of_name(heading), stated_unit(heading)) {
            (Some(joint), _) => (joint, None),
            (None, Some((name, unit))) => match of_name(name) {
                Some(joint) => (joint, Some(unit)),
                None if name.starts_with("joint_") => {
                    let joints = joints.iter().map(|joint| joint.name.clone()).collect();
                    return Err(ReadFault::UnknownJoint { name: name["joint_".len()..].to_owned(), joints });
                }
                None => continue,
            },
            (None, None) => continue,
        };
        let Joint { name, kind, .. } = &joints[joint];
        let units = [kind.unit(), kind.display_unit()];
        let Some(unit) = units.into_iter().find(|unit| stated == Some(unit)) else {
            let names = units.map(|unit| format!("{name}_{unit}"));
            return Err(ReadFault::JointUnit { heading: heading.clone(), is_stated: stated.is_some(), names });
        };
        match found[joint] {
            Some((_, other)) if other == unit => return Err(ReadFault::Repeated { name: heading.clone() }),
            Some((_, other)) if other == kind.unit() => {}
            _ => found[joint] = Some((column, unit)),
        }
    }
    complete(found, joints, "a heading is a joint's name with its unit, as in elbow_rad or elbow_deg")
}

/// A heading's name and unit.
fn stated_unit(heading: &str) -> Option<(&str, &'static str)> {
    let (name, unit) = heading.rsplit_once('_')?;
    UNITS.into_iter().find(|known| *known == unit).map(|unit| (name, unit))
}

fn refused(error: &csv::Error) -> ReadError {
    let line = error.position().map_or(1, |position| position.line() as usize);
    let fault = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            ReadFault::Columns { found: *len as usize, expected: *expected_len as usize }
        }
        _ => ReadFault::Syntax { message: error.to_string() },
    };
    fault.at(line)
}

#[cfg(test)]
mod tests {
    use crate::formats::pose_list::listed::{joints, values};
    use crate::formats::pose_list::{PoseListFormat, read_poses};

    fn read(text: &str) -> Result<super::PoseList, super::ReadError> {
        read_poses(text, PoseListFormat::Csv, &joints())
    }

    #[test]
    fn columns_are_matched_by_name_and_unit() {
        // As pandas and plan.csv write them.
        let list = read(",joint_3_rad,waist_deg,slide_mm,tilt_deg\n0,0.5,90,20,7\n1,-0.5,-90,-20.5,7\n").unwrap();
        let quarter = std::f64::consts::FRAC_PI_2;
        let [first, second] = &values(&list)[..] else { panic!("{list:?}") };
        assert!((first[0] - quarter).abs() < 1e-15 && first[1..] == [0.02, 0.5], "{first:?}");
        assert!((second[0] + quarter).abs() < 1e-15 && second[2] == -0.5, "{second:?}");
        let plan = "id,joint_waist_rad,joint_slide_m,joint_joint_3_rad,joint_waist_deg,joint_slide_mm,joint_joint_3_deg\n\
                    77,0.25,0.1,0.125,1,1,1\n";
        let list = read(plan).unwrap();
        assert_eq!((values(&list), list.poses[0].name.as_str()), (vec![vec![0.25, 0.1, 0.125]], "77"));
        let export = "visit,label,waist_rad,slide_m,joint_3_rad\n0,home,0,0,0\n1,\"pose, 9\",1,2,3\n";
        let list = read(export).unwrap();
        assert_eq!((values(&list), list.poses[0].name.as_str()), (vec![vec![1.0, 2.0, 3.0]], "pose, 9"));
        assert_eq!(list.passed, 1);
        let by_hand = "# taught\nwaist_rad,slide_m,joint_3_rad\n1,2,3\n# the rest is missing\n";
        assert_eq!(PoseListFormat::of(by_hand), Ok(PoseListFormat::Csv));
        assert_eq!(values(&read(by_hand).unwrap()), vec![vec![1.0, 2.0, 3.0]]);
    }

    #[test]
    fn what_does_not_fit_is_told_with_its_line() {
        let wrong = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(
            wrong("waist,slide_m,joint_3_rad\n1,2,3\n"),
            "line 1: the column \"waist\" does not state its unit; call it waist_rad or waist_deg"
        );
        assert_eq!(
            wrong("waist_rad,slide_deg,joint_3_rad\n1,2,3\n"),
            "line 1: the column \"slide_deg\" has a unit that is not the joint's; call it slide_m or slide_mm"
        );
        assert_eq!(
            wrong("waist_rad,slide_m\n1,2\n"),
            "line 1: joint joint_3 of the robot has no value; a heading is a joint's name with its unit, as in elbow_rad or elbow_deg"
        );
        assert_eq!(
            wrong("joint_wrist_rad,waist_rad,slide_m,joint_3_rad\n1,2,3,4\n"),
            "line 1: there is no joint \"wrist\"; the robot's joints are waist, slide, joint_3"
        );
        let head = "waist_rad,slide_m,joint_3_rad\n";
        assert_eq!(wrong(&format!("{head}1,2\n")), "line 2: 2 columns, but the header has 3");
        assert_eq!(
            wrong(&format!("{head}1,2,3\n1,inf,3\n")),
            "line 3: `slide_m` is \"inf\"; it must be a finite number"
        );
        assert_eq!(wrong(&format!("{head}1,,3\n")), "line 2: `slide_m` is \"\"; it must be a finite number");
        assert_eq!(wrong("waist_rad,waist_rad,slide_m,joint_3_rad\n"), "line 1: `waist_rad` occurs a second time");
        assert_eq!(wrong(head), "line 1: there are no poses in the file");
    }
}
