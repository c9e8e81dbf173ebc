//! The problem's constraints on the views of a survey, derived from the problem file alone.

use super::error::{BrokenConstraint, CertifyError};
use crate::feasibility::View;
use crate::plan::survey::Survey;
use crate::problem::Problem;
use crate::robot::JointKind;

/// Views of which a set may have only so many.
#[derive(Clone)]
pub(super) struct Group {
    pub(super) members: Vec<usize>,
    pub(super) most: usize,
}

/// The constraints on the views, by number.
pub(super) struct Rules {
    pub(super) required: Vec<usize>,
    pub(super) forbidden: Vec<bool>,
    /// Those of the problem file in its order.
    pub(super) groups: Vec<Group>,
    /// Points of all views and the least distance between those of two poses.
    separations: Vec<(Vec<Vec<f64>>, f64)>,
}

impl Rules {
    pub(super) fn new(problem: &Problem, survey: &Survey) -> Self {
        let constraints = &problem.constraints;
        let views = &survey.views;
        let has = |ids: &[usize], view: &View| ids.contains(&view.id);
        let numbers = |is: &dyn Fn(&View) -> bool| (0..views.len()).filter(|&i| is(&views[i])).collect::<Vec<_>>();
        let forbidden = views
            .iter()
            .map(|view| has(&constraints.forbidden, view) || constraints.keep_out.iter().any(|r| r.contains(&view.q)));
        let groups = constraints
            .groups
            .iter()
            .map(|group| Group { members: numbers(&|view| group.region.contains(&view.q)), most: group.most })
            .collect();
        let mut separations: Vec<(Vec<Vec<f64>>, f64)> = Vec::new();
        if constraints.joint_separation > 0.0 {
            let joints = &problem.robot.chain.joints;
            let angles = |view: &View| {
                let revolute = view.q.iter().zip(joints).filter(|(_, joint)| joint.kind == JointKind::Revolute);
                revolute.map(|(&q, _)| q).collect()
            };
            separations.push((views.iter().map(angles).collect(), constraints.joint_separation));
        }
        if constraints.view_separation > 0.0 {
            // Unit vectors at an angle α are 2 sin(α/2) apart.
            let chord = 2.0 * (0.5 * constraints.view_separation).sin();
            let toward = |view: &View| view.X_CT.inverse().translation.vector.normalize().iter().copied().collect();
            separations.push((views.iter().map(toward).collect(), chord));
        }
        let least = problem.picture_separation();
        if least > 0.0 {
            let picture = |view: &View| view.picture(&problem.camera, &problem.target.board).to_vec();
            separations.push((views.iter().map(picture).collect(), least));
        }
        let required = numbers(&|view| has(&constraints.required, view));
        Self { required, forbidden: forbidden.collect(), groups, separations }
    }

    /// Checks that they allow the poses.
    pub(super) fn allow(&self, selected: &[usize], problem: &Problem, survey: &Survey) -> Result<(), CertifyError> {
        let id = |i: usize| survey.views[i].id;
        let Self { forbidden, groups, .. } = self;
        let broken = |broken| Err(CertifyError::Constraint(broken));
        // Also one that is no view: it cannot be among them.
        let ids: Vec<usize> = selected.iter().map(|&i| id(i)).collect();
        if let Some(&id) = problem.constraints.required.iter().find(|id| !ids.contains(id)) {
            return broken(BrokenConstraint::Missing { id });
        }
        if let Some(&i) = selected.iter().find(|&&i| forbidden[i]) {
            return broken(BrokenConstraint::Forbidden { id: id(i) });
        }
        for (Group { members, most }, group) in groups.iter().zip(&problem.constraints.groups) {
            let count = selected.iter().filter(|i| members.contains(i)).count();
            if count > *most {
                return broken(BrokenConstraint::Crowded { group: group.name.clone(), count, most: *most });
            }
        }
        for (a, &i) in selected.iter().enumerate() {
            if let Some(&j) = selected[a + 1..].iter().find(|&&j| self.are_too_close(i, j)) {
                return broken(BrokenConstraint::Close { first: id(i), second: id(j) });
            }
        }
        Ok(())
    }

    /// The views that are not forbidden.
    pub(super) fn open(&self) -> Vec<usize> {
        (0..self.forbidden.len()).filter(|&i| !self.forbidden[i]).collect()
    }

    pub(super) fn are_too_close(&self, i: usize, j: usize) -> bool {
        self.separations.iter().any(|(points, least)| distance(&points[i], &points[j]) < *least)
    }

    /// The views nearer than half a separation's least distance to the point midway between two of them, or a little less, so that
    /// rounding joins none that are not: any two of them are too close to each other. `None` if there is no such separation.
    pub(super) fn ball(&self, separation: usize, a: usize, b: usize) -> Option<Group> {
        let (points, least) = self.separations.get(separation)?;
        let centre: Vec<f64> = points[a].iter().zip(&points[b]).map(|(a, b)| 0.5 * (a + b)).collect();
        let is_near = |&i: &usize| 2.0 * distance(&points[i], &centre) < least * (1.0 - 1e-9);
        Some(Group { members: (0..points.len()).filter(is_near).collect(), most: 1 })
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
