//! Averages over the image's area.

use nalgebra::{DMatrix, Vector2};

use crate::camera::Camera;

/// Order of the Gauss rule along each direction of a sector; the tests say how well it has converged.
const ORDER: usize = 24;

/// Places on a side of the image at which it is asked whether the lens reaches it.
const PROBES: usize = 64;

/// Halvings of an interval: as many as the significand has digits.
const HALVINGS: usize = 52;

/// A point of the image and its share of the area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AreaNode {
    pub(super) pixel: Vector2<f64>,
    pub(super) share: f64,
}

/// Points and shares by which `Σ share · f(pixel)` is the mean of a smooth f over the area that `camera` sees: the image,
/// [−½, w−½] × [−½, h−½], as far as the lens reaches. The shares are positive and add up to one; there are no points if it
/// reaches none.
///
/// A product Gauss rule on the triangles between the principal point, around which a lens ends, and the image's sides, in
/// collapsed coordinates `pixel = c + t (b(s) − c)` with b on the side. Sides are divided where the lens's end crosses
/// them, and t goes up to the lens's end τ, so that all is smooth. Near that end rays change with the root of the distance
/// to it; there t is τ(1 − x²) with x from the rule.
pub(super) fn image_area(camera: &Camera) -> Vec<AreaNode> {
    of_order(camera, ORDER)
}

fn of_order(camera: &Camera, order: usize) -> Vec<AreaNode> {
    let low = Vector2::new(-0.5, -0.5);
    let high = Vector2::new(f64::from(camera.width()), f64::from(camera.height())) + low;
    // The area is convex: of a principal point outside the image the nearest point of the image serves as well.
    let center = Vector2::from_fn(|i, _| camera.intrinsics()[2 + i].clamp(low[i], high[i]));
    let corners = [low, Vector2::new(high.x, low.y), high, Vector2::new(low.x, high.y)];
    let rule = gauss_legendre(order);
    let mut nodes = Vec::new();
    for (i, &from) in corners.iter().enumerate() {
        Triangle { camera, center, from, to: corners[(i + 1) % 4] }.add_nodes(&rule, &mut nodes);
    }
    let total: f64 = nodes.iter().map(|node| node.share).sum();
    for node in &mut nodes {
        node.share /= total;
    }
    nodes
}

/// The part of the image between its centre and one side.
struct Triangle<'a> {
    camera: &'a Camera,
    center: Vector2<f64>,
    from: Vector2<f64>,
    to: Vector2<f64>,
}

impl Triangle<'_> {
    fn at(&self, s: f64, t: f64) -> Vector2<f64> {
        self.center + (self.from + (self.to - self.from) * s - self.center) * t
    }

    fn is_reached(&self, s: f64, t: f64) -> bool {
        self.camera.unproject(&self.at(s, t)).is_some()
    }

    /// Adds nodes whose shares are areas in px².
    fn add_nodes(&self, rule: &[(f64, f64)], nodes: &mut Vec<AreaNode>) {
        let area = (self.from - self.center).perp(&(self.to - self.center));
        for part in self.divisions().windows(2) {
            let width = part[1] - part[0];
            for &(x, s_weight) in rule {
                let s = part[0] + x * width;
                let is_whole = self.is_reached(s, 1.0);
                let end = if is_whole { 1.0 } else { last(0.0, 1.0, |t| self.is_reached(s, t)) };
                for &(x, t_weight) in rule {
                    let (t, dt) = if is_whole { (x, 1.0) } else { (end * (1.0 - x * x), end * 2.0 * x) };
                    let share = area * t * width * s_weight * dt * t_weight;
                    if share > 0.0 {
                        nodes.push(AreaNode { pixel: self.at(s, t), share });
                    }
                }
            }
        }
    }

    /// The parameters s, from 0 to 1, between which all of the side is reached or nothing is.
    fn divisions(&self) -> Vec<f64> {
        let probe = |i: usize| i as f64 / PROBES as f64;
        let crossings = (0..PROBES).filter_map(|i| {
            let before = self.is_reached(probe(i), 1.0);
            let crosses = before != self.is_reached(probe(i + 1), 1.0);
            crosses.then(|| last(probe(i), probe(i + 1), |s| self.is_reached(s, 1.0) == before))
        });
        std::iter::once(0.0).chain(crossings).chain([1.0]).collect()
    }
}

/// The last of `low` to `high` that `holds`, where all before it do.
fn last(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// Nodes and weights of the Gauss–Legendre rule on [0, 1], as eigenvalues and squared first components of the eigenvectors
/// of the Legendre polynomials' recurrence (Golub & Welsch 1969).
fn gauss_legendre(order: usize) -> Vec<(f64, f64)> {
    let beside = |i: usize| i as f64 / ((4 * i * i - 1) as f64).sqrt();
    let recurrence = DMatrix::from_fn(order, order, |i, j| if i.abs_diff(j) == 1 { beside(i.max(j)) } else { 0.0 });
    let eigen = recurrence.symmetric_eigen();
    let node = |i: usize| (f64::midpoint(1.0, eigen.eigenvalues[i]), eigen.eigenvectors[(0, i)].powi(2));
    (0..order).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Lens;

    fn camera(lens: Lens, θ: &[f64]) -> Camera {
        Camera::new(lens, 1280, 720, θ).unwrap()
    }

    /// The whole image, seen from a point inside, on the border, and outside of it.
    #[test]
    fn moments_of_the_image_are_exact() {
        for (cx, cy) in [(639.5, 359.5), (100.0, 700.0), (-0.5, 300.0), (-200.0, -90.0), (1500.0, 300.0)] {
            let nodes = image_area(&camera(Lens::Pinhole, &[1000.0, 900.0, cx, cy]));
            let moment = |f: &dyn Fn(f64, f64) -> f64| {
                nodes.iter().map(|AreaNode { pixel, share }| share * f(pixel.x, pixel.y)).sum::<f64>()
            };
            let near = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-7, "{found} {expected}");
            near(moment(&|_, _| 1.0), 1.0);
            near(moment(&|x, _| x), 639.5);
            near(moment(&|x, _| (x - 639.5).powi(2)), 1280.0f64.powi(2) / 12.0);
            near(moment(&|_, y| (y - 359.5).powi(4)), 720.0f64.powi(4) / 80.0);
            near(moment(&|x, _| (x - 639.5).powi(8)), 640.0f64.powi(8) / 9.0);
        }
    }

    /// θ − θ³/3 turns back at θ = 1, r = 2/3: a circle of 400 px, cut off by the image above and below.
    #[test]
    fn beyond_the_lens_there_is_no_area() {
        let fisheye = camera(Lens::KannalaBrandt, &[600.0, 600.0, 639.5, 359.5, -1.0 / 3.0, 0.0, 0.0, 0.0]);
        let nodes = image_area(&fisheye);
        assert!(nodes.iter().all(|node| fisheye.unproject(&node.pixel).is_some()));
        let mean_square: f64 =
            nodes.iter().map(|node| node.share * (node.pixel - Vector2::new(639.5, 359.5)).norm_squared()).sum();
        // ∫∫ over |y| ≤ 360 of the disc: area 2(h√(R²−h²) + R² asin(h/R)); Σ r² by the same strips.
        let (R, h) = (400.0f64, 360.0f64);
        let strips = 200_000;
        let (mut area, mut moment) = (0.0, 0.0);
        for i in 0..strips {
            let y = (f64::from(i) + 0.5) / f64::from(strips) * h;
            let x = (R * R - y * y).sqrt();
            area += x;
            moment += x * y * y + x.powi(3) / 3.0;
        }
        assert!((mean_square / (moment / area) - 1.0).abs() < 1e-6, "{mean_square} {}", moment / area);
    }

    #[test]
    fn twelve_nodes_integrate_polynomials_of_degree_23() {
        let rule = gauss_legendre(12);
        for degree in 0..24 {
            let found: f64 = rule.iter().map(|(x, weight)| weight * x.powi(degree)).sum();
            assert!((found * f64::from(degree + 1) - 1.0).abs() < 1e-12, "{degree}: {found}");
        }
    }

    /// Every column's part in the map error is that of a rule twice as fine: to rounding where the lens reaches the whole
    /// image, to far below what a report shows where it ends inside.
    #[test]
    fn the_rule_has_converged() {
        use crate::information::Unknowns;
        let focal = [1000.0, 990.0, 641.0, 362.0];
        // Turns back at 0.86 rad, 573 px from the principal point.
        let folding: (Lens, &[f64], f64) = (Lens::KannalaBrandt, &[-0.45, 0.0, 0.0, 0.0], 3e-5);
        let lenses = Lens::ALL.into_iter().map(|lens| (lens, lens.typical(), 1e-11));
        for (lens, coefficients, tolerance) in lenses.chain([folding]) {
            let camera = camera(lens, &[&focal[..], coefficients].concat());
            let estimated: Vec<usize> = (0..camera.intrinsics().len()).collect();
            let W = |order| Unknowns { camera: &camera, estimated: &estimated }.weight_over(&of_order(&camera, order));
            let (coarse, fine) = (W(ORDER), W(2 * ORDER));
            for i in 0..estimated.len() {
                let ratio = (coarse[(i, i)] / fine[(i, i)]).sqrt();
                assert!((ratio - 1.0).abs() < tolerance, "{lens:?} {i}: {ratio}");
            }
        }
    }
}
