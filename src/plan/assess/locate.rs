//! A plan that was written, found again in a survey of its problem.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use thiserror::Error;

use crate::figures::grouped;
use crate::plan::choose::{Chooser, PlanError};
use crate::plan::document::{Plan, PlannedPose, PlannedPoses, joints_deg};
use crate::plan::survey::Survey;
use crate::problem::{Problem, RobustGoal, Robustness};

/// Why a plan does not fit the survey.
#[derive(Debug, Error)]
pub enum LocateError {
    /// A pose is no view.
    #[error("its pose {id} is not among the {} configurations that see the board", grouped(*views))]
    NotAView {
        /// The pose's id.
        id: usize,
        /// Number of views.
        views: usize,
    },
    /// A pose's joint values are not those of its id.
    #[error("the joint values of its pose {id} are not those of the swept configuration {id}")]
    Moved {
        /// The pose's id.
        id: usize,
    },
    /// A pose is in the plan twice.
    #[error("its pose {id} occurs twice")]
    Twice {
        /// The pose's id.
        id: usize,
    },
    /// Its joints are not the robot's.
    #[error("its joints are {}; the robot's are {}", stated.join(", "), found.join(", "))]
    Joints {
        /// Names in the plan.
        stated: Vec<String>,
        /// The robot's.
        found: Vec<String>,
    },
    /// Its intrinsics are not those that the problem estimates.
    #[error("its intrinsics are {}; the problem estimates {}", stated.join(", "), found.join(", "))]
    Intrinsics {
        /// Names in the plan.
        stated: Vec<String>,
        /// Those that are estimated.
        found: Vec<String>,
    },
    /// The hash is of the problem file alone; a camera file that it names may have changed.
    #[error("it was made for another nominal camera; make a new plan")]
    Camera,
    /// There are no poses, or of another robot.
    #[error("its poses do not have {dof} joint values, as the robot has joints")]
    JointValues {
        /// Number of the robot's joints.
        dof: usize,
    },
    /// A robot's description that the problem file names may have changed, too.
    #[error(
        "the joint values of its pose {id} lead to another camera pose than the plan says: the robot or the plan was changed; make a \
         new plan"
    )]
    Elsewhere {
        /// The pose's id.
        id: usize,
    },
    /// It optimises something else.
    #[error("it optimises \"{stated}\"; the problem asks for \"{found}\"")]
    Criterion {
        /// What it says.
        stated: String,
        /// What the problem asks for.
        found: String,
    },
    /// Its certificate is for something else.
    #[error("its certificate is for \"{stated}\"; the problem asks for \"{found}\"")]
    Certificate {
        /// What the certificate's terms say.
        stated: String,
        /// What the problem asks for.
        found: String,
    },
    /// The problem's constraints or criteria cannot be held.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

impl Plan {
    /// Checks that the plan is of the problem's robot, camera and criteria: names, nominal values, and every pose where it says.
    ///
    /// # Errors
    /// When it is not.
    pub fn fit(&self, problem: &Problem) -> Result<(), LocateError> {
        PlannedPoses::from(self).fit(problem)?;
        let goal = &problem.selection.goal;
        if self.criterion != goal.to_string() {
            return Err(LocateError::Criterion { stated: self.criterion.clone(), found: goal.to_string() });
        }
        let proven = self.certificate.grid.terms.iter().map(|term| (term.criterion.as_str(), term.share));
        // Of a mean over scenarios each has an equal part.
        let (scenarios, parts) = match &problem.robust {
            None => (1, 1),
            Some(Robustness { scenarios, goal: RobustGoal::Mean, .. }) => (*scenarios, *scenarios),
            Some(Robustness { scenarios, goal: RobustGoal::Worst, .. }) => (*scenarios, 1),
        };
        let terms = || goal.terms().into_iter().map(|(criterion, share)| (criterion, share / parts as f64));
        if !proven.clone().eq((0..scenarios).flat_map(|_| terms())) {
            let stated =
                proven.map(|(criterion, share)| format!("{share} {criterion}")).collect::<Vec<_>>().join(" + ");
            return Err(LocateError::Certificate { stated, found: goal.to_string() });
        }
        Ok(())
    }

    /// The chooser that made the plan, by what the problem asks for, and its poses as indices into the survey's views, in the
    /// plan's order.
    ///
    /// # Errors
    /// When a pose is no view of the survey, or the constraints cannot be held.
    pub fn locate<'a>(
        &self,
        problem: &'a Problem,
        survey: &'a Survey,
    ) -> Result<(Chooser<'a>, Vec<usize>), LocateError> {
        Ok((Chooser::new(problem, survey)?, self.places(survey)?))
    }

    /// The poses' places among the survey's views, whose joint values must be theirs.
    pub(super) fn places(&self, survey: &Survey) -> Result<Vec<usize>, LocateError> {
        let views = &survey.views;
        let mut places = Vec::with_capacity(self.poses.len());
        for pose in &self.poses {
            let id = pose.id;
            let place = survey.index_of(id).ok_or(LocateError::NotAView { id, views: views.len() })?;
            let q = &views[place].q;
            let same = pose.joints_rad.iter().zip(q).all(|(a, b)| (a - b).abs() <= 1e-12);
            if pose.joints_rad.len() != q.len() || !same {
                return Err(LocateError::Moved { id });
            }
            if places.contains(&place) {
                return Err(LocateError::Twice { id });
            }
            places.push(place);
        }
        Ok(places)
    }
}

impl PlannedPoses {
    /// Checks that the poses are of the problem's robot and camera: names, nominal values, and every pose where it says.
    ///
    /// # Errors
    /// When they are not.
    pub fn fit(&self, problem: &Problem) -> Result<(), LocateError> {
        let chain = &problem.robot.chain;
        let joints: Vec<String> = chain.joints.iter().map(|joint| joint.name.clone()).collect();
        if self.joints != joints {
            return Err(LocateError::Joints { stated: self.joints.clone(), found: joints });
        }
        let names = problem.unknowns().names();
        if self.intrinsics.names != names {
            let found = names.into_iter().map(String::from).collect();
            return Err(LocateError::Intrinsics { stated: self.intrinsics.names.clone(), found });
        }
        if self.intrinsics.nominal != problem.unknowns().values() {
            return Err(LocateError::Camera);
        }
        let dof = chain.dof();
        if self.poses.is_empty() || self.poses.iter().any(|pose| pose.joints_rad.len() != dof) {
            return Err(LocateError::JointValues { dof });
        }
        match self.poses.iter().find(|pose| !pose.is_there(problem)) {
            Some(pose) => Err(LocateError::Elsewhere { id: pose.id }),
            None => Ok(()),
        }
    }
}

impl PlannedPose {
    /// Whether the joint values, in rad and in degrees alike, bring the camera to where the pose says.
    fn is_there(&self, problem: &Problem) -> bool {
        let X_BC = problem.robot.camera_pose(&self.joints_rad);
        let [x, y, z] = self.camera_in_base.position_m;
        let [i, j, k, w] = self.camera_in_base.quaternion_xyzw;
        let planned = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        let joints_deg = joints_deg(&problem.robot.chain, &self.joints_rad);
        (X_BC.translation.vector - Vector3::new(x, y, z)).norm() < 1e-9
            && X_BC.rotation.angle_to(&planned) < 1e-7
            && self.joints_deg.len() == joints_deg.len()
            && self.joints_deg.iter().zip(&joints_deg).all(|(a, b)| (a - b).abs() < 1e-9)
    }
}
