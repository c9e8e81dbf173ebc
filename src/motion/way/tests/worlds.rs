//! Worlds whose margins have a closed form.

use rand::Rng;
use rand_xoshiro::Xoshiro256PlusPlus;

use super::super::*;

/// The margins at `q` in full.
pub(super) fn margins_at(margins: &dyn Margins, q: &[f64]) -> Vec<f64> {
    let measure = margins.at(q);
    (0..margins.changes(q, q).len()).map(|i| measure(i, f64::INFINITY)).collect()
}

/// No margin sinks below its bound at any of so many places of the move.
pub(super) fn assert_holds(margins: &dyn Margins, from: &[f64], to: &[f64], bounds: &[f64], places: u32) {
    for place in 0..=places {
        let q = between(from, to, f64::from(place) / f64::from(places));
        for (i, (margin, bound)) in margins_at(margins, &q).iter().zip(bounds).enumerate() {
            assert!(margin >= bound && *bound > 0.0, "margin {i} is {margin} at {q:?}, the bound {bound}");
        }
    }
}

pub(super) fn euclidean(from: &[f64], to: &[f64]) -> f64 {
    from.iter().zip(to).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// One joint, and margins as functions of its value with bounds on their slopes.
pub(super) struct Laws(pub(super) Vec<(Law, f64)>);

type Law = Box<dyn Fn(f64) -> f64 + Sync>;

impl Laws {
    pub(super) fn one(slope: f64, law: impl Fn(f64) -> f64 + Sync + 'static) -> Self {
        Self(vec![(Box::new(law), slope)])
    }
}

impl Margins for Laws {
    fn at<'a>(&'a self, q: &'a [f64]) -> Measure<'a> {
        Box::new(|i, _| self.0[i].0(q[0]))
    }

    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        self.0.iter().map(|(_, slope)| slope * (to[0] - from[0]).abs()).collect()
    }
}

/// A world that tells no more than it is asked for.
pub(super) struct Terse<W>(pub(super) W);

impl<W: Margins> Margins for Terse<W> {
    fn at<'a>(&'a self, q: &'a [f64]) -> Measure<'a> {
        let measure = self.0.at(q);
        Box::new(move |i, enough| measure(i, f64::INFINITY).min(enough))
    }

    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        self.0.changes(from, to)
    }
}

/// A point among boxes along the axes, given by their corners, that it must keep clear of.
pub(super) struct Maze {
    pub(super) walls: Vec<[Vec<f64>; 2]>,
    pub(super) clearance: f64,
}

impl Maze {
    /// A wall across x = 0, 0.1 thick, in the cube from −1 to 1, with a door about y = 0.7 where there is one.
    pub(super) fn with_door(dimensions: usize, door: f64, clearance: f64) -> Self {
        let wall = |y: f64, end: f64| {
            let (mut low, mut high) = (vec![-0.05, y], vec![0.05, end]);
            low.resize(dimensions, -2.0);
            high.resize(dimensions, 2.0);
            [low, high]
        };
        Self { walls: vec![wall(-2.0, 0.7 - door / 2.0), wall(0.7 + door / 2.0, 2.0)], clearance }
    }
}

impl Margins for Maze {
    fn at<'a>(&'a self, q: &'a [f64]) -> Measure<'a> {
        Box::new(|i, _| {
            let [low, high] = &self.walls[i];
            let nearest: Vec<f64> = (0..q.len()).map(|k| q[k].clamp(low[k], high[k])).collect();
            euclidean(q, &nearest) - self.clearance
        })
    }

    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        vec![euclidean(from, to); self.walls.len()]
    }
}

/// Bars with round ends in the plane, one joint each, among discs.
#[derive(Debug)]
pub(super) struct Arm {
    pub(super) lengths: Vec<f64>,
    pub(super) radius: f64,
    /// Centre and radius.
    pub(super) discs: Vec<([f64; 2], f64)>,
}

impl Arm {
    pub(super) fn random(rng: &mut Xoshiro256PlusPlus) -> Self {
        let lengths = (0..rng.gen_range(1..=3)).map(|_| rng.gen_range(0.2..0.5)).collect();
        let mut disc = || ([rng.gen_range(-1.2..1.2), rng.gen_range(-1.2..1.2)], rng.gen_range(0.02..0.15));
        let discs = (0..3).map(|_| disc()).collect();
        Self { lengths, radius: 0.03, discs }
    }

    pub(super) fn configuration(&self, rng: &mut Xoshiro256PlusPlus) -> Vec<f64> {
        self.lengths.iter().map(|_| rng.gen_range(-3.0..3.0)).collect()
    }

    /// The joints and the tip.
    fn points(&self, q: &[f64]) -> Vec<[f64; 2]> {
        let (mut points, mut angle) = (vec![[0.0, 0.0]], 0.0);
        for (i, (length, q)) in self.lengths.iter().zip(q).enumerate() {
            angle += q;
            points.push([points[i][0] + length * angle.cos(), points[i][1] + length * angle.sin()]);
        }
        points
    }
}

impl Margins for Arm {
    fn at<'a>(&'a self, q: &'a [f64]) -> Measure<'a> {
        let points = self.points(q);
        Box::new(move |i, _| {
            let (bar, (centre, radius)) = (i / self.discs.len(), self.discs[i % self.discs.len()]);
            let (a, b) = (points[bar], points[bar + 1]);
            let (along, to_centre) = ([b[0] - a[0], b[1] - a[1]], [centre[0] - a[0], centre[1] - a[1]]);
            let dot = |u: [f64; 2], v: [f64; 2]| u[0] * v[0] + u[1] * v[1];
            let share = (dot(along, to_centre) / dot(along, along)).clamp(0.0, 1.0);
            euclidean(&to_centre, &along.map(|x| share * x)) - radius - self.radius
        })
    }

    /// No point of a bar is farther from a joint than the bars between are long together, and the radius.
    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let of_bar = |bar: usize| {
            let reach = |joint: usize| self.lengths[joint..=bar].iter().sum::<f64>() + self.radius;
            (0..=bar).map(|joint| (to[joint] - from[joint]).abs() * reach(joint)).sum::<f64>()
        };
        (0..self.lengths.len()).flat_map(|bar| std::iter::repeat_n(of_bar(bar), self.discs.len())).collect()
    }
}
