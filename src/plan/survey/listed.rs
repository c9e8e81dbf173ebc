//! Views that come from elsewhere than the sweep, put beside those of a survey as they are.

use super::scenarios::certain;
use super::{Survey, SurveyError};
use crate::feasibility::View;
use crate::problem::Problem;
use crate::sweep::AxisRule;
use crate::target::AxisCase;

/// Joint values, rad or m, that differ by no more than this are one.
const SAME: f64 = 1e-6;

/// A view that was put beside those of a survey.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Joined {
    /// Its place among the survey's views.
    pub(crate) place: usize,
    /// Why no plan of the problem could have it, if none could.
    pub(crate) excluded: Option<Excluded>,
}

/// Why no plan of a problem has a view that is one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excluded {
    /// Its optical axis misses the zone.
    Axis,
    /// A joint is nearer to one of its limits than poses keep.
    LimitMargin,
    /// Its joint values lie in a region without poses.
    KeepOut,
    /// It is a view in too few of the set-ups that may be.
    Uncertain,
    /// It is listed before.
    Repeated,
    /// It was taken already, from joint values that nobody knows.
    Taken,
}

impl Excluded {
    /// Name, as in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Axis => "axis",
            Self::LimitMargin => "limit_margin",
            Self::KeepOut => "keep_out",
            Self::Uncertain => "uncertain",
            Self::Repeated => "repeated",
            Self::Taken => "taken",
        }
    }
}

/// Whether two configurations are one.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME)
}

impl Survey {
    /// Puts `views` behind the survey's own, in their order, and tells where each of them stands. One from joint values that a view of
    /// the survey has takes that one's place, if it is the first to do so; whatever the joint values are, views that `are_taken` do not,
    /// for these are not exactly known.
    ///
    /// # Errors
    /// When a view's pose is not determined by its own corners.
    pub(crate) fn join_listed(
        &mut self,
        problem: &Problem,
        views: Vec<View>,
        are_taken: bool,
    ) -> Result<Vec<Joined>, SurveyError> {
        let own = self.views.len();
        let mut added: Vec<View> = Vec::new();
        let mut joined: Vec<Joined> = Vec::with_capacity(views.len());
        let mut places = vec![false; own];
        let mut id = problem.space.len() + self.refined + self.off_grid;
        for view in views {
            let known = if are_taken { None } else { self.views.iter().position(|other| same(&other.q, &view.q)) };
            if let Some(place) = known.filter(|&place| !std::mem::replace(&mut places[place], true)) {
                joined.push(Joined { place, excluded: None });
                continue;
            }
            let is_repeated = known.is_some() || added.iter().any(|other| same(&other.q, &view.q));
            let excluded = if are_taken {
                Some(Excluded::Taken)
            } else if is_repeated {
                Some(Excluded::Repeated)
            } else {
                excluded(problem, &view)
            };
            joined.push(Joined { place: own + added.len(), excluded });
            added.push(View { id, ..view });
            id += 1;
        }
        self.off_grid += added.len();
        // What a view shows does not hang on how near its joints are to their limits.
        self.append(Self::of(&up_to_limits(problem), added)?);
        Ok(joined)
    }
}

/// The problem in which poses may go up to the joints' limits.
pub(crate) fn up_to_limits(problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    for joint in &mut problem.robot.chain.joints {
        joint.limit_margin = 0.0;
    }
    problem
}

/// Why no plan of `problem` could have the view.
fn excluded(problem: &Problem, view: &View) -> Option<Excluded> {
    if problem.axis != AxisRule::Any && view.axis_case(&problem.target) == AxisCase::Outside {
        return Some(Excluded::Axis);
    }
    if problem.robot.chain.joints.iter().zip(&view.q).any(|(joint, &q)| !joint.keeps_margin(q)) {
        return Some(Excluded::LimitMargin);
    }
    if problem.constraints.keep_out.iter().any(|region| region.contains(&view.q)) {
        return Some(Excluded::KeepOut);
    }
    certain(problem, vec![view.clone()]).is_empty().then_some(Excluded::Uncertain)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::plan::survey::survey;
    use crate::problem::{JointRegion, Overrides};
    use crate::robot::Limits;

    #[test]
    fn listed_views_stand_where_they_belong() {
        let step = Overrides::new().set("sweep.step_deg=20").unwrap();
        let mut problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &step).unwrap();
        let found = survey(&problem, &|_| {}).unwrap();
        let free = up_to_limits(&problem);
        let checks = free.checks();
        let moved = |view: &View, joint: usize, value: f64| {
            let mut q = view.q.clone();
            q[joint] = value;
            checks.view(0, &q).ok().filter(|view| view.axis_case(&problem.target) != AxisCase::Outside)
        };
        let own = &found.views[7];
        let near = moved(own, 0, own.q[0] + 4e-7).unwrap();
        let between = found.views.iter().find_map(|view| moved(view, 0, view.q[0] + 0.02)).unwrap();
        let neck = problem.robot.chain.joints[3].limits.min;
        let at_limit = found.views.iter().find_map(|view| moved(view, 3, neck)).unwrap();
        let configurations = (0..problem.space.len()).map(|id| problem.space.configuration(id));
        let aside = configurations
            .filter_map(|q| checks.view(0, &q).ok())
            .find(|view| view.axis_case(&problem.target) == AxisCase::Outside);
        let listed = [near.clone(), between.clone(), own.clone(), between.clone(), at_limit, aside.unwrap()];

        let mut survey = found.clone();
        let joined = survey.join_listed(&problem, listed.to_vec(), false).unwrap();
        let n = found.views.len();
        assert_eq!(joined.iter().map(|joined| joined.place).collect::<Vec<_>>(), [7, n, n + 1, n + 2, n + 3, n + 4]);
        let repeated = Some(Excluded::Repeated);
        let expected = [None, None, repeated, repeated, Some(Excluded::LimitMargin), Some(Excluded::Axis)];
        assert_eq!(joined.iter().map(|joined| joined.excluded).collect::<Vec<_>>(), expected);
        assert_eq!((survey.views.len(), survey.information.len()), (n + 5, n + 5));
        assert!(survey.views.windows(2).all(|pair| pair[0].id < pair[1].id));
        assert_eq!(survey.off_grid_views().len(), found.off_grid + 5);
        assert_eq!(survey.information.packed(n + 1), survey.information.packed(7));

        problem.constraints.keep_out =
            vec![JointRegion(vec![(0, Limits { min: between.q[0] - 1e-3, max: between.q[0] + 1e-3 })])];
        let kept_out = found.clone().join_listed(&problem, vec![between.clone()], false).unwrap();
        assert_eq!(kept_out[0].excluded, Some(Excluded::KeepOut));
        // Pictures are where they are.
        let taken = found.clone().join_listed(&problem, vec![near, between], true).unwrap();
        let expected = [n, n + 1].map(|place| Joined { place, excluded: Some(Excluded::Taken) });
        assert_eq!(taken, expected);
    }

    #[test]
    fn a_view_that_is_none_in_most_set_ups_is_uncertain() {
        let sets = [
            "sweep.step_deg=20",
            "robot.limit_margin_deg=0",
            "robust={mount_rotation_deg=8, scenarios=4, draws=8, seen_share=0.75}",
        ];
        let overrides = sets.iter().fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
        let problem = Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap();
        let stated = survey(&Problem { robust: None, ..problem.clone() }, &|_| {}).unwrap();
        let certain = survey(&problem, &|_| {}).unwrap();
        let joined = certain.clone().join_listed(&problem, stated.views.clone(), false).unwrap();
        for (view, joined) in stated.views.iter().zip(&joined) {
            let expected = if certain.index_of(view.id).is_some() { None } else { Some(Excluded::Uncertain) };
            assert_eq!(joined.excluded, expected, "{}", view.id);
        }
        assert!(joined.iter().any(|joined| joined.excluded.is_some()));
    }
}
