//! The problem's constraints on the views of a survey, derived from the problem file alone.

use std::collections::BTreeMap;

use super::error::{BrokenConstraint, CertifyError};
use crate::feasibility::View;
use crate::plan::survey::Survey;
use crate::problem::Problem;
use crate::robot::JointKind;

/// Groups of views of which a set may have only so many; the last ones, `most` 1, are the cells of the separations.
pub(super) struct Group {
    pub(super) members: Vec<usize>,
    pub(super) most: usize,
}

/// The constraints on the views, by number.
pub(super) struct Rules {
    pub(super) required: Vec<usize>,
    pub(super) forbidden: Vec<bool>,
    /// First those of the problem file in its order, then the cells of the separations, as prices number them.
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
        let mut groups: Vec<Group> = constraints
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
        for (points, least) in &separations {
            groups.extend(cells(points, *least));
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
        self.separations.iter().any(|(points, least)| {
            let squares = points[i].iter().zip(&points[j]).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt() < *least
        })
    }
}

/// The cells of more than one point of a grid, in the grid's order. Its side is `least / √d` for points of d coordinates, and a
/// little less, so that any two points of a cell are closer than `least`: a set has at most one of them.
fn cells(points: &[Vec<f64>], least: f64) -> Vec<Group> {
    let dimension = points.first().map_or(0, Vec::len).max(1);
    let side = least / (dimension as f64).sqrt() * (1.0 - 1e-9);
    let mut cells = BTreeMap::<Vec<i64>, Vec<usize>>::new();
    for (i, point) in points.iter().enumerate() {
        let cell = point.iter().map(|x| (x / side).floor() as i64).collect();
        cells.entry(cell).or_default().push(i);
    }
    cells.into_values().filter(|members| members.len() > 1).map(|members| Group { members, most: 1 }).collect()
}
