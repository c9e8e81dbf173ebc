//! Programs of KUKA.
//!
//! Source: KUKA's Quickguide KRL-Syntax, KSS 8.x: names of letters, digits and `_`, up to 24 characters of them, 16 on old
//! controllers; `PTP {A1 …}` in degrees and mm; `$VEL_AXIS` and `$ACC_AXIS` in percent of the machine's own.

use super::axes::Axes;
use super::{announcement, beginning, percent};
use crate::export::Export;
use crate::export::error::ExportError;
use crate::export::program::{Leg, Program};
use crate::export::text::{Names, comments, fixed, rounded_up};

const NAME: &str = "krl";

pub(in crate::export) const KRL: Export =
    Export { name: NAME, file_name: |program| format!("{}.src", identifier(program)), write };

const TRACKS: usize = 6;

const LONGEST_NAME: usize = 16;

/// Most percent of the way to the start, which is not planned.
const APPROACH: u32 = 5;

/// Words of the language that a program's name could be.
const RESERVED: &str = "and anin anout axis bas bool brake case cell channel char circ circ_rel confirm const continue decl def \
    default defdat deffct delay do e6axis e6pos else end enddat endfct endfor endif endloop endswitch endwhile \
    enum exit ext extfct false for frame global goto halt if import int interrupt is lin lin_rel loop not or pos \
    ptp ptp_rel pulse real repeat resume return signal struc switch trigger wait while";

fn identifier(program: &Program) -> String {
    Names::new(LONGEST_NAME, RESERVED).take(program.name, "tour")
}

fn write(program: &Program) -> Result<String, ExportError> {
    let takes = "1 to 6 revolute joints, on up to 6 prismatic ones that come first as external axes";
    let axes = Axes::new(program, NAME, TRACKS, takes)?;
    let mut text = format!("&ACCESS RVP\n&REL 1\nDEF {}()\n", identifier(program));
    text += &comments("; ", &beginning(program, &notes(program, &axes)));
    text += "\nBAS(#INITMOV, 0)\n";
    for (i, leg) in program.legs().iter().enumerate() {
        match i {
            0 => text += &speeds(program, &axes, percent(program).min(APPROACH)),
            1 => text += &speeds(program, &axes, percent(program)),
            _ => {}
        }
        text += &stop(program, &axes, leg);
    }
    Ok(text + "END\n")
}

fn notes(program: &Program, axes: &Axes) -> Vec<String> {
    vec![
        axes.note(program, |i| format!("A{i}"), |i| format!("E{i}")),
        format!(
            "Speeds and accelerations are percent of the machine's own: {} % between the stops, {} % on the way to the start. \
             Lower them if the plan's speeds are lower.",
            percent(program),
            percent(program).min(APPROACH)
        ),
        "The file must have the program's name.".to_owned(),
    ]
}

/// Speed and acceleration of every axis that moves, in percent.
fn speeds(program: &Program, axes: &Axes, percent: u32) -> String {
    let q = &program.stops[0].q;
    let of = |kind: &str, axes: usize| {
        let set = |i| format!("$VEL_{kind}[{i}] = {percent}\n$ACC_{kind}[{i}] = {percent}\n");
        (1..=axes).map(set).collect::<String>()
    };
    of("AXIS", axes.degrees(q).len()) + &of("EXTAX", axes.millimetres(q).len())
}

fn stop(program: &Program, axes: &Axes, leg: &Leg) -> String {
    let named = |letter: &str, values: Vec<f64>| {
        let value = |(i, value): (usize, f64)| format!("{letter}{} {}", i + 1, fixed(value, 6));
        values.into_iter().enumerate().map(value).collect::<Vec<_>>()
    };
    let values = [named("A", axes.degrees(leg.to)), named("E", axes.millimetres(leg.to))].concat().join(", ");
    let mut text = format!("; {}\nPTP {{{values}}}\n", announcement(program, leg));
    if leg.visit.is_some() && program.dwell > 0.0 {
        text += &format!("WAIT SEC {}\n", rounded_up(program.dwell, 3));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{below, joints, program, stops};
    use crate::robot::JointKind;

    #[test]
    fn a_move_a_stop() {
        let (mut joints, stops) = (joints(), stops());
        joints[0].kind = JointKind::Prismatic;
        joints.truncate(3);
        let stops: Vec<_> = stops.into_iter().map(|mut stop| (stop.q.truncate(3), stop).1).collect();
        let text = write(&program(&joints, &stops)).unwrap();
        let speeds = |percent: u32| {
            ["AXIS[1]", "AXIS[2]", "EXTAX[1]"]
                .map(|axis| format!("$VEL_{axis} = {percent}\n$ACC_{axis} = {percent}\n"))
                .concat()
        };
        let expected = format!(
            "&ACCESS RVP\n&REL 1\nDEF my_robot()\n\nBAS(#INITMOV, 0)\n{}PTP {{A1 -28.647890, A2 57.295780, E1 100.000000}}\n\
             WAIT SEC 1.500\n{}PTP {{A1 14.323945, A2 57.295780, E1 400.000000}}\nWAIT SEC 1.500\nEND\n",
            speeds(5),
            speeds(50)
        );
        assert_eq!(below(&text, ";"), expected);
        assert!(text.contains("; pose 3 (2 of 2)\n"));
        assert!(text.contains("E1 = joint_1, A1 = joint_2, A2 = joint_3"));
    }

    #[test]
    fn names_fit_old_controllers() {
        let (joints, stops) = (joints(), stops());
        let name = |name| identifier(&Program { name, ..program(&joints, &stops) });
        assert_eq!(["a name that is too long", "PTP", "$x"].map(name), ["a_name_that_is_t", "PTP_2", "x"]);
    }
}
