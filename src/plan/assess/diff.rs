//! Two plans held against each other.

use thiserror::Error;

use crate::plan::document::{
    ComparedPlan, DiffDocument, Document, LonePose, MovedPose, Plan, PlannedPose, ProblemReference, SigmaChange,
};

/// Joint values, rad or m, that differ by no more than this are one.
const SAME: f64 = 1e-6;

/// A pose whose joints are all within this of another's, rad or m, is that one moved: two steps of a usual grid.
const MOVED: f64 = 0.28;

/// Why two plans cannot be held against each other.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum DiffError {
    /// They are of different robots.
    #[error("the joints of A are {}; those of B are {}: poses of different robots do not compare", a.join(", "), b.join(", "))]
    Joints {
        /// Names of A's.
        a: Vec<String>,
        /// Names of B's.
        b: Vec<String>,
    },
    /// A pose does not have a value for every joint.
    #[error("pose {id} of {plan} has {found} joint values; there are {joints} joints")]
    JointValues {
        /// `A` or `B`.
        plan: char,
        /// Id of the pose.
        id: usize,
        /// Values that it has.
        found: usize,
        /// Number of joints.
        joints: usize,
    },
}

/// What differs between the plans `a` and `b`, read from these files. Poses are matched by their joint values, the nearest first, whatever
/// their ids are; joints by name.
///
/// # Errors
/// When the plans are of robots with other joints.
pub fn diff((file_a, a): (&str, &Plan), (file_b, b): (&str, &Plan)) -> Result<DiffDocument, DiffError> {
    let order = matched_joints(a, b)?;
    let poses_a = places('A', a, &(0..order.len()).collect::<Vec<_>>())?;
    let poses_b = places('B', b, &order)?;
    let Matched { same, moved, only_a, only_b } = matched(&poses_a, &poses_b);
    let same_problem = a.problem.sha256 == b.problem.sha256 && set_up(&a.problem).eq(set_up(&b.problem));
    let lone = |alone: &[usize], own: &[Place], others: &[Place]| {
        alone.iter().filter_map(|&i| own[i].alone(others)).collect::<Vec<_>>()
    };
    let pairs = moved.into_iter().map(|(i, j)| (&poses_a[i], &poses_b[j]));
    Ok(DiffDocument {
        header: DiffDocument::header(),
        a: numbers(file_a, a),
        b: numbers(file_b, b),
        same_problem,
        comparable: same_problem && a.criterion == b.criterion,
        sigma: sigma(a, b),
        joints: a.joints.clone(),
        same: same.into_iter().map(|(i, j)| [poses_a[i].id, poses_b[j].id]).collect(),
        moved: pairs
            .map(|(a, b)| MovedPose {
                id_a: a.id,
                id_b: b.id,
                joints_a_deg: a.shown.clone(),
                joints_b_deg: b.shown.clone(),
                distance_rad: a.distance(b),
            })
            .collect(),
        only_a: lone(&only_a, &poses_a, &poses_b),
        only_b: lone(&only_b, &poses_b, &poses_a),
    })
}

/// The values given in place of the file's, but for those that say what to select from what is surveyed.
fn set_up(problem: &ProblemReference) -> impl Iterator<Item = &String> {
    let selects = |set: &str| set.starts_with("selection.") && !set.starts_with("selection.pictures");
    problem.set.iter().filter(move |set| !selects(set))
}

/// Of each of A's joints the place in B's list.
fn matched_joints(a: &Plan, b: &Plan) -> Result<Vec<usize>, DiffError> {
    let places: Option<Vec<usize>> =
        a.joints.iter().map(|name| b.joints.iter().position(|other| other == name)).collect();
    let others = || DiffError::Joints { a: a.joints.clone(), b: b.joints.clone() };
    places.filter(|places| places.len() == b.joints.len()).ok_or_else(others)
}

/// A pose in the joint space of A.
struct Place {
    id: usize,
    /// Rad or m.
    q: Vec<f64>,
    /// In degrees or mm.
    shown: Vec<f64>,
}

impl Place {
    fn distance(&self, other: &Self) -> f64 {
        self.q.iter().zip(&other.q).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    /// The greatest difference of a joint.
    fn farthest(&self, other: &Self) -> f64 {
        self.q.iter().zip(&other.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// What is told of it where none of the `others` is it.
    fn alone(&self, others: &[Self]) -> Option<LonePose> {
        let nearest = others.iter().min_by(|a, b| self.distance(a).total_cmp(&self.distance(b)))?;
        let distance_rad = self.distance(nearest);
        Some(LonePose { id: self.id, joints_deg: self.shown.clone(), nearest: nearest.id, distance_rad })
    }
}

/// The poses of a plan with their joint values in this order.
fn places(name: char, plan: &Plan, order: &[usize]) -> Result<Vec<Place>, DiffError> {
    let place = |pose: &PlannedPose| {
        for found in [pose.joints_rad.len(), pose.joints_deg.len()] {
            if found != order.len() {
                return Err(DiffError::JointValues { plan: name, id: pose.id, found, joints: order.len() });
            }
        }
        let ordered = |values: &[f64]| order.iter().map(|&i| values[i]).collect();
        Ok(Place { id: pose.id, q: ordered(&pose.joints_rad), shown: ordered(&pose.joints_deg) })
    };
    plan.poses.iter().map(place).collect()
}

/// Which poses are which, by their places in the two lists.
struct Matched {
    same: Vec<(usize, usize)>,
    moved: Vec<(usize, usize)>,
    only_a: Vec<usize>,
    only_b: Vec<usize>,
}

/// Pairs the poses, the nearest first.
fn matched(a: &[Place], b: &[Place]) -> Matched {
    let pairs = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i, j)));
    let mut near: Vec<(usize, usize)> = pairs.filter(|&(i, j)| a[i].farthest(&b[j]) <= MOVED).collect();
    near.sort_by(|&(i, j), &(k, l)| a[i].distance(&b[j]).total_cmp(&a[k].distance(&b[l])));
    let (mut is_free_a, mut is_free_b) = (vec![true; a.len()], vec![true; b.len()]);
    let (mut same, mut moved) = (Vec::new(), Vec::new());
    for (i, j) in near {
        if is_free_a[i] && is_free_b[j] {
            (is_free_a[i], is_free_b[j]) = (false, false);
            (if a[i].farthest(&b[j]) <= SAME { &mut same } else { &mut moved }).push((i, j));
        }
    }
    same.sort_unstable();
    let left = |is_free: Vec<bool>| (0..is_free.len()).filter(|&i| is_free[i]).collect();
    Matched { same, moved, only_a: left(is_free_a), only_b: left(is_free_b) }
}

fn numbers(file: &str, plan: &Plan) -> ComparedPlan {
    ComparedPlan {
        file: file.into(),
        problem: plan.problem.clone(),
        calipose: plan.header.calipose.clone(),
        criterion: plan.criterion.clone(),
        method: plan.method.clone(),
        count: plan.count,
        pictures: plan.pictures,
        value: plan.value,
        bound: plan.bound,
        efficiency: plan.efficiency,
        map_error_px: plan.map_error_px,
        moving_s: plan.tour.as_ref().map(|tour| tour.moving_s),
        total_s: plan.tour.as_ref().map(|tour| tour.total_s),
    }
}

/// Of every intrinsic that either plan estimates, A's first.
fn sigma(a: &Plan, b: &Plan) -> Vec<SigmaChange> {
    let of = |plan: &Plan, name: &String| {
        let place = plan.intrinsics.names.iter().position(|other| other == name)?;
        plan.intrinsics.sigma.get(place).copied()
    };
    let alone = b.intrinsics.names.iter().filter(|name| !a.intrinsics.names.contains(name));
    let names = a.intrinsics.names.iter().chain(alone);
    names.map(|name| SigmaChange { name: name.clone(), a: of(a, name), b: of(b, name) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(id: usize, q: [f64; 2]) -> Place {
        Place { id, q: q.to_vec(), shown: q.map(f64::to_degrees).to_vec() }
    }

    #[test]
    fn poses_are_matched_the_nearest_first() {
        let a = [place(1, [0.0, 0.0]), place(2, [1.0, 0.0]), place(3, [2.0, 2.0]), place(4, [0.1, 0.0])];
        // The second is as near to pose 1 as to pose 4, but pose 4 has it to the last digit.
        let b = [place(9, [1.0, 5e-7]), place(8, [0.1, 0.0]), place(7, [-0.2, 0.1]), place(6, [2.0, 2.3])];
        let Matched { same, moved, only_a, only_b } = matched(&a, &b);
        assert_eq!((same, moved), (vec![(1, 0), (3, 1)], vec![(0, 2)]));
        assert_eq!((only_a, only_b), (vec![2], vec![3]));
        let lone = a[2].alone(&b).unwrap();
        assert_eq!((lone.id, lone.nearest), (3, 6));
        assert!((lone.distance_rad - 0.3).abs() < 1e-12);
        assert!(a[2].alone(&[]).is_none());
    }
}
