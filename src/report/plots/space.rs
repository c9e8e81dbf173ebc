//! Drawings in space: the arm and its frames, the camera before the zone, and where the cameras are. What the figures 6 to 9 of the
//! paper show, from a plan's own data.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::figures::grouped;
use crate::plan::document::{Plan, Review, ReviewedPose, Scene};
use crate::report::figure::{Content, Figure, Hue, Line, Mark, Series};

/// The drawings that need no more than a plan and its review.
pub(super) fn drawings(plan: &Plan, review: &Review) -> Vec<Figure> {
    let mut figures: Vec<Figure> = arm(review).into_iter().chain(camera_and_zone(review)).collect();
    figures.push(configurations(review));
    figures.push(locations(plan, review));
    figures
}

/// Seen along a diagonal from above.
fn isometric(point: &Point3<f64>, up: &Vector3<f64>) -> (f64, f64) {
    let aside = up.cross(&if up.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() }).normalize();
    let ahead = aside.cross(up);
    let (x, y, z) = (point.coords.dot(&ahead), point.coords.dot(&aside), point.coords.dot(up));
    let (c, s) = (30f64.to_radians().cos(), 30f64.to_radians().sin());
    (1e3 * (x - y) * c, 1e3 * (z - (x + y) * s))
}

/// The links from the camera to the root.
fn way(scene: &Scene) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(scene.camera_link), |&link| scene.links[link].parent)
}

struct Canvas {
    up: Vector3<f64>,
    series: Vec<Series>,
}

impl Canvas {
    fn new(scene: &Scene) -> Self {
        Self { up: Vector3::from(scene.up), series: vec![] }
    }

    fn line(&mut self, name: &str, hue: Hue, line: Line, points: &[Point3<f64>]) {
        self.add(name, hue, Mark::Line(line), points);
    }

    fn add(&mut self, name: &str, hue: Hue, mark: Mark, points: &[Point3<f64>]) {
        let points = points.iter().map(|point| isometric(point, &self.up)).collect();
        self.series.push(Series { name: name.into(), hue, mark, points, titles: vec![] });
    }

    /// The board's border and the zone's.
    fn board(&mut self, scene: &Scene) {
        let board = &scene.board;
        let X_BT = board.pose.transform();
        for (name, hue, [width, height]) in [("board", Hue::Other, board.size_m), ("zone", Hue::Views, board.zone_m)] {
            let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)];
            let border = corners.map(|(x, y)| X_BT * Point3::new(x * width, y * height, 0.0));
            self.line(name, hue, Line::Solid, &border);
        }
    }

    /// The links from the root to the camera.
    fn arm(&mut self, scene: &Scene, poses: &[Isometry3<f64>]) {
        let mut points: Vec<_> = way(scene).map(|link| Point3::from(poses[link].translation.vector)).collect();
        points.insert(0, (poses[scene.camera_link] * scene.camera.pose.transform()).translation.vector.into());
        self.line("arm", Hue::Plan, Line::Solid, &points);
        self.add("joints", Hue::Plan, Mark::Discs, &points[1..]);
    }

    /// The camera's view: the picture's border at `depth`.
    fn frustum(&mut self, name: &str, scene: &Scene, X_BC: &Isometry3<f64>, depth: f64) {
        let mut border: Vec<_> =
            scene.camera.outline.iter().map(|[x, y]| X_BC * Point3::new(depth * x, depth * y, depth)).collect();
        let Some(first) = border.first().copied() else { return };
        border.push(first);
        let eye = Point3::from(X_BC.translation.vector);
        let quarter = scene.camera.outline.len() / 4;
        let mut lines = border.clone();
        for corner in 1..4 {
            lines.extend([eye, border[corner * quarter]]);
        }
        self.line(name, Hue::Bound, Line::Solid, &lines);
    }

    fn figure(self, name: &'static str, title: &str, caption: String) -> Figure {
        Figure {
            name: name.into(),
            title: title.into(),
            caption,
            x: "mm, seen along a diagonal".into(),
            y: String::new(),
            content: Content::Drawing(self.series),
        }
    }
}

fn first(review: &Review) -> Option<&ReviewedPose> {
    review.poses.first()
}

/// The arm's model with the frames of its links, at the first pose.
fn arm(review: &Review) -> Option<Figure> {
    let scene = &review.scene;
    let mut canvas = Canvas::new(scene);
    let poses = scene.link_poses(&first(review)?.joints)?;
    canvas.board(scene);
    canvas.arm(scene, &poses);
    let reach = poses.iter().map(|X| X.translation.vector.norm()).fold(0.0, f64::max);
    let length = 0.1 * reach.max(0.1);
    for (axis, name, hue, line) in [
        (Vector3::x(), "x axes", Hue::Other, Line::Dashed),
        (Vector3::y(), "y axes", Hue::Views, Line::Solid),
        (Vector3::z(), "z axes", Hue::Bound, Line::Solid),
    ] {
        for (i, link) in way(scene).enumerate() {
            let X = &poses[link];
            // The legend names the axes once.
            let ends = [X * Point3::origin(), X * Point3::from(axis * length)];
            canvas.line(if i == 0 { name } else { "" }, hue, line, &ends);
        }
    }
    Some(canvas.figure(
        "arm",
        "The arm and the frames of its links",
        "At the plan's first pose; z is the axis of each joint of a DH arm.".into(),
    ))
}

/// The camera as it looks at the zone, at the first pose.
fn camera_and_zone(review: &Review) -> Option<Figure> {
    let scene = &review.scene;
    let pose = first(review)?;
    let mut canvas = Canvas::new(scene);
    canvas.board(scene);
    canvas.arm(scene, &scene.link_poses(&pose.joints)?);
    canvas.frustum("picture", scene, &pose.camera.transform(), pose.distance_m);
    Some(canvas.figure(
        "camera-and-zone",
        "The camera looks at the zone",
        format!("At pose {}, configuration {}.", pose.label, pose.id),
    ))
}

/// Cameras of another choice and of the plan among those of all views.
fn configurations(review: &Review) -> Figure {
    let scene = &review.scene;
    let views = &review.views;
    let mut canvas = Canvas::new(scene);
    let at =
        |i: usize| Point3::new(views.positions_m[3 * i], views.positions_m[3 * i + 1], views.positions_m[3 * i + 2]);
    let of = |ids: &[usize]| -> Vec<Point3<f64>> {
        ids.iter().filter_map(|id| views.ids.binary_search(id).ok()).map(at).collect()
    };
    let all: Vec<_> = (0..views.ids.len()).step_by(views.ids.len().div_ceil(super::MOST_DOTS).max(1)).map(at).collect();
    canvas.add(&format!("{} views", grouped(views.all)), Hue::Views, Mark::Dots, &all);
    canvas.board(scene);
    for other in &review.others {
        canvas.add(&other.method, Hue::Other, Mark::Diamonds, &of(&other.ids));
    }
    let poses: Vec<_> = review.poses.iter().map(|pose| Point3::from(Vector3::from(pose.camera.position_m))).collect();
    canvas.add("this plan", Hue::Plan, Mark::Discs, &poses);
    canvas.figure(
        "configurations",
        "Where the cameras are",
        "Positions of the camera of all views, of as many k-means poses, and of the plan.".into(),
    )
}

/// The plan's cameras, and where their axes meet the board's plane.
fn locations(plan: &Plan, review: &Review) -> Figure {
    let scene = &review.scene;
    let mut canvas = Canvas::new(scene);
    canvas.board(scene);
    let mut points = vec![];
    for pose in &plan.poses {
        let camera = Point3::from(Vector3::from(pose.camera_in_base.position_m));
        if let Some(point) = pose.target_point_m {
            let name = if points.is_empty() { "optical axes" } else { "" };
            points.push(Point3::from(Vector3::from(point)));
            canvas.line(name, Hue::Views, Line::Solid, &[camera, Point3::from(Vector3::from(point))]);
        }
    }
    let cameras: Vec<_> =
        plan.poses.iter().map(|pose| Point3::from(Vector3::from(pose.camera_in_base.position_m))).collect();
    canvas.add("cameras", Hue::Plan, Mark::Discs, &cameras);
    canvas.add("axis meets the board's plane", Hue::Other, Mark::Diamonds, &points);
    canvas.figure(
        "locations",
        "Camera locations and the points they look at",
        "Optical axes end where they meet the board's plane.".into(),
    )
}
