//! Modules of ABB.
//!
//! Source: ABB's technical reference manuals of RAPID, 3HAC050946 (kernel) and 3HAC050917 (instructions): identifiers of up to 32
//! characters; `jointtarget` in degrees and mm, 9E9 for an axis that is not there; `MoveAbsJ` with `\T`, the move's time in s, in
//! place of the speed.

use super::axes::Axes;
use super::{announcement, beginning};
use crate::export::Export;
use crate::export::error::ExportError;
use crate::export::program::{Leg, Program};
use crate::export::text::{Names, comments, fixed, rounded_up};

const NAME: &str = "rapid";

pub(in crate::export) const RAPID: Export =
    Export { name: NAME, file_name: |program| format!("{}.mod", Identifiers::new(program).module), write };

/// Axes of the arm, and external ones.
const AXES: usize = 6;

const LONGEST_NAME: usize = 32;

/// Speed of the way to the start, which is not planned: 50 mm/s at the tool.
const APPROACH: &str = "v50";

/// Words of the language, and what the module uses of the controller.
const RESERVED: &str = "alias and backward bool case connect const default div do else elseif endfor endfunc endif endmodule endproc \
    endrecord endtest endtrap endwhile error exit false fine for from func goto if inout jointtarget local main \
    mod module moveabsj nostepin not noview num or pers proc raise readonly record retry return step string \
    sysmodule task test then to tool0 tpwrite trap true trynext undo v50 var viewonly waittime while with \
    withinpos wobj0 xor";

struct Identifiers {
    module: String,
    procedure: String,
    /// Of the end of each leg.
    targets: Vec<String>,
}

impl Identifiers {
    fn new(program: &Program) -> Self {
        let mut names = Names::new(LONGEST_NAME, RESERVED);
        let module = names.take(program.name, "tour");
        let procedure = names.take(&format!("run_{module}"), "run");
        let targets = program.legs().iter().map(|leg| names.take(leg.label, "pose")).collect();
        Self { module, procedure, targets }
    }
}

fn write(program: &Program) -> Result<String, ExportError> {
    let takes = "1 to 6 revolute joints, on up to 6 prismatic ones that come first as external axes";
    let axes = Axes::new(program, NAME, AXES, takes)?;
    let Identifiers { module, procedure, targets } = Identifiers::new(program);
    let mut text =
        format!("MODULE {module}\n{}", comments("  ! ", &beginning(program, &notes(program, &axes, &procedure))));
    let legs = program.legs();
    for (leg, name) in legs.iter().zip(&targets) {
        text += &format!("  LOCAL CONST jointtarget {name} := {};\n", target(&axes, leg.to));
    }
    text += &format!("\n  PROC {procedure}()\n");
    for (leg, name) in legs.iter().zip(&targets) {
        text += &stop(program, leg, name);
    }
    Ok(text + "  ENDPROC\nENDMODULE\n")
}

fn notes(program: &Program, axes: &Axes, procedure: &str) -> Vec<String> {
    let external = |i: usize| format!("eax_{}", ["a", "b", "c", "d", "e", "f"][i - 1]);
    vec![
        axes.note(program, |i| format!("rax_{i}"), external),
        format!(
            "Each move takes the planned time, in its argument T: the speeds are {} % of the joints' greatest or less.",
            super::percent(program)
        ),
        format!("Load the module and set the program pointer to {procedure}."),
    ]
}

/// `[[rax_1, …, rax_6], [eax_a, …, eax_f]]`.
fn target(axes: &Axes, q: &[f64]) -> String {
    let six = |values: &[f64]| {
        let number = |i| values.get(i).map_or("9E9".to_owned(), |&value| fixed(value, 6));
        (0..AXES).map(number).collect::<Vec<_>>().join(",")
    };
    format!("[[{}],[{}]]", six(&axes.degrees(q)), six(&axes.millimetres(q)))
}

fn stop(program: &Program, leg: &Leg, name: &str) -> String {
    let time = if leg.from.is_some() && leg.seconds > 0.0 {
        format!("\\T:={}", rounded_up(leg.seconds, 3))
    } else {
        String::new()
    };
    let mut text = format!("    TPWrite \"{}\";\n", announcement(program, leg));
    text += &format!("    MoveAbsJ {name}\\NoEOffs, {APPROACH}{time}, fine, tool0;\n");
    if leg.visit.is_some() && program.dwell > 0.0 {
        text += &format!("    WaitTime\\InPos, {};\n", rounded_up(program.dwell, 3));
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
        let (joints, stops) = (joints(), stops());
        let text = write(&program(&joints, &stops)).unwrap();
        let expected = "MODULE my_robot
  LOCAL CONST jointtarget pose_7 := [[5.729578,-28.647890,57.295780,0.000000,0.000006,171.887339],[9E9,9E9,9E9,9E9,9E9,9E9]];
  LOCAL CONST jointtarget pose_3 := [[22.918312,14.323945,57.295780,5.729578,-11.459156,103.132403],[9E9,9E9,9E9,9E9,9E9,9E9]];

  PROC run_my_robot()
    TPWrite \"pose 7 (1 of 2)\";
    MoveAbsJ pose_7\\NoEOffs, v50, fine, tool0;
    WaitTime\\InPos, 1.500;
    TPWrite \"pose 3 (2 of 2)\";
    MoveAbsJ pose_3\\NoEOffs, v50\\T:=2.500, fine, tool0;
    WaitTime\\InPos, 1.500;
  ENDPROC
ENDMODULE
";
        assert_eq!(below(&text, "!"), expected);
    }

    #[test]
    fn tracks_are_external_axes_and_names_are_unique() {
        let (mut joints, mut stops) = (joints(), stops());
        joints[0].kind = JointKind::Prismatic;
        stops[0].label = "v50".into();
        stops[1].label = "V50 2".into();
        let text = write(&program(&joints, &stops)).unwrap();
        assert!(text.contains(
            "jointtarget v50_2 := [[-28.647890,57.295780,0.000000,0.000006,171.887339,9E9],[100.000000,9E9,"
        ));
        assert!(text.contains("jointtarget V50_2_2 := "));
        assert!(text.contains("eax_a = joint_1, rax_1 = joint_2"));
        let mut seven = joints.clone();
        seven.insert(1, joints[1].clone());
        seven.push(joints[1].clone());
        assert!(write(&program(&seven, &stops)).unwrap_err().to_string().contains("7 revolute and 1 prismatic"));
    }
}
