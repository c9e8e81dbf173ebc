//! Bounds against the scores that they bound.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;
use crate::camera::{Camera, Lens, MAX_INTRINSICS};
use crate::feasibility::Checks;
use crate::information::{Blur, Noise, NoiseModel, Unknowns};
use crate::robot::JointKind;
use crate::robot::dh::{Convention, Row, chain, frame_link, tree};
use crate::selection::packed::{dot, dual, pack};
use crate::spatial::Pose;
use crate::target::{AprilGrid, AxisCase, Board, Charuco, Circles, Dictionary, Warp, Zone};

/// What a problem states.
struct Stated {
    robot: Robot,
    camera: Camera,
    target: Target,
    visibility: VisibilityLimits,
    noise: Noise,
    estimated: Vec<usize>,
}

impl Stated {
    fn measurement(&self) -> Measurement<'_> {
        let unknowns = Unknowns { camera: &self.camera, estimated: &self.estimated };
        Measurement { warp: self.target.warp, ..Measurement::new(unknowns, &self.target.board, self.noise) }
    }

    fn checks(&self) -> Checks<'_> {
        Checks::new(&self.robot, &self.camera, &self.target, &self.visibility, 0.0, None)
    }

    fn setting(&self) -> Setting<'_> {
        let Self { robot, target, visibility, .. } = self;
        Setting { robot, target, measurement: self.measurement(), visibility, axis: AxisRule::Zone }
    }

    fn ranges(&self) -> Vec<Limits> {
        self.robot.chain.joints.iter().map(|joint| joint.limits).collect()
    }

    /// Joint values of views, drawn at random.
    fn views(&self, count: usize) -> Vec<Vec<f64>> {
        let random = &mut Xoshiro256PlusPlus::seed_from_u64(3);
        let (checks, ranges) = (self.checks(), self.ranges());
        let mut views = Vec::new();
        for _ in 0..3_000_000 {
            let q: Vec<f64> = ranges.iter().map(|limits| random.gen_range(limits.min..=limits.max)).collect();
            let view = checks.view(0, &q).ok().filter(|view| view.axis_case(&self.target) != AxisCase::Outside);
            views.extend(view.map(|view| view.q));
            if views.len() == count {
                break;
            }
        }
        assert!(views.len() > 5, "{} views", views.len());
        views
    }
}

fn revolute(a: f64, alpha: f64, d: f64, theta: f64, limits_deg: [f64; 2]) -> Row {
    let [min, max] = limits_deg.map(f64::to_radians);
    let limits = Limits { min, max };
    Row { name: String::new(), kind: JointKind::Revolute, a, alpha, d, theta, limits, max_speed: None }
}

/// The Servosila Engineer, and more joints at its hand.
fn servosila_with(more: &[Row]) -> Stated {
    let rows = [
        &[
            revolute(0.07, FRAC_PI_2, 0.0, 0.0, [-214.2, 137.3]),
            revolute(0.3, 0.0, 0.0, 0.0, [-16.4, 114.2]),
            revolute(0.425, 0.0, -0.06, PI, [-216.9, 0.0]),
            revolute(0.0, 0.0, 0.06, -PI, [0.0, 188.8]),
        ],
        more,
    ]
    .concat();
    let mount = Matrix3::new(0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, 0.0);
    let mount = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(mount));
    let robot = Robot {
        chain: chain(&rows, Convention::Standard, Pose::identity()),
        tree: tree(&rows, Convention::Standard, Pose::identity()),
        X_FC: Pose::from_parts(Vector3::zeros().into(), mount),
        board_link: 0,
        camera_link: frame_link(rows.len()),
        obstacles: Vec::new(),
    };
    let camera = Camera::new(Lens::BrownConrady, 1280, 720, &[1000.0, 1000.0, 639.5, 359.5, -0.2, 0.05, 0.0, 0.0, 0.0]);
    let zone = Zone { width: 0.378_25, height: 0.3505, edge_margin: 0.0 };
    let X_BT = Pose::translation(0.232_875, 0.072_75, -0.098);
    Stated {
        robot,
        camera: camera.unwrap(),
        target: Target { board: Board::checkerboard(8, 6, 0.035), X_BT, zone, warp: None, thickness: 5e-3 },
        visibility: VisibilityLimits {
            margin: 5.0,
            max_incidence: 80f64.to_radians(),
            max_tilt: 70f64.to_radians(),
            min_distance: 0.1,
            max_distance: 3.0,
            min_corner_spacing: 0.0,
            min_corners: None,
            min_marker: 0.0,
        },
        noise: Noise { sigma: 0.3, model: NoiseModel::Edges { window: 5.0, blur: Blur::NONE } },
        estimated: (0..9).collect(),
    }
}

fn servosila() -> Stated {
    servosila_with(&[])
}

/// What views score, collision and all.
struct Scorer<'a> {
    checks: Checks<'a>,
    measurement: Measurement<'a>,
    dual: Vec<f64>,
    problem: &'a Stated,
}

impl<'a> Scorer<'a> {
    fn new(problem: &'a Stated, y: &[f64]) -> Self {
        let measurement = problem.measurement();
        Self { checks: problem.checks(), dual: dual(y.to_vec(), measurement.order()), measurement, problem }
    }

    fn score(&self, q: &[f64]) -> Option<f64> {
        let view = self.checks.view(0, q).ok()?;
        if view.axis_case(&self.problem.target) == AxisCase::Outside {
            return None;
        }
        Some(dot(&self.dual, &self.measurement.information(&view.X_CT, &view.seen)?))
    }
}

/// A random Y ⪰ 0 in the units of the views' information.
fn random_y(problem: &Stated, random: &mut Xoshiro256PlusPlus, views: &[Vec<f64>]) -> Vec<f64> {
    let measurement = problem.measurement();
    let p = measurement.order();
    let mut mean = DMatrix::zeros(p, p);
    let checks = problem.checks();
    for q in views.iter().take(50) {
        let view = checks.view(0, q).unwrap();
        mean += unpack(&measurement.information(&view.X_CT, &view.seen).unwrap(), p);
    }
    let L = mean.cholesky().unwrap().l().try_inverse().unwrap();
    let root = DMatrix::from_fn(p, p, |_, _| random.gen_range(-1.0..1.0));
    let root = L.transpose() * root;
    pack(&(&root * root.transpose()))
}

/// Boxes about views; the bound of each is held against the scores of joint values in it. Returns the mean of bound by greatest
/// score found and how many boxes had a bound.
fn hold(problem: &Stated, boxes: usize, draws: usize, half_deg: [f64; 2], seed: u64) -> (f64, usize) {
    let random = &mut Xoshiro256PlusPlus::seed_from_u64(seed);
    let views = problem.views(40);
    let y = random_y(problem, random, &views);
    let continuum = Continuum::new(vec![(problem.setting(), &y)], problem.ranges()).unwrap();
    let scorer = Scorer::new(problem, &y);
    let (mut sum, mut bounded) = (0.0, 0);
    for _ in 0..boxes {
        let centre = &views[random.gen_range(0..views.len())];
        let around: Vec<Limits> = centre
            .iter()
            .map(|&q| {
                let half = random.gen_range(half_deg[0]..=half_deg[1]).to_radians();
                let q = q + half * random.gen_range(-1.0..1.0);
                Limits { min: q - half, max: q + half }
            })
            .collect();
        let found = continuum.examine(&Cell::new(&around));
        let mut greatest = 0.0f64;
        for draw in 0..draws {
            let q: Vec<f64> = around
                .iter()
                .map(|limits| match draw % 3 {
                    0 => random.gen_range(limits.min..=limits.max),
                    _ => [limits.min, limits.max][random.gen_range(0..2)],
                })
                .collect();
            if let Some(score) = scorer.score(&q) {
                greatest = greatest.max(score);
            }
        }
        match found {
            Found::Empty => assert_eq!(greatest, 0.0, "a view in an empty box {around:?}"),
            Found::Bound { bound, .. } => {
                assert!(greatest <= bound, "{greatest} > {bound}: {around:?}");
                if bound.is_finite() && greatest > 0.0 {
                    sum += bound / greatest;
                    bounded += 1;
                }
            }
        }
    }
    (sum / bounded.max(1) as f64, bounded)
}

/// Scores less the prices of balls of pictures, some of which hold a box and some of which end in it.
#[test]
fn no_view_scores_more_less_its_prices() {
    let random = &mut Xoshiro256PlusPlus::seed_from_u64(11);
    let problem = servosila();
    let views = problem.views(40);
    let y = random_y(&problem, random, &views);
    let scorer = Scorer::new(&problem, &y);
    let picture = |q: &[f64]| {
        let view = scorer.checks.view(0, q).ok()?;
        Some(view.picture(&problem.camera, &problem.target.board))
    };
    let (mut held, mut ended, mut looser) = (0, 0, 0);
    for q in &views {
        let score = scorer.score(q).unwrap();
        let ranges = around(q, [(); 4].map(|()| random.gen_range(0.02..0.6)));
        let ball = |q: &[f64], radius: f64, share: f64| PictureBall {
            centre: picture(q).unwrap(),
            radius,
            price: share * score,
        };
        let aside: Vec<f64> = q.iter().map(|q| q + random.gen_range(-0.01..0.01)).collect();
        let aside = if picture(&aside).is_some() { aside } else { q.clone() };
        let balls = vec![
            ball(q, random.gen_range(1.0..30.0), 0.3),
            ball(&aside, random.gen_range(1.0..30.0), 0.2),
            ball(&aside, 1.0, 0.1),
        ];
        let unpriced = Continuum::new(vec![(problem.setting(), &y)], problem.ranges()).unwrap();
        let priced = unpriced.clone().less(balls.clone());
        let of = |continuum: &Continuum| match continuum.examine(&Cell::new(&ranges)) {
            Found::Bound { bound, .. } => bound,
            Found::Empty => panic!("{q:?} is in it"),
        };
        let (bound, without) = (of(&priced), of(&unpriced));
        let [mut inside, mut outside] = [0; 2];
        for _ in 0..300 {
            let q: Vec<f64> = ranges.iter().map(|limits| random.gen_range(limits.min..=limits.max)).collect();
            let Some(score) = scorer.score(&q) else { continue };
            let picture = picture(&q).unwrap();
            let less = score - PictureBall::price_of(&balls, &picture);
            assert!(less <= bound && bound <= without * (1.0 + 1e-9), "{less} {bound} {without}");
            *(if balls[0].contains(&picture) { &mut inside } else { &mut outside }) += 1;
        }
        held += usize::from(outside == 0 && bound < without - 0.29 * score);
        ended += usize::from(inside > 0 && outside > 0);
        looser += usize::from(outside == 0 && bound > without - 0.01 * score);
    }
    assert!(held > 5 && ended > 5 && looser < held, "{held} {ended} {looser}");
}

/// The Servosila with another lens.
fn with_lens(lens: Lens) -> Stated {
    let mut problem = servosila();
    let focal = if lens.is_fisheye() { 500.0 } else { 1000.0 };
    let coefficients: &[f64] = match lens {
        Lens::Pinhole => &[],
        Lens::BrownConrady => &[-0.2, 0.05, 1e-3, -2e-3, 0.01],
        Lens::Rational => &[-0.012, 0.036, -2.5e-4, 5.3e-4, 0.0197, 0.0148, -0.0562, 0.05],
        Lens::KannalaBrandt => &[-0.02, 0.01, -0.004, 0.001],
    };
    let θ = [&[focal, focal * 0.99, 641.0, 362.0], coefficients].concat();
    problem.camera = Camera::new(lens, 1280, 720, &θ).unwrap();
    // Of information packed in double precision, a denominator's last coefficients leave no digits.
    problem.estimated = (0..θ.len().min(10)).collect();
    problem
}

/// And with another board in the place of its own.
fn with_board(board: Board) -> Stated {
    let mut problem = servosila();
    problem.target.board = board;
    problem
}

fn blurred() -> Stated {
    let mut problem = servosila();
    let blur = Blur { focal_length: 1000.0, aperture: 0.002, focus: 2.0, turning: 0.002, moving: 0.0005 };
    problem.noise = Noise { sigma: 0.3, model: NoiseModel::Edges { window: 5.0, blur } };
    problem
}

fn warped() -> Stated {
    let mut problem = servosila();
    problem.target.warp = Some(Warp::new(1e-3, &problem.target.board));
    problem
}

fn constant() -> Stated {
    let mut problem = servosila();
    problem.noise.model = NoiseModel::Constant;
    problem
}

/// Small squares, whose edges end in the detector's window.
fn small() -> Stated {
    let mut problem = with_board(Board::checkerboard(8, 6, 0.008));
    problem.noise.model = NoiseModel::Edges { window: 9.0, blur: Blur::NONE };
    problem
}

fn in_part() -> Stated {
    let charuco = Charuco::new([9, 7], 0.035, 0.026, Dictionary::named("DICT_5X5_100").unwrap(), false).unwrap();
    let mut problem = with_board(Board::Charuco(charuco));
    problem.visibility.min_corners = Some(12);
    problem
}

fn wrist() -> Row {
    revolute(0.05, FRAC_PI_2, 0.0, 0.0, [-20.0, 20.0])
}

fn slide() -> Row {
    let limits = Limits { min: -0.05, max: 0.05 };
    Row { kind: JointKind::Prismatic, limits, ..revolute(0.0, -FRAC_PI_2, 0.0, 0.0, [0.0; 2]) }
}

fn settings() -> Vec<(&'static str, Stated)> {
    vec![
        ("Brown and Conrady", servosila()),
        ("Brown and Conrady, all coefficients", with_lens(Lens::BrownConrady)),
        ("pinhole", with_lens(Lens::Pinhole)),
        ("rational", with_lens(Lens::Rational)),
        ("fisheye", with_lens(Lens::KannalaBrandt)),
        ("constant noise", constant()),
        ("blurred", blurred()),
        ("warped", warped()),
        ("small squares", small()),
        ("circles", with_board(Board::Circles(Circles::new([7, 5], 0.04, 0.02, false).unwrap()))),
        ("AprilTags", with_board(Board::AprilGrid(AprilGrid::new([4, 3], 0.05, 0.3).unwrap()))),
        ("in part", in_part()),
        ("five axes and a slide", servosila_with(&[wrist(), slide()])),
    ]
}

#[test]
fn no_view_of_a_box_scores_more_than_its_bound() {
    for (_, problem) in settings() {
        hold(&problem, 12, 20, [0.1, 4.0], 2);
    }
}

#[test]
#[ignore = "takes minutes"]
fn no_view_of_many_boxes_scores_more_than_their_bounds() {
    for (_, problem) in settings() {
        for half in [0.25, 0.5, 1.0, 3.0] {
            hold(&problem, 200, 300, [half, half], 1);
        }
        hold(&problem, 200, 300, [0.1, 8.0], 2);
    }
}

#[test]
fn bounds_of_small_boxes_are_tight() {
    for (half, most) in [(0.5, 1.02), (0.25, 1.005)] {
        let (ratio, bounded) = hold(&servosila(), 20, 40, [half, half], 1);
        assert!(ratio < most && bounded > 10, "±{half}°: {ratio}, {bounded}");
    }
}

/// Within some degrees of a view.
fn around(q: &[f64], half_deg: [f64; 4]) -> Vec<Limits> {
    let limits = |(&q, half): (&f64, f64)| Limits { min: q - half.to_radians(), max: q + half.to_radians() };
    q.iter().zip(half_deg).map(limits).collect()
}

#[test]
fn the_greatest_score_is_that_of_a_dense_grid() {
    let problem = servosila();
    let views = problem.views(40);
    let y = random_y(&problem, &mut Xoshiro256PlusPlus::seed_from_u64(4), &views);
    let scorer = Scorer::new(&problem, &y);
    let best = views.iter().max_by(|a, b| scorer.score(a).unwrap().total_cmp(&scorer.score(b).unwrap())).unwrap();
    // Two joints move, the others stand.
    let ranges = around(best, [0.0, 6.0, 0.0, 6.0]);
    let steps = 120;
    let at = |limits: &Limits, i: usize| limits.min + (limits.max - limits.min) * i as f64 / steps as f64;
    let mut greatest = 0.0f64;
    for (i, j) in (0..=steps).flat_map(|i| (0..=steps).map(move |j| (i, j))) {
        let q = [best[0], at(&ranges[1], i), best[2], at(&ranges[3], j)];
        greatest = greatest.max(scorer.score(&q).unwrap_or(0.0));
    }
    let continuum = Continuum::new(vec![(problem.setting(), &y)], ranges).unwrap();
    let settings = ContinuumSettings { tolerance: 1e-3, most_boxes: 20_000 };
    let run = || continuum.greatest(0.0, &settings, &|q| scorer.score(q), &mut |_| ControlFlow::Continue(()));
    let found = run();
    assert_eq!(found.end, ContinuumEnd::Closed);
    assert!(found.bound >= greatest && found.found <= found.bound && found.bound <= 1.001 * found.found);
    // The grid misses the border of what is seen by up to a step.
    assert!(greatest > 0.98 * found.found);
    assert!(continuum.holds(found.bound * 1.001, 20_000).is_proven);
    assert!(!continuum.holds(found.found * 0.999, 500).is_proven);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    for threads in [1, 3] {
        assert_eq!(pool(threads).install(run), found, "{threads} threads");
    }
    let stopped = continuum.greatest(0.0, &settings, &|q| scorer.score(q), &mut |_| ControlFlow::Break(()));
    assert_eq!((stopped.end, stopped.boxes), (ContinuumEnd::Stopped, 1));
}

#[test]
fn arms_of_more_joints_are_refused() {
    assert_eq!(Continuum::new(Vec::new(), vec![Limits::FULL_TURN; 9]).unwrap_err(), Unsupported::Joints { joints: 9 });
}

/// The polynomial at x, lane by lane, and the remainder.
fn at<const N: usize, const Q: usize, const C: usize>(
    model: &taylor::Taylor<N, Q, C>,
    x: &[f64; N],
    lane: usize,
) -> (f64, f64) {
    let mut value = model.c.0[lane];
    let (mut k, mut third) = (0, 0);
    for a in 0..N {
        value += model.l[a].0[lane] * x[a];
        for b in a..N {
            value += model.q[k].0[lane] * x[a] * x[b];
            k += 1;
            for c in b..N {
                value += model.t[third].0[lane] * x[a] * x[b] * x[c];
                third += 1;
            }
        }
    }
    (value, model.r.0[lane])
}

/// Points, pixels and their derivatives, at random joint values of random boxes.
#[test]
fn images_are_within_their_models() {
    let random = &mut Xoshiro256PlusPlus::seed_from_u64(5);
    for (name, problem) in settings() {
        if problem.robot.chain.dof() != 4 {
            continue;
        }
        let views = problem.views(40);
        for _ in 0..30 {
            let q = &views[random.gen_range(0..views.len())];
            let half = [(); 4].map(|()| random.gen_range(0.001..0.05));
            let kinematics = Kinematics::new(&problem.robot, &problem.target.X_BT, q, &half);
            let corners: Vec<Point3<f64>> = problem.target.board.corners().take(4).collect();
            let points = score::packed::<4, 10, 20>(&std::array::from_fn(|i| {
                point(&kinematics.of_board, &(kinematics.X_CT * corners[i]))
            }));
            let image = image::image(&problem.camera, &points);
            for _ in 0..20 {
                let x = [(); 4].map(|()| random.gen_range(-1.0..=1.0));
                let q: Vec<f64> = (0..4).map(|a| q[a] + half[a] * x[a]).collect();
                let X_CT = problem.robot.camera_pose(&q).inverse() * problem.target.X_BT;
                for (lane, corner) in corners.iter().enumerate() {
                    let p = X_CT * corner;
                    let near = |model: &taylor::Taylor<4, 10, 20>, value: f64, what: &str| {
                        let (found, r) = at(model, &x, lane);
                        assert!((found - value).abs() <= r, "{name}, {what}: {found} ± {r}, {value}");
                    };
                    for row in 0..3 {
                        near(&points[row], p[row], "point");
                    }
                    let Some(projection) = problem.camera.project_with_derivatives(&p) else { continue };
                    assert!(image.exists[lane]);
                    for row in 0..2 {
                        near(&image.pixel[row], projection.pixel[row], "pixel");
                        for column in 0..3 {
                            near(&image.by_point[row][column], projection.by_point[(row, column)], "by point");
                        }
                        for column in 0..MAX_INTRINSICS {
                            let zero = taylor::Taylor::constant(0.0);
                            let model = image.by_intrinsics[row][column].as_deref().unwrap_or(&zero);
                            near(model, projection.by_intrinsics[(row, column)], "by intrinsics");
                        }
                    }
                }
            }
        }
    }
}

/// At the centre of a box that is a point.
#[test]
fn the_score_of_a_point_is_its_own() {
    for (name, problem) in settings() {
        let random = &mut Xoshiro256PlusPlus::seed_from_u64(7);
        let views = problem.views(40);
        let y = random_y(&problem, random, &views);
        let scorer = Scorer::new(&problem, &y);
        let continuum = Continuum::new(vec![(problem.setting(), &y)], problem.ranges()).unwrap();
        for q in views.iter().take(20) {
            let point: Vec<Limits> = q.iter().map(|&q| Limits { min: q, max: q }).collect();
            let Found::Bound { bound, .. } = continuum.examine(&Cell::new(&point)) else { panic!("{name}") };
            let score = scorer.score(q).unwrap();
            assert!(bound >= score, "{name}: {score} {bound}");
            // Corners that are hidden count in the bound, and the allowance for the rounding of a Y that is all but singular, as of many
            // coefficients, is felt.
            let loose = if name == "rational" { 1e-3 } else { 1e-4 };
            assert!(name == "in part" || bound < score * (1.0 + loose), "{name}: {score} {bound}");
        }
    }
}

/// The whole model against the score where corners keep to the picture.
#[test]
fn scores_are_below_their_models() {
    for (name, problem) in settings() {
        if problem.robot.chain.dof() != 4 {
            continue;
        }
        let random = &mut Xoshiro256PlusPlus::seed_from_u64(9);
        let views = problem.views(40);
        let y = random_y(&problem, random, &views);
        let scorer = Scorer::new(&problem, &y);
        let scored = Scored::new(problem.setting(), &y);
        for _ in 0..10 {
            let q = &views[random.gen_range(0..views.len())];
            let half = [(); 4].map(|()| random.gen_range(0.001..0.01));
            let kinematics = Kinematics::new(&problem.robot, &problem.target.X_BT, q, &half);
            let Outcome::Score(scores) = scored.score::<4, 10, 20>(&kinematics) else { continue };
            for _ in 0..20 {
                let x = [(); 4].map(|()| random.gen_range(-1.0..=1.0));
                let moved: Vec<f64> = (0..4).map(|a| q[a] + half[a] * x[a]).collect();
                let Some(score) = scorer.score(&moved) else { continue };
                let model = scores.score.at(&x);
                assert!(score <= model + scores.score.r, "{name}: {score} {model} {}", scores.score.r);
                for limit in scores.inside.iter().chain(&scored.sight.limits::<4, 10, 20>(&kinematics)) {
                    assert!(limit.at(&x) + limit.r >= 0.0, "{name}: {} {}", limit.at(&x), limit.r);
                }
            }
        }
    }
}

/// Of a board that may be seen in part, where it is past the picture, and the zone does not say so.
#[test]
fn boxes_that_show_too_few_corners_are_empty() {
    let problem = in_part();
    let views = problem.views(40);
    let y = random_y(&problem, &mut Xoshiro256PlusPlus::seed_from_u64(4), &views);
    let setting = Setting { axis: AxisRule::Any, ..problem.setting() };
    let continuum = Continuum::new(vec![(setting, &y)], problem.ranges()).unwrap();
    let checks = problem.checks();
    let mut past = 0;
    for q in &views {
        for turn in (5..60).map(|degrees| f64::from(degrees).to_radians()) {
            let q = [q[0], q[1], q[2], q[3] + turn];
            let found = continuum.examine(&Cell::new(&around(&q, [0.02; 4])));
            if checks.view(0, &q).is_ok() {
                assert_ne!(found, Found::Empty);
            }
            past += usize::from(found == Found::Empty);
        }
    }
    // Most of them: the board leaves the picture within some forty degrees.
    assert!(past > 20 * views.len(), "{past}");
}

/// A robust plan's score is the sum of its scenarios'; views are those of the first.
#[test]
fn scores_of_several_settings_add_up() {
    let problem = servosila();
    let mut moved = servosila();
    moved.target.X_BT = Pose::translation(0.004, -0.003, 0.002) * moved.target.X_BT;
    let views = problem.views(40);
    let random = &mut Xoshiro256PlusPlus::seed_from_u64(4);
    let ys = [random_y(&problem, random, &views), random_y(&problem, random, &views)];
    let elsewhere = Setting { axis: AxisRule::Any, ..moved.setting() };
    let settings = vec![(problem.setting(), &ys[0][..]), (elsewhere, &ys[1][..])];
    let continuum = Continuum::new(settings, problem.ranges()).unwrap();
    let scorers = [Scorer::new(&problem, &ys[0]), Scorer::new(&moved, &ys[1])];
    let (mut seen_in_both, mut tightest) = (0, f64::INFINITY);
    for q in &views {
        let ranges = around(q, [0.1; 4]);
        let Found::Bound { bound, .. } = continuum.examine(&Cell::new(&ranges)) else { panic!("{q:?}") };
        for _ in 0..50 {
            let q: Vec<f64> = ranges.iter().map(|limits| random.gen_range(limits.min..=limits.max)).collect();
            let Some(score) = scorers[0].score(&q) else { continue };
            // There the axis is not asked.
            let there = scorers[1].checks.view(0, &q).ok();
            let told = there.and_then(|view| scorers[1].measurement.information(&view.X_CT, &view.seen));
            seen_in_both += usize::from(told.is_some());
            let sum = score + told.map_or(0.0, |told| dot(&scorers[1].dual, &told));
            assert!(bound >= sum, "{bound} {sum}");
            tightest = tightest.min(bound / sum);
        }
    }
    assert!(seen_in_both > 1000 && tightest < 1.05, "{seen_in_both} {tightest}");
}
