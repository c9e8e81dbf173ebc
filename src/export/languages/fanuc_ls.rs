//! Programs of FANUC as text, which a controller with the ASCII upload option loads and `MakeTP` translates.
//!
//! Sources: the post-processor `Fanuc_R30iA.py` of `RoboDK` (ros-industrial-attic/robodk_postprocessors) for the file, and for J3
//! `fanuc_utils.cpp` of ros-industrial/fanuc. The pendant's J3 is the forearm's angle to the horizontal: it stays when J2 turns.
//! In a description of links, each of which hangs on the one before, J3 is the forearm's angle to the upper arm. Both are
//! positive upwards, while J2 is positive forwards and takes the forearm down; hence `J3 on the pendant = J3 − J2`.

use super::axes::Axes;
use super::{announcement, beginning, percent};
use crate::export::Export;
use crate::export::error::ExportError;
use crate::export::program::{Leg, Program};
use crate::export::text::{Names, fixed, rounded_up, wrapped};

const NAME: &str = "fanuc-ls";

pub(in crate::export) const FANUC_LS: Export =
    Export { name: NAME, file_name: |program| format!("{}.LS", identifier(program)), write };

/// Extended axes of a motion group.
const TRACKS: usize = 3;

/// Of a program's name, on controllers before the R-30iA.
const LONGEST_NAME: usize = 8;

const LONGEST_REMARK: usize = 32;

/// Longest wait, s.
const LONGEST_WAIT: f64 = 327.67;

/// Most percent of the way to the start, which is not planned.
const APPROACH: u32 = 5;

fn identifier(program: &Program) -> String {
    Names::new(LONGEST_NAME, "").take(program.name, "tour").to_ascii_uppercase()
}

fn write(program: &Program) -> Result<String, ExportError> {
    let takes = "1 to 6 revolute joints, on up to 3 prismatic ones that come first as extended axes";
    let axes = Axes::new(program, NAME, TRACKS, takes)?;
    if program.dwell > LONGEST_WAIT {
        return Err(ExportError::Dwell { format: NAME, dwell: program.dwell, most: LONGEST_WAIT });
    }
    let lines = lines(program, &axes);
    let mut text = format!(
        "/PROG  {}\n/ATTR\nOWNER\t\t= MNEDITOR;\nCOMMENT\t\t= \"calipose\";\nLINE_COUNT\t= {};\nPROTECT\t\t= READ_WRITE;\n\
         TCD:  STACK_SIZE\t= 0,\n      TASK_PRIORITY\t= 50,\n      TIME_SLICE\t= 0,\n      BUSY_LAMP_OFF\t= 0,\n      \
         ABORT_REQUEST\t= 0,\n      PAUSE_REQUEST\t= 0;\nDEFAULT_GROUP\t= 1,*,*,*,*;\nCONTROL_CODE\t= 00000000 00000000;\n/MN\n",
        identifier(program),
        lines.len()
    );
    for (i, line) in lines.iter().enumerate() {
        text += &format!("{:4}:{line} ;\n", i + 1);
    }
    text += "/POS\n";
    for (i, leg) in program.legs().iter().enumerate() {
        text += &position(i + 1, &axes, leg.to);
    }
    Ok(text + "/END\n")
}

/// The program's lines without their numbers.
fn lines(program: &Program, axes: &Axes) -> Vec<String> {
    let remark =
        |text: &str| wrapped(text, LONGEST_REMARK).into_iter().map(|line| format!("  !{line}")).collect::<Vec<_>>();
    let mut lines: Vec<String> =
        beginning(program, &notes(program, axes)).iter().flat_map(|sentence| remark(sentence)).collect();
    // The frames of the positions below, without which the controller refuses to go there.
    lines.extend(["  UFRAME_NUM=0", "  UTOOL_NUM=1"].map(str::to_owned));
    for (i, leg) in program.legs().iter().enumerate() {
        lines.extend(remark(&announcement(program, leg)));
        lines.extend(stop(program, i + 1, leg));
    }
    lines
}

fn notes(program: &Program, axes: &Axes) -> Vec<String> {
    vec![
        axes.note(program, |i| format!("J{i}"), |i| format!("E{i}")),
        "J3 is the pendant's, the plan's J3 minus its J2: the plan's is the angle between forearm and upper arm, positive \
         upwards. Test: at a stop, turn J2 alone. The forearm must keep its tilt."
            .to_owned(),
        format!(
            "Speeds are percent of the machine's own: {} % between the stops. Lower them if the plan's speeds are lower.",
            percent(program)
        ),
    ]
}

fn stop(program: &Program, number: usize, leg: &Leg) -> Vec<String> {
    let most = if leg.from.is_some() { 100 } else { APPROACH };
    let mut lines = vec![format!("J P[{number}] {}% FINE", percent(program).min(most))];
    if leg.visit.is_some() && program.dwell > 0.0 {
        lines.push(format!("  WAIT {:>6}(sec)", rounded_up(program.dwell, 2)));
    }
    lines
}

fn position(number: usize, axes: &Axes, q: &[f64]) -> String {
    let named = |letter: &str, values: Vec<f64>, unit: &str| {
        let value = |(i, value): (usize, f64)| format!("\t{letter}{}={:>10} {unit}", i + 1, fixed(value, 4));
        values.into_iter().enumerate().map(value).collect::<Vec<_>>()
    };
    let values = [named("J", pendant(axes.degrees(q)), "deg"), named("E", axes.millimetres(q), "mm")].concat();
    let rows = values.chunks(3).map(|row| row.join(",")).collect::<Vec<_>>().join(",\n");
    format!("P[{number}]{{\n   GP1:\n\tUF : 0, UT : 1,\n{rows}\n}};\n")
}

/// The angles of the arm as the pendant shows them, °.
fn pendant(mut degrees: Vec<f64>) -> Vec<f64> {
    if let [_, j2, j3, ..] = degrees.as_mut_slice() {
        *j3 -= *j2;
    }
    degrees
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{below, joints, program, stops};
    use crate::robot::JointKind;

    #[test]
    fn a_move_and_a_position_a_stop() {
        let (joints, stops) = (joints(), stops());
        let text = write(&program(&joints, &stops)).unwrap();
        let remarks = text.lines().filter(|line| line.contains(":  !")).count();
        let moves = "  UFRAME_NUM=0 ;
  UTOOL_NUM=1 ;
  !pose 7 (1 of 2) ;
J P[1] 5% FINE ;
  WAIT   1.50(sec) ;
  !pose 3 (2 of 2) ;
J P[2] 50% FINE ;
  WAIT   1.50(sec) ;
";
        let numbered = |(i, line)| format!("{:4}:{line}\n", remarks - 1 + i);
        let moves: String = moves.lines().enumerate().map(numbered).collect();
        let positions = "/POS
P[1]{
   GP1:
\tUF : 0, UT : 1,
\tJ1=    5.7296 deg,\tJ2=  -28.6479 deg,\tJ3=   85.9437 deg,
\tJ4=    0.0000 deg,\tJ5=    0.0000 deg,\tJ6=  171.8873 deg
};
P[2]{
   GP1:
\tUF : 0, UT : 1,
\tJ1=   22.9183 deg,\tJ2=   14.3239 deg,\tJ3=   42.9718 deg,
\tJ4=    5.7296 deg,\tJ5=  -11.4592 deg,\tJ6=  103.1324 deg
};
/END
";
        assert!(text.ends_with(&(moves + positions)), "{text}");
        assert!(text.starts_with("/PROG  MY_ROBOT\n/ATTR\n"));
        assert!(text.contains(&format!("LINE_COUNT\t= {};", remarks + 6)));
    }

    #[test]
    fn remarks_fit_and_tracks_are_extended_axes() {
        let (mut joints, stops) = (joints(), stops());
        joints[0].kind = JointKind::Prismatic;
        let text = write(&program(&joints, &stops)).unwrap();
        let remarks =
            text.lines().filter_map(|line| line.split_once('!')).map(|(_, remark)| remark.trim_end_matches(" ;"));
        assert!(remarks.clone().count() > 10 && remarks.into_iter().all(|remark| remark.len() <= LONGEST_REMARK));
        assert!(text.contains("J5=  171.8873 deg,\tE1=  100.0000 mm\n};"), "{text}");
        assert!(!below(&text, "/PROG").contains("J6="));
    }

    #[test]
    fn j3_keeps_the_forearms_tilt() {
        assert_eq!(pendant(vec![1.0, 20.0, 20.0, 4.0]), [1.0, 20.0, 0.0, 4.0]);
        assert_eq!(pendant(vec![1.0, 20.0]), [1.0, 20.0]);
    }

    #[test]
    fn long_waits_are_refused() {
        let (joints, stops) = (joints(), stops());
        let error = write(&Program { dwell: 400.0, ..program(&joints, &stops) }).unwrap_err();
        assert_eq!(error.to_string(), "the format \"fanuc-ls\" can wait 327.67 s at most, not the dwell of 400 s");
    }
}
