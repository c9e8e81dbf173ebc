//! The robot's bodies before the camera.

use nalgebra::{Isometry3, Point3, Vector3};
use parry3d_f64::query::Ray;
use parry3d_f64::shape::{Ball, Capsule, ConvexPolyhedron, Cuboid, Shape as Solid};

use crate::robot::{Body, Shape};
use crate::spatial::Pose;

/// Grey value of a body that faces the camera, and how much darker one that is seen edge-on is.
const FACING: f64 = 150.0;
const DARKER: f64 = 70.0;

/// Bodies that can be hit by rays from the camera.
#[derive(Default)]
pub struct Bodies(Vec<Placed>);

/// A body, and where its link is in the camera's frame.
#[derive(Debug, Clone, Copy)]
pub struct PlacedBody<'a> {
    /// The body.
    pub body: &'a Body,
    /// Pose of its link in C.
    pub X_CL: Pose,
}

/// Where a ray meets a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// Which of the bodies.
    body: usize,
    /// How far along the ray, m.
    pub(super) depth: f64,
    /// Its grey value there.
    pub(super) shade: f64,
}

/// Difference of shades beyond which a body has an edge between two rays; what is round is shaded more smoothly.
const EDGE: f64 = 20.0;

impl Hit {
    /// Whether rays next to each other, which meet this and that or nothing, are either side of an edge.
    pub(super) fn is_edge(a: Option<Self>, b: Option<Self>) -> bool {
        match (a, b) {
            (Some(a), Some(b)) => a.body != b.body || (a.shade - b.shade).abs() > EDGE,
            (a, b) => a.is_some() != b.is_some(),
        }
    }
}

struct Placed {
    solid: Box<dyn Solid>,
    X_CG: Isometry3<f64>,
    /// Of a sphere around it, in C, m.
    centre: Vector3<f64>,
    radius: f64,
}

impl Bodies {
    /// Bodies in the camera's frame. One that holds the camera's centre, its housing, hides nothing and is left out; of one that is the hull of
    /// points, the margin is.
    pub fn new<'a>(bodies: impl IntoIterator<Item = PlacedBody<'a>>) -> Self {
        let placed = bodies.into_iter().filter_map(|PlacedBody { body, X_CL }| {
            let solid = solid(&body.shape)?;
            let X_CG = X_CL * body.X_LG;
            if solid.contains_point(&X_CG, &Point3::origin()) {
                return None;
            }
            let sphere = solid.compute_bounding_sphere(&X_CG);
            Some(Placed { solid, X_CG, centre: sphere.center().coords, radius: sphere.radius() })
        });
        Self(placed.collect())
    }

    /// What a ray of unit length from the camera meets first.
    pub(super) fn first(&self, ray: &Vector3<f64>) -> Option<Hit> {
        let mut first: Option<Hit> = None;
        for (body, Placed { solid, X_CG, centre, radius }) in self.0.iter().enumerate() {
            let nearest = ray * ray.dot(centre).max(0.0);
            if (nearest - centre).norm_squared() > radius * radius {
                continue;
            }
            let most = first.map_or(f64::MAX, |hit| hit.depth);
            if let Some(hit) = solid.cast_ray_and_get_normal(X_CG, &Ray::new(Point3::origin(), *ray), most, true) {
                let facing = -hit.normal.dot(ray);
                let shade = FACING - DARKER * (1.0 - facing.clamp(0.0, 1.0));
                first = Some(Hit { body, depth: hit.time_of_impact, shade });
            }
        }
        first
    }
}

/// The shape to hit; `None` of points that have no hull.
fn solid(shape: &Shape) -> Option<Box<dyn Solid>> {
    Some(match shape {
        Shape::Box { half_extents } => Box::new(Cuboid::new(*half_extents)),
        Shape::Sphere { radius } => Box::new(Ball::new(*radius)),
        Shape::Capsule { radius, length } => Box::new(Capsule::new_z(0.5 * length, *radius)),
        Shape::Cylinder { radius, length } => {
            Box::new(ConvexPolyhedron::from_convex_hull(&rims(*radius, 0.5 * length))?)
        }
        Shape::Convex { points, .. } => Box::new(ConvexPolyhedron::from_convex_hull(points)?),
    })
}

/// Corners of a cylinder along z.
const AROUND: u16 = 48;

fn rims(radius: f64, half: f64) -> Vec<Point3<f64>> {
    let corner = |i: u16| {
        let φ = std::f64::consts::TAU * f64::from(i) / f64::from(AROUND);
        [-half, half].map(|z| Point3::new(radius * φ.cos(), radius * φ.sin(), z))
    };
    (0..AROUND).flat_map(corner).collect()
}
