//! Programs of Universal Robots.
//!
//! Source: Universal Robots' script manual, module motion: `movej(q, a, v)` with `a` and `v` those of the leading axis, the one
//! with the longest way; the others keep step with it.

use super::axes::refused;
use super::{announcement, beginning};
use crate::export::Export;
use crate::export::error::ExportError;
use crate::export::program::{Leg, Program};
use crate::export::text::{Names, comments, decimal, rounded_down};

const NAME: &str = "urscript";

pub(in crate::export) const URSCRIPT: Export =
    Export { name: NAME, file_name: |program| format!("{}.script", identifier(program)), write };

/// Greatest speed of the way to the start, which is not planned, rad/s.
const APPROACH: f64 = 0.1;

/// Words of the language, and functions that the program calls.
const RESERVED: &str = "and break continue def elif else end enum false for global halt if local movej not or pass return run sec \
    sleep struct textmsg thread true while xor";

fn identifier(program: &Program) -> String {
    Names::new(40, RESERVED).take(program.name, "tour")
}

fn write(program: &Program) -> Result<String, ExportError> {
    if program.joints.len() != 6 || !program.turns_only() {
        return Err(refused(program, NAME, "exactly 6 revolute joints"));
    }
    // Comments inside: what is sent to the controller must begin with def.
    let mut text =
        format!("def {}():\n{}", identifier(program), comments("  # ", &beginning(program, &notes(program))));
    for leg in program.legs() {
        let (speed, acceleration) = leading_axis(program, &leg);
        let q = leg.to.iter().map(|&value| decimal(value)).collect::<Vec<_>>().join(", ");
        text += &format!("  textmsg(\"{}\")\n", announcement(program, &leg));
        text += &format!("  movej([{q}], a={}, v={})\n", rounded_down(acceleration, 6), rounded_down(speed, 6));
        if leg.visit.is_some() && program.dwell > 0.0 {
            text += &format!("  sleep({})\n", decimal(program.dwell));
        }
    }
    Ok(text + "end\n")
}

fn notes(program: &Program) -> Vec<String> {
    let joints = program.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>().join(", ");
    vec![
        format!(
            "Joint values in rad, of base, shoulder, elbow, wrist 1, wrist 2, wrist 3, in the plan called {joints}."
        ),
        "a in rad/s^2 and v in rad/s are those of the joint with the longest way. No joint is faster than planned."
            .to_owned(),
        "Send the file to port 30002, or insert it as a script and call the function.".to_owned(),
    ]
}

/// Speed and acceleration of the joint with the longest way, such that no joint is faster than it may be.
fn leading_axis(program: &Program, leg: &Leg) -> (f64, f64) {
    let from = leg.from.unwrap_or(leg.to);
    let ways: Vec<f64> = from.iter().zip(leg.to).map(|(from, to)| (to - from).abs()).collect();
    let longest = ways.iter().copied().fold(0.0, f64::max);
    // Of a way that is not known, or of none, any joint may be the leading one.
    let share = |way: f64| if longest > 0.0 { way / longest } else { 1.0 };
    let most = if leg.from.is_some() { f64::INFINITY } else { APPROACH };
    program.joints.iter().zip(ways).fold((most, f64::INFINITY), |(speed, acceleration), (joint, way)| {
        (speed.min(program.share * joint.speed / share(way)), acceleration.min(joint.acceleration / share(way)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::example::{below, joints, program, stops};

    #[test]
    fn a_move_a_stop() {
        let (mut joints, stops) = (joints(), stops());
        joints[0].speed = 0.5;
        let text = write(&program(&joints, &stops)).unwrap();
        // From pose 7 joint 6 leads with 1.2 rad; joint 1 with 0.3 rad and a speed of 0.25 rad/s lets it have 1 rad/s.
        let expected = "def my_robot():
  textmsg(\"pose 7 (1 of 2)\")
  movej([0.1, -0.5, 1.0, 0.0, 0.0000001, 3.0], a=4.000000, v=0.100000)
  sleep(1.5)
  textmsg(\"pose 3 (2 of 2)\")
  movej([0.4, 0.25, 1.0, 0.1, -0.2, 1.8], a=4.000000, v=1.000000)
  sleep(1.5)
end
";
        assert_eq!(below(&text, "#"), expected);
    }

    #[test]
    fn only_six_joints_that_turn() {
        let (mut joints, stops) = (joints(), stops());
        let message = |joints: &[_]| write(&program(joints, &stops)).unwrap_err().to_string();
        assert_eq!(
            message(&joints[..4]),
            "the format \"urscript\" takes exactly 6 revolute joints; this robot has 4 revolute and 0 prismatic: export it as \
             \"joint-trajectory\" if it runs on ROS, or as \"csv\" for a program of your own"
        );
        joints[0].kind = crate::robot::JointKind::Prismatic;
        assert!(message(&joints).contains("5 revolute and 1 prismatic"));
    }

    #[test]
    fn programs_are_not_named_as_words_of_the_language() {
        let (joints, stops) = (joints(), stops());
        let name = |name| identifier(&Program { name, ..program(&joints, &stops) });
        assert_eq!(["while", "7", "日本"].map(name), ["while_2", "tour_7", "tour"]);
    }
}
