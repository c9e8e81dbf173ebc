//! A problem stated by a program.

use std::path::Path;

use super::schema::{self, Named, NumberOrList, Numbers, RangeOrSets, TargetKind, TextOrTable};
use super::{Method, OverrideError, Overrides, Problem, ProblemError};
use crate::camera::Camera;
use crate::information::Criterion;
use crate::robot::JointKind;
use crate::robot::dh::{Convention, Row};
use crate::spatial::Pose;
use crate::target::{Board, Checkerboard};

/// States a problem without a file: the same defaults, the same checks, the same messages. Values are in metres, radians and
/// pixels, as everywhere in the library; messages name the keys of the file and have its units.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use calipose::camera::{Camera, Lens};
/// use calipose::information::Criterion;
/// use calipose::plan::choose::{Chooser, decide};
/// use calipose::plan::survey::survey;
/// use calipose::problem::Problem;
/// use calipose::spatial::Pose;
/// use calipose::target::Board;
///
/// let problem = Problem::builder("table")
///     .urdf("problems/urdf/six-axis-rover.urdf", "camera_optical_frame")
///     .camera(&Camera::new(Lens::Pinhole, 1280, 720, &[900.0, 900.0, 640.0, 360.0])?)
///     .board(Board::checkerboard(9, 6, 0.025), Pose::translation(0.5, 0.0, 0.0))
///     .sample(20_000)
///     .best(8, &[(Criterion::V, 1.0)])
///     .build()?;
/// let survey = survey(&problem, &|_| {})?;
/// let decision = decide(&Chooser::new(&problem, &survey)?, &mut |_| ControlFlow::Continue(()))?;
/// assert!(decision.certificate.efficiency(decision.choice.log_value) > 0.9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ProblemBuilder {
    file: schema::File,
    overrides: Overrides,
}

impl Problem {
    /// States a problem of that name without a file.
    pub fn builder(name: &str) -> ProblemBuilder {
        let file = schema::File { name: Some(name.to_owned()), ..schema::File::default() };
        ProblemBuilder { file, overrides: Overrides::new() }
    }
}

impl ProblemBuilder {
    /// The arm's next joint, base first, as a row of its Denavit–Hartenberg table.
    #[must_use]
    pub fn joint(mut self, row: Row) -> Self {
        let Row { name, kind, a, alpha, d, theta, limits, max_speed } = row;
        let range = |unit: fn(f64) -> f64| Some(RangeOrSets::Range(Numbers([unit(limits.min), unit(limits.max)])));
        let is = |this: JointKind| kind == this;
        self.file.robot.joints.push(schema::Joint {
            name,
            kind: Named(kind),
            a_mm: mm(a),
            alpha_deg: alpha.to_degrees(),
            d_mm: mm(d),
            theta_deg: theta.to_degrees(),
            limits_deg: is(JointKind::Revolute).then(|| range(f64::to_degrees)).flatten(),
            limits_mm: is(JointKind::Prismatic).then(|| range(mm)).flatten(),
            max_speed_deg_s: max_speed.filter(|_| is(JointKind::Revolute)).map(f64::to_degrees),
            max_speed_mm_s: max_speed.filter(|_| is(JointKind::Prismatic)).map(mm),
        });
        self
    }

    /// The order of a row's factors; [`Convention::Standard`] when left out.
    #[must_use]
    pub fn convention(mut self, convention: Convention) -> Self {
        self.file.robot.convention = Some(Named(convention));
        self
    }

    /// The arm from a URDF file, the camera on one of its links.
    #[must_use]
    pub fn urdf(mut self, file: &str, camera_link: &str) -> Self {
        self.file.robot.urdf = Some(file.to_owned());
        self.file.robot.camera_link = Some(camera_link.to_owned());
        self
    }

    /// The nominal camera.
    #[must_use]
    pub fn camera(mut self, camera: &Camera) -> Self {
        let θ = camera.intrinsics();
        let (width, height) = (camera.width(), camera.height());
        let mut distortion = schema::Distortion { model: Named(camera.lens()), ..schema::Distortion::default() };
        for (name, &value) in camera.lens().parameter_names().iter().zip(θ).skip(4) {
            if let Some(coefficient) = distortion.coefficient(name) {
                *coefficient = Some(value);
            }
        }
        let keys = &mut self.file.camera;
        (keys.width_px, keys.height_px) = (Some(width), Some(height));
        (keys.fx_px, keys.fy_px, keys.cx_px, keys.cy_px) = (Some(θ[0]), Some(θ[1]), Some(θ[2]), Some(θ[3]));
        keys.distortion = Some(distortion);
        self
    }

    /// Pose of the camera (x right, y down, z forward) on the flange, or on its link; the same frame when left out.
    #[must_use]
    pub fn mount(mut self, X_FC: &Pose) -> Self {
        self.file.camera.mount = TextOrTable::Table(pose(X_FC));
        self
    }

    /// The board and its pose in the robot's base frame.
    #[must_use]
    pub fn board(mut self, board: Board, X_BT: Pose) -> Self {
        let target = &mut self.file.target;
        match board {
            Board::Checkerboard(Checkerboard { columns, rows, square }) => {
                (target.columns, target.rows) = (Some(saturating(columns)), Some(saturating(rows)));
                target.square_mm = Some(mm(square));
            }
            Board::Charuco(board) => {
                target.kind = Some(Named(TargetKind::Charuco));
                (target.columns, target.rows) = (Some(saturating(board.columns())), Some(saturating(board.rows())));
                (target.square_mm, target.marker_mm) = (Some(mm(board.square())), Some(mm(board.marker())));
                target.dictionary = Some(board.dictionary().name().to_owned());
                target.legacy_pattern = Some(board.is_legacy());
            }
            Board::AprilGrid(board) => {
                target.kind = Some(Named(TargetKind::AprilGrid));
                (target.columns, target.rows) = (Some(saturating(board.columns())), Some(saturating(board.rows())));
                (target.tag_mm, target.tag_spacing) = (Some(mm(board.tag())), Some(board.spacing()));
            }
            Board::Circles(board) => {
                let kind = if board.is_asymmetric() { TargetKind::AsymmetricCircles } else { TargetKind::Circles };
                target.kind = Some(Named(kind));
                (target.columns, target.rows) = (Some(saturating(board.columns())), Some(saturating(board.rows())));
                (target.spacing_mm, target.diameter_mm) = (Some(mm(board.spacing())), Some(mm(board.diameter())));
            }
            Board::Points(board) => {
                target.kind = Some(Named(TargetKind::Points));
                let listed = |([x, y], group): ([f64; 2], Option<i64>)| {
                    [mm(x), mm(y)].into_iter().chain(group.map(|group| group as f64)).collect()
                };
                target.points_mm = board.listed().map(listed).collect();
            }
        }
        target.pose = pose(&X_BT);
        self
    }

    /// Puts the board on a link of the URDF, in whose frame its pose is then.
    #[must_use]
    pub fn board_link(mut self, link: &str) -> Self {
        self.file.target.link = Some(link.to_owned());
        self
    }

    /// Sweeps a grid with these steps, one a joint, base first (rad or m).
    #[must_use]
    pub fn grid(mut self, revolute_steps: &[f64], prismatic_steps: &[f64]) -> Self {
        let list = |steps: &[f64], unit: fn(f64) -> f64| {
            (!steps.is_empty()).then(|| NumberOrList::List(steps.iter().map(|&step| unit(step)).collect()))
        };
        self.file.sweep.step_deg = list(revolute_steps, f64::to_degrees);
        self.file.sweep.step_mm = list(prismatic_steps, mm);
        self
    }

    /// Sweeps a low-discrepancy sample of so many configurations.
    #[must_use]
    pub fn sample(mut self, configurations: usize) -> Self {
        self.file.sweep.sample = Some(whole(configurations));
        self
    }

    /// Standard deviation of a detected corner in each direction, in px.
    #[must_use]
    pub fn noise(mut self, sigma: f64) -> Self {
        self.file.noise.sigma_px = sigma;
        self
    }

    /// The intrinsics to estimate, by their names; all when left out.
    #[must_use]
    pub fn estimate(mut self, intrinsics: &[&str]) -> Self {
        self.file.estimate.intrinsics = Some(intrinsics.iter().map(|&name| name.to_owned()).collect());
        self
    }

    /// Asks for the best `count` poses by the weighted geometric mean of these criteria; for ten by `v` when left out.
    #[must_use]
    pub fn best(mut self, count: usize, criteria: &[(Criterion, f64)]) -> Self {
        let shares = criteria.iter().map(|&(criterion, share)| (criterion.name().to_owned(), share)).collect();
        let selection = &mut self.file.selection;
        (selection.count, selection.criterion) = (Some(whole(count)), Some(TextOrTable::Table(shares)));
        (selection.accuracy, selection.time) = (None, None);
        self
    }

    /// Asks for the best poses, as many as serve, whose tour takes at most so many seconds.
    #[must_use]
    pub fn within(mut self, seconds: f64) -> Self {
        let selection = &mut self.file.selection;
        (selection.count, selection.method, selection.accuracy) = (None, None, None);
        selection.time = Some(schema::TimeLimit { most_s: seconds });
        self
    }

    /// How to choose the best poses; [`Method::Best`] when left out.
    #[must_use]
    pub fn method(mut self, method: Method) -> Self {
        self.file.selection.method = Some(Named(method));
        self
    }

    /// Asks for the fewest poses that reach these accuracies, as standard deviations: of [`Accuracy::MAP_ERROR`] and of estimated
    /// intrinsics by their names.
    ///
    /// [`Accuracy::MAP_ERROR`]: super::Accuracy::MAP_ERROR
    #[must_use]
    pub fn fewest(mut self, accuracies: &[(&str, f64)]) -> Self {
        let selection = &mut self.file.selection;
        (selection.criterion, selection.count, selection.method, selection.time) = (None, None, None, None);
        selection.accuracy = Some(accuracies.iter().map(|&(name, sigma)| (name.to_owned(), sigma)).collect());
        self
    }

    /// Any key of the problem file, `KEY=VALUE` in its units; see [`Overrides::set`].
    ///
    /// # Errors
    /// When the text is of another form.
    pub fn set(mut self, text: &str) -> Result<Self, OverrideError> {
        self.overrides = self.overrides.set(text)?;
        Ok(self)
    }

    /// The problem file that states the same, but for what [`ProblemBuilder::set`] gives.
    pub fn to_toml(&self) -> String {
        // What cannot be written, as a key that is no text, is not in the schema.
        toml::to_string(&self.file).unwrap_or_default()
    }

    /// The problem. Files are sought from the working directory.
    ///
    /// # Errors
    /// When something is missing or impossible: every fault by its key.
    pub fn build(&self) -> Result<Problem, ProblemError> {
        let name = self.file.name.as_deref().unwrap_or_default();
        Problem::parse_with(&self.to_toml(), Path::new(name), &self.overrides)
    }
}

fn mm(metres: f64) -> f64 {
    metres * 1e3
}

/// The greatest whole number of TOML is that of `i64`.
fn whole(count: usize) -> u64 {
    i64::try_from(count).unwrap_or(i64::MAX).unsigned_abs()
}

fn saturating(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

fn pose(X: &Pose) -> schema::Pose {
    let [x, y, z, w] = X.rotation.coords.into();
    schema::Pose {
        position_mm: Numbers((X.translation.vector * 1e3).into()),
        rpy_deg: None,
        quaternion_xyzw: Some(Numbers([x, y, z, w])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Lens;
    use crate::problem::{Accuracy, Goal};
    use crate::robot::Limits;

    fn row(name: &str, a: f64) -> Row {
        let limits = Limits { min: -1.0, max: 1.5 };
        let (alpha, d, theta) = (0.3, 0.2, -0.1);
        Row { name: name.into(), kind: JointKind::Revolute, a, alpha, d, theta, limits, max_speed: Some(2.0) }
    }

    fn builder() -> ProblemBuilder {
        let camera =
            Camera::new(Lens::BrownConrady, 640, 480, &[500.0, 501.0, 320.0, 240.0, -0.1, 0.0, 0.0, 1e-3, 0.0]);
        Problem::builder("two joints")
            .joint(row("turn", 0.3))
            .joint(Row { kind: JointKind::Prismatic, ..row("slide", 0.0) })
            .camera(&camera.unwrap())
            .mount(&Pose::translation(0.01, 0.0, 0.02))
            .board(Board::checkerboard(8, 6, 0.02), Pose::translation(0.3, 0.0, -0.5))
            .grid(&[0.1], &[0.05])
            .noise(0.25)
    }

    #[test]
    fn what_is_stated_is_in_the_problem() {
        let problem = builder().build().unwrap();
        let joints = &problem.robot.chain.joints;
        assert_eq!((joints.len(), joints[0].name.as_str(), joints[1].kind), (2, "turn", JointKind::Prismatic));
        assert!((joints[0].limits.max - 1.5).abs() < 1e-12 && (joints[1].limits.min + 1.0).abs() < 1e-12);
        assert_eq!(problem.camera.intrinsics(), [500.0, 501.0, 320.0, 240.0, -0.1, 0.0, 0.0, 1e-3, 0.0]);
        assert!((problem.robot.X_FC.translation.vector.z - 0.02).abs() < 1e-12);
        assert!((problem.target.X_BT.translation.vector.z + 0.5).abs() < 1e-12);
        assert_eq!((problem.noise.sigma, problem.selection.goal.count()), (0.25, Some(10)));
        // The file that it writes states the same.
        let text = builder().to_toml();
        assert_eq!(Problem::parse(&text, Path::new("two joints")).unwrap(), problem);
        let fewest = builder().estimate(&["cx", "fx"]).fewest(&[("fx", 2.0)]).build().unwrap();
        assert_eq!(fewest.selection.goal.accuracies(), [(Accuracy::Intrinsic(0), 2.0)]);
        let within = builder().within(90.0).build().unwrap();
        assert_eq!(within.selection.goal, Goal::Within { criteria: vec![(Criterion::V, 1.0)], seconds: 90.0 });
        let exact = builder().best(12, &[(Criterion::D, 1.0)]).method(Method::Exact).build().unwrap();
        let criteria = vec![(Criterion::D, 1.0)];
        assert_eq!(exact.selection.goal, Goal::Best { criteria, count: 12, method: Method::Exact });
    }

    #[test]
    fn wrong_values_are_refused_by_their_keys() {
        let faults = |builder: ProblemBuilder| {
            let refused = builder.build().unwrap_err();
            refused.faults().iter().map(|fault| fault.key.clone()).collect::<Vec<_>>()
        };
        assert_eq!(faults(builder().grid(&[0.1, 0.1], &[0.05])), ["sweep.step_deg"]);
        assert_eq!(faults(builder().noise(0.0)), ["noise.sigma_px"]);
        assert_eq!(faults(builder().grid(&[], &[]).sample(usize::MAX)), ["sweep.sample"]);
        assert_eq!(faults(builder().best(usize::MAX, &[(Criterion::V, 1.0)])), ["selection.count"]);
        assert_eq!(faults(builder().noise(f64::NAN)), ["noise.sigma_px"]);
        assert_eq!(faults(builder().estimate(&["fx", "fx"])), ["estimate.intrinsics[1]"]);
        assert_eq!(faults(builder().joint(row("turn", 0.0)).grid(&[0.1, 0.1], &[0.05])), ["robot.joints[2].name"]);
        let reversed = Row { limits: Limits { min: 1.0, max: -1.0 }, ..row("back", 0.0) };
        assert_eq!(faults(builder().joint(reversed)), ["robot.joints[2].limits_deg"]);
        assert_eq!(faults(builder().set("camera.fx_px=0").unwrap()), ["camera.fx_px"]);
        assert_eq!(faults(builder().fewest(&[("fz", 1.0)])), ["selection.accuracy.fz"]);
        assert_eq!(faults(builder().within(0.0)), ["selection.time.most_s"]);
        let nothing = faults(Problem::builder(""));
        for key in ["name", "robot.joints", "camera.width_px", "camera.fx_px", "target.columns", "target.square_mm"] {
            assert!(nothing.iter().any(|found| found == key), "{key}: {nothing:?}");
        }
    }
}
