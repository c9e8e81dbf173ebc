//! `calipose reach`.

use clap::{ArgGroup, Args};
use nalgebra::{Quaternion, UnitQuaternion};

use crate::cli::arguments::ProblemArguments;
use crate::cli::number_of;
use crate::cli::output::collision::untested_text;
use crate::cli::output::failure::Failure;
use crate::cli::output::joint_table::{Heading, joint_table};
use crate::cli::output::{Screen, fixed, short, wrapped};
use crate::feasibility::LinkPair;
use crate::plan::assess::reach_starts;
use crate::plan::document::{ReachDocument, joints_deg};
use crate::problem::Problem;
use crate::robot::{ReachSettings, Reached, reach};
use crate::spatial::Pose;
use crate::target::viewpoint;

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("request").required(true).args(["position", "distance"]))]
pub(crate) struct ReachArguments {
    #[command(flatten)]
    problem: ProblemArguments,
    /// Position of the camera in the base frame, in mm; needs an orientation
    #[arg(long = "position-mm", value_name = "X,Y,Z", value_parser = numbers::<3>, allow_hyphen_values = true)]
    position: Option<[f64; 3]>,
    /// Orientation of the camera in the base frame: roll, pitch and yaw in degrees, Rz(yaw) Ry(pitch) Rx(roll)
    #[arg(
        long = "rpy-deg",
        value_name = "R,P,Y",
        value_parser = numbers::<3>,
        requires = "position",
        conflicts_with_all = ["quaternion", "distance"],
        allow_hyphen_values = true
    )]
    rpy: Option<[f64; 3]>,
    /// Orientation of the camera in the base frame as a unit quaternion
    #[arg(
        long = "quaternion-xyzw",
        value_name = "X,Y,Z,W",
        value_parser = numbers::<4>,
        requires = "position",
        conflicts_with = "distance",
        allow_hyphen_values = true
    )]
    quaternion: Option<[f64; 4]>,
    /// Distance from the board's centre, in mm; the camera looks at the centre
    #[arg(long = "distance-mm", value_name = "MM")]
    distance: Option<f64>,
    /// With --distance-mm: angle off the board's normal, in degrees
    #[arg(long = "tilt-deg", value_name = "DEG", conflicts_with = "position", default_value_t = 0.0)]
    tilt: f64,
    /// With --distance-mm: direction of the tilt, in degrees from the board's x towards its y
    #[arg(
        long = "azimuth-deg",
        value_name = "DEG",
        requires = "distance",
        default_value_t = 0.0,
        allow_hyphen_values = true
    )]
    azimuth: f64,
    /// With --distance-mm: rotation of the camera about its optical axis, in degrees
    #[arg(
        long = "roll-deg",
        value_name = "DEG",
        requires = "distance",
        default_value_t = 0.0,
        allow_hyphen_values = true
    )]
    roll: f64,
    /// Maximum number of configurations to show
    #[arg(long, short = 'n', default_value_t = 5, value_parser = number_of(false))]
    count: usize,
}

/// `N` finite numbers, separated by commas.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|word| word.trim().parse().ok().filter(|number: &f64| number.is_finite())).collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("must be {N} numbers separated by commas"))
}

impl ReachArguments {
    /// The requested pose `X_BC`.
    fn requested(&self, problem: &Problem) -> Result<Pose, Failure> {
        let refused = |what: &str| Err(Failure::Usage(what.into()));
        if let Some(distance) = self.distance {
            if !(distance > 0.0 && distance.is_finite()) {
                return refused("--distance-mm must be positive");
            }
            if !(0.0..90.0).contains(&self.tilt) {
                return refused("--tilt-deg must be at least 0 and less than 90");
            }
            if !(self.azimuth.is_finite() && self.roll.is_finite()) {
                return refused("--azimuth-deg and --roll-deg must be finite");
            }
            let X_TC =
                viewpoint(distance / 1e3, self.tilt.to_radians(), self.azimuth.to_radians(), self.roll.to_radians());
            return Ok(problem.target.X_BT * X_TC);
        }
        let rotation = match (self.rpy, self.quaternion) {
            (Some(rpy), _) => {
                let [roll, pitch, yaw] = rpy.map(f64::to_radians);
                UnitQuaternion::from_euler_angles(roll, pitch, yaw)
            }
            (None, Some([x, y, z, w])) => {
                let quaternion = Quaternion::new(w, x, y, z);
                if (quaternion.norm() - 1.0).abs() > 1e-3 {
                    return refused("--quaternion-xyzw must have norm 1");
                }
                UnitQuaternion::new_normalize(quaternion)
            }
            (None, None) => return refused("--position-mm needs an orientation: --rpy-deg or --quaternion-xyzw"),
        };
        let position = self.position.unwrap_or_default().map(|mm| mm / 1e3);
        Ok(Pose::from_parts(position.into(), rotation))
    }
}

pub(crate) fn run(arguments: &ReachArguments, screen: &mut Screen) -> Result<(), Failure> {
    let problem = arguments.problem.problem(&[])?;
    let requested = arguments.requested(&problem)?;
    // An error of angle moves what the camera sees by the angle times its distance.
    let to_board = (problem.target.X_BT.translation.vector - requested.translation.vector).norm();
    let settings = ReachSettings { length: to_board.clamp(0.1, 10.0), ..ReachSettings::default() };
    let mut found = reach(&problem.robot, &requested, &reach_starts(&problem), &settings);
    found.truncate(arguments.count);
    let reached = found.iter().any(|configuration| configuration.reached);
    let in_the_way: Vec<Option<LinkPair>> = {
        let checks = problem.checks();
        found.iter().map(|found| checks.collision().first(&problem.robot.tree.link_poses(&found.q))).collect()
    };
    screen.document(&ReachDocument::new(&problem, &requested, &found, &in_the_way))?;
    let verdict = match (reached, found.len()) {
        (true, 1) => "one configuration takes the pose".to_owned(),
        (true, n) => format!("{n} configurations take the pose; those farthest from joint limits first"),
        (false, _) => "no configuration found takes the pose; the nearest".to_owned(),
    };
    let verdict = wrapped(&format!("{}: {verdict}:", problem.name));
    screen.text(&format!("{verdict}\n\n{}", configurations(&problem, &found, &in_the_way)))?;
    match &found[..] {
        [nearest, ..] if !reached => Err(Failure::Unreached {
            position_error: nearest.position_error,
            angle_error: nearest.angle_error,
            joints: problem.robot.chain.dof(),
        }),
        _ => Ok(()),
    }
}

fn configurations(problem: &Problem, found: &[Reached], in_the_way: &[Option<LinkPair>]) -> String {
    let row = |(number, configuration): (usize, &Reached)| {
        let values = joints_deg(&problem.robot.chain, &configuration.q).into_iter().map(|q| fixed(q, 2));
        let off = |error: f64| if error < 5e-7 { "0".to_owned() } else { short(error) };
        let errors = [
            format!("{:.0}", configuration.limit_margin * 100.0),
            off(configuration.position_error * 1e3),
            off(configuration.angle_error.to_degrees()),
        ];
        std::iter::once(number.to_string()).chain(values).chain(errors).collect()
    };
    let rows: Vec<Vec<String>> = (1..).zip(found).map(row).collect();
    let after = [
        Heading { full: "to a limit [%]", brief: "limit" },
        Heading { full: "off [mm]", brief: "mm off" },
        Heading { full: "off [deg]", brief: "deg off" },
    ];
    let legend = "Limit: distance from the nearest joint limit in % of its range.";
    let table = joint_table(&problem.robot.chain.joints, &[Heading { full: "", brief: "" }], &after, legend, &rows);
    let collisions = untested_text(problem).unwrap_or_else(|| collisions(problem, in_the_way));
    format!("{table}\n\n{}", wrapped(&collisions))
}

/// Which of the configurations collide, and with what.
fn collisions(problem: &Problem, in_the_way: &[Option<LinkPair>]) -> String {
    let name = |link: usize| problem.robot.tree.links[link].name.as_str();
    let found = (1..)
        .zip(in_the_way)
        .filter_map(|(number, pair): (usize, _)| pair.map(|[a, b]| format!("{number} ({}–{})", name(a), name(b))));
    let found: Vec<String> = found.collect();
    if found.is_empty() { "Collision: none.".into() } else { format!("In collision: {}.", found.join(", ")) }
}
